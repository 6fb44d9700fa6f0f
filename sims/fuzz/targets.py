"""What can be fuzzed, by name."""

from collections.abc import Callable

from sims.fuzz.abb_codec import AbbCodec
from sims.fuzz.abb_server import AbbServer
from sims.fuzz.engine import Target
from sims.fuzz.rapid_text import RapidText

__all__ = ["TARGETS"]

TARGETS: dict[str, Callable[[], Target]] = {
    "abb-codec": AbbCodec,
    "abb-server": AbbServer,
    "rapid-text": RapidText,
}
