import itertools
import struct

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from drivers.abb import messages as m
from drivers.abb.codec import encode, reply_decoder, request_decoder
from drivers.abb.layouts import REPLIES as REPLY_LAYOUTS
from drivers.abb.layouts import REQUESTS as REQUEST_LAYOUTS
from hal.errors import LocalProtocolError, RemoteProtocolError
from tests.drivers.abb.strategies import REPLIES, REQUESTS, flat, same

seqs = st.integers(0, 8_000_000)

# Written by hand from docs/reference/abb-protocol.md.
GOLDEN = [
    (1, m.Hello(1, 0, 77), "b1 01 0006 00000001  01 00 0000004d"),
    (2, m.Identify(), "b1 02 0000 00000002"),
    (
        0x01020304 // 16,
        m.Run(7, 3, 9),
        "b1 13 000a 00102030  00000007 0003 00000009",
    ),
    (
        5,
        m.SetLoad(0.5, (0.0, 0.0, 0.125)),
        "b1 22 0010 00000005  3f000000 00000000 00000000 42fa0000",
    ),
    (6, m.Write(3, 1), "b1 41 0002 00000006  03 01"),
    (
        9,
        m.AddLinear((0.5, 0.0, -0.25), (1.0, 0.0, 0.0, 0.0), (0, -1, 1, 4), 0.25, 0.01),
        "b1 11 0028 00000009  43fa0000 00000000 c37a0000  3f800000 00000000 00000000 00000000"
        " 00 ff 01 04  437a0000 41200000",
    ),
]
GOLDEN_REPLIES = [
    (1, m.Welcome(1, 0, 77, 50, 0.5), "b1 81 000a 00000001  01 00 0000004d 0032 01f4"),
    (
        4,
        m.Outcome(m.Result.STOPPED, m.Code.STOP_ORDERED, 7, 2),
        "b1 91 0009 00000004  03 0019 00000007 0002",
    ),
    (4, m.Refused(m.Code.OUT_OF_REACH, 2), "b1 92 0004 00000004  000a 0002"),
    (8, m.SignalNames(("di1",), ("do1", "x")), "b1 c0 000c 00000008  01 02 03646931 03646f31 0178"),
]


@pytest.mark.parametrize(("seq", "message", "text"), GOLDEN)
def test_requests_are_as_the_protocol_has_them(seq, message, text):
    assert encode(seq, message) == bytes.fromhex(text)


@pytest.mark.parametrize(("seq", "message", "text"), GOLDEN_REPLIES)
def test_replies_are_read_as_the_protocol_has_them(seq, message, text):
    decoder = reply_decoder()
    decoder.feed(bytes.fromhex(text))
    assert decoder.next_frame() == m.Frame(seq, message)
    assert decoder.next_frame() is None


def test_near_is_same_and_far_is_not():
    assert same(m.SetLoad(1.0, (0, 0, 0.1)), m.SetLoad(1.0 + 1e-8, (0, 0, 0.1)))
    assert not same(m.SetLoad(1.0, (0, 0, 0.1)), m.SetLoad(1.001, (0, 0, 0.1)))
    assert not same(m.Accepted(1), m.Accepted(2))
    assert flat(m.SetLoad(1.0, (0, 0, 0.1))) == pytest.approx([1.0, 0, 0, 0.1])


def outcomes(decoder, pieces):
    """Frames until the stream ends or errs; the error's text last."""
    seen = []
    for piece in pieces:
        decoder.feed(piece)
        try:
            while (frame := decoder.next_frame()) is not None:
                seen.append(frame)
        except RemoteProtocolError as error:
            seen.append(str(error))
            with pytest.raises(RemoteProtocolError):
                decoder.next_frame()
            break
    return seen


def cut(stream, at):
    ends = sorted({min(i, len(stream)) for i in at} | {0, len(stream)})
    return [stream[a:b] for a, b in itertools.pairwise(ends)]


@given(st.lists(st.tuples(seqs, REQUESTS), max_size=6), st.lists(st.integers(0, 700)))
def test_requests_come_back_however_the_stream_is_cut(frames, at):
    stream = b"".join(encode(seq, message) for seq, message in frames)
    seen = outcomes(request_decoder(), cut(stream, at))
    assert [frame.seq for frame in seen] == [seq for seq, _ in frames]
    for frame, (_, message) in zip(seen, frames, strict=True):
        assert same(frame.message, message)


@given(st.lists(st.tuples(seqs, REPLIES), max_size=6), st.lists(st.integers(0, 2000)))
def test_replies_come_back_however_the_stream_is_cut(frames, at):
    stream = b"".join(encode(seq, message) for seq, message in frames)
    seen = outcomes(reply_decoder(), cut(stream, at))
    assert [frame.seq for frame in seen] == [seq for seq, _ in frames]
    for frame, (_, message) in zip(seen, frames, strict=True):
        assert same(frame.message, message)


WHOLE = [bytes.fromhex(text) for _, _, text in GOLDEN_REPLIES]
PIECES = [
    *WHOLE,
    *(frame[:8] for frame in WHOLE),
    b"\xb1",
    b"\xb1\x92",
    b"\xb1\x90\x00\x04\x00\x00\x00\x01",
    b"\xb1\x90\xff\xff\x00\x00\x00\x01",
    b"\xb1\x90\x00\x04\xff\xff\xff\xff\x00\x00\x00\x00",
    b"\x00" * 8,
    b"\x7f\xc0\x00\x00",
]
soup = st.lists(st.one_of(st.sampled_from(PIECES), st.binary(max_size=6))).map(b"".join)


@given(soup, st.lists(st.integers(0, 400)))
@example(b"\xb1\x90\x00\x04\x00\x00\x00\x01\x00\x00\x00\x05", [9])
@example(encode(1, m.SignalNames((), ()))[:-1] + b"\x09", [])
def test_rubbish_means_the_same_however_it_is_cut(stream, at):
    """Only frames or a protocol error come out, and the cuts do not matter."""
    assert outcomes(reply_decoder(), cut(stream, at)) == outcomes(reply_decoder(), [stream])


@given(st.tuples(seqs, REPLIES), st.integers(0, 7), st.integers(0, 255))
def test_a_spoilt_header_never_passes_for_a_longer_wait_than_its_limit(frame, at, value):
    data = bytearray(encode(*frame))
    data[at] = value
    decoder = reply_decoder()
    seen = outcomes(decoder, [bytes(data), bytes(2000)])
    assert seen
    if at == 0 and value != 0xB1:
        assert isinstance(seen[0], str)


@pytest.mark.parametrize(
    "layout", [*REQUEST_LAYOUTS, *REPLY_LAYOUTS], ids=lambda x: x.message.__name__
)
@pytest.mark.parametrize("change", [-1, 1])
def test_a_payload_of_another_length_is_refused(layout, change):
    decoder = request_decoder() if layout in REQUEST_LAYOUTS else reply_decoder()
    sizes = {"SignalNames": 2, "IdentityReply": 3}
    struct_ = getattr(layout, "_struct", None)
    size = sizes[layout.message.__name__] if struct_ is None else struct_.size
    if size + change < 0:
        return
    decoder.feed(struct.pack(">BBHi", 0xB1, layout.kind, size + change, 1) + bytes(size + change))
    with pytest.raises(RemoteProtocolError):
        decoder.next_frame()


@pytest.mark.parametrize("bad", [float("nan"), float("inf"), -float("inf")])
def test_numbers_that_are_none_are_never_sent_nor_believed(bad):
    with pytest.raises(LocalProtocolError):
        encode(1, m.SetLoad(bad, (0, 0, 0)))
    decoder = request_decoder()
    decoder.feed(struct.pack(">BBHi4f", 0xB1, 34, 16, 1, 1.0, 0.0, bad, 0.0))
    with pytest.raises(RemoteProtocolError, match="finite"):
        decoder.next_frame()


@pytest.mark.parametrize(
    "message",
    [
        m.SetLoad(1e39, (0, 0, 0)),
        m.Run(2**31, 1, 0),
        m.Run(1, 70000, 0),
        m.Write(-1, 0),
        m.Write(300, 0),
        m.AddJoint((0.0,) * 5, 1.0, 0.0),
        m.IdentityReply("x" * 300, "", ""),
        m.IdentityReply("\u20ac", "", ""),
        m.SignalNames(("x" * 200,) * 8, ()),
    ],
    ids=repr,
)
def test_what_does_not_fit_is_our_own_error(message):
    with pytest.raises(LocalProtocolError):
        encode(1, message)


def test_unknown_codes_are_nonsense():
    decoder = reply_decoder()
    decoder.feed(struct.pack(">BBHiHH", 0xB1, 146, 4, 1, 55, 0))
    with pytest.raises(RemoteProtocolError, match="55"):
        decoder.next_frame()


def test_an_error_keeps_what_was_received_and_is_final():
    decoder = reply_decoder()
    decoder.feed(b"HTTP/1.1 400 Bad Request\r\n")
    with pytest.raises(RemoteProtocolError) as caught:
        decoder.next_frame()
    assert caught.value.raw.startswith(b"HTTP/1.1")
    decoder.feed(encode(1, m.Accepted(1)))
    with pytest.raises(RemoteProtocolError):
        decoder.next_frame()


@pytest.mark.parametrize("seq", [-1, 8_000_001])
def test_numbers_beyond_what_a_num_counts_are_not_sent(seq):
    with pytest.raises(LocalProtocolError):
        encode(seq, m.Ping())
