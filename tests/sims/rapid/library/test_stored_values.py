"""Values in files, modules that are saved, texts from tables, names of types."""

from pathlib import Path

import pytest

from sims.rapid.builtin import BUILTINS, TaskKind
from sims.rapid.names import UNSUPPORTED
from sims.rapid.parser import parse_file, parse_routine_head
from sims.rapid.system import RapidSystem
from tests.sims.rapid.runtime.bench import Host, make, result, run, value


def test_values_of_any_type_come_back_from_a_file_as_they_were(tmp_path: Path) -> None:
    program = """
        VAR iodev f; VAR robtarget r; VAR string s; VAR num n{3}; VAR num wrong; VAR num ended;
        CONST robtarget p := [[1.1,2,3],[1,0,0,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
        PROC main()
            VAR bool b;
            Open "HOME:/a.bin", f\\Write\\Bin;
            WriteAnyBin f, p; WriteAnyBin f, "a""b"; WriteAnyBin f, [1,2.5,1E-40]; WriteAnyBin f, 3;
            Close f;
            Open "HOME:/a.bin", f\\Read\\Bin;
            ReadAnyBin f, r; ReadAnyBin f, s; ReadAnyBin f, n;
            ReadAnyBin f, b;
            ReadAnyBin f, b;
        ERROR
            IF ERRNO = ERR_RANYBIN_CHK wrong := wrong + 1;
            IF ERRNO = ERR_RANYBIN_EOF ended := ended + 1;
            TRYNEXT;
        ENDPROC
    """.replace("WriteAnyBin f, [1,2.5,1E-40];", "n := [1,2.5,1E-40]; WriteAnyBin f, n;")
    system = run(program, host=Host(home=tmp_path))
    assert value(system, "r") == value(system, "p")
    assert value(system, "s") == 'a"b'
    assert value(system, "n") == [1, 2.5, pytest.approx(1e-40, rel=1e-4)]
    assert [value(system, "wrong"), value(system, "ended")] == [1, 1]


@pytest.mark.parametrize(
    "content",
    [b"\x01", b"\xff\xff\xff\xff", b"\x02\0\0\0[]", b"\x04\0\0\0nope", b'\x0c\0\0\0["num",1e999]'],
)
def test_a_file_of_something_else_is_an_error_of_the_program(
    tmp_path: Path, content: bytes
) -> None:
    (tmp_path / "a").write_bytes(content)
    program = """
        VAR iodev f; VAR num n; VAR num result;
        PROC main()
            Open "HOME:/a", f\\Read\\Bin;
            ReadAnyBin f, n;
        ERROR
            result := ERRNO;
            TRYNEXT;
        ENDPROC
    """
    assert result(program, host=Host(home=tmp_path)) > 0


def test_a_saved_module_has_the_values_of_its_persistents_and_loads_again(tmp_path: Path) -> None:
    text = "\n".join(
        [
            "MODULE Kept",
            'PERS num a := 1.000000000000000000000000; ! one; "',
            'PERS string s:="x;y" ; PERS num b{2}:=[1,',
            "  2]; ! two",
            "LOCAL PERS num c := 1 + 2;",
            "VAR num v := 7;",
            "PROC main()",
            'a := 2.5; s := "!;"; b := [3,4]; c := 9; v := 8;',
            'Save "Kept" \\FilePath:="HOME:" \\File:="kept.mod";',
            "ENDPROC",
            "ENDMODULE",
        ]
    )
    run(text, host=Host(home=tmp_path))
    trees, wrong = parse_file(tmp_path / "kept.mod")
    assert not wrong
    system = RapidSystem(Host())

    system.add_task("T_ROB1", TaskKind.NORMAL, True, trees)
    system.load()
    names = ("a", "s", "b", "Kept:c", "v")
    assert [value(system, name) for name in names] == [2.5, "!;", [3, 4], 9, 7]
    assert "! two" in (tmp_path / "kept.mod").read_text()


def test_texts_come_from_installed_tables(tmp_path: Path) -> None:
    (tmp_path / "t.eng").write_text('# texts\nMINE::\n1:\n"first"\n12:\n"say ""it"""\n')
    program = """
        VAR string texts{2}; VAR bool was_free{2}; VAR num table; VAR num result;
        PROC main()
            was_free{1} := TextTabFreeToUse("mine");
            TextTabInstall "HOME:/t.eng";
            was_free{2} := TextTabFreeToUse("MINE");
            table := TextTabGet("mine");
            texts{1} := TextGet(table, 1);
            texts{2} := TextGet(table, 2);
        ERROR
            result := ERRNO; TRYNEXT;
        ENDPROC
    """
    system = run(program, host=Host(home=tmp_path))
    assert value(system, "texts") == ["first", ""]
    assert value(system, "was_free") == [True, False]
    assert value(system, "result") == value(system, "ERR_ARGVALERR")


def test_type_tells_the_declared_type_and_what_it_stands_for() -> None:
    program = """
        VAR string result{3}; VAR errnum e; VAR pos p;
        PROC main()
            result{1} := Type(e); result{2} := Type(e\\BaseName); result{3} := Type(p);
        ENDPROC
    """
    assert result(program) == ["errnum", "num", "pos"]


def test_a_component_of_a_call_is_its_value_and_a_warning() -> None:
    program = """
        VAR num result{3}; VAR pose p := [[1,2,3],[1,0,0,0]];
        FUNC pose twice(pose given) given.trans.x := 2 * given.trans.x; RETURN given; ENDFUNC
        PROC main()
            result{1} := PoseInv(p).trans.y;
            result{2} := twice(p).trans.x + twice(PoseInv(p)).trans.x;
            result{3} := Offs(CRobTLike(),1,0,0).trans.x;
        ENDPROC
        FUNC robtarget CRobTLike()
            RETURN [[5,0,0],[1,0,0,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
        ENDFUNC
    """.replace("given) given", "given)\ngiven")
    assert result(program) == [-2, 0, 6]


def test_persistents_keep_their_values_over_a_load_if_asked_to() -> None:
    text = "LOCAL PERS num a := 1; PERS pos p := [1,2,3]; VAR num v := 4; PROC main() ENDPROC"
    system = make(text.replace("main() ", "main()\n"))
    kept_names = ("Bench:a", "p", "v")
    for name, new in zip(kept_names, (5, [6, 7, 8], 9), strict=True):
        system.find("T_ROB1", name).set(new)
    kept = system.persistents()
    system.load()
    assert [value(system, name) for name in kept_names] == [1, [1, 2, 3], 4]
    system.restore(kept)
    assert [value(system, name) for name in kept_names] == [5, [6, 7, 8], 4]


def test_a_persistent_of_another_type_starts_anew() -> None:
    kept = make("PERS num a := 1;\nPROC main()\nENDPROC").persistents()
    other = make('PERS string a := "x";\nPROC main()\nENDPROC')
    other.restore(kept)
    assert value(other, "a") == "x"


def test_what_is_refused_by_name_is_not_built() -> None:
    built = {parse_routine_head(one.declaration).name.lower() for one in BUILTINS}
    assert not built & UNSUPPORTED.keys()
    assert len(built) == len(BUILTINS)
