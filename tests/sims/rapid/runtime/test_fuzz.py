"""Whatever a program does, only RAPID's own errors come out, and it ends or is stopped."""

import asyncio

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.sims.rapid.runtime.bench import play

NUMBERS = [
    "a",
    "b",
    "list{a}",
    "list{2}",
    "grid{1, b}",
    "p.x",
    "recs{2}.at.y",
    "g",
    "0",
    "2",
    "-.5",
]
STRINGS = ["s", '"x"', "names{1}", "recs{1}.name", "StrPart(s, 1, 1)", "ValToStr(recs)"]
BOOLS = ["TRUE", "FALSE", "ok", "do1 = 1"]
TARGETS = ["a", "b", "list{a}", "grid{b, 1}", "p.x", "recs{a}.at.y", "g"]

number = st.deferred(
    lambda: st.one_of(
        st.sampled_from(NUMBERS),
        st.builds("({} {} {})".format, number, st.sampled_from("+-*/"), number),
        st.builds("f({})".format, number),
        st.builds("Abs({})".format, number),
        st.builds("StrLen({})".format, text),
    )
)
text = st.deferred(
    lambda: st.one_of(st.sampled_from(STRINGS), st.builds("({} + {})".format, text, text))
)
condition = st.deferred(
    lambda: st.one_of(
        st.sampled_from(BOOLS),
        st.builds("({} {} {})".format, number, st.sampled_from(["<", "=", "<>", ">="]), number),
        st.builds("({} {} {})".format, condition, st.sampled_from(["AND", "OR", "XOR"]), condition),
        st.builds("NOT {}".format, condition),
    )
)
simple = st.one_of(
    st.builds("{} := {};".format, st.sampled_from(TARGETS), number),
    st.builds("{} := {};".format, st.sampled_from(["s", "names{1}"]), text),
    st.builds("ok := {};".format, condition),
    st.builds("q {}, a \\opt:=b;".format, number),
    st.builds("%{}% {};".format, text, number),
    st.builds("WaitTime {};".format, number),
    st.builds("WaitUntil {} \\MaxTime:=0.2;".format, condition),
    st.builds("RAISE {};".format, st.sampled_from(["5", "a", "b"])),
    st.sampled_from(
        [
            "recs{1} := recs{2};", "recs := recs;", "p := p + p;", "recs{2}.at := p;", "nosuch;",
            "g := g + 1;", "RETURN;", "Stop;", "ExitCycle;", "Incr a;", "SetDO do1, 1;",
            "SocketCreate sock;", 'SocketBind sock, "192.168.125.1", 1;', "SocketListen sock;",
            "SocketAccept sock, sock \\Time:=0.1;", "SocketReceive sock \\Str:=s \\Time:=0.1;",
            'SocketSend sock \\Str:="x";', "SocketClose sock;", "IDelete id;", "ITimer 0.05, id;",
            "CONNECT id WITH hit;", "IPers g, id;", "IDisable;", "IEnable;", "EXIT;",
        ]
    ),
)  # fmt: skip
statements = st.deferred(
    lambda: st.lists(
        st.one_of(
            simple,
            st.builds("IF {} THEN\n{}\nELSE\n{}\nENDIF".format, condition, statements, statements),
            st.builds("WHILE {} DO\n{}\nENDWHILE".format, condition, statements),
            st.builds("FOR i FROM {} TO {} DO\n{}\nENDFOR".format, number, number, statements),
            st.builds(
                "TEST {}\nCASE 1, b:\n{}\nDEFAULT:\n{}\nENDTEST".format,
                number,
                statements,
                statements,
            ),
        ),
        max_size=4,
    ).map("\n".join)
)
handler = st.one_of(
    st.just(""),
    st.builds(
        "ERROR{}\n{}\n{}".format,
        st.sampled_from(["", " (ERR_DIVZERO, 5)", " (LONG_JMP_ALL_ERR)"]),
        statements,
        st.sampled_from(["RETRY;", "TRYNEXT;", "RAISE;", "RETURN;", "RAISE 6;", ""]),
    ),
)
DATA = """
    RECORD rec
        string name;
        pos at;
    ENDRECORD
    VAR num a := 1;
    VAR num b := 2;
    VAR num list{3};
    VAR num grid{2, 2};
    VAR pos p;
    VAR rec recs{2};
    VAR string s := "q";
    VAR string names{2};
    VAR bool ok;
    VAR socketdev sock;
    VAR intnum id;
    PERS num g := 0;
"""


four_bodies = st.lists(statements, min_size=4, max_size=4)
three_handlers = st.lists(handler, min_size=3, max_size=3)


@settings(max_examples=40)
@given(four_bodies, three_handlers)
def test_a_random_program_ends_with_an_error_of_its_own_or_goes_on(bodies, handlers):
    play_random(bodies, handlers)


@pytest.mark.slow
@pytest.mark.timeout(600)
@settings(max_examples=1500)
@given(four_bodies, three_handlers)
def test_so_do_very_many(bodies, handlers):
    play_random(bodies, handlers)


def play_random(bodies, handlers):
    main, q, f, trap = bodies
    h1, h2, h3 = handlers
    program = f"""
{DATA}
PROC main()
{main}
{h1}
ENDPROC
PROC q(num x, INOUT num y \\num opt)
{q.replace("FALSE", "Present(opt)")}
{h2}
UNDO
a := 0;
ENDPROC
FUNC num f(num x)
{f.replace("RETURN;", "RETURN x;")}
RETURN x;
{h3.replace("RETURN;", "RETURN x;")}
ENDFUNC
TRAP hit
{trap}
ENDTRAP
"""

    async def script(system):
        (task,) = system.tasks.values()
        for _ in range(3):
            if task.pointer is None:
                task.pp_to_main()
            task.start()
            await asyncio.sleep(0.06)
            task.stop()
            await task.stopped()
            assert "Internal error" not in system.host.log.titles
        assert len(task.machine.frames) <= 500
        task.pp_to_main()
        assert len(task.stack) == 1

    play(script, program)
