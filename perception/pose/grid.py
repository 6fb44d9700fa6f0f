"""The distance table of a part that is no solid of revolution, kept in the user's cache folder."""

import hashlib
import os
import tempfile
import zipfile
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from hal.errors import ConfigError
from perception.parts import Part
from perception.pose.field import GridField

__all__ = ["cache_folder", "grid_field"]

PADDING_M = 0.008
STEP_M = 0.0005
MOST_CELLS = 6_000_000
LAYOUT = 2


def cache_folder() -> Path:
    """Where tables are kept: ``$XDG_CACHE_HOME/binpick/fields``, else under ``~/.cache``."""
    base = os.environ.get("XDG_CACHE_HOME", "")
    root = Path(base) if Path(base).is_absolute() else Path.home() / ".cache"
    return root / "binpick" / "fields"


def grid_field(part: Part) -> GridField:
    """Return the table of ``part``, from the cache when the same surface was tabulated before.

    Raises
    ------
    ConfigError
        There is no cached table and the ray caster of the ``sim`` extra is not installed.
    """
    low, high = part.vertices_m.min(axis=0) - PADDING_M, part.vertices_m.max(axis=0) + PADDING_M
    volume_m3 = float(np.prod(high - low))
    step_m = max(STEP_M, float(np.cbrt(volume_m3 / MOST_CELLS)))
    shape = tuple(int(n) for n in np.ceil((high - low) / step_m).astype(int) + 1)
    digest = hashlib.sha256()
    digest.update(repr((LAYOUT, PADDING_M, step_m, shape)).encode())
    digest.update(np.ascontiguousarray(part.vertices_m).tobytes())
    digest.update(np.ascontiguousarray(part.triangles).tobytes())
    path = cache_folder() / f"{digest.hexdigest()}.npz"
    distance_m = _load(path, shape)
    if distance_m is None:
        distance_m = _cast(part, low, step_m, shape)
        _store(path, distance_m)
    gradient = np.stack([np.gradient(distance_m, step_m, axis=k) for k in range(3)], axis=-1)
    table = np.concatenate([distance_m[..., None], gradient], axis=-1).astype(np.float32)
    return GridField(table, low, step_m, part.max_radius_m, part.length_m / 2)


def _cast(
    part: Part, low: NDArray[np.float64], step_m: float, shape: tuple[int, ...]
) -> NDArray[np.float32]:
    try:
        import open3d as o3d  # noqa: PLC0415 - two seconds, and only when needed
    except ImportError as error:
        raise ConfigError(
            "a part that is no solid of revolution needs the 'sim' extra (open3d)",
            source=part.name,
        ) from error
    scene = o3d.t.geometry.RaycastingScene(nthreads=1)
    scene.add_triangles(
        o3d.core.Tensor(part.vertices_m.astype(np.float32)),
        o3d.core.Tensor(part.triangles.astype(np.uint32)),
    )
    axes = [low[k] + step_m * np.arange(shape[k]) for k in range(3)]
    slabs = []
    for x in axes[0].tolist():
        points = np.stack(np.meshgrid([x], axes[1], axes[2], indexing="ij"), axis=-1)
        slabs.append(
            scene.compute_signed_distance(o3d.core.Tensor(points.astype(np.float32))).numpy()
        )
    return np.concatenate(slabs)


def _load(path: Path, shape: tuple[int, ...]) -> NDArray[np.float32] | None:
    """Read a table; anything wrong with the file means that there is none."""
    try:
        with np.load(path, allow_pickle=False) as stored:
            distance_m = np.asarray(stored["distance_m"], np.float32)
    except (OSError, ValueError, KeyError, zipfile.BadZipFile):
        return None
    return distance_m if distance_m.shape == shape and np.isfinite(distance_m).all() else None


def _store(path: Path, distance_m: NDArray[np.float32]) -> None:
    """Write beside, then rename: a reader sees all of it or nothing. A full disk is no error."""
    name = ""
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.NamedTemporaryFile(dir=path.parent, suffix=".part", delete=False) as file:
            name = file.name
            np.savez(file, distance_m=distance_m)
        os.replace(name, path)
    except OSError:
        Path(name).unlink(missing_ok=True) if name else None
