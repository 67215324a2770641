"""The independent check that proves or refutes a grasp.

It reads the robot and the scene anew (URDF by yourdfpy, meshes by trimesh, SRDF as XML) and recomputes every
figure from the claim: joint angles, contact points and forces. It shares no code with the optimiser. `check` has the
`Verifier`; here are the data that it takes and gives, which need no library to be read.
"""

from .certificate import Certificate, Figure
from .claim import Claim

__all__ = ["Certificate", "Claim", "Figure"]
