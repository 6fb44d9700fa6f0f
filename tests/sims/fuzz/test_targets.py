import pytest

from sims.fuzz import TARGETS, fuzz
from sims.fuzz.abb_server import AbbServer, ServerError


@pytest.mark.parametrize(("target", "count"), [("abb-server", 80), ("rapid-text", 2000)])
def test_hostile_inputs_break_no_promise(target, count):
    report = fuzz(TARGETS[target](), count=count, seed=3)
    assert report.findings == []
    assert report.inputs == count
    assert report.lines > 100


@pytest.mark.slow
@pytest.mark.timeout(600)
@pytest.mark.parametrize(("target", "count"), [("abb-server", 5000), ("rapid-text", 200_000)])
def test_many_hostile_inputs_break_no_promise(target, count):
    report = fuzz(TARGETS[target](), count=count, seed=4, seconds=240)
    assert report.findings == []


def test_a_service_that_stops_is_found_out():
    target = AbbServer()
    target.run(target.seeds()[0])
    target._controller.motors_off()
    with pytest.raises(ServerError):
        target.run(target.seeds()[0])


def test_the_same_seed_tries_the_same_inputs():
    seen = []

    class Ear:
        name = "ear"
        modules = ()
        prefixes = ()

        def seeds(self):
            return [b"abc", b""]

        def pieces(self):
            return [b"xyz"]

        def run(self, data):
            seen.append(data)

    fuzz(Ear(), count=50, seed=7)
    first = list(seen)
    seen.clear()
    fuzz(Ear(), count=50, seed=7)
    assert seen == first
    assert len(set(first)) > 30


def test_what_breaks_a_promise_is_kept_and_counted_and_the_fuzzer_goes_on():
    class Picky:
        name = "picky"
        modules = ()
        prefixes = ()

        def seeds(self):
            return [b"good"]

        def pieces(self):
            return [b"!"]

        def run(self, data):
            if b"!" in data:
                raise ValueError("shouting")

    report = fuzz(Picky(), count=200, seed=1)
    assert report.findings
    assert all(b"!" in finding.data for finding in report.findings)
    assert "shouting" in report.findings[0].error
