"""The same program on the direct devices leaves the same bits, whatever threads and hashes do."""

import os
import subprocess
import sys

import pytest

PROGRAM = """
import asyncio, hashlib, random, time
from hal import JointTarget, LinearTarget, Transform, compute
from hal.errors import PreemptedError
from sims.direct import DirectGripper, DirectIo, DirectRobot
from sims.loop import LockstepLoop
from sims.world import World, cylinders, fill

world = World(shape=cylinders([-0.05, -0.015, 0.010, 0.05], [0.010, 0.014, 0.010]), parts=6)
fill(world, seed=2)
loop = LockstepLoop(world)
trace = []


async def main():
    robot, gripper, io = DirectRobot(world), DirectGripper(world), DirectIo(world)
    dawdle = random.Random()
    async with robot, gripper, io:
        homing = gripper.home()
        home = await robot.move_joints((0, 0, 0, 0, 1.5, 0))
        seen = asyncio.ensure_future(
            compute(lambda: time.sleep(dawdle.random() * 0.01) or 4, charge_s=0.333)
        )
        down = Transform.from_parts(
            "base", "tcp", home.T_base_tcp.rotation, home.T_base_tcp.translation_m - [0, 0, 0.1]
        )
        aside = JointTarget((0.4, 0, 0, 0, 1.5, 0))
        trace.append(await robot.move([LinearTarget(down, 0.25, 0.02), aside]))
        trace.append((await seen, loop.now_ns, await homing, await gripper.grasp(), loop.now_ns))
        move = robot.move_joints((0, 0, 0, 0, 1.5, 0))
        await io.pulse("do1", 0.1)
        trace.append(await robot.stop())
        try:
            await move
        except PreemptedError as error:
            trace.append(str(error))
        trace.append((await robot.state(), await gripper.state(), loop.now_ns))


loop.run_until_complete(main())
loop.close()
state = world.data.qpos.tobytes() + world.data.qvel.tobytes()
print(hashlib.sha256(repr(trace).encode() + state).hexdigest())
"""


@pytest.mark.timeout(300)
def test_reruns_are_identical_for_any_hash_seed_and_thread_count():
    digests = set()
    for seed, threads in (("1", "1"), ("77", "2")):
        environment = {**os.environ, "PYTHONHASHSEED": seed, "OMP_NUM_THREADS": threads}
        run = subprocess.run(
            [sys.executable, "-c", PROGRAM],
            check=False,
            env=environment,
            capture_output=True,
            text=True,
        )
        assert run.returncode == 0, run.stderr
        digests.add(run.stdout.strip())
    assert len(digests) == 1
    assert len(digests.pop()) == 64
