"""State, signals, system I/O, event routines, log, pendant."""

import asyncio

import pytest

from hal import OperatingMode
from sims.controller import CtrlState, StartRefusedError
from sims.controller.backup import (
    CrossConnection,
    Event,
    EventRoutine,
    SignalConfig,
    SystemInput,
    SystemOutput,
)
from sims.controller.eventlog import MOST_ENTRIES, ControllerLog
from sims.controller.operator import Operator, OperatorError, describe
from sims.controller.signals import SignalBoard
from sims.controller.state import TRANSITIONS, StateEvent, after
from sims.rapid.errors import RapidError
from sims.rapid.host import EventKind, SignalKind
from sims.world import Faults, World

WAITING = """
  PROC main()
    phase := phase + 1;
    WHILE TRUE DO
      WaitTime 0.1;
    ENDWHILE
  ENDPROC
  PROC rStart()
    started := started + 1;
  ENDPROC
  PROC rStop()
    stopped := stopped + 1;
  ENDPROC
  PROC rRestart()
    restarted := restarted + 1;
  ENDPROC
  PERS num started := 0;
  PERS num stopped := 0;
  PERS num restarted := 0;
"""


def test_every_state_is_reached_and_a_failure_is_final():
    reached = set(TRANSITIONS.values())
    assert reached == set(CtrlState) - {CtrlState.INIT}
    for event in StateEvent:
        assert after(CtrlState.SYSFAIL, event) in (None, CtrlState.SYSFAIL)


def test_motors_come_on_only_after_the_emergency_stop_is_released_and_reset():
    state = CtrlState.MOTORON
    for event, wanted in [
        (StateEvent.STOP_PRESSED, CtrlState.EMERGENCYSTOP),
        (StateEvent.MOTORS_ON, None),
        (StateEvent.STOP_RELEASED, CtrlState.EMERGENCYSTOPRESET),
        (StateEvent.MOTORS_ON, None),
        (StateEvent.RESET, CtrlState.MOTOROFF),
        (StateEvent.MOTORS_ON, CtrlState.MOTORON),
    ]:
        following = after(state, event)
        assert following is wanted
        state = following or state


def test_the_cabinets_own_buttons_are_followed(bench):
    async def play(b):
        faults, c = Faults(b.world), b.controller
        await b.start()
        faults.press_emergency_stop()
        await asyncio.sleep(0.05)
        assert c.state is CtrlState.EMERGENCYSTOP
        assert not c.is_running
        faults.release_emergency_stop()
        await asyncio.sleep(0.05)
        assert c.state is CtrlState.MOTORON
        faults.switch_motors(False)
        await asyncio.sleep(0.05)
        assert c.state is CtrlState.MOTOROFF
        faults.turn_key(OperatingMode.MANUAL_FULL)
        await asyncio.sleep(0.05)
        assert c.op_mode == "OP_MAN_TEST"
        faults.turn_key(OperatingMode.AUTO)
        await b.until(lambda: c.mode == "AUTO_CH")
        with pytest.raises(StartRefusedError):
            await c.start()
        await asyncio.sleep(0.01)
        assert c.mode == "AUTO"

    bench(WAITING).run(play)


OUTPUTS = (
    ("MotorOn", ()),
    ("EmStop", ()),
    ("RunchOk", ()),
    ("TaskExecuting", ("T_ROB1",)),
    ("MechUnitNotMoving", ("ROB_1",)),
    ("AutoOn", ()),
    ("CycleOn", ()),
)


def test_system_outputs_follow_the_state(bench):
    signals = [SignalConfig(f"o{k}", SignalKind.DO) for k in range(len(OUTPUTS))]
    outputs = [SystemOutput(status, f"o{k}", args) for k, (status, args) in enumerate(OUTPUTS)]

    async def play(b):
        def levels():
            return [int(b.controller.signals[f"o{k}"].value) for k in range(len(OUTPUTS))]

        await asyncio.sleep(0.3)
        assert levels() == [1, 0, 1, 0, 1, 1, 0]
        await b.start()
        await asyncio.sleep(0.3)
        assert levels() == [1, 0, 1, 1, 1, 1, 1]
        b.controller.press_emergency_stop()
        await asyncio.sleep(0.3)
        assert levels() == [0, 1, 0, 0, 1, 1, 0]

    bench(WAITING, signals=signals, system_outputs=outputs).run(play)


def test_system_inputs_start_and_stop_and_unknown_ones_are_logged(bench):
    actions = ["Start", "Stop", "PPMain", "MotorOn", "Frobnicate"]
    signals = [SignalConfig(f"i{k}", SignalKind.DI) for k in range(len(actions))]
    inputs = [SystemInput(f"i{k}", action) for k, action in enumerate(actions)]

    async def play(b):
        c = b.controller
        assert any("Frobnicate" in line for entry in c.log for line in entry.cause)
        c.set_input("i0", 1)
        await asyncio.sleep(0.2)
        assert c.is_running
        assert b.value("phase") == 1
        c.set_input("i2", 1)  # refused while running; nobody to raise at
        await asyncio.sleep(0.1)
        assert c.is_running
        c.set_input("i1", 1)
        await asyncio.sleep(0.2)
        assert not c.is_running
        c.set_input("i2", 0)
        c.set_input("i2", 1)
        c.set_input("i0", 0)
        await asyncio.sleep(0.1)
        c.set_input("i0", 1)
        await asyncio.sleep(0.2)
        assert b.value("phase") == 2

    bench(WAITING, signals=signals, system_inputs=inputs).run(play)


def test_event_routines_run_at_their_events(bench):
    routines = [
        EventRoutine(Event.START, "rStart", "T_ROB1"),
        EventRoutine(Event.STOP, "rStop"),
        EventRoutine(Event.QSTOP, "rStop"),
        EventRoutine(Event.RESTART, "rRestart"),
        EventRoutine(Event.START, "rMissing"),
    ]

    async def play(b):
        def counts():
            return [b.value(name) for name in ("started", "stopped", "restarted")]

        await b.start()
        await asyncio.sleep(0.2)
        assert counts() == [1, 0, 0]
        assert any("rMissing" in line for entry in b.controller.log for line in entry.cause)
        await b.controller.stop()
        assert counts() == [1, 1, 0]
        await b.start()
        await asyncio.sleep(0.2)
        assert counts() == [1, 1, 1]
        b.controller.press_emergency_stop()
        await asyncio.sleep(0.5)
        assert counts() == [1, 2, 1]

    bench(WAITING, event_routines=routines).run(play)


def test_a_background_task_runs_by_itself_and_through_an_emergency_stop(bench):
    back = "  PERS num beats := 0;\n  PROC main()\n    Incr beats;\n    WaitTime 0.1;\n  ENDPROC"

    async def play(b):
        await asyncio.sleep(0.5)
        before = b.value("beats", "T_BACK")
        assert before >= 4
        b.controller.press_emergency_stop()
        await asyncio.sleep(0.5)
        assert b.value("beats", "T_BACK") >= before + 4

    bench(WAITING, back).run(play)


def board(*configs, crosses=()):
    return SignalBoard(configs, World().cabinet, crosses)


def test_groups_and_bits_of_a_device_are_one():
    made = board(
        SignalConfig("go1", SignalKind.GO, "D", "0-3", bits=4),
        SignalConfig("doA", SignalKind.DO, "D", "2"),
        SignalConfig("doB", SignalKind.DO),
    )
    seen = []
    made.by_name["go1"].watch(seen.append)
    made.by_name["doa"].set(1)
    assert made.by_name["go1"].value == 4
    made.by_name["go1"].set(3)
    assert made.by_name["doa"].value == 0
    assert made.by_name["dob"].value == 0
    assert seen == [4, 3]
    with pytest.raises(RapidError, match="0 to 15"):
        made.by_name["go1"].set(16)


def test_inputs_and_protected_outputs_cannot_be_written_by_programs():
    made = board(
        SignalConfig("di1", SignalKind.DI), SignalConfig("x", SignalKind.DO, access="ReadOnly")
    )
    for name in ("di1", "x"):
        with pytest.raises(RapidError, match="cannot be written"):
            made.by_name[name].set(1)


def test_analog_values_keep_their_range():
    made = board(SignalConfig("ao", SignalKind.AO, logical_min=-10, logical_max=10))
    made.by_name["ao"].set(9.5)
    assert made.by_name["ao"].value == 9.5
    for value in (10.5, float("nan")):
        with pytest.raises(RapidError):
            made.by_name["ao"].set(value)


def test_cross_connections_join_left_to_right_and_rings_rest():
    names = [SignalConfig(name, SignalKind.DO) for name in "abcr"]
    made = board(
        *names,
        crosses=[
            CrossConnection("r", (("a", False), ("b", True), ("c", False)), ("AND", "OR")),
            CrossConnection("a", (("a", True),)),
        ],
    )
    level = {name: signal.value for name, signal in made.by_name.items()}
    assert level["r"] == (level["a"] and not level["b"])
    made.by_name["c"].put(1)
    assert made.by_name["r"].value == 1


def test_world_inputs_are_followed_and_watchers_told(bench):
    async def play(b):
        seen = []
        cancel = b.controller.signals["di3"].watch(seen.append)
        Faults(b.world).set_input("di3", True)
        await asyncio.sleep(0.01)
        cancel()
        Faults(b.world).set_input("di3", False)
        await asyncio.sleep(0.01)
        assert seen == [1.0]
        b.controller.set_input("di4", 1)
        assert b.world.cabinet.inputs["di4"]
        with pytest.raises(ValueError, match="no input"):
            b.controller.set_input("do1", 1)

    bench(WAITING).run(play)


def test_the_log_is_bounded_and_lines_are_cut():
    log = ControllerLog()
    for k in range(MOST_ENTRIES + 50):
        log.write(EventKind.STATE, 8, k, "x" * 10_000, ["y" * 10_000] * 100)
    assert len(log) == MOST_ENTRIES
    last = list(log)[-1]
    assert len(last.title) <= 200
    assert sum(len(line) for line in last.cause) <= 1600
    assert last.code == 8 * 10_000 + MOST_ENTRIES + 49


def test_typed_commands_do_what_they_say_and_wrong_ones_say_what_there_is(bench):
    async def play(b):
        operator = Operator(b.controller)
        for line in ("start", "set di1 1", "speed 50", "guard open"):
            await operator.obey(line)
        assert b.controller.state is CtrlState.GUARDSTOP
        assert b.controller.speed_ratio == 0.5
        state = describe(b.controller)
        assert state["signals"]["di1"] == 1
        assert state["tasks"]["T_ROB1"]["pointer"]
        for line in (
            "fly",
            "set di1",
            "set do1 1",
            "speed 200",
            "speed x",
            "answer 1",
            "",
            "set di1 nan",
        ):
            with pytest.raises(OperatorError):
                await operator.obey(line)

    bench(WAITING).run(play)


def test_power_off_ends_tasks_and_the_world_goes_on(bench):
    made = bench(WAITING)

    async def play(b):
        await b.start()
        await b.controller.power_off()
        await b.controller.power_off()
        assert not b.controller.is_running
        assert b.controller.refusal() == "the controller is off"
        await asyncio.sleep(0.1)

    made.run(play)


def test_a_restart_ordered_by_a_signal_restarts(bench):
    async def play(b):
        await b.start()
        await asyncio.sleep(0.2)
        assert b.value("phase") == 1
        before = b.controller.system.tasks["T_ROB1"]
        b.controller.set_input("i0", 1)
        await asyncio.sleep(0.2)
        assert not b.controller.is_running
        assert b.controller.system.tasks["T_ROB1"] is not before
        b.controller.system.find("T_ROB1", "phase").set(0)
        await b.start()
        await asyncio.sleep(0.2)
        assert b.value("phase") == 1

    signals = [SignalConfig("i0", SignalKind.DI)]
    inputs = [SystemInput("i0", "SystemRestart")]
    bench(WAITING, signals=signals, system_inputs=inputs).run(play)


def test_states_are_told_by_digital_outputs_only(bench):
    async def play(b):
        assert any("MotorOn -> a0" in line for entry in b.controller.log for line in entry.cause)

    signals = [SignalConfig("a0", SignalKind.AO, logical_min=5, logical_max=10)]
    bench(WAITING, signals=signals, system_outputs=[SystemOutput("MotorOn", "a0")]).run(play)
