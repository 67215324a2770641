"""Limits of the joints of a URDF: where a `<safety_controller>` keeps a joint farther in, those count."""

from __future__ import annotations

import xml.etree.ElementTree as ET


def hard_limits(joint: ET.Element) -> tuple[float, float]:
    """Return the limits of a joint, rad (m); 0, 0 where the URDF gives none."""
    limit = joint.find("limit")
    low, high = (0.0 if limit is None else float(limit.get(key, "0")) for key in ("lower", "upper"))
    return low, high


def limits_of(joint: ET.Element) -> tuple[float, float]:
    """Return the limits within which a joint is kept, rad (m).

    Soft limits that are not within the hard ones, or leave nothing to move in, as zeros for both do, do not count.
    """
    low, high = hard_limits(joint)
    soft = joint.find("safety_controller")
    if soft is None:
        return low, high
    ends = float(soft.get("soft_lower_limit", low)), float(soft.get("soft_upper_limit", high))
    inside = max(low, ends[0]), min(high, ends[1])
    return inside if inside[0] < inside[1] else (low, high)
