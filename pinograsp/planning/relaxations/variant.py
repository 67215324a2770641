"""What is to be mended, and a change that has a size."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from ...arrays import Array
from ...descriptions import Scene, Task
from ...descriptions.bodies import Body
from ...results import Grasp

SMALL = (0.001, 0.002, 0.004, 0.008, 0.016, 0.032)
"""Sizes of jaws and regions that are tried, m."""


@dataclass(frozen=True)
class Failure:
    """What is to be mended."""

    scene: Scene
    task_name: str
    base: Array
    """Origin of the first arm joint, world, m, shape (3,)."""
    bodies: tuple[str, ...]
    """Bodies that are in the way, the most frequent first."""
    kinds: tuple[str, ...]
    """Constraints that are violated, the most frequent first; keys of the scene that a refusal names."""
    nearest_miss: Grasp | None = None
    """The posture that came nearest to a grasp."""
    jaw: tuple[float, float] | None = None
    """Least and greatest distance of two pads that face each other, m; None: not known."""
    done: int = 0
    """Starts that were solved; 0: the task was refused."""

    @property
    def task(self) -> Task:
        """The task."""
        return self.scene.task(self.task_name)

    @property
    def target(self) -> Body:
        """The task's object."""
        return self.scene.objects[self.task.object]


@dataclass(frozen=True)
class Variant:
    """One of the ways to make a change."""

    changes: Callable[[float], Mapping[str, Any]]
    """Of a size: new values by place in the scene; an `InputError` where there is no such change."""
    amount: Callable[[float], float]
    """Of a size, as it is reported."""
    text: Callable[[float], str]
    """Of a size."""


@dataclass(frozen=True)
class Change:
    """A change of one kind, which has a size, in one or several ways."""

    kind: str
    unit: str
    step: float
    """To which sizes are rounded up."""
    sizes: tuple[float, ...]
    """That are tried, in this order."""
    variants: tuple[Variant, ...]
    """The most promising first."""
    tried: Callable[[float], str]
    """What was tried up to a size, in words."""
    steady: bool = False
    """Whether what does not help does not help if it is smaller either."""
    share: float = 1.0
    """Of the time, compared with other changes."""
    without: Scene | None = None
    """A scene that asks for no more than every one of the changed ones; None: none is known."""


def place(*keys: str) -> str:
    """Return the place of a value in a scene, as `Remedy.changes` has it."""
    return json.dumps(list(keys))
