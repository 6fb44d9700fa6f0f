import io
import re

import numpy as np
import pytest
from rich.console import Console

from cell.report import charts
from cell.report.html import render_report
from cell.report.pictures import LookPictures, cloud_picture, depth_picture, outline_picture
from cell.report.terminal import print_report

ERROR = {"axis_deg": 0.1, "transverse_mm": 0.2, "axial_mm": 0.1, "position_mm": 0.22}
PICK = {
    "number": 1,
    "kind": "across",
    "outcome": "held",
    "size_m": 0.02,
    "force_n": 90.0,
    "is_held": True,
    "is_placed": True,
    "pose_error": {**ERROR, "is_flipped": False},
    "place_error": {**ERROR, "is_flipped": False},
    "miss": "",
}
SUMMARY = {"n": 1, "misses": 0, **{key: {"rms": v, "p95": v} for key, v in ERROR.items()}}
RESULT = {
    "seed": 7,
    "parts": ["shaft"],
    "count": 2,
    "attempts": 1,
    "held": 1,
    "placed": 1,
    "left": 1,
    "lost": 0,
    "failure": "",
    "ending": "parts left, none graspable",
    "left_reasons": {"<b>out of reach</b>": 1},
    "reject_reasons": {"approach is blocked": 12, "no way from home": 3},
    "misses": {},
    "motion_s": 5.0,
    "compute_s": 2.5,
    "virtual_s": 6.0,
    "picks": [PICK],
    "pose_error": {"shaft": SUMMARY},
    "place_error": {"shaft": SUMMARY},
    "journal_sha256": "ab" * 32,
}
PHASES = [
    {"name": "approach", "start_s": 0.0, "end_s": 1.5},
    {"name": "find parts", "start_s": 1.0, "end_s": 3.0},
]


def look(rows=40, columns=60):
    rng = np.random.default_rng(0)
    v, u = np.mgrid[:rows, :columns]
    depth = np.full((rows, columns), 0.73, np.float32)
    depth[10:20, 10:30] = 0.70
    depth[0, :] = np.nan
    points = np.stack([(v - 20) * 0.004, (u - 30) * 0.004, 0.73 - depth], -1).astype(np.float32)
    labels = np.full((rows, columns), -1, np.int32)
    labels[10:20, 10:30] = 0
    outline = np.array([[10, 10], [30, 10], [30, 20], [10, 20], [10, 10]], np.float32)
    image = rng.uniform(0, 200, (rows, columns)).astype(np.float32)
    return LookPictures(1, image, depth, points, labels, ((outline,),), (0.36, 0.26, 0.14))


def test_the_page_is_one_file_and_says_what_happened():
    page = render_report(RESULT, [look()], [0], PHASES)
    assert "1 of 2 parts picked and placed" in page
    assert "parts left, none graspable" in page
    assert page.count("data:image/jpeg;base64,") == 3
    assert not re.search(r'(src|href)="(?!data:)', page)
    assert "approach is blocked" in page


def test_what_devices_and_files_say_is_escaped():
    page = render_report(RESULT, [look()], [0], PHASES)
    assert "<b>out of reach</b>" not in page
    assert "&lt;b&gt;out of reach" in page


def test_a_run_without_looks_or_picks_still_has_a_page():
    empty = {"n": 0, "misses": 0}
    result = RESULT | {
        "attempts": 0,
        "held": 0,
        "placed": 0,
        "picks": [],
        "pose_error": {"shaft": empty},
        "place_error": {"shaft": empty},
    }
    assert "0 of 2 parts" in render_report(result, [], [], [])


def test_the_outline_is_drawn_where_the_part_is():
    picture = outline_picture(look(), chosen=0)
    coloured = np.ptp(picture.astype(int), axis=2) > 30
    assert coloured[9:12, 12:28].mean() > 0.5
    assert not coloured[25:].any()


def test_near_is_brighter_than_far_and_unknown_is_black():
    picture = depth_picture(look()).astype(int)
    assert picture[15, 20].sum() > picture[30, 20].sum()
    assert (picture[0] == 0).all()
    nothing = LookPictures(**{**vars(look()), "depth_m": np.full((40, 60), np.nan, np.float32)})
    assert (depth_picture(nothing) == 0).all()
    assert cloud_picture(nothing).shape[2] == 3


def test_the_cloud_has_the_parts_colour():
    picture = cloud_picture(look())
    assert (np.ptp(picture.astype(int), axis=2) > 60).any()


def test_bars_end_where_the_phases_end():
    drawing = charts.timeline(PHASES)
    rects = re.findall(r'<rect x="([\d.]+)" y="(\d+)" width="([\d.]+)"', drawing)
    (x0, y0, w0), (x1, y1, w1) = [tuple(map(float, rect)) for rect in rects]
    scale = w1 / 2.0
    assert w0 == pytest.approx(1.5 * scale, abs=0.2)
    assert x1 - x0 == pytest.approx(1.0 * scale, abs=0.2)
    assert y0 != y1


def test_the_table_names_every_reason():
    out = io.StringIO()
    print_report(RESULT, Console(file=out, width=120), report="out/report.html")
    text = out.getvalue()
    for words in ("2 x shaft, seed 7", "1 held, 1 placed", "1 x <b>out of reach</b>", "out/report"):
        assert words in text
