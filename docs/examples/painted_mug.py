"""A mug with a painted handle, made here, that is to be held by nothing but the paint."""

from itertools import pairwise
from pathlib import Path

import numpy as np
from trimesh.creation import cylinder, icosphere

import pinograsp

WHITE, RED = (230, 230, 230), (200, 30, 30)


def write_mug(file: Path) -> None:
    """Write a mug, m, with a handle towards x, of which what is upright is red."""
    body = cylinder(0.041, segment=((0.0, 0.0, -0.0525), (0.0, 0.0, 0.0525)), sections=96)
    inside = cylinder(0.037, segment=((0.0, 0.0, -0.0465), (0.0, 0.0, 0.06)), sections=96)
    bends = [(0.04, 0.0, 0.034), (0.077, 0.0, 0.034), (0.077, 0.0, -0.034), (0.04, 0.0, -0.034)]
    rods = [cylinder(0.007, segment=ends, sections=64) for ends in pairwise(bends)]
    balls = [icosphere(radius=0.007).apply_translation(bend) for bend in bends[1:3]]
    mug = body.union([*rods, *balls]).difference(inside)
    mug.visual.face_colors = np.where(mug.triangles_center[:, :1] > 0.068, RED, WHITE)
    mug.export(file)


def main(starts: int = 100) -> None:
    """Plan grasps of the mug in the scene that has a simpler one."""
    write_mug(file := Path("mug.ply"))
    scene = pinograsp.load_scene("glovebox_mug")
    mug = scene.objects["mug"].model_copy(update={"shape": pinograsp.Mesh(file=file)})
    paint = pinograsp.Painted(color=RED)
    scene = scene.with_object("mug", mug).with_task("handle", desired_contacts=None, allowed_contacts=paint)
    result = pinograsp.plan(pinograsp.load_robot("gen3_2f85"), scene, "handle", starts=starts)
    print(f"{result.verified} of {result.done} starts verified, on the paint alone")
    if result:
        pinograsp.visualization.write_html(result, "mug.html")


if __name__ == "__main__":
    main()
