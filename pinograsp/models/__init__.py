"""Kinematics and geometry: the robot mounted in a scene, exact signed distances, object surfaces.

`urdf` prepares the robot's URDF, `robot` turns it into a Pinocchio model with arm, hand and pads,
`kinematics` computes poses, contact points and their derivatives, `covers` convex pieces that contain a mesh,
`collision` the signed distances with gradients, and `shapes` holds one file a shape.
"""

from .batch import BatchKinematics, GroupFrames
from .batch_clearance import BatchClearance
from .collision import CollisionModel, Distances
from .hand_posture import hand_free, hand_opening, preshape, widest_jaw
from .kinematics import Configuration, ContactKinematics, contact_kinematics, forward, jacobian_derivatives
from .reach import arm_reach
from .regions import membership
from .robot import RobotModel
from .shapes import Surface, surface_of
from .wrist import approach_direction

__all__ = [
    "BatchClearance",
    "BatchKinematics",
    "CollisionModel",
    "Configuration",
    "ContactKinematics",
    "Distances",
    "GroupFrames",
    "RobotModel",
    "Surface",
    "approach_direction",
    "arm_reach",
    "contact_kinematics",
    "forward",
    "hand_free",
    "hand_opening",
    "jacobian_derivatives",
    "membership",
    "preshape",
    "surface_of",
    "widest_jaw",
]
