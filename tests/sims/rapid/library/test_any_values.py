"""Whatever values a program gives to a function of the library: an answer or a RapidError."""

import asyncio
import inspect
import random
from pathlib import Path
from typing import Any

import pytest

from sims.rapid import library
from sims.rapid.ast import Mode, Param
from sims.rapid.builtin import BUILTINS, Builtin
from sims.rapid.errors import RapidError
from sims.rapid.parser import parse_routine_head
from tests.sims.rapid.runtime.bench import Host

library.register()

MODULES = ("maths", "bits", "strings", "conversions", "poses", "rawbytes", "files", "folders")
MODULES += ("dates", "messages")
OURS = [b for b in BUILTINS if b.call.__module__.rpartition(".")[2] in MODULES]

NUMBERS = [0.0, 1.0, -1.0, 0.5, 2.0, 3.0, 8.0, 9.0, 80.0, 81.0, 255.0, 256.0, 1024.0, 1025.0, 9e9]
NUMBERS += [-9e9, 3.4e38, -3.4e38, 1e-40, -0.0, 90.0, 1e-7]
DNUMS = [*NUMBERS, 2.0**52, 2.0**53, 1e308, -1e308]
TEXTS = ["", "a", "1", "-1", "255", "zz", "x" * 80, "HOME:", "HOME:/a", "/../b", "a\x00", "{1}{2}"]
TEXTS += ["[1,2,3]", "[[[", '"', "1E400", "99999999999999999999", "\xff", "..", "RMQ_T_ROB1", "EOF"]


class Data:
    """A data object that takes everything."""

    def __init__(self, base: str, value: Any) -> None:
        self.name = "data"
        self.type = self.base = base
        self.rank = 0
        self._value = value

    def get(self) -> Any:
        return self._value

    def set(self, value: Any) -> None:
        self._value = value


class Task:
    name = "T_ROB1"

    def __init__(self, home: Path) -> None:
        self.host = Host(home=home)


def _orient(pick: random.Random) -> list[float]:
    return pick.choice([[1.0, 0.0, 0.0, 0.0], [0.5] * 4, [0.0] * 4, _numbers(pick, 4)])


def _numbers(pick: random.Random, count: int) -> list[float]:
    return [pick.choice(NUMBERS) for _ in range(count)]


def _value(kind: str, pick: random.Random) -> Any:
    match kind:
        case "dnum":
            return pick.choice(DNUMS)
        case "string" | "stringdig":
            return pick.choice(TEXTS)
        case "bool":
            return pick.random() < 0.5
        case "switch":
            return pick.random() < 0.3
        case "pos":
            return _numbers(pick, 3)
        case "orient":
            return _orient(pick)
        case "pose":
            return [_numbers(pick, 3), _orient(pick)]
        case "robtarget":
            return [_numbers(pick, 3), _orient(pick), _numbers(pick, 4), _numbers(pick, 6)]
        case "rawbytes":
            return bytearray(pick.randrange(1025))
        case "rmqheader":
            return ["", 0.0, 0.0, 0.0, 0.0]
    return pick.choice(NUMBERS)


def _argument(param: Param, pick: random.Random) -> Any:
    if param.type == "switch":
        return pick.random() < 0.3
    if param.is_optional and pick.random() < 0.5:
        return None
    kind = param.type
    if kind == "anytype":
        kind = pick.choice(["num", "dnum", "string", "bool", "pos", "robtarget"])
    if kind in ("iodev", "dir", "rmqslot", "rmqmessage"):
        return Data(kind, None)
    value = _numbers(pick, 3) if param.rank else _value(kind, pick)
    return value if param.mode is Mode.IN else Data(kind, value)


def _keywords(entry: Builtin, pick: random.Random) -> dict[str, Any]:
    names = inspect.signature(entry.call).parameters
    given = {}
    for param in parse_routine_head(entry.declaration).params:
        low = param.name.lower()
        given[low if low in names else f"{low}_"] = _argument(param, pick)
    return given


@pytest.mark.parametrize("entry", OURS, ids=lambda entry: entry.declaration.split("(")[0])
def test_a_function_answers_or_raises_an_error_of_rapid(entry: Builtin, tmp_path: Path) -> None:
    (tmp_path / "a").write_text("12\nab\n")
    task = Task(tmp_path)
    pick = random.Random(entry.declaration)
    outcomes = set()

    async def call() -> None:
        try:
            answer = entry.call(task, **_keywords(entry, pick))
            if inspect.isawaitable(answer):
                answer = await asyncio.wait_for(answer, 0.001)
        except RapidError as error:
            outcomes.add(error.name)
        except TimeoutError:
            outcomes.add("waits")
        else:
            outcomes.add(type(answer).__name__)

    async def many() -> None:
        for _ in range(20 if inspect.iscoroutinefunction(entry.call) else 200):
            await call()

    asyncio.run(many())
    errors = outcomes - {"waits", "NoneType", "float", "str", "bool", "list"}
    assert all(name.startswith("ERR_") for name in errors), outcomes


def test_all_of_the_library_is_tried() -> None:
    assert len(OURS) > 100
