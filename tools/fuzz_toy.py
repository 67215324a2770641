"""Random small robots: one arm joint or more, and a parallel jaw, of boxes."""

from __future__ import annotations

import random
from typing import Any

_COLLISION = '<collision><origin xyz="0 0 {0}"/><geometry>{1}</geometry></collision>'
_BOX = '<box size="{0} 0.02 {1}"/>'
_JOINT = """<joint name="{0}" type="{1}"><parent link="{2}"/><child link="{3}"/><origin xyz="0 0 {4}"/><axis xyz="{5}"/>
<limit lower="{6}" upper="{7}" effort="1" velocity="1"/>{8}</joint>"""
_MIMIC = '<mimic joint="slide_left" multiplier="{0}" offset="0.002"/>'


def _link(name: str, height: float, geometry: str) -> str:
    return f'<link name="{name}">{_COLLISION.format(height, geometry)}</link>'


def random_robot(rng: random.Random, wrist_geometry: str = "") -> tuple[str, dict[str, Any]]:
    """Return a URDF and the content of a robot file beside it, `toy.urdf`; of boxes, the wrist of what is given."""
    arm = [f"joint_{i}" for i in range(rng.randrange(1, 4))]
    links = ["base", *(f"arm_{i}" for i in range(len(arm)))]
    wrist = links[-1]
    box = _BOX.format(0.04, 0.06)
    text = [_link(name, 0.05, (name == wrist and wrist_geometry) or box) for name in links]
    for name, parent, child in zip(arm, links, links[1:], strict=False):
        axis = rng.choice(("0 1 0", "1 0 0", "0 0 1"))
        text.append(_JOINT.format(name, "revolute", parent, child, 0.15, axis, -1.5, 1.5, ""))
    for side, x in (("left", 1), ("right", -1)):
        text.append(_link(side, 0.02, _BOX.format(0.01, 0.04)))
        mimic = _MIMIC.format(round(rng.uniform(0.8, 1.2), 2)) if side == "right" else ""
        text.append(_JOINT.format(f"slide_{side}", "prismatic", wrist, side, 0.2, f"{x} 0 0", 0.0, 0.08, mimic))
    patch = {
        "type": "plane",
        "origin": [0.0, 0.0, 0.02],
        "x_axis": [0.0, 0.0, 1.0],
        "u": [-0.018, 0.018],
        "v": [-0.008, 0.008],
    }
    robot = {
        "format": 1,
        "name": "toy",
        "urdf": "toy.urdf",
        "arm": {"joints": arm, "wrist": wrist},
        "hand": {"synergies": [{"joint": "slide_left"}]},
        "pads": [
            {
                "name": side,
                "link": side,
                "patch": {**patch, "normal": [normal, 0.0, 0.0]},
                "contact": {"model": "hard_finger"},
            }
            for side, normal in (("left", -1.0), ("right", 1.0))
        ],
        "stiffness": {"joint": 100.0, "contact": 10000.0},
    }
    return f'<?xml version="1.0"?><robot name="toy">{"".join(text)}</robot>', robot
