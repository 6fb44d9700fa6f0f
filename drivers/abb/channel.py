"""One connection to the controller: requests, their answers, and what comes unasked."""

import asyncio
import contextlib
from collections.abc import Callable

from drivers.abb.checklist import connection_advice
from drivers.abb.codec import MAX_SEQ, encode, reply_decoder
from drivers.abb.messages import Frame, Message
from drivers.transports import Connector, PushTransport, Transport
from hal.errors import CellError, DeviceTimeoutError, LinkError, RemoteProtocolError

__all__ = ["Channel", "Exchange"]

RECEIVE_BYTES = 4096
MAX_FORGOTTEN = 256
REFUSED_FOR_S = 1.5
RETRY_S = 0.02

Event = Callable[[Frame], None]


class Exchange:
    """A request on its way; answers come in order."""

    def __init__(self, seq: int, answers: int) -> None:
        loop = asyncio.get_running_loop()
        self.seq = seq
        self._given = 0
        self.answers: list[asyncio.Future[Message]] = [loop.create_future() for _ in range(answers)]

    def take(self, message: Message) -> bool:
        """Give the next answer; True when it was the last one."""
        future = self.answers[self._given]
        self._given += 1
        if not future.done():
            future.set_result(message)
        return self._given == len(self.answers)

    @property
    def missing(self) -> int:
        """How many answers have not come."""
        return len(self.answers) - self._given

    def fail(self, error: CellError) -> None:
        """Give an error instead of what is missing."""
        for future in self.answers:
            if not future.done():
                future.set_exception(error)
                future.exception()  # whoever waits sees it; nobody need wait


class Channel:
    """Requests are answered by number; an answer to a question nobody asked ends the channel.

    A request that was given up keeps its number in mind, so that its late answer is recognised
    and dropped, never taken for another's.
    """

    def __init__(
        self, device: str, name: str, transport: Transport, on_event: Event | None = None
    ) -> None:
        self.error: CellError | None = None
        self._device = device
        self._name = name
        self._transport = transport
        self._on_event = on_event
        self._seq = 0
        self._pending: dict[int, Exchange] = {}
        self._forgotten: dict[int, int] = {}
        self._on_end: list[Callable[[], None]] = []
        self._decoder = reply_decoder()
        self._reader: asyncio.Task[None] | None = None
        if isinstance(transport, PushTransport):
            transport.deliver_to(self._arrived)
        else:
            loop = asyncio.get_running_loop()
            self._reader = loop.create_task(self._read(), name=f"{name} reader")

    @classmethod
    async def connect(
        cls,
        connector: Connector,
        port: int,
        *,
        device: str,
        name: str,
        timeout_s: float,
        on_event: Event | None = None,
    ) -> "Channel":
        """Open a connection.

        Raises
        ------
        LinkError
            Refused for longer than the controller needs to listen again after its last client,
            unreachable, or no answer in time; says what to check.
        """
        where = f"{connector.where} port {port}"
        try:
            async with asyncio.timeout(timeout_s):
                transport = await _persistent(connector, port)
        except TimeoutError as error:
            why = f"no answer from {where} in {timeout_s:g} s"
            advice = connection_advice(port, was_refused=False)
            raise LinkError(f"{why}; {advice}", device=device) from error
        except OSError as error:
            why = error.strerror or str(error) or type(error).__name__
            advice = connection_advice(port, was_refused=isinstance(error, ConnectionRefusedError))
            raise LinkError(f"{where} cannot be reached: {why}; {advice}", device=device) from error
        return cls(device, name, transport, on_event)

    @property
    def is_open(self) -> bool:
        """Whether requests may be sent."""
        return self.error is None

    def on_end(self, call: Callable[[], None]) -> None:
        """Call when the channel has ended, whyever."""
        self._on_end.append(call)

    async def begin(self, message: Message, *, answers: int = 1) -> Exchange:
        """Send a request and return its exchange.

        Raises
        ------
        LinkError
            The connection is gone.
        """
        if self.error is not None:
            raise self.error
        self._seq = self._seq % MAX_SEQ + 1
        exchange = Exchange(self._seq, answers)
        data = encode(self._seq, message)
        self._pending[exchange.seq] = exchange
        await self._send(data)
        return exchange

    async def ask(self, message: Message, *, timeout_s: float) -> Message:
        """Send a request and return its answer.

        Raises
        ------
        DeviceTimeoutError
            No answer in time.
        LinkError, RemoteProtocolError
            The connection ended.
        """
        exchange = await self.begin(message)
        return await self.answer(exchange, timeout_s=timeout_s, action=type(message).__name__)

    async def answer(
        self, exchange: Exchange, *, timeout_s: float, action: str, which: int = 0
    ) -> Message:
        """Wait for an answer of an exchange; see ``ask``."""
        try:
            async with asyncio.timeout(timeout_s):
                return await exchange.answers[which]
        except TimeoutError as error:
            self.forget(exchange)
            raise DeviceTimeoutError(
                device=self._device, action=action, timeout_s=timeout_s
            ) from error
        except asyncio.CancelledError:
            self.forget(exchange)
            raise

    def forget(self, exchange: Exchange) -> None:
        """Give a request up; answers to it that are still to come are dropped."""
        if self._pending.pop(exchange.seq, None) is None or not exchange.missing:
            return
        self._forgotten[exchange.seq] = exchange.missing
        while len(self._forgotten) > MAX_FORGOTTEN:
            self._forgotten.pop(next(iter(self._forgotten)))

    async def tell(self, message: Message) -> None:
        """Send what needs no answer."""
        if self.error is not None:
            raise self.error
        await self._send(encode(0, message))

    def end(self, error: CellError) -> None:
        """Close; whoever waits gets the error."""
        if self.error is not None:
            return
        self.error = error
        self._transport.close()
        if self._reader is not None and self._reader is not asyncio.current_task():
            self._reader.cancel()
        for exchange in self._pending.values():
            exchange.fail(error)
        self._pending.clear()
        for call in self._on_end:
            call()

    async def close(self) -> None:
        """Close and wait until the reader has ended."""
        self.end(LinkError(f"the {self._name} connection was closed", device=self._device))
        if self._reader is not None:
            with contextlib.suppress(asyncio.CancelledError):
                await self._reader

    async def _send(self, data: bytes) -> None:
        try:
            await self._transport.send(data)
        except OSError as error:
            self.end(self._lost(str(error)))
            raise self.error or error from error

    async def _read(self) -> None:
        try:
            while self.error is None:
                self._arrived(await self._transport.receive(RECEIVE_BYTES))
        except OSError as error:
            self.end(self._lost(str(error)))

    def _arrived(self, data: bytes) -> None:
        """Take what arrived; ``b""``: the end."""
        if self.error is not None:
            return
        if not data:
            self.end(self._lost("the controller closed it"))
            return
        self._decoder.feed(data)
        try:
            while (frame := self._decoder.next_frame()) is not None:
                self._take(frame)
        except RemoteProtocolError as error:
            self.end(error)

    def _take(self, frame: Frame) -> None:
        if frame.seq == 0:
            if self._on_event is not None:
                self._on_event(frame)
        elif (exchange := self._pending.get(frame.seq)) is not None:
            if exchange.take(frame.message):
                del self._pending[frame.seq]
        elif frame.seq in self._forgotten:
            self._forgotten[frame.seq] -= 1
            if self._forgotten[frame.seq] == 0:
                del self._forgotten[frame.seq]
        else:
            raise RemoteProtocolError(
                f"an answer to request {frame.seq}, which nobody asked", device=self._device
            )

    def _lost(self, why: str) -> LinkError:
        return LinkError(
            f"the {self._name} connection is gone ({why}); reopen the device", device=self._device
        )


async def _persistent(connector: Connector, port: int) -> Transport:
    """Connect; a controller that has just lost its last client refuses for a moment."""
    loop = asyncio.get_running_loop()
    until_s = loop.time() + REFUSED_FOR_S
    while True:
        try:
            return await connector.connect(port)
        except ConnectionRefusedError:
            if loop.time() > until_s:
                raise
            await asyncio.sleep(RETRY_S)
