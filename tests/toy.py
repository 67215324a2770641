"""A toy robot on one page: a turning arm and two sliding fingers, the right one mimicking the left one."""

from __future__ import annotations

from pathlib import Path

URDF = """<robot name="toy">
  <link name="base"/>
  <link name="palm">
    <collision><geometry><mesh filename="package://toy_meshes/palm.stl"/></geometry></collision>
  </link>
  <link name="left_finger">
    <collision><geometry><box size="0.01 0.02 0.04"/></geometry></collision>
  </link>
  <link name="right_finger">
    <collision><geometry><box size="0.01 0.02 0.04"/></geometry></collision>
  </link>
  <joint name="turn" type="revolute">
    <parent link="base"/><child link="palm"/><origin xyz="0 0 0.1"/><axis xyz="0 0 1"/>
    <limit lower="-1" upper="1" effort="1" velocity="1"/>
  </joint>
  <joint name="left_slide" type="prismatic">
    <parent link="palm"/><child link="left_finger"/><origin xyz="-0.01 0 0.1"/><axis xyz="-1 0 0"/>
    <limit lower="0" upper="0.05" effort="1" velocity="1"/>
  </joint>
  <joint name="right_slide" type="prismatic">
    <parent link="palm"/><child link="right_finger"/><origin xyz="0.01 0 0.1"/><axis xyz="1 0 0"/>
    <limit lower="0" upper="0.05" effort="1" velocity="1"/>
    <mimic joint="left_slide"/>
  </joint>
</robot>
"""

ROBOT = """format: 1
name: toy
urdf: toy.urdf
packages: [meshes]
arm:
  joints: [turn]
  wrist: palm
hand:
  synergies:
    - joint: left_slide
pads:
  - name: left
    link: left_finger
    patch: {type: plane, origin: [0.005, 0, 0], normal: [1, 0, 0], x_axis: [0, 0, 1], u: [-0.02, 0.02], v: [-0.01, 0.01]}
    contact: {model: hard_finger}
  - name: right
    link: right_finger
    patch: {type: plane, origin: [-0.005, 0, 0], normal: [-1, 0, 0], x_axis: [0, 0, 1], u: [-0.02, 0.02], v: [-0.01, 0.01]}
    contact: {model: hard_finger}
stiffness: {joint: 100, contact: 10000}
"""

TETRAHEDRON = """solid palm
facet normal 0 0 -1
outer loop
vertex 0 0 0
vertex 0 0.02 0
vertex 0.02 0 0
endloop
endfacet
facet normal 0 -1 0
outer loop
vertex 0 0 0
vertex 0.02 0 0
vertex 0 0 0.02
endloop
endfacet
facet normal -1 0 0
outer loop
vertex 0 0 0
vertex 0 0 0.02
vertex 0 0.02 0
endloop
endfacet
facet normal 1 1 1
outer loop
vertex 0.02 0 0
vertex 0 0.02 0
vertex 0 0 0.02
endloop
endfacet
endsolid palm
"""


def write_toy(folder: Path, urdf: str = URDF, robot: str = ROBOT) -> Path:
    """Write the toy's files into a folder and return its robot file."""
    mesh = folder / "meshes" / "toy_meshes" / "palm.stl"
    mesh.parent.mkdir(parents=True, exist_ok=True)
    mesh.write_text(TETRAHEDRON)
    (folder / "toy.urdf").write_text(urdf)
    file = folder / "robot.yaml"
    file.write_text(robot)
    return file
