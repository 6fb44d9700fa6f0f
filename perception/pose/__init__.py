"""Depth in, poses out: segmentation, hypotheses, refinement on the distance field, verification."""

from perception.pose.find import find_parts
from perception.pose.finding import Detection, Finding, Rejection
from perception.pose.model import PartModel, build_model
from perception.pose.volume import BinVolume

__all__ = [
    "BinVolume",
    "Detection",
    "Finding",
    "PartModel",
    "Rejection",
    "build_model",
    "find_parts",
]
