"""Does it hold? Grasps simulated in MuJoCo, with the hand of the URDF and a free, rigid object.

`hand` is what the last arm joint carries and how it is driven, `pieces` the solids of its links, `pads` and `objects`
the solids that meet, `mjcf` the model of a grasp, `simulation` what happens to it, `run` the test of many grasps,
`film` pictures. MuJoCo is imported when it is needed: `pip install 'pinograsp[hold]'`.

What the model leaves out: bodies are rigid, friction is Coulomb's; the arm holds still but for the accelerations that
it is given; the hand's links have no weight and no inertial forces; its joints have no play, no friction, no limits.
Nothing but the hand touches the object, and the hand does not touch itself.
"""

from .film import write_film
from .mjcf import HandAndObject, HoldModel
from .options import HoldOptions
from .outcome import FirstSlip, HoldOutcome, PadForce
from .run import HoldProgress, hold_test, in_order
from .simulation import Phase, Simulation
from .write import write_mjcf

__all__ = [
    "FirstSlip",
    "HandAndObject",
    "HoldModel",
    "HoldOptions",
    "HoldOutcome",
    "HoldProgress",
    "PadForce",
    "Phase",
    "Simulation",
    "hold_test",
    "in_order",
    "write_film",
    "write_mjcf",
]
