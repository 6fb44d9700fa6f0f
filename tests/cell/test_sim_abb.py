"""``binpick sim abb``: real sockets, wall time."""

import asyncio
import os
import pty
import select
import socket
import subprocess
import sys
import threading
import time

import pytest

from cell.standalone import AbbOptions, run_abb
from hal.errors import CellError, ConfigError
from sims.rapid.errors import RapidLoadError

ECHO = """
MODULE Echo
  CONST num PORT := 1025;
  CONST string GREETING := "hello";
  VAR socketdev listener;
  VAR socketdev client;
  VAR string text;
  PROC main()
    SocketCreate listener;
    SocketBind listener, "192.168.125.1", PORT;
    SocketListen listener;
    SocketAccept listener, client \\Time:=WAIT_MAX;
    SocketSend client \\Str:=GREETING;
    WHILE TRUE DO
      SocketReceive client \\Str:=text \\Time:=WAIT_MAX;
      SocketSend client \\Str:=text;
    ENDWHILE
  ENDPROC
ENDMODULE
"""


class Ear:
    """A view that remembers, and may act when a line comes."""

    def __init__(self, act=None):
        self.entries, self.lines = [], []
        self._act = act

    def begin(self, controller, typed):
        self.controller, self.typed = controller, typed

    def entry(self, entry):
        self.entries.append(entry)

    def line(self, text):
        self.lines.append(text)
        if self._act is not None:
            self._act(self, text)

    def refresh(self):
        pass

    def end(self):
        pass


def module(tmp_path, text=ECHO):
    path = tmp_path / "Echo.mod"
    path.write_text(text)
    return path


def test_a_foreign_client_talks_to_the_program_over_a_real_socket(tmp_path):
    answers = []

    async def talk(port, typed):
        reader, writer = await asyncio.open_connection("127.0.0.1", port)
        answers.append(await reader.readexactly(3))
        began = time.perf_counter()
        writer.write(b"over here")
        answers.append(await reader.readexactly(9))
        answers.append(time.perf_counter() - began)
        writer.close()
        await writer.wait_closed()
        typed.put_nowait("quit")

    talks = []

    def act(ear, text):
        if "1025" in text:
            port = int(text.rpartition(":")[2])
            talks.append(asyncio.ensure_future(talk(port, ear.typed)))

    options = AbbOptions(
        modules=[module(tmp_path)], ports={1025: 0}, overrides={"GREETING": '"hey"'}, duration_s=20
    )
    state = run_abb(options, Ear(act))
    assert answers[:2] == [b"hey", b"over here"]
    assert answers[2] < 10.0
    assert state["ports"]["1025"] not in (0, 1025)


def test_commands_are_obeyed_in_order_and_wrong_ones_refused_in_words(tmp_path):
    ear = Ear()
    commands = ["stop", "motors off", "start", "dance", "wait 0.1", "motors on", "start", "quit"]
    options = AbbOptions(modules=[module(tmp_path)], ports={1025: 0}, commands=commands)
    state = run_abb(options, ear)
    assert state["is_running"]
    assert state["state"] == "motoron"
    refused = [line for line in ear.lines if line.startswith("refused")]
    assert len(refused) == 2
    assert "motors are off" in refused[0]
    assert "dance" in refused[1]


def test_without_start_nothing_runs_until_it_is_told_to(tmp_path):
    options = AbbOptions(modules=[module(tmp_path)], starts=False, duration_s=0.2)
    assert not run_abb(options, Ear())["is_running"]


@pytest.mark.parametrize(
    ("changes", "error"),
    [
        ({"arm": "irb1"}, ConfigError),
        ({"overrides": {"NOTHING": "1"}}, ConfigError),
        ({"overrides": {"PORT": "]["}}, CellError),
        ({"modules": ["missing.mod"]}, RapidLoadError),
    ],
)
def test_what_cannot_be_run_is_refused_before_anything_moves(tmp_path, changes, error):
    with pytest.raises(error):
        run_abb(AbbOptions(**{"modules": [module(tmp_path)], "duration_s": 5.0, **changes}), Ear())


def test_a_port_that_cannot_be_opened_is_said(tmp_path):
    ear = Ear()
    with socket.create_server(("127.0.0.1", 0)) as other:
        port = other.getsockname()[1]
        run_abb(AbbOptions(modules=[module(tmp_path)], ports={1025: port}, duration_s=0.5), ear)
    told = [line for line in ear.lines if "cannot be opened" in line]
    assert len(told) == 1
    assert f"127.0.0.1:{port}: Address already in use" in told[0]


def test_our_own_package_runs_when_nothing_else_is_named():
    state = run_abb(AbbOptions(ports={5010: 0, 5011: 0}, duration_s=1.0), Ear())
    assert set(state["tasks"]) == {"T_ROB1", "T_BINPICK"}
    assert set(state["ports"]) == {"5010", "5011"}


def test_the_pendant_takes_typed_commands_and_gives_the_terminal_back(tmp_path):
    master, slave = pty.openpty()
    command = [sys.executable, "-m", "cell", "sim", "abb", "--module", str(module(tmp_path))]
    process = subprocess.Popen(
        [*command, "--port-map", "1025=0", "--pendant"],
        stdin=slave,
        stdout=slave,
        stderr=slave,
        env={**os.environ, "TERM": "xterm", "COLUMNS": "120", "LINES": "50"},
    )
    os.close(slave)
    seen = b""
    try:
        deadline = time.monotonic() + 60
        typed = [b"speed 40\r", b"quit\r"]
        marks = [b"running", b"40%"]
        while typed and time.monotonic() < deadline:
            if select.select([master], [], [], 0.2)[0]:
                seen += os.read(master, 65536)
            if marks[0] in seen:
                os.write(master, typed.pop(0))
                marks.pop(0)
                seen = b""
        drain = threading.Thread(target=_drain, args=(master,), daemon=True)
        drain.start()
        assert process.wait(timeout=20) == 0
        drain.join(5)
    finally:
        process.kill()
        process.wait()
        os.close(master)
    assert not typed


def _drain(master):
    while True:
        try:
            if not os.read(master, 65536):
                return
        except OSError:
            return
