"""The promises of ``hal.Projector``."""

import pytest

from hal.camera import Projector
from hal.conformance.base import Conformance
from hal.conformance.stage import Stage
from hal.errors import LinkError

__all__ = ["ProjectorConformance"]


class ProjectorConformance(Conformance):
    """Nobody may look into the light while these run."""

    interface = "projector"

    @pytest.fixture
    def projector(self, device: Projector) -> Projector:
        return device

    async def test_it_has_at_least_one_pattern(self, projector: Projector) -> None:
        assert projector.pattern_count >= 1

    async def test_the_light_obeys_and_saying_it_twice_is_harmless(
        self, projector: Projector, stage: Stage
    ) -> None:
        for is_on in (True, True, False, False, True):
            await projector.set_light(is_on)
            assert await stage.is_lit() is is_on

    async def test_a_sequence_of_its_patterns_is_taken(self, projector: Projector) -> None:
        await projector.load_sequence(range(projector.pattern_count))
        await projector.load_sequence([0])

    async def test_a_sequence_it_cannot_show_is_a_value_error_at_once(
        self, projector: Projector
    ) -> None:
        with pytest.raises(ValueError, match=r"."):
            projector.load_sequence([])
        with pytest.raises(ValueError, match=str(projector.pattern_count)):
            projector.load_sequence([projector.pattern_count])
        with pytest.raises(ValueError, match="-1"):
            projector.load_sequence([-1])

    async def test_closed_it_takes_no_command(self, projector: Projector) -> None:
        await projector.close()
        with pytest.raises(LinkError):
            await projector.set_light(True)
        with pytest.raises(LinkError):
            await projector.load_sequence([0])
