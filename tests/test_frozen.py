"""Records and mappings that nobody can change: written to, compared, pickled, shown."""

from __future__ import annotations

import copy
import dataclasses
import json
import math
import pickle
from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest

import pinograsp.assessment.outcome
import pinograsp.database.coverage
import pinograsp.database.query
import pinograsp.hold.outcome
import pinograsp.onboarding.check
import pinograsp.results.configuration_check
import pinograsp.results.reverify
import pinograsp.verification.derived  # noqa: F401  every record is defined
from pinograsp import Certificate, Claim, Contact, Cost, Figure, Grasp, InputError
from pinograsp.frozen import FrozenMapping, Record, json_data
from pinograsp.verification import certificate as certificates


@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class Thing(Record):
    """A record of everything that one may hold."""

    also_in_json = ("doubled",)
    not_in_json = ("secret",)

    array: np.ndarray[Any, Any]
    numbers: Mapping[str, float]
    nested: Mapping[str, Any]
    parts: tuple[Any, ...]
    number: float = math.nan
    secret: str = "word"
    seconds: float = dataclasses.field(default=0.0, compare=False)

    @property
    def doubled(self) -> float:
        return 2.0 * self.number


def thing(**changes: Any) -> Thing:
    given: dict[str, Any] = {
        "array": np.array([[1.0, math.nan], [3.0, 4.0]]),
        "numbers": {"left": 1.0, "right": math.inf},
        "nested": {"files": {"urdf": "a"}, "list": [1, {"b": [2]}]},
        "parts": (Cost(1.0, 0.0, 1.0), np.arange(3.0)),
    }
    return Thing(**(given | changes))


def grasp() -> Grasp:
    contact = Contact("pad", "tip", np.zeros(3), np.array([1.0, 0, 0]), np.ones(3), 0.0, np.zeros(3), np.eye(4))
    figures = (Figure("contact gap", 2e-6, 1e-5, "m", "at most", "pad"), Figure("reach", 0.3, 0.1, "rad", "at least"))
    return Grasp(
        start=4,
        count=2,
        joints={"shoulder": 0.1, "slide_right": 0.3, "slide_left": 0.2},
        q_arm=np.array([0.1]),
        synergy=np.array([0.2]),
        contact_parameters=np.zeros(4),
        internal_forces=np.array([3.0]),
        q_r={"slide_left": 0.21},
        cost=Cost(2.5, 0.5, 2.0),
        contacts=(contact, dataclasses.replace(contact, pad="other")),
        certificate=Certificate(figures),
        T_world_wrist=np.eye(4),
    )


def subclasses(kind: type) -> set[type]:
    found = set(kind.__subclasses__())
    return found.union(*map(subclasses, found))


# What cannot be written.


def test_arrays_are_read_only_copies() -> None:
    given = np.zeros(3)
    held = thing(array=given, parts=(given,))
    given[0] = 1.0  # the caller's own
    assert held.array[0] == held.parts[0][0] == 0.0
    for array in (held.array, held.parts[0], grasp().contacts[0].T_world_pad, grasp().claim.points, grasp().q):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 1.0
    view = given[:]
    view.flags.writeable = False
    held = thing(array=view)
    given[1] = 2.0
    assert held.array[1] == 0.0
    assert thing(array=held.array).array is held.array  # it is frozen already


@pytest.mark.parametrize("path", [("numbers",), ("nested",), ("nested", "files")], ids=".".join)
def test_mappings_cannot_be_written(path: tuple[str, ...]) -> None:
    held: Any = thing()
    for name in path:
        held = held[name] if isinstance(held, Mapping) else getattr(held, name)
    with pytest.raises(TypeError, match="item assignment"):
        held["left"] = 2.0
    with pytest.raises(TypeError, match="item deletion"):
        del held["left"]
    assert not hasattr(held, "update")
    assert not hasattr(held, "pop")


def test_what_was_given_can_be_changed_without_the_record() -> None:
    numbers, nested = {"left": 1.0}, {"list": [1, {"b": 2}]}
    held = thing(numbers=numbers, nested=nested)
    numbers["left"] = 7.0
    nested["list"].append(3)
    assert held.numbers == {"left": 1.0}
    assert held.nested == {"list": [1, {"b": 2}]}
    assert held.nested["list"][1]["b"] == 2


def test_fields_cannot_be_set() -> None:
    with pytest.raises(dataclasses.FrozenInstanceError):
        thing().number = 1.0  # type: ignore[misc]


# Mappings.


def test_a_mapping_is_one() -> None:
    mapping = FrozenMapping({"b": 1.0, "a": 2.0})
    assert (list(mapping), list(mapping.values()), len(mapping)) == (["b", "a"], [1.0, 2.0], 2)
    assert "a" in mapping
    assert "c" not in mapping
    assert (mapping.get("a"), mapping.get("c"), mapping.get("c", 0.5)) == (2.0, None, 0.5)
    assert mapping == {"a": 2.0, "b": 1.0} == dict(mapping)
    assert mapping != {"a": 2.0}
    assert {**mapping, "a": 3.0} == {"b": 1.0, "a": 3.0}
    assert repr(mapping) == "{'b': 1.0, 'a': 2.0}"


@pytest.mark.parametrize(
    ("mapping", "name"),
    [(grasp().joints, "slide_lft"), (grasp().certificate, "contact gaps")],
    ids=["mapping", "certificate"],
)
def test_an_unknown_name_is_an_error_with_close_ones(mapping: Mapping[str, Any], name: str) -> None:
    close = {"slide_lft": "slide_left", "contact gaps": "contact gap"}[name]
    for kind in (KeyError, InputError):
        with pytest.raises(kind) as caught:
            mapping[name]
        assert str(caught.value).startswith(f"there is no '{name}'. Did you mean {close}")
    assert mapping.get(name) is None


# Comparison.


def test_equal_in_all_that_they_hold() -> None:
    assert thing() == thing()
    assert thing() == thing(nested={"list": (1, {"b": (2,)}), "files": {"urdf": "a"}})
    assert thing() == thing(seconds=3.0)
    assert grasp() == grasp()
    assert thing() != thing(number=1.0)
    assert thing() != grasp()
    assert (grasp() == 3) is False


@pytest.mark.parametrize(
    "change",
    [
        {"array": np.array([[1.0, math.nan], [3.0, np.nextafter(4.0, 5.0)]])},
        {"array": np.array([1.0, math.nan, 3.0, 4.0])},
        {"numbers": {"left": 1.0, "right": -math.inf}},
        {"numbers": {"left": 1.0}},
        {"nested": {"files": {"urdf": "b"}, "list": [1, {"b": [2]}]}},
        {"parts": (Cost(1.0, 0.0, 1.1), np.arange(3.0))},
        {"parts": (Cost(1.0, 0.0, 1.0), (0.0, 1.0, 2.0))},
        {"secret": "other"},
    ],
    ids=lambda change: next(iter(change)),
)
def test_every_part_counts(change: dict[str, Any]) -> None:
    assert thing() != thing(**change)


def test_not_a_number_equals_itself() -> None:
    assert Figure("a", float("nan"), 1.0, "m", "at most") == Figure("a", float("nan"), 1.0, "m", "at most")
    assert Figure("a", 1.0, 1.0, "m", "at most") != Figure("a", 1.0, 2.0, "m", "at most")


def test_records_have_no_comparison_of_their_own() -> None:
    """A dataclass makes one if it is not told otherwise, which fails for arrays."""
    records = subclasses(Record)
    assert {Grasp, Contact, Claim, Certificate, Figure, certificates.PairClearance} <= records
    assert len(records) > 20
    for record in records:
        assert dataclasses.is_dataclass(record)
        assert record.__eq__ is Record.__eq__, record
        assert record.__setattr__ is not object.__setattr__, record


# Pickled, copied, written.


@pytest.mark.parametrize("make", [thing, grasp], ids=["thing", "grasp"])
def test_pickled_and_copied(make: Any) -> None:
    for protocol in range(2, pickle.HIGHEST_PROTOCOL + 1):
        again = pickle.loads(pickle.dumps(make(), protocol))
        assert again == make()
        assert_frozen(again)
    for copied in (copy.copy(make()), copy.deepcopy(make())):
        assert copied == make()
        assert_frozen(copied)


def assert_frozen(value: Any) -> None:
    assert not isinstance(value, dict | list)
    if isinstance(value, np.ndarray):
        assert not value.flags.writeable
    for part in (
        vars(value).values() if isinstance(value, Record) else value.values() if isinstance(value, Mapping) else ()
    ):
        assert_frozen(part)
    for part in value if isinstance(value, tuple) else ():
        assert_frozen(part)


def test_json_has_the_attributes() -> None:
    data = thing().to_json()
    assert data == {
        "array": [[1.0, None], [3.0, 4.0]],
        "numbers": {"left": 1.0, "right": None},
        "nested": {"files": {"urdf": "a"}, "list": [1, {"b": [2]}]},
        "parts": [{"U": 1.0, "phi_mm2": 0.0, "V": 1.0}, [0.0, 1.0, 2.0]],
        "number": None,
        "seconds": 0.0,
        "doubled": None,
    }
    assert json.loads(json.dumps(data, allow_nan=False)) == data
    assert json_data(np.float64(0.5)) == 0.5
    assert json_data(True) is True


# Shown.


def test_representations_are_short() -> None:
    found = grasp()
    assert repr(found) == "<Grasp: verified, U 2.5, found by 2 starts>"
    assert repr(found.cost) == "Cost(U=2.5, phi_mm2=0.5, V=2)"
    assert repr(found.certificate) == "<Certificate: verified, 2 figures>"
    bad = Certificate((Figure("contact gap", 2e-3, 1e-5, "m", "at most", "pad"), *found.certificate.figures[1:]))
    assert repr(bad) == "<Certificate: refuted by contact gap 2 mm (≤ 0.01 mm)>"
    shown = repr(found.contacts[0])
    assert shown.startswith(
        "Contact(pad='pad', link='tip', point=[0., 0., 0.], normal=[1., 0., 0.], force=[1., 1., 1.]"
    )
    assert shown.endswith("T_world_pad=<array of shape (4, 4)>)")
    many = FrozenMapping({f"joint_{i}": 0.0 for i in range(20)})
    assert "numbers={20 entries}, nested={'files': {'urdf': 'a'}, 'list': (1, {'b': (2,)})}" in repr(
        thing(numbers=many)
    )
    assert "parts=(9 of int)" in repr(thing(parts=tuple(range(9))))


# Certificates.


def test_a_certificate_is_a_mapping_of_its_figures() -> None:
    certificate = grasp().certificate
    assert certificate["reach"] is certificate.figures[1]
    assert list(certificate) == ["contact gap", "reach"]
    assert dict(certificate) == {figure.name: figure for figure in certificate.figures}
    assert "reach" in certificate
    assert "beauty" not in certificate
    assert len(certificate) == 2
    twice = Certificate((*certificate.figures, Figure("reach", 9.0, 0.1, "rad", "at least")))
    assert (len(twice), twice["reach"].value) == (2, 0.3)
    assert twice != certificate
