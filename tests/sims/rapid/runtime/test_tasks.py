import asyncio

import pytest

from sims.loop import LockstepLoop, NoWorld
from sims.rapid.builtin import TaskKind
from sims.rapid.task import NoRoutineError, TaskError
from tests.sims.rapid.runtime.bench import Host, load_errors, make, play, run, value


def test_a_busy_wait_on_a_shared_flag_lets_the_other_task_run():
    first = """
        PERS bool mutex := TRUE;
        PERS num order := 0;
        PROC main()
            WHILE mutex DO
            ENDWHILE
            order := order * 10 + 2;
        ENDPROC
    """
    second = """
        PERS bool mutex;
        PERS num order;
        PROC main()
            WaitTime 0.05;
            order := order * 10 + 1;
            mutex := FALSE;
        ENDPROC
    """
    system = run(first, second)
    assert value(system, "order") == 12


def test_a_busy_loop_costs_virtual_time_and_freezes_nobody():
    async def script(system):
        task = system.tasks["T_ROB1"]
        task.start()
        began_s = asyncio.get_running_loop().time()
        await asyncio.sleep(0.1)
        assert asyncio.get_running_loop().time() - began_s == pytest.approx(0.1)
        assert task.statements == pytest.approx(20_000, rel=0.02)

    play(script, "PROC main()\n WHILE TRUE DO\n ENDWHILE\n ENDPROC")


def test_test_and_set_excludes_the_others():
    worker = """
        PERS bool lock := FALSE;
        PERS num inside := 0;
        PERS num most := 0;
        PERS num done := 0;
        PROC main()
            FOR i FROM 1 TO 5 DO
                WaitTestAndSet lock;
                inside := inside + 1;
                IF inside > most most := inside;
                WaitTime 0.01;
                inside := inside - 1;
                done := done + 1;
                lock := FALSE;
            ENDFOR
        ENDPROC
    """
    system = run(worker, worker, worker)
    assert value(system, "most") == 1
    assert value(system, "done") == 15


def test_a_persistent_is_shared_by_name_though_one_task_gives_the_value():
    system = run(
        "PERS num shared;\n PERS num seen := 0;\n PROC main()\n seen := shared;\n ENDPROC",
        "PERS num shared := 7;\n PROC main()\n ENDPROC",
    )
    assert value(system, "seen") == 7
    assert system.find("T_ROB1", "shared") is system.find("T_2", "shared")


def test_local_and_task_persistents_and_variables_are_the_tasks_own():
    text = """
        LOCAL PERS num mine := 0;
        TASK PERS num ours := 0;
        VAR num own;
        PROC main()
            mine := mine + 1;
            ours := ours + 1;
            own := own + 1;
        ENDPROC
    """
    system = run(text, text)
    for task in ("T_ROB1", "T_2"):
        assert [value(system, name, task) for name in ("bench:mine", "ours", "own")] == [1, 1, 1]


def test_a_shared_persistent_of_two_types_refuses_the_load():
    errors = load_errors(
        "PERS num a := 1;\n PROC main()\n ENDPROC", 'PERS string a := "";\n PROC main()\n ENDPROC'
    )
    assert any("a is a num here and a string in task T_2" in error for error in errors)


def test_pp_to_main_gives_variables_their_first_values_and_keeps_persistents():
    text = """
        PERS num kept := 1;
        VAR num lost := 1;
        VAR num list{2} := [1, 2];
        PROC main()
            kept := kept + 1;
            lost := lost + 1;
            list{1} := lost;
            Stop;
        ENDPROC
    """

    async def script(system):
        task = system.tasks["T_ROB1"]
        for expected in (2, 3):
            task.start()
            await task.stopped()
            assert value(system, "kept") == expected
            assert value(system, "lost") == 2
            assert value(system, "list") == [2, 2]
            task.pp_to_main()
            assert value(system, "list") == [1, 2]

    play(script, text)


def test_main_begins_again_and_keeps_its_variables_until_the_cycle_is_once():
    text = "VAR num cycles;\n PROC main()\n WaitTime 0.1;\n cycles := cycles + 1;\n ENDPROC"

    async def script(system):
        task = system.tasks["T_ROB1"]
        task.start(is_cyclic=True)
        await asyncio.sleep(1.005)
        assert value(system, "cycles") == 10
        task.stop()
        await task.stopped()
        task.start(is_cyclic=False)
        await task.stopped()
        assert value(system, "cycles") == 11
        assert task.pointer.routine == "main"

    play(script, text)


def test_stop_holds_a_wait_and_a_start_goes_on_with_it():
    text = """
        VAR num stage;
        PROC main()
            stage := 1;
            WaitTime 1;
            stage := 2;
            WHILE TRUE DO
            ENDWHILE
        ENDPROC
    """

    async def script(system):
        task = system.tasks["T_ROB1"]
        task.start()
        await asyncio.sleep(0.5)
        assert task.is_waiting
        task.stop()
        await task.stopped()
        assert str(task.pointer) == "Bench/main, line 6"
        await asyncio.sleep(5)
        assert value(system, "stage") == 1
        task.start()
        await asyncio.sleep(0.01)
        assert value(system, "stage") == 2

    play(script, text)


def test_steps_go_statement_by_statement_and_into_routines():
    text = """
        VAR num a;
        PROC main()
            a := 1;
            inner;
            a := 3;
        ENDPROC
        PROC inner()
            a := 2;
        ENDPROC
    """

    async def script(system):
        task = system.tasks["T_ROB1"]
        seen = []
        for _ in range(9):
            await task.step()
            seen.append((task.pointer.routine, task.pointer.line, value(system, "a")))
        assert ("main", 6, 1) in seen
        assert ("inner", 10, 1) in seen
        assert ("main", 7, 2) in seen
        assert seen.index(("main", 6, 1)) < seen.index(("inner", 10, 1))

    play(script, text)


def test_an_event_routine_runs_on_top_of_a_stopped_program():
    text = """
        PERS string trace := "";
        PROC main()
            WaitTime 1;
            trace := trace + "m";
            Stop;
        ENDPROC
        PROC on_restart()
            WaitTime 0.1;
            trace := trace + "e" + ValToStr(EventType());
        ENDPROC
    """

    async def script(system):
        task = system.tasks["T_ROB1"]
        task.start()
        await asyncio.sleep(0.5)
        with pytest.raises(TaskError, match="stop it first"):
            await task.call_routine("on_restart")
        task.stop()
        await task.stopped()
        await task.call_routine("on_restart", event=5.0)
        assert str(task.pointer) == "Bench/main, line 5"
        task.start()
        await task.stopped()
        assert value(system, "trace") == "e5m"
        with pytest.raises(NoRoutineError):
            await task.call_routine("nosuch")

    play(script, text)


def test_tasks_meet_at_a_synchronisation_point():
    def worker(name, wait):
        return f"""
            PERS tasks both{{2}} := [["T_ROB1"], ["T_2"]];
            VAR syncident meeting;
            VAR clock watch;
            VAR num waited;
            PROC main()
                ClkStart watch;
                WaitTime {wait};
                WaitSyncTask meeting, both;
                waited := ClkRead(watch);
            ENDPROC
        """

    system = run(worker("a", 1), worker("b", 3))
    assert value(system, "waited") == 3
    assert value(system, "waited", "T_2") == 3


def test_the_same_program_twice_gives_the_same_trace():
    worker = """
        PERS num total := 0;
        PERS string trace := "";
        VAR num seed := {seed};
        PROC main()
            FOR i FROM 1 TO 40 DO
                seed := (seed * 13 + 7) MOD 101;
                total := total + seed;
                IF StrLen(trace) < 70 trace := trace + "{seed}";
                WaitTime seed / 1000;
                TPWrite "{seed}" \\Num:=total;
            ENDFOR
        ENDPROC
    """

    def lines():
        system = run(worker.replace("{seed}", "1"), worker.replace("{seed}", "2"))
        return system.host.pendant.lines, value(system, "trace")

    assert lines() == lines()
    assert len(set(lines()[0])) > 20


def test_overrides_replace_initial_values_and_unknown_ones_are_refused():
    text = "CONST num port := 1025;\n VAR num result;\n PROC main()\n result := port;\n ENDPROC"
    assert value(run(text, overrides={"PORT": "2000"}), "result") == 2000
    assert value(run(text, overrides={"bench:port": "1+2"}), "result") == 3
    assert any("no data nosuch" in e for e in load_errors(text, overrides={"nosuch": "1"}))


def test_static_tasks_are_left_alone_when_a_normal_task_fails():
    background = "VAR num n;\n PROC main()\n WaitTime 0.1;\n n := n + 1;\n ENDPROC"

    async def script(system):
        normal, static = system.tasks.values()
        normal.start()
        static.start()
        await normal.stopped()
        await asyncio.sleep(1)
        assert static.is_running
        assert value(system, "n", "T_2") >= 9

    failing = "PROC main()\n nosuch;\n ENDPROC"
    play(script, failing, background, kinds=[TaskKind.NORMAL, TaskKind.STATIC])


def test_a_slow_controller_takes_longer_for_the_same_statements():
    def duration_s(statement_ns):
        host = Host(statement_ns=statement_ns)
        loop_s = []

        async def script(system):
            task = system.tasks["T_ROB1"]
            task.start(is_cyclic=False)
            await task.stopped()
            loop_s.append(asyncio.get_running_loop().time())

        play(script, "PROC main()\n FOR i FROM 1 TO 1000 DO\n ENDFOR\n ENDPROC", host=host)
        return loop_s[0]

    assert duration_s(50_000) == pytest.approx(10 * duration_s(5_000), rel=0.1)
    assert duration_s(0) == 0.0
    assert duration_s(5_000_000) == pytest.approx(5.0, rel=0.1)


def test_lockstep_closes_cleanly_with_tasks_that_wait():
    loop = LockstepLoop(NoWorld())

    async def main():
        system = make("PROC main()\n WaitTime 100;\n ENDPROC")
        system.tasks["T_ROB1"].start()
        await asyncio.sleep(1)
        await system.close()
        return len(asyncio.all_tasks())

    try:
        assert loop.run_until_complete(main()) == 1
    finally:
        loop.close()


def test_an_event_routine_that_fails_leaves_the_program_where_it_was():
    text = """
        VAR num zero;
        PROC main()
            WaitTime 1;
            Stop;
        ENDPROC
        PROC on_start()
            zero := 1 / zero;
        ENDPROC
    """

    async def script(system):
        task = system.tasks["T_ROB1"]
        await task.call_routine("on_start")
        assert task.has_failed
        assert system.host.log.titles == ["Unhandled error ERR_DIVZERO"]
        assert [one.routine for one in task.stack] == ["main"]
        task.start()
        await task.stopped()
        assert not task.has_failed

    play(script, text)


def test_standstill_is_waited_for_where_a_wait_asks_for_it():
    text = """
        VAR num stage;
        PROC main()
            WaitTime \\InPos, 0;
            stage := 1;
            WaitUntil \\InPos, TRUE;
            stage := 2;
            Stop;
        ENDPROC
    """

    async def script(system):
        task = system.tasks["T_ROB1"]

        async def settled():
            await asyncio.sleep(1)

        task.settled = settled
        task.start()
        await asyncio.sleep(1.5)
        assert value(system, "stage") == 1
        await task.stopped()
        assert value(system, "stage") == 2
        assert asyncio.get_running_loop().time() == pytest.approx(2, abs=0.01)

    play(script, text)
