"""Points to solve from, for a start that pairs of contacts are proposed to.

First the hand holds a pair as in its trial, and the arm is brought there. Where that leads nowhere, the start is
projected onto one pair after the other from where it is.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from itertools import islice

from ..arrays import Array
from ..kinematics.wrist import wrist_pose
from ..problem import DesiredPoints, GraspProblem, Proposal, State
from ..solver_words import Projection
from .held_hand import between, brought, turned
from .projection import descend, initial_guesses, miss, nearest_assignment

NEAR = 0.02
"""Norm of the scaled residual up to which a projected start is solved from before it is projected onto other pairs."""
BROUGHT = 0.008
"""Norm of the scaled residual up to which a hand that was brought to a pair is solved from: of those that miss the
conditions by more hardly one leads to a grasp."""
CLOSE = 1e-3
"""Norm of the scaled residual at which an arm is close enough to be solved from, 10 micrometres: the rest is quicker
there."""
FAR = 10.0
"""Norm of the scaled residual above which an arm that is brought to a hold is too far in walls or links to get out."""
HOLDS = 2
"""Hands that hold one pair and are tried, at most: those into which the wrist has the least way to turn."""
GUESSES = 8
"""Points that a start is projected to, at most."""

Guess = tuple[GraspProblem, Array]
"""A problem, and a point to solve it from, shape (v,)."""
ProblemOf = Callable[[tuple[int, ...], DesiredPoints], GraspProblem]
"""Gives the problem of an assignment and of points that are proposed."""


def held_guesses(problem_of: ProblemOf, start: State, proposed: Sequence[Proposal]) -> Iterator[Guess]:
    """Yield guesses at which the hand holds a pair about as it did in its trial, and all but keep the conditions.

    Args:
        problem_of: gives the problems.
        start: where the arm is.
        proposed: pairs, with the hands that hold them.
    """
    here = wrist_pose(start.configuration)
    for pair in proposed:
        for hold in sorted((turned(hold, here) for hold in pair.holds), key=partial(between, here))[:HOLDS]:
            problem = problem_of(hold.assignment, pair.desired)
            x = brought(problem, start.x, hold)
            if x is not None and miss(problem, x) <= FAR:
                guess = descend(problem, 0.0, 1.0, x, 0.0, done=CLOSE)
                if miss(problem, guess) <= BROUGHT:
                    yield problem, guess


def nearest_first(
    problem_of: ProblemOf, start: State, proposed: Sequence[Proposal], onto: Projection
) -> Iterator[Guess]:
    """Yield projected starts that all but keep the conditions as they come, then the others, nearest first.

    From nine of ten of the former a solve leads to a grasp; from one of ten of the latter, and it takes four times as
    long. Each is made when it is asked for.

    Args:
        problem_of: gives the problems.
        start: that is projected.
        proposed: pairs.
        onto: conditions of the projection.
    """
    others = []
    for problem, guess in islice(_projected(problem_of, start, proposed, onto), GUESSES):
        if (missed := miss(problem, guess)) <= NEAR:
            yield problem, guess
        else:
            others.append((missed, problem, guess))
    for _, problem, guess in sorted(others, key=lambda other: other[0]):
        yield problem, guess


def _projected(problem_of: ProblemOf, start: State, proposed: Sequence[Proposal], onto: Projection) -> Iterator[Guess]:
    """Yield the first projection of a start on each of the pairs, then the second ones."""
    ways = []
    for pair in proposed:
        problem = problem_of(nearest_assignment(start.model, start, pair.desired), pair.desired)
        ways.append((problem, initial_guesses(problem, start.x, onto)))
    while ways:
        for way in list(ways):
            problem, guesses = way
            guess = next(guesses, None)
            if guess is None:
                ways.remove(way)
            else:
                yield problem, guess
