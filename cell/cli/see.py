"""``binpick see``: perception on image files."""

from pathlib import Path
from typing import Annotated, Any

import typer

from cell.cli.common import (
    JsonOption,
    Unit,
    check_writable,
    console,
    json_files,
    replacing,
    write_json,
)

__all__ = ["NAME", "command"]

NAME = "see"
PICTURES = {".png", ".jpg", ".jpeg"}


def command(
    folder: Annotated[
        Path, typer.Argument(help="A stereo shot folder; `binpick capture` makes one.")
    ],
    part: Annotated[
        str, typer.Option("--part", "--parts", help="Catalogue name, sizes or mesh file.")
    ] = "shaft",
    calibration: Annotated[
        Path | None, typer.Option(help="Calibration file, if not the folder's calibration.json.")
    ] = None,
    cell: Annotated[Path | None, typer.Option(help="Cell file: where the bin is.")] = None,
    unit: Annotated[Unit, typer.Option(help="Unit of a mesh file.")] = Unit.MILLIMETRE,
    seed: Annotated[
        int, typer.Option(min=0, help="For the choice of points; one seed, one answer.")
    ] = 0,
    picture: Annotated[
        Path | None, typer.Option(help="Write the left image with outlines here (.png, .jpg).")
    ] = None,
    json: JsonOption = None,
) -> None:
    """Find parts in a stereo shot folder and say where they are.

    Poses are of the part's own frame (of the mesh file, for a mesh) in frame `camera`, the
    rectified left camera, and in frame `base`, by the calibration's mounting. If the folder
    holds truth.json, each part's error is shown too.
    """
    from cell.config import load_cell
    from hal.errors import ConfigError
    from perception.files import read_shot
    from perception.parts import load_part
    from perception.pose import build_model
    from perception.see import see

    for path in [*([picture] if picture else []), *json_files(json)[:1]]:
        check_writable(path)
    if picture is not None and picture.suffix.lower() not in PICTURES:
        raise ConfigError("must end in .png or .jpg", source=str(picture), key="--picture")
    shot = read_shot(folder, calibration=calibration)
    chosen = load_part(part, unit=unit.value)
    box = load_cell(cell).layout.bin
    sight = see(shot.capture, shot.calibration, build_model(chosen), box, seed=seed)
    result = sight_as_json(sight, chosen)
    if shot.truth is not None:
        add_errors(result, shot.truth, chosen, source=str(folder / "truth.json"))
    if picture is not None:
        _draw(sight, chosen, box, picture)
    write_json(result, json)
    _print(result, console(json))


def sight_as_json(sight: Any, part: Any) -> dict[str, Any]:
    """Return the object of ``binpick see --json``; docs/reference/see-json.md."""
    import numpy as np

    from cell.journal import quantise

    T_object_mesh = part.T_object_mesh
    finding = sight.finding
    rows = []
    for detection in finding.detections:
        T_camera = detection.T_camera_object @ T_object_mesh
        T_base = sight.T_base_camera @ detection.T_camera_object @ T_object_mesh
        spread = np.sqrt(np.diag(detection.covariance))
        rows.append(
            {
                "part": part.name,
                "score": detection.score,
                "visible": detection.visible,
                "match": detection.match,
                "violation": detection.violation,
                "T_camera_part": T_camera.matrix,
                "T_base_part": T_base.matrix,
                "sigma_rotation_rad": spread[:3],
                "sigma_translation_m": spread[3:],
                "unobservable": list(detection.unobservable),
                "points": detection.points,
            }
        )
    answer = {
        "parts": rows,
        "is_empty": finding.is_empty,
        "leftover_m2": finding.leftover_m2,
        "rejected": [
            {
                "reason": r.reason,
                "score": r.score,
                "T_camera_part": (r.T_camera_object @ T_object_mesh).matrix,
            }
            for r in finding.rejections
        ],
        "noise_m": finding.noise_m,
    }
    rounded: dict[str, Any] = quantise(answer)
    return rounded


def add_errors(result: dict[str, Any], truth: dict[str, Any], part: Any, *, source: str) -> None:
    """Add to each part its error against the nearest true one, for scoring.

    Raises
    ------
    ConfigError
        The truth file is not what ``binpick capture --truth`` writes.
    """
    import numpy as np

    from cell.demo.errors import pose_error
    from hal import Transform
    from hal.errors import ConfigError

    def object_pose(matrix: Any) -> Transform:
        pose = Transform("camera", "mesh", np.vstack([np.asarray(matrix, float)[:3], (0, 0, 0, 1)]))
        T_mesh_object: Transform = part.T_object_mesh.inverse()
        return pose @ T_mesh_object

    try:
        true = [object_pose(row["T_camera_part"]) for row in truth["parts"]]
    except (KeyError, TypeError, ValueError) as error:
        raise ConfigError(f"is not a truth file ({error})", source=source) from error
    for row in result["parts"] if true else []:
        pose = object_pose(row["T_camera_part"])
        nearest = min(
            true, key=lambda T: float(np.linalg.norm(T.translation_m - pose.translation_m))
        )
        row["error"] = pose_error(pose, nearest, part).as_json()
    result["true_parts"] = len(true)


def _draw(sight: Any, part: Any, box: Any, path: Path) -> None:
    import cv2

    from cell.eyes import look_pictures
    from cell.report.pictures import outline_picture

    ok, data = cv2.imencode(path.suffix, outline_picture(look_pictures(1, sight, part, box)))
    assert ok
    with replacing(path) as partial:
        partial.write_bytes(data.tobytes())


def _print(result: dict[str, Any], terminal: Any) -> None:
    from rich.table import Table

    if not result["parts"]:
        what = "the bin is empty" if result["is_empty"] else "something is there, but no such part"
        terminal.print(what)
        return
    table = Table(box=None, header_style="bold")
    for name in ("#", "score", "seen", "x, y, z in base, mm", "axis in base"):
        table.add_column(name, no_wrap=True)
    has_errors = "error" in result["parts"][0]
    if has_errors:
        table.add_column("error, deg, mm", no_wrap=True)
    for number, row in enumerate(result["parts"], 1):
        T = row["T_base_part"]
        place = "  ".join(f"{T[k][3] * 1000:6.1f}" for k in range(3))
        axis = "  ".join(f"{T[k][2]:5.2f}" for k in range(3))
        cells = [f"{number}", f"{row['score']:.2f}", f"{row['visible']:.0%}", place, axis]
        if has_errors:
            error = row["error"]
            flip = "  flipped" if error["is_flipped"] else ""
            cells.append(f"{error['axis_deg']:.2f} {error['position_mm']:.2f}{flip}")
        table.add_row(*cells)
    terminal.print(table)
