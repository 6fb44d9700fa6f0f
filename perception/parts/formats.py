"""Reading STL, PLY and OBJ: bytes to corners and triangles, nothing believed that the bytes deny.

Every count in a file is checked against the bytes that are there before anything is allocated.
A reader returns vertices (V, 3) float64 in the file's unit and triangles (F, 3); polygons are cut
into fans. It raises ``ValueError`` with the reason; the caller names the file.
"""

import io

import numpy as np
from numpy.typing import NDArray

__all__ = ["MAX_BYTES", "MAX_TRIANGLES", "read_obj", "read_ply", "read_stl"]

MAX_BYTES = 256 * 1024 * 1024
MAX_TRIANGLES = 2_000_000
MAX_HEADER_BYTES = 64 * 1024

Mesh = tuple[NDArray[np.float64], NDArray[np.int64]]

PLY_TYPES = {
    "char": "i1", "int8": "i1", "uchar": "u1", "uint8": "u1", "short": "i2", "int16": "i2",
    "ushort": "u2", "uint16": "u2", "int": "i4", "int32": "i4", "uint": "u4", "uint32": "u4",
    "float": "f4", "float32": "f4", "double": "f8", "float64": "f8",
}  # fmt: skip


def read_stl(data: bytes) -> Mesh:
    """Read an STL file, binary or text."""
    if len(data) >= 84:
        count = int.from_bytes(data[80:84], "little")
        if len(data) == 84 + 50 * count:
            return _binary_stl(data, count)
    if data.lstrip()[:5].lower() == b"solid" and b"facet" in data[:MAX_HEADER_BYTES]:
        return _text_stl(data)
    if len(data) < 84:
        raise ValueError(f"{len(data)} bytes are too few for an STL file")
    raise ValueError(
        f"an STL file of {count} triangles has {84 + 50 * count} bytes, this one {len(data)}"
    )


def _binary_stl(data: bytes, count: int) -> Mesh:
    _check_count(count, "triangles")
    record = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("extra", "<u2")])
    corners = np.frombuffer(data, record, count, 84)["corners"].astype(np.float64)
    return corners.reshape(-1, 3), np.arange(3 * count).reshape(-1, 3)


def _text_stl(data: bytes) -> Mesh:
    rows = [line.split()[1:] for line in data.splitlines() if line.lstrip()[:6] == b"vertex"]
    if not rows or len(rows) % 3:
        raise ValueError(f"{len(rows)} corners do not make triangles")
    if b"endsolid" not in data[-MAX_HEADER_BYTES:]:
        raise ValueError("the file ends before 'endsolid'")
    _check_count(len(rows) // 3, "triangles")
    corners = _numbers(rows, 3, "vertex")
    return corners, np.arange(len(corners)).reshape(-1, 3)


def read_obj(data: bytes) -> Mesh:
    """Read the v and f lines of a Wavefront OBJ file."""
    vertices: list[list[bytes]] = []
    faces: list[list[int]] = []
    for number, line in enumerate(data.splitlines(), 1):
        words = line.split()
        if not words:
            continue
        if words[0] == b"v":
            vertices.append(words[1:4])
        elif words[0] == b"f":
            try:
                face = [int(word.split(b"/", 1)[0]) for word in words[1:]]
            except ValueError:
                raise ValueError(f"line {number}: cannot read a face") from None
            # Negative numbers count back from the vertices read so far.
            faces.append([k - 1 if k > 0 else len(vertices) + k for k in face])
    if not faces:
        raise ValueError("there are no faces in it")
    triangles = _fans(faces)
    _check_index(triangles, len(vertices))
    return _numbers(vertices, 3, "v"), triangles


def read_ply(data: bytes) -> Mesh:
    """Read a PLY file, text or binary, either byte order."""
    end = data.find(b"end_header", 0, MAX_HEADER_BYTES)
    stop = data.find(b"\n", end) + 1
    if not data.startswith(b"ply") or end < 0 or stop == 0:
        raise ValueError("there is no PLY header")
    style, elements = _ply_header(data[:end].decode("ascii", "replace").splitlines()[1:])
    body = data[stop:]
    if style == "ascii":
        return _text_ply(body, elements)
    return _binary_ply(body, elements, "<" if style == "binary_little_endian" else ">")


class _Element:
    """One element of a PLY header: name, count and properties (name, type, list count type)."""

    def __init__(self, name: str, count: int) -> None:
        self.name = name
        self.count = count
        self.properties: list[tuple[str, str, str]] = []

    def column(self, name: str) -> int:
        """Where a property stands."""
        names = [item[0] for item in self.properties]
        if name not in names:
            raise ValueError(f"the {self.name} element has no {name}")
        return names.index(name)


def _ply_header(lines: list[str]) -> tuple[str, list[_Element]]:
    style = ""
    elements: list[_Element] = []
    for line in lines:
        words = line.split()
        match words[:1]:
            case ["format"]:
                style = words[1] if len(words) > 1 else ""
            case ["element"] if len(words) == 3 and words[2].isdigit():
                elements.append(_Element(words[1], int(words[2])))
            case ["property"] if elements and len(words) == 3 and words[1] in PLY_TYPES:
                elements[-1].properties.append((words[2], PLY_TYPES[words[1]], ""))
            case ["property"] if (
                elements
                and len(words) == 5
                and words[1] == "list"
                and words[2] in PLY_TYPES
                and words[3] in PLY_TYPES
            ):
                kinds = PLY_TYPES[words[3]], PLY_TYPES[words[2]]
                elements[-1].properties.append((words[4], *kinds))
            case [] | ["comment"] | ["obj_info"]:
                pass
            case _:
                raise ValueError(f"cannot read the header line {line[:60]!r}")
    if style not in ("ascii", "binary_little_endian", "binary_big_endian"):
        raise ValueError(f"unknown PLY format {style!r}")
    names = [element.name for element in elements]
    if "vertex" not in names or "face" not in names:
        raise ValueError("there are no vertex and face elements in it")
    for element in elements:
        _check_count(element.count, element.name)
    return style, elements


def _text_ply(body: bytes, elements: list[_Element]) -> Mesh:
    lines = [line for line in body.splitlines() if line.strip()]
    vertices = np.zeros((0, 3))
    faces: list[list[int]] = []
    first = 0
    for element in elements:
        rows = [line.split() for line in lines[first : first + element.count]]
        if len(rows) < element.count:
            raise ValueError(f"{len(rows)} of {element.count} {element.name} lines are there")
        first += element.count
        if element.name == "vertex":
            columns = [element.column(name) for name in "xyz"]
            try:
                picked = [[row[c] for c in columns] for row in rows]
            except IndexError:
                raise ValueError("a vertex line is too short") from None
            vertices = _numbers(picked, 3, "vertex")
        elif element.name == "face":
            faces = [_text_face(row) for row in rows]
    triangles = _fans(faces)
    _check_index(triangles, len(vertices))
    return vertices, triangles


def _text_face(row: list[bytes]) -> list[int]:
    try:
        count = int(row[0])
        face = [int(word) for word in row[1 : 1 + count]]
    except (ValueError, IndexError):
        raise ValueError("cannot read a face line") from None
    if len(face) != count:
        raise ValueError("a face line is too short")
    return face


def _binary_ply(body: bytes, elements: list[_Element], order: str) -> Mesh:
    vertices = np.zeros((0, 3))
    triangles = np.zeros((0, 3), np.int64)
    stream = io.BytesIO(body)
    for element in elements:
        lists = [item for item in element.properties if item[2]]
        if not lists:
            record = np.dtype([(name, order + kind) for name, kind, _ in element.properties])
            raw = stream.read(record.itemsize * element.count)
            if len(raw) < record.itemsize * element.count:
                raise ValueError(f"the {element.name} data is cut off")
            if element.name == "vertex":
                table = np.frombuffer(raw, record, element.count)
                for name in "xyz":
                    element.column(name)
                vertices = np.stack([table[name].astype(np.float64) for name in "xyz"], axis=1)
        elif element.name == "face":
            triangles = _binary_faces(stream, element, order)
        else:
            raise ValueError(f"lists in element {element.name} are not understood")
    _check_index(triangles, len(vertices))
    return vertices, triangles


def _binary_faces(stream: io.BytesIO, element: _Element, order: str) -> NDArray[np.int64]:
    if len(element.properties) != 1:
        raise ValueError("faces with more than their list of corners are not understood")
    _, kind, count_kind = element.properties[0]
    if kind[0] == "f" or count_kind[0] == "f":
        raise ValueError("faces are not made of whole numbers")
    start = stream.tell()
    record = np.dtype([("count", order + count_kind), ("corners", order + kind, 3)])
    raw = stream.read(record.itemsize * element.count)
    if len(raw) == record.itemsize * element.count:
        table = np.frombuffer(raw, record, element.count)
        if (table["count"] == 3).all():
            return table["corners"].astype(np.int64)
    stream.seek(start)
    count_type, corner_type = np.dtype(order + count_kind), np.dtype(order + kind)
    faces = []
    for _ in range(element.count):
        head = stream.read(count_type.itemsize)
        count = int(np.frombuffer(head, count_type)[0]) if len(head) == count_type.itemsize else -1
        tail = stream.read(corner_type.itemsize * count) if 0 <= count <= 1000 else b""
        if not 0 <= count <= 1000 or len(tail) < corner_type.itemsize * count:
            raise ValueError("the face data is cut off or makes no sense")
        faces.append(np.frombuffer(tail, corner_type).astype(np.int64).tolist())
    return _fans(faces)


def _fans(faces: list[list[int]]) -> NDArray[np.int64]:
    """Cut polygons into triangles about their first corner."""
    triangles = []
    for face in faces:
        if len(face) < 3:
            raise ValueError(f"a face of {len(face)} corners")
        triangles += [(face[0], face[k], face[k + 1]) for k in range(1, len(face) - 1)]
        if len(triangles) > MAX_TRIANGLES:
            raise ValueError(f"more than {MAX_TRIANGLES} triangles")
    try:
        return np.array(triangles, np.int64).reshape(-1, 3)
    except OverflowError:
        raise ValueError("a face names a vertex beyond all bounds") from None


def _numbers(rows: list[list[bytes]], width: int, what: str) -> NDArray[np.float64]:
    _check_count(len(rows), what)
    if any(len(row) < width for row in rows):
        raise ValueError(f"a {what} line is too short")
    try:
        return np.array([[float(word) for word in row[:width]] for row in rows])
    except ValueError:
        raise ValueError(f"cannot read a {what} line as numbers") from None


def _check_count(count: int, what: str) -> None:
    if not 0 < count <= 3 * MAX_TRIANGLES:
        raise ValueError(f"{count} {what}: at least one and at most {3 * MAX_TRIANGLES} are read")


def _check_index(triangles: NDArray[np.int64], count: int) -> None:
    if not len(triangles):
        raise ValueError("there are no faces in it")
    if triangles.min() < 0 or triangles.max() >= count:
        raise ValueError(f"a face names vertex {triangles.max()} of {count}")
