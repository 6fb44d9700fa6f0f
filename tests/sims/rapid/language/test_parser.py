"""What the parser makes of the language, tier by tier, and of syntax that is easily missed."""

from pathlib import Path

import pytest

from sims.rapid import ast
from sims.rapid.errors import Diagnostic, RapidLoadError, Severity
from sims.rapid.parser import (
    MAX_NESTING,
    parse_expression,
    parse_file,
    parse_routine_head,
    parse_text,
)


def parsed(text: str) -> ast.Module:
    modules, wrong = parse_text(text, "a.mod")
    assert not wrong, [str(item) for item in wrong]
    return modules[0]


def body(statements: str, rest: str = "") -> tuple[ast.Statement, ...]:
    routine = parsed(f"MODULE m\nPROC p()\n{statements}\n{rest}\nENDPROC\nENDMODULE").declarations[
        0
    ]
    assert isinstance(routine, ast.RoutineDecl)
    return routine.body


def shape(expr: ast.Expr | None) -> object:
    """The tree without places: what binds to what."""
    match expr:
        case ast.Number() | ast.StringLiteral() | ast.BoolLiteral():
            return expr.value
        case ast.Name():
            return expr.name
        case ast.Aggregate():
            return [shape(item) for item in expr.items]
        case ast.Field():
            return (shape(expr.base), ".", expr.name)
        case ast.Index():
            return (shape(expr.base), *("*" if i is None else shape(i) for i in expr.indices))
        case ast.Unary():
            return (expr.op, shape(expr.operand))
        case ast.Binary():
            return (shape(expr.left), expr.op, shape(expr.right))
        case ast.Call():
            return (expr.name, *(shape(argument.value) for argument in expr.arguments))
    return None


@pytest.mark.parametrize(
    ("text", "tree"),
    [
        (".5", 0.5),
        ("1E3", 1000.0),
        ("9E+09", 9e9),
        ("0xFF", 255.0),
        ("0b101", 5.0),
        ("007", 7.0),
        ("a+b*c", ("a", "+", ("b", "*", "c"))),
        ("a-b-c", (("a", "-", "b"), "-", "c")),
        ("-a*b", ("-", ("a", "*", "b"))),
        ("-a+b", (("-", "a"), "+", "b")),
        ("a*-b", ("a", "*", ("-", "b"))),
        ("a DIV b MOD c", (("a", "DIV", "b"), "MOD", "c")),
        ("a OR b AND c", ("a", "OR", ("b", "AND", "c"))),
        ("NOT a AND b", ("NOT", ("a", "AND", "b"))),
        ("a AND NOT b", ("a", "AND", ("NOT", "b"))),
        ("NOT a OR b", (("NOT", "a"), "OR", "b")),
        ("NOT a = b", ("NOT", ("a", "=", "b"))),
        ("a=TRUE and b<>2", (("a", "=", True), "AND", ("b", "<>", 2.0))),
        ("a{1,i}.trans.x", ((("a", 1.0, "i"), ".", "trans"), ".", "x")),
        ("a.b{*}", ((("a", ".", "b"), "*"))),
        ("[[1,x],f(y),TRUE]", [[1.0, "x"], ("f", "y"), True]),
        ("(a)", "a"),
    ],
)
def test_what_binds_to_what(text: str, tree: object) -> None:
    assert shape(parse_expression(text)) == tree


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ('"a""b"', 'a"b'),
        (r'"\0A\0d"', "\n\r"),
        (r'"\\0A"', "\\0A"),
        (r'"x\y"', r"x\y"),
        ('"! no comment"', "! no comment"),
        ('""', ""),
        ('"' + "x" * 80 + '"', "x" * 80),
    ],
)
def test_strings_mean_what_they_say(text: str, value: str) -> None:
    assert shape(parse_expression(text)) == value


def test_arguments_are_required_optional_and_conditional() -> None:
    (call,) = body("MoveL\\Conc, p{2}, v100\\T:=5, fine,\\Tool:=t\\WObj?w \\Sw;")
    assert isinstance(call, ast.ProcCall)
    assert [(a.name, a.is_optional, shape(a.value)) for a in call.arguments] == [
        ("Conc", True, None),
        (None, False, ("p", 2.0)),
        (None, False, "v100"),
        ("T", True, 5.0),
        (None, False, "fine"),
        ("Tool", True, "t"),
        ("WObj", True, None),
        ("Sw", True, None),
    ]
    condition = call.arguments[6].condition
    assert condition is not None
    assert condition.name == "w"


@pytest.mark.parametrize(
    ("call", "count"),
    [("rP;", 0), ("rP();", 0), ("rP a;", 1), ("rP(a);", 1), ("rP(a,b);", 2), ("rP (a)+(b), c;", 2)],
)
def test_calls_are_written_with_and_without_parentheses(call: str, count: int) -> None:
    (node,) = body(call)
    assert isinstance(node, ast.ProcCall)
    assert len(node.arguments) == count


def test_late_calls_take_an_expression_and_arguments() -> None:
    (node,) = body('%"r"+NumToStr(n,0)% 1, b\\C;')
    assert isinstance(node, ast.LateCall)
    assert len(node.arguments) == 3


def test_compact_if_is_an_if_with_one_statement() -> None:
    first, second = body("IF NOT b Incr c;\nIF a=1 GOTO l;", "l:")[:2]
    assert isinstance(first, ast.If)
    assert shape(first.branches[0][0]) == ("NOT", "b")
    assert isinstance(second, ast.If)
    assert isinstance(second.branches[0][1][0], ast.Goto)


def test_blocks_nest_and_may_be_empty() -> None:
    nodes = body(
        "IF a THEN ELSEIF b THEN x:=1; ELSE ENDIF\nWHILE m DO ENDWHILE\n"
        "FOR i FROM 1 TO 9 STEP -2 DO ENDFOR\nTEST n CASE 1,2: x:=1; CASE 3: DEFAULT: ENDTEST"
    )
    assert [type(node) for node in nodes] == [ast.If, ast.While, ast.For, ast.Test]
    test = nodes[3]
    assert isinstance(test, ast.Test)
    assert [len(values) for values, _ in test.cases] == [2, 1]
    assert test.default == ()


def test_a_routine_has_its_clauses_in_any_order() -> None:
    routine = parsed(
        "MODULE m\nFUNC num f(num a \\num b | switch c, VAR num d{*,*}, PERS tooldata t, "
        "INOUT bool e)\nVAR num x{2}:=[1,2];\nRETURN a;\nBACKWARD\nr;\n"
        "ERROR (ERR_A, LONG_JMP_ALL_ERR)\nRETRY;\n"
        "ERROR\nRAISE;\nUNDO\ns;\nENDFUNC\nENDMODULE"
    ).declarations[0]
    assert isinstance(routine, ast.RoutineDecl)
    assert [(p.name, p.mode.value, p.rank, p.is_optional) for p in routine.params] == [
        ("a", "", 0, False),
        ("b", "", 0, True),
        ("c", "", 0, True),
        ("d", "VAR", 2, False),
        ("t", "PERS", 0, False),
        ("e", "INOUT", 0, False),
    ]
    assert routine.params[1].group == routine.params[2].group != 0
    first, last = routine.handlers
    assert (first.has_long_jump, len(first.numbers), len(last.numbers)) == (True, 1, 0)
    assert routine.undo is not None
    assert routine.backward is not None


def test_modules_declare_everything_in_any_order() -> None:
    module = parsed(
        "%%%\n VERSION:1\n LANGUAGE:ENGLISH\n%%%\n\nMODULE m(SYSMODULE, nostepin)\n"
        "LOCAL RECORD r\n num x; string s;\nENDRECORD\nALIAS num level;\n"
        "LOCAL PROC a() ENDPROC\nTASK PERS level n;\nPERS r t{3,4}:=[1];\nTRAP t1 ENDTRAP\n"
        "CONST num late:=-.5;\nENDMODULE\nthe end of\nthe file"
    )
    assert module.attributes == {"SYSMODULE", "NOSTEPIN"}
    assert [type(d).__name__ for d in module.declarations] == [
        "RecordDecl",
        "AliasDecl",
        "RoutineDecl",
        "DataDecl",
        "DataDecl",
        "RoutineDecl",
        "DataDecl",
    ]
    assert module.lines[5].startswith("MODULE m")


def test_a_text_may_hold_several_modules() -> None:
    modules, wrong = parse_text("MODULE a ENDMODULE\nin between\nMODULE b ENDMODULE", "x")
    assert [m.name for m in modules] == ["a", "b"]
    assert not wrong


def test_placeholders_are_statements_and_declarations_are_left_out_with_a_warning() -> None:
    modules, wrong = parse_text(
        "MODULE m\n<DDN>\nVAR num a:=<EXP>;\nPROC p(<PAR>)\n<SMT>\nx:=<EXP>;\n"
        "IF <EXP> THEN y:=1; ENDIF\nMoveL <ARG>, v1;\n<VAR> := 2;\nz;\nENDPROC\nENDMODULE",
        "x",
    )
    assert {item.severity for item in wrong} == {Severity.WARNING}
    (routine,) = modules[0].declarations
    assert isinstance(routine, ast.RoutineDecl)
    kinds = [type(node).__name__ for node in routine.body]
    assert kinds == ["Placeholder"] * 5 + ["ProcCall"]


def errors_of(text: str) -> list[Diagnostic]:
    return parse_text(text, "x")[1]


def test_all_errors_are_reported_with_their_places() -> None:
    wrong = errors_of(
        "MODULE m\nVAR num 5;\nPROC p()\n a := ;\n b := 2\n c := 3;\n foo(1,;\n"
        " IF a> THEN\n x := 1;\n ENDIF\n ENDWHILE\n d := 4;\nENDPROC\nCONST num k;\nENDMODULE"
    )
    assert [(d.at.line, d.at.column) for d in wrong] == [
        (2, 9),
        (4, 7),
        (5, 8),
        (7, 7),
        (8, 8),
        (11, 2),
        (14, 11),
    ]


def test_what_stands_around_an_error_is_still_there() -> None:
    modules, wrong = parse_text(
        "MODULE m\nPROC a()\n x := ;\n y := 1;\nENDPROC\nFUNC num b( oops\nENDFUNC\n"
        "VAR num c;\nENDMODULE",
        "x",
    )
    assert len(wrong) == 2
    names = [d.name for d in modules[0].declarations]
    assert names == ["a", "b", "c"]
    routine = modules[0].declarations[0]
    assert isinstance(routine, ast.RoutineDecl)
    assert len(routine.body) == 1


def test_an_open_block_is_said_once_where_it_is_missed() -> None:
    (wrong,) = errors_of(
        "MODULE m\nPROC p()\nIF a THEN\nWHILE b DO\nx;\nENDIF\ny;\nENDPROC\nENDMODULE"
    )
    assert "ENDWHILE is missing for the WHILE of line 4" in wrong.message
    assert wrong.at.line == 6


@pytest.mark.parametrize(
    "text",
    [
        "(" * 500 + "1" + ")" * 500,
        "[" * 500 + "1" + "]" * 500,
        "-" * 5000 + "1",
        "NOT " * 5000 + "a",
        "+".join(["a"] * 5000),
        "a" + ".b" * 5000,
        "f(" * 500 + ")" * 500,
        "a{" * 500 + "1" + "}" * 500,
    ],
)
def test_deep_expressions_are_an_error_and_no_crash(text: str) -> None:
    with pytest.raises(RapidLoadError, match=f"deeper than {MAX_NESTING}"):
        parse_expression(text)


def test_deep_blocks_are_an_error_and_no_crash() -> None:
    text = "MODULE m PROC p()\n" + "IF a THEN\n" * 3000 + "ENDIF\n" * 3000 + "ENDPROC ENDMODULE"
    assert any("nested deeper" in item.message for item in errors_of(text))


def test_long_strings_and_names_are_said() -> None:
    text = f'MODULE m\nVAR string s:="{"x" * 81}";\nVAR num {"n" * 33};\nENDMODULE'
    first, second = errors_of(text)
    assert (first.at.line, first.severity) == (2, Severity.ERROR)
    assert "81" in first.message
    assert (second.at.line, second.severity) == (3, Severity.WARNING)


def test_endless_errors_end() -> None:
    wrong = errors_of("MODULE m\nPROC p()\n" + "x := ;\n" * 5000)
    assert len(wrong) <= 201


@pytest.mark.parametrize("ends", ["\n", "\r\n", "\r"])
def test_lines_are_counted_whatever_ends_them(ends: str, tmp_path: Path) -> None:
    path = tmp_path / "a.mod"
    text = ends.join(["MODULE m", "! \xe9\xff", "VAR num 1;", "ENDMODULE"])
    path.write_bytes(text.encode("latin-1"))
    modules, (wrong,) = parse_file(path)
    assert wrong.at.line == 3
    assert modules[0].lines[1] == "! \xe9\xff"


def test_utf8_with_its_mark_and_wide_spaces_are_read(tmp_path: Path) -> None:
    path = tmp_path / "a.mod"
    path.write_bytes('\ufeffMODULE\u3000m\u3000\nVAR string s:="\xe9";\nENDMODULE'.encode())
    modules, wrong = parse_file(path)
    assert not wrong
    (data,) = modules[0].declarations
    assert isinstance(data, ast.DataDecl)
    assert shape(data.value) == "\xe9"
    path.write_bytes("MODULE\u3000m\nENDMODULE".encode())
    assert [m.name for m in parse_file(path)[0]] == ["m"]


def test_what_is_no_rapid_is_one_diagnostic(tmp_path: Path) -> None:
    path = tmp_path / "a.mod"
    path.write_bytes(b"MODULE\x00\x01\x02" * 99)
    assert "encoded" in parse_file(path)[1][0].message
    path.write_text("set I; param n;\nsubject to c: x <= 5;\n")
    (wrong,) = parse_file(path)[1]
    assert "no MODULE" in wrong.message
    assert "cannot be read" in parse_file(tmp_path / "none.mod")[1][0].message


def test_heads_of_built_ins_know_references() -> None:
    head = parse_routine_head(r"PROC P(\switch A | num B, REF anytype C, PERS num D{*})")
    assert [(p.name, p.mode.value) for p in head.params] == [
        ("A", ""),
        ("B", ""),
        ("C", "REF"),
        ("D", "PERS"),
    ]
    assert head.params[0].group == head.params[1].group == 1
    with pytest.raises(RapidLoadError):
        parse_routine_head("PROC P(")


@pytest.mark.parametrize(
    "text", ["", "1 2", "a b", "<EXP>", "1E999", '"open', "f(", "a{", "[1,", "@"]
)
def test_half_an_expression_is_refused(text: str) -> None:
    with pytest.raises(RapidLoadError):
        parse_expression(text)


def test_an_endless_file_is_read_to_its_limit_and_said(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sims.rapid.parser.MAX_CHARS", 1000)
    monkeypatch.setattr("sims.rapid.parser.modules.MAX_CHARS", 1000)
    modules, wrong = parse_text("MODULE m\n" + "! x\n" * 500 + "ENDMODULE", "x")
    assert "more than 1000 characters" in wrong[0].message
    assert len(parse_file("/dev/zero")[1]) == 1
    assert modules
