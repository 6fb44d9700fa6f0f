"""RAPID Message Queue: tasks send each other values of any type.

A task can be found once it runs (``RMQ_`` and its name).
"""

import asyncio
from copy import deepcopy
from typing import Any

from sims.rapid.builtin import Ref, TaskContext, builtin, opaque
from sims.rapid.errors import RapidError
from sims.rapid.queues import MAX_VALUES, Message, Queue, queues_of

__all__: list[str] = []

_WAIT_MAX = 9999999.0

opaque("rmqslot")
opaque("rmqmessage")


def _own(task: TaskContext) -> Queue:
    return queues_of(task.host).of(task.name)


@builtin("PROC RMQFindSlot(VAR rmqslot Slot, string Name)")
def rmq_find_slot(task: TaskContext, *, slot: Ref, name: str) -> None:
    """Look a task's queue up. ERR_RMQ_NAME: there is none of this name."""
    _own(task)
    queue = queues_of(task.host).find(name)
    if queue is None:
        raise RapidError("ERR_RMQ_NAME", f"no queue {name!r}; a task's is RMQ_ and its name")
    slot.set(queue)


@builtin("FUNC string RMQGetSlotName(VAR rmqslot Slot)")
def rmq_get_slot_name(task: TaskContext, *, slot: Ref) -> str:
    """Return the name of a queue."""
    del task
    return f"RMQ_{_queue(slot).name}"


@builtin("PROC RMQSendMessage(VAR rmqslot Slot, REF anytype SendData \\num UserDef)")
def rmq_send_message(
    task: TaskContext, *, slot: Ref, senddata: Ref, userdef: float | None = None
) -> None:
    """Send and go on. ERR_RMQ_FULL: the queue takes no more."""
    _send(task, slot, senddata, userdef)


@builtin(
    "PROC RMQSendWait(VAR rmqslot Slot, REF anytype SendData \\num UserDef, "
    "VAR rmqmessage Message, REF anytype ReceiveDataType \\num TimeOut)"
)
async def rmq_send_wait(
    task: TaskContext,
    *,
    slot: Ref,
    senddata: Ref,
    userdef: float | None = None,
    message: Ref,
    receivedatatype: Ref,
    timeout: float | None = None,
) -> None:
    """Send and wait for an answer of a type. ERR_RMQ_TIMEOUT."""
    _send(task, slot, senddata, userdef)
    queue = _own(task)
    end_s = asyncio.get_running_loop().time() + (60.0 if timeout is None else timeout)
    others: list[Message] = []
    try:
        while True:
            left_s = end_s - asyncio.get_running_loop().time()
            answer = await queue.wait(max(left_s, 0.0))
            if answer is None:
                raise RapidError("ERR_RMQ_TIMEOUT", f"no answer from {_queue(slot).name}")
            if answer.datatype.lower() == receivedatatype.type.lower():
                message.set(answer)
                return
            others.append(answer)
    finally:
        queue.messages.extendleft(reversed(others))


@builtin("PROC RMQGetMessage(VAR rmqmessage Message)")
def rmq_get_message(task: TaskContext, *, message: Ref) -> None:
    """Take the oldest message. ERR_RMQ_NOMSG: there is none."""
    found = _own(task).take()
    if found is None:
        raise RapidError("ERR_RMQ_NOMSG", "no message waits")
    message.set(found)


@builtin("PROC RMQReadWait(VAR rmqmessage Message \\num TimeOut)")
async def rmq_read_wait(task: TaskContext, *, message: Ref, timeout: float | None = None) -> None:
    """Take the oldest message or wait for one, 60 s by default. ERR_RMQ_TIMEOUT."""
    seconds = 60.0 if timeout is None else timeout
    found = await _own(task).wait(None if seconds >= _WAIT_MAX else max(seconds, 0.0))
    if found is None:
        raise RapidError("ERR_RMQ_TIMEOUT", f"no message in {seconds:g} s")
    message.set(found)


@builtin("PROC RMQEmptyQueue()")
def rmq_empty_queue(task: TaskContext) -> None:
    """Drop what waits."""
    _own(task).messages.clear()


@builtin(
    "PROC RMQGetMsgHeader(VAR rmqmessage Message \\INOUT rmqheader Header "
    "\\VAR rmqslot SenderId \\INOUT num UserDef)"
)
def rmq_get_msg_header(
    task: TaskContext,
    *,
    message: Ref,
    header: Ref | None = None,
    senderid: Ref | None = None,
    userdef: Ref | None = None,
) -> None:
    """Say what is in a message and who sent it."""
    found = _message(message)
    if header is not None:
        dims = [*found.dims, 0, 0, 0][:3]
        header.set([found.datatype, float(len(found.dims)), *(float(dim) for dim in dims)])
    if senderid is not None:
        senderid.set(queues_of(task.host).of(found.sender))
    if userdef is not None:
        userdef.set(found.user_def)


@builtin("PROC RMQGetMsgData(VAR rmqmessage Message, INOUT anytype Data)")
def rmq_get_msg_data(task: TaskContext, *, message: Ref, data: Ref) -> None:
    """Copy the value out. ERR_RMQ_VALUE: of another type; ERR_RMQ_DIM: of other dimensions."""
    del task
    found = _message(message)
    if found.datatype.lower() != data.type.lower():
        raise RapidError(
            "ERR_RMQ_VALUE", f"the message holds a {found.datatype}, not a {data.type}"
        )
    if found.dims != _dims(data.get(), data.rank):
        raise RapidError("ERR_RMQ_DIM", f"the message holds an array of {found.dims}")
    data.set(deepcopy(found.data))


def _send(task: TaskContext, slot: Ref, data: Ref, user_def: float | None) -> None:
    queue = _queue(slot)
    value = data.get()
    if _count(value) > MAX_VALUES:
        raise RapidError("ERR_RMQ_MSGSIZE", f"over {MAX_VALUES} values in one message")
    _own(task)
    message = Message(
        data.type,
        _dims(value, data.rank),
        deepcopy(value),
        task.name,
        -1.0 if user_def is None else user_def,
    )
    if not queue.put(message):
        raise RapidError("ERR_RMQ_FULL", f"the queue of {queue.name} is full")


def _queue(slot: Ref) -> Queue:
    queue = slot.get()
    if not isinstance(queue, Queue):
        raise RapidError("ERR_RMQ_INVALID", f"{slot.name} is no queue: RMQFindSlot it first")
    return queue


def _message(message: Ref) -> Message:
    found = message.get()
    if not isinstance(found, Message):
        raise RapidError("ERR_RMQ_INVMSG", f"{message.name} holds no message")
    return found


def _dims(value: Any, rank: int) -> tuple[int, ...]:
    found: list[int] = []
    for _ in range(rank):
        found.append(len(value))
        value = value[0] if value else []
    return tuple(found)


def _count(value: Any) -> int:
    return sum(_count(item) for item in value) if isinstance(value, list) else 1
