"""Work shared by cores: the same results in the same order, whoever does it."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType

import numpy as np
import pytest
from threadpoolctl import threadpool_info, threadpool_limits

import softid
from softid.parallel import both, in_parallel, in_step, is_copy, sharing

HAS_FORK = sys.platform == "linux"
WAYS = [False, pytest.param(True, marks=pytest.mark.skipif(not HAS_FORK, reason="no fork here"))]

Share = Callable[..., None]


def threads() -> set[int]:
    """How many the matrix libraries that are loaded may take."""
    return {lib["num_threads"] for lib in threadpool_info() if lib["user_api"] == "blas"}


def require_two_threads() -> None:
    if threads() != {2}:
        pytest.skip("the matrix library has one thread only")


@pytest.fixture
def share(monkeypatch: pytest.MonkeyPatch) -> Share:
    """Sets how many cores there are, and whether the process may be forked."""

    def set_up(cores: int, *, forked: bool) -> None:
        monkeypatch.setattr(sharing, "usable_cores", lambda: cores)
        monkeypatch.setattr(sharing, "_can_fork", lambda: forked)

    return set_up


def place() -> tuple[int, int]:
    return os.getpid(), threading.get_ident()


@pytest.mark.parametrize("forked", WAYS)
def test_results_keep_the_order_of_the_items(share: Share, *, forked: bool) -> None:
    """The first item is the last to be done, and still comes first."""
    share(4, forked=forked)

    def work(item: int) -> int:
        time.sleep(0.02 * (4 - item))
        return item**2

    assert in_parallel(work, range(4)) == [0, 1, 4, 9]


def test_one_core_works_in_the_caller_itself(share: Share) -> None:
    """No thread and no process is started for nothing."""
    share(1, forked=HAS_FORK)
    assert set(in_parallel(lambda _: place(), range(5))) == {place()}


@pytest.mark.parametrize("forked", WAYS)
@pytest.mark.parametrize("cores", [2, 64])
def test_as_many_work_as_there_are_cores_up_to_the_limit(
    share: Share, cores: int, *, forked: bool
) -> None:
    """Each item takes long enough that everybody gets one; threads or processes, not both."""
    share(cores, forked=forked)

    def work(_: int) -> tuple[int, int]:
        time.sleep(0.05)
        return place()

    found = set(in_parallel(work, range(12)))
    assert len(found) == min(cores, sharing.MAX_WORKERS)
    assert len({process for process, _ in found}) == (len(found) if forked else 1)


@pytest.mark.parametrize("forked", WAYS)
@pytest.mark.parametrize("cores", [1, 3])
def test_an_error_reaches_the_caller(share: Share, cores: int, *, forked: bool) -> None:
    """Wherever it happens; the work behind it is that of the caller, with its traceback."""
    share(cores, forked=forked)
    with pytest.raises(ZeroDivisionError) as caught:
        in_parallel(lambda item: 1 // item, [1, 0, 2])
    assert any(entry.name == "<lambda>" for entry in caught.traceback)


@dataclass(frozen=True, eq=False)
class Holder:
    """Something that is known by being the same one, with a view that nothing can pickle."""

    values: np.ndarray
    names: MappingProxyType[str, int]


@pytest.mark.skipif(not HAS_FORK, reason="no fork here")
def test_what_was_known_comes_back_as_itself_and_the_rest_equal(share: Share) -> None:
    """Numbers to the last bit; a known object by identity, also within a new one."""
    share(3, forked=True)
    known = Holder(np.random.default_rng(0).standard_normal(50), MappingProxyType({"a": 1}))

    def work(item: int) -> tuple[Holder, Holder, int]:
        time.sleep(0.02)
        new = Holder(known.values * item, MappingProxyType({"b": item}))
        return known, new, os.getpid()

    found = in_parallel(work, range(6))
    assert len({process for _, _, process in found}) == 3
    for item, (same, new, _) in enumerate(found):
        assert same is known
        np.testing.assert_array_equal(new.values, known.values * item)
        assert dict(new.names) == {"b": item}


@pytest.mark.skipif(not HAS_FORK, reason="no fork here")
def test_what_a_copy_cannot_send_or_do_is_done_by_the_caller(share: Share) -> None:
    """A lock cannot be sent; a copy that is killed sends nothing."""
    share(2, forked=True)
    caller = os.getpid()

    def unsendable(item: int) -> tuple[int, object]:
        time.sleep(0.01)
        return item, threading.Lock()

    assert [item for item, _ in in_parallel(unsendable, range(6))] == list(range(6))

    def killed(item: int) -> int:
        time.sleep(0.01)
        if os.getpid() != caller:
            os.kill(os.getpid(), signal.SIGKILL)
        return item

    assert in_parallel(killed, range(6)) == list(range(6))


@pytest.mark.parametrize("forked", WAYS)
def test_a_part_is_not_shared_out_again(share: Share, *, forked: bool) -> None:
    """Or each copy would make copies of its own."""
    share(2, forked=forked)

    def work(_: int) -> bool:
        time.sleep(0.02)
        return {place()} == set(in_parallel(lambda _: place(), range(4)))

    assert all(in_parallel(work, range(4)))
    assert {place()} != set(in_parallel(lambda _: (time.sleep(0.02), place())[1], range(8)))


@pytest.mark.parametrize("workers", [1, 2])
def test_factorisations_take_one_thread_each(workers: int) -> None:
    """Their threads on cores that are taken wait for one another; afterwards all is as before."""
    with threadpool_limits(2, user_api="blas"):
        require_two_threads()
        inside = in_parallel(lambda _: threads(), range(4), workers=workers)
        assert inside == [{1}] * 4
        assert threads() == {2}


@pytest.mark.parametrize("verb", [softid.fit, softid.diagnose])
def test_a_fit_takes_one_thread(verb: Callable[..., object]) -> None:
    """It tells its progress with one thread in the matrix library, and leaves two as it found."""
    time_s = 0.02 * np.arange(600)
    pressure = np.where(time_s % 4.0 < 2.0, 0.0, 100.0)
    angle = np.convolve(pressure, 0.05 * 0.95 ** np.arange(200))[:600]
    angle += np.random.default_rng(0).standard_normal(600)
    log = softid.Log.from_arrays(time_s, {"pressure": pressure, "angle": angle})
    seen: list[set[int]] = []
    with threadpool_limits(2, user_api="blas"):
        require_two_threads()
        verb(log, model="oscillator", progress=lambda message, fraction: seen.append(threads()))
        assert threads() == {2}
    assert seen
    assert all(counts == {1} for counts in seen)


INTERRUPTED = """
import os, signal, sys, time
from softid.parallel import sharing
signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell in the background ignores it
sharing.usable_cores = lambda: 3
def work(item):
    os.write({begun}, b"b")
    time.sleep(30)
{how}
"""


@pytest.mark.skipif(not HAS_FORK, reason="no fork here")
@pytest.mark.parametrize(
    "how",
    [
        "sharing.in_parallel(work, range(3))",
        "with sharing.in_step(): sharing.in_parallel(work, range(3))",
    ],
)
def test_an_interrupt_ends_all_of_them_with_one_word(how: str) -> None:
    """As Ctrl-C reaches a whole group; none of the copies prints a traceback or goes on."""
    told, begun = os.pipe()
    process = subprocess.Popen(
        [sys.executable, "-c", INTERRUPTED.format(begun=begun, how=how)],
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
        pass_fds=[begun],
    )
    os.close(begun)
    for _ in range(3):
        assert os.read(told, 1)
    began = time.monotonic()
    os.killpg(process.pid, signal.SIGINT)
    _, errors = process.communicate(timeout=20)
    assert time.monotonic() - began < 10
    assert errors.count("KeyboardInterrupt") == 1
    assert not os.read(told, 1)  # nobody is left who could write
    os.close(told)


@pytest.mark.skipif(not HAS_FORK, reason="no fork here")
def test_copies_in_step_share_one_task_after_the_other(share: Share) -> None:
    """What was found first goes into what is shared next; all know everything."""
    share(3, forked=True)
    with in_step():
        first = in_parallel(slow_square, range(6))
        second = in_parallel(lambda k: (slow_square(first[k][0]), first), range(6))
    assert [number for number, _ in first] == [0, 1, 4, 9, 16, 25]
    assert [number for (number, _), _ in second] == [0, 1, 16, 81, 256, 625]
    members = {process for _, process in first}
    assert len(members) == 3
    assert members == {process for (_, process), _ in second}
    assert all(known is first for _, known in second)


def slow_square(number: int) -> tuple[int, int]:
    time.sleep(0.02)
    return number**2, os.getpid()


@pytest.mark.skipif(not HAS_FORK, reason="no fork here")
def test_a_copy_says_nothing_and_ends_with_the_block(
    share: Share, capfd: pytest.CaptureFixture[str]
) -> None:
    """One line is printed for each that is printed, and no process is left when an error is."""
    share(3, forked=True)
    seen: list[tuple[tuple[int, int], bool]] = []

    @in_step()
    def work() -> None:
        sys.stdout.write("once")
        os.write(2, b"once")
        seen.extend(in_parallel(lambda k: (slow_square(k), is_copy()), range(6)))
        raise InterruptedError

    with pytest.raises(InterruptedError):
        work()
    assert capfd.readouterr() == ("once", "once")
    assert {copy for (_, process), copy in seen if process != os.getpid()} == {True}
    assert {copy for (_, process), copy in seen if process == os.getpid()} == {False}
    for process in {process for (_, process), copy in seen if copy}:
        with pytest.raises(ProcessLookupError):
            os.kill(process, 0)


@pytest.mark.skipif(not HAS_FORK, reason="no fork here")
def test_an_error_is_caught_by_all_of_them(share: Share) -> None:
    """A program may go on after it: so do its copies."""
    share(2, forked=True)
    with in_step():
        try:
            in_parallel(lambda k: 1 // (slow_square(k)[0] - 4), range(4))
        except ZeroDivisionError:
            found = in_parallel(slow_square, range(6))
    assert [number for number, _ in found] == [0, 1, 4, 9, 16, 25]
    assert len({process for _, process in found}) == 2


@pytest.mark.parametrize("forked", WAYS)
@pytest.mark.parametrize("cores", [1, 2])
def test_a_block_in_another_or_on_one_core_changes_nothing(
    share: Share, cores: int, *, forked: bool
) -> None:
    """Nor where the system cannot fork."""
    share(cores, forked=forked)
    with in_step(), in_step():
        found = in_parallel(slow_square, range(6))
        alone = in_parallel(slow_square, range(6), workers=1)
    assert len({process for _, process in found}) == (2 if forked and cores == 2 else 1)
    assert {process for _, process in alone} == {os.getpid()}


@pytest.mark.skipif(not HAS_FORK, reason="no fork here")
def test_small_work_is_not_worth_copies_unless_they_are_there(share: Share) -> None:
    """Threads of this process do it, or those that go on in step."""
    share(2, forked=True)
    alone = in_parallel(slow_square, range(6), small=True)
    with in_step():
        together = in_parallel(slow_square, range(6), small=True)
        (_, first), (_, second) = both(lambda: slow_square(1), lambda: slow_square(2))
    assert {process for _, process in alone} == {os.getpid()}
    assert len({process for _, process in together}) == 2
    assert {first, second} <= {process for _, process in together}
    assert [number for number, _ in alone] == [number for number, _ in together]


@pytest.mark.parametrize("forked", WAYS)
def test_an_error_is_that_of_the_first_try(share: Share, *, forked: bool) -> None:
    """What fails once and would not again is not made good in silence."""
    share(2, forked=forked)
    met: list[int] = []

    def once(item: int) -> int:
        time.sleep(0.02)
        if item == 0 and not met:
            met.append(item)
            raise InterruptedError
        return item

    with pytest.raises(InterruptedError):
        in_parallel(once, range(2), workers=1)
    met.clear()
    with pytest.raises(InterruptedError):
        in_parallel(once, range(6))


@pytest.mark.skipif(not HAS_FORK, reason="no fork here")
def test_what_was_printed_before_is_not_printed_again(share: Share, tmp_path: Path) -> None:
    """A stream that holds text back has a copy in every process."""
    share(3, forked=True)
    out = sys.stdout
    with (tmp_path / "told.txt").open("w") as sys.stdout:
        sys.stdout.write("once")
        in_parallel(slow_square, range(6))
    sys.stdout = out
    assert (tmp_path / "told.txt").read_text() == "once"
