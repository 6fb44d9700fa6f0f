"""Maths, bits, strings and conversions, as programs get them."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sims.rapid.formats import fixed_text, number_text, text_to_value, value_text
from tests.sims.rapid.runtime.bench import result


def answer(kind: str, expression: str, data: str = "") -> object:
    return result(f"VAR {kind} result;\n{data}\nPROC main()\nresult := {expression};\nENDPROC")


def failure(expression: str, data: str = "") -> str:
    """The name of the error that an expression raises."""
    return result(
        f'VAR string result := "none";\nVAR num number;\n{data}\nPROC main()\n{expression};\n'
        "ERROR\n"
        'number := ERRNO;\nIF number = ERR_ARGVALERR result := "ERR_ARGVALERR";\n'
        'IF number = ERR_DIVZERO result := "ERR_DIVZERO";\n'
        'IF number = ERR_INT_NOTVAL result := "ERR_INT_NOTVAL";\n'
        'IF number = ERR_STRTOOLNG result := "ERR_STRTOOLNG";\n'
        'IF number = ERR_OUTOFBND result := "ERR_OUTOFBND";\n'
        "TRYNEXT;\nENDPROC"
    )


@pytest.mark.parametrize(
    ("expression", "value"),
    [
        ("Abs(-2.5)", 2.5),
        ("Sqrt(9)", 3.0),
        ("Sin(30)", 0.5),
        ("Cos(90)", 0.0),
        ("Sin(180)", 0.0),
        ("Sin(-720)", 0.0),
        ("Tan(45)", 1.0),
        ("ASin(1)", 90.0),
        ("ACos(-1)", 180.0),
        ("ATan(1)", 45.0),
        ("ATan2(-1,-1)", -135.0),
        ("Pow(2,10)", 1024.0),
        ("Exp(0)", 1.0),
        ("Round(2.5)", 3.0),
        ("Round(-2.5)", -3.0),
        ("Round(0.3852138\\Dec:=3)", 0.385),
        ("Trunc(-2.99)", -2.0),
        ("Trunc(0.3856138\\Dec:=3)", 0.385),
        ("Max(2,-3)", 2.0),
        ("Min(2,-3)", -3.0),
        ("BitAnd(12,10)", 8.0),
        ("BitOr(12,10)", 14.0),
        ("BitXOr(12,10)", 6.0),
        ("BitNeg(1)", 254.0),
        ("BitLSh(129,1)", 2.0),
        ("BitRSh(129,7)", 1.0),
        ('StrLen("abc")', 3.0),
        ('StrFind("Robotics",1,"aeiou")', 2.0),
        ('StrFind("Robotics",1,"aeiou"\\NotInSet)', 1.0),
        ('StrFind("abc",1,"x")', 4.0),
        ('StrMatch("Robotics",1,"bo")', 3.0),
        ('StrMatch("Robotics",4,"bo")', 9.0),
        ('StrMatch("",1,"x")', 1.0),
        ('StrToByte("FF"\\Hex)', 255.0),
        ('StrToByte("a"\\Char)', 97.0),
        ("DnumToNum(7)", 7.0),
        ("VectMagn([3,4,0])", 5.0),
        ("DotProd([1,2,3],[4,5,6])", 32.0),
        ("Distance([0,0,1],[0,0,-1])", 2.0),
        ("EulerZYX(\\Z, OrientZYX(30,20,10))", 30.0),
        ("EulerZYX(\\Y, OrientZYX(30,20,10))", 20.0),
        ("EulerZYX(\\X, OrientZYX(30,20,10))", 10.0),
        ("EulerZYX(\\Z, OrientZYX(30,90,0))", 30.0),
    ],
)
def test_functions_of_num(expression: str, value: float) -> None:
    assert answer("num", expression) == pytest.approx(value, rel=1e-6, abs=1e-6)


@pytest.mark.parametrize(
    ("expression", "value"),
    [
        ("NumToStr(-1.1,2)", "-1.10"),
        ("NumToStr(0,2)", "0.00"),
        ("NumToStr(-0.001,2)", "0.00"),
        ("NumToStr(3.7,0)", "4"),
        ("NumToStr(9E9,0)", "8999999488"),
        ("NumToStr(1234.5,2\\Exp)", "1.23E+03"),
        ("DnumToStr(0.1,6)", "0.100000"),
        ("ValToStr(p)", "[1,2.5,-3]"),
        ("ValToStr(0.1)", "0.1"),
        ("ValToStr(9E9)", "9E+09"),
        ("ValToStr(TRUE)", "TRUE"),
        ('StrPart("Robotics",1,5)', "Robot"),
        ('StrPart("ab",3,0)', ""),
        ('StrMap("Robotics","aeiou","AEIOU")', "RObOtIcs"),
        ('StrMap("abc",STR_LOWER,STR_UPPER)', "ABC"),
        ("ByteToStr(122\\Hex)", "7A"),
        ("ByteToStr(5\\Bin)", "00000101"),
        ("ByteToStr(8\\Okt)", "010"),
        ("ByteToStr(97\\Char)", "a"),
        ("ByteToStr(9)", "9"),
        ('DecToHex("255")', "FF"),
        ('HexToDec("fF")', "255"),
        ('StrDigCalc("4294967290",OpAdd,"5")', "4294967295"),
        ('StrDigCalc("10",OpSub,"3")', "7"),
        ('StrDigCalc("65535",OpMult,"65537")', "4294967295"),
        ('StrDigCalc("10",OpDiv,"3")', "3"),
        ('StrDigCalc("10",OpMod,"3")', "1"),
        ('StrFormat("{2}-{1}-{3}-{x}"\\Arg1:="a"\\Arg2:="{1}")', "{1}-a-{3}-{x}"),
    ],
)
def test_functions_of_string(expression: str, value: str) -> None:
    assert answer("string", expression, "CONST pos p := [1,2.5,-3];") == value


@pytest.mark.parametrize(
    ("expression", "value"),
    [
        ('StrMemb("Robotics",2,"aeiou")', True),
        ('StrMemb("Robotics",1,"aeiou")', False),
        ('StrOrder("FIRST","SECOND",STR_UPPER)', True),
        ('StrOrder("B","AA",STR_UPPER)', False),
        ('StrOrder("A","AA",STR_UPPER)', True),
        ('StrDigCmp("1234",LT,"1256")', True),
        ('StrDigCmp("9",GT,"10")', False),
        ("BitCheck(130,8)", True),
        ("BitCheck(130,1)", False),
    ],
)
def test_functions_of_bool(expression: str, value: bool) -> None:
    assert answer("bool", expression) is value


@pytest.mark.parametrize(
    ("expression", "error"),
    [
        ("a := Sqrt(-1)", "ERR_ARGVALERR"),
        ("a := ACos(2)", "ERR_ARGVALERR"),
        ("a := Tan(90)", "ERR_DIVZERO"),
        ('s := StrDigCalc("1",6,"3")', "ERR_ARGVALERR"),
        ('s := StrDigCalc("-1",OpAdd,"3")', "ERR_INT_NOTVAL"),
        ("a := Round(1\\Dec:=1.5)", "ERR_ARGVALERR"),
        ("a := BitAnd(256,1)", "ERR_ARGVALERR"),
        ("a := BitLSh(1,9)", "ERR_ARGVALERR"),
        ('s := StrPart("abc",2,3)', "ERR_ARGVALERR"),
        ('s := StrPart("abc",0,1)', "ERR_ARGVALERR"),
        ('a := StrToByte("256")', "ERR_INT_NOTVAL"),
        ('a := StrToByte("-1")', "ERR_INT_NOTVAL"),
        ('b := StrDigCmp("x",LT,"1")', "ERR_INT_NOTVAL"),
        ("s := DnumToStr(1E300,2)", "ERR_STRTOOLNG"),
        ("s := ValToStr(long)", "ERR_STRTOOLNG"),
    ],
)
def test_what_is_not_defined_is_an_error_that_a_handler_sees(expression: str, error: str) -> None:
    data = "VAR num a; VAR string s; VAR bool b; VAR robtarget long := "
    data += "[[1.23456,2.34567,3.45678],[1,0,0,0],[-1,0,-1,0],[9E9,9E9,9E9,9E9,9E9,9E9]];\n"
    data += "VAR bool unused;"
    data = data.replace("[1,0,0,0],", "[.123456,.234567,.345678,.456789],")
    assert failure(expression, data) == error


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("007", 7.0),
        ("+1.5", 1.5),
        (".25", 0.25),
        ("-2.", -2.0),
        (" 1e3 ", 1000.0),
        ("", None),
        ("1 2", None),
        ("abc", None),
        ("0x10", None),
        ("1e", None),
        ("nan", None),
        ("1E39", None),
    ],
)
def test_strtoval_takes_the_numbers_that_are_numbers(text: str, value: float | None) -> None:
    program = f"""
        VAR num result := 99;
        VAR bool ok;
        PROC main()
            ok := StrToVal("{text}", result);
            IF NOT (ok OR result <> 99) result := -99;
        ENDPROC
    """
    assert result(program) == (-99 if value is None else value)


def test_strtoval_reads_records_and_leaves_data_alone_when_it_cannot() -> None:
    program = """
        VAR pos result;
        VAR bool ok;
        VAR pose p;
        PROC main()
            ok := StrToVal("[[1,2,3],[1,0,0,0]]", p) AND NOT StrToVal("[9,9]", p.trans)
                AND NOT StrToVal("[9,9,9", p.trans) AND NOT StrToVal("[9,9,TRUE]", p.trans);
            IF ok result := p.trans;
        ENDPROC
    """
    assert result(program) == [1.0, 2.0, 3.0]


def test_counting_instructions_count() -> None:
    program = """
        VAR num result := 5;
        VAR dnum d := 1;
        VAR num a{2} := [1,10];
        PROC main()
            Incr result; Incr result; Decr result;
            Add result, 2.5;
            Add d, 4294967296;
            Incr a{2};
            IF d = 4294967297 AND a{2} = 11 Add result, 0.5;
            Clear a{1};
            Add result, a{1};
        ENDPROC
    """
    assert result(program) == 9.0


@given(st.floats(width=32, allow_nan=False, allow_infinity=False))
def test_a_number_survives_as_text_to_six_digits(value: float) -> None:
    read = text_to_value(number_text(value), 0.0)
    assert read == pytest.approx(value, rel=1e-5)
    assert math.isfinite(read)


@given(st.floats(width=32, allow_nan=False, allow_infinity=False), st.integers(0, 15))
def test_fixed_text_has_its_decimals_and_no_negative_zero(value: float, decimals: int) -> None:
    text = fixed_text(value, decimals)
    assert len(text.partition(".")[2]) == decimals
    assert float(text) != 0.0 or not text.startswith("-")


values = st.recursive(
    st.one_of(
        st.booleans(), st.integers(-999999, 999999).map(float), st.text('a"[], ', max_size=5)
    ),
    lambda inner: st.lists(inner, min_size=1, max_size=4),
    max_leaves=12,
)


@given(values)
def test_any_value_is_read_back_from_its_text(value: object) -> None:
    assert text_to_value(value_text(value), value) == value


@given(st.text('[]",.+-0123456789eE TRUFALS', max_size=30), values)
def test_any_text_is_a_value_of_the_right_make_or_none(text: str, like: object) -> None:
    read = text_to_value(text, like)
    assert read is None or type(read) is type(like)
