"""Take a picture of an HTML page with a headless Chromium: `python tools/screenshot.py page.html out.png`.

With --small, of its 3D picture alone, without the panel, in 256 colours: for pages of the documentation.
"""

from __future__ import annotations

import argparse
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from PIL import Image

BROWSERS = ("chromium", "chromium-browser", "google-chrome")
OPTIONS = (
    "--headless",
    "--no-sandbox",
    "--use-gl=angle",
    "--use-angle=swiftshader",  # WebGL without a graphics card
    "--enable-unsafe-swiftshader",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--hide-scrollbars",
    "--virtual-time-budget=20000",
)

SMALL = (1070, 520)
"""Of a window, pixels."""
PANEL = 350
"""Width of the panel at its left, as the page's style sheet says, pixels."""
COLORS = 256


def screenshot(html: Path, png: Path, size: tuple[int, int] = (1600, 1000), view: str = "whole-box") -> None:
    """Write a PNG of a page of `pinograsp.visualization`.

    Args:
        html: the page.
        png: where to write the picture.
        size: width and height of the window, pixels.
        view: `whole-box` or `close-up`.

    Raises:
        FileNotFoundError: there is no such page, or no Chromium on the path.
        RuntimeError: Chromium took no picture.
    """
    page = html.resolve(strict=True)
    browser = next(filter(None, map(shutil.which, BROWSERS)), None)
    if browser is None:
        raise FileNotFoundError(f"none of {', '.join(BROWSERS)} was found: apt install chromium")
    png = png.resolve()
    png.unlink(missing_ok=True)
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
        command = [browser, *OPTIONS, f"--user-data-dir={profile}", f"--window-size={size[0]},{size[1]}"]
        command += [f"--screenshot={png}", f"{page.as_uri()}#{view}"]
        run = subprocess.run(command, capture_output=True, text=True, timeout=180, check=False)
    if run.returncode != 0 or not png.is_file():
        raise RuntimeError(f"{browser} took no picture of {html}: {run.stderr[-500:]}")


def small(png: Path) -> None:
    """Cut the panel off the picture of a window of the size `SMALL`, and leave few colours."""
    with Image.open(png) as whole:
        whole.convert("RGB").crop((PANEL, 0, *SMALL)).quantize(COLORS, kmeans=1).save(png, optimize=True)


def main() -> None:
    """Read the command line and take the picture."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("html", type=Path, help="page to photograph")
    parser.add_argument("png", type=Path, help="picture to write")
    parser.add_argument("--size", type=int, nargs=2, default=(1600, 1000), metavar=("WIDTH", "HEIGHT"))
    parser.add_argument("--view", choices=("whole-box", "close-up"), default="whole-box")
    parser.add_argument("--small", action="store_true", help="the 3D picture alone, in few colours")
    options = parser.parse_args()
    try:
        screenshot(options.html, options.png, SMALL if options.small else tuple(options.size), options.view)
        if options.small:
            small(options.png)
    except (OSError, RuntimeError, subprocess.TimeoutExpired) as error:
        sys.exit(f"screenshot: {error}")


if __name__ == "__main__":
    main()
