"""Parts that were found as the text of a robot file. What nobody can know from a URDF is marked with CHECK."""

from __future__ import annotations

from pathlib import Path

from ..descriptions.composition import Attachment, UrdfPart
from ..disk import is_file
from ..words import in_words, number_of
from .coupled import Coupled
from .pad_text import HARD, SOFT, number, numbers, pad_lines, pad_names
from .parts import Parts, guessed_limits, rests
from .yaml_text import text, texts

MANY = 3
"""More synergies are more than most tasks need."""
PADS_BY_HAND = """\
# CHECK: no two flat faces of the fingers that close on each other were found. Write two or more pads by hand (types:
# plane, line, cylinder, sphere). `pinograsp robot check` shows the flat faces that there are, and the pads:
#   - name: left
#     link: left_finger_tip
#     patch:
#       type: plane                  # origin + u x_axis + v (normal x x_axis), in the frame of the link
#       origin: [0.0, 0.0, 0.0]
#       normal: [0.0, 1.0, 0.0]      # outward, towards the object
#       x_axis: [0.0, 0.0, 1.0]
#       u: [-0.01, 0.01]
#       v: [-0.01, 0.01]
#     contact: {model: hard_finger}
pads: []
"""


def robot_file(found: Parts, name: str, srdf: str | None) -> str:
    """Return the text.

    Args:
        found: what was found.
        name: of the robot.
        srdf: address of an SRDF that lies beside the URDF, to be offered.
    """
    blocks = [_head(found, name, srdf)]
    blocks += [_attached(part) for part in found.composition.attach]
    blocks += [_arm(found), _hand(found), _pads(found), _stiffness(found)]
    return "\n\n".join("\n".join(block) for block in blocks) + "\n"


def _head(found: Parts, name: str, srdf: str | None) -> list[str]:
    composition = found.composition
    lines = ["# Written by `pinograsp robot new`. Lines with CHECK hold what a URDF does not say."]
    lines += ["format: 1", f"name: {text(name)}", f"urdf: {text(composition.urdf)}"]
    if srdf is not None:
        lines += [
            "# Found beside the URDF; without it, pairs of links that may touch are found by sampling.",
            f"# srdf: {text(srdf)}",
        ]
    lines += _taken(composition)
    if composition.packages:
        lines += ["packages:", *(f"  - {text(str(folder))}" for folder in composition.packages)]
    return lines


def _taken(part: UrdfPart) -> list[str]:
    """Return lines on what is held in a URDF, and on what stands for its collision geometry."""
    held = ", ".join(f"{text(name)}: {value}" for name, value in part.hold.items())
    lines = [f"hold: {{{held}}}    # CHECK: moved by nothing here, held at their origins"] if part.hold else []
    return [*lines, *(["use_visual: true    # links without collision geometry"] if part.use_visual else [])]


def _attached(part: Attachment) -> list[str]:
    lines = ["attach:", f"  - urdf: {text(part.urdf)}"]
    lines += [] if part.root is None else [f"    root: {text(part.root)}"]
    lines += [f"    to: {text(part.to)}"]
    lines += [f"    prefix: {text(part.prefix)}"] if part.prefix else []
    lines += [f"    {line}" for line in _taken(part)]
    given = any(part.position) or any(part.rpy)
    lines.append(f"    position: {numbers(part.position, 9)}" + ("" if given else "    # CHECK: in metres"))
    lines.append(f"    rpy: {numbers(part.rpy, 9)}" + ("" if given else "    # CHECK: in radians"))
    return lines


def _arm(found: Parts) -> list[str]:
    chain, limits = found.chain, guessed_limits(found)
    off = "" if found.towards else "    # CHECK: its z axis should point to the pads, it does not"
    lines = ["arm:", f"  joints: {texts(chain.arm)}", f"  wrist: {text(found.wrist)}{off}"]
    guessed = {name: limits[name] for name in chain.arm if name in limits}
    lines += ["  limits:"] if guessed else []
    for joint, interval in guessed.items():
        lines.append(f"    {text(joint)}: {_guess(found, joint, interval)}")
    if chain.still:
        count, names = number_of(len(chain.still), "joint"), in_words(list(map(text, chain.still)))
        where = "for good at zero, or as near to it as they can be," if rests(found) else "at zero for good"
        lines.append(f"# CHECK: {count} of neither arm nor hand, {where}: {names}".replace(",:", ":"))
    return lines


def _guess(found: Parts, joint: str, interval: tuple[float, float]) -> str:
    low, high = found.tree.joints[joint].limits
    given = f"{low:g} .. {high:g}" if (high, low) == interval else "none"
    return f"{list(interval)}    # CHECK: a guess, the URDF has {given}"


def _hand(found: Parts) -> list[str]:
    if found.coupled is not None:
        return [*_coupled(found.coupled), *_rest(found)]
    lines, limits = ["hand:", "  synergies:"], guessed_limits(found)
    if len(found.chain.hand) > MANY:
        lines.append(
            "    # CHECK: joints that move together can be one synergy: {name: close, joints: {a: 1.0, b: 0.5}}"
        )
    for joint in found.chain.hand:
        lines.append(f"    - joint: {text(joint)}")
        followers = found.tree.followers(joint)
        lines += [f"      # followed by {text(name)}, {mimic.multiplier:+g}" for name, mimic in followers.items()]
        if joint in limits:
            lines.append(f"      limits: {_guess(found, joint, limits[joint])}")
    return [*lines, *_rest(found)]


def _coupled(pair: Coupled) -> list[str]:
    return [
        "hand:",
        f"  # CHECK: {pair.said}.",
        "  # They are taken for one synergy. If each moves on its own, this is the line instead:",
        f"  # synergies: {pair.apart}",
        f"  synergies: [{pair.synergy}]",
    ]


def _rest(found: Parts) -> list[str]:
    """Return lines on joints that do not stay at zero."""
    pair = found.coupled
    lines = [] if pair is None or pair.rest is None else [f"    {pair.rest}    # not if each moves on its own"]
    lines += [f"    {text(name)}: {number(at)}    # CHECK: it cannot be at 0" for name, at in rests(found).items()]
    return ["  rest:", *lines] if lines else []


def _pads(found: Parts) -> list[str]:
    if not found.pads:
        return PADS_BY_HAND.splitlines()
    lines = ["# Flat faces that close on each other, less 1 mm at each edge so that a contact never sits on the rim."]
    if len(found.pads) > 2:
        lines.append("# CHECK: the first is of the thumb, which closes on the others; a task names those that it wants")
    if _fingers(found) > len(found.pads):
        lines.append("# CHECK: the hand has more fingers; add a pad for each that is to touch")
    if found.turning:
        lines.append(
            "# They do not stay parallel: only soft fingers keep what they hold from turning about both contacts."
        )
    names, contact = pad_names([pad.link for pad in found.pads]), SOFT if found.turning else HARD
    described = (pad_lines(pad, name, contact) for pad, name in zip(found.pads, names, strict=True))
    return [*lines, "pads:", *(line for pad in described for line in pad)]


def _fingers(found: Parts) -> int:
    """Return the number of links at the ends of branches of the hand that move on their own."""
    hand = found.chain.hand
    starts = [joint for joint in found.tree.branches(found.chain.palm) if (joint.leader or joint.name) in hand]
    # The links of one finger may branch off the palm side by side, as a knuckle and the bar that guides it.
    return len(starts) if len(hand) > 1 else 2


def _stiffness(found: Parts) -> list[str]:
    sliding = any(found.tree.joints[name].kind == "prismatic" for name in found.chain.hand)
    joint, unit = ("10000.0", "N / m") if sliding else ("100.0", "N m / rad")
    return [
        "stiffness:",
        f"  joint: {joint}    # CHECK: a guess, {unit}",
        "  contact: 10000.0    # CHECK: a guess, N / m",
    ]


def srdf_beside(urdf: Path) -> Path | None:
    """Return the SRDF with the name of a URDF in its folder, or in the folder `srdf` beside that."""
    places = (urdf.with_suffix(".srdf"), urdf.parent.parent / "srdf" / f"{urdf.stem}.srdf")
    return next((place for place in places if is_file(place)), None)
