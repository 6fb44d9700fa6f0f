"""Messages as hypothesis makes them, and how near they must come back over the wire."""

import math

from hypothesis import strategies as st

from drivers.abb import messages as m

__all__ = ["REPLIES", "REQUESTS", "flat", "same"]

number = st.floats(-100, 100, width=32)
triples = st.tuples(number, number, number)
quaternions = st.tuples(*[st.floats(-1, 1, width=32)] * 4)
joints = st.tuples(*[st.floats(-7, 7, width=32)] * 6)
confs = st.tuples(*[st.integers(-8, 7)] * 4)
lengths = st.floats(0, 10, width=32)
longs = st.integers(0, 8_000_000)
words = st.integers(0, 65535)
octets = st.integers(0, 255)
names = st.text(st.characters(min_codepoint=32, max_codepoint=255), max_size=80)
signals = st.lists(st.text("abcdefghij0123456789", max_size=32), max_size=14).map(tuple)

REQUESTS = st.one_of(
    st.builds(m.Hello, octets, octets, longs),
    st.just(m.Identify()),
    st.builds(m.AddJoint, joints, lengths, lengths),
    st.builds(m.AddLinear, triples, quaternions, confs, lengths, lengths),
    st.builds(m.AddCircular, triples, quaternions, triples, quaternions, confs, lengths, lengths),
    st.builds(m.Run, longs, words, longs),
    st.just(m.Drop()),
    st.builds(m.SetTool, triples, quaternions, lengths, triples),
    st.builds(m.SetWorkObject, triples, quaternions),
    st.builds(m.SetLoad, lengths, triples),
    st.builds(m.SetAcceleration, lengths, lengths),
    st.just(m.AskState()),
    st.just(m.Stop()),
    st.just(m.Ping()),
    st.just(m.AskSignals()),
    st.builds(m.Write, octets, octets),
    st.builds(m.Pulse, octets, lengths),
    st.builds(m.WaitFor, octets, octets, octets, lengths),
)
REPLIES = st.one_of(
    st.builds(m.Welcome, octets, octets, longs, words, words.map(lambda ms: ms / 1000)),
    st.builds(m.IdentityReply, names, names, names),
    st.builds(m.Accepted, longs),
    st.builds(m.Outcome, st.sampled_from(m.Result), st.sampled_from(m.Code), longs, words),
    st.builds(m.Refused, st.sampled_from(m.Code), words),
    st.builds(
        m.ControllerState,
        words,
        lengths,
        st.integers(0, 255).map(m.Flag),
        st.sampled_from(m.Code),
        longs,
        longs,
        joints,
        triples,
        quaternions,
        words,
        words,
    ),
    st.builds(m.SignalNames, signals, signals),
)


def flat(value):
    """All numbers and texts of a message, in order."""
    if isinstance(value, tuple):
        return [item for part in value for item in flat(part)]
    if hasattr(value, "__slots__"):
        return [item for name in value.__slots__ for item in flat(getattr(value, name))]
    return [value]


def same(a, b):
    """Equal, but for binary32 and the units of the wire."""
    if type(a) is not type(b):
        return False
    for one, other in zip(flat(a), flat(b), strict=True):
        if isinstance(one, float) and not isinstance(one, bool):
            if not math.isclose(one, other, rel_tol=3e-7, abs_tol=1e-9):
                return False
        elif one != other:
            return False
    return True
