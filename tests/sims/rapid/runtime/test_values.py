import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sims.rapid.errors import RapidError
from sims.rapid.values import binary32, divide_whole, modulo
from tests.sims.rapid.runtime.bench import Host, load_errors, result, run, value

single = st.floats(width=32, allow_nan=False, allow_infinity=False)


@given(single, single, st.sampled_from("+-*/"))
def test_arithmetic_is_that_of_binary32(a, b, op):
    x, y = np.float32(a), np.float32(b)
    with np.errstate(all="ignore"):
        expected = {"+": x + y, "-": x - y, "*": x * y, "/": x / y if b else None}[op]
    if expected is None or not np.isfinite(expected):
        with pytest.raises((RapidError, ZeroDivisionError)):
            binary32(eval(f"a {op} b"))
    else:
        assert binary32(eval(f"a {op} b")) == float(expected)


@given(st.integers(-1000, 1000), st.integers(-30, 30).filter(bool))
def test_div_and_mod_go_towards_zero(a, b):
    quotient, rest = divide_whole(float(a), float(b)), modulo(float(a), float(b))
    assert quotient * b + rest == a
    assert abs(rest) < abs(b)
    assert rest == 0 or (rest > 0) == (a > 0)


@given(st.lists(st.tuples(single, st.sampled_from("+-*")), min_size=1, max_size=6))
def test_every_operation_of_an_expression_is_rounded(terms):
    expected = np.float32(1)
    text = "1"
    with np.errstate(all="ignore"):
        for number, op in terms:
            text = f"({text}) {op} ({np.format_float_positional(np.float32(number))})"
            x = np.float32(number)
            expected = {"+": expected + x, "-": expected - x, "*": expected * x}[op]
            if not np.isfinite(expected):
                return
    text = text.replace("(-", "(0 - ").replace(".)", ")")
    assert result(f"VAR num result;\nPROC main()\nresult := {text};\nENDPROC") == float(expected)


def evaluated(kind, expression, data="", before=""):
    return result(
        f"{data}\nVAR {kind} result;\nPROC main()\n{before}\nresult := {expression};\nENDPROC"
    )


@pytest.mark.parametrize(
    ("kind", "expression", "expected"),
    [
        ("num", "2 + 3 * 4 - 6 / 4", 12.5),
        ("num", "-7 DIV 2", -3),
        ("num", "-7 MOD 2", -1),
        ("num", ".5 + 1E1", 10.5),
        ("num", "0.1", float(np.float32(0.1))),
        ("dnum", "0.1", 0.1),
        ("dnum", "0.1 + 0.2", 0.1 + 0.2),
        ("dnum", "1 / 3", 1 / 3),
        ("num", "16777216 + 1", 16777216),
        ("bool", "TRUE OR 1 / zero = 1", True),
        ("bool", "FALSE AND 1 / zero = 1", False),
        ("bool", "TRUE XOR TRUE", False),
        ("bool", "NOT FALSE AND 1 < 2", True),
        ("bool", 'NOT ("a" = "A")', True),
        ("bool", "p = [1, 2, 3]", True),
        ("bool", "[1, 2, 3] <> p", False),
        ("string", '"a" + "b""" + "\\41"', 'ab"A'),
        ("pos", "p + [1, 1, 1] * 2", [3, 4, 5]),
        ("pos", "2 * p - p", [1, 2, 3]),
        ("pos", "-p", [-1, -2, -3]),
        ("pos", "p * [0, 0, 1]", [2, -1, 0]),
        ("pos", "p / 2", [0.5, 1, 1.5]),
        ("orient", "[0, 1, 0, 0] * [0, 1, 0, 0]", [-1, 0, 0, 0]),
        ("num", "list{k + 1}.y", 5),
        ("num", "Dim(list, 1)", 2),
        ("string", 'StrPart("hello", 2, 3)', "ell"),
    ],
)
def test_expressions_mean_what_they_say(kind, expression, expected):
    data = """
        VAR num zero;
        VAR num k := 1;
        VAR pos p := [1, 2, 3];
        VAR pos list{2} := [[1, 2, 3], [4, 5, 6]];
    """
    assert evaluated(kind, expression, data) == expected


def test_lists_are_values_when_assigned_passed_and_returned():
    program = """
        RECORD part
            num id;
            pos at;
        ENDRECORD
        CONST pos home := [1, 2, 3];
        VAR part a;
        VAR part b;
        VAR part all{2};
        VAR string result;
        FUNC part changed(part x)
            x.at.x := 99;
            RETURN x;
        ENDFUNC
        FUNC part stored()
            RETURN a;
        ENDFUNC
        PROC through(VAR part x)
            x.at.y := 55;
        ENDPROC
        PROC main()
            VAR part c;
            a := [1, home];
            b := a;
            b.at.x := 10;
            all{1} := b;
            all{2} := all{1};
            all{2}.at.z := 30;
            c := changed(b);
            c := stored();
            c.id := 7;
            through all{1};
            result := ValToStr(a) + ValToStr(b) + ValToStr(all{1}.at) + ValToStr(all{2}.at);
        ENDPROC
    """
    assert result(program) == "[1,[1,2,3]][1,[10,2,3]][10,55,3][10,2,30]"


def test_constants_refer_forward_across_modules_and_give_dimensions():
    program = """
        MODULE A
            CONST num total := rows * cols + Abs(offset);
            VAR num grid{rows, cols};
            VAR num result;
            PROC main()
                grid{rows, cols} := total;
                result := grid{2, 3} + Dim(grid, 2);
            ENDPROC
        ENDMODULE
        MODULE B
            CONST num offset := -100;
            CONST num rows := 2;
            CONST num cols := rows + 1;
        ENDMODULE
    """
    assert result(program) == 109


def test_names_are_local_then_of_the_module_then_global_and_in_any_case():
    program = """
        MODULE A
            LOCAL VAR num x := 1;
            VAR string result;
            PROC main()
                note x;
                shadow 5;
                FOR X FROM 7 TO 7 DO
                    note x;
                ENDFOR
                NOTE X;
                fromB;
            ENDPROC
            PROC shadow(num x)
                note x;
                block;
            ENDPROC
            PROC block()
                VAR num x := 6;
                note x;
            ENDPROC
            PROC note(num value)
                result := result + ValToStr(value);
            ENDPROC
        ENDMODULE
        MODULE B
            VAR num x := 2;
            LOCAL PROC note(num value)
                result := result + "b" + ValToStr(value);
            ENDPROC
            PROC fromB()
                note x;
            ENDPROC
        ENDMODULE
    """
    assert result(program) == "15671b2"


def test_optional_arguments_are_present_passed_on_or_absent():
    program = """
        VAR string result;
        VAR num got;
        PROC inner(\\num a \\switch s | switch t \\VAR num back, num must)
            IF Present(a) result := result + "a" + ValToStr(a);
            IF Present(s) result := result + "s";
            IF Present(t) result := result + "t";
            IF Present(back) back := must;
        ENDPROC
        PROC outer(num must \\num a \\switch s \\VAR num back)
            inner \\a?a \\s?s \\back?back, must;
        ENDPROC
        PROC main()
            inner 1;
            inner \\a:=5 \\t \\back:=got, 2;
            result := result + ValToStr(got) + "/";
            outer 3;
            outer 4 \\s;
            outer 6, \\a:=7, \\back:=got;
            result := result + ValToStr(got);
        ENDPROC
    """
    assert result(program) == "a5t2/sa76"


def test_an_absent_argument_that_is_used_stops_the_program():
    system = run("PROC inner(\\num a)\n a := a + 1;\n ENDPROC\n PROC main()\n inner;\n ENDPROC")
    assert "Present()" in system.host.log.entries[0].cause[2]


def test_calls_in_expressions_keep_the_order_of_the_source():
    program = """
        VAR num count;
        VAR string result;
        FUNC num next(string name)
            count := count + 1;
            result := result + name;
            RETURN count;
        ENDFUNC
        PROC main()
            VAR num a;
            VAR num list{3};
            a := count + next("a") * 10 + count + next("b") * 100;
            result := result + ValToStr(a);
            list{next("c")} := next("d");
            result := result + ValToStr(list{3});
            IF next("e") > 100 AND next("f") > 0 result := result + "!";
            IF next("g") > 0 OR next("h") > 0 result := result + "?";
            WHILE next("w") < 9 DO
            ENDWHILE
        ENDPROC
    """
    assert result(program) == "ab211cd4eg?www"


def test_arguments_and_items_before_a_call_keep_the_value_they_had():
    program = """
        VAR num count := 1;
        VAR pos at;
        VAR string result;
        FUNC num next()
            count := count + 1;
            RETURN count;
        ENDFUNC
        PROC note(num a, num b, num c)
            result := result + ValToStr(a) + ValToStr(b) + ValToStr(c);
        ENDPROC
        PROC main()
            at := [count, next(), count];
            note count, next(), count;
            result := result + ValToStr(at);
        ENDPROC
    """
    assert result(program) == "233[1,2,2]"


def test_for_counts_up_down_and_by_steps():
    program = """
        VAR string result;
        PROC main()
            FOR i FROM 1 TO 3 DO
                result := result + ValToStr(i);
            ENDFOR
            FOR i FROM 3 TO 1 DO
                result := result + ValToStr(i);
            ENDFOR
            FOR i FROM 0 TO 1 STEP 0.5 DO
                result := result + "," + ValToStr(i);
            ENDFOR
            FOR i FROM 5 TO 1 STEP 1 DO
                result := result + "never";
            ENDFOR
            FOR i FROM 5 TO 4 STEP -1 DO
                result := result + ";" + ValToStr(i);
            ENDFOR
        ENDPROC
    """
    assert result(program) == "123321,0,0.5,1;5;4"


def test_test_goto_and_compact_if():
    program = """
        VAR string result;
        VAR num k;
        PROC main()
        again:
            k := k + 1;
            TEST k
            CASE 1, 2:
                result := result + "a";
            CASE 3:
                result := result + "b";
            DEFAULT:
                result := result + "c";
            ENDTEST
            TEST ValToStr(k)
            CASE "2":
                result := result + "!";
            ENDTEST
            IF k < 4 GOTO again;
        ENDPROC
    """
    assert result(program) == "aa!bc"


def test_signals_are_values_in_expressions():
    program = """
        VAR num result;
        VAR signaldo led;
        PROC main()
            AliasIO do1, led;
            SetDO led, 1;
            SetGO go1, 12;
            SetAO ao1, 2.5;
            PulseDO \\PLength:=0.5, do2;
            IF do1 = 1 AND do2 = 1 result := go1 + ao1;
            WaitTime 1;
            result := result + DOutput(do2) + 100 * led;
        ENDPROC
    """
    assert result(program) == 114.5


def test_data_is_found_by_name_and_by_type():
    program = """
        PERS num first := 1;
        VAR num second := 2;
        VAR string result;
        PROC main()
            VAR datapos at;
            VAR string name;
            VAR num x;
            SetDataVal "second", first;
            GetDataVal "SECOND", x;
            result := ValToStr(x);
            SetDataSearch "num" \\Object:=".*s.*";
            WHILE GetNextSym(name, at) DO
                GetDataVal name \\Block:=at, x;
                result := result + name + ValToStr(x);
            ENDWHILE
            IF IsPers(first) AND NOT IsPers(second) AND IsVar(second) result := result + "!";
        ENDPROC
    """
    assert result(program) == "1first1second1!"


@pytest.mark.parametrize(
    ("line", "word"),
    [
        ("VAR num a{2000, 2000};", "1000000"),
        ("CONST num a := b; CONST num b := a;", "itself"),
        ("VAR num a{k}; VAR num k;", "CONST"),
        ("VAR nosuch a;", "nosuch"),
        ("RECORD r nosuch x; ENDRECORD", "nosuch"),
        ("VAR num a := \"x\";", "string"),
        ("CONST num a := 1 / (1 - 1);", "load"),
        ("CONST num a := 1E39;", "1e+39"),
        ("VAR pos a := [1, 2];", "pos"),
        ("PROC q()\n nosuch := 1;\n ENDPROC", "nosuch"),
        ("PROC q()\n SyncMoveUndo;\n ENDPROC", "MultiMove"),
        ("PROC q()\n TPWrite 5;\n ENDPROC", "string"),
        ("PROC q()\n VAR num a{200000};\n ENDPROC", "100000"),
    ],
)  # fmt: skip
def test_what_cannot_be_is_refused_at_load_with_a_place(line, word):
    errors = load_errors(f"{line}\nPROC main()\nENDPROC")
    assert any(word.lower() in error.lower() for error in errors), errors
    assert all(error.startswith("test.mod:") for error in errors)


def test_a_module_that_is_loaded_at_run_time_is_called_by_name(tmp_path):
    (tmp_path / "more.mod").write_text(
        "MODULE More\n VAR num inside := 4;\n PROC extra()\n result := inside;\n ENDPROC\nENDMODULE"
    )
    program = """
        VAR num result;
        VAR string trace;
        PROC main()
            extra;
            Load \\Dynamic, "HOME:/more.mod";
            extra;
            %"extra"%;
            Load \\Dynamic, "HOME:" \\File:="more.mod";
            UnLoad "HOME:/more.mod";
            extra;
        ERROR
            IF ERRNO = ERR_REFUNKPRC trace := trace + "u";
            IF ERRNO = ERR_LOADED trace := trace + "l";
            TRYNEXT;
        ENDPROC
    """
    system = run(program, host=Host(home=tmp_path))
    assert value(system, "result") == 4
    assert value(system, "trace") == "ulu"
