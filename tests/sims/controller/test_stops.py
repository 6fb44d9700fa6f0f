"""Stops of every kind keep the path, and the arm goes on where it was."""

import asyncio

import numpy as np
import pytest

from sims.controller import CtrlState, StartRefusedError

LINE = """
  PROC main()
    MoveAbsJ HOME, v1000, fine, tTool;
    p0 := CRobT(\\Tool:=tTool \\WObj:=wobj0);
    phase := 1;
    MoveL Offs(p0, 0, 300, 0), v500, fine, tTool;
    phase := 2;
    MoveL p0, v500, fine, tTool;
    phase := 99;
    EXIT;
  ERROR
    errno_seen := ERRNO;
    StopMove;
    ClearPath;
    StartMove;
    TRYNEXT;
  ENDPROC
"""
WATCHER = """
  PERS num wish := 0;
  PROC main()
    WHILE TRUE DO
      IF wish = 1 StopMove \\Quick \\AllMotionTasks;
      IF wish = 2 StartMove \\AllMotionTasks;
      wish := 0;
      WaitTime 0.01;
    ENDWHILE
  ENDPROC
"""


async def half_way(b):
    b.record()
    await b.start()
    await b.until(lambda: b.value("phase") == 1 and b.speed > 0)
    await b.until(lambda: b.place[1] > 0.12)


async def stands(b):
    await b.until(lambda: b.controller.unit.is_standing, limit_s=2.0)


def is_on_line(b):
    return np.abs(b.places[:, [0, 2]] - np.array([0.451, 0.6471])).max() < 5e-5


def test_a_program_stop_keeps_the_path_and_start_goes_on(bench):
    async def play(b):
        await half_way(b)
        await b.controller.stop()
        await stands(b)
        stop = b.place[1]
        assert 0.12 < stop < 0.2
        await asyncio.sleep(1.0)
        assert b.place[1] == pytest.approx(stop, abs=1e-5)
        assert b.value("phase") == 1
        await b.start()
        await b.ended()
        assert b.value("phase") == 99
        assert is_on_line(b)

    bench(LINE).run(play)


def test_after_an_emergency_stop_motors_on_and_start_go_on(bench):
    async def play(b):
        await half_way(b)
        c = b.controller
        c.press_emergency_stop()
        await stands(b)
        assert c.state is CtrlState.EMERGENCYSTOP
        assert not c.is_running
        with pytest.raises(StartRefusedError, match="emergency stop is pressed"):
            await c.start()
        c.release_emergency_stop()
        await asyncio.sleep(0.1)
        assert c.state is CtrlState.EMERGENCYSTOPRESET
        with pytest.raises(StartRefusedError, match="not reset"):
            await c.start()
        c.reset_emergency_stop()
        assert c.state is CtrlState.MOTOROFF
        with pytest.raises(StartRefusedError, match="motors are off"):
            await c.start()
        c.motors_on()
        await asyncio.sleep(0.01)
        assert b.value("phase") == 1
        await c.start()
        await b.ended()
        assert b.value("phase") == 99
        assert is_on_line(b)
        assert {10013, 10010, 10011} <= set(b.numbers)

    bench(LINE).run(play)


def test_a_guard_stop_holds_until_the_guard_is_closed_and_the_program_started(bench):
    async def play(b):
        await half_way(b)
        b.controller.set_guard(True)
        await stands(b)
        assert b.controller.state is CtrlState.GUARDSTOP
        b.controller.set_guard(False)
        await asyncio.sleep(0.3)
        assert b.controller.state is CtrlState.MOTORON
        assert b.speed == 0
        await b.start()
        await b.ended()
        assert is_on_line(b)

    bench(LINE).run(play)


def test_a_mode_change_stops_the_program(bench):
    from hal import OperatingMode

    async def play(b):
        await half_way(b)
        b.controller.set_mode(OperatingMode.MANUAL_REDUCED)
        await stands(b)
        assert not b.controller.is_running
        assert b.controller.mode == "MANR"
        assert b.controller.op_mode == "OP_MAN_PROG"

    bench(LINE).run(play)


def test_another_task_stops_and_starts_the_arm_while_the_program_waits(bench):
    async def play(b):
        await half_way(b)
        b.controller.system.find("T_BACK", "wish").set(1)
        await stands(b)
        stop = b.place[1]
        assert b.controller.is_running
        await asyncio.sleep(0.5)
        assert b.place[1] == pytest.approx(stop, abs=1e-5)
        b.controller.system.find("T_BACK", "wish").set(2)
        await b.ended()
        assert b.value("phase") == 99
        assert is_on_line(b)

    bench(LINE, WATCHER).run(play)


def test_an_arm_that_was_pushed_away_returns_to_its_path_before_it_goes_on(bench):
    async def play(b):
        await half_way(b)
        await b.controller.stop()
        await stands(b)
        b.world.arm.jump_to(b.world.arm.target_rad + 0.02)
        stop = b.controller.unit
        await b.start()
        await b.until(lambda: stop.speed > 0, limit_s=5.0)
        assert is_on_line_now(b)
        await b.ended()
        assert b.value("phase") == 99

    def is_on_line_now(b):
        return np.abs(b.place[[0, 2]] - np.array([0.451, 0.6471])).max() < 1e-4

    bench(LINE).run(play)


TRAP = """
  VAR intnum demand;
  VAR errnum STOPPED := -1;
  PERS num demanded := 0;
  PROC main()
    BookErrNo STOPPED;
    MoveAbsJ HOME, v1000, fine, tTool;
    p0 := CRobT(\\Tool:=tTool \\WObj:=wobj0);
    CONNECT demand WITH halting;
    IPers demanded, demand;
    drive;
    phase := 3;
    MoveL p0, v500, fine, tTool;
    phase := 99;
    EXIT;
  ENDPROC
  PROC drive()
    phase := 1;
    MoveL Offs(p0, 0, 300, 0), v500, z10, tTool;
    MoveL Offs(p0, 0, 300, -100), v500, fine, tTool;
    phase := 2;
  ERROR
    errno_seen := ERRNO;
    RETURN;
  ENDPROC
  TRAP halting
    StopMove \\Quick;
    ClearPath;
    StartMove;
    RAISE STOPPED;
  ERROR
    RAISE;
  ENDTRAP
"""


def test_a_trap_clears_the_path_and_its_error_lands_in_the_moving_routine(bench):
    async def play(b):
        await half_way(b)
        b.controller.system.find("T_ROB1", "demanded").set(1)
        await b.until(lambda: b.value("phase") >= 3)
        assert b.value("errno_seen") == b.value("STOPPED")
        await b.ended()
        assert b.value("phase") == 99
        assert b.places[:, 1].max() < 0.22
        assert b.place == pytest.approx(np.array(b.value("p0")[0]) / 1e3, abs=3e-5)

    bench(TRAP).run(play)


STORED = """
  PROC main()
    MoveAbsJ HOME, v1000, fine, tTool;
    p0 := CRobT(\\Tool:=tTool \\WObj:=wobj0);
    phase := 1;
    MoveL Offs(p0, 0, 300, 0), v500, z10, tTool;
    WaitTime 0.3;
    StopMove;
    StorePath;
    phase := 2;
    MoveL Offs(p0, 0, 50, -50), v500, fine, tTool;
    phase := 3;
    RestoPath;
    StartMove;
    MoveL Offs(p0, 0, 300, -100), v500, fine, tTool;
    phase := 99;
    EXIT;
  ENDPROC
"""


def test_a_stored_path_is_taken_up_again(bench):
    async def play(b):
        b.record()
        await b.start()
        await b.ended()
        assert b.value("phase") == 99
        goals = np.array(b.value("p0")[0]) / 1e3 + [(0, 0.05, -0.05), (0, 0.3, -0.1)]
        for goal in goals:
            assert np.linalg.norm(b.places - goal, axis=1).min() < 5e-5
        assert b.places[:, 1].max() > 0.28

    bench(STORED).run(play)


def test_running_into_something_is_an_error_that_the_program_may_handle(bench):
    async def play(b):
        await half_way(b)
        b.world.model.body_mass[b.world.model.body("link3").id] += 400.0
        await b.ended()
        assert 50204 in b.numbers
        assert b.value("errno_seen") == b.value("ERR_MOTIONSUP")
        assert b.controller.has_collided

    bench(LINE).run(play)


def test_pp_to_main_forgets_the_path_and_puts_settings_back(bench):
    async def play(b):
        await half_way(b)
        await b.controller.stop()
        await stands(b)
        b.controller.mechanics.settings.checks_conf_linear = False
        await b.controller.pp_to_main()
        assert b.controller.mechanics.settings.checks_conf_linear
        assert not b.controller.unit.moves
        await b.start()
        await b.ended()
        assert b.value("phase") == 99

    bench(LINE).run(play)


def test_pp_to_main_is_refused_while_the_program_runs(bench):
    async def play(b):
        await half_way(b)
        with pytest.raises(StartRefusedError, match="stop"):
            await b.controller.pp_to_main()

    bench(LINE).run(play)


def test_a_warm_start_loads_everything_anew(bench):
    async def play(b):
        await half_way(b)
        assert b.value("p0")[0] != [0, 0, 0]
        await b.controller.restart()
        await stands(b)
        assert not b.controller.is_running
        assert b.value("p0")[0] == [0, 0, 0]
        await b.start()
        await b.ended()
        assert b.value("phase") == 99

    bench(LINE).run(play)


def test_the_same_run_twice_leaves_the_same_bits(bench):
    def once():
        async def play(b):
            await half_way(b)
            await b.controller.stop()
            await asyncio.sleep(0.2)
            await b.start()
            await b.ended()
            return b.world.data.qpos.tobytes(), b.loop.now_ns, b.numbers

        return bench(LINE).run(play)

    assert once() == once()


def test_the_moving_task_does_not_take_back_another_tasks_stop(bench):
    async def play(b):
        await half_way(b)
        b.controller.system.find("T_BACK", "wish").set(1)
        await stands(b)
        b.controller.system.find("T_ROB1", "demanded").set(1)
        await b.until(lambda: b.value("phase") >= 3)
        await asyncio.sleep(0.3)
        assert b.speed == 0
        b.controller.system.find("T_BACK", "wish").set(2)
        await b.ended()
        assert b.value("phase") == 99

    bench(TRAP, WATCHER).run(play)


UNHEARD = """
  PROC main()
    MoveAbsJ HOME, v1000, fine, tTool;
    p0 := CRobT(\\Tool:=tTool \\WObj:=wobj0);
    phase := 1;
    MoveL Offs(p0, 0, 300, 0), v500, z10, tTool;
    WaitTime 2;
    phase := 2;
    MoveL p0, v500, z10, tTool;
    phase := 3;
    EXIT;
  ERROR
    errno_seen := ERRNO;
    TRYNEXT;
  ENDPROC
"""


def test_a_collision_that_no_move_was_waiting_for_is_raised_by_the_next_one(bench):
    async def play(b):
        await half_way(b)
        b.controller.collide()
        await b.until(lambda: b.value("phase") == 3)
        assert b.value("errno_seen") == b.value("ERR_MOTIONSUP")

    bench(UNHEARD).run(play)
