"""The disk of a program: what lies below the host's home folder, and nothing else.

``HOME:/logs/a.txt``, ``/logs/a.txt`` and ``HOME:`` with a file name mean the same. A name with
``..`` in it, another drive, and a link that leads outside are refused with ERR_FILEACC.
"""

import os
from pathlib import Path

from sims.rapid.errors import RapidError
from sims.rapid.host import Host

__all__ = ["MAX_FILES", "MAX_FILE_BYTES", "MAX_OPEN", "Device", "Directory", "locate"]

MAX_FILE_BYTES = 64_000_000
MAX_FILES = 10_000
MAX_OPEN = 40

_MAX_NAME = 200
_open_devices = 0


def locate(host: Host, *parts: str) -> Path:
    """Return the path of a RAPID name. ERR_FILEACC: there is no disk, or the name leads off it."""
    whole = "/".join(part for part in parts if part)
    if host.home is None:
        raise RapidError("ERR_FILEACC", f"{whole}: this controller has no disk")
    drive, colon, rest = whole.partition(":")
    if colon and drive.strip("/").upper() != "HOME":
        raise RapidError("ERR_FILEACC", f"{whole}: only HOME: can be reached")
    names = [name for name in (rest if colon else whole).replace("\\", "/").split("/") if name]
    if any(_is_odd(name) for name in names):
        raise RapidError("ERR_FILEACC", f"{whole}: not a name below HOME:")
    home = host.home.resolve()
    try:
        path = home.joinpath(*names).resolve()
    except (OSError, RuntimeError):
        raise RapidError("ERR_FILEACC", f"{whole}: cannot be followed") from None
    if not path.is_relative_to(home):
        raise RapidError("ERR_FILEACC", f"{whole}: leads out of HOME:")
    return path


def _is_odd(name: str) -> bool:
    return name in (".", "..") or len(name) > _MAX_NAME or not name.isprintable() or ":" in name


def check_room(path: Path) -> None:
    """ERR_FILEACC: a new file would be one too many in its folder."""
    if not path.exists() and path.parent.is_dir():
        with os.scandir(path.parent) as entries:
            if sum(1 for _ in entries) >= MAX_FILES:
                raise RapidError("ERR_FILEACC", f"{path.parent.name} holds {MAX_FILES} files")


class Device:
    """An open file: what an ``iodev`` holds. Reading and writing keep one place."""

    def __init__(self, path: Path, mode: str) -> None:
        """Open; ``mode`` is ``r``, ``w`` or ``a``. ERR_FILEACC, ERR_FILEOPEN."""
        global _open_devices  # noqa: PLW0603
        self.is_open = False
        self.path = path
        self.can_read = mode == "r"
        if _open_devices >= MAX_OPEN:
            raise RapidError("ERR_FILEOPEN", f"{MAX_OPEN} files are open: Close some")
        if not self.can_read:
            check_room(path)
        try:
            self._file = path.open(mode + "b")
        except OSError as error:
            raise RapidError("ERR_FILEACC", f"{path.name}: {error.strerror}") from None
        self.is_open = True
        _open_devices += 1

    def __del__(self) -> None:
        self.close()

    def close(self) -> None:
        """Close; harmless when closed."""
        global _open_devices  # noqa: PLW0603
        if self.is_open:
            self.is_open = False
            _open_devices -= 1
            self._file.close()

    def rewind(self) -> None:
        """Read from the beginning again; a file being written is read from now on."""
        if not self.can_read:
            self._file.close()
            self._file = self.path.open("rb")
            self.can_read = True
        self._file.seek(0)

    def write(self, data: bytes) -> None:
        """ERR_FILEACC: open for reading, or the disk does not take it; ERR_FILESIZE: too long."""
        if self.can_read:
            raise RapidError("ERR_FILEACC", f"{self.path.name} is open for reading")
        if self._file.tell() + len(data) > MAX_FILE_BYTES:
            raise RapidError(
                "ERR_FILESIZE", f"{self.path.name} would be over {MAX_FILE_BYTES} bytes"
            )
        try:
            self._file.write(data)
            self._file.flush()
        except OSError as error:
            raise RapidError("ERR_FILEACC", f"{self.path.name}: {error.strerror}") from None

    def read(self, most: int) -> bytes:
        """Up to so many bytes; none at the end. ERR_FILEACC: open for writing."""
        if not self.can_read:
            raise RapidError("ERR_FILEACC", f"{self.path.name} is open for writing")
        data: bytes = self._file.read(most)
        return data

    def unread(self, count: int) -> None:
        """Step back over bytes that were read."""
        self._file.seek(-count, os.SEEK_CUR)


class Directory:
    """An open folder: what a ``dir`` holds."""

    def __init__(self, path: Path) -> None:
        """List at once, in the order of names. ERR_FILEACC."""
        try:
            names = sorted(os.listdir(path))[:MAX_FILES]
        except OSError as error:
            raise RapidError("ERR_FILEACC", f"{path.name}: {error.strerror}") from None
        self._names = iter([".", "..", *names])

    def next_name(self) -> str | None:
        """Return the next name, None behind the last."""
        return next(self._names, None)
