"""What everybody has: FPFH features, RANSAC and ICP, with Open3D, on the same depth views."""

import numpy as np
import open3d as o3d
from numpy.typing import NDArray

from hal import Transform
from perception.parts import Part
from perception.parts.sampling import sample_surface
from perception.pose import BinVolume
from perception.view import DepthView

__all__ = ["fpfh_ransac_icp"]

VOXEL_M = 0.0025
CLUSTER_M = 0.004
MIN_CLUSTER = 100
ITERATIONS = 20_000
TUKEY_M = (0.006, 0.003, 0.0015)
MOST_IN_CLUSTER = 6


def fpfh_ransac_icp(
    view: DepthView, part: Part, volume: BinVolume, *, seed: int = 0
) -> list[Transform]:
    """Return T_camera_object of what is found: clusters, features, RANSAC, ICP, take away, again.

    Voxels of 2.5 mm, normals within 2.2 and features within 5 voxels, point-to-plane ICP with
    Tukey's loss at 6, 3 and 1.5 mm. Seeded as far as Open3D can be.
    """
    o3d.utility.random.seed(seed)
    points = view.points().reshape(-1, 3)
    points = points[volume.contains(points)]
    if len(points) < MIN_CLUSTER:
        return []
    scene = _prepared(_cloud(points))
    vertices, _ = sample_surface(part.vertices_m, part.triangles, 20_000)
    model = _prepared(_cloud(vertices), inward=True)
    labels = np.asarray(scene.cluster_dbscan(CLUSTER_M, 6))
    features = _features(model)
    poses = []
    with o3d.utility.VerbosityContextManager(o3d.utility.VerbosityLevel.Error):
        for label in range(int(labels.max()) + 1):
            cluster = scene.select_by_index(np.flatnonzero(labels == label).tolist())
            poses += _in_cluster(cluster, model, features)
    return poses


def _in_cluster(
    cluster: o3d.geometry.PointCloud,
    model: o3d.geometry.PointCloud,
    features: o3d.pipelines.registration.Feature,
) -> list[Transform]:
    """Find one part after the other, taking away the points of each."""
    poses: list[Transform] = []
    while len(cluster.points) >= MIN_CLUSTER and len(poses) < MOST_IN_CLUSTER:
        result = _register(cluster, model, features)
        explained = np.asarray(result.correspondence_set)[:, 0]
        if len(explained) < MIN_CLUSTER:
            break
        pose = np.linalg.inv(np.asarray(result.transformation, np.float64))
        poses.append(Transform("camera", "object", _rigid(pose)))
        cluster = cluster.select_by_index(explained.tolist(), invert=True)
    return poses


def _register(
    cluster: o3d.geometry.PointCloud,
    model: o3d.geometry.PointCloud,
    features: o3d.pipelines.registration.Feature,
) -> o3d.pipelines.registration.RegistrationResult:
    reg = o3d.pipelines.registration
    result = reg.registration_ransac_based_on_feature_matching(
        cluster, model, _features(cluster), features, True, 2 * VOXEL_M,
        reg.TransformationEstimationPointToPoint(False), 3,
        [reg.CorrespondenceCheckerBasedOnDistance(2 * VOXEL_M)],
        reg.RANSACConvergenceCriteria(ITERATIONS, 0.999),
    )  # fmt: skip
    for tukey_m in TUKEY_M:
        estimate = reg.TransformationEstimationPointToPlane(reg.TukeyLoss(tukey_m))
        result = reg.registration_icp(cluster, model, tukey_m, result.transformation, estimate)
    return result


def _cloud(points: NDArray[np.floating]) -> o3d.geometry.PointCloud:
    return o3d.geometry.PointCloud(o3d.utility.Vector3dVector(points.astype(np.float64)))


def _prepared(cloud: o3d.geometry.PointCloud, *, inward: bool = False) -> o3d.geometry.PointCloud:
    """Thin out and give normals: towards the camera, or outwards for the model at the origin."""
    cloud = cloud.voxel_down_sample(VOXEL_M)
    cloud.estimate_normals(o3d.geometry.KDTreeSearchParamHybrid(2.2 * VOXEL_M, 30))
    cloud.orient_normals_towards_camera_location(np.zeros(3))
    if inward:
        cloud.normals = o3d.utility.Vector3dVector(-np.asarray(cloud.normals))
    return cloud


def _features(cloud: o3d.geometry.PointCloud) -> o3d.pipelines.registration.Feature:
    search = o3d.geometry.KDTreeSearchParamHybrid(5 * VOXEL_M, 100)
    return o3d.pipelines.registration.compute_fpfh_feature(cloud, search)


def _rigid(matrix: NDArray[np.floating]) -> NDArray[np.float64]:
    u, _, vt = np.linalg.svd(matrix[:3, :3])
    rigid = np.eye(4)
    rigid[:3, :3] = u @ vt
    rigid[:3, 3] = matrix[:3, 3]
    return rigid
