"""Pictures of a small scene whose geometry is known on paper."""

import cv2
import mujoco
import numpy as np
import pytest

from hal import Region
from perception.rectify import T_base_camera, distorted, rectifier_for
from sims.camera import (
    Bodies,
    Exposure,
    Poses,
    RigTruth,
    Sensor,
    StereoRenderer,
    patterns,
    true_view,
    visible_shares,
)
from sims.camera.primitives import box, cylinder

RIG = RigTruth.seeded(1)
BALLS = [(0.50, -0.05, 0.08), (0.60, 0.06, 0.12), (0.55, 0.0, 0.06)]
LEFT, RIGHT = Region(800, 350, 480, 480), Region(600, 350, 480, 480)

BLACK_FLOOR = """<mujoco><worldbody>
<geom type="plane" size="2 2 .1" pos="0 0 .05" rgba="0.02 0.02 0.02 1"/>{balls}
<geom type="box" size=".5 .5 .01" pos=".55 0 .3" group="4"/>
<geom type="box" size=".5 .5 .01" pos=".55 0 .32" rgba="1 1 1 0"/>
<geom name="camera_housing" type="box" size=".1 .1 .1" pos=".55 0 .78"/>
</worldbody></mujoco>""".format(
    balls="".join(
        f'<geom type="sphere" size=".005" pos="{x} {y} {z}" rgba="1 1 1 1"/>' for x, y, z in BALLS
    )
)


def scene(text, part_mesh=None):
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    return Bodies(model, part_mesh), Poses.copied(data)


@pytest.fixture(scope="module")
def balls():
    bodies, poses = scene(BLACK_FLOOR)
    renderer = StereoRenderer(RIG, bodies)
    return renderer, poses, renderer.buffers(poses, LEFT, RIGHT)


def test_balls_appear_where_the_true_rig_projects_them(balls):
    renderer, _, buffers = balls
    dark = Exposure(pattern=None, exposure_s=0.05)
    images = renderer.images(buffers, (LEFT, RIGHT), dark)
    true = RIG.calibration
    left_points = true.T_base_left.inverse().apply(np.array(BALLS))
    right_points = true.T_left_right.inverse().apply(left_points)
    for image, camera, region, points in (
        (images[0], true.left, LEFT, left_points),
        (images[1], true.right, RIGHT, right_points),
    ):
        found, centres = centroids(image)
        assert found == len(BALLS)
        u, v = distorted(camera, points[:, 0] / points[:, 2], points[:, 1] / points[:, 2])
        expected = np.stack([u - region.offset_x_px, v - region.offset_y_px], axis=1)
        for place in expected:
            assert np.linalg.norm(centres - place, axis=1).min() < 0.15


def centroids(image):
    """Number of bright blobs and the middles of their outlines (n, 2): shading has no say."""
    count, _, _, centres = cv2.connectedComponentsWithStats((image > 40).astype(np.uint8))
    return count - 1, centres[1:]


def test_true_depth_of_a_plane_is_what_the_calibration_says(balls):
    renderer, poses, _ = balls
    true = RIG.calibration
    pinhole = rectifier_for(true, LEFT, RIGHT).pinhole
    view = true_view(RIG, renderer.bodies, poses, true, pinhole)
    u, v = np.meshgrid(np.arange(pinhole.width_px), np.arange(pinhole.height_px))
    rays = np.stack(
        [
            (u - pinhole.centre_x_px) / pinhole.focal_px,
            (v - pinhole.centre_y_px) / pinhole.focal_px,
            np.ones(u.shape),
        ],
        axis=-1,
    )
    points = T_base_camera(true).apply(rays * view.depth_m[..., None].astype(float))
    on_floor = np.abs(points[..., 2] - 0.05) < 1e-3
    assert on_floor.mean() > 0.98
    assert np.abs(points[on_floor][:, 2] - 0.05).max() < 2e-6
    assert (view.part == -1).all()
    assert not view.is_measurable.any()


def test_a_region_is_the_crop_of_a_larger_one(balls):
    renderer, poses, buffers = balls
    inner = Region(900, 420, 200, 160)
    small = renderer.buffers(poses, inner, RIGHT)
    shot = Exposure(pattern=2)
    whole = renderer.images(buffers, (LEFT, RIGHT), shot)[0]
    part = renderer.images(small, (inner, RIGHT), shot)[0]
    np.testing.assert_array_equal(part, whole[70:230, 100:300])


def test_the_same_key_gives_the_same_bits_at_any_thread_count(balls):
    renderer, poses, _ = balls
    seen = []
    before = cv2.getNumThreads()
    try:
        for threads in (1, 2):
            cv2.setNumThreads(threads)
            buffers = renderer.buffers(poses, LEFT, RIGHT)
            images = renderer.images(buffers, (LEFT, RIGHT), Exposure(3, noise_key=(5, 9)))
            seen.append(b"".join(image.tobytes() for image in images))
    finally:
        cv2.setNumThreads(before)
    assert seen[0] == seen[1]


def test_noise_differs_between_shots_cameras_and_worlds_but_not_the_sensors_own_map(balls):
    renderer, _, buffers = balls
    regions = (LEFT, RIGHT)
    clean = renderer.images(buffers, regions, Exposure(1))

    def noise(key):
        images = renderer.images(buffers, regions, Exposure(1, noise_key=key))
        return [a.astype(float) - b for a, b in zip(images, clean, strict=True)]

    first, second, third = noise((0, 0)), noise((0, 1)), noise((1, 0))
    assert not np.array_equal(first[0], second[0])
    assert not np.array_equal(first[0], third[0])
    assert np.corrcoef(first[0].ravel(), first[1].ravel())[0, 1] < 0.05
    assert 0.2 < first[0].std() < 2.0


def test_patterns_are_cyclic_shifts_and_the_dark_shows_ambient_light_only(balls):
    renderer, _, buffers = balls
    regions = (LEFT, RIGHT)
    images = [renderer.images(buffers, regions, Exposure(k))[0] for k in (0, 1, 0)]
    dark = renderer.images(buffers, regions, Exposure(None))[0]
    np.testing.assert_array_equal(images[0], images[2])
    assert not np.array_equal(images[0], images[1])
    assert dark.mean() < 0.5 * images[0].mean()
    u, v = np.meshgrid(np.arange(50, dtype=np.float32), np.arange(40, dtype=np.float32))
    du, dv = patterns.shift_px(5)
    shifted = patterns.lookup(5, u, v, (1280, 800))
    np.testing.assert_allclose(shifted, patterns.lookup(0, u + du, v + dv, (1280, 800)), atol=1e-5)


def test_exposure_scales_and_clips(balls):
    renderer, _, buffers = balls
    regions = (LEFT, RIGHT)
    short, double, burnt = (
        renderer.images(buffers, regions, Exposure(0, exposure_s=s))[0].astype(float)
        for s in (0.010, 0.020, 3.0)
    )
    usable = (double < 250) & (short > 5)
    assert np.median(double[usable] / short[usable]) == pytest.approx(2.0, abs=0.06)
    assert (burnt == 255).mean() > 0.5


@pytest.mark.parametrize(("bits", "kind"), [(8, np.uint8), (10, np.uint16), (12, np.uint16)])
def test_more_bits_show_the_same_picture_finer(balls, bits, kind):
    renderer, _, buffers = balls
    fine = StereoRenderer(RIG, renderer.bodies, Sensor(bits=bits))
    image = fine.images(buffers, (LEFT, RIGHT), Exposure(0))[0]
    eight = renderer.images(buffers, (LEFT, RIGHT), Exposure(0))[0]
    assert image.dtype == kind
    assert image.max() < 2**bits
    scale = (2**bits - 1) / 255
    assert np.abs(image / scale - eight).max() <= 0.501 + 0.5 / scale


PARTS = """<mujoco><worldbody>
<geom type="plane" size="2 2 .1" rgba=".6 .6 .6 1"/>
<body name="part0" pos=".55 0 .02"><freejoint/><geom type="cylinder" size=".002 .002"/></body>
<body name="part1" pos=".55 0 .10" euler="90 0 0"><freejoint/>
  <geom type="cylinder" size=".002 .002"/></body>
</worldbody></mujoco>"""


def test_parts_are_drawn_with_their_mesh_and_hide_each_other():
    bodies, poses = scene(PARTS, cylinder(0.02, 0.04))
    true = RIG.calibration
    pinhole = rectifier_for(true, LEFT, RIGHT).pinhole
    view = true_view(RIG, bodies, poses, true, pinhole)
    shares = visible_shares(RIG, bodies, poses, true, pinhole)
    assert (view.part == 1).sum() > 5_000
    assert shares[1] == 1.0
    assert shares[0] < 0.6
    assert view.is_interior.sum() < view.is_measurable.sum() < (view.part >= 0).sum()


WALL = """<mujoco><worldbody>
<body name="part0" pos=".55 0 .02"><freejoint/><geom type="box" size=".1 .1 .01"/></body>
<geom type="box" size=".1 .002 .08" pos=".55 {y} .12"/>
</worldbody></mujoco>"""


def test_what_a_wall_hides_from_the_right_camera_is_not_measurable():
    """The right camera is on the side of negative y, the left one on that of positive y."""
    true = RIG.calibration
    pinhole = rectifier_for(true, LEFT, RIGHT).pinhole
    rows_of_wall = {}
    for y in (-0.06, 0.06):
        bodies, poses = scene(WALL.format(y=y), box((0.1, 0.1, 0.01)))
        view = true_view(RIG, bodies, poses, true, pinhole)
        rows_of_wall[y] = (view.part >= 0).sum() - view.is_measurable.sum()
    assert rows_of_wall[0.06] > 500
    assert rows_of_wall[-0.06] > 500


def test_what_lies_in_the_projectors_shadow_is_not_measurable():
    """The lamp stands 30 mm farther from the robot than the cameras, which share one x."""
    text = (
        WALL.format(y=0).replace(".1 .002 .08", ".002 .1 .08").replace('".55 0 .12', '".48 0 .12')
    )
    bodies, poses = scene(text, box((0.1, 0.1, 0.01)))
    true = RIG.calibration
    pinhole = rectifier_for(true, LEFT, RIGHT).pinhole
    view = true_view(RIG, bodies, poses, true, pinhole)
    assert (view.part >= 0).sum() - view.is_measurable.sum() > 1_000


BAR = """<mujoco><worldbody>
<geom type="plane" size="2 2 .1"/>
<body name="bar" pos="{place}"><freejoint/><geom type="box" size=".02 .1 .02"/></body>
</worldbody></mujoco>"""


@pytest.mark.parametrize(
    ("place", "counts"),
    [
        (".55 0 .1", True),  # in the picture
        (".62 -.02 .6", True),  # between lamp and picture, seen by nobody
        (".3 -.5 .2", False),  # over the tray
        (".55 0 1.2", False),  # above the rig
        ("-.2 .1 .5", False),  # behind the arm
    ],
)
def test_only_what_can_change_a_picture_is_cast_again(place, counts):
    renderer = StereoRenderer(RIG, scene(BAR.format(place=place))[0])
    _, before = scene(BAR.format(place=place))
    _, after = scene(BAR.format(place=place))
    assert renderer.is_same_picture(before, after, LEFT, RIGHT)
    after.geom_m[1] += 5e-3
    assert renderer.is_same_picture(before, after, LEFT, RIGHT) is not counts
    if not counts:
        pictures = [
            renderer.images(renderer.buffers(poses, LEFT, RIGHT), (LEFT, RIGHT), Exposure(0))
            for poses in (before, after)
        ]
        assert np.array_equal(pictures[0], pictures[1])
