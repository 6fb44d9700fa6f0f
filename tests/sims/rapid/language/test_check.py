"""What is wrong with a program for certain, and that a valid one is left alone."""

from collections.abc import Collection

import pytest

from sims.controller import instructions
from sims.rapid import library
from sims.rapid.builtin import TaskKind
from sims.rapid.check import check
from sims.rapid.errors import Severity
from sims.rapid.parser import parse_text

library.register()
instructions.register()


def messages(
    text: str,
    *,
    signals: Collection[str] | None = (),
    has_motion: bool = True,
    severity: Severity = Severity.ERROR,
    **options: object,
) -> list[str]:
    modules, wrong = parse_text(text, "a.mod")
    assert not wrong, [str(item) for item in wrong]
    found = check(
        modules,
        kind=TaskKind.NORMAL if has_motion else TaskKind.SEMISTATIC,
        has_motion=has_motion,
        signals=signals,
        **options,  # type: ignore[arg-type]
    )
    return [item.message for item in found if item.severity is severity]


DATA = """
 CONST num k:=3; VAR num n; VAR dnum d; VAR bool b; VAR string s; VAR num a{3}; VAR num a2{k,2};
 VAR pos p; PERS tooldata t:=[TRUE,[[0,0,0],[1,0,0,0]],[1,[0,0,1],[1,0,0,0],0,0,0]];
 VAR tooldata vt; VAR robtarget r; VAR intnum i; VAR rawbytes raw;
 RECORD mine num x; string y; ENDRECORD
 VAR mine m; VAR mine ms{2}; ALIAS num level; VAR level lv;
 PROC rp(num q, VAR string w \\num opt) ENDPROC
 FUNC num rf(num q) RETURN q; ENDFUNC
 TRAP trapped ENDTRAP
"""


def statements(text: str, rest: str = "", **options: object) -> list[str]:
    return messages(f"MODULE m {DATA} PROC main() {text} {rest} ENDPROC ENDMODULE", **options)


@pytest.mark.parametrize(
    "text",
    [
        "n:=lv+k*2; lv:=n; d:=1; d:=n; b:=n>1 AND NOT b; s:=s+NumToStr(n,2);",
        'm:=[1,"a"]; m.x:=n; ms{2}:=m; ms:=[m,[n,s]]; a2{1,2}:=a{2}; a:=[n,1,2];',
        "p:=p+p*2; p:=2*p; n:=p.x; r.trans:=p; r:=Offs(r,0,0,1); p:=r.trans;",
        "rp n,s; rp(n,s); rp n, m.y\\opt:=2; n:=rf(rf(1));",
        "FOR j FROM 1 TO Trunc(k) DO a{j}:=j; ENDFOR",
        'TEST n CASE 1,k: s:=""; DEFAULT: ENDTEST',
        'TEST s CASE "a": n:=1; ENDTEST',
        "again: GOTO again;",
        "MoveL r, v100, fine, t; MoveJ\\Conc, r, vmax\\T:=2, z10, t\\WObj:=wobj0; ConfL\\Off; "
        "MoveL [p,[1,0,0,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]], v100, fine, tool0;",
        "PackRawBytes n, raw, RawBytesLen(raw)+1\\Float4; UnpackRawBytes raw,1,s\\ASCII:=3;",
        "CONNECT i WITH trapped; RAISE 5; RETURN;",
        "b:=StrToVal(s,m); b:=StrToVal(s,n); Incr n; s:=ValToStr(p);",
        '%"rp"% 1, s; NotThere n; n:=NotThere2(n);',
        "n:=ERRNO; n:=ERR_DIVZERO; n:=di1; b:=di1=1; IF di1=high n:=1; n:=di1+1;",
        'b:=m=[1,"a"]; b:=p=r.trans; b:=s<>"x";',
    ],
)
def test_valid_programs_have_no_errors(text: str) -> None:
    assert statements(text, signals=["DI1"]) == []


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("n:=unheard;", "unheard is not known"),
        ("unheard:=1;", "unheard is not known"),
        ("k:=1;", "k is a CONST"),
        ("tool0.robhold:=nothing;", "nothing is not known"),
        ("FOR j FROM 1 TO 2 DO j:=1; ENDFOR", "variable of FOR"),
        ('n:="a";', "what is assigned to is a num, this is a string"),
        ("b:=1;", "is a bool, this is a num"),
        ("s:=n+s;", "a num + a string is not defined"),
        ("IF n THEN ENDIF", "a condition is a bool"),
        ("WHILE s DO ENDWHILE", "a condition is a bool"),
        ("b:=n=s;", "cannot be compared"),
        ("p:=[1,2];", "pos has 3 components, here are 2"),
        ('p:=[1,2,"3"];', "this component is a num"),
        ("n:=p.w;", "pos has no component w; it has x, y, z"),
        ("n:=n.x;", "a num has no components"),
        ("n:=a{1,2};", "2 indices"),
        ("n:=a;", "a num{*}"),
        ("n:=n{1};", "no array"),
        ("rp n;", "rp needs w as well"),
        ("rp n,s,n;", "takes 2 required arguments"),
        ("rp n,s\\opt:=1\\opt:=2;", "given twice"),
        ("rp n,s\\other;", "no optional argument \\other; it has \\opt"),
        ("rp n,s\\opt;", "needs a value"),
        ('rp n,"x";', "w of rp is VAR: it needs data"),
        ("rp s,s;", "q of rp is a num, this is a string"),
        ("rp n,STR_DIGIT;", "STR_DIGIT is a CONST"),
        ("MoveL r, v100, fine, vt;", "has to be a PERS: declare vt as one"),
        ("ConfL\\On\\Off;", "exclude each other"),
        ("rf n;", "is a FUNC, not a PROC"),
        ("n:=rp(1);", "is a PROC and has no value"),
        ("trapped;", "CONNECT it"),
        ("n:=rf;", "call it with ()"),
        ("GOTO nowhere;", "no label nowhere in main"),
        ("x: x: n:=1;", "stands twice"),
        ("RETRY;", "RETRY stands in an ERROR handler only"),
        ("TRYNEXT;", "TRYNEXT stands in an ERROR handler only"),
        ("RAISE;", "RAISE without a number"),
        ("RETURN 1;", "returns no value"),
        ("CONNECT i WITH main;", "CONNECT needs a TRAP"),
        ("CONNECT i WITH nobody;", "no TRAP nobody"),
        ("EGMRunPose 1;", "Externally Guided Motion"),
        ("rp n,s\\opt?n;", "optional parameter of this routine"),
        ("b:=Present(n);", "optional parameter of its own"),
        ('TEST n CASE "a": ENDTEST', "TEST is about a num"),
        ("n:=-s;", "has no sign"),
    ],
)
def test_what_is_wrong_is_said_with_what_to_do(text: str, why: str) -> None:
    found = statements(text)
    assert len(found) == 1, found
    assert why in found[0]


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("VAR nosuch x;", "the type nosuch is not known"),
        ("VAR seamdata x;", "arc welding"),
        ("VAR num x; VAR num X;", "declared already in line 1"),
        ("VAR num n:=2; VAR num x{n};", "n is not a CONST"),
        ("VAR num x{0};", "whole number from 1"),
        ("VAR num x{1,1,1,1};", "4 dimensions"),
        ('VAR num x:="a";', "is a num, this is a string"),
        ("RECORD r r x; ENDRECORD", "holds itself"),
        ("RECORD q r x; ENDRECORD RECORD r q x; ENDRECORD", "holds itself"),
        ("RECORD q num x; num X; ENDRECORD", "two components"),
        ("ALIAS b a; ALIAS a b;", "not known"),
        ("PROC p(num a, num A) ENDPROC", "stands twice"),
        ("PROC p(num a) VAR num a; ENDPROC", "declared twice"),
        ("PROC p() PERS num a:=1; ENDPROC", "PERS: declare it in the module"),
        ("FUNC num f() RETURN; ENDFUNC", "RETURN needs a value"),
        ("FUNC num f() RETURN TRUE; ENDFUNC", "the result of f is a num"),
    ],
)
def test_declarations_are_checked(text: str, why: str) -> None:
    found = messages(f"MODULE m {text} ENDMODULE")
    assert found
    assert all(why in message for message in found), found


def test_a_module_sees_its_own_local_names_and_no_others() -> None:
    text = (
        "MODULE a LOCAL VAR num x; VAR num y; PROC p() x:=y; ENDPROC ENDMODULE\n"
        "MODULE b LOCAL VAR bool x; PROC q() x:=TRUE; y:=1; p; ENDPROC ENDMODULE\n"
        "MODULE c PROC r() x:=1; ENDPROC ENDMODULE"
    )
    assert messages(text) == ["x is not known: declare it, or configure the signal"]


def test_two_modules_of_one_task_do_not_share_a_global_name() -> None:
    text = "MODULE a VAR num x; ENDMODULE MODULE b PROC x() ENDPROC ENDMODULE"
    assert messages(text) == ["x is declared in a too: make one LOCAL"]
    assert messages(text, same_task=False) == []


def test_a_program_may_use_a_predefined_name_for_itself() -> None:
    text = (
        "MODULE a VAR string reg1; PROC Incr(string a) ENDPROC "
        "PROC p() Incr reg1; ENDPROC ENDMODULE"
    )
    assert messages(text) == []


def test_an_undeclared_name_may_be_a_signal_where_signals_are_not_known() -> None:
    text = "MODULE a PROC p() IF di7=1 THEN ENDIF ENDPROC ENDMODULE"
    assert messages(text, signals=None) == []
    assert len(messages(text, signals=None, severity=Severity.WARNING)) == 1
    assert messages(text, signals=["DI7"]) == []
    assert len(messages(text, signals=[])) == 1


def test_motion_in_a_background_task_is_a_warning() -> None:
    text = f"MODULE m {DATA} PROC main() MoveL r, v100, fine, t; ENDPROC ENDMODULE"
    assert messages(text, severity=Severity.WARNING) == []
    (found,) = messages(text, has_motion=False, severity=Severity.WARNING)
    assert "only in a motion task" in found


def test_persistents_have_one_type_in_all_tasks() -> None:
    same = "MODULE o ALIAS num level; PERS level shared; ENDMODULE"
    assert (
        messages("MODULE m PERS num shared; ENDMODULE", others={"T": parse_text(same, "o")[0]})
        == []
    )
    theirs = parse_text('MODULE o PERS string shared:=""; TASK PERS num own; ENDMODULE', "o")[0]
    text = "MODULE m PERS num shared; PERS bool own; ENDMODULE"
    (found,) = messages(text, others={"T_2": theirs})
    assert "string in task T_2" in found


def test_a_function_without_return_is_a_warning() -> None:
    text = "MODULE m FUNC num f() ENDFUNC ENDMODULE"
    assert "no RETURN" in messages(text, severity=Severity.WARNING)[0]


@pytest.mark.parametrize(
    ("condition", "count"),
    [
        ("NOT a AND b", 1),
        ("NOT (a) AND b", 1),
        ("NOT (a AND b)", 0),
        ("(NOT a) AND b", 0),
        ("a AND NOT b AND c", 0),
        ("NOT a OR b", 0),
        ("b OR NOT a=c AND b", 1),
    ],
)
def test_not_before_and_is_a_warning_unless_parentheses_say_what_is_meant(
    condition: str, count: int
) -> None:
    text = f"MODULE m\nVAR bool a; VAR bool b; VAR bool c;\nPROC p()\nIF {condition} p;\n"
    found = messages(text + "ENDPROC\nENDMODULE", severity=Severity.WARNING)
    assert len(found) == count
