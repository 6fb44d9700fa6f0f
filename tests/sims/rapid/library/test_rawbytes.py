"""rawbytes: layouts, bounds, and that nothing is written where nothing may be."""

import struct

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.sims.rapid.runtime.bench import result, run, value


def packed(*instructions: str, data: str = "") -> bytes:
    text = f"VAR rawbytes raw;\n{data}\nPROC main()\n" + "\n".join(instructions) + "\nENDPROC"
    return bytes(result(text, "raw"))


@pytest.mark.parametrize(
    ("instruction", "data"),
    [
        ("PackRawBytes 1, raw, 1\\IntX:=USINT;", b"\x01"),
        ("PackRawBytes -2, raw, 1\\IntX:=INT;", b"\xfe\xff"),
        ("PackRawBytes 258, raw\\Network, 1\\IntX:=UINT;", b"\x01\x02"),
        ("PackRawBytes 70000, raw, 1\\IntX:=DINT;", struct.pack("<i", 70000)),
        ("PackRawBytes big, raw, 1\\IntX:=UDINT;", struct.pack("<I", 4294967295)),
        ("PackRawBytes 1.5, raw, 1\\Float4;", struct.pack("<f", 1.5)),
        ("PackRawBytes 1.5, raw\\Network, 1\\Float4;", struct.pack(">f", 1.5)),
        ('PackRawBytes "ab\\E9", raw, 1\\ASCII;', b"ab\xe9"),
        ("PackRawBytes 10, raw, 1\\Hex1;", b"\x0a"),
    ],
)
def test_a_value_is_packed_as_its_switch_says(instruction: str, data: bytes) -> None:
    assert packed(instruction, data="VAR dnum big := 4294967295;") == data


def test_packing_appends_overwrites_and_keeps_the_rest() -> None:
    data = packed(
        'PackRawBytes "abcd", raw, 1\\ASCII;',
        'PackRawBytes "XY", raw, 2\\ASCII;',
        'PackRawBytes "!", raw, RawBytesLen(raw)+1\\ASCII;',
    )
    assert data == b"aXYd!"


@given(st.integers(-(2**15), 2**15 - 1), st.floats(-1e6, 1e6, width=32), st.text("az{", max_size=9))
def test_what_was_packed_is_unpacked(whole: int, real: float, text: str) -> None:
    program = f"""
        VAR rawbytes raw; VAR num n; VAR num f; VAR string s;
        PROC main()
            PackRawBytes {whole}, raw\\Network, 1\\IntX:=INT;
            PackRawBytes StrLen("{text}"), raw, 3\\IntX:=USINT;
            PackRawBytes "{text}", raw, 4\\ASCII;
            PackRawBytes {real:.9g}, raw, RawBytesLen(raw)+1\\Float4;
            UnpackRawBytes raw\\Network, 1, n\\IntX:=INT;
            UnpackRawBytes raw, 4, s\\ASCII:=StrLen("{text}");
            UnpackRawBytes raw, RawBytesLen(raw)-3, f\\Float4;
        ENDPROC
    """
    system = run(program)
    assert [value(system, name) for name in ("n", "f", "s")] == [whole, real, text]


@pytest.mark.parametrize(
    "instruction",
    [
        "PackRawBytes 1, raw, 3\\Hex1;",
        "PackRawBytes 1, raw, 0\\Hex1;",
        "PackRawBytes 1, raw, 1.5\\Hex1;",
        "PackRawBytes 256, raw, 1\\Hex1;",
        "PackRawBytes 0.5, raw, 1\\IntX:=DINT;",
        "PackRawBytes 40000, raw, 1\\IntX:=INT;",
        "PackRawBytes TRUE, raw, 1\\Hex1;",
        "PackRawBytes 1, raw, 1;",
        "UnpackRawBytes raw, 1, n\\Float4;",
        "UnpackRawBytes raw, 2, n\\Hex1;",
        "UnpackRawBytes raw, 1, s\\ASCII:=81;",
        "UnpackRawBytes raw, 1, n\\IntX:=3;",
        "CopyRawBytes raw, 1, full, 1025;",
        "CopyRawBytes full, 1, raw, 2;",
        "CopyRawBytes raw, 1, raw, 1\\NoOfBytes:=2;",
        "ClearRawBytes raw\\FromIndex:=3;",
    ],
)
def test_what_does_not_fit_is_an_error_and_changes_nothing(instruction: str) -> None:
    program = f"""
        VAR rawbytes raw; VAR rawbytes full; VAR num n; VAR string s; VAR bool failed;
        PROC main()
            PackRawBytes 7, raw, 1\\Hex1;
            FOR i FROM 1 TO 1024 DO
                PackRawBytes 1, full, i\\Hex1;
            ENDFOR
            {instruction}
        ERROR
            failed := ERRNO = ERR_OUTOFBND OR ERRNO = ERR_ARGVALERR;
            TRYNEXT;
        ENDPROC
    """
    system = run(program)
    assert value(system, "failed")
    assert bytes(value(system, "raw")) == b"\x07"
    assert len(value(system, "full")) == 1024


def test_copies_and_cuts_count_from_one() -> None:
    data = packed(
        'PackRawBytes "abcdef", raw, 1\\ASCII;',
        "CopyRawBytes raw, 2, raw2, 1\\NoOfBytes:=3;",
        "ClearRawBytes raw\\FromIndex:=3;",
        "CopyRawBytes raw2, 1, raw, 3;",
        data="VAR rawbytes raw2;",
    )
    assert data == b"abbcd"
