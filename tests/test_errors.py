"""The tree of errors: classes, messages, and their way from one process to another."""

from __future__ import annotations

import pickle
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import pytest

from pinograsp.errors import (
    DatabaseMismatchError,
    FileError,
    InputError,
    MissingExtraError,
    PinograspError,
    TaskError,
    UnknownNameError,
    WorkerLostError,
    close_names,
)

KINDS = [InputError, UnknownNameError, FileError, DatabaseMismatchError, TaskError]


@pytest.mark.parametrize("kind", KINDS)
def test_an_input_error_says_where_what_and_how_to_mend_it(kind: type[InputError]) -> None:
    error = kind("is wrong", file="scene.yaml", line=3, key="tasks.a", remedy="Do this")
    assert str(error) == "scene.yaml:3: tasks.a: is wrong. Do this"
    assert (error.file, error.line, error.key) == (Path("scene.yaml"), 3, "tasks.a")
    assert (error.problem, error.remedy) == ("is wrong", "Do this")
    assert str(kind("is wrong", key="tasks.a")) == "tasks.a: is wrong"
    several = kind("is wrong:\nline 3\u2028of it", file="a\nb.yaml", remedy="Do\r\nthis")
    assert str(several) == "a b.yaml: is wrong: line 3 of it. Do this"
    assert (several.problem, several.remedy) == ("is wrong: line 3 of it", "Do this")
    assert isinstance(error, PinograspError)


def test_what_is_caught_apart() -> None:
    with pytest.raises(KeyError):
        raise UnknownNameError("there is no 'a'")
    for kind in KINDS[1:]:
        assert issubclass(kind, InputError)
    for further in (MissingExtraError, WorkerLostError):
        assert issubclass(further, PinograspError)
        assert not issubclass(further, InputError)
    assert not issubclass(FileError, OSError | KeyError)


@pytest.mark.parametrize("kind", KINDS)
def test_class_and_parts_are_pickled(kind: type[InputError]) -> None:
    error = kind("is wrong", file=Path("scene.yaml"), line=3, key="tasks.a", remedy="Do this")
    again = pickle.loads(pickle.dumps(error))
    assert type(again) is kind
    assert vars(again) == vars(error)
    assert str(again) == str(error)


def test_a_missing_extra_says_how_to_install_it() -> None:
    error = MissingExtraError("the hold test", "MuJoCo", "hold")
    assert str(error) == "the hold test needs MuJoCo. Run pip install 'pinograsp[hold]'"
    again = pickle.loads(pickle.dumps(error))
    assert (type(again), vars(again), str(again)) == (MissingExtraError, vars(error), str(error))


def _fail(name: str) -> None:
    raise UnknownNameError(f"there is no {name!r}", key="tasks", remedy=close_names(name, ["sphere"]))


def test_an_error_crosses_from_a_worker_process() -> None:
    with (
        ProcessPoolExecutor(1) as executor,
        pytest.raises(UnknownNameError, match=r"^tasks: there is no 'spher'\. Did you mean sphere\?$") as caught,
    ):
        executor.submit(_fail, "spher").result()
    assert caught.value.key == "tasks"


@pytest.mark.parametrize(
    ("name", "known", "remedy"),
    [
        ("spher", ["can", "sphere"], "Did you mean sphere?"),
        ("xyz", ["can", "sphere"], "Known: can, sphere"),
        ("xyz", list("abcdefghijkl"), "Known: a, b, c, d, e, f, g, h, i, j, k, l"),
        ("xyz", list("mlkjihgfedcba"), "Known: a, b, c, d, e, f, g, h, i, j, k, l, ..."),
        ("xyz", ["elbow", "elbow", "base"], "Known: base, elbow"),
        ("elbo", ["elbow", "elbow", "base"], "Did you mean elbow?"),
        ("xyz", [], "None is defined"),
        (3, {"can": 1}, "Known: can"),
        (None, ("can",), "Known: can"),
    ],
)
def test_close_names(name: object, known: list[str], remedy: str) -> None:
    assert close_names(name, known) == remedy
