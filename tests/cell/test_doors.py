"""Two doors into one world: the arm itself, and the driver that speaks to RAPID over a wire."""

from cell.config import DeviceConfig, load_cell
from cell.demo.run import DemoOptions, run_demo
from perception.parts import load_part


def picks(config):
    result = run_demo(
        DemoOptions(config, load_part("shaft"), 4, seed=3, keeps_pictures=False)
    ).result
    return [(pick["part"], pick["is_held"], pick["is_placed"]) for pick in result["picks"]]


def test_both_doors_give_the_same_picks():
    wire = load_cell()
    assert wire.robot.backend == "abb-rapid"
    direct = wire.model_copy(update={"robot": DeviceConfig(backend="direct-robot", address="sim:")})
    through_the_wire = picks(wire)
    assert len(through_the_wire) == 4
    assert through_the_wire == picks(direct)
    assert all(held and placed for _, held, placed in through_the_wire)
