"""URDFs of an arm of six joints with hands of several kinds, made in the tests; lengths in m, angles in rad."""

from __future__ import annotations

_LINKS = {
    "base": ("0 0 0.05", '<cylinder radius="0.06" length="0.1"/>'),
    "l1": ("0 0 0.05", '<cylinder radius="0.055" length="0.1"/>'),
    "l2": ("0 0 0.17", '<cylinder radius="0.045" length="0.26"/>'),
    "l3": ("0 0 0.14", '<cylinder radius="0.04" length="0.18"/>'),
    "l4": ("0 0 0.03", '<cylinder radius="0.035" length="0.06"/>'),
    "l5": ("0 0 0.055", '<cylinder radius="0.032" length="0.05"/>'),
    "l6": ("0 0 0.01", '<cylinder radius="0.03" length="0.02"/>'),
}
_JOINTS = (
    ("a1", "base", "l1", 0.105, "0 0 1", 2.8),
    ("a2", "l1", "l2", 0.12, "0 1 0", 2.0),
    ("a3", "l2", "l3", 0.34, "0 1 0", 2.5),
    ("a4", "l3", "l4", 0.25, "0 0 1", 2.8),
    ("a5", "l4", "l5", 0.09, "0 1 0", 2.1),
    ("a6", "l5", "l6", 0.09, "0 0 1", 3.1),
)


def solid(xyz: str, shape: str, tag: str = "collision") -> str:
    """Return the geometry of a link."""
    return f'<{tag}><origin xyz="{xyz}"/><geometry>{shape}</geometry></{tag}>'


def link(name: str, *solids: str) -> str:
    return f'<link name="{name}">{"".join(solids)}</link>'


def box(xyz: str, size: str) -> str:
    return solid(xyz, f'<box size="{size}"/>')


def joint(
    name: str, kind: str, parent: str, child: str, xyz: str, axis: str = "", more: str = "", rpy: str = ""
) -> str:
    """Return a joint; `more` holds limits and the like."""
    turned = f' rpy="{rpy}"' if rpy else ""
    along = f'<axis xyz="{axis}"/>' if axis else ""
    ends = f'<parent link="{parent}"/><child link="{child}"/>'
    return f'<joint name="{name}" type="{kind}">{ends}<origin xyz="{xyz}"{turned}/>{along}{more}</joint>'


def limit(lower: float, upper: float) -> str:
    return f'<limit lower="{lower}" upper="{upper}" effort="20" velocity="1"/>'


MIMIC = '<mimic joint="slide_l"/>'
PALM = link("palm", box("0 0 0.015", "0.05 0.12 0.03"))
MOUNT = joint("mount", "fixed", "l6", "palm", "0 0 0.02")


def parallel_jaw(*, mimic: str = MIMIC, left: str = "", right: str = "0 -1 0", ends: str = limit(0, 0.04)) -> str:
    """Return a palm with two fingers that slide; `left` stands in the left joint, `ends` are the right one's limits."""
    return (
        PALM
        + MOUNT
        + link("finger_l", box("0 0.005 0.03", "0.02 0.01 0.06"))
        + link("finger_r", box("0 -0.005 0.03", "0.02 0.01 0.06"))
        + joint("slide_l", "prismatic", "palm", "finger_l", "0 0 0.03", "0 1 0", limit(0, 0.04) + left)
        + joint("slide_r", "prismatic", "palm", "finger_r", "0 0 0.03", right, ends + mimic)
    )


FIXED_FINGER = (
    link("palm", box("0 0 0.015", "0.05 0.1 0.03"), box("0 -0.045 0.08", "0.02 0.01 0.1"))
    + MOUNT
    + link("jaw", box("0 0.005 0.045", "0.02 0.01 0.09"))
    + joint("close", "revolute", "palm", "jaw", "0 0.03 0.04", "-1 0 0", limit(-0.9, 0.2))
)
"""A finger that the palm holds, its face at y = -40 mm, and one that turns towards it, hinged at y = 30 mm."""


def arm(hand: str, *, name: str = ' name="little"', more: str = "") -> str:
    """Return the URDF of the arm with a hand on its link l6."""
    links = "".join(link(part, solid(*content)) for part, content in _LINKS.items())
    joints = "".join(
        joint(name_, "revolute", parent, child, f"0 0 {z}", axis, limit(-reach, reach))
        for name_, parent, child, z, axis, reach in _JOINTS
    )
    return f"<robot{name}>{links}{joints}{hand}{more}</robot>"


def finger(name: str, place: str, axis: str, width: float = 0.02) -> str:
    """Return two phalanges of 45 mm along z that turn about x or against it."""
    phalanx = box("0 0 0.0235", f"{width} 0.012 0.045")
    return (
        link(f"{name}_1", phalanx)
        + link(f"{name}_2", phalanx)
        + joint(f"{name}_a", "revolute", "palm", f"{name}_1", place, axis, limit(-0.1, 1.4))
        + joint(f"{name}_b", "revolute", f"{name}_1", f"{name}_2", "0 0 0.047", axis, limit(-0.1, 1.4))
    )


THUMB = finger("thumb", "0.005 -0.03 0.035", "-1 0 0", 0.06)
MANY_FINGERS = (
    link("palm", box("0 0 0.015", "0.1 0.1 0.03"))
    + MOUNT
    + finger("index", "0.03 0.03 0.035", "1 0 0")
    + finger("middle", "0.005 0.03 0.035", "1 0 0")
    + finger("ring", "-0.02 0.03 0.035", "1 0 0")
    + THUMB
)
"""Three fingers side by side, 5 mm between them, which bend towards -y, and a broad thumb that bends towards +y."""
