"""Ctrl-C and SIGTERM: raised where nothing is lost, and never dropped."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable

import pytest

from pinograsp.execution.workers import Processes
from pinograsp.interrupts import exit_code, heard, held, taken, watched


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


def test_an_interrupt_within_compiled_code_is_one() -> None:
    with pytest.raises(KeyboardInterrupt), heard():
        raise SystemError("returned a result with an exception set") from KeyboardInterrupt()
    with pytest.raises(SystemError), heard():
        raise SystemError("another one")
