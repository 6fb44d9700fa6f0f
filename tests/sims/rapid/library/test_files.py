"""Files below HOME:, nowhere else; messages between tasks; dates."""

from pathlib import Path

import pytest

from tests.sims.rapid.runtime.bench import Host, result, run, value


def test_text_is_written_appended_and_read_back_line_by_line(tmp_path: Path) -> None:
    program = """
        VAR iodev f; VAR string a; VAR string b; VAR num n; VAR string eof1; VAR num eof2;
        PROC main()
            MakeDir "HOME:/logs";
            Open "HOME:"\\File:="logs/a.txt", f\\Write;
            Write f, "pos "\\Pos:=[1,2.5,3];
            Write f, "no end"\\NoNewLine;
            Close f;
            Open "/logs/a.txt", f\\Append;
            Write f, "!";
            Write f, "42.5";
            Close f;
            Open "home:/logs/a.txt", f\\Read;
            a := ReadStr(f);
            b := ReadStr(f);
            n := ReadNum(f);
            eof1 := ReadStr(f);
            eof2 := ReadNum(f);
            Close f;
        ENDPROC
    """
    system = run(program, host=Host(home=tmp_path))
    names = ("a", "b", "n", "eof1", "eof2")
    assert [value(system, name) for name in names] == [
        "pos [1,2.5,3]",
        "no end!",
        42.5,
        "EOF",
        9998,
    ]
    assert (tmp_path / "logs/a.txt").read_text() == "pos [1,2.5,3]\nno end!\n42.5\n"


def test_long_lines_come_in_pieces_of_80_and_delimiters_split(tmp_path: Path) -> None:
    (tmp_path / "a").write_bytes(b"x" * 100 + b"\r\n1;2\n")
    program = """
        VAR iodev f; VAR num lengths{2}; VAR num n{2};
        PROC main()
            Open "HOME:/a", f\\Read;
            lengths{1} := StrLen(ReadStr(f));
            lengths{2} := StrLen(ReadStr(f\\RemoveCR));
            n{1} := ReadNum(f\\Delim:=";");
            n{2} := ReadNum(f);
        ENDPROC
    """
    system = run(program, host=Host(home=tmp_path))
    assert value(system, "lengths") == [80, 20]
    assert value(system, "n") == [1, 2]


def test_bytes_are_written_and_read_and_the_end_is_an_error(tmp_path: Path) -> None:
    program = """
        VAR iodev f; VAR rawbytes raw; VAR num b{3}; VAR string s; VAR bool ended;
        PROC main()
            Open "HOME:/b", f\\Write\\Bin;
            WriteBin f, [0,255,7], 2;
            WriteStrBin f, "a\\0A";
            PackRawBytes 9, raw, 1\\Hex1;
            WriteRawBytes f, raw;
            Rewind f;
            b{1} := ReadBin(f);
            b{2} := ReadBin(f);
            s := ReadStrBin(f, 2);
            ReadRawBytes f, raw\\NoOfBytes:=4;
            b{3} := ReadBin(f);
            Close f;
        ERROR
            ended := ERRNO = ERR_RANYBIN_EOF;
            TRYNEXT;
        ENDPROC
    """
    system = run(program, host=Host(home=tmp_path))
    assert value(system, "ended")
    assert value(system, "b") == [0, 255, -1]
    assert value(system, "s") == "a\n"
    assert bytes(value(system, "raw")) == b"\x09"


ESCAPES = [
    'Open "HOME:/../secret", f\\Read;',
    'Open "HOME:"\\File:="../secret", f\\Read;',
    'Open "/../secret", f\\Append;',
    'Open "link", f\\Read;',
    'Open "HOME:/linkdir/secret", f\\Write;',
    'Open "TEMP:/x", f\\Write;',
    'Open "com1:", f\\Write;',
    'Open "HOME:/a:b", f\\Write;',
    'Open "HOME:/\\00", f\\Write;',
    'Open "HOME:", f\\Read;',
    'MakeDir "HOME:/../new";',
    'RemoveFile "HOME:/../secret";',
    'CopyFile "HOME:/../secret", "HOME:/x";',
    'RenameFile "HOME:/own", "HOME:/../stolen";',
    'RemoveDir "HOME:";',
    'RenameFile "HOME:", "HOME:/x";',
    'n := FileSize("HOME:/../secret");',
    'OpenDir d, "HOME:/..";',
    'Write f, "x";',
    "a := ReadStr(f);",
]


@pytest.mark.parametrize("instruction", ESCAPES)
@pytest.mark.parametrize("has_disk", [True, False])
def test_nothing_outside_home_is_touched(instruction: str, has_disk: bool, tmp_path: Path) -> None:
    home = tmp_path / "home"
    home.mkdir()
    (tmp_path / "secret").write_text("secret")
    (home / "own").write_text("own")
    (home / "link").symlink_to(tmp_path / "secret")
    (home / "linkdir").symlink_to(tmp_path)
    program = f"""
        VAR iodev f; VAR dir d; VAR num n; VAR string a; VAR bool refused;
        PROC main()
            {instruction}
        ERROR
            refused := ERRNO = ERR_FILEACC;
            TRYNEXT;
        ENDPROC
    """
    system = run(program, host=Host(home=home if has_disk else None))
    assert value(system, "refused")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["home", "secret"]
    assert (tmp_path / "secret").read_text() == "secret"
    assert sorted(path.name for path in home.iterdir()) == ["link", "linkdir", "own"]


def test_folders_are_listed_and_files_copied_renamed_removed(tmp_path: Path) -> None:
    (tmp_path / "a.txt").write_text("12345")
    program = """
        VAR dir d; VAR string name; VAR string names; VAR num n; VAR bool b{3}; VAR bool exists;
        PROC main()
            CopyFile "HOME:/a.txt", "HOME:/b.txt";
            RenameFile "HOME:/b.txt", "HOME:/c.txt";
            MakeDir "HOME:/sub";
            b{1} := IsFile("HOME:/c.txt"\\RegFile);
            b{2} := IsFile("HOME:/sub"\\Directory);
            b{3} := IsFile("HOME:/sub"\\RegFile);
            n := FileSize("HOME:/c.txt");
            IF FileTime("HOME:/c.txt"\\ModifyTime) < 1000000000 n := -1;
            RemoveFile "HOME:/a.txt";
            OpenDir d, "HOME:";
            WHILE ReadDir(d, name) DO
                names := names + name + " ";
            ENDWHILE
            CloseDir d;
            RenameFile "HOME:/c.txt", "HOME:/sub";
        ERROR
            exists := ERRNO = ERR_FILEEXIST;
            TRYNEXT;
        ENDPROC
    """
    system = run(program, host=Host(home=tmp_path))
    assert value(system, "names") == ". .. c.txt sub "
    assert value(system, "b") == [True, True, False]
    assert value(system, "n") == 5
    assert value(system, "exists")


def test_a_program_cannot_hold_endless_files_open(tmp_path: Path) -> None:
    program = """
        VAR iodev f{100}; VAR num opened; VAR bool refused;
        PROC main()
            FOR i FROM 1 TO 100 DO
                Open "HOME:"\\File:=NumToStr(i,0), f{i}\\Write;
                Incr opened;
            ENDFOR
        ERROR
            refused := ERRNO = ERR_FILEOPEN;
            FOR i FROM 1 TO 100 DO
                Close f{i};
            ENDFOR
            RETURN;
        ENDPROC
    """
    system = run(program, host=Host(home=tmp_path))
    assert value(system, "refused")
    assert value(system, "opened") <= 40


def test_tasks_send_each_other_values_of_any_type() -> None:
    first = """
        VAR rmqslot other; VAR rmqmessage m; VAR string answer; VAR rmqheader h; VAR num user;
        PROC main()
            WaitTime 0.1;
            RMQFindSlot other, "RMQ_T_2";
            RMQSendMessage other, [[1,2,3],[1,0,0,0]]\\UserDef:=5;
        ENDPROC
    """
    first = first.replace("RMQSendMessage other, [[1,2,3],[1,0,0,0]]", "RMQSendMessage other, p")
    first = first.replace("VAR rmqslot", "VAR pose p := [[1,2,3],[1,0,0,0]]; VAR rmqslot")
    first = first.replace(
        "\n        ENDPROC", "\n RMQReadWait m; RMQGetMsgData m, answer;\nENDPROC"
    )
    second = """
        VAR rmqmessage m; VAR rmqheader h; VAR rmqslot sender; VAR num user; VAR pose p; VAR num n;
        VAR bool wrong; VAR bool empty; VAR string reply := "got it";
        PROC main()
            RMQEmptyQueue;
            RMQReadWait m\\TimeOut:=5;
            RMQGetMsgHeader m\\Header:=h\\SenderId:=sender\\UserDef:=user;
            RMQGetMsgData m, p;
            RMQSendMessage sender, reply;
            RMQGetMsgData m, n;
            RMQGetMessage m;
        ERROR
            IF ERRNO = ERR_RMQ_VALUE wrong := TRUE;
            IF ERRNO = ERR_RMQ_NOMSG empty := TRUE;
            TRYNEXT;
        ENDPROC
    """
    system = run(first, second)
    assert value(system, "answer") == "got it"
    assert value(system, "h", "T_2") == ["pose", 0, 0, 0, 0]
    assert [value(system, name, "T_2") for name in ("user", "wrong", "empty")] == [5, True, True]
    assert value(system, "p", "T_2") == [[1, 2, 3], [1, 0, 0, 0]]


def test_a_full_queue_refuses_and_keeps_what_it_has() -> None:
    program = """
        VAR rmqslot own; VAR rmqmessage m; VAR num sent; VAR num got; VAR num n; VAR bool bad;
        PROC main()
            RMQFindSlot own, "RMQ_T_ROB1";
            FOR i FROM 1 TO 50 DO
                n := i;
                RMQSendMessage own, n;
                Incr sent;
            ENDFOR
        ERROR
            IF ERRNO = ERR_RMQ_FULL THEN
                RMQGetMessage m;
                RMQGetMsgData m, got;
                RETURN;
            ENDIF
        ENDPROC
    """
    system = run(program)
    assert value(system, "sent") == 10
    assert value(system, "got") == 1


def test_waiting_for_a_message_ends_in_time() -> None:
    program = """
        VAR rmqmessage m; VAR clock c; VAR num result;
        PROC main()
            ClkStart c;
            RMQReadWait m\\TimeOut:=2;
        ERROR
            IF ERRNO = ERR_RMQ_TIMEOUT result := ClkRead(c);
            TRYNEXT;
        ENDPROC
    """
    assert result(program) == pytest.approx(2.0, abs=0.02)


def test_dates_and_times_come_from_the_hosts_epoch() -> None:
    program = """
        VAR string day; VAR string time; VAR num parts{3};
        PROC main()
            WaitTime 2;
            day := CDate();
            time := CTime();
            parts := [GetTime(\\WDay), GetTime(\\Year), GetTime(\\Sec)];
        ENDPROC
    """
    system = run(program, host=Host(epoch_s=1477227196.0))
    assert value(system, "day") == "2016-10-23"
    assert value(system, "time") == "12:53:18"
    assert value(system, "parts") == [7, 2016, 18]
