"""Run coroutine promises on the bench's loop, judge skips, print the matrix."""

from collections.abc import Generator
from typing import Any, cast

import pytest

from hal.conformance.base import DECLARED, Bench, Conformance
from hal.conformance.stage import StageCannotError

__all__ = [
    "pytest_configure",
    "pytest_pyfunc_call",
    "pytest_runtest_makereport",
    "pytest_terminal_summary",
]

MARKS = {"passed": "kept", "failed": "BROKEN", "skipped": "-"}


def pytest_configure(config: pytest.Config) -> None:
    """Declare the marker that leaves a device as it is after opening."""
    config.addinivalue_line("markers", "unprepared: the promise is about a device just opened")


@pytest.hookimpl(tryfirst=True)
def pytest_pyfunc_call(pyfuncitem: pytest.Function) -> bool | None:
    """Run a promise; skip what its backend declares it lacks."""
    suite = pyfuncitem.instance
    if not isinstance(suite, Conformance):
        return None
    name = pyfuncitem.originalname
    if name in suite.lacks:
        pytest.skip(DECLARED + suite.lacks[name])
    bench = cast("Bench", pyfuncitem.funcargs["bench"])
    names = pyfuncitem._fixtureinfo.argnames
    arguments = {argument: pyfuncitem.funcargs[argument] for argument in names}
    try:
        bench.loop.run_until_complete(pyfuncitem.obj(**arguments))
    except StageCannotError as cannot:
        if cannot.ability not in suite.lacks:
            pytest.fail(
                f"the stage of {suite.backend} cannot {cannot.ability}, and 'lacks' does not say so"
            )
        pytest.skip(DECLARED + suite.lacks[cannot.ability])
    return True


@pytest.hookimpl(hookwrapper=True)
def pytest_runtest_makereport(
    item: pytest.Item, call: pytest.CallInfo[None]
) -> Generator[None, Any, None]:
    """Fail skips nobody declared, and note the outcome for the matrix."""
    outcome = yield
    suite = getattr(item, "cls", None)
    if not (isinstance(suite, type) and issubclass(suite, Conformance)):
        return
    report: pytest.TestReport = outcome.get_result()
    if report.skipped and DECLARED not in str(report.longrepr):
        report.outcome = "failed"
        report.longrepr = f"a skip that 'lacks' does not declare: {report.longrepr}"
    if call.when == "call" or report.outcome != "passed":
        promise = getattr(item, "originalname", item.name).removeprefix("test_").replace("_", " ")
        why = str(report.longrepr).rpartition(DECLARED)[2].rstrip("')") if report.skipped else ""
        column = f"{suite.backend} {suite.wire}".strip()
        result = (suite.interface, promise, column, report.outcome, why)
        report.user_properties.append(("conformance", result))


def pytest_terminal_summary(terminalreporter: Any) -> None:
    """Print backend x promise."""
    results = [
        value
        for outcome in (*MARKS, "error")
        for report in terminalreporter.stats.get(outcome, [])
        for key, value in getattr(report, "user_properties", [])
        if key == "conformance"
    ]
    for interface in sorted({result[0] for result in results}):
        _print_table(terminalreporter, interface, [r for r in results if r[0] == interface])


def _print_table(reporter: Any, interface: str, results: list[Any]) -> None:
    backends = sorted({result[2] for result in results})
    promises = sorted({result[1] for result in results})
    cells = {(result[1], result[2]): MARKS[result[3]] for result in results}
    width = max(len(promise) for promise in promises)
    columns = [max(len(backend), 6) for backend in backends]
    reporter.section(f"conformance: {interface}", sep="-")
    heads = "  ".join(b.ljust(w) for b, w in zip(backends, columns, strict=True))
    reporter.write_line(f"{'promise'.ljust(width)}  {heads}")
    for promise in promises:
        row = [
            cells.get((promise, backend), "").ljust(w)
            for backend, w in zip(backends, columns, strict=True)
        ]
        reporter.write_line(f"{promise.ljust(width)}  {'  '.join(row)}".rstrip())
    for _, promise, backend, _, why in sorted(r for r in results if r[3] == "skipped"):
        reporter.write_line(f"- {backend}: {promise}: {why}")
