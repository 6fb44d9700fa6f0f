"""The predefined modules, as a program meets them."""

from sims.rapid.ast import DataDecl, RecordDecl
from sims.rapid.prelude import prelude_modules


def _data() -> dict[str, DataDecl]:
    declared = [d for module in prelude_modules() for d in module.declarations]
    return {d.name.lower(): d for d in declared if isinstance(d, DataDecl)}


def test_every_name_is_declared_once() -> None:
    names = [d.name.lower() for module in prelude_modules() for d in module.declarations]
    assert len(names) == len(set(names))


def test_two_errors_never_share_a_number() -> None:
    numbers = [
        d.value.value
        for d in _data().values()
        if d.type == "errnum" and d.value.__class__.__name__ == "Number"
    ]
    assert len(numbers) == len(set(numbers)) > 180


def test_what_programs_of_the_field_name_is_there() -> None:
    known = _data()
    for name in ("v5", "v7000", "vmax", "fine", "z0", "z200", "tool0", "wobj0", "load0", "reg1"):
        assert name in known, name
    for name in ("clock1", "pi", "wait_max", "eof_num", "op_auto", "socket_connected", "str_digit"):
        assert name in known, name
    for name in ("err_sock_closed", "err_refunkprc", "egm_stop_hold", "type_err", "common_err"):
        assert name in known, name


def test_a_robtarget_has_its_four_components() -> None:
    records = [d for m in prelude_modules() for d in m.declarations if isinstance(d, RecordDecl)]
    robtarget = next(record for record in records if record.name == "robtarget")
    assert [name for _, name in robtarget.fields] == ["trans", "rot", "robconf", "extax"]
