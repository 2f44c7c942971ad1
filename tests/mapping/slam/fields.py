"""Fields to match scans with."""

from mapping.geometry import Pose
from mapping.slam.hit_field import HitField
from mapping.slam.scan_cloud import ScanCloud


def field_of(clouds: list[ScanCloud], poses: list[Pose], cell: float) -> HitField:
    """The field of scans around the origin."""
    field = HitField(cell, 4.4, 1.0)
    field.clear([0.0, 0.0])
    for cloud, pose in zip(clouds, poses, strict=True):
        field.add(pose, cloud.surface)
    return field
