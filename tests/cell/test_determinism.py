"""Two runs of one seed are one run, whatever the machine lends them."""

import json
import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]


def demo(folder, *, cpus, hash_seed):
    """Run the demo in a process of its own; return its result and its journal."""
    command = [sys.executable, "-m", "cell", "demo", "--count", "2", "--shots", "2", "--seed", "6"]
    environment = {
        **os.environ,
        "PYTHONHASHSEED": hash_seed,
        "OMP_NUM_THREADS": str(len(cpus)),
        "OPENCV_FOR_THREADS_NUM": str(len(cpus)),
    }
    done = subprocess.run(
        [*command, "--no-report", "--out", folder, "--json", folder / "demo.json"],
        cwd=ROOT,
        env=environment,
        capture_output=True,
        text=True,
        timeout=110,
        check=False,
        preexec_fn=lambda: os.sched_setaffinity(0, cpus),
    )
    assert done.returncode == 0, done.stderr
    result = json.loads((folder / "demo.json").read_text())
    return result, (folder / "journal.jsonl").read_bytes()


def test_one_thread_or_two_and_any_hash_seed_give_the_same_bytes(tmp_path):
    available = sorted(os.sched_getaffinity(0))
    one, journal_one = demo(tmp_path / "one", cpus=available[:1], hash_seed="0")
    two, journal_two = demo(tmp_path / "two", cpus=available[:2], hash_seed="1")
    assert journal_one == journal_two
    assert one == two
    assert one["placed"] == 2
    wall = json.loads((tmp_path / "one" / "demo.wall.json").read_text())
    assert wall["total_s"] > 0
    assert "wall" not in journal_one.decode()
