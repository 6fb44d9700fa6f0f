"""A search finds where a signal changed, and says so when it did not."""

import numpy as np
import pytest

from tests.sims.controller.test_moves import CAUGHT, program

DATA = "VAR robtarget found; PERS bool seen := FALSE;"
FOUND = "Offs(p0, 0, 0, -200), v100, tTool"


def search(bench, line, *hits, before="", data=DATA, **changes):
    """Run one search; at each of ``hits`` (mm below the start) ``di1`` changes."""
    made = bench(data + program(before, line, errors=CAUGHT), **changes)

    async def play(b):
        if before:
            b.controller.set_input("di1", 1)
        await b.start()
        value = 0
        for depth in hits:
            await b.until(
                lambda depth=depth: (
                    b.value("p0")[0][2] - b.place[2] * 1e3 > depth and b.value("p0")[0][2] > 0
                )
            )
            value = 1 - value
            b.controller.set_input("di1", value)
        await b.ended()
        return b

    return made.run(play)


def depth(b, place):
    return b.value("p0")[0][2] - place


def error(b, name):
    return b.controller.system.find("T_ROB1", name).get()


@pytest.mark.parametrize("stop", ["\\Stop", "\\PStop", "\\SStop"])
def test_with_a_stop_the_arm_brakes_at_the_hit_and_the_place_is_stored(bench, stop):
    b = search(bench, f"SearchL {stop}, di1, found, {FOUND};", 60)
    assert b.value("phase") == 99
    assert depth(b, b.value("found")[0][2]) == pytest.approx(60, abs=1.0)
    assert depth(b, b.value("found")[0][2]) < depth(b, b.place[2] * 1e3) < 80


def test_without_a_stop_the_arm_goes_on_to_the_end_and_the_first_hit_counts(bench):
    b = search(bench, f"SearchL di1, found, {FOUND};", 60, 90, 120)
    assert b.value("errno_seen") == 0
    assert depth(b, b.value("found")[0][2]) == pytest.approx(60, abs=1.0)
    assert depth(b, b.place[2] * 1e3) == pytest.approx(200, abs=0.05)


def test_with_sup_a_second_hit_is_an_error_at_the_end(bench):
    b = search(bench, f"SearchL \\Sup, di1, found, {FOUND};", 60, 90, 120)
    assert b.value("errno_seen") == error(b, "ERR_WHLSEARCH")
    assert depth(b, b.place[2] * 1e3) == pytest.approx(200, abs=0.05)


def test_a_search_that_finds_nothing_is_an_error_at_the_end(bench):
    b = search(bench, f"SearchL \\Stop, di1, found, {FOUND};")
    assert b.value("errno_seen") == error(b, "ERR_WHLSEARCH")
    assert b.value("found")[0] == [0, 0, 0]


@pytest.mark.parametrize(
    ("flank", "hits"), [("\\NegFlank", [30, 60]), ("\\Flanks", [60]), ("\\PosFlank", [60])]
)
def test_a_flank_may_be_chosen(bench, flank, hits):
    b = search(bench, f"SearchL \\Stop, di1 {flank}, found, {FOUND};", *hits)
    assert depth(b, b.value("found")[0][2]) == pytest.approx(60, abs=1.0)


def test_a_signal_that_is_high_already_is_refused_unless_a_level_is_asked_for(bench):
    before = "phase := 1;"
    b = search(bench, f"SearchL \\Stop, di1, found, {FOUND};", before=before)
    assert b.value("errno_seen") == error(b, "ERR_SIGSUPSEARCH")
    b = search(bench, f"SearchL \\Stop, di1 \\HighLevel, found, {FOUND};", before=before)
    assert b.value("errno_seen") == 0
    assert depth(b, b.value("found")[0][2]) == pytest.approx(0, abs=1.0)


def test_the_place_found_is_in_the_displaced_frame(bench):
    before = "PDispSet [[0, 0, 10], [1, 0, 0, 0]];\n"
    line = before + f"SearchL \\Stop, di1, found, {FOUND};"
    b = search(bench, line, 60)
    assert depth(b, b.value("found")[0][2]) == pytest.approx(70, abs=1.0)


def test_a_persistent_may_be_searched_for_on_a_circle(bench):
    background = """
      PERS bool seen; PERS num phase;
      PROC main()
        WaitUntil phase = 1;
        WaitTime 0.5;
        seen := TRUE;
        WaitUntil FALSE;
      ENDPROC
    """
    line = (
        "phase := 1; SearchC \\Stop, seen, found, Offs(p0, 0, 60, -60), Offs(p0, 0, 0, -120), "
        "v100, tTool;"
    )
    made = bench(DATA + program(line, errors=CAUGHT), background)

    async def play(b):
        await b.start()
        await b.ended()
        return b

    b = made.run(play)
    centre = np.array(b.value("p0")[0]) + (0, 0, -60)
    assert b.value("errno_seen") == 0
    assert np.linalg.norm(np.array(b.value("found")[0]) - centre) == pytest.approx(60, abs=0.1)
    assert 0 < depth(b, b.value("found")[0][2]) < 60
    assert b.value("phase") == 99


def test_an_output_or_a_variable_is_no_target_of_a_search(bench):
    b = search(bench, f"SearchL \\Stop, do1, found, {FOUND};")
    assert b.value("phase") == 0


def test_a_search_is_tried_again_from_its_handler(bench):
    handler = """
        errno_seen := errno_seen + 1;
        IF errno_seen > 2 TRYNEXT;
        StorePath; MoveL p0, v500, fine, tTool; RestoPath;
        StartMoveRetry;
    """
    made = bench(DATA + program(f"SearchL \\Stop, di1, found, {FOUND};", errors=handler))

    async def play(b):
        await b.start()
        await b.until(lambda: b.value("errno_seen") == 1)
        await b.until(lambda: depth(b, b.place[2] * 1e3) < 1)
        await b.until(lambda: depth(b, b.place[2] * 1e3) > 80)
        b.controller.set_input("di1", 1)
        await b.ended()
        return b

    b = made.run(play)
    assert b.value("errno_seen") == 1
    assert b.value("phase") == 99
    assert depth(b, b.value("found")[0][2]) == pytest.approx(80, abs=1.0)
