"""From a depth view to parts: the whole search, in the order in which it happens."""

import cv2
import numpy as np
from numpy.typing import NDArray

from hal import Transform, rotation_from_rotvec, rotvec_from_rotation
from hal.errors import NoDepthError
from perception.pose.candidates import find_candidates
from perception.pose.consistency import Scene
from perception.pose.covariance import pose_covariance
from perception.pose.finding import Detection, Finding, Rejection
from perception.pose.model import PartModel
from perception.pose.polish import own_points, polish
from perception.pose.segments import label_pieces
from perception.pose.surface import Surface, see_surface
from perception.pose.verify import compare
from perception.pose.volume import BinVolume
from perception.view import DepthView

__all__ = ["find_parts"]

ROUNDS = 3
MIN_DEPTH_SHARE = 0.15
SEAM_M = 0.003
FINAL_STRIDE_PX = 4


def find_parts(view: DepthView, model: PartModel, *, volume: BinVolume, seed: int = 0) -> Finding:
    """Find every part in the bin that shows enough of itself.

    The same view, model, volume and seed give the same bits, whatever the number of threads.

    Parameters
    ----------
    view
        The rectified left view with its depth.
    model
        From ``build_model``.
    volume
        Where the bin is, in frame ``camera``.
    seed
        For the choice of points in the first fits.

    Raises
    ------
    NoDepthError
        The bin is out of view, or hardly anything of it has depth.
    """
    rng = np.random.default_rng(seed)
    surface = see_surface(view, volume)
    if surface is None:
        raise NoDepthError("the bin is not in view; check the calibration's mounting")
    share = surface.measured_share
    if share < MIN_DEPTH_SHARE:
        raise NoDepthError(
            f"only {share:.0%} of the bin has depth; check light, pattern and camera order"
        )
    scene = Scene(surface, model)
    for _ in range(ROUNDS):
        labels = label_pieces(surface, scene.is_open)
        candidates = find_candidates(surface, model, labels, scene.is_open, rng=rng)
        if not scene.accept(candidates):
            break
    return _finding(view, surface, model, scene)


def _finding(view: DepthView, surface: Surface, model: PartModel, scene: Scene) -> Finding:
    """Polish what was accepted and write it down, best first."""
    polished = polish(surface, model, [a.pose for a in scene.accepted])
    shares = [compare(surface, model, p.pose, stride=FINAL_STRIDE_PX) for p in polished]
    order = sorted(range(len(polished)), key=lambda k: (-shares[k].score, k))
    detections = []
    for k in order:
        covariance, unobservable = pose_covariance(
            polished[k].normal_matrix, model.part, surface,
            residual_m=polished[k].residual_m,
            pixels_per_point=max(polished[k].pixels / max(polished[k].points, 1), 1.0),
            axial_sigma_m=polished[k].axial_sigma_m,
        )  # fmt: skip
        detections.append(
            Detection(
                T_camera_object=_transform(polished[k].pose),
                score=float(np.clip(shares[k].score, 0, 1)),
                match=shares[k].match,
                violation=shares[k].violation,
                occluded=shares[k].occluded,
                visible=shares[k].match * shares[k].measured,
                covariance=covariance,
                unobservable=unobservable,
                flip_margin=scene.accepted[k].flip_margin,
                points=polished[k].points,
            )
        )
    labels, leftover_m2 = _labels(view, surface, model, [polished[k].pose for k in order])
    return Finding(
        detections=tuple(detections),
        rejections=tuple(
            Rejection(_transform(r.pose), float(r.score), r.reason) for r in scene.refused
        ),
        labels=labels,
        window=surface.window,
        leftover_m2=leftover_m2,
        part_area_m2=_least_area(model),
        noise_m=surface.noise_m,
    )


def _labels(
    view: DepthView, surface: Surface, model: PartModel, poses: list[NDArray[np.float64]]
) -> tuple[NDArray[np.int32], float]:
    """Label the view, and measure what is left without the thin seams about parts."""
    labels = own_points(surface, model, poses)
    left = (surface.is_inside & (labels == 0)).astype(np.uint8)
    pixel_m = surface.pixel_m
    side = 2 * max(round(SEAM_M / pixel_m / 2), 1) + 1 if np.isfinite(pixel_m) else 3
    left = cv2.morphologyEx(left, cv2.MORPH_OPEN, np.ones((side, side), np.uint8))
    labels[left > 0] = -1
    whole = np.zeros(view.depth_m.shape, np.int32)
    whole[surface.window.slices] = labels
    return whole, float(left.sum()) * pixel_m**2 if left.any() else 0.0


def _least_area(model: PartModel) -> float:
    """The least outline area that the part can show: end-on, or lying."""
    radius_m, length_m = model.part.max_radius_m, model.part.length_m
    profile = model.part.profile
    side_m2 = float((2 * profile.radii_m * profile.lengths_m).sum())
    return min(np.pi * radius_m**2, side_m2) if length_m > 0 else np.pi * radius_m**2


def _transform(pose: NDArray[np.float64]) -> Transform:
    """Give a pose its frames; thousands of small turns are rounded back to a rotation."""
    rotation = rotation_from_rotvec(rotvec_from_rotation(pose[:3, :3]))
    return Transform.from_parts("camera", "object", rotation, pose[:3, 3])
