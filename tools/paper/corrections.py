"""Where this implementation departs from what the paper prints."""

from __future__ import annotations

from .page import Block, Heading, Table, Text

CORRECTIONS = (
    (
        "alpha = 1/(1 + mu²), (17) and (A1)",
        "1/sqrt(1 + mu²)",
        "This is the cosine of the friction angle of 41.98° that section 4.1 gives, and only with it do the printed "
        "forces have the printed V.",
    ),
    (
        "f_max = 100 N",
        "5 N, as a limit on the norm of the force",
        "With 5 N the optimum is V = 2.1787 at 3.631 N of normal force, as printed. With 100 N it would be V = 0.0044 "
        "near 72 N.",
    ),
    ("kappa is not given", "0.01 N", "Anything small against 0.8 N leaves every printed value as it is."),
    (
        "w = G f",
        "w + G f = 0, with G of the forces on the object",
        "The printed forces of every row of Table 5 sum to [-2, 0, 0] N: they oppose the weight.",
    ),
    (
        "(G K Gᵀ)⁻¹, (6)",
        "pseudo-inverse; what no force can balance is a constraint",
        "Two hard fingers resist no torque about the line that joins them: G has rank 5, there is no inverse.",
    ),
    (
        "Table 5, third entry of q",
        "pi - sigma",
        "The printed numbers are the second arm angle of Table 4, in all four rows; with pi - sigma (1.124, and 1.026 "
        "three times) they fit q_r.",
    ),
    (
        "Table 4: q_c in rad, y in mm",
        "q_c in mm, y in N",
        "The heads of the two columns belong to other quantities: q_c is a length on the phalanx, y a force.",
    ),
    (
        "Table 4, q_7 of Sims. 3 and 4",
        "not used as truth",
        "The direction of the jaw that these angles give contradicts the forces of Table 5; in Sims. 1 and 2 both "
        "agree within half a degree.",
    ),
    ("Case 3 cites Sim. 3 of both tables", "Sim. 4", "Case 2 cites the same row; the forces belong to case 2."),
    (
        "S = [0.5, -0.5, -0.5, 0.5], (19)",
        "[1, -1, -1, 1]",
        "It is the derivative of q = [sigma, pi/2 - sigma, pi - sigma, sigma - pi/2]. Only the unit of the synergy "
        "displacement changes: forces, y (in an orthonormal basis of the range of F_s) and q_r stay what they are.",
    ),
    (
        "25.2 mm from the left to the right finger's frame",
        "12.6 mm to each side of the middle",
        "The gap between the fingers is 25.2 - 2 · 57.3 cos(sigma) mm: 25.2 mm is the whole distance, not that of one "
        "finger.",
    ),
    (
        "q_r is not defined by a formula",
        "q + S delta sigma, with F_s delta sigma = E_s y",
        "Gives the printed q_r within 0.004 rad.",
    ),
    (
        "starts are solved as the database gives them",
        "projected on contacts and clearances first",
        "Solves from there are shorter and fail less; a plan says what each start came to.",
    ),
    (
        "no self-collision, no margin",
        "5 mm to walls and to itself (case 2: 2 mm to walls)",
        "The arm can hit itself, and a wall is not exactly where a file says.",
    ),
    (
        "links may touch the object, (15)",
        "only pads may, all other links keep 1 mm",
        "Where the palm touches too, the pads carry less than the forces that are reported.",
    ),
    (
        "a contact point is in its region, (14)",
        "the same in case 3; beside it, all that pad and object touch is",
        "A flat pad touches a can along a line, whose ends are up to half a pad away from the point.",
    ),
    (
        "a contact anywhere on its pad, (13)",
        "half a millimetre from its rim and from the object's edges",
        "An object that a pad touches with its very rim tips over it. Cases 2 and 3 would like to have it there: their "
        "U is 1 to 3 % larger for it, in case 3 by footprints only.",
    ),
    (
        "joints up to their limits, (13)",
        "arm joints keep 0.02 rad",
        "An arm at a limit cannot follow a correction.",
    ),
    (
        "hard fingers",
        "hard fingers for the paper's hand, soft ones for the real gripper",
        "Rubber pads resist a torque about their normal, by 2.2 mm times the friction they have left.",
    ),
)


def corrections_section() -> list[Block]:
    """Return the table of corrections."""
    return [
        Heading(2, "Printed and used"),
        Text(
            "Parts of what the paper prints cannot be what was run; its own tables show it. The last seven rows are "
            "choices of ours."
        ),
        Table(("printed", "used", "why"), CORRECTIONS),
    ]
