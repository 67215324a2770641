"""pinograsp: verified optimal grasps for a robot arm and hand inside a narrow enclosure.

import pinograsp

robot = pinograsp.load_robot("gen3_2f85")
scene = pinograsp.load_scene("scenes/glovebox.yaml")
result = pinograsp.plan(robot, scene, task="sphere")
best = result.best

The public names stand in `__init__.pyi`; each loads the module that defines it when it is used. What finds them is
loaded then, too: before that the command line must have seen to its signals.
"""


def __getattr__(name):
    _attach()
    return globals()[name] if name == "__all__" else globals()["__getattr__"](name)


def __dir__():
    _attach()
    return globals()["__dir__"]()


def _attach():
    """Put what lazy_loader makes in the place of the functions above."""
    import lazy_loader

    names = ("__getattr__", "__dir__", "__all__")
    globals().update(zip(names, lazy_loader.attach_stub(__name__, __file__), strict=True))
