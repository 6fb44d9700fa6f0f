"""The report on the terminal: one table."""

from typing import Any

from rich.console import Console
from rich.markup import escape
from rich.table import Table

__all__ = ["print_report"]


def print_report(result: dict[str, Any], console: Console, *, report: str = "") -> None:
    """Print the result of a demo, as ``binpick demo --json`` gives it."""
    table = Table(box=None, show_header=False, pad_edge=False)
    table.add_column(style="bold")
    table.add_column()
    attempts, count = result["attempts"], result["count"]
    table.add_row("parts", escape(f"{count} x {', '.join(result['parts'])}, seed {result['seed']}"))
    table.add_row("attempts", f"{attempts}, {result['held']} held, {result['placed']} placed")
    table.add_row("left in the bin", f"{result['left']} ({result['ending']})")
    if result["lost"]:
        table.add_row("lost", f"{result['lost']}, neither in the bin nor in a slot")
    for reason, number in result["left_reasons"].items():
        table.add_row("", escape(f"{number} x {reason}"))
    for miss, number in result["misses"].items():
        table.add_row("missed", escape(f"{number} x {miss}"))
    seconds = f"{result['virtual_s']:.1f} s in the cell: {result['motion_s']:.1f} s moving, "
    table.add_row("time", seconds + f"{result['compute_s']:.1f} s computing")
    for name, errors in result["pose_error"].items():
        table.add_row(f"pose error, {name}", _errors(errors))
    for name, errors in result["place_error"].items():
        table.add_row(f"placing error, {name}", _errors(errors))
    if report:
        table.add_row("report", escape(report))
    console.print(table)


def _errors(errors: dict[str, Any]) -> str:
    if not errors["n"]:
        return f"nothing to compare, {errors['misses']} missed"
    axis, across, along = (errors[k] for k in ("axis_deg", "transverse_mm", "axial_mm"))
    return (
        f"axis {axis['rms']:.3f} deg, across {across['rms']:.3f} mm, along {along['rms']:.3f} mm "
        f"rms of {errors['n']}, {errors['misses']} missed"
    )
