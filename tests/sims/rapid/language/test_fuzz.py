"""Any text gives modules or located errors, soon, whatever stands in it."""

import time
from contextlib import suppress

from hypothesis import example, given
from hypothesis import strategies as st

from sims.rapid.builtin import TaskKind
from sims.rapid.check import check
from sims.rapid.errors import Diagnostic, RapidLoadError
from sims.rapid.lexer import KEYWORDS
from sims.rapid.parser import decode, parse_expression, parse_text

SYMBOLS = "+ - * / = <> < <= > >= := ( ) { } [ ] , ; : . \\ ? | %"
WORDS = "a num string pos x 1 .5 1E9 0xF <SMT> <EXP> <ID> %%% ! ERRNO MoveL\\Conc"

PIECES = [
    *sorted(KEYWORDS),
    *SYMBOLS.split(),
    *WORDS.split(),
    '"s"',
    '"open',
    "\n",
    "\r",
    "\u3000",
    "\x00",
    "MODULE m\nPROC p()\n",
    "ENDPROC\nENDMODULE\n",
    "VAR num a{2}:=[1,2];\n",
    "IF a THEN\n",
    "FUNC num f(num a\\num b|switch c)\n",
    "x:=a{1}.b;\n",
]

soup = st.lists(st.one_of(st.sampled_from(PIECES), st.text(max_size=3)), max_size=60).map(" ".join)


def _look(text: str) -> list[Diagnostic]:
    modules, wrong = parse_text(text, "x")
    lines = text.replace("\r\n", "\n").replace("\r", "\n").split("\n")
    for item in wrong:
        assert 1 <= item.at.line <= len(lines)
        assert 1 <= item.at.column <= len(lines[item.at.line - 1]) + 1
    assert modules or wrong
    found = check(modules, kind=TaskKind.NORMAL, has_motion=True, signals=None)
    assert all(item.at.source in ("x", "types.sys") for item in found)
    return wrong


@given(soup)
@example("MODULE m PROC p() TEST a x; CASE 1: ENDTEST ENDPROC ENDMODULE")
@example("MODULE m PROC p( ENDPROC ENDMODULE")
@example("MODULE m PROC p(REF")
@example("MODULE <ID> PROC <ID>(<PAR>,<PAR>) ENDPROC ENDMODULE")
@example("MODULE m RECORD r r a; ENDRECORD VAR r x{x}; VAR r y:=[y]; ENDMODULE")
@example("MODULE m FUNC f f(f f) RETURN f(f\\f?f); ENDFUNC ENDMODULE")
def test_any_words_are_modules_or_located_errors(text: str) -> None:
    _look(text)
    _look(f"MODULE m\nPROC p()\n{text}")


@given(st.binary(max_size=200))
def test_any_bytes_are_text_or_refused(data: bytes) -> None:
    text = decode(data)
    if text is not None:
        _look(text)


@given(st.one_of(soup, st.text(max_size=20)))
def test_any_text_is_an_expression_or_refused(text: str) -> None:
    with suppress(RapidLoadError):
        parse_expression(text)


def test_time_grows_no_faster_than_the_text() -> None:
    """Shapes that make careless parsers quadratic: a megabyte of each is done in seconds."""
    shapes = [
        "(",
        '"',
        "a ",
        "IF a THEN\n",
        "x := ;\n",
        "<",
        "%",
        "%%%",
        "MODULE m\n",
        "rP (",
        "rP (a), \n",
        "!\n",
        "\\a",
        "[1,",
        "CASE 1:\n",
        "PROC p(\n",
        "1.",
        "VAR num a;\n",
    ]
    for shape in shapes:
        text = "MODULE m\nPROC p()\n" + shape * (200_000 // len(shape))
        begin = time.process_time()
        parse_text(text, "x")
        assert time.process_time() - begin < 5.0, shape
