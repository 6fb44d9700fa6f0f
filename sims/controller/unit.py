"""The mechanical unit: moves queued by the program, driven by the servo, watched each tick.

The program pointer runs ahead: a move is planned when it is queued, joined to the move before
by a corner where that one has a zone, and driven while the program goes on. Nothing here knows
RAPID's values; lengths are metres, angles radians.
"""

import asyncio
from collections import deque
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from drivers.arms import ArmModel, Kinematics
from sims.controller.queue import Happening, Move, Stored
from sims.motion import Leg, Pace, Way, WayPlayer, joint_leg
from sims.world import World

__all__ = ["MechanicalUnit"]

Array = NDArray[np.float64]

AHEAD_MOVES = 3
AHEAD_S = 0.4
MOST_AHEAD_MOVES = 40
AWAY_RAD = 1e-5
REGAIN_SHARE = 0.1
ARRIVED = 1e-9


class MechanicalUnit:
    """One arm. ``tick`` is to be called after every tick of the world.

    The arm moves while there are moves and nothing ``holds`` it. ``failed_corner`` is told when
    a zone could not be used because the next move came too late.
    """

    def __init__(
        self,
        world: World,
        arm: ArmModel,
        *,
        name: str = "ROB_1",
        failed_corner: Callable[[], None] = lambda: None,
    ) -> None:
        self.name = name
        self.arm = arm
        self.kinematics = Kinematics(arm)
        self.holds: set[str] = set()
        self.moves: deque[Move] = deque()
        self.stored: list[Stored] = []
        self.ratio = 1.0
        self.most_mps = np.inf
        self._failed_corner = failed_corner
        self._world = world
        self._tick_s = world.physics.tick_s
        self._brakes = np.array(arm.accelerations_radps2)
        self._way = Way()
        self._place = 0.0
        self._player: WayPlayer | None = None
        self._regain: WayPlayer | None = None
        self._is_changed = False
        self._failure: Exception | None = None
        self._happenings: list[Happening] = []
        self._passed: list[asyncio.Future[None]] = []
        self._standing: list[asyncio.Future[None]] = []
        self.ramp_share = 1.0
        self._rests = False

    # What it is doing.

    @property
    def is_driving(self) -> bool:
        """Whether set-points are being given."""
        is_ours = self._player is not None or self._regain is not None
        return is_ours or self._world.arm.is_following

    @property
    def is_standing(self) -> bool:
        """Whether the arm has come to rest."""
        return not self.is_driving and self._world.arm.is_standing

    @property
    def is_about_to_drive(self) -> bool:
        """Whether moves are queued that the next tick begins."""
        return self._is_changed and bool(self.moves) and not self.holds and self.ratio > 0

    @property
    def has_come_to_rest(self) -> bool:
        """The same, remembered until the arm is driven again: cheap enough for every tick."""
        if self.is_driving:
            self._rests = False
        elif not self._rests:
            self._rests = self._world.arm.is_standing
        return self._rests

    @property
    def is_dropping(self) -> bool:
        """Whether the arm still brakes on a path that was dropped."""
        return self.is_driving and not self.moves

    @property
    def measured_rad(self) -> Array:
        """What the resolvers say."""
        return self._world.arm.measured_rad

    @property
    def planned_end_rad(self) -> Array:
        """Where the queued moves lead; without any, the set-point."""
        if self.moves:
            return self.moves[-1].leg.end_rad
        if self._player is not None:
            return self._way.pieces[-1].leg.end_rad
        return np.array(self._world.arm.target_rad)

    @property
    def speed(self) -> float:
        """Along the way, in joint space (rad/s)."""
        return self._player.speed if self._player is not None else 0.0

    # Moves.

    def add(self, move: Move, tool: Array) -> Move:
        """Queue a planned move that begins at ``planned_end_rad``."""
        leg = move.leg
        if not self.moves and not self.is_driving:
            self._way, self._place = Way(), 0.0
        before = self.moves[-1] if self.moves else None
        reached = self._player.lead if self._player is not None else self._place
        entry = before.zone if before is not None else None
        self._way, begin = self._way.joined(
            self.kinematics, tool, leg, move.pace, zone=entry, not_before=reached
        )
        if before is not None:
            before.until = begin
            for happening in before.happenings:
                if happening.is_at_corner:
                    happening.place = begin
            if entry is not None and self._way.stands and self._way.stands[-1] == begin:
                self._note_corner(before, leg)
        move.until = self._way.end
        move.ended = asyncio.get_running_loop().create_future()
        for happening in move.happenings:
            happening.place = self._place_of(happening, leg)
        self._happenings = sorted([*self._happenings, *move.happenings], key=lambda h: h.place)
        self.moves.append(move)
        self._is_changed = True
        return move

    def _note_corner(self, before: Move, leg: Leg) -> None:
        if before.leg.length > 0 and leg.length > 0:
            self._failed_corner()

    def _place_of(self, happening: Happening, leg: Leg) -> float:
        begin = self._way.end - leg.length
        if happening.is_from_start:
            return begin + leg.length_after_start(happening.distance_m)
        return begin + leg.length_before_end(happening.distance_m)

    async def ended(self, move: Move) -> None:
        """Wait until the arm stands at a move's end, or the move was dropped.

        Raises the error of ``fail``.
        """
        if move.ended is not None:
            move.is_awaited = True
            await asyncio.shield(move.ended)

    async def room(self) -> None:
        """Wait until the program may run on: few moves ahead, or little time.

        Raises the error of a ``fail`` that no other wait was told of.
        """
        while self._is_far_ahead():
            future: asyncio.Future[None] = asyncio.get_running_loop().create_future()
            self._passed.append(future)
            await future
        self.check()

    def check(self) -> None:
        """Raise the error of a ``fail`` that no wait was told of; once."""
        failure, self._failure = self._failure, None
        if failure is not None:
            raise failure

    def _is_far_ahead(self) -> bool:
        count = len(self.moves)
        if count <= AHEAD_MOVES or count > MOST_AHEAD_MOVES:
            return count > AHEAD_MOVES
        player = self._player
        return self._is_changed or player is None or player.remaining_s > AHEAD_S

    async def standing(self) -> None:
        """Wait until the arm rests; one that is about to go goes first."""
        if not self.is_standing or self.is_about_to_drive:
            future: asyncio.Future[None] = asyncio.get_running_loop().create_future()
            self._standing.append(future)
            await future

    def drop(self) -> None:
        """Forget the path; an arm that moves brakes on it first. Waiting moves count as ended."""
        for player in (self._player, self._regain):
            if player is not None:
                player.brake()
        moves, self.moves = self.moves, deque()
        self._happenings = []
        for move in moves:
            _settle(move.ended)
        self._wake(self._passed)

    def fail(self, error: Exception) -> None:
        """Brake, forget the path, and let whoever waits for a move get ``error``.

        Without such a wait the next ``room`` or ``check`` raises it.
        """
        awaited = [m.ended for m in self.moves if m.is_awaited and m.ended is not None]
        for future in awaited:
            if not future.done():
                future.set_exception(error)
                future.exception()  # the wait may have been given up
        if not awaited:
            self._failure = error
        self.drop()

    def store(self) -> None:
        """Put the path aside; the arm must stand."""
        self.stored.append(Stored(self._way, self._place, tuple(self.moves)))
        self._way, self._place = Way(), 0.0
        self.moves, self._happenings = deque(), []

    def unstore(self) -> None:
        """Take the path up again."""
        stored = self.stored.pop()
        self._way, self._place, self.moves = stored.way, stored.place, deque(stored.moves)
        self._happenings = sorted(
            (h for move in self.moves for h in move.happenings if h.place >= self._place),
            key=lambda h: h.place,
        )
        self._is_changed = True

    # Stopping and going on.

    def hold(self, reason: str) -> None:
        """Brake on the path and keep it."""
        self.holds.add(reason)
        for player in (self._player, self._regain):
            if player is not None:
                player.brake()

    def release(self, reason: str) -> None:
        """Take a reason away; without any left the arm goes on."""
        self.holds.discard(reason)
        self._is_changed = True

    # Each tick.

    def tick(self) -> None:
        """Look at what has become of the arm."""
        if self._regain is not None and self._regain.is_done:
            self._regain = None
            self._is_changed = True
        if self._player is not None:
            self._watch(self._player)
        if self._is_changed and not self.holds and self.ratio > 0:
            self._go_on()
        if (self._standing or self.moves) and not self.is_driving and self._world.arm.is_standing:
            self._rest()

    def _watch(self, player: WayPlayer) -> None:
        self._place = player.place
        if self._happenings:
            self._let_happen(player.speed)
        while self.moves and self.moves[0].zone is not None and self._is_passed(self.moves[0]):
            if len(self.moves) == 1:
                self._failed_corner()
            self._end(self.moves.popleft())
        if player.is_done:
            self._player = None
            self._is_changed = True
            if not self.moves:
                self._way, self._place = Way(), 0.0

    def _is_passed(self, move: Move) -> bool:
        return self._place >= move.until - ARRIVED

    def _let_happen(self, speed: float) -> None:
        while self._happenings:
            first = self._happenings[0]
            if self._place + speed * first.lead_s < first.place - ARRIVED:
                return
            self._happenings.pop(0)
            first.action()

    def _go_on(self) -> None:
        self._is_changed = False
        if not self.moves or self._regain is not None:
            return
        if self._player is not None:
            self._way = self._way.without_passed(self._place)
            self._player.plan(self._way, ratio=self.ratio, most_mps=self.most_mps)
            self._wake(self._passed)
            return
        if self._way.end - self._place <= ARRIVED:
            return
        if self._world.arm.is_following:  # somebody else's path is still braking
            self._is_changed = True
            return
        start = self._way.joints_rad(np.array([self._place]))[0]
        if np.abs(start - self._world.arm.target_rad).max() > AWAY_RAD:
            self._regain = self._way_back(start)
            self._world.arm.follow(self._regain)
            return
        self._player = self._player_on(self._way, self._place)
        self._player.plan(self._way, ratio=self.ratio, most_mps=self.most_mps)
        self._world.arm.follow(self._player)

    def _player_on(self, way: Way, place: float) -> WayPlayer:
        window = max(1, round(self.arm.jerk_time_s / self.ramp_share / self._tick_s))
        return WayPlayer(way, place, tick_s=self._tick_s, window=window, joint_radps2=self._brakes)

    def _way_back(self, start: Array) -> WayPlayer:
        """Slowly, in joint space, to where the path was left."""
        tool = np.eye(4)
        leg = joint_leg(self.kinematics, self._world.arm.target_rad, start, tool)
        speeds = np.array(self.arm.limits.speed_radps) * REGAIN_SHARE
        pace = Pace(np.inf, np.inf, speeds, self._brakes, np.inf, np.inf, np.inf)
        way, _ = Way().joined(self.kinematics, tool, leg, pace)
        player = self._player_on(way, 0.0)
        player.plan(way, most_mps=self.most_mps)
        return player

    def _rest(self) -> None:
        self._let_happen(0.0)
        while self.moves and self._is_passed(self.moves[0]):
            self._end(self.moves.popleft())
        if not self.moves:
            # What was to happen later than the end happens now.
            late, self._happenings = self._happenings, []
            for happening in late:
                happening.action()
        self._wake(self._standing)

    def _end(self, move: Move) -> None:
        _settle(move.ended)
        self._wake(self._passed)

    def _wake(self, futures: "list[asyncio.Future[None]]") -> None:
        for future in futures:
            _settle(future)
        futures.clear()


def _settle(future: "asyncio.Future[None] | None") -> None:
    if future is not None and not future.done():
        future.set_result(None)
