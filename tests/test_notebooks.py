"""Results, grasps, certificates and checks as tables of HTML in a notebook."""

from __future__ import annotations

import dataclasses
import math
import re
from html.parser import HTMLParser

import numpy as np
import pytest

from pinograsp import (
    Cause,
    Certificate,
    Contact,
    Cost,
    Explanation,
    Figure,
    Grasp,
    PairClearance,
    Result,
    Robot,
    Scene,
    Setup,
)
from pinograsp.results.configuration_check import ConfigurationCheck
from pinograsp.results.criteria import CRITERIA
from pinograsp.results.table import explanation_lines
from pinograsp.visualization import explanation_tables

FIGURES = (
    Figure("enclosure clearance", 0.0312, 0.005, "m", "at least", "forearm <-> wall"),
    Figure("joint reserve", math.radians(12.5), math.radians(1.0), "rad", "at least", "joint_2"),
    Figure("Q_force", 9.87, -math.inf, "m/s^2", "at least", "+z"),
    Figure("contact gap", 2e-6, 1e-5, "m", "at most", "left"),
)


@pytest.fixture(scope="module")
def grasp(gen3: Robot, glovebox: Scene) -> Grasp:
    contact = Contact(
        pad="<left>",
        link="tip & co",
        point=np.zeros(3),
        normal=np.array([1.0, 0.0, 0.0]),
        force=np.array([-3.63, 0.0, 1.0]),
        spin_torque=0.0,
        desired_point=np.zeros(3),
        T_world_pad=np.eye(4),
    )
    return Grasp(
        start=3,
        count=4,
        joints={"joint_1": 0.25, "<slide>": -0.0125},
        q_arm=np.array([0.25]),
        synergy=np.array([-0.0125]),
        contact_parameters=np.zeros(2),
        internal_forces=np.zeros(1),
        q_r={},
        cost=Cost(2.179, 0.04, 2.139),
        contacts=(contact,),
        certificate=Certificate(FIGURES),
        T_world_wrist=np.eye(4),
        setup=Setup(gen3.description.model_copy(update={"name": "<arm>"}), glovebox, "sphere"),
    )


class Tables(HTMLParser):
    """Reads the rows of all tables as the text of their cells, and refuses HTML whose tags do not pair."""

    def __init__(self, html: str) -> None:
        super().__init__()
        self.rows: list[list[str]] = []
        self.captions: list[str] = []
        self._open: list[str] = []
        self.feed(html)
        assert not self._open

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self._open.append(tag)
        if tag == "tr":
            self.rows.append([])
        elif tag in ("td", "th"):
            self.rows[-1].append("")
        elif tag == "caption":
            self.captions.append("")

    def handle_endtag(self, tag: str) -> None:
        assert self._open.pop() == tag

    def handle_data(self, data: str) -> None:
        if "caption" in self._open:
            self.captions[-1] += data
        elif "td" in self._open or "th" in self._open:
            self.rows[-1][-1] += data


def test_a_certificate_has_every_figure_in_shown_units(grasp: Grasp) -> None:
    tables = Tables(grasp.certificate._repr_html_())
    assert tables.captions == ["Certificate: verified"]
    assert tables.rows == [
        ["figure", "value", "limit", "", "where"],
        ["enclosure clearance", "31.2 mm", "≥ 5 mm", "", "forearm <-> wall"],
        ["joint reserve", "12.5 °", "≥ 1 °", "", "joint_2"],
        ["Q_force", "9.87 m/s²", "", "", "+z"],
        ["contact gap", "0.002 mm", "≤ 0.01 mm", "", "left"],
    ]


def test_a_certificate_that_is_refuted_says_by_what(grasp: Grasp) -> None:
    failing = dataclasses.replace(FIGURES[3], value=2e-3)
    html = Certificate((*FIGURES[:3], failing))._repr_html_()
    tables = Tables(html)
    assert tables.captions == ["Certificate: not verified: refuted by contact gap 2 mm (≤ 0.01 mm)"]
    assert tables.rows[-1] == ["contact gap", "2 mm", "≤ 0.01 mm", "fails", "left"]
    bold = re.findall(r"<b>([^<]+)</b>", html)
    assert bold[1:] == tables.rows[-1]  # after the caption
    many = Certificate(tuple(dataclasses.replace(failing, name=f"gap {i}") for i in range(5)))
    [caption] = Tables(many._repr_html_()).captions
    assert caption.endswith("gap 2 2 mm (≤ 0.01 mm) and 2 more")


def test_a_grasp_has_every_criterion(grasp: Grasp) -> None:
    tables = Tables(grasp._repr_html_())
    assert tables.captions[0] == "Grasp of <arm> in glovebox, task sphere: verified"
    criteria = tables.rows[: len(CRITERIA)]
    assert [row[0] for row in criteria] == [criterion.name for criterion in CRITERIA]
    shown = {row[0]: row[1] for row in criteria}
    assert (shown["U"], shown["Q_force"], shown["clearance"], shown["reserve"]) == (
        "2.179",
        "9.87 m/s²",
        "31.2 mm",
        "12.5 °",
    )
    assert shown["Q_torque"] == "-"
    assert ["joint_1", "0.2500"] in tables.rows
    assert ["<slide>", "-0.0125"] in tables.rows
    assert ["<left>", "tip & co", "(-3.63, 0.00, 1.00) N"] in tables.rows
    assert tables.captions[-1] == "Certificate: verified"
    loose = Tables(dataclasses.replace(grasp, setup=None)._repr_html_())
    assert loose.captions[0] == "Grasp: verified"


def test_a_result_lists_the_grasps_that_differ(grasp: Grasp) -> None:
    assert grasp.setup is not None
    far = np.eye(4)
    far[0, 3] = 0.3
    grasps = (
        grasp,
        dataclasses.replace(grasp, start=5),
        dataclasses.replace(grasp, start=7, count=1, T_world_wrist=far),
    )
    result = Result(grasp.setup, grasps, 12, {"converged": 9, "failed": 3}, 9, 0, {})
    tables = Tables(result._repr_html_())
    assert tables.captions == ["<arm> in glovebox, task sphere: 9 of 12 starts verified", "Starts"]
    assert tables.rows[0] == ["", "found", "U", "Q m/s²", "Q turn m/s²", "clear mm", "reserve °", "manip. m³"]
    assert tables.rows[1:3] == [
        ["1", "8x", "2.179", "9.87", "-", "31.2", "12.5", "-"],
        ["3", "1x", "2.179", "9.87", "-", "31.2", "12.5", "-"],
    ]
    assert tables.rows[3] == ["9 of 12 starts verified (75.0 %); solver: 9 converged, 3 failed"]
    nothing = Tables(Result(grasp.setup, (), 1, {"failed": 1}, 0, 0, {})._repr_html_())
    assert len(nothing.rows) == 2


def test_a_check_has_certificate_and_distances(grasp: Grasp) -> None:
    pairs = (
        PairClearance("self collision", "forearm", "base", -math.inf),
        PairClearance("object clearance", "palm", "<ball>", 0.01234),
    )
    tables = Tables(ConfigurationCheck(grasp, pairs)._repr_html_())
    assert tables.captions == ["Certificate: verified", "Distances below 50 mm"]
    assert tables.rows[-2:] == [
        ["self collision", "forearm", "base", "overlap"],
        ["object clearance", "palm", "<ball>", "12.3 mm"],
    ]


def test_no_colour_of_its_own(grasp: Grasp) -> None:
    """Pages are light or dark; and nothing is loaded from elsewhere."""
    assert grasp.setup is not None
    result = Result(grasp.setup, (grasp,), 1, {"converged": 1}, 1, 0, {})
    for html in (shown._repr_html_() for shown in (result, grasp, ConfigurationCheck(grasp, ()))):
        assert not re.search(r"color(?!: inherit)|background|#[0-9a-f]{3}|class=|src=|href=|<script", html)


def test_a_depth_that_is_not_known_is_an_overlap() -> None:
    figure = Figure("pad clearance", -math.inf, 0.0, "m", "at least", "left")
    assert figure.shown_value == "overlap"
    least = next(criterion for criterion in CRITERIA if criterion.name == "clearance")
    assert least.shown({"object clearance": -math.inf, "self clearance": 0.01}) == "overlap"
    assert least.cell({"object clearance": -math.inf}) == "overlap"
    assert least.shown({"object clearance": 0.01}) == "10.0 mm"
    missed = Explanation(causes=(Cause("object clearance", 3, 1.0, math.inf, "m", "palm / ball", "ball"),), done=3)
    assert "100 % object clearance: nearest miss overlap (palm / ball)" in explanation_lines(missed)
    assert "overlap" in explanation_tables(missed)
    assert repr(Certificate((figure,))) == "<Certificate: refuted by pad clearance overlap (≥ 0 mm)>"


def test_figures_have_three_digits_and_large_ones_no_exponent() -> None:
    figure = Figure("Q_force", 1234.5, 1000.0, "m/s^2", "at least")
    assert (figure.shown_value, figure.shown_limit) == ("1230 m/s²", "≥ 1000 m/s²")
    assert Figure("enclosure clearance", 0.0312, 0.00499901, "m", "at least").shown_limit == "≥ 5 mm"
    assert Figure("enclosure clearance", 0.3, 0.2, "m", "at least").shown_limit == "≥ 200 mm"
