"""The controller's signals: bits of devices, alone and in groups, and analog values."""

import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from functools import partial

import numpy as np

from sims.controller.backup import CrossConnection, SignalConfig
from sims.rapid.errors import RapidError
from sims.rapid.host import SignalKind
from sims.world.cabinet import Cabinet

__all__ = ["ControllerSignal", "SignalBoard"]

Cancel = Callable[[], None]

GROUPS = (SignalKind.GI, SignalKind.GO)
ANALOG = (SignalKind.AI, SignalKind.AO)
DIGITAL = (SignalKind.DI, SignalKind.DO)
INPUTS = (SignalKind.DI, SignalKind.GI, SignalKind.AI)
MOST_BITS = 32
PROTECTED = ("readonly", "internal")


@dataclass(eq=False)
class _Device:
    bits: dict[int, bool] = field(default_factory=dict)
    signals: "list[ControllerSignal]" = field(default_factory=list)


class ControllerSignal:
    """One signal on its device."""

    def __init__(self, config: SignalConfig, device: _Device) -> None:
        self.config = config
        self.name = config.name
        self.bits = _bits(config)
        self.kind = config.kind
        self._device = device
        self._analog = float(config.default)
        self._watchers: list[Callable[[float], None]] = []
        self._last = 0.0
        self.drive: Callable[[bool], None] | None = None
        device.signals.append(self)

    @property
    def value(self) -> float:
        """Now."""
        if self.kind in ANALOG:
            return self._analog
        bits = self._device.bits
        return float(sum(1 << k for k, bit in enumerate(self.bits) if bits.get(bit, False)))

    def set(self, value: float) -> None:
        """Write an output from a program.

        Raises
        ------
        RapidError
            An input, a protected output, or a value out of range.
        """
        if self.kind in INPUTS or self.config.access.lower() in PROTECTED:
            raise RapidError("ERR_ARGVALERR", f"signal {self.name} cannot be written by a program")
        self.put(value)

    def put(self, value: float) -> None:
        """Bring to a value from outside: the pendant, the world, the system.

        Raises
        ------
        RapidError
            The value is out of range.
        """
        if not np.isfinite(value):
            raise RapidError("ERR_ARGVALERR", f"signal {self.name} := {value}")
        if self.kind in ANALOG:
            self._put_analog(value)
            return
        most = 2 ** len(self.bits) - 1
        number = int(value != 0) if self.kind not in GROUPS else round(value)
        if not 0 <= number <= most:
            raise RapidError("ERR_GO_LIM", f"signal {self.name} := {value:g}; 0 to {most}")
        for k, bit in enumerate(self.bits):
            self._device.bits[bit] = bool(number >> k & 1)
        for signal in self._device.signals:
            signal.tell()

    def _put_analog(self, value: float) -> None:
        low, high = self.config.logical_min, self.config.logical_max
        if low < high and not low <= value <= high:
            raise RapidError("ERR_AO_LIM", f"signal {self.name} := {value:g}; {low:g} to {high:g}")
        self._analog = float(value)
        self.tell()

    def tell(self) -> None:
        """Call back those who watch, if the value is another one."""
        value = self.value
        if value == self._last:
            return
        self._last = value
        if self.drive is not None:
            self.drive(bool(value))
        for watcher in list(self._watchers):
            watcher(value)

    def watch(self, changed: Callable[[float], None]) -> Cancel:
        """Call back with the new value at every change, until cancelled."""
        self._watchers.append(changed)

        def cancel() -> None:
            if changed in self._watchers:
                self._watchers.remove(changed)

        return cancel


class SignalBoard:
    """All signals by lower-case name; those named like the cabinet's are the cabinet's.

    Raises
    ------
    ValueError
        Two signals have one name.
    """

    def __init__(
        self,
        configs: Iterable[SignalConfig],
        cabinet: Cabinet,
        crosses: Iterable[CrossConnection] = (),
    ) -> None:
        self._cabinet = cabinet
        self.by_name: dict[str, ControllerSignal] = {}
        devices: dict[str, _Device] = {}
        self._inputs: list[tuple[str, ControllerSignal]] = []
        self._seen: dict[str, bool] = {}
        for config in configs:
            self._add(config, devices)
        self.poll()
        for cross in crosses:
            self._connect(cross)

    def _add(self, config: SignalConfig, devices: dict[str, _Device]) -> None:
        name = config.name.lower()
        if name in self.by_name:
            raise ValueError(f"two signals are named {config.name}")
        is_mapped = config.device and config.device_map
        device = devices.setdefault(config.device.lower() if is_mapped else f"={name}", _Device())
        signal = self.by_name[name] = ControllerSignal(config, device)
        if config.kind is SignalKind.DI and name in self._cabinet.inputs:
            self._inputs.append((name, signal))
        elif config.kind is SignalKind.DO and name in self._cabinet.outputs:
            signal.drive = partial(self._drive, name)
        if config.default and config.kind not in ANALOG:
            signal.put(config.default)

    def _connect(self, cross: CrossConnection) -> None:
        names = [cross.result, *(name for name, _ in cross.actors)]
        signals = [self.by_name.get(name.lower()) for name in names]
        if any(signal is None or signal.kind not in DIGITAL for signal in signals):
            return
        result = self.by_name[cross.result.lower()]
        is_busy = False

        def follow(_: float = 0.0) -> None:
            nonlocal is_busy
            if is_busy:  # a ring of inverted connections would never rest
                return
            is_busy = True
            try:
                result.put(float(self._joined(cross)))
            finally:
                is_busy = False

        for name, _ in cross.actors:
            self.by_name[name.lower()].watch(follow)
        follow()

    def _joined(self, cross: CrossConnection) -> bool:
        levels = [bool(self.by_name[name.lower()].value) != turned for name, turned in cross.actors]
        joined = levels[0]
        for operator, level in zip(cross.operators, levels[1:], strict=False):
            joined = joined or level if operator == "OR" else joined and level
        return joined

    def _drive(self, name: str, is_on: bool) -> None:
        self._cabinet.outputs[name] = is_on

    def poll(self) -> None:
        """Take over what the cabinet's inputs say."""
        inputs = self._cabinet.inputs
        if inputs == self._seen:
            return
        self._seen = dict(inputs)
        for name, signal in self._inputs:
            signal.put(float(inputs[name]))

    def set_input(self, name: str, value: float) -> None:
        """The operator's or a test's hand on an input.

        Raises
        ------
        ValueError
            There is no such input, or it has no such value.
        """
        signal = self.by_name.get(name.lower())
        if signal is None or signal.kind not in INPUTS:
            raise ValueError(f"there is no input {name!r}")
        if signal.kind is SignalKind.DI and name.lower() in self._cabinet.inputs:
            self._cabinet.inputs[name.lower()] = bool(value)
        try:
            signal.put(value)
        except RapidError as error:
            raise ValueError(str(error)) from error


def _bits(config: SignalConfig) -> tuple[int, ...]:
    """The bits of a signal on its device, from a map such as ``0-7,9``; lowest first."""
    if config.kind in ANALOG:
        return ()
    bits: list[int] = []
    for part in config.device_map.split(","):
        match = re.fullmatch(r"\s*([0-9]{1,6})\s*(?:-\s*([0-9]{1,6}))?\s*", part)
        if match is not None:
            first, last = int(match[1]), int(match[2] or match[1])
            step = 1 if last >= first else -1
            bits += list(range(first, last + step, step))[: MOST_BITS + 1 - len(bits)]
    count = config.bits if config.kind in GROUPS else 1
    return tuple(bits[:MOST_BITS]) if bits else tuple(range(min(count, MOST_BITS)))
