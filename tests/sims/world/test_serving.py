import pytest

import sims
from hal import Address, Kind, Registry
from hal.errors import ConfigError
from sims.world import World
from sims.world.serving import serve, withdraw


def test_a_cell_file_reaches_a_running_world_and_gets_its_devices():
    registry = Registry(sims.BACKENDS, schemes=[sims.SCHEMES])
    world = World()
    serve(world, "mine")
    try:
        address = Address.parse("sim:mine", known=registry.schemes)
        opened = registry.opener(address)(address.rest)
        assert opened is world
        robot = registry.backend("direct-robot", Kind.ROBOT).load("direct-robot")(opened)
        assert robot.name == "robot"
    finally:
        withdraw("mine")


def test_a_world_that_does_not_run_is_an_error_that_names_the_ones_that_do():
    opener = Registry(schemes=[sims.SCHEMES]).opener(Address("sim", "other"))
    serve(World(), "mine")
    try:
        with pytest.raises(ConfigError, match="sim:mine"):
            opener("other")
    finally:
        withdraw("mine")
        withdraw("mine")
