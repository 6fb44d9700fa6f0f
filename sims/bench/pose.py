"""Bench ``pose``: shafts found in rendered stereo of settled piles, without any help from truth.

Depth comes from the rendered images with the rig's true calibration, segmentation is our own, and
every part that shows half of its camera-facing surface counts as wanted. Success is within 2
degrees and 2 mm. Errors are over successes; what was missed, false or flipped stands beside them.
"""

import time
from collections.abc import Sequence

import numpy as np

from hal import Figure
from perception.parts import Part
from perception.pose import build_model, find_parts
from sims.bench.looks import Look, look_at, pile_of
from sims.bench.peers import fpfh_ransac_icp
from sims.bench.scoring import Score, score_poses

__all__ = ["run"]

PAIRS = 4
PEER = "Open3D FPFH + RANSAC + ICP"
COVERED = 2.0


def run(*, seeds: Sequence[int], part: Part, count: int = 20, pairs: int = PAIRS) -> list[Figure]:
    """Measure on a pile of ``count`` a seed, ``pairs`` patterns a look; the peer on the same views.

    Angles are in radians, lengths in metres, times in seconds of wall clock, on this machine as
    it is loaded.
    """
    ours, peer = Score(), Score()
    our_s: list[float] = []
    peer_s: list[float] = []
    for seed in seeds:
        look = look_at(pile_of(seed, count, part), seed=seed, pairs=pairs)
        _add_ours(look, ours, our_s)
        _add_peer(look, peer, peer_s)
    return _figures(ours, peer, our_s, peer_s)


def _add_ours(look: Look, score: Score, wall_s: list[float]) -> None:
    model = build_model(look.part)
    began_s = time.perf_counter()
    finding = find_parts(look.view, model, volume=look.volume, seed=look.seed)
    wall_s.append(time.perf_counter() - began_s)
    poses = [d.T_camera_object for d in finding.detections]
    score_poses(score, look.part, poses, look.T_camera_parts, look.visible, finding.detections)


def _add_peer(look: Look, score: Score, wall_s: list[float]) -> None:
    began_s = time.perf_counter()
    poses = fpfh_ransac_icp(look.view, look.part, look.volume, seed=look.seed)
    wall_s.append(time.perf_counter() - began_s)
    score_poses(score, look.part, poses, look.T_camera_parts, look.visible)


def _figures(ours: Score, peer: Score, our_s: list[float], peer_s: list[float]) -> list[Figure]:
    def share(name: str, pick: str, of: str) -> Figure:
        mine, other = (
            getattr(s, pick) / getattr(s, of) if getattr(s, of) else 0.0 for s in (ours, peer)
        )
        return Figure(f"pose.shaft.{name}", mine, "", getattr(ours, of), None, None, PEER, other)

    def rms(name: str, pick: str, unit: str) -> Figure:
        mine, other = (np.array(getattr(s, pick)) for s in (ours, peer))
        worst = float(np.abs(mine).max()) if len(mine) else None
        peers = float(np.sqrt((other**2).mean())) if len(other) else None
        value = float(np.sqrt((mine**2).mean())) if len(mine) else float("nan")
        return Figure(f"pose.shaft.{name}", value, unit, len(mine), None, worst, PEER, peers)

    deviations = np.abs(np.array(ours.deviations).reshape(-1, 5))
    covered = float((deviations < COVERED).mean()) if len(deviations) else float("nan")
    return [
        share("recall", "found", "wanted"),
        share("false_rate", "false", "detected"),
        share("flips", "flipped", "detected"),
        rms("axis_rms", "axis_rad", "rad"),
        rms("position_rms", "position_m", "m"),
        rms("transverse_rms", "transverse_m", "m"),
        rms("axial_rms", "axial_m", "m"),
        Figure("pose.shaft.coverage_2sigma", covered, "", deviations.size),
        Figure.median(
            "pose.shaft.seconds_scene",
            our_s,
            "s",
            peer=PEER,
            peer_value=float(np.median(peer_s)) if peer_s else None,
        ),
    ]
