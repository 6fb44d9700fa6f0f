"""The driver before the shipped modules: settings, queues, accuracy, the clock."""

import asyncio

import numpy as np
import pytest

from drivers.abb import RapidIo
from drivers.abb import messages as m
from hal import CircularTarget, JointTarget, LinearTarget, Load, Tool, Transform
from tests.drivers.abb.cell import HOME, run


def shifted(pose, by_m):
    return Transform.from_parts(pose.parent, pose.child, pose.rotation, pose.translation_m + by_m)


def test_targets_stay_in_the_base_whatever_the_work_object():
    async def main(cell):
        here = (await cell.robot.state()).T_base_tcp
        frame = Transform.from_quaternion("base", "object", (0.9, 0.1, -0.2, 0.3), (0.3, 0.2, 0.1))
        await cell.robot.set_work_object(frame)
        goal = shifted(here, (0.02, 0.05, -0.06))
        state = await cell.robot.move([LinearTarget(goal, 0.2)])
        assert state.T_base_tcp.matrix == pytest.approx(goal.matrix, abs=2e-6)
        via, end = shifted(goal, (0, -0.03, 0.03)), shifted(goal, (0, -0.06, 0))
        state = await cell.robot.move([CircularTarget(via, end, 0.2)])
        assert state.T_base_tcp.matrix == pytest.approx(end.matrix, abs=2e-6)
        told = cell.controller.system.find("T_ROB1", "bpWobj").get()
        assert told[3][0] == pytest.approx([300, 200, 100])

    run(main)


def test_tool_and_load_arrive_in_the_controllers_units_and_frames():
    async def main(cell):
        T_flange_tcp = Transform.from_quaternion("flange", "tcp", (0, 0, 1, 0), (0.01, 0.02, 0.16))
        await cell.robot.set_tool(Tool(T_flange_tcp, Load(0.67, (0.0, 0.0, 0.08))))
        await cell.robot.set_load(Load(0.34, (0.01, 0.02, 0.2)))
        tool = cell.controller.system.find("T_ROB1", "bpTool").get()
        load = cell.controller.system.find("T_ROB1", "bpLoad").get()
        assert tool[1][0] == pytest.approx([10, 20, 160])
        assert tool[2][0] == pytest.approx(0.67)
        assert tool[2][1] == pytest.approx([0, 0, 80])  # the tool's, in the flange
        assert load[0] == pytest.approx(0.34)
        assert load[1] == pytest.approx([0, 0, -40], abs=1e-4)  # the part's, in the tool

    run(main)


def test_a_softer_acceleration_takes_longer():
    async def main(cell):
        loop = asyncio.get_running_loop()
        took = []
        for share in (1.0, 0.2):
            await cell.robot.set_acceleration(share)
            await cell.robot.move_joints(HOME)
            began = loop.time()
            await cell.robot.move_joints((0.6, *HOME[1:]))
            took.append(loop.time() - began)
        assert took[1] > 1.5 * took[0]

    run(main)


def test_a_full_queue_is_driven_in_order_and_one_more_is_refused_at_once():
    async def main(cell):
        angles = np.linspace(0.0, 0.5, 50)
        targets = [JointTarget((q, *HOME[1:]), 1.0, 0.005) for q in angles]
        state = await cell.robot.move(targets)
        assert state.joints_rad[0] == pytest.approx(0.5, abs=1e-4)
        with pytest.raises(ValueError, match="50"):
            cell.robot.move([*targets, targets[0]])

    run(main)


def test_the_clock_goes_on_through_its_turns():
    """The controller counts in turns of 64 s, so that binary32 stays exact."""

    async def main(cell):
        loop = asyncio.get_running_loop()
        ages, turns = [], set()
        for _ in range(150):
            state = await cell.robot.state()
            ages.append(loop.time() - state.stamp_s)
            turns.add(cell.robot._session.state.turns)
            await asyncio.sleep(1.0)
        assert len(turns) >= 3
        assert np.ptp(ages) < 0.005

    run(main)


def test_a_wait_sees_a_signal_and_many_waits_stand_side_by_side():
    async def main(cell):
        io = RapidIo(cell.connector)
        await io.open()
        waits = [io.wait_for(f"di{k}", True, timeout_s=5.0) for k in range(1, 5)]
        await asyncio.sleep(0.1)
        assert not any(wait.done() for wait in waits)
        for k in range(1, 5):
            cell.controller.set_input(f"di{k}", 1)
        await asyncio.gather(*waits)
        await io.close()

    run(main)


def test_every_code_of_the_package_is_a_code_of_the_driver():
    """The words of the protocol stand in RAPID and in Python; they must be the same."""

    async def main(cell):
        find = cell.controller.system.find
        names = {code.name: code.value for code in m.Code if code is not m.Code.NONE}
        aliases = {"UNKNOWN": "BP_UNKNOWN"}
        for name, value in names.items():
            found = find("T_ROB1", aliases.get(name, f"BP_{name}"))
            assert found is not None, name
            assert found.get() == value, name

    run(main)
