"""Summary, marks, and Tables 4 and 5 of the paper beside our best grasps."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

import pinograsp

from .cases import STARTS, Case, Row
from .page import Block, Heading, Table, Text
from .runs import Results, Session, costs, near_best, of_least_U, search_seconds


def introduction(session: Session) -> list[Block]:
    """Return what the page is about."""
    robots = "; ".join(f"`{robot.description.name}`: {robot.description.description}" for robot in session.robots)
    return [
        Text(
            "The four cases of Altobelli, Tokatli, Burroughes and Skilton, Robotics 2021, 10(1), 4, planned with "
            f"{session.starts} starts each, seed {session.seed}, beside the numbers that the paper prints. Robots: "
            f"{robots}."
        )
    ]


def summary_section(session: Session, results: Results) -> list[Block]:
    """Return what every run gave, beside what the paper prints."""
    rows = []
    for case in session.cases:
        rows.append(_printed_row(case))
        rows += [_row(case, name, results[name, case.name]) for name in session.names]
    head = (
        *("case", "robot", "starts", "verified", "near the best", "best U", "Phi, mm²", "V", "wall time"),
        "solver, a start and core",
    )
    return [
        Heading(2, "Summary"),
        Text(
            "Verified: the independent check verified the grasp. Near the best: share of the verified ones with U "
            "within 1 % + 1 mm² of the best. The wall time does not contain the start database, which is made once "
            f"for a robot and an enclosure; {session.workers} workers. The paper's times: LN_COBYLA in C++, all cores "
            "of a desktop i7 at 3.6 GHz."
        ),
        Table(head, rows),
    ]


def _printed_row(case: Case) -> tuple[str, ...]:
    printed = case.printed
    verified = _share(printed.verified, STARTS)
    values = (_number(printed.U), _number(printed.phi_mm2), f"{printed.V:.3f}")
    return (case.title, "paper", str(STARTS), verified, "", *values, "10-12 h", "")


def _row(case: Case, robot: str, result: pinograsp.Result) -> tuple[str, ...]:
    near, values = "-", ("-", "-", "-")
    best = of_least_U(result)
    if best is not None:
        cost = best.cost
        near = _share(near_best(costs(result), cost.U), result.verified)
        values = (_number(cost.U), _number(cost.phi_mm2), f"{cost.V:.4f}")
    times = (f"{search_seconds(result):.1f} s", f"{1e3 * result.times['solver_mean']:.1f} ms")
    return (case.title, robot, str(result.done), _share(result.verified, result.done), near, *values, *times)


def marks_section(session: Session, results: Results) -> list[Block]:
    """Return which marks are reached."""
    rows = []
    for case in session.cases:
        judged = {name: judge(case, results[name, case.name]) for name in session.names}
        marks = judged[session.names[0]]
        rows += [(case.title, mark, *(judged[name][mark] for name in session.names)) for mark in marks]
    fewer = f" These are of {session.starts} starts each." if session.starts != STARTS else ""
    return [
        Heading(2, "Marks to reach"),
        Text(f"Marks are set for {STARTS} starts.{fewer}"),
        Table(("case", "mark", *session.names), rows),
    ]


def judge(case: Case, result: pinograsp.Result) -> dict[str, str]:
    """Return, by mark, what was reached and whether that is enough."""
    marks, best = case.marks, of_least_U(result)
    U = np.inf if best is None else best.cost.U
    share = result.verified / max(result.done, 1)
    near = near_best(costs(result), U) / max(result.verified, 1)
    found = {f"verified at least {100 * marks.verified:.0f} %": _judged(_percent(share), share >= marks.verified)}
    if marks.near_best is None:
        found["near the best (to report)"] = _percent(near)
    else:
        mark = f"near the best at least {100 * marks.near_best:.0f} %"
        found[mark] = _judged(_percent(near), near >= marks.near_best)
    least = f"{marks.least_U:g} to " if marks.least_U else "at most "
    found[f"best U {least}{marks.most_U:g}"] = _judged(f"{U:.6g}", marks.least_U <= U <= marks.most_U)
    if marks.penetration_mm is not None:
        depth = np.inf if best is None else max(0.0, -1e3 * best.certificate["pad clearance"].value)
        found[f"best grasp at most {marks.penetration_mm:g} mm inside the object"] = _judged(
            f"{depth:.4f} mm", depth <= marks.penetration_mm
        )
    return found


def _judged(value: str, reached: bool) -> str:
    return f"{value}: {'reached' if reached else 'missed'}"


def printed_tables_section(session: Session, results: Results) -> list[Block]:
    """Return Tables 4 and 5 in the paper's layout, each printed row above ours."""
    table_4, table_5 = [], []
    for case in session.cases:
        printed, label = case.printed, f"Sim. {case.printed.sim}"
        table_4.append(
            (label, "paper", _vector(printed.q_a), f"{printed.sigma:.3f}", _vector(printed.q_c), f"{printed.y:.3f}")
        )
        table_5.append((label, "paper", *(_vector(row) for row in (printed.q, printed.q_r, printed.f_1, printed.f_2))))
        base = np.array(pinograsp.load_scene(case.scene).mounting.matrix)[:3, :3]
        for name in session.names:
            best = of_least_U(results[name, case.name])
            if best is None:
                table_4.append((label, name, *4 * ("-",)))
                table_5.append((label, name, *4 * ("-",)))
                continue
            row_4 = (best.q_arm, best.synergy, 1e3 * best.contact_parameters, best.internal_forces)
            table_4.append((label, name, *map(_own, row_4)))
            table_5.append((label, name, *map(_own, table_5_row(best, base))))
    return [
        Heading(2, "Tables 4 and 5 of the paper"),
        Text(
            "Best grasp of each case. Sim. 1 is the sphere, Sims. 2 to 4 are cases 1 to 3. Printed numbers stand as "
            "they are printed, but under the right heads; the third entry of each printed q repeats the second arm "
            "angle and should be pi - sigma. Arm angles of different grasps cannot agree: seven joints leave a family "
            "of arm postures for each pose of the hand, and the two robots differ in their hands (the manufacturer's "
            "model has its jaw turned by 90° about joint 7 against the paper's)."
        ),
        Heading(3, "Table 4: components of Q at the least U"),
        Table(("", "robot", "q_a, rad", "sigma, rad", "q_c, mm", "y, N"), table_4),
        Text(
            "q_c counts from the finger tip in the paper and from where a robot file puts the origin of the pad here, "
            "parameters of the first pad first; sigma and the sign of y are those of each robot's own hand."
        ),
        Heading(3, "Table 5: hand joints, their references, contact forces"),
        Table(("", "robot", "q, rad", "q_r, rad", "f_1, N", "f_2, N"), table_5),
        Text(
            "Forces on the object in the base frame of the arm (x along gravity), contact 1 at the first desired "
            "point. q and q_r in the order of the hand's joints: " + "; ".join(_hand_joints(session)) + "."
        ),
    ]


def table_5_row(grasp: pinograsp.Grasp, base: np.ndarray) -> tuple[Iterable[float], ...]:
    """Return q, q_r, f_1, f_2 of a grasp.

    Args:
        grasp: the grasp.
        base: rotation of the arm's base in the world, shape (3, 3).
    """
    contacts = sorted(grasp.contacts, key=lambda contact: -contact.desired_point[1])
    f_1, f_2 = (contact.force @ base for contact in contacts)
    return [grasp.joints[name] for name in grasp.q_r], grasp.q_r.values(), f_1, f_2


def _hand_joints(session: Session) -> list[str]:
    return [
        f"{robot.description.name}: " + ", ".join(f"`{robot.joint_names[joint]}`" for joint in robot.hand_joints)
        for robot in session.robots
    ]


def _vector(values: Iterable[float] | Row) -> str:
    texts = [f"{value:.3f}" for value in values]
    return texts[0] if len(texts) == 1 else f"[{', '.join(texts)}]"


def _own(values: Iterable[float]) -> str:
    """Write a row of ours, without the sign of a zero."""
    return _vector(np.round(list(values), 3) + 0.0)


def _share(part: int, whole: int) -> str:
    return f"{part} ({100 * part / whole:.1f} %)" if whole else "-"


def _percent(share: float) -> str:
    return f"{100 * share:.1f} %"


def _number(value: float) -> str:
    """Write a cost: as many digits as the marks need, tiny ones by their power of ten."""
    return f"{value:.1e}" if 0.0 < abs(value) < 1e-3 else f"{value:.6g}"


def machine_section(session: Session) -> list[Block]:
    """Return what computed the results that the page shows."""
    origins: dict[str, list[str]] = {}
    for name, made in session.store.used.items():
        key = (
            f"pinograsp {made['pinograsp']} at commit {made['commit']}, Python {made['python']}, "
            f"{made['processor']}, {made['cores']} cores"
        )
        origins.setdefault(key, []).append(name)
    rows = [(key, ", ".join(f"`{name}`" for name in names)) for key, names in origins.items()]
    return [
        Heading(2, "What computed this"),
        Text("All times are those of this machine. The results are the JSON files in `results/`."),
        Table(("made by", "results"), rows),
    ]
