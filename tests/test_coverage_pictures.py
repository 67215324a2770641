"""Pictures of what the wrist reaches: slices as a PNG, voxels as a page."""

import base64
import gzip
import re
import struct
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from pinograsp.database.coverage import SECTORS, Coverage
from pinograsp.errors import InputError
from pinograsp.visualization import coverage, coverage_html, coverage_png
from pinograsp.visualization.viewer import Recorder, Visualizer

ORIGIN, VOXEL = np.array([0.2, -0.4, 0.1]), 0.05


def made_up(shape, share, seed=0):
    """Return a coverage in which about a share of the voxels is reached."""
    random = np.random.default_rng(seed)
    directions = np.where(random.random(shape) < share, random.integers(1, SECTORS + 1, shape), 0)
    return Coverage(ORIGIN, VOXEL, 3 * directions, directions)


def meshes(found):
    """Return (vertices, faces, colours) of the voxels that are drawn at each height, by layer."""
    recorder = Recorder()
    coverage.draw_coverage(Visualizer(window=recorder), found)
    drawn = {}
    for command in recorder.commands:
        if command["type"] == "set_object" and "/voxels/" in command["path"]:
            data = command["object"]["geometries"][0]["data"]
            arrays = (data["attributes"]["position"], data["index"], data["attributes"]["color"])
            types = (np.float32, np.uint32, np.float32)
            drawn[int(command["path"].rsplit("/", 1)[1])] = tuple(
                np.frombuffer(array["array"].data, dtype).reshape(-1, 3)
                for array, dtype in zip(arrays, types, strict=True)
            )
    return drawn


def size_of_png(file):
    head = file.read_bytes()[:24]
    assert head[:8] == b"\x89PNG\r\n\x1a\n"
    return struct.unpack(">II", head[16:24])


@pytest.mark.parametrize("shape", [(22, 17, 12), (3, 20, 1), (1, 1, 2)], ids=str)
def test_the_png_is_a_picture_of_its_size(shape, tmp_path):
    file = tmp_path / "coverage.png"
    file.write_text("old")
    coverage_png(made_up(shape, 0.6), file, "a $title$ of $ & <b>")
    assert size_of_png(file) == (1600, 900)
    assert 20_000 < file.stat().st_size < 1_000_000
    assert list(tmp_path.iterdir()) == [file]


def test_the_page_escapes_its_title_and_loads_nothing(tmp_path):
    file = tmp_path / "coverage.html"
    found = made_up((6, 5, 4), 0.5)
    coverage_html(found, file, "<script>alert(1)</script> & more")
    page = file.read_text(encoding="utf-8")
    assert "<script>alert(1)" not in page
    assert page.count("&lt;script&gt;alert(1)&lt;/script&gt; &amp; more") == 2
    assert not re.search(r"<(script|link|img|iframe)[^>]*(src|href)=", page)
    assert f"{(found.counts > 0).sum()} of 120" in page
    assert "-0.400 to -0.150 m" in page
    assert list(tmp_path.iterdir()) == [file]

    (commands,) = re.findall(r'draw\("([A-Za-z0-9+/=]+)"\)', page)
    stream = gzip.decompress(base64.b64decode(commands))
    for layer in range(4):
        assert f"/meshcat/coverage/voxels/{layer}".encode() in stream
    assert '"/meshcat/coverage/voxels/" + layer' in page


def test_every_reached_voxel_is_drawn_once_in_its_colour():
    found = made_up((7, 5, 4), 0.4)
    drawn = meshes(found)
    assert sum(len(vertices) for vertices, _, _ in drawn.values()) == 8 * (found.counts > 0).sum()
    palette = coverage.scale_colors()
    directions = np.zeros_like(found.directions)
    for layer, (vertices, faces, paint) in drawn.items():
        assert len(faces) == 12 * len(vertices) // 8
        centers = vertices.reshape(-1, 8, 3).mean(axis=1)
        index = np.floor((centers - ORIGIN) / VOXEL).astype(int)
        np.testing.assert_allclose(centers, ORIGIN + VOXEL * (index + 0.5), atol=1e-6)
        assert set(index[:, 2]) == {layer}
        nearest = np.linalg.norm(palette - paint[::8, None, :], axis=2).argmin(axis=1)
        directions[tuple(index.T)] += nearest + 1
    np.testing.assert_array_equal(directions, found.directions)


def test_the_triangles_of_a_cube_face_outwards_and_close_it():
    found = Coverage(ORIGIN, VOXEL, np.ones((1, 1, 1), dtype=np.int64), np.ones((1, 1, 1), dtype=np.int64))
    vertices, faces, _ = meshes(found)[0]
    a, b, c = (vertices[faces[:, corner]].astype(np.float64) - vertices.mean(axis=0) for corner in range(3))
    volumes = np.einsum("ij,ij->i", a, np.cross(b, c)) / 6
    np.testing.assert_allclose(volumes, (coverage.CUBE * VOXEL) ** 3 / 12, rtol=1e-4)


def test_colours_tell_the_numbers_of_directions_apart():
    palette = coverage.scale_colors()
    assert palette.shape == (SECTORS, 3)
    assert (np.diff(palette @ [0.2126, 0.7152, 0.0722]) > 0).all()


@pytest.mark.parametrize("layers", [1, 2, 3, 5, 6, 12, 24, 120])
def test_slices_are_spread_over_the_box(layers):
    slices = coverage.slice_layers(layers)
    assert len(slices) == min(layers, coverage.SLICES)
    assert len(set(slices)) == len(slices)
    assert slices == sorted(slices)
    assert slices[0] >= 0 and slices[-1] < layers


def test_nothing_reached_is_a_picture_too(tmp_path):
    nothing = made_up((6, 5, 4), 0.0)
    coverage_png(nothing, tmp_path / "a.png", "nothing")
    assert size_of_png(tmp_path / "a.png") == (1600, 900)
    coverage_html(nothing, tmp_path / "a.html", "nothing")
    assert "0.0 %, 0 of 120" in (tmp_path / "a.html").read_text(encoding="utf-8")
    assert meshes(nothing) == {}


@pytest.mark.parametrize("write", [coverage_png, coverage_html])
def test_a_folder_that_cannot_be_made_is_an_error_of_input(write, tmp_path):
    (tmp_path / "file").touch()
    with pytest.raises(InputError, match=r"a\.out: cannot be written: "):
        write(made_up((2, 2, 2), 0.5), tmp_path / "file" / "a.out", "title")


def test_importing_the_visualization_leaves_matplotlib_alone():
    code = "import sys, pinograsp.visualization; assert 'matplotlib' not in sys.modules"
    here = Path(__file__).parent.parent
    subprocess.run([sys.executable, "-c", code], cwd=here, check=True, timeout=60)
