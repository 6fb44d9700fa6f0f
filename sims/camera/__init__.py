"""The simulated stereo rig: rays into the MuJoCo scene, a pattern projector, two sensors."""

from sims.camera.bodies import Bodies, Poses, Surface
from sims.camera.primitives import Mesh
from sims.camera.render import Exposure, StereoRenderer
from sims.camera.residual import calibration_for
from sims.camera.rig import HOUSING_SIZE_M, RigTruth, T_base_housing, nominal_calibration
from sims.camera.sensor import Sensor
from sims.camera.stand import CameraFaults, Stand, hang_rig, rig_over
from sims.camera.trial import TrialScene, trial_scene
from sims.camera.truth import TrueView, true_view, visible_shares

__all__ = [
    "HOUSING_SIZE_M",
    "Bodies",
    "CameraFaults",
    "Exposure",
    "Mesh",
    "Poses",
    "RigTruth",
    "Sensor",
    "Stand",
    "StereoRenderer",
    "Surface",
    "T_base_housing",
    "TrialScene",
    "TrueView",
    "calibration_for",
    "hang_rig",
    "nominal_calibration",
    "rig_over",
    "trial_scene",
    "true_view",
    "visible_shares",
]
