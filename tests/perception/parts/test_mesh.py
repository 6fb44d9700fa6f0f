"""Meshes from files: the axis is found wherever it lies, and what is broken is refused."""

import struct

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hal import rotation_from_rotvec
from hal.errors import ConfigError
from perception.parts import load_part
from perception.parts.formats import read_obj, read_ply, read_stl

SHAFT = load_part("shaft")
GEAR = load_part("gear-small")


def stl(vertices, triangles):
    head = b"made for a test".ljust(80) + struct.pack("<I", len(triangles))
    facet = struct.Struct("<12fH")
    return head + b"".join(
        facet.pack(0, 0, 0, *corners.ravel(), 0) for corners in vertices[triangles]
    )


def text_stl(vertices, triangles):
    lines = ["solid test"]
    for corners in vertices[triangles]:
        lines += ["facet normal 0 0 0", "outer loop"]
        lines += [f"vertex {x:.9g} {y:.9g} {z:.9g}" for x, y, z in corners]
        lines += ["endloop", "endfacet"]
    return "\n".join([*lines, "endsolid test"]).encode()


def obj(vertices, triangles):
    lines = [f"v {x:.9g} {y:.9g} {z:.9g}" for x, y, z in vertices]
    lines += [f"f {a + 1}/7 {b + 1} {c - len(vertices)}" for a, b, c in triangles]
    return "\n".join(lines).encode()


def ply(vertices, triangles, *, style="binary_little_endian"):
    order = ">" if style == "binary_big_endian" else "<"
    head = (
        f"ply\nformat {style} 1.0\ncomment test\nelement vertex {len(vertices)}\n"
        "property float x\nproperty float y\nproperty float z\n"
        f"element face {len(triangles)}\nproperty list uchar int vertex_indices\nend_header\n"
    ).encode()
    if style == "ascii":
        rows = [" ".join(f"{value:.9g}" for value in vertex) for vertex in vertices]
        rows += ["3 " + " ".join(map(str, face)) for face in triangles]
        return head + "\n".join(rows).encode()
    face = struct.Struct(order + "B3i")
    return (
        head
        + vertices.astype(order + "f4").tobytes()
        + b"".join(face.pack(3, *map(int, corners)) for corners in triangles)
    )


WRITERS = {
    "a.stl": stl,
    "b.stl": text_stl,
    "c.obj": obj,
    "d.ply": ply,
    "e.ply": lambda v, t: ply(v, t, style="ascii"),
    "f.ply": lambda v, t: ply(v, t, style="binary_big_endian"),
}


def write(folder, name, vertices_m, triangles, *, scale=1000.0):
    path = folder / name
    path.write_bytes(WRITERS[name](vertices_m * scale, triangles))
    return str(path)


@pytest.mark.parametrize("name", sorted(WRITERS))
def test_every_format_gives_the_same_part(tmp_path, name):
    part = load_part(write(tmp_path, name, SHAFT.vertices_m, SHAFT.triangles))
    assert (part.fold, part.is_reversible) == (0, False)
    assert part.mass_kg == pytest.approx(SHAFT.mass_kg, rel=1e-5)
    assert part.profile.z_edges_m == pytest.approx(SHAFT.profile.z_edges_m, abs=2e-5)
    assert part.profile.radii_m == pytest.approx(SHAFT.profile.radii_m, abs=2e-5)


@pytest.mark.parametrize("part", [SHAFT, GEAR], ids=["shaft", "gear"])
def test_a_turned_and_shifted_file_gives_the_same_part_and_says_how(tmp_path, part):
    rotation = rotation_from_rotvec([0.4, -0.7, 0.3])
    moved = part.vertices_m @ rotation.T + [0.03, -0.01, 0.02]
    found = load_part(write(tmp_path, "a.stl", moved, part.triangles))
    assert (found.fold, found.is_reversible) == (part.fold, part.is_reversible)
    back = found.T_object_mesh.apply(np.array([[0.03, -0.01, 0.02]]))[0]
    assert np.abs(back).max() < 2e-6
    axis = found.T_object_mesh.rotation @ rotation[:, 2]
    assert abs(axis[2]) == pytest.approx(1, abs=1e-9)
    assert found.T_object_mesh.apply(moved) == pytest.approx(found_order(found, moved), abs=1e-6)


def found_order(found, moved):
    """Return the found part's vertices in the order of the file's."""
    local = found.T_object_mesh.apply(moved)
    nearest = ((local[:, None] - found.vertices_m[None]) ** 2).sum(axis=2).argmin(axis=1)
    return found.vertices_m[nearest]


def test_metres_are_read_as_metres(tmp_path):
    path = write(tmp_path, "c.obj", SHAFT.vertices_m, SHAFT.triangles, scale=1.0)
    assert load_part(path, unit="m").length_m == pytest.approx(0.1)
    with pytest.raises(ConfigError, match="say unit=m"):
        load_part(path)


def test_an_inside_out_mesh_is_turned_and_says_so(tmp_path):
    part = load_part(write(tmp_path, "a.stl", SHAFT.vertices_m, SHAFT.triangles[:, ::-1]))
    assert part.solid.volume_m3 > 0
    assert "inside out" in part.notes[0]


def cut(data):
    return data[: len(data) * 2 // 3]


def crop(vertices, triangles):
    return vertices, triangles[:-5]


def keyway(vertices, triangles):
    near = (vertices[:, 0] > 0.0095) & (np.abs(vertices[:, 1]) < 0.003)
    return np.where(near[:, None], vertices * [0.8, 1, 1], vertices), triangles


def one_turned(vertices, triangles):
    triangles = triangles.copy()
    triangles[7] = triangles[7, ::-1]
    return vertices, triangles


def not_finite(vertices, triangles):
    vertices = vertices.copy()
    vertices[3, 1] = np.nan
    return vertices, triangles


def doubled(vertices, triangles):
    return vertices, np.concatenate([triangles, triangles])


@pytest.mark.parametrize(
    ("spoil", "reason"),
    [
        (crop, "not watertight"),
        (keyway, "no axis of symmetry"),
        (one_turned, "badly oriented"),
        (not_finite, "not finite"),
        (doubled, "join over two triangles"),
    ],
)
def test_a_broken_mesh_is_refused_with_the_reason(tmp_path, spoil, reason):
    path = write(tmp_path, "a.stl", *spoil(SHAFT.vertices_m, SHAFT.triangles))
    with pytest.raises(ConfigError, match=reason) as caught:
        load_part(path)
    assert caught.value.source == path
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("name", ["a.stl", "b.stl", "d.ply", "e.ply", "f.ply"])
def test_a_file_that_ends_early_is_refused(tmp_path, name):
    path = tmp_path / name
    path.write_bytes(cut(WRITERS[name](SHAFT.vertices_m * 1000, SHAFT.triangles)))
    with pytest.raises(ConfigError, match=r"bytes|ends before|make triangles|cut off|are there"):
        load_part(str(path))


@pytest.mark.parametrize(
    ("name", "data", "reason"),
    [
        ("x.stl", b"", "empty"),
        ("x.stl", b"hello", "too few"),
        ("x.stl", bytes(80) + b"\xff\xff\xff\xff" + bytes(100), "bytes"),
        ("x.ply", b"ply\nformat ascii 1.0\nelement vertex 99999999999\nend_header\n", "no vertex"),
        (
            "x.ply",
            b"ply\nformat binary_little_endian 1.0\nelement vertex 5999999\nproperty double x\n"
            b"property double y\nproperty double z\nelement face 1\n"
            b"property list uchar int vertex_indices\nend_header\n\0\0",
            "cut off",
        ),
        (
            "x.ply",
            b"ply\nformat ascii 1.0\nelement vertex 999999999\nelement face 1\nend_header\n",
            "at most",
        ),
        ("x.obj", b"v 0 0 0\nf 1 2 3\n", "names vertex"),
        ("x.obj", b"v 0 0 0\n", "no faces"),
        ("x.obj", b"v a b c\nf 1 1 1\n", "as numbers"),
        ("x.step", b"ISO-10303-21;", "meshes are"),
    ],
)
def test_rubbish_is_refused_with_the_reason(tmp_path, name, data, reason):
    path = tmp_path / name
    path.write_bytes(data)
    with pytest.raises(ConfigError, match=reason):
        load_part(str(path))


def test_a_missing_file_is_said_to_be_missing(tmp_path):
    with pytest.raises(ConfigError, match="no such file"):
        load_part(str(tmp_path / "gone.stl"))


PIECES = [
    b"ply\n", b"format ascii 1.0\n", b"format binary_little_endian 1.0\n", b"element vertex 3\n",
    b"element face 1\n", b"element face 4000000000\n", b"property float x\n", b"end_header\n",
    b"property float y\n", b"property float z\n", b"property list uchar int vertex_indices\n",
    b"3 0 1 2\n", b"0 0 1\n", b"solid\n", b"facet\n", b"vertex 1 2 3\n", b"endsolid", b"v 1 2 3\n",
    b"f 1 2 3\n", b"f 1/2 -1 9999999999999999999999\n", b"nan inf 1e999\n", b"\xff\xff",
]  # fmt: skip
soup = st.lists(st.one_of(st.sampled_from(PIECES), st.binary(max_size=8)), max_size=20)


@settings(max_examples=300, deadline=None)
@given(soup.map(b"".join))
def test_rubbish_makes_a_mesh_or_a_reason_and_nothing_else(data):
    for read in (read_stl, read_obj, read_ply):
        try:
            vertices, triangles = read(data)
        except ValueError:
            continue
        assert triangles.max() < len(vertices)


def test_a_ball_and_a_cube_have_no_axis_of_their_own(tmp_path):
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)]) * 0.02
    faces = np.array(
        [[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1],
         [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]]
    )  # fmt: skip
    with pytest.raises(ConfigError, match="more than one axis"):
        load_part(write(tmp_path, "a.stl", corners, faces))
    bar = load_part(write(tmp_path, "c.obj", corners * [1, 3, 1], faces))
    assert (bar.fold, bar.is_reversible) == (4, True)
    assert bar.length_m == pytest.approx(0.06)
