"""What the direct devices share: being open, and a link that can be cut."""

import asyncio
from collections.abc import Callable

from hal import Identity
from hal.errors import LinkError
from sims.world import World

__all__ = ["DirectLink"]


class DirectLink:
    """The connection of one device to the world."""

    def __init__(self, world: World, device: str, identity: Identity) -> None:
        self.world = world
        self.device = device
        self.identity = identity
        self._cuts_at_open: int | None = None

    @property
    def is_open(self) -> bool:
        """Whether the device was opened and its link has held since."""
        links = self.world.cabinet.links
        return self._cuts_at_open == links.count(self.device) and links.is_up(self.device)

    def open(self) -> None:
        """Connect.

        Raises
        ------
        LinkError
            The link is cut.
        """
        links = self.world.cabinet.links
        if not links.is_up(self.device):
            raise LinkError("cannot be reached", device=self.device)
        self._cuts_at_open = links.count(self.device)

    def close(self) -> None:
        """Let go."""
        self._cuts_at_open = None

    def check(self) -> None:
        """Refuse commands without a link.

        Raises
        ------
        LinkError
            Not open, or the link was cut since.
        """
        if self._cuts_at_open is None:
            raise LinkError("is not open", device=self.device)
        if not self.is_open:
            raise LinkError("the link is gone; reopen the device", device=self.device)

    async def wait(self, condition: Callable[[], bool]) -> None:
        """Wait for the world, as long as the link holds.

        Raises
        ------
        LinkError
            The link was cut meanwhile.
        """
        await self.world.until(lambda: not self.is_open or condition())
        self.check()

    @property
    def stamp_s(self) -> float:
        """Loop time of a reading."""
        return asyncio.get_running_loop().time()
