"""The loop: change an input that reached something, run it, keep it if it reaches more."""

import random
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Protocol

from sims.fuzz.reach import LineReach

__all__ = ["Finding", "FuzzReport", "Target", "fuzz"]

MAX_CORPUS = 2000
MAX_FINDINGS = 20
# Watching lines is slow: one input in so many is watched, all are judged.
WATCH_ONE_IN = 8
BLOCK_BYTES = (1, 2, 4, 8, 16, 64)
EDGES = (0, 1, 2, 7, 8, 127, 128, 254, 255)


class Target(Protocol):
    """A reader of bytes under test."""

    name: str
    modules: Sequence[str]
    prefixes: tuple[str, ...]

    def seeds(self) -> list[bytes]:
        """Good inputs to begin with."""

    def pieces(self) -> list[bytes]:
        """Parts of the language, for splicing."""

    def run(self, data: bytes) -> None:
        """Read it. Whatever is raised is a finding: allowed errors are caught inside."""


@dataclass(frozen=True)
class Finding:
    """An input that broke a promise."""

    data: bytes
    error: str


@dataclass
class FuzzReport:
    """``last_new`` is the input after which no new line was reached: the plateau's beginning."""

    target: str
    inputs: int = 0
    lines: int = 0
    last_new: int = 0
    seconds: float = 0.0
    longest_s: float = 0.0
    findings: list[Finding] = field(default_factory=list)

    @property
    def inputs_per_s(self) -> float:
        """Speed."""
        return self.inputs / self.seconds if self.seconds else 0.0


def fuzz(
    target: Target,
    *,
    count: int,
    seed: int = 0,
    seconds: float | None = None,
    progress: Callable[[int], None] | None = None,
) -> FuzzReport:
    """Try ``count`` inputs, or as many as there is time for."""
    rng = random.Random(seed)
    corpus, pieces = target.seeds(), target.pieces()
    report = FuzzReport(target.name)
    reach = LineReach(target.modules, target.prefixes)
    began = time.perf_counter()
    for number in range(count):
        data = corpus[number] if number < len(corpus) else mutated(rng, corpus, pieces)
        is_watched = number < len(corpus) or rng.randrange(WATCH_ONE_IN) == 0
        started = time.perf_counter()
        try:
            is_new = reach.watch(target.run, data) if is_watched else False
            if not is_watched:
                target.run(data)
        except Exception as error:  # every kind of crash is what is looked for
            is_new = False
            report.findings.append(Finding(data, f"{type(error).__name__}: {error}"))
        report.longest_s = max(report.longest_s, time.perf_counter() - started)
        report.inputs = number + 1
        if is_new:
            report.last_new = number + 1
            if len(corpus) < MAX_CORPUS:
                corpus.append(data)
        if progress is not None and number % 256 == 0:
            progress(number)
        is_late = seconds is not None and time.perf_counter() - began > seconds
        if is_late or len(report.findings) >= MAX_FINDINGS:
            break
    report.lines = len(reach.lines)
    report.seconds = time.perf_counter() - began
    return report


def mutated(rng: random.Random, corpus: Sequence[bytes], pieces: Sequence[bytes]) -> bytes:
    """Return a changed input: bytes, blocks, pieces of the language, two inputs spliced."""
    data = bytearray(rng.choice(corpus))
    for _ in range(1 << rng.randrange(4)):
        _CHANGES[rng.randrange(len(_CHANGES))](rng, data, corpus, pieces)
    return bytes(data)


def _flip(rng: random.Random, data: bytearray, _c: object, _p: object) -> None:
    if data:
        data[rng.randrange(len(data))] ^= 1 << rng.randrange(8)


def _edge(rng: random.Random, data: bytearray, _c: object, _p: object) -> None:
    if data:
        data[rng.randrange(len(data))] = rng.choice(EDGES)


def _delete(rng: random.Random, data: bytearray, _c: object, _p: object) -> None:
    at = rng.randrange(len(data) + 1)
    del data[at : at + rng.choice(BLOCK_BYTES)]


def _repeat(rng: random.Random, data: bytearray, _c: object, _p: object) -> None:
    at = rng.randrange(len(data) + 1)
    block = data[at : at + rng.choice(BLOCK_BYTES)]
    data[at:at] = block * rng.randrange(1, 4)


def _insert(rng: random.Random, data: bytearray, _c: object, pieces: Sequence[bytes]) -> None:
    at = rng.randrange(len(data) + 1)
    data[at:at] = rng.choice(pieces) if pieces and rng.randrange(4) else rng.randbytes(3)


def _splice(rng: random.Random, data: bytearray, corpus: Sequence[bytes], _p: object) -> None:
    other = rng.choice(corpus)
    at = rng.randrange(len(data) + 1)
    data[at:] = other[rng.randrange(len(other) + 1) :]


_CHANGES = (_flip, _edge, _delete, _repeat, _insert, _insert, _splice)
