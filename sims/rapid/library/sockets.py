"""TCP sockets, as the PC Interface option has them."""

import asyncio
import errno
from collections.abc import Awaitable
from typing import Any, TypeVar

from sims.rapid.builtin import Ref, TaskContext, builtin, opaque
from sims.rapid.errors import RapidError
from sims.rapid.host import Listener, Stream
from sims.rapid.task import task_of

MAX_SOCKETS = 32
DEFAULT_TIMEOUT_S = 60.0
WAIT_MAX = 9_999_999.0
MAX_STRING = 80
MAX_BYTES = 1024
CREATED, CONNECTED, BOUND, LISTENING, CLOSED = 1.0, 2.0, 3.0, 4.0, 5.0
R = TypeVar("R")


class Socket:
    """A socket of a task; ``data`` has come but was not asked for yet."""

    def __init__(self) -> None:
        self.status = CREATED
        self.listener: Listener | None = None
        self.stream: Stream | None = None
        self.data = bytearray()

    def close(self) -> None:
        """Both ways; harmless when closed."""
        self.status = CLOSED
        if self.listener is not None:
            self.listener.close()
        if self.stream is not None:
            self.stream.close()


class Count:
    """How many sockets of all tasks are open."""

    def __init__(self) -> None:
        self.used = 0


class Sockets:
    """A task's sockets; all are closed when its program starts anew."""

    def __init__(self) -> None:
        self._sockets: set[Socket] = set()
        self._count = Count()

    def add(self, socket: Socket, count: Count) -> Socket:
        """Keep a socket. ERR_SOCK_UNSPEC: 32 are open."""
        self._count = count
        if count.used >= MAX_SOCKETS:
            socket.close()
            raise RapidError("ERR_SOCK_UNSPEC", f"{MAX_SOCKETS} sockets are open: close some")
        count.used += 1
        self._sockets.add(socket)
        return socket

    def remove(self, socket: Socket) -> None:
        """Close a socket."""
        socket.close()
        if socket in self._sockets:
            self._sockets.remove(socket)
            self._count.used -= 1

    def close(self) -> None:
        """Close all."""
        for socket in tuple(self._sockets):
            self.remove(socket)


opaque("socketdev")


def _add(task: TaskContext, socket: Socket) -> Socket:
    owner = task_of(task)
    return owner.service(Sockets).add(socket, owner.common_service(Count))


def _open(ref: Ref, *statuses: float) -> Socket:
    socket: Socket | None = ref.get()
    if socket is None or socket.status == CLOSED:
        raise RapidError("ERR_SOCK_CLOSED", f"the socket {ref.name} is not created, or closed")
    if socket.status not in statuses:
        name = {CREATED: "ERR_SOCK_NOT_BOUND", BOUND: "ERR_SOCK_NOT_BOUND"}.get(
            statuses[0], "ERR_SOCK_NOT_CONN"
        )
        raise RapidError(name, f"the socket {ref.name} is not in the right state for this")
    return socket


async def _in_time(waiting: Awaitable[R], time_s: float | None) -> R:
    limit_s = DEFAULT_TIMEOUT_S if time_s is None else time_s
    try:
        async with asyncio.timeout(None if limit_s >= WAIT_MAX else max(0.0, limit_s)):
            return await waiting
    except TimeoutError:
        raise RapidError("ERR_SOCK_TIMEOUT", f"nothing happened within {limit_s:g} s") from None
    except ConnectionError as error:
        raise RapidError("ERR_SOCK_CLOSED", str(error)) from error


@builtin("PROC SocketCreate(VAR socketdev Socket \\switch UDP)")
def socket_create(task: TaskContext, *, socket: Ref, udp: bool) -> None:
    """A new socket. One that the variable still holds stays open, as on a controller."""
    if udp:
        raise RapidError("ERR_SOCK_UNSPEC", "UDP sockets are not supported: use TCP")
    socket.set(_add(task, Socket()))


@builtin("PROC SocketBind(VAR socketdev Socket, string LocalAddress, num LocalPort)")
async def socket_bind(
    task: TaskContext, *, socket: Ref, localaddress: str, localport: float
) -> None:
    """Take an address and a port. ERR_SOCK_ADDR_INUSE, ERR_SOCK_ADDR_INVALID."""
    held = _open(socket, CREATED)
    try:
        held.listener = await task.host.network.listen(localaddress, int(localport))
    except (OSError, OverflowError) as error:
        is_used = getattr(error, "errno", None) == errno.EADDRINUSE
        name = "ERR_SOCK_ADDR_INUSE" if is_used else "ERR_SOCK_ADDR_INVALID"
        raise RapidError(name, f"{localaddress}:{localport:g}: {error}") from error
    held.status = BOUND


@builtin("PROC SocketListen(VAR socketdev Socket)")
def socket_listen(task: TaskContext, *, socket: Ref) -> None:
    """Be ready for clients."""
    del task
    _open(socket, BOUND, LISTENING).status = LISTENING


@builtin(
    "PROC SocketAccept(VAR socketdev Socket, VAR socketdev ClientSocket "
    "\\VAR string ClientAddress \\num Time)"
)
async def socket_accept(
    task: TaskContext,
    *,
    socket: Ref,
    clientsocket: Ref,
    clientaddress: Ref | None,
    time: float | None,
) -> None:
    """Wait for a client. ERR_SOCK_TIMEOUT, ERR_SOCK_CLOSED."""
    held = _open(socket, LISTENING)
    assert held.listener is not None
    client = Socket()
    client.stream = await _in_time(held.listener.accept(), time)
    client.status = CONNECTED
    clientsocket.set(_add(task, client))
    if clientaddress is not None:
        clientaddress.set(client.stream.peer)


@builtin("PROC SocketConnect(VAR socketdev Socket, string Address, num Port \\num Time)")
async def socket_connect(
    task: TaskContext, *, socket: Ref, address: str, port: float, time: float | None
) -> None:
    """Connect to a server. ERR_SOCK_TIMEOUT, ERR_SOCK_CLOSED, ERR_SOCK_IS_CONN."""
    held: Socket | None = socket.get()
    if held is not None and held.status == CONNECTED:
        raise RapidError("ERR_SOCK_IS_CONN", f"{socket.name} is connected already")
    held = _open(socket, CREATED, BOUND)
    try:
        held.stream = await _in_time(task.host.network.connect(address, int(port)), time)
    except (OSError, OverflowError) as error:
        raise RapidError("ERR_SOCK_CLOSED", f"{address}:{port:g}: {error}") from error
    held.status = CONNECTED


@builtin("PROC SocketClose(VAR socketdev Socket)")
def socket_close(task: TaskContext, *, socket: Ref) -> None:
    """Close it; harmless when closed."""
    held: Socket | None = socket.get()
    if held is not None:
        task_of(task).service(Sockets).remove(held)


@builtin("FUNC socketstatus SocketGetStatus(VAR socketdev Socket)")
def socket_get_status(task: TaskContext, *, socket: Ref) -> float:
    """``SOCKET_CREATED`` .. ``SOCKET_CLOSED``."""
    del task
    held: Socket | None = socket.get()
    return CLOSED if held is None else held.status


@builtin("FUNC num SocketPeek(VAR socketdev Socket)")
def socket_peek(task: TaskContext, *, socket: Ref) -> float:
    """How many bytes could be received at once."""
    del task
    held = _open(socket, CONNECTED)
    assert held.stream is not None
    return float(min(len(held.data) + held.stream.pending(), MAX_BYTES))


@builtin(
    "PROC SocketReceive(VAR socketdev Socket \\VAR string Str | VAR rawbytes RawData "
    "| VAR byte Data{*} \\num ReadNoOfBytes \\VAR num NoRecBytes \\num Time)"
)
async def socket_receive(task: TaskContext, **arguments: Any) -> None:
    """Wait for data: what is there, or exactly so many bytes.

    ERR_SOCK_TIMEOUT (nothing is lost), ERR_SOCK_CLOSED (at the end of the data).
    """
    del task
    held = _open(arguments["socket"], CONNECTED)
    most = _most(arguments)
    wanted = arguments["readnoofbytes"]
    least = 1 if wanted is None else int(wanted)
    if not 1 <= least <= most:
        raise RapidError("ERR_ARGVALERR", f"1 to {most} bytes can be received, not {least}")
    await _in_time(_gather(held, least), arguments["time"])
    count = min(len(held.data) + _pending(held), most) if wanted is None else least
    if count > len(held.data):
        assert held.stream is not None
        held.data += await held.stream.receive(count - len(held.data))
    data = bytes(held.data[:count])
    del held.data[:count]
    _deliver(arguments, data)


def _pending(held: Socket) -> int:
    return 0 if held.stream is None else held.stream.pending()


async def _gather(held: Socket, least: int) -> None:
    """Until so many bytes are in ``data``."""
    assert held.stream is not None
    while len(held.data) < least:
        data = await held.stream.receive(least - len(held.data))
        if not data:
            held.status = CLOSED if not held.data else held.status
            raise RapidError("ERR_SOCK_CLOSED", f"{held.stream.peer} has closed the connection")
        held.data += data


def _most(arguments: dict[str, Any]) -> int:
    if arguments["str"] is not None:
        return MAX_STRING
    if arguments["rawdata"] is not None:
        return MAX_BYTES
    if arguments["data"] is not None:
        return min(MAX_BYTES, len(arguments["data"].get()))
    raise RapidError("ERR_ARGVALERR", "SocketReceive needs \\Str, \\RawData or \\Data")


def _deliver(arguments: dict[str, Any], data: bytes) -> None:
    if arguments["str"] is not None:
        arguments["str"].set(data.decode("latin-1"))
    elif arguments["rawdata"] is not None:
        arguments["rawdata"].get()[:] = data
    else:
        values = arguments["data"].get()
        values[: len(data)] = [float(byte) for byte in data]
    if arguments["norecbytes"] is not None:
        arguments["norecbytes"].set(float(len(data)))


@builtin(
    "PROC SocketSend(VAR socketdev Socket \\string Str | VAR rawbytes RawData | byte Data{*} "
    "\\num NoOfBytes)"
)
async def socket_send(task: TaskContext, **arguments: Any) -> None:
    """Send all of it, or so many bytes. ERR_SOCK_CLOSED."""
    del task
    held = _open(arguments["socket"], CONNECTED)
    assert held.stream is not None
    data = _data_to_send(arguments)
    count = arguments["noofbytes"]
    if count is not None:
        if not 0 <= count <= len(data):
            raise RapidError("ERR_ARGVALERR", f"there are {len(data)} bytes, not {count:g}")
        data = data[: int(count)]
    try:
        await held.stream.send(data)
    except ConnectionError as error:
        held.status = CLOSED
        raise RapidError("ERR_SOCK_CLOSED", str(error)) from error


def _data_to_send(arguments: dict[str, Any]) -> bytes:
    if arguments["str"] is not None:
        text: str = arguments["str"]
        return text.encode("latin-1", "replace")
    if arguments["rawdata"] is not None:
        return bytes(arguments["rawdata"].get())
    if arguments["data"] is not None:
        values = arguments["data"][:MAX_BYTES]
        if any(value != int(value) or not 0 <= value <= 255 for value in values):
            raise RapidError("ERR_ARGVALERR", "bytes are whole numbers from 0 to 255")
        return bytes(int(value) for value in values)
    raise RapidError("ERR_ARGVALERR", "SocketSend needs \\Str, \\RawData or \\Data")
