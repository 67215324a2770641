"""Does it hold? Grasps simulated in MuJoCo, with the hand of the URDF and a free, rigid object.

`hand` is what the last arm joint carries and how it is driven, `pieces` the solids of its links, `pads` and `objects`
the solids that meet, `mjcf` the model of a grasp, `simulation` what happens to it, `run` the test of many grasps,
`film` pictures. MuJoCo is imported when it is needed: `pip install 'pinograsp[hold]'`.

What the model leaves out: bodies are rigid, friction is Coulomb's; the arm holds still but for the accelerations that
it is given; the hand's links have no weight and no inertial forces; its joints have no play, no friction, no limits.
Nothing but the hand touches the object, and the hand does not touch itself.
"""
