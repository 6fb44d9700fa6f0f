"""The report as one self-contained page."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from jinja2 import Environment, FileSystemLoader, StrictUndefined, select_autoescape
from markupsafe import Markup

from cell.report import charts
from cell.report.pictures import (
    LookPictures,
    as_data_uri,
    cloud_picture,
    depth_picture,
    outline_picture,
)

__all__ = ["render_report"]

FIRST_SECONDS = 40.0


def render_report(
    result: dict[str, Any],
    looks: Sequence[LookPictures],
    chosen: Sequence[int | None],
    phases: Sequence[dict[str, Any]],
) -> str:
    """Return the page.

    ``looks`` and ``chosen`` (the part picked after each look) go together; ``phases`` are the
    journal's.
    """
    environment = Environment(
        loader=FileSystemLoader(Path(__file__).parent),
        autoescape=select_autoescape(),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    picks = result["picks"]
    first = looks[0] if looks else None
    return environment.get_template("report.html").render(
        result=result,
        picks=picks,
        kind=", ".join(result["parts"]),
        pose=next(iter(result["pose_error"].values())),
        place=next(iter(result["place_error"].values())),
        first_outline=as_data_uri(outline_picture(first, chosen[0])) if first else "",
        first_depth=as_data_uri(depth_picture(first)) if first else "",
        first_cloud=as_data_uri(cloud_picture(first)) if first else "",
        gallery=[
            (look.number, as_data_uri(outline_picture(look, part), quality=70, max_width_px=360))
            for look, part in list(zip(looks, chosen, strict=True))[1:]
        ],
        timeline=Markup(charts.timeline(phases)),
        timeline_start=Markup(charts.timeline(phases, max_s=FIRST_SECONDS))
        if result["virtual_s"] > FIRST_SECONDS
        else "",
        legend=charts.timeline_legend(phases),
        rejects=Markup(charts.bars(result["reject_reasons"])),
        lefts=Markup(charts.bars(result["left_reasons"])),
        axis_chart=Markup(_error_chart(picks, "pose_error", "axis_deg", "deg", 0.10)),
        position_chart=Markup(_error_chart(picks, "pose_error", "position_mm", "mm", 0.15)),
        place_chart=Markup(_error_chart(picks, "place_error", "position_mm", "mm", 0.40)),
    )


def _error_chart(
    picks: Sequence[dict[str, Any]], which: str, key: str, unit: str, limit: float
) -> str:
    values = [(pick["number"], pick[which][key]) for pick in picks if pick[which] is not None]
    if not values:
        return '<p class="quiet">nothing to compare</p>'
    return charts.error_dots(values, unit=unit, limit=limit)
