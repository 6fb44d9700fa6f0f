from importlib import import_module

from cell.devices import registry


def test_every_registered_backend_is_held_to_the_promises_of_its_kind():
    known = registry()
    assert set(known.suites) == set(known.backends)
    for name, target in known.suites.items():
        module, _, suite_name = target.partition(":")
        suite = getattr(import_module(module), suite_name)
        assert suite.backend == name
        assert suite.interface == str(known.backends[name].kind)


def test_every_suite_is_collected_here():
    from tests.conformance import test_abb, test_direct

    targets = {target.partition(":")[2] for target in registry().suites.values()}
    assert targets == {*test_direct.__all__, *test_abb.__all__}
