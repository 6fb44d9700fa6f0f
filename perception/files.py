"""Calibration files and shot folders: read with clear errors, written whole or not at all.

``docs/reference/calibration-file.md`` and ``docs/reference/shot-folder.md`` describe them.
"""

import json
import os
import shutil
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal, TypeVar

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from hal import (
    CameraIntrinsics,
    Region,
    StereoCalibration,
    StereoCapture,
    StereoShot,
    Transform,
)
from hal.errors import ConfigError
from perception.png import read_png, write_png
from perception.quality import check_rig

__all__ = ["ShotFolder", "read_calibration", "read_shot", "write_calibration", "write_shot"]

SHOT_FILE = "shot.json"
CALIBRATION_FILE = "calibration.json"
TRUTH_FILE = "truth.json"

M = TypeVar("M", bound=BaseModel)
Side = Annotated[float, Field(allow_inf_nan=False)]
Vector = tuple[Side, Side, Side]
Distortion = tuple[Side, Side, Side, Side, Side]
Name = Annotated[str, Field(pattern=r"^[A-Za-z0-9_][A-Za-z0-9_.-]*\.png$")]


class _Record(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class _Serials(_Record):
    left: str = Field(min_length=1)
    right: str = Field(min_length=1)


class _Pose(_Record):
    quaternion_wxyz: tuple[Side, Side, Side, Side]
    translation_m: Vector

    @classmethod
    def of(cls, pose: Transform) -> "_Pose":
        w, x, y, z = (float(q) for q in pose.quaternion_wxyz)
        tx, ty, tz = (float(t) for t in pose.translation_m)
        return cls(quaternion_wxyz=(w, x, y, z), translation_m=(tx, ty, tz))


class _Camera(_Record):
    width_px: int = Field(ge=16, le=65536)
    height_px: int = Field(ge=16, le=65536)
    focal_x_px: float = Field(gt=0, le=1e6)
    focal_y_px: float = Field(gt=0, le=1e6)
    centre_x_px: Side
    centre_y_px: Side
    distortion: Distortion


class _Calibration(_Record):
    format: Literal["binpick-stereo-calibration"]
    version: Literal[1]
    serials: _Serials
    left: _Camera
    right: _Camera
    T_left_right: _Pose
    T_base_left: _Pose


class _Region(_Record):
    offset_x_px: int = Field(ge=0)
    offset_y_px: int = Field(ge=0)
    width_px: int = Field(ge=1)
    height_px: int = Field(ge=1)


class _Shot(_Record):
    left: Name
    right: Name
    left_region: _Region
    right_region: _Region
    block_id: int = Field(ge=0)
    stamp_ns: int = Field(ge=0)
    exposure_s: float = Field(gt=0)


class _Shots(_Record):
    format: Literal["binpick-shot"]
    version: Literal[1]
    serials: _Serials
    bits: int = Field(ge=8, le=16)
    shots: tuple[_Shot, ...] = Field(min_length=1, max_length=64)


@dataclass(frozen=True, eq=False)
class ShotFolder:
    """What a shot folder holds; ``truth`` is what a simulator knew, for scoring only."""

    capture: StereoCapture
    calibration: StereoCalibration
    truth: dict[str, Any] | None = None


def read_calibration(path: Path) -> StereoCalibration:
    """Read a calibration file.

    Raises
    ------
    ConfigError
        Missing, not JSON, or a key is unknown, missing or out of range.
    """
    record = _read(path, _Calibration)
    poses = {"T_left_right": record.T_left_right, "T_base_left": record.T_base_left}
    for key, pose in poses.items():
        norm = float(np.linalg.norm(pose.quaternion_wxyz))
        if abs(norm - 1) > 1e-3:
            raise ConfigError(
                f"length is {norm:.4f}; a rotation has length 1",
                source=str(path),
                key=f"{key}.quaternion_wxyz",
            )
    if np.linalg.norm(record.T_left_right.translation_m) < 1e-3:
        raise ConfigError(
            "the two cameras are less than 1 mm apart",
            source=str(path),
            key="T_left_right.translation_m",
        )
    return StereoCalibration(
        serials=(record.serials.left, record.serials.right),
        left=CameraIntrinsics(**record.left.model_dump()),
        right=CameraIntrinsics(**record.right.model_dump()),
        T_left_right=_transform("left", "right", record.T_left_right),
        T_base_left=_transform("base", "left", record.T_base_left),
        version=record.version,
    )


def write_calibration(path: Path, calibration: StereoCalibration) -> None:
    """Write a calibration file; an old one is replaced in one step."""
    record = _Calibration(
        format="binpick-stereo-calibration",
        version=1,
        serials=_Serials(left=calibration.serials[0], right=calibration.serials[1]),
        left=_camera(calibration.left),
        right=_camera(calibration.right),
        T_left_right=_Pose.of(calibration.T_left_right),
        T_base_left=_Pose.of(calibration.T_base_left),
    )
    _write(path, record.model_dump())


def read_shot(folder: Path, *, calibration: Path | None = None) -> ShotFolder:
    """Read a shot folder, with its own calibration file or another one.

    Raises
    ------
    ConfigError
        A file is missing, damaged or of the wrong size, left and right do not pair, or the
        calibration belongs to other cameras.
    """
    if not folder.is_dir():
        raise ConfigError("no such folder", source=str(folder))
    record = _read(folder / SHOT_FILE, _Shots)
    _check_pairs(folder, record)
    capture = StereoCapture(
        shots=tuple(_read_pair(folder, shot, record.bits) for shot in record.shots),
        serials=(record.serials.left, record.serials.right),
        bits=record.bits,
    )
    calibration_path = calibration or folder / CALIBRATION_FILE
    stereo = read_calibration(calibration_path)
    check_rig(capture, stereo, source=str(calibration_path))
    truth_path = folder / TRUTH_FILE
    truth = _json(truth_path) if truth_path.exists() else None
    return ShotFolder(capture, stereo, truth)


def write_shot(
    folder: Path,
    capture: StereoCapture,
    calibration: StereoCalibration,
    *,
    truth: dict[str, Any] | None = None,
) -> None:
    """Write a shot folder: it appears whole, or not at all.

    Raises
    ------
    ConfigError
        The folder exists already, or cannot be written.
    """
    if folder.exists():
        raise ConfigError("exists already: name another folder or remove it", source=str(folder))
    try:
        folder.parent.mkdir(parents=True, exist_ok=True)
        growing = Path(tempfile.mkdtemp(prefix=f".{folder.name}.", dir=folder.parent))
    except OSError as error:
        raise ConfigError(f"cannot be made ({error.strerror})", source=str(folder)) from error
    try:
        _fill(growing, capture, calibration, truth)
        growing.chmod(0o755)
        growing.rename(folder)
    except OSError as error:
        raise ConfigError(f"cannot be written ({error.strerror})", source=str(folder)) from error
    finally:
        shutil.rmtree(growing, ignore_errors=True)


def _fill(
    folder: Path,
    capture: StereoCapture,
    calibration: StereoCalibration,
    truth: dict[str, Any] | None,
) -> None:
    shots = []
    for number, shot in enumerate(capture.shots):
        names = (f"left_{number:02d}.png", f"right_{number:02d}.png")
        write_png(folder / names[0], shot.left)
        write_png(folder / names[1], shot.right)
        shots.append(
            _Shot(
                left=names[0],
                right=names[1],
                left_region=_Region(**vars(shot.left_region)),
                right_region=_Region(**vars(shot.right_region)),
                block_id=shot.block_id,
                stamp_ns=shot.stamp_ns,
                exposure_s=shot.exposure_s,
            )
        )
    record = _Shots(
        format="binpick-shot",
        version=1,
        serials=_Serials(left=capture.serials[0], right=capture.serials[1]),
        bits=capture.bits,
        shots=tuple(shots),
    )
    _write(folder / SHOT_FILE, record.model_dump())
    write_calibration(folder / CALIBRATION_FILE, calibration)
    if truth is not None:
        _write(folder / TRUTH_FILE, truth)


def _check_pairs(folder: Path, record: _Shots) -> None:
    on_disk = [len(list(folder.glob(f"{side}_*.png"))) for side in ("left", "right")]
    if on_disk != [len(record.shots)] * 2:
        raise ConfigError(
            f"{on_disk[0]} left and {on_disk[1]} right images, {SHOT_FILE} names "
            f"{len(record.shots)} pairs: copy the folder again",
            source=str(folder),
        )


def _read_pair(folder: Path, shot: _Shot, bits: int) -> StereoShot:
    regions = [Region(**region.model_dump()) for region in (shot.left_region, shot.right_region)]
    images = [read_png(folder / name) for name in (shot.left, shot.right)]
    for name, image, region in zip((shot.left, shot.right), images, regions, strict=True):
        wanted = (region.height_px, region.width_px)
        if image.shape != wanted:
            raise ConfigError(
                f"is {image.shape[1]} x {image.shape[0]} px, its region {wanted[1]} x {wanted[0]}",
                source=str(folder / name),
            )
        if (image.dtype == np.uint8) != (bits == 8) or int(image.max()) >= 2**bits:
            raise ConfigError(
                f"is {image.dtype} up to {image.max()}, {SHOT_FILE} says {bits} bits",
                source=str(folder / name),
            )
    return StereoShot(
        left=images[0],
        right=images[1],
        left_region=regions[0],
        right_region=regions[1],
        block_id=shot.block_id,
        stamp_ns=shot.stamp_ns,
        exposure_s=shot.exposure_s,
    )


def _camera(camera: CameraIntrinsics) -> _Camera:
    return _Camera(**vars(camera))


def _transform(parent: str, child: str, pose: _Pose) -> Transform:
    return Transform.from_quaternion(parent, child, pose.quaternion_wxyz, pose.translation_m)


def _json(path: Path) -> Any:
    try:
        return json.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError as error:
        raise ConfigError("no such file", source=str(path)) from error
    except OSError as error:
        raise ConfigError(f"cannot be read ({error.strerror})", source=str(path)) from error
    except ValueError as error:
        raise ConfigError(f"is not JSON ({error})", source=str(path)) from error


def _read(path: Path, model: type[M]) -> M:
    try:
        # By way of text, because strict JSON knows tuples where strict Python does not.
        return model.model_validate_json(json.dumps(_json(path)), strict=True)
    except ValidationError as error:
        first = error.errors(include_url=False, include_input=False)[0]
        key = ".".join(str(part) for part in first["loc"])
        raise ConfigError(first["msg"], source=str(path), key=key) from error


def _write(path: Path, content: Any) -> None:
    """Write JSON beside the target, then put it in its place."""
    text = json.dumps(content, indent=2, allow_nan=False) + "\n"
    handle, name = tempfile.mkstemp(prefix=f".{path.name}.", dir=path.parent)
    try:
        with os.fdopen(handle, "w", encoding="utf-8") as stream:
            stream.write(text)
        Path(name).chmod(0o644)
        Path(name).replace(path)
    finally:
        Path(name).unlink(missing_ok=True)
