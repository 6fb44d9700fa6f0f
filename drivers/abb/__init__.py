"""ABB arms through RAPID sockets: the controller package, the codec, the driver."""

from drivers.abb.io import RapidIo
from drivers.abb.package import package_files
from drivers.abb.robot import RapidRobot

__all__ = ["RapidIo", "RapidRobot", "package_files"]
