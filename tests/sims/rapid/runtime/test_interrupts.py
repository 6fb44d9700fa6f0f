import asyncio

from tests.sims.rapid.runtime.bench import play, result, run, value

COUNT = """
    VAR intnum id;
    VAR num count;
    VAR num result;
    PERS num flag := 0;
    TRAP hit
        count := count + 1;
    ENDTRAP
"""


def test_a_trap_runs_between_statements_as_soon_as_its_persistent_changes():
    program = """
        PROC main()
            CONNECT id WITH hit;
            IPers flag, id;
            flag := 1;
            result := count;
            flag := 1;
            flag := 2;
            result := result * 10 + count;
        ENDPROC
    """
    assert result(COUNT + program) == 12


def test_a_wait_goes_on_while_a_trap_runs():
    program = """
        VAR clock watch;
        PROC main()
            CONNECT id WITH hit;
            ITimer 0.3, id;
            ClkStart watch;
            WaitTime 1;
            IDelete id;
            result := ClkRead(watch);
        ENDPROC
    """
    system = run(COUNT + program)
    assert value(system, "count") == 3
    assert value(system, "result") == 1.0


def test_a_trap_that_waits_holds_the_program_but_not_the_clock():
    program = """
        VAR clock watch;
        TRAP slow
            WaitTime 2;
            count := count + 1;
        ENDTRAP
        PROC main()
            CONNECT id WITH slow;
            ITimer \\Single, 0.5, id;
            ClkStart watch;
            WaitTime 1;
            result := ClkRead(watch) + 100 * count;
        ENDPROC
    """
    assert result(COUNT + program) == 102.5


def test_a_trap_is_not_interrupted_by_a_trap():
    program = """
        VAR intnum other;
        VAR string trace;
        TRAP slow
            trace := trace + "(";
            flag := flag + 1;
            WaitTime 0.1;
            trace := trace + ")";
        ENDTRAP
        TRAP quick
            trace := trace + "q";
        ENDTRAP
        PROC main()
            CONNECT id WITH slow;
            CONNECT other WITH quick;
            ITimer \\Single, 0.1, id;
            IPers flag, other;
            WaitTime 1;
        ENDPROC
    """
    assert result(COUNT + program, "trace") == "()q"


def test_disabled_interrupts_wait_and_sleeping_ones_are_lost():
    program = """
        PROC main()
            CONNECT id WITH hit;
            IPers flag, id;
            IDisable;
            flag := 1;
            flag := 2;
            result := count;
            IEnable;
            result := result * 10 + count;
            ISleep id;
            flag := 3;
            IWatch id;
            result := result * 10 + count;
            flag := 4;
            result := result * 10 + count;
        ENDPROC
    """
    # Both traps run before the statement behind IEnable.
    assert result(COUNT + program) == 223


def test_a_single_interrupt_comes_once():
    program = """
        PROC main()
            CONNECT id WITH hit;
            ISignalDO \\Single, do1, 1, id;
            SetDO do1, 1;
            SetDO do1, 0;
            SetDO do1, 1;
            result := count;
        ENDPROC
    """
    assert result(COUNT + program) == 1


def test_signals_interrupt_at_the_wanted_value_or_any_edge():
    program = """
        VAR intnum both;
        VAR intnum group;
        VAR num edges;
        VAR num groups;
        TRAP edge
            edges := edges + 1;
        ENDTRAP
        TRAP changed
            groups := groups + 1;
        ENDTRAP
        PROC main()
            CONNECT id WITH hit;
            CONNECT both WITH edge;
            CONNECT group WITH changed;
            ISignalDO do1, 0, id;
            ISignalDO do1, edge, both;
            ISignalGO go1, group;
            FOR i FROM 1 TO 3 DO
                SetDO do1, 1;
                SetDO do1, 0;
                SetGO go1, i;
            ENDFOR
            result := 100 * count + 10 * edges + groups;
        ENDPROC
    """
    program = program.replace("TRAP edge", "TRAP anyedge").replace("WITH edge", "WITH anyedge")
    assert result(COUNT + program) == 363


def test_raise_in_a_trap_lands_in_the_handler_of_the_interrupted_routine():
    program = """
        TRAP hit2
            RAISE 55;
        ENDTRAP
        PROC main()
            CONNECT id WITH hit2;
            ITimer \\Single, 0.5, id;
            work;
        ENDPROC
        PROC work()
            WaitTime 10;
            result := result + 100;
        ERROR (55)
            result := result + 1;
            TRYNEXT;
        ENDPROC
    """
    system = run(COUNT + program)
    assert value(system, "result") == 101
    assert not system.tasks["T_ROB1"].machine.interrupts.in_trap


def test_a_trap_knows_its_interrupt_and_an_event_can_be_read():
    program = """
        VAR string title;
        VAR trapdata data;
        VAR errdomain domain;
        VAR errtype kind;
        VAR num number;
        VAR string text1;
        TRAP event
            GetTrapData data;
            ReadErrData data, domain, number, kind \\Title:=title \\Str1:=text1;
            IF INTNO = id result := 1;
        ENDTRAP
        PROC main()
            CONNECT id WITH event;
            IError COMMON_ERR, TYPE_ERR, id;
            ErrWrite \\W, "only a warning", "x";
            ErrWrite "Door open", "close it";
        ENDPROC
    """
    system = run(COUNT + program)
    names = ("result", "title", "text1", "domain", "number")
    assert [value(system, name) for name in names] == [1, "Door open", "close it", 8, 1]


def test_too_many_interrupts_are_dropped_with_a_warning():
    program = """
        PROC main()
            CONNECT id WITH hit;
            IPers flag, id;
            IDisable;
            FOR i FROM 1 TO 150 DO
                flag := i;
            ENDFOR
            IEnable;
            result := count;
        ENDPROC
    """
    system = run(COUNT + program)
    assert value(system, "result") == 100
    assert len(system.host.log.entries) == 50


def test_a_message_interrupts_its_receiver():
    receiver = """
        VAR intnum id;
        VAR num got;
        VAR rmqmessage message;
        PERS num result := 0;
        TRAP arrived
            RMQGetMessage message;
            RMQGetMsgData message, got;
            result := got;
        ENDTRAP
        PROC main()
            CONNECT id WITH arrived;
            IRMQMessage got, id;
            WaitTime 5;
        ENDPROC
    """
    sender = """
        VAR rmqslot slot;
        PROC main()
            WaitTime 1;
            RMQFindSlot slot, "RMQ_T_ROB1";
            RMQSendMessage slot, 42;
        ENDPROC
    """
    sender = sender.replace("RMQSendMessage slot, 42;", "data := 42; RMQSendMessage slot, data;")
    sender = "VAR num data;" + sender
    system = run(receiver, sender)
    assert value(system, "result") == 42


def test_pp_to_main_forgets_interrupts_and_what_waits():
    program = """
        PROC main()
            CONNECT id WITH hit;
            ITimer 0.1, id;
            WaitTime 100;
        ENDPROC
    """

    async def script(system):
        task = system.tasks["T_ROB1"]
        task.start()
        await asyncio.sleep(1.05)
        task.stop()
        await task.stopped()
        assert value(system, "count") == 10
        task.pp_to_main()
        assert value(system, "count") == 0
        await asyncio.sleep(1)
        task.start()
        await asyncio.sleep(0.25)
        assert value(system, "count") == 2

    play(script, COUNT + program)
