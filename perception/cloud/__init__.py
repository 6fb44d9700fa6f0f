"""Stages for unordered point clouds, each after its equations in the literature.

The pose path works on the organised depth image, where neighbours are known without a search
and the same stages cost milliseconds: its bilateral smoothing of inverse depth stands for the
outlier removal and moving least squares, its image gradients for the plane normals. The stages
here serve clouds that have no image (merged views, files), and as the reference to compare with.
"""

from perception.cloud.crop import crop_box
from perception.cloud.keypoints import find_keypoints, protrusion
from perception.cloud.normals import plane_normals
from perception.cloud.outliers import remove_outliers
from perception.cloud.smoothing import smooth_surface
from perception.cloud.voxel import thin_out

__all__ = [
    "crop_box",
    "find_keypoints",
    "plane_normals",
    "protrusion",
    "remove_outliers",
    "smooth_surface",
    "thin_out",
]
