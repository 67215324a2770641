"""The HTML page: meshcat's viewer, the drawing commands and a panel; that of a grasp holds its figures."""

from __future__ import annotations

import base64
import gzip
import json
import struct
from html import escape
from pathlib import Path
from string import Template
from typing import Any

import numpy as np
import umsgpack  # type: ignore[import-untyped]

from ..results.grasp import Contact, Grasp
from ..results.setup import Setup
from ..verification.certificate import Certificate, Figure
from . import colors
from .camera import View, close_up, whole_box, y_up
from .comparison import criteria_table
from .rows import row
from .viewer import viewer_javascript


def page(title: str, panel: str, commands: list[dict[str, Any]], views: dict[str, View]) -> str:
    """Return a page with a panel beside meshcat's viewer; it loads nothing from elsewhere.

    Args:
        title: title of the page, plain text.
        panel: HTML of the panel.
        commands: meshcat commands, in the order in which they are to be drawn; `camera.place` at the first view.
        views: where the camera may stand, by the name that `view_button` takes; the page opens with the first.
    """
    first = next(iter(views.values()))
    template = Template(Path(__file__).with_name("page.html").read_text(encoding="utf-8"))
    return template.substitute(
        title=escape(title),
        panel=panel,
        javascript=viewer_javascript(),
        views=json.dumps({name: _view(view, first) for name, view in views.items()}),
        commands=packed(commands),
    )


def grasp_page(commands: list[dict[str, Any]], grasp: Grasp, setup: Setup, caption: str, listed: str = "") -> str:
    """Return the page of a grasp; one that is not verified says so, and what refutes it, above everything else.

    Args:
        commands: meshcat commands, in the order in which they are to be drawn.
        grasp: the grasp that they draw.
        setup: robot, scene and task that it belongs to.
        caption: text below the heading.
        listed: HTML of what is to stand above its figures.
    """
    scene, task = setup.scene, setup.scene.task(setup.task)
    desired = task.desired_contacts is not None
    panel = (
        f"<h1>{_heading(grasp)}</h1>",
        f"<p>{escape(setup.robot.name)} in {escape(scene.name)}, task {escape(setup.task)}</p>",
        f"<p>{escape(caption)}</p>" if caption else "",
        _refutation(grasp.certificate),
        view_button("whole-box", "Whole box") + view_button("close-up", "Close-up"),
        listed,
        f"<table><caption>Cost</caption>{_costs(grasp, desired=desired)}</table>",
        criteria_table(grasp),
        "<table><caption>Contact forces on the object, world frame</caption>",
        "".join(_contact(contact) for contact in grasp.contacts) + "</table>",
        legend(
            colors.legend(
                regions=task.contact_region is not None,
                approach=task.approach is not None,
                desired=desired,
                verified=grasp.certificate.verified,
            )
        ),
        f"<table>{_certificate(grasp.certificate)}</table>",
    )
    views = {"whole-box": whole_box(scene, task), "close-up": close_up(grasp, scene, task)}
    return page(f"{setup.robot.name} / {scene.name} / {setup.task}", "\n".join(panel), commands, views)


def _heading(grasp: Grasp) -> str:
    if grasp.start is None:
        return "Configuration"
    return "Grasp" if grasp.certificate.verified else "Nearest miss"


def view_button(view: str, label: str) -> str:
    """Return a button of the panel that puts the camera at one of the page's views."""
    return f"<button onclick=\"look('{view}')\">{escape(label)}</button>"


def legend(entries: dict[str, int]) -> str:
    """Return the legend of colours (0xrrggbb) by what they mean, plain text."""
    return "<ul>" + "".join(_legend_entry(text, color) for text, color in entries.items()) + "</ul>"


def packed(commands: list[dict[str, Any]]) -> str:
    """Return commands as base64 of gzip of (length as little-endian uint32, msgpack) one after another."""
    messages = [umsgpack.packb(command) for command in commands]
    stream = b"".join(struct.pack("<I", len(message)) + message for message in messages)
    return base64.b64encode(gzip.compress(stream, compresslevel=6, mtime=0)).decode("ascii")


def _view(view: View, origin: View) -> dict[str, list[float]]:
    """Return a view in the viewer's coordinates, whose origin is the target of the first view."""
    return {"position": y_up(view.position - origin.target), "target": y_up(view.target - origin.target)}


def _costs(grasp: Grasp, *, desired: bool) -> str:
    cost, distances = grasp.cost, "contacts from desired points" if desired else "no contacts desired: proposed ones"
    return "".join(
        (
            row("U", f"{cost.U:.4g}", "cost index"),
            row("Φ", f"{cost.phi_mm2:.3g} mm²", distances),
            row("V", f"{cost.V:.4g}", "forces in their cones"),
        )
    )


def _contact(contact: Contact) -> str:
    force = contact.force
    components = ", ".join(f"{component:z.2f}" for component in force)
    spin = f"spin {1000 * contact.spin_torque:z.1f} N mm".replace(" ", "\N{NO-BREAK SPACE}")  # not broken in two
    turning = f", {spin}" if contact.spin_torque else ""
    return row(contact.pad, f"{np.linalg.norm(force):.2f} N", f"({components}) N{turning}")


def _refutation(certificate: Certificate) -> str:
    if certificate.verified:
        return ""
    reasons = "".join(
        f"<li>{escape(f'{figure.name}: {figure.shown_value}, not {figure.shown_limit}')}"
        f"<small>{escape(figure.where)}</small></li>"
        for figure in certificate.refuted_by
    )
    return f'<div class="refuted"><b>Not verified.</b> Refuted by<ul>{reasons}</ul></div>'


def _certificate(certificate: Certificate) -> str:
    verdict = "verified" if certificate.verified else "not verified"
    rows = "".join(_figure(figure) for figure in certificate.figures)
    return f"<caption>Certificate: {verdict}</caption>{rows}"


def _figure(figure: Figure) -> str:
    state = "holds" if figure.holds else "fails"
    return row(figure.name, figure.shown_value, figure.shown_limit, note=figure.where, style=state)


def _legend_entry(text: str, color: int) -> str:
    return f'<li><span style="background: {colors.css(color)}"></span>{escape(text)}</li>'
