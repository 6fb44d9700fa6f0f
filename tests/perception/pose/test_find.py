"""Parts are found where they lie, nothing is found where nothing lies, and bits repeat."""

import hashlib
import os
import subprocess
import sys
import time
from dataclasses import replace

import numpy as np
import pytest

from hal import Transform, rotation_from_rotvec
from hal.errors import FrameMismatchError, NoDepthError
from perception.parts import load_part
from perception.pose import BinVolume, build_model, find_parts
from perception.pose.outline import outline


@pytest.fixture(scope="module")
def model(shaft):
    return build_model(shaft)


@pytest.fixture(scope="module")
def scene(shaft, five_shafts, look_into_bin, over_bin):
    return look_into_bin(shaft, five_shafts, over_bin(), noise_m=0.0002, seed=1)


@pytest.fixture(scope="module")
def finding(scene, model):
    return find_parts(scene.view, model, volume=scene.volume)


def errors(detection, truth, *, is_reversible=False):
    """Return (axis angle rad, distance m) to the nearest true pose."""
    found = detection.T_camera_object
    best = min(truth, key=lambda t: np.linalg.norm(t.translation_m - found.translation_m))
    cosine = float(found.rotation[:, 2] @ best.rotation[:, 2])
    cosine = abs(cosine) if is_reversible else cosine
    off = np.linalg.norm(best.translation_m - found.translation_m)
    return np.arccos(np.clip(cosine, -1, 1)), off


def assert_all_found(finding, truth, *, axis_rad=0.008, off_m=0.0008, is_reversible=False):
    assert len(finding.detections) == len(truth)
    taken = set()
    for detection in finding.detections:
        angle, off = errors(detection, truth, is_reversible=is_reversible)
        assert angle < axis_rad
        assert off < off_m
        taken.add(
            min(
                range(len(truth)),
                key=lambda k: np.linalg.norm(
                    truth[k].translation_m - detection.T_camera_object.translation_m
                ),
            )
        )
    assert len(taken) == len(truth)


def test_parts_are_found_apart_touching_crossing_and_upright(finding, scene):
    assert_all_found(finding, scene.T_camera_parts)


def test_what_is_said_of_a_detection_holds(finding, scene):
    assert [d.score for d in finding.detections] == sorted(
        (d.score for d in finding.detections), reverse=True
    )
    for detection in finding.detections:
        assert detection.violation < 0.02
        assert 0.35 < detection.match <= 1
        assert "rotation z" in detection.unobservable
        assert np.isinf(detection.covariance[2, 2])
        seen = [k for k in range(6) if np.isfinite(detection.covariance[k, k])]
        block = detection.covariance[np.ix_(seen, seen)]
        assert block == pytest.approx(block.T)
        assert np.linalg.eigvalsh(block).min() > 0
        assert detection.flip_margin > 0
    assert finding.labels.shape == scene.view.depth_m.shape
    assert set(np.unique(finding.labels)) >= {0, 1, len(finding.detections)}
    assert not finding.is_empty


def test_the_labels_show_where_each_part_was_seen(finding, scene):
    points = scene.view.points()
    for k, detection in enumerate(finding.detections):
        local = detection.T_camera_object.inverse().apply(points[finding.labels == k + 1])
        assert len(local) > 200
        assert np.hypot(local[:, 0], local[:, 1]).max() < 0.017
        assert np.abs(local[:, 2]).max() < 0.053


@pytest.mark.parametrize("turn_rad", [1.1, np.pi, -2.0])
def test_turning_the_camera_turns_the_poses(
    shaft, model, five_shafts, look_into_bin, over_bin, turn_rad
):
    scene = look_into_bin(shaft, five_shafts, over_bin((0.02, -0.03, turn_rad)))
    assert_all_found(find_parts(scene.view, model, volume=scene.volume), scene.T_camera_parts)


def test_a_shaft_turned_end_for_end_is_found_turned(shaft, model, look_into_bin, lay, over_bin):
    axes = []
    for turn_rad in (0.5, 0.5 + np.pi):
        scene = look_into_bin(shaft, [lay(shaft, 0, 0, turn_rad)], over_bin(), noise_m=0.0002)
        finding = find_parts(scene.view, model, volume=scene.volume)
        assert_all_found(finding, scene.T_camera_parts)
        axes.append(finding.detections[0].T_camera_object.rotation[:, 2])
    assert axes[0] @ axes[1] < -0.999


@pytest.mark.parametrize("name", ["shaft-slim", "shaft-short", "shaft-plain", "shaft:24x30,16x50"])
def test_shafts_of_other_sizes_are_found(name, look_into_bin, lay, over_bin):
    part = load_part(name)
    poses = [lay(part, -0.1, 0.05, 0.3), lay(part, 0.05, -0.05, 2.2), lay(part, 0.08, 0.07, -1.2)]
    scene = look_into_bin(part, poses, over_bin(), noise_m=0.0002, seed=2)
    finding = find_parts(scene.view, build_model(part), volume=scene.volume)
    assert_all_found(finding, scene.T_camera_parts, is_reversible=part.is_reversible)
    for detection in finding.detections:
        assert np.isinf(detection.flip_margin) or not part.is_reversible


def test_an_empty_bin_is_empty_and_quickly_so(shaft, model, look_into_bin, over_bin):
    scene = look_into_bin(shaft, [], over_bin(), noise_m=0.0003)
    began = time.process_time()
    finding = find_parts(scene.view, model, volume=scene.volume)
    assert time.process_time() - began < 1.0
    assert finding.detections == ()
    assert finding.is_empty


def test_something_else_in_the_bin_is_left_over_and_no_part(shaft, model, look_into_bin, over_bin):
    block = ((0.05, 0.02, 0.02), (0.06, 0.04, 0.04))
    scene = look_into_bin(shaft, [], over_bin(), noise_m=0.0002, boxes=[block])
    finding = find_parts(scene.view, model, volume=scene.volume)
    assert finding.detections == ()
    assert not finding.is_empty
    assert finding.leftover_m2 == pytest.approx(0.06 * 0.04, rel=0.35)


def test_a_shaft_of_another_size_is_not_taken_for_this_one(shaft, look_into_bin, lay, over_bin):
    other = load_part("shaft-short")
    scene = look_into_bin(other, [lay(other, 0, 0, 0.4)], over_bin(), noise_m=0.0002)
    finding = find_parts(scene.view, build_model(shaft), volume=scene.volume)
    assert finding.detections == ()
    assert not finding.is_empty
    assert all(r.reason for r in finding.rejections)


def test_a_shaft_mostly_hidden_is_not_guessed(shaft, model, look_into_bin, lay, over_bin):
    lid = ((0.02, 0, 0.05), (0.11, 0.06, 0.004))
    scene = look_into_bin(shaft, [lay(shaft, 0, 0, 0.0)], over_bin(), noise_m=0.0002, boxes=[lid])
    finding = find_parts(scene.view, model, volume=scene.volume)
    assert finding.detections == ()


def test_without_depth_there_is_an_error_and_no_empty_bin(scene, model):
    dark = replace(scene.view, depth_m=np.full_like(scene.view.depth_m, np.nan))
    with pytest.raises(NoDepthError, match="has depth"):
        find_parts(dark, model, volume=scene.volume)
    behind = Transform.from_translation("camera", "bin", (0, 0, -1))
    with pytest.raises(NoDepthError, match="not in view"):
        find_parts(scene.view, model, volume=BinVolume(behind, (0.36, 0.26, 0.14)))


def test_a_volume_wants_the_bin_in_the_camera():
    with pytest.raises(FrameMismatchError, match="T_camera_bin"):
        BinVolume(Transform.identity("base", "bin"), (1, 1, 1))


def test_inputs_are_not_changed(scene, model):
    before = scene.view.depth_m.copy()
    find_parts(scene.view, model, volume=scene.volume)
    assert np.array_equal(before, scene.view.depth_m, equal_nan=True)


def digest(finding) -> str:
    total = hashlib.sha256()
    for d in finding.detections:
        total.update(d.T_camera_object.matrix.tobytes() + d.covariance.tobytes())
        total.update(repr((d.score, d.match, d.flip_margin, d.points)).encode())
    total.update(finding.labels.tobytes())
    return total.hexdigest()


AGAIN = """
import sys, pickle, hashlib
import numpy as np, cv2
cv2.setNumThreads(int(sys.argv[2]))
from perception.parts import load_part
from perception.pose import build_model, find_parts
view, volume = pickle.load(open(sys.argv[1], "rb"))
finding = find_parts(view, build_model(load_part("shaft")), volume=volume)
total = hashlib.sha256()
for d in finding.detections:
    total.update(d.T_camera_object.matrix.tobytes() + d.covariance.tobytes())
    total.update(repr((d.score, d.match, d.flip_margin, d.points)).encode())
total.update(finding.labels.tobytes())
print(total.hexdigest())
"""


def test_the_bits_repeat_whatever_the_threads_and_hashes(tmp_path, scene, finding):
    import pickle

    path = tmp_path / "scene.pkl"
    path.write_bytes(pickle.dumps((scene.view, scene.volume)))
    seen = set()
    for threads, hashes in (("1", "1"), ("2", "77")):
        env = dict(os.environ, OPENBLAS_NUM_THREADS=threads, PYTHONHASHSEED=hashes)
        run = subprocess.run(
            [sys.executable, "-c", AGAIN, str(path), threads],
            env=env, capture_output=True, text=True, check=True,
        )  # fmt: skip
        seen.add(run.stdout.strip())
    assert seen == {digest(finding)}


def test_the_outline_runs_round_the_part(finding, scene, shaft):
    detection = finding.detections[0]
    silhouette, *steps = outline(shaft, detection.T_camera_object, scene.view)
    assert np.array_equal(silhouette[0], silhouette[-1])
    points = detection.T_camera_object.apply(shaft.vertices_m)
    u = points[:, 0] / points[:, 2] * scene.view.focal_px + scene.view.centre_x_px
    assert silhouette[:, 0].min() == pytest.approx(u.min(), abs=1.0)
    assert silhouette[:, 0].max() == pytest.approx(u.max(), abs=1.0)
    assert len(steps) >= 3


@pytest.mark.slow
@pytest.mark.parametrize("seed", [3, 4])
def test_a_rendered_pile_is_seen_whole(shaft, seed):
    from sims.bench.looks import look_at, pile_of
    from sims.bench.scoring import Score, score_poses

    look = look_at(pile_of(seed, 20, shaft), seed=seed, pairs=4)
    finding = find_parts(look.view, build_model(shaft), volume=look.volume)
    score = Score()
    poses = [d.T_camera_object for d in finding.detections]
    score_poses(score, shaft, poses, look.T_camera_parts, look.visible, finding.detections)
    assert score.found >= 0.95 * score.wanted
    assert score.false == 0
    assert np.sqrt(np.mean(np.square(score.axis_rad))) < np.radians(0.2)
    assert np.sqrt(np.mean(np.square(score.position_m))) < 0.0003


def test_a_gear_is_looked_for_without_a_crash(look_into_bin, over_bin, tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    gear = load_part("gear")
    flat = Transform.from_translation("bin", "object", (0.02, -0.03, 0.01))
    leaning = Transform.from_parts(
        "bin", "object", rotation_from_rotvec([0.25, 0, 0]), (-0.08, 0.04, 0.018)
    )
    scene = look_into_bin(gear, [flat, leaning], over_bin(), noise_m=0.0002)
    finding = find_parts(scene.view, build_model(gear), volume=scene.volume)
    assert len(finding.detections) == 2
    for detection in finding.detections:
        angle, off = errors(detection, scene.T_camera_parts, is_reversible=True)
        assert angle < 0.02
        assert off < 0.002
