"""The independent check that proves or refutes a grasp.

It reads the robot and the scene anew (URDF by yourdfpy, meshes by trimesh, SRDF as XML) and recomputes every
figure from the claim: joint angles, contact points and forces. It shares no code with the optimiser.
"""

from .certificate import Certificate, Figure
from .check import Verifier
from .claim import Claim
from .derived import Derived
from .pair_clearances import PairClearance

__all__ = ["Certificate", "Claim", "Derived", "Figure", "PairClearance", "Verifier"]
