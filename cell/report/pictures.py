"""Pictures of a look: outlines over the left image, depth in colours, the cloud from aside."""

import base64
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

__all__ = ["LookPictures", "as_data_uri", "cloud_picture", "depth_picture", "outline_picture"]

Picture = NDArray[np.uint8]

HUES = 12
DEPTH_MARGIN_M = 0.002
WALL_MARGIN_M = 0.003


@dataclass(frozen=True, eq=False)
class LookPictures:
    """What a look leaves behind for the report.

    ``image`` (H, W) grey levels and ``depth_m`` (H, W), NaN for none, of the rectified left
    camera; ``points_bin_m`` (H, W, 3) the same in frame ``bin``; ``labels`` (H, W) the index
    of the part that explains a pixel, -1 for none; ``outlines`` for each part its polylines,
    each (K, 2) pixel coordinates.
    """

    number: int
    image: NDArray[np.float32]
    depth_m: NDArray[np.float32]
    points_bin_m: NDArray[np.float32]
    labels: NDArray[np.int32]
    outlines: tuple[tuple[NDArray[np.float32], ...], ...]
    bin_size_m: tuple[float, float, float]

    @property
    def is_inside(self) -> NDArray[np.bool_]:
        """Which pixels show the inside of the bin, walls left out."""
        x, y, _ = np.moveaxis(self.points_bin_m, -1, 0)
        length_m, width_m, _ = self.bin_size_m
        return np.asarray(
            (np.abs(x) < length_m / 2 - WALL_MARGIN_M) & (np.abs(y) < width_m / 2 - WALL_MARGIN_M)
        )


def part_colour(index: int) -> tuple[int, int, int]:
    """BGR; neighbours differ strongly, and a part has one colour in all pictures."""
    hue = (index * 5 % HUES) / HUES
    pixel = np.array([[[hue * 179, 200, 255 if index // HUES % 2 == 0 else 190]]], np.uint8)
    b, g, r = cv2.cvtColor(pixel, cv2.COLOR_HSV2BGR)[0, 0]
    return int(b), int(g), int(r)


def outline_picture(look: LookPictures, chosen: int | None = None) -> Picture:
    """Left image with the fitted outlines; the chosen part's is drawn thick."""
    high = max(float(np.percentile(look.image, 99.5)), 1.0)
    grey = np.clip(look.image * (235 / high), 0, 255).astype(np.uint8)
    picture = cv2.cvtColor(grey, cv2.COLOR_GRAY2BGR)
    for index, lines in enumerate(look.outlines):
        thickness = 3 if index == chosen else 1
        for line in lines:
            corners = np.round(np.asarray(line) * 8).astype(np.int32).reshape(-1, 1, 2)
            cv2.polylines(
                picture, [corners], False, part_colour(index), thickness, cv2.LINE_AA, shift=3
            )
    return np.asarray(picture, np.uint8)


def depth_picture(look: LookPictures) -> Picture:
    """Near is yellow, far is violet, no depth is black; the scale spans the inside of the bin."""
    depth = look.depth_m
    known = np.isfinite(depth)
    if not known.any():
        return np.zeros((*depth.shape, 3), np.uint8)
    inside = known & look.is_inside
    near, far = np.percentile(depth[inside if inside.any() else known], [0.2, 99.8])
    span = max(float(far - near), DEPTH_MARGIN_M)
    scaled = np.clip(255 - (np.where(known, depth, far) - near) / span * 255, 0, 255)
    picture = cv2.applyColorMap(scaled.astype(np.uint8), cv2.COLORMAP_VIRIDIS)
    picture[~known] = 0
    if inside.any():
        picture[~inside] //= 3  # walls and rim: there, but not the matter
    return np.asarray(picture, np.uint8)


def cloud_picture(look: LookPictures, *, width_px: int = 720, tilt_rad: float = 0.9) -> Picture:
    """Draw the cloud as seen from in front of the bin, tilted; coloured by part."""
    known = np.isfinite(look.depth_m) & look.is_inside
    points = look.points_bin_m[known].astype(np.float64)
    labels = look.labels[known]
    if not len(points):
        return np.full((width_px // 2, width_px, 3), 24, np.uint8)
    # Look from -x of the bin, from above: right is -y, up mixes x and z.
    right = -points[:, 1]
    up = points[:, 0] * np.cos(tilt_rad) + points[:, 2] * np.sin(tilt_rad)
    towards = points[:, 2] * np.cos(tilt_rad) - points[:, 0] * np.sin(tilt_rad)
    scale = (width_px - 40) / max(float(np.ptp(right)), 0.05)
    height_px = int(np.ptp(up) * scale) + 40
    column = ((right - right.min()) * scale + 20).astype(int)
    row = height_px - 21 - ((up - up.min()) * scale).astype(int)
    order = np.argsort(towards, kind="stable")
    colours = np.array([part_colour(k) for k in range(labels.max(initial=0) + 1)] + [(92, 88, 84)])
    shade = 0.55 + 0.45 * np.clip(points[:, 2] / 0.08, 0, 1)
    picture = np.full((height_px, width_px, 3), 24, np.uint8)
    value = (colours[labels] * shade[:, None]).astype(np.uint8)
    for dy in (0, 1):
        for dx in (0, 1):
            picture[
                np.clip(row[order] + dy, 0, height_px - 1),
                np.clip(column[order] + dx, 0, width_px - 1),
            ] = value[order]
    return picture


def as_data_uri(picture: Picture, *, quality: int = 82, max_width_px: int = 900) -> str:
    """JPEG in a ``data:`` address, so that the page needs no other file."""
    if picture.shape[1] > max_width_px:
        height_px = round(picture.shape[0] * max_width_px / picture.shape[1])
        size = (max_width_px, height_px)
        picture = np.asarray(cv2.resize(picture, size, interpolation=cv2.INTER_AREA), np.uint8)
    encoded = cv2.imencode(".jpg", picture, [cv2.IMWRITE_JPEG_QUALITY, quality])[1]
    return "data:image/jpeg;base64," + base64.b64encode(encoded.tobytes()).decode()
