"""Charts of the report as SVG: where the time went, why grasps were rejected, errors."""

from collections.abc import Sequence
from html import escape
from typing import Any

__all__ = ["bars", "error_dots", "timeline"]

PHASE_COLOURS = {
    "get ready": "#64748b",
    "approach": "#38bdf8",
    "descend": "#0ea5e9",
    "grip": "#f59e0b",
    "retreat": "#0ea5e9",
    "transfer": "#6366f1",
    "lower": "#0ea5e9",
    "let go": "#f59e0b",
    "home": "#38bdf8",
    "home without a part": "#ef4444",
    "exchange tray": "#94a3b8",
    "capture": "#a3e635",
    "find parts": "#22c55e",
    "plan": "#14b8a6",
}
ROWS = ("arm and gripper", "camera", "computing")
ROW_OF = {"capture": 1, "find parts": 2, "plan": 2}
WIDTH, LEFT, ROW = 1100, 120, 26  # SVG units
MOST_TICKS = 12


def timeline(phases: Sequence[dict[str, Any]], *, max_s: float | None = None) -> str:
    """Bars over the cell's time, a row each for arm, camera and computing.

    ``phases`` have ``name``, ``start_s``, ``end_s``.
    """
    shown = [p for p in phases if max_s is None or p["start_s"] < max_s]
    end_s = max((p["end_s"] for p in shown), default=1.0)
    end_s = min(end_s, max_s) if max_s else end_s
    scale = (WIDTH - LEFT - 10) / max(end_s, 1e-6)
    height = ROW * len(ROWS) + 26
    parts = [_open(WIDTH, height)]
    for row, name in enumerate(ROWS):
        y = 8 + row * ROW
        parts.append(f'<text x="0" y="{y + 14}" class="label">{name}</text>')
        parts.append(f'<line x1="{LEFT}" x2="{WIDTH}" y1="{y + 19}" y2="{y + 19}" class="rule"/>')
    for phase in shown:
        x = LEFT + phase["start_s"] * scale
        width = max((min(phase["end_s"], end_s) - phase["start_s"]) * scale, 0.6)
        y = 8 + ROW_OF.get(phase["name"], 0) * ROW
        colour = PHASE_COLOURS.get(phase["name"], "#94a3b8")
        seconds = phase["end_s"] - phase["start_s"]
        parts.append(
            f'<rect x="{x:.1f}" y="{y}" width="{width:.1f}" height="17" fill="{colour}">'
            f"<title>{escape(phase['name'])}: {seconds:.2f} s</title></rect>"
        )
    step_s = next(s for s in (1, 2, 5, 10, 20, 50, 100, 200, 500, 1e9) if end_s / s <= MOST_TICKS)
    for k in range(int(end_s / step_s) + 1):
        t = k * step_s
        x = min(LEFT + t * scale, WIDTH - 14)
        parts.append(f'<text x="{x:.0f}" y="{height - 4}" class="tick">{t:.0f} s</text>')
    return "".join([*parts, "</svg>"])


def timeline_legend(phases: Sequence[dict[str, Any]]) -> list[tuple[str, str, float]]:
    """Name, colour and total seconds of each phase that occurs."""
    totals: dict[str, float] = {}
    for phase in phases:
        seconds = phase["end_s"] - phase["start_s"]
        totals[phase["name"]] = totals.get(phase["name"], 0.0) + seconds
    return [(n, c, totals[n]) for n, c in PHASE_COLOURS.items() if n in totals]


def bars(counts: dict[str, int]) -> str:
    """Horizontal bars, the longest first."""
    rows = sorted(counts.items(), key=lambda item: -item[1])
    if not rows:
        return '<p class="quiet">none</p>'
    most = rows[0][1]
    parts = [_open(560, 26 * len(rows) + 6)]
    for k, (name, count) in enumerate(rows):
        y = 4 + 26 * k
        width = 1 + 230 * count / most
        parts.append(f'<text x="0" y="{y + 14}" class="label">{escape(name)}</text>')
        parts.append(f'<rect x="290" y="{y}" width="{width:.1f}" height="18" fill="#6366f1"/>')
        parts.append(f'<text x="{296 + width:.1f}" y="{y + 14}" class="tick left">{count}</text>')
    return "".join([*parts, "</svg>"])


def error_dots(
    values: Sequence[tuple[int, float]], *, unit: str, limit: float | None = None
) -> str:
    """Each pick (number, value) a dot; a dashed line at the limit."""
    width, height, left = 520, 130, 46
    top = max([*(value for _, value in values), limit or 0.0, 1e-9]) * 1.15
    parts = [_open(width, height)]
    for k in range(3):
        y = height - 22 - (height - 34) * k / 2
        label = f"{top * k / 2:.2g} {unit}" if k else f"0 {unit}"
        parts.append(f'<line x1="{left}" x2="{width}" y1="{y}" y2="{y}" class="rule"/>')
        parts.append(f'<text x="0" y="{y + 4}" class="tick left">{label}</text>')
    if limit:
        y = height - 22 - (height - 34) * limit / top
        parts.append(f'<line x1="{left}" x2="{width}" y1="{y}" y2="{y}" class="limit"/>')
    step = (width - left - 20) / max(len(values), 1)
    for k, (number, value) in enumerate(values):
        x = left + 12 + k * step
        y = height - 22 - (height - 34) * value / top
        parts.append(
            f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3.5" fill="#6366f1">'
            f"<title>pick {number}: {value:.3g} {unit}</title></circle>"
        )
    parts.append(f'<text x="{left}" y="{height - 4}" class="tick left">picks in order</text>')
    return "".join([*parts, "</svg>"])


def _open(width: int, height: int) -> str:
    return (
        f'<svg viewBox="0 0 {width} {height}" width="100%" '
        f'style="max-width:{width}px" role="img" xmlns="http://www.w3.org/2000/svg">'
    )
