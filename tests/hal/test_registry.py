import pytest

import hal.registry
from hal import Backend, Kind, Registry
from hal.errors import ConfigError


class Point:
    def __init__(self, name, target):
        self.name, self.value = name, "stranger.package:thing"
        self.target = target

    def load(self):
        if isinstance(self.target, Exception):
            raise self.target
        return self.target


def test_other_packages_add_devices_and_a_broken_one_is_only_its_own_trouble(monkeypatch):
    fine = Backend(Kind.ROBOT, "json:loads", "tcp")
    points = {
        "binpick.backends": [Point("fine", fine), Point("bad", ImportError("no module"))],
        "binpick.suites": [Point("fine", None)],
    }
    monkeypatch.setattr(hal.registry, "entry_points", lambda group: points.get(group, []))
    registry = Registry().add_installed()
    assert registry.backend("fine", Kind.ROBOT) is fine
    assert registry.suites == {"fine": "stranger.package:thing"}
    with pytest.raises(ConfigError, match="'bad' cannot be loaded"):
        registry.backend("bad", Kind.ROBOT)
