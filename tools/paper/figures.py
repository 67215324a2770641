"""Sorted costs (Figures 4, 7, 10 and 12 of the paper) and pictures of the best grasps."""

from __future__ import annotations

import subprocess
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

import pinograsp
from pinograsp.visualization import write_html
from screenshot import screenshot

from .cases import Case
from .page import Block, Heading, Pictures, Text
from .runs import Results, Session, costs, of_least_U

COLORS = ("#1f4fd8", "#d2691e", "#2ca02c", "#8e44ad")
PAPER = "#555555"


def sorted_costs_section(session: Session, results: Results, folder: Path) -> list[Block]:
    """Draw the sorted costs of every case into a folder, and return the section that shows them."""
    pictures = []
    for case in session.cases:
        file = folder / f"costs-{case.name}.png"
        of_robots = {name: costs(results[name, case.name]) for name in session.names}
        draw_sorted_costs(of_robots, case, file)
        pictures.append((file, f"Figure {case.printed.figure} of the paper: {case.title}"))
    return [
        Heading(2, "Sorted costs"),
        Text(
            "U of every verified grasp in descending order, as in Figures 4, 7, 10 and 12 of the paper; on a "
            "logarithmic scale where it spans more than a decade."
        ),
        Pictures(pictures),
    ]


def draw_sorted_costs(of_robots: dict[str, list[float]], case: Case, file: Path) -> None:
    """Draw one figure.

    Args:
        of_robots: ascending U of the verified grasps by robot.
        case: the case, for the paper's best U and number of verified grasps.
        file: PNG to write.
    """
    figure = Figure(figsize=(7.2, 4.2), dpi=130, layout="constrained")
    axes = figure.subplots()
    for (name, ascending), color in zip(of_robots.items(), COLORS, strict=False):
        numbers = np.arange(1, len(ascending) + 1)
        axes.plot(numbers, ascending[::-1], color=color, lw=2.0, label=f"{name}: {len(ascending)} verified")
    printed = case.printed
    label = f"paper: {printed.verified} verified, best U {printed.U:g}"
    axes.axhline(printed.U, color=PAPER, ls="--", lw=1.2, label=label)
    everything = [printed.U, *(U for ascending in of_robots.values() for U in ascending)]
    if max(everything) > 10.0 * min(everything):
        axes.set_yscale("log")
    axes.set_ylim(0.8 * min(everything), 1.3 * max(everything))
    axes.set_xlabel("verified grasp")
    axes.set_ylabel("U")
    axes.set_title(case.title)
    axes.grid(alpha=0.3, which="both")
    axes.legend(frameon=False, fontsize=9)
    _write(figure, file)


def draw_trade_off(points: Mapping[str, Sequence[tuple[float, float, float]]], file: Path) -> None:
    """Draw Phi against V of the best grasps for several weights k.

    Args:
        points: by robot (k, Phi in mm^2, V).
        file: PNG to write.
    """
    figure = Figure(figsize=(7.2, 4.2), dpi=130, layout="constrained")
    for i, ((name, curve), color) in enumerate(zip(points.items(), COLORS, strict=False), 1):
        axes = figure.add_subplot(1, len(points), i)
        k, phi, V = np.array(curve).T
        axes.plot(phi, V, "o-", color=color, lw=1.2, ms=4, label=name)
        # A span of at least 2 %: what differs by rounding only shall look the same.
        spans = [max(np.ptp(values), 0.02 * values.max(), 0.01) for values in (phi, V)]
        for first, last in _runs_of_neighbours(np.column_stack([phi / spans[0], V / spans[1]])):
            text = f"k = {k[first]:g}" + f" to {k[last]:g}" * (last > first)
            axes.annotate(text, (phi[last], V[last]), xytext=(5, 5), textcoords="offset points", fontsize=8)
        for values, limit in ((phi, axes.set_xlim), (V, axes.set_ylim)):
            middle, half = 0.5 * (values.min() + values.max()), 0.8 * spans.pop(0)
            limit(middle - half, middle + half)
        axes.ticklabel_format(useOffset=False)
        axes.set_xlabel("Phi, mm²")
        axes.set_ylabel("V")
        axes.grid(alpha=0.3)
        axes.legend(frameon=False, fontsize=9)
    _write(figure, file)


def _runs_of_neighbours(points: np.ndarray) -> list[tuple[int, int]]:
    """Return first and last of every run of points, shape (n, 2), that lie within 3 % of the run's first."""
    runs: list[tuple[int, int]] = []
    for i, point in enumerate(points):
        if runs and np.abs(point - points[runs[-1][0]]).max() < 0.03:
            runs[-1] = (runs[-1][0], i)
        else:
            runs.append((i, i))
    return runs


def _write(figure: Figure, file: Path) -> None:
    file.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(file)


def grasps_section(session: Session, results: Results, folder: Path) -> list[Block]:
    """Write the best grasp of every run as a page to turn with the mouse, and photograph it."""
    pictures, missing = [], []
    for case in session.cases:
        for robot in session.robots:
            name = robot.description.name
            best = of_least_U(results[name, case.name])
            file = folder / f"grasp-{name}-{case.name}.png"
            if best is None:
                missing.append(f"{name}, {case.title}: no grasp was found")
            elif reason := photograph(best, file, case.title):
                missing.append(f"{name}, {case.title}: {reason}")
            else:
                pictures.append((file, f"{case.title}, {name}: U = {best.cost.U:.6g}"))
    notes: list[Block] = [Text("No picture of " + "; ".join(missing) + ".")] if missing else []
    return [
        Heading(2, "Best grasps"),
        Text(
            "Contact forces on the object red, weight blue, friction cones green, desired points blue balls, contact "
            f"points black. In `{folder.name}/` an HTML page beside each picture turns with the mouse."
        ),
        Pictures(pictures),
        *notes,
    ]


def photograph(grasp: pinograsp.Grasp, file: Path, title: str) -> str:
    """Write the page of a grasp and a picture of it; return why there is no picture, or nothing."""
    page = file.with_suffix(".html")
    page.parent.mkdir(parents=True, exist_ok=True)
    write_html(grasp, page, caption=title)
    try:
        screenshot(page, file, size=(1280, 800), view="close-up")
    except (OSError, RuntimeError, subprocess.TimeoutExpired) as error:
        return str(error)
    return ""
