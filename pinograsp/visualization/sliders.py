"""Sliders that move a robot in the HTML page: forward kinematics in the browser, q = B p + q_0 for posture p.

A joint's pose is that of its parent, times its placement, times its motion by q; what is drawn is fixed to joints.
"""

from __future__ import annotations

import json
import math
from html import escape
from string import Template
from typing import Any

import numpy as np
import pinocchio as pin

from ..arrays import Array
from ..kinematics.robot import Robot

Nodes = dict[str, tuple[int, Array]]
"""What moves: path in meshcat's tree to joint of the model and pose in its frame (may scale), shape (4, 4)."""

STEPS = 1000


def sliders(robot: Robot, posture: Array, nodes: Nodes) -> str:
    """Return HTML with a slider for every arm joint and synergy, and the script that moves the nodes.

    Args:
        robot: the robot.
        posture: (q_a, sigma) that the nodes are drawn at, rad (m), shape (l + s,).
        nodes: what moves.
    """
    names = robot.posture_names
    rows = [
        _row(i, name, robot.urdf.movable.get(name), float(low), float(high), float(value))
        for i, (name, low, high, value) in enumerate(zip(names, robot.lower, robot.upper, posture, strict=True))
    ]
    clipped = np.clip(np.zeros(len(names)), robot.lower, robot.upper)
    data = {
        "joints": _joints(robot),
        "B": robot.B.tolist(),
        "q0": robot.q_0.tolist(),
        "nodes": [[path, joint, _column_major(T)] for path, (joint, T) in nodes.items()],
        "postures": {"middle": (0.5 * (robot.lower + robot.upper)).tolist(), "zero": clipped.tolist()},
    }
    return _HTML.substitute(rows="".join(rows), data=json.dumps(data).replace("</", "<\\/"))


_UNITS = {
    "prismatic": (1e3, "mm", 1),
    "revolute": (math.degrees(1.0), "°", 0),
    "continuous": (math.degrees(1.0), "°", 0),
}
"""Scale, unit and decimals in which a value is shown, by type of joint."""


def _row(number: int, name: str, kind: str | None, low: float, high: float, value: float) -> str:
    scale, unit, digits = (1.0, "", 3) if kind is None else _UNITS[kind]  # a synergy of several joints has no unit
    ends = f"{scale * low:.{digits}f} .. {scale * high:.{digits}f} {unit}"
    return (
        f'<p class="slider"><label>{escape(name)}: <output id="value{number}"></output> {unit} <small>{ends}</small>'
        f'<input type="range" id="slider{number}" min="{low!r}" max="{high!r}" step="{(high - low) / STEPS!r}" '
        f'value="{value!r}" data-scale="{scale!r}" data-digits="{digits}" autocomplete="off" '
        'oninput="move()"></label></p>'
    )


def _joints(robot: Robot) -> list[dict[str, Any]]:
    """Return parent, placement and axis of every joint, in the model's order; the world, joint 0, is left out."""
    model, data = robot.model, robot.model.createData()
    pin.computeJointJacobians(model, data, np.zeros(model.nv))
    joints = []
    for joint in range(1, model.njoints):
        column = model.joints[joint].idx_v
        motion = pin.getJointJacobian(model, data, joint, pin.LOCAL).reshape(6, model.nv)[:, column]
        joints.append(
            {
                "parent": int(model.parents[joint]),
                "placement": _column_major(model.jointPlacements[joint].homogeneous),
                "slide": motion[:3].tolist(),
                "turn": motion[3:].tolist(),
                "row": int(column),
            }
        )
    return joints


def _column_major(T: Array) -> list[float]:
    return [float(value) for value in T.T.ravel()]


_HTML = Template("""<table><caption>Joints</caption></table>
<p><button onclick="set('middle')">Middle</button><button onclick="set('zero')">Zero</button></p>
$rows
<script>
const robot = $data;

function product(a, b) {  // of poses, column by column
  return b.map((_, i) => [0, 1, 2, 3].reduce((sum, k) => sum + a[i % 4 + 4 * k] * b[k + 4 * Math.floor(i / 4)], 0));
}

function motion(joint, q) {  // Rodrigues
  const [x, y, z] = joint.turn, s = Math.sin(q), c = 1 - Math.cos(q);
  return [
    1 - c * (y * y + z * z), c * x * y + s * z, c * x * z - s * y, 0,
    c * x * y - s * z, 1 - c * (x * x + z * z), c * y * z + s * x, 0,
    c * x * z + s * y, c * y * z - s * x, 1 - c * (x * x + y * y), 0,
    ...joint.slide.map(d => d * q), 1,
  ];
}

function move() {
  const posture = robot.postures.middle.map((_, i) => {
    const slider = document.getElementById("slider" + i), value = Number(slider.value);
    const shown = (value * slider.dataset.scale).toFixed(slider.dataset.digits);
    document.getElementById("value" + i).textContent = shown;
    return value;
  });
  const q = robot.B.map((row, i) => row.reduce((sum, b, k) => sum + b * posture[k], robot.q0[i]));
  const poses = [[1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]];
  for (const joint of robot.joints) {
    poses.push(product(poses[joint.parent], product(joint.placement, motion(joint, q[joint.row]))));
  }
  for (const [path, joint, local] of robot.nodes) {
    viewer.handle_command({type: "set_transform", path: path, matrix: product(poses[joint], local)});
  }
}

function set(name) {
  robot.postures[name].forEach((value, i) => { document.getElementById("slider" + i).value = value; });
  move();
}

addEventListener("load", move);
</script>""")
