"""Ctrl-C and SIGTERM: raised where nothing is lost, and never dropped."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator, Mapping
from typing import Annotated, Any

import numpy as np
import pytest
import typer
from pydantic import BaseModel, WrapSerializer
from pydantic_core import PydanticSerializationError
from typer.testing import CliRunner

import pinograsp
from pinograsp import Robot, Scene
from pinograsp.cli.arguments import command
from pinograsp.execution.workers import Processes
from pinograsp.geometry.shapes import SphereSurface
from pinograsp.interrupts import exit_code, heard, held, taken, undisguised, watched


def ask(number: int = signal.SIGINT) -> None:
    os.kill(os.getpid(), number)


def test_what_comes_while_it_is_held_is_raised_at_the_end() -> None:
    done = []
    with pytest.raises(KeyboardInterrupt), watched():
        with held():
            ask()
            done.append("written")
        done.append("after it")
    assert done == ["written"]


def test_a_part_that_is_heard_is_left_at_once() -> None:
    done = []
    with watched(), held():
        try:
            with heard():
                ask()
                done.append("waited")
        except KeyboardInterrupt:
            taken()
            done.append("caught")
        ask()
        done.append("written")
        with pytest.raises(KeyboardInterrupt), heard():  # what came before it
            done.append("waited again")
        taken()
    assert done == ["caught", "written"]


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_exit_codes_are_those_of_shells(number: int) -> None:
    with pytest.raises(KeyboardInterrupt), watched() as asked:
        ask(number)
    assert asked.exit_code == 128 + number
    with pytest.raises(KeyboardInterrupt), watched(), held():
        ask(number)
        assert exit_code() == 128 + number


def test_what_came_first_decides() -> None:
    with pytest.raises(KeyboardInterrupt), watched() as asked, held():
        ask(signal.SIGTERM)
        ask(signal.SIGINT)
    assert asked.exit_code == 143


def test_what_a_library_drops_is_raised_again() -> None:
    done = []
    with pytest.raises(KeyboardInterrupt), watched():
        try:
            ask()
        except BaseException:
            done.append("dropped")
        time.sleep(10.0)
        done.append("slept")
    assert done == ["dropped"]


def test_what_a_destructor_drops_is_raised_again(capsys: pytest.CaptureFixture[str]) -> None:
    class Closed:
        def __del__(self) -> None:
            ask()

    done = []
    with pytest.raises(KeyboardInterrupt), watched():
        closed = Closed()
        del closed
        done.append("deleted")
        time.sleep(10.0)
        done.append("slept")
    assert done == ["deleted"]
    assert capsys.readouterr() == ("", "")


def test_what_is_on_its_way_is_not_raised_again() -> None:
    """However long it takes to end what was begun."""
    done = []
    with pytest.raises(KeyboardInterrupt), watched():
        try:
            ask()
        finally:
            time.sleep(0.1)
            ask()  # nor another one
            time.sleep(0.1)
            done.append("ended")
    assert done == ["ended"]


def test_what_was_taken_is_not_raised_again() -> None:
    with watched():
        try:
            ask()
        except KeyboardInterrupt:
            taken()
        time.sleep(0.1)


def test_handlers_are_put_back() -> None:
    numbers = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGALRM)
    before = [signal.getsignal(number) for number in numbers]
    with watched():
        assert [signal.getsignal(number) for number in numbers] != before
    assert [signal.getsignal(number) for number in numbers] == before


def test_a_hang_up_that_is_to_be_ignored_is() -> None:
    """As `nohup` says."""
    before = signal.signal(signal.SIGHUP, signal.SIG_IGN)
    try:
        with watched():
            ask(signal.SIGHUP)
    finally:
        signal.signal(signal.SIGHUP, before)


def test_a_script_keeps_its_own_handler() -> None:
    came = []
    before = signal.signal(signal.SIGINT, lambda number, frame: came.append(number))
    try:
        with held():
            ask()
            assert came == []
        assert came == [signal.SIGINT]
        with heard():
            ask()
        assert came == [signal.SIGINT, signal.SIGINT]
    finally:
        signal.signal(signal.SIGINT, before)


def asking_handler() -> Callable[[int], int]:
    def handle(item: int) -> int:
        if item == 0:
            os.kill(os.getppid(), signal.SIGINT)
            time.sleep(0.1)
        return item

    return handle


def test_what_workers_have_begun_is_kept() -> None:
    outcomes: list[int] = []
    with watched(), held(), Processes(1) as workers, pytest.raises(KeyboardInterrupt):
        outcomes.extend(workers.run(asking_handler, range(50), chunk=1))
    assert outcomes[0] == 0
    assert outcomes == list(range(len(outcomes)))
    assert len(outcomes) < 5


ASKED_WITHIN_AN_IMPORT = """
import os, sys

class Asking:
    module, number = sys.argv.pop(1), int(sys.argv.pop(1))

    def find_spec(self, name, path=None, target=None):
        if name == self.module:
            os.kill(os.getpid(), self.number)

sys.meta_path.insert(0, Asking())
from pinograsp.__main__ import main
main()
"""


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
@pytest.mark.parametrize("module", ["pinograsp.cli", "typer"])
def test_the_first_imports_end_with_a_line(module: str, number: int) -> None:
    command = [sys.executable, "-c", ASKED_WITHIN_AN_IMPORT, module, str(number), "list"]
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=120)
    assert (done.returncode, done.stdout, done.stderr) == (128 + number, "", "error: interrupted\n")


def disguised(depth: int) -> SystemError:
    """Return what Python makes of an interrupt where so many functions in C return with an exception set."""
    error: BaseException = KeyboardInterrupt()
    for _ in range(depth):
        made = SystemError("returned a result with an exception set")
        made.__cause__, error = error, made
    assert isinstance(error, SystemError)
    return error


@pytest.mark.parametrize("context", [heard, undisguised])
@pytest.mark.parametrize("depth", [1, 2, 5])
def test_an_interrupt_within_compiled_code_is_one(context: Any, depth: int) -> None:
    with pytest.raises(KeyboardInterrupt), context():
        raise disguised(depth)
    with pytest.raises(SystemError), context():
        raise SystemError("another one")
    with pytest.raises(SystemError), context():
        raise SystemError("another one") from ValueError()


def interrupted_writing(value: Any, write: Any) -> Any:
    raise KeyboardInterrupt


class Written(BaseModel):
    value: Annotated[int, WrapSerializer(interrupted_writing)]


def test_an_interrupt_within_what_pydantic_writes_is_one() -> None:
    with pytest.raises(KeyboardInterrupt), undisguised():
        Written(value=1).model_dump(mode="json")


@pytest.mark.parametrize("error", [disguised(1), PydanticSerializationError("Error calling function")])
def test_a_command_ends_with_a_line_whatever_an_interrupt_looks_like(error: Exception) -> None:
    error.__cause__ = KeyboardInterrupt()
    app = typer.Typer()

    def work() -> None:
        raise error

    command(app, "work")(work)
    done = CliRunner().invoke(app)
    assert (done.exit_code, done.stderr) == (130, "error: interrupted\n")


def test_an_interrupt_within_a_lock_is_one() -> None:
    with pytest.raises(KeyboardInterrupt), undisguised():
        try:
            raise KeyboardInterrupt
        finally:
            threading.Lock().release()
    with pytest.raises(RuntimeError), undisguised():
        threading.Lock().release()
    with pytest.raises(ValueError, match="another one"), undisguised():
        try:
            raise KeyboardInterrupt
        except KeyboardInterrupt:
            raise ValueError("another one") from None


@pytest.mark.parametrize("call", ["check", "contacts", "grasps", "first", "plan"])
def test_a_script_gets_the_interrupt_and_no_other_error(
    call: str, gen3: Robot, glovebox: Scene, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Wherever the calls of compiled functions are interrupted."""

    def interrupted(*_: object) -> None:
        raise disguised(2)

    monkeypatch.setattr(SphereSurface, "signed_distance", interrupted)
    with pinograsp.Planner(gen3, glovebox, workers=1) as planner, pytest.raises(KeyboardInterrupt):
        if call == "check":
            planner.check("sphere", np.zeros(8))
        elif call == "grasps":
            next(planner.grasps("sphere"))
        else:
            getattr(planner, call)("sphere")


class Interrupting(Mapping[str, Any]):
    """Content in which Ctrl-C comes while it is looked at."""

    def __init__(self, content: dict[str, Any]) -> None:
        self._content = content

    def __getitem__(self, key: str) -> Any:
        return self._content[key]

    def __iter__(self) -> Iterator[str]:
        return iter(self._content)

    def __len__(self) -> int:
        ask()
        return len(self._content)

    def keys(self) -> Any:
        ask()
        return self._content.keys()

    def items(self) -> Any:
        ask()
        return self._content.items()


def test_an_interrupt_is_no_error_of_a_scene(glovebox: Scene) -> None:
    content = glovebox.to_dict()
    with pytest.raises(KeyboardInterrupt):
        Scene.from_dict({**content, "objects": Interrupting(content["objects"])})
