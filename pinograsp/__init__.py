"""pinograsp: verified optimal grasps for a robot arm and hand inside a narrow enclosure.

import pinograsp

robot = pinograsp.load_robot("gen3_2f85")
scene = pinograsp.load_scene("scenes/glovebox.yaml")
result = pinograsp.plan(robot, scene, task="sphere")
best = result.best

The public names stand in `__init__.pyi`; each loads the module that defines it when it is used.
"""

import lazy_loader as _lazy

__getattr__, __dir__, __all__ = _lazy.attach_stub(__name__, __file__)
