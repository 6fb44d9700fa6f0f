import json

import numpy as np
import pytest

from cell.journal import Journal, quantise
from hal import Transform


def test_equal_runs_have_equal_bytes(tmp_path):
    digests = []
    for name in ("a", "b"):
        journal = Journal(tmp_path / name)
        journal.write("seen", 5, b=np.float64(1 / 3), a=[np.int64(2), -0.0, np.bool_(True)])
        journal.write("pose", 6, T=Transform.identity("base", "object"))
        journal.close()
        digests.append(journal.sha256)
    assert digests[0] == digests[1]
    assert (tmp_path / "a").read_bytes() == (tmp_path / "b").read_bytes()
    first = json.loads((tmp_path / "a").read_text().splitlines()[0])
    assert first == {"t_ns": 5, "event": "seen", "a": [2, 0.0, True], "b": 0.333333333}


def test_a_changed_number_changes_the_digest():
    digests = set()
    for value in (1.0, 1.00000001):
        journal = Journal()
        journal.write("x", 0, value=value)
        digests.add(journal.sha256)
    assert len(digests) == 2


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_what_json_cannot_say_is_null(value):
    assert quantise({"x": (value,)}) == {"x": [None]}


def test_minus_zero_is_zero():
    assert json.dumps(quantise(-0.0)) == "0.0"
