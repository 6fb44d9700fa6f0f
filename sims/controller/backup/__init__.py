"""A controller's backup folder, as a value."""

from sims.controller.backup.folder import read_backup
from sims.controller.backup.values import (
    Backup,
    BackupTask,
    CrossConnection,
    Event,
    EventRoutine,
    MotionConfig,
    SignalConfig,
    SystemInput,
    SystemOutput,
)

__all__ = [
    "Backup",
    "BackupTask",
    "CrossConnection",
    "Event",
    "EventRoutine",
    "MotionConfig",
    "SignalConfig",
    "SystemInput",
    "SystemOutput",
    "read_backup",
]
