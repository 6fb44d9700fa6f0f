"""The motion connection: targets are queued and driven on it, and it says how that ended."""

import asyncio
import contextlib
from collections.abc import Sequence
from typing import Any

from drivers.abb.channel import Channel, Exchange
from drivers.abb.checklist import forbidden, refusal
from drivers.abb.messages import (
    MAJOR,
    MINOR,
    Accepted,
    Code,
    ControllerState,
    Flag,
    Hello,
    Message,
    Outcome,
    Refused,
    Result,
    Run,
    Welcome,
)
from drivers.abb.session import CONNECT_TIMEOUT_S, REPLY_TIMEOUT_S, Session, expected
from hal.errors import DeviceTimeoutError, LinkError, PreemptedError

__all__ = ["MotionLink"]

STAND_TIMEOUT_S = 5.0
MAX_RUN = 8_000_000


class MotionLink:
    """Made for one session; connects when it is first needed, and anew when it was lost."""

    def __init__(self, session: Session, device: str, port: int) -> None:
        self._session = session
        self._device = device
        self._port = port
        self._channel: Channel | None = None
        self._connecting = asyncio.Lock()
        self._runs = 0
        # From the moment a RUN is sent until its end is known.
        self.may_be_driving = False

    async def close(self) -> None:
        """Let the connection go."""
        if self._channel is not None:
            await self._channel.close()
            self._channel = None

    async def ready(self, settings: Sequence[Message]) -> None:
        """Be connected. A new connection is told the settings first.

        Raises
        ------
        LinkError
            The controller does not listen: another client is connected, or no program runs.
        """
        async with self._connecting:
            if self._channel is None or not self._channel.is_open:
                await self._connect(settings)

    async def _connect(self, settings: Sequence[Message]) -> None:
        session = self._session
        channel = await Channel.connect(
            session.connector,
            self._port,
            device=self._device,
            name="motion",
            timeout_s=CONNECT_TIMEOUT_S,
        )
        gone = LinkError("the monitor connection is gone; reopen the device", device=self._device)
        session.channel.on_end(lambda: channel.end(session.channel.error or gone))
        try:
            hello = Hello(MAJOR, MINOR, session.welcome.epoch)
            answer = await channel.ask(hello, timeout_s=REPLY_TIMEOUT_S)
            expected(answer, Welcome, self._device)
            self._channel = channel
            for message in settings:
                await self.set(message)
        except BaseException:
            self._channel = None
            await channel.close()
            raise

    async def set(self, message: Message) -> None:
        """Make a setting."""
        answer = await self._open_channel().ask(message, timeout_s=REPLY_TIMEOUT_S)
        expected(answer, Accepted, self._device)

    async def begin(self, targets: Sequence[Message], tick: int) -> Exchange:
        """Queue the targets and start them; nothing moves if one of them is refused.

        ``tick`` is the state's the decision was based on: the controller refuses to start when a
        stop has come since.
        """
        channel = self._open_channel()
        exchanges = [await channel.begin(message) for message in targets]
        self._runs = self._runs % MAX_RUN + 1
        self.may_be_driving = True
        run = await channel.begin(Run(self._runs, len(targets), tick), answers=2)
        try:
            for exchange in (*exchanges, run):
                answer = await channel.answer(exchange, timeout_s=REPLY_TIMEOUT_S, action="run")
                if isinstance(answer, Refused):
                    self.may_be_driving = False
                expected(answer, Accepted, self._device)
        except BaseException:
            for exchange in (*exchanges, run):
                channel.forget(exchange)
            raise
        return run

    def forget(self, run: Exchange) -> None:
        """Give a motion up; what the controller still says of it is dropped."""
        if self._channel is not None:
            self._channel.forget(run)

    async def end(self, run: Exchange) -> Outcome:
        """Wait for the end of a motion.

        Raises
        ------
        SafetyError, RejectedError
            A stop came, the motors went off, the program was stopped: the motion task cannot
            answer. The arm stands.
        LinkError
            A connection was lost; the controller stops the arm.
        """
        end = run.answers[1]
        trouble = self._session.reached(lambda state: forbidden(state) is not Code.NONE)
        waited: list[asyncio.Future[Any]] = [end, trouble]
        try:
            await asyncio.wait(waited, return_when=asyncio.FIRST_COMPLETED)
            if end.done():
                outcome = expected(end.result(), Outcome, self._device)
                self.may_be_driving = False
                return outcome
            # It will answer when somebody has started it again: too late for us.
            self.forget(run)
            await trouble
            code = forbidden(self._session.state)
            await self._session.until(is_standing, timeout_s=STAND_TIMEOUT_S)
            self.may_be_driving = False
            raise refusal(self._device, code)
        finally:
            trouble.cancel()

    async def judge(self, outcome: Outcome, *, is_stopping: bool) -> None:
        """Say how a motion ended, once the arm stands.

        Raises
        ------
        PreemptedError
            It was stopped.
        CellError
            It failed; see ``checklist.refusal``.
        """
        if outcome.result is Result.DONE:
            return
        with contextlib.suppress(DeviceTimeoutError):
            await self._session.until(is_standing, timeout_s=STAND_TIMEOUT_S)
        if outcome.result is Result.FAILED:
            raise refusal(self._device, outcome.code, at=outcome.at)
        code = forbidden(self._session.state)
        if code is not Code.NONE and not is_stopping:
            raise refusal(self._device, code)
        raise PreemptedError("the motion was stopped", device=self._device)

    def _open_channel(self) -> Channel:
        if self._channel is None:
            raise LinkError("the motion connection is gone", device=self._device)
        return self._channel


def is_standing(state: ControllerState) -> bool:
    """Whether the arm has come to rest."""
    return Flag.MOVING not in state.flags
