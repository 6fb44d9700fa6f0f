"""The RAPID modules and configuration that are loaded into a controller."""

from pathlib import Path

__all__ = ["package_files"]

FOLDER = Path(__file__).parent / "controller"
MOTION_TASK, MONITOR_TASK = "T_ROB1", "T_BINPICK"
SHARED = ("BinpickConfig.sys", "BinpickShared.sys")
OWN = {
    MOTION_TASK: ("BinpickTargets.mod", "BinpickSettings.mod", "BinpickMotion.mod"),
    MONITOR_TASK: ("BinpickSignals.mod", "BinpickMonitor.mod"),
}


def package_files() -> dict[str, list[Path]]:
    """Return the modules of each task, in the order they are loaded."""
    return {task: [FOLDER / name for name in (*SHARED, *own)] for task, own in OWN.items()}
