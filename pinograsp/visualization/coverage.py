"""Which parts of the enclosure the wrist reaches: slices as a PNG, voxels in meshcat as an HTML page.

A `Coverage` knows its voxels but not the walls: where a wall cuts the last voxels, the drawn box ends with them, up to
one voxel beyond the wall.
"""

from __future__ import annotations

import io
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..arrays import Array, Integers
from ..database.coverage import SECTORS, Coverage
from ..descriptions.enclosure import Enclosure
from ..disk import as_path, write_whole
from ..errors import require_kind
from . import camera, colors
from .page import legend, page, view_button
from .rows import row
from .scene import draw_enclosure
from .symbols import Look, arrow, draw
from .viewer import LayeredMesh, Recorder, Visualizer, clear_backdrop, geometry

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.cm import ScalarMappable


SLICES = 5
"""Most heights at which the PNG cuts the box."""
NOT_REACHED = "#dcdfe3"
"""No configuration of the database is there, which does not prove that there is none."""
CUBE = 0.5
"""Edge of a drawn cube in voxels: the gaps let the cubes behind be seen."""
AXIS_LENGTH, AXIS_RADIUS = 0.12, 0.0035
AXIS_COLORS = {"x": 0xD62728, "y": 0x2CA02C, "z": 0x1F4FD8}
TICKS = (1, 6, 12, 18, 24)


def coverage_png(coverage: Coverage, file: Path | str, title: str) -> None:
    """Write horizontal slices and projections of a coverage as a PNG, 1600 x 900 pixels.

    The file is complete or not there; an older one is replaced.

    Args:
        coverage: what the wrist reaches.
        file: where to write.
        title: heading, plain text.

    Raises:
        InputError: the file cannot be written.
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import ListedColormap, Normalize
    from matplotlib.figure import Figure

    require_kind("coverage", coverage, Coverage, remedy="Make it with `Coverage.of`")
    low, high = extent(coverage)
    layers = slice_layers(coverage.directions.shape[2])
    scale = ScalarMappable(
        Normalize(0.5, SECTORS + 0.5), ListedColormap([*scale_colors()]).with_extremes(bad=NOT_REACHED)
    )

    figure = Figure(figsize=(16, 9), dpi=100, layout="constrained", facecolor="white")
    FigureCanvasAgg(figure)
    figure.suptitle(f"{title}\nThe wrist reaches {_share(coverage)}", fontsize=16, parse_math=False, linespacing=1.4)
    rows = figure.add_gridspec(2, 1, height_ratios=(1, 1.3))
    top, bottom = figure.add_subfigure(rows[0]), figure.add_subfigure(rows[1])
    slices = top.subplots(1, len(layers), sharey=True, squeeze=False)[0]
    for axes, layer in zip(slices, layers, strict=True):
        _map(axes, coverage.directions[:, :, layer], low[[0, 1]], high[[0, 1]], scale)
        axes.set_title(f"z = {heights(coverage)[layer]:.3f} m", fontsize=14)
        axes.set_xlabel("x, m", fontsize=12)
    slices[0].set_ylabel("y, m", fontsize=12)

    above, side, shares = bottom.subplots(1, 3)
    _map(above, coverage.directions.max(axis=2), low[[0, 1]], high[[0, 1]], scale)
    above.set_title("from above: the most at any z", fontsize=14)
    above.set_xlabel("x, m", fontsize=12)
    above.set_ylabel("y, m", fontsize=12)
    _map(side, coverage.directions.max(axis=1), low[[0, 2]], high[[0, 2]], scale)
    side.set_title("from the side: the most at any y", fontsize=14)
    side.set_xlabel("x, m", fontsize=12)
    side.set_ylabel("z, m", fontsize=12)
    _draw_shares(shares, coverage, layers)
    bar = bottom.colorbar(scale, ax=[above, side], ticks=TICKS, fraction=0.04, pad=0.02)
    bar.set_label(f"approach directions of {SECTORS} (grey: none found)", fontsize=12)

    picture = io.BytesIO()
    figure.savefig(picture, format="png")
    write_whole(as_path("file", file), picture.getvalue())


def coverage_html(coverage: Coverage, file: Path | str, title: str) -> None:
    """Write the reached voxels as one HTML file: coloured cubes in the box, to turn with the mouse.

    The file is complete or not there; an older one is replaced.

    Args:
        coverage: what the wrist reaches.
        file: where to write.
        title: heading, plain text.

    Raises:
        InputError: the file cannot be written.
    """
    require_kind("coverage", coverage, Coverage, remedy="Make it with `Coverage.of`")
    recorder = Recorder()
    view = draw_coverage(Visualizer(window=recorder), coverage)
    write_whole(as_path("file", file), page(title, _panel(coverage, title), recorder.commands, view))


def draw_coverage(visualizer: Visualizer, coverage: Coverage) -> dict[str, camera.View]:
    """Draw the box and one mesh of cubes per height, below the node `coverage`; return the views of the page."""
    world = visualizer["coverage"]
    low, high = extent(coverage)
    draw_enclosure(world["enclosure"], Enclosure(min=tuple(low.tolist()), max=tuple(high.tolist())))
    for axis, (name, color) in enumerate(AXIS_COLORS.items()):
        for part, piece in arrow(low, low + AXIS_LENGTH * np.eye(3)[axis], AXIS_RADIUS).items():
            draw(world["axes"][name][part], piece, Look(color, layer=colors.SYMBOL_LAYER))
    for layer in range(coverage.directions.shape[2]):
        if (coverage.directions[:, :, layer] > 0).any():
            material = geometry.MeshPhongMaterial(vertexColors=True, flatShading=True)
            world["voxels"][str(layer)].set_object(LayeredMesh(cubes(coverage, layer), material, 0))
    clear_backdrop(visualizer)
    views = {
        "whole-box": camera.around(low, high, np.array([0.4, -1.0, 0.6])),
        "above": camera.around(low, high, np.array([0.0, -1e-3, 1.0])),
        "side": camera.around(low, high, np.array([0.0, -1.0, 0.0])),
    }
    camera.place(world, views["whole-box"])
    return views


def cubes(coverage: Coverage, layer: int) -> Any:
    """Return one mesh with a coloured cube, 8 vertices and 12 triangles, in every reached voxel of a height."""
    reached = np.argwhere(coverage.directions[:, :, layer] > 0)
    centers = coverage.origin + coverage.voxel * (np.column_stack([reached, np.full(len(reached), layer)]) + 0.5)
    corners = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])
    vertices = centers[:, None, :] + CUBE * coverage.voxel * corners
    faces = 8 * np.arange(len(reached))[:, None, None] + _CUBE_FACES
    directions = coverage.directions[reached[:, 0], reached[:, 1], layer]
    paint = np.repeat(scale_colors()[directions - 1], 8, axis=0)
    return geometry.TriangularMeshGeometry(vertices.reshape(-1, 3), faces.reshape(-1, 3), paint)


_CUBE_FACES = np.array(
    [
        *([0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5]),  # x
        *([0, 4, 5], [0, 5, 1], [2, 3, 7], [2, 7, 6]),  # y
        *([0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]),  # z
    ]
)
"""Corners of the triangles of a cube, anticlockwise from outside; corner 4 x + 2 y + z, each 0 or 1."""


def extent(coverage: Coverage) -> tuple[Array, Array]:
    """Return the lowest and the highest corner of the voxels, world frame, m, shapes (3,)."""
    return coverage.origin, coverage.origin + coverage.voxel * np.array(coverage.counts.shape)


def heights(coverage: Coverage) -> Array:
    """Return z of the middle of every layer of voxels, m, shape (nz,)."""
    return np.asarray(coverage.origin[2] + coverage.voxel * (np.arange(coverage.counts.shape[2]) + 0.5))


def slice_layers(layers: int) -> list[int]:
    """Return the layers of voxels that the PNG shows: the middles of equal parts of the box, from below."""
    count = min(SLICES, layers)
    return [int((part + 0.5) * layers / count) for part in range(count)]


def scale_colors() -> Array:
    """Return the colours of 1, 2, ..., `SECTORS` approach directions, RGB of 0..1, shape (SECTORS, 3)."""
    from matplotlib import colormaps

    return np.asarray(colormaps["viridis"](np.linspace(0, 1, SECTORS)), dtype=np.float64)[:, :3]


def _map(axes: Axes, directions: Integers, low: Array, high: Array, scale: ScalarMappable) -> None:
    """Draw approach directions, shape (n0, n1), on a plane from corner `low` to `high`, m, shapes (2,)."""
    axes.imshow(
        np.ma.masked_equal(directions.T, 0),
        cmap=scale.cmap,
        vmin=0.5,
        vmax=SECTORS + 0.5,
        origin="lower",
        extent=(low[0], high[0], low[1], high[1]),
        interpolation="nearest",
    )
    axes.tick_params(labelsize=11)


def _draw_shares(axes: Axes, coverage: Coverage, layers: list[int]) -> None:
    """Draw the share of voxels reached at every height; the heights of the slices are darker."""
    shares = 100 * (coverage.directions > 0).mean(axis=(0, 1))
    paint = ["#31688e" if layer in layers else "#a9c3d4" for layer in range(len(shares))]
    axes.barh(heights(coverage), shares, height=0.86 * coverage.voxel, color=paint)
    axes.set(xlim=(0, 100), ylim=(extent(coverage)[0][2], extent(coverage)[1][2]))
    axes.set_title("voxels reached (dark: slices above)", fontsize=14)
    axes.set_xlabel("share, %", fontsize=12)
    axes.set_ylabel("z, m", fontsize=12)
    axes.tick_params(labelsize=11)
    axes.grid(axis="x", color="#d5dbe2")
    axes.set_axisbelow(True)


def _figures(coverage: Coverage) -> dict[str, str]:
    """Return what the coverage comes to, in words, by what it is."""
    often = coverage.directions[coverage.directions > 0]
    mean, most = (f"{often.mean():.1f}", f"{often.max()}") if often.size else ("-", "-")
    return {
        "voxels reached": f"{100 * coverage.reached:.1f} %, {often.size:,} of {coverage.counts.size:,}",
        "edge of a voxel": f"{1e3 * coverage.voxel:g} mm",
        "configurations": f"{coverage.counts.sum():,}",
        "directions of a reached voxel, mean": f"{mean} of {SECTORS}",
        "directions of a reached voxel, most": f"{most} of {SECTORS}",
    }


def _panel(coverage: Coverage, title: str) -> str:
    """Return the HTML of the page's panel."""
    low, high = extent(coverage)
    figures = "".join(row(name, value) for name, value in _figures(coverage).items())
    sides = "".join(row(axis, f"{low[i]:.3f} to {high[i]:.3f} m") for i, axis in enumerate("xyz"))
    paint = "".join(f'<span style="background: {color}"></span>' for color in _css_colors())
    ticks = "".join(f'<span style="left: {100 * (tick - 0.5) / SECTORS:.1f}%">{tick}</span>' for tick in TICKS)
    buttons = (("whole-box", "Whole box"), ("above", "From above"), ("side", "From the side"))
    tops = [round(float(top), 4) for top in heights(coverage) + coverage.voxel / 2]
    return "\n".join(
        (
            "<h1>Coverage</h1>",
            f"<p>{escape(title)}</p>",
            "".join(view_button(*button) for button in buttons),
            f"<table><caption>What the wrist reaches</caption>{figures}</table>",
            "<table><caption>Approach directions of a voxel</caption></table>",
            f'<div class="scale">{paint}</div><div class="ticks">{ticks}</div>',
            "<p>A voxel in which no configuration was found is not drawn; a larger database may find some.</p>",
            _SLIDER.format(layers=len(tops), top=f"{tops[-1]:.3f}", tops=tops),
            f"<table><caption>Voxels, world frame</caption>{sides}</table>",
            legend({f"{axis} axis": color for axis, color in AXIS_COLORS.items()}),
        )
    )


_SLIDER = """<table><caption>Shown: z up to <span id="top">{top}</span> m</caption></table>
<p><input type="range" min="1" max="{layers}" value="{layers}" aria-label="height" autocomplete="off"
  oninput="cut(this.value)"></p>
<script>
const tops = {tops};
function cut(layers) {{
  document.getElementById("top").textContent = tops[layers - 1].toFixed(3);
  tops.forEach((_, layer) => viewer.handle_command({{
    type: "set_property", path: "/meshcat/coverage/voxels/" + layer, property: "visible", value: layer < layers,
  }}));
}}
</script>"""
"""Hides the voxels above a height, to look inside."""


def _css_colors() -> list[str]:
    return [colors.css(int(red) << 16 | int(green) << 8 | int(blue)) for red, green, blue in 255 * scale_colors()]


def _share(coverage: Coverage) -> str:
    figures = _figures(coverage)
    return f"{figures['voxels reached']} voxels of {figures['edge of a voxel']}"
