"""What happened, one JSON object a line, the same bytes for the same run.

A record has ``t_ns`` (loop time), ``event`` and the event's own fields. Floats are rounded
to nine significant digits, keys are sorted, and wall times never enter.
"""

import hashlib
import json
from pathlib import Path
from typing import Any

import numpy as np

from hal import Transform

__all__ = ["Journal", "quantise"]


def quantise(value: Any) -> Any:
    """Turn arrays, tuples and floats into JSON values with nine significant digits."""
    if isinstance(value, Transform):
        return quantise(value.matrix[:3])
    if isinstance(value, dict):
        return {str(key): quantise(item) for key, item in value.items()}
    if isinstance(value, np.ndarray):
        return quantise(value.tolist())
    if isinstance(value, (list, tuple)):
        return [quantise(item) for item in value]
    if isinstance(value, (float, np.floating)):
        # + 0.0 so that -0.0 and 0.0 are the same bytes
        return float(f"{float(value):.9g}") + 0.0 if np.isfinite(value) else None
    if isinstance(value, np.integer):
        return int(value)
    if isinstance(value, (np.bool_, bool)):
        return bool(value)
    return value


class Journal:
    """Kept in memory and, if a path is given, written line by line as it grows."""

    def __init__(self, path: Path | None = None) -> None:
        self.records: list[dict[str, Any]] = []
        self._digest = hashlib.sha256()
        self._file = path.open("w", encoding="utf-8") if path else None

    def write(self, event: str, t_ns: int, **fields: Any) -> None:
        """Add a record."""
        record = quantise({"t_ns": t_ns, "event": event, **fields})
        line = json.dumps(record, sort_keys=True, ensure_ascii=True) + "\n"
        self.records.append(record)
        self._digest.update(line.encode())
        if self._file:
            self._file.write(line)
            self._file.flush()

    def of(self, event: str) -> list[dict[str, Any]]:
        """Every record of one event, in order."""
        return [record for record in self.records if record["event"] == event]

    @property
    def sha256(self) -> str:
        """Over the lines so far."""
        return self._digest.hexdigest()

    def close(self) -> None:
        """Close the file, if any."""
        if self._file:
            self._file.close()
            self._file = None
