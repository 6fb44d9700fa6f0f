"""A backup folder, as a controller writes it, becomes one value."""

from pathlib import Path

import pytest

from hal.errors import ConfigError
from sims.controller.backup import Event, read_backup
from sims.rapid.builtin import TaskKind
from sims.rapid.host import SignalKind

SYS = r"""SYS:CFG_1.0:6:0::
#
CAB_TASKS:

      -Name "T_ROB1" -Type "NORMAL" -MotionTask -Entry "mainRob"

      -Name "T_STATE" -Type "SEMISTATIC" -TrustLevel \
      "SysStop"
#
CAB_EXEC_HOOKS:
      -Routine "second" -Shelf "START" -Task "T_ROB1" -SeqNo 2
      -Routine "first" -Shelf "POWER_ON" -AllTask -SeqNo 1
      -Routine "odd" -Shelf "SOMETIMES" -Task "T_ROB1"
#
CAB_TASK_MODULES:
      -File "HOME:/lib/shared.sys" -AllTask
      -File "RELEASE:/addin.sys" -Task "T_ROB1"
#
CAB_UNHEARD_OF:
      -Name "x"
"""

EIO = """EIO:CFG_1.0:6:1::
#
SYSSIG_OUT:
      -Status "MotorOn" -Signal "doMotors"
#
SYSSIG_IN:
      -Signal "diStart" -Action "Start" -Arg1 "CONT"
#
EIO_CROSS:
      -Name "x1" -Res "doBoth" -Act1 "diA" -Oper1 "AND" -Act2 "diB" -Act2_invert
#
EIO_SIGNAL:
      -Name "diA" -SignalType "DI" -Device "Board10" -DeviceMap "0"
      -Name "goWide" -SignalType "GO" -DeviceMap "0-7,9" -Default 3
      -Name "DIA" -SignalType "DO"
      -Name "odd" -SignalType "XX"
"""

MOC = "MOC:CFG_1.0:6:0::\n#\nARM:\n" + "".join(
    f'  -name "rob1_{axis}" -upper_joint_bound {axis}.5 -lower_joint_bound -{axis}.25\n'
    for axis in range(1, 7)
)
MOC += '#\nROBOT:\n  -name "ROB_1" -use_robot_type "ROB1_1200_0.9_5" -base_frame_pos_x 1 \\\n'
MOC += "  -base_frame_pos_y 2 -base_frame_pos_z 0.5\n"

BACKINFO = """>>SYSTEM_ID:
Cell

>>PRODUCTS_ID:
RobotWare 6.08

>>TASK1: (T_ROB1,,)
SYSMOD/user.sys @
PROGMOD/Used.mod @
PROGMOD/Lost.mod @
PROGMOD/../../../../secret.mod @

>>TASK3: (T_STATE,,)

>>TASK9: (T_GONE,,)

>>EOF:
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "secret.mod").write_text("MODULE secret ENDMODULE")
    root = tmp_path / "backup"
    files = {
        "BACKINFO/backinfo.txt": BACKINFO,
        "SYSPAR/SYS.cfg": SYS,
        "SYSPAR/EIO.cfg": EIO,
        "SYSPAR/moc.CFG": MOC,
        "HOME/lib/shared.sys": "",
        "RAPID/TASK1/PROGMOD/Used.mod": "",
        "RAPID/TASK1/PROGMOD/Used_old.mod": "",
        "RAPID/TASK1/SYSMOD/USER.SYS": "",
        "RAPID/TASK3/PROGMOD/State.mod": "",
    }
    for name, text in files.items():
        (root / name).parent.mkdir(parents=True, exist_ok=True)
        (root / name).write_text(text)
    return root


def test_tasks_are_those_of_the_configuration_with_the_modules_of_backinfo(folder: Path) -> None:
    motion, state = read_backup(folder).tasks
    assert (motion.name, motion.kind, motion.has_motion) == ("T_ROB1", TaskKind.NORMAL, True)
    assert motion.entry == "mainRob"
    assert [p.name for p in motion.modules] == ["USER.SYS", "Used.mod", "shared.sys"]
    assert (state.kind, state.has_motion, state.entry) == (TaskKind.SEMISTATIC, False, "main")
    assert state.trust_level == "SysStop"
    assert [p.name for p in state.modules] == ["State.mod", "shared.sys"]


def test_what_is_not_loaded_or_not_understood_is_named(folder: Path) -> None:
    rest = "\n".join(read_backup(folder).rest)
    for part in ("Used_old.mod", "Lost.mod", "T_GONE", "CAB_UNHEARD_OF (1)", "SOMETIMES", "addin"):
        assert part in rest, part
    assert "'XX'" in rest
    assert "stands twice" in rest


def test_no_module_is_taken_from_outside_the_backup(folder: Path) -> None:
    backup = read_backup(folder)
    assert all(folder in path.parents for task in backup.tasks for path in task.modules)
    link = folder / "RAPID/TASK1/PROGMOD/Lost.mod"
    link.symlink_to(folder.parent / "secret.mod")
    assert link not in read_backup(folder).tasks[0].modules


def test_signals_crosses_and_system_signals_are_read(folder: Path) -> None:
    backup = read_backup(folder)
    first, wide = backup.signals
    assert (first.name, first.kind, first.device) == ("diA", SignalKind.DI, "Board10")
    assert (wide.kind, wide.bits, wide.default) == (SignalKind.GO, 9, 3.0)
    assert backup.crosses[0].actors == (("diA", False), ("diB", True))
    assert backup.crosses[0].operators == ("AND",)
    assert backup.system_inputs[0].arguments == ("CONT",)
    assert backup.system_outputs[0].status == "MotorOn"


def test_event_routines_come_in_their_sequence(folder: Path) -> None:
    first, second = read_backup(folder).event_routines
    assert (first.event, first.routine, first.task) == (Event.POWER_ON, "first", "")
    assert (second.event, second.routine, second.task) == (Event.START, "second", "T_ROB1")


def test_joint_bounds_and_base_frame_come_from_the_motion_configuration(folder: Path) -> None:
    motion = read_backup(folder).motion
    assert motion.robot_type == "ROB1_1200_0.9_5"
    assert motion.joint_bounds_rad is not None
    assert motion.joint_bounds_rad[5] == (-6.25, 6.5)
    assert motion.base_position_m == (1.0, 2.0, 0.5)
    assert motion.base_orientation is None


def test_a_folder_that_is_no_backup_is_refused_with_what_to_name(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match="folder that the controller wrote"):
        read_backup(tmp_path)
