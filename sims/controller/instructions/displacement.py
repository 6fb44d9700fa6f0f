"""Program displacement: PDispOn and its kin, ORobT; offsets of external axes; MirPos."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sims.controller.frames import frame_of, pose_of, wobj_frame
from sims.controller.instructions.common import Setup, mechanics_of, not_supported, value_of
from sims.rapid.builtin import Legal, Ref, TaskContext, builtin
from sims.rapid.library.poses import def_frame

__all__: list[str] = []

Array = NDArray[np.float64]

LEAST_UNUSED = 8.99e9  # 9E9 is no binary32


def _set(task: TaskContext, T_object_shown: Array) -> None:
    """Make a displacement the active one; C_PROGDISP tells the program."""
    mechanics_of(task).settings.T_object_shown = T_object_shown
    shown = task.find("C_PROGDISP")
    if shown is not None:
        shown.set([pose_of(T_object_shown), [0.0] * 6])


@builtin(
    "PROC PDispOn(\\switch Rot \\robtarget ExeP, robtarget ProgPoint, PERS tooldata Tool "
    "\\PERS wobjdata WObj)",
    Legal.MOTION,
)
async def p_disp_on(
    task: TaskContext,
    *,
    rot: bool = False,
    exep: list[Any] | None = None,
    progpoint: list[Any],
    tool: Ref,
    wobj: Ref | None = None,
) -> None:
    r"""Displace so that the programmed point is where the tool is (``\ExeP``: a given point).

    Only the place counts, unless ``\Rot`` asks for the orientation too. Without ``\ExeP`` the
    arm is let come to its fine point first.
    """
    mechanics = mechanics_of(task)
    unit = mechanics.unit
    programmed = frame_of(progpoint)
    setup = Setup.of(tool.get(), value_of(wobj))
    if exep is None:
        await unit.standing()
        there = setup.tcp_in_object(unit.kinematics.forward(unit.measured_rad))
    else:
        there = frame_of(exep)
    if rot:
        _set(task, np.asarray(there @ np.linalg.inv(programmed)))
        return
    shift = np.eye(4)
    shift[:3, 3] = there[:3, 3] - programmed[:3, 3]
    _set(task, shift)


@builtin("PROC PDispSet(pose DispFrame)", Legal.MOTION)
def p_disp_set(task: TaskContext, *, dispframe: list[Any]) -> None:
    """Displace by a frame in the work object."""
    _set(task, frame_of(dispframe))


@builtin("PROC PDispOff()", Legal.MOTION)
def p_disp_off(task: TaskContext) -> None:
    """Displace no more."""
    _set(task, np.eye(4))


@builtin("FUNC robtarget ORobT(robtarget OrgPoint \\switch InPDisp | \\switch InEOffs)")
def o_rob_t(
    task: TaskContext, *, orgpoint: list[Any], inpdisp: bool = False, ineoffs: bool = False
) -> list[Any]:
    r"""Where a displaced target is in the work object; ``\InPDisp`` leaves it as it is."""
    del ineoffs
    if inpdisp:
        return orgpoint
    T_object_shown = mechanics_of(task).settings.T_object_shown
    return [*pose_of(np.asarray(T_object_shown @ frame_of(orgpoint))), *orgpoint[2:]]


@builtin(
    "FUNC pose DefDFrame(robtarget OldP1, robtarget OldP2, robtarget OldP3, robtarget NewP1, "
    "robtarget NewP2, robtarget NewP3)"
)
def def_d_frame(
    task: TaskContext,
    *,
    oldp1: list[Any],
    oldp2: list[Any],
    oldp3: list[Any],
    newp1: list[Any],
    newp2: list[Any],
    newp3: list[Any],
) -> list[Any]:
    """The displacement that takes three places to three others; the first pair meets exactly.

    ERR_FRAME: three of them are on one line.
    """
    old, new = _corner(task, oldp1, oldp2, oldp3), _corner(task, newp1, newp2, newp3)
    return pose_of(np.asarray(new @ np.linalg.inv(old)))


def _corner(task: TaskContext, first: list[Any], second: list[Any], third: list[Any]) -> Array:
    """The frame at the first place, x towards the second, the third in the plane of x and y."""
    return frame_of(def_frame(task, newp1=first, newp2=second, newp3=third))


@builtin("PROC EOffsOn(\\robtarget ExeP, robtarget ProgPoint)", Legal.MOTION)
def e_offs_on(task: TaskContext, *, exep: list[Any] | None = None, progpoint: list[Any]) -> None:
    """Offset external axes by a difference; there are none, so it has to be none."""
    del task
    if exep is not None:
        pairs = zip(exep[3], progpoint[3], strict=True)
        _check_offsets([a - b for a, b in pairs if max(a, b) < LEAST_UNUSED])


@builtin("PROC EOffsSet(extjoint EAxOffs)", Legal.MOTION)
def e_offs_set(task: TaskContext, *, eaxoffs: list[float]) -> None:
    """Offset external axes; there are none, so only zero and 9E9 are possible."""
    del task
    _check_offsets(eaxoffs)


@builtin("PROC EOffsOff()", Legal.MOTION)
def e_offs_off(task: TaskContext) -> None:
    """Nothing is offset."""
    del task


def _check_offsets(offsets: Sequence[float]) -> None:
    if any(offset != 0.0 and offset < LEAST_UNUSED for offset in offsets):
        raise not_supported("an offset of an external axis, of which there is none,")


@builtin("FUNC robtarget MirPos(robtarget Point, wobjdata MirPlane \\wobjdata WObj \\switch MirY)")
def mir_pos(
    task: TaskContext,
    *,
    point: list[Any],
    mirplane: list[Any],
    wobj: list[Any] | None = None,
    miry: bool = False,
) -> list[Any]:
    r"""A target mirrored in the xy plane of a frame.

    Its x and z axes are mirrored (``\MirY``: y and z), the third follows. The configuration stays
    as it was.
    """
    del task
    T_plane_object = np.linalg.inv(wobj_frame(mirplane)) @ wobj_frame(wobj)
    place = T_plane_object @ frame_of(point)
    mirrored = place.copy()
    mirrored[2] = -place[2]
    turned = 0 if miry else 1
    mirrored[:3, turned] = -mirrored[:3, turned]
    return [*pose_of(np.asarray(np.linalg.inv(T_plane_object) @ mirrored)), *point[2:]]
