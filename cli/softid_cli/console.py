"""What goes to stderr: messages, progress, and errors in one line each."""

from __future__ import annotations

import errno
import io
import os
import re
import sys
import threading
import traceback
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING, NoReturn

import click

from softid.errors import SoftidError
from softid.sentences import lowered

if TYPE_CHECKING:
    from types import FrameType

    from rich.progress import Progress, TaskID

INTERRUPTED = 130
BROKEN_PIPE = 141
UNEXPECTED = 70
BAD_OUTPUT = 3

PATIENCE_S = 1.0
"""Work that takes less shows no progress."""

COMPILING = "compiling numerical kernels, once; later runs start at once …"
COMPILING_IN_VAIN = (
    "compiling numerical kernels in every run, for they cannot be kept here; let NUMBA_CACHE_DIR "
    "name a folder in which you may write …"
)

_SUGGESTION = re.compile(r"\. Did you mean (.*)\?")
"""How click proposes another option where it knows one."""

_BAR_STEPS = 1000
_LEAST_NEWS = 0.1
"""Fraction of the work after which a file is told of the same stage again."""

ProgressCallback = Callable[[str, float], None]


class NoCommandError(click.UsageError):
    """`softid` alone; its message is the help.

    Releases of click differ here: 8.1 prints the help and succeeds, later ones raise an error that
    8.1 does not have.
    """

    def __init__(self, ctx: click.Context) -> None:
        super().__init__(ctx.get_help(), ctx)


_interruptions: list[int] = []


def note_interruption(signum: int, frame: FrameType | None) -> NoReturn:
    """Raise KeyboardInterrupt, and remember it, for a library may turn it into something else."""
    del frame
    _interruptions.append(signum)
    sys.unraisablehook = _say_nothing
    raise KeyboardInterrupt


def was_interrupted() -> bool:
    """Whether the user has asked this process to stop."""
    return bool(_interruptions)


def _say_nothing(_: object) -> None:
    """What goes wrong while an interrupted run is taken down is of no interest."""


def leave_at_once(code: int) -> NoReturn:
    """End an interrupted process without the interpreter's last steps.

    They could be interrupted again, and where code made at run time was interrupted the interpreter
    would end by the signal and not with the code.
    """
    for stream in (sys.stdout, sys.stderr):
        with suppress(OSError, ValueError):  # closed or full
            stream.flush()
    os._exit(code)


def collect_output() -> None:
    """Put a buffer before stdout where PYTHONUNBUFFERED has taken it away.

    Without one Python drops what the system did not take at once, so that a result on a full disk
    would end early and nobody would say so.
    """
    if isinstance(getattr(sys.stdout, "buffer", None), io.RawIOBase):
        encoding, lines = sys.stdout.encoding, sys.stdout.isatty()
        buffer = os.fdopen(sys.stdout.fileno(), "wb", closefd=False)
        sys.stdout = io.TextIOWrapper(buffer, encoding, line_buffering=lines)


def say(message: str) -> None:
    """Print one message on stderr."""
    click.echo(f"softid: {message}", err=True)


@contextmanager
def progress(*, quiet: bool) -> Iterator[ProgressCallback | None]:
    """Show how far the work is, once it takes longer than a second.

    Yields a function of stage and fraction done, or None when the user wants quiet. On a terminal
    it moves a bar, elsewhere it prints a line for each new stage.
    """
    if quiet:
        yield None
        return
    shown: _Bar | _Lines = _Bar() if sys.stderr.isatty() else _Lines()
    timer = threading.Timer(PATIENCE_S, shown.show)
    timer.daemon = True
    timer.start()
    try:
        yield shown.update
    finally:
        timer.cancel()
        shown.close()


class _Lines:
    """Progress for a file or a pipe: a line per stage, and per tenth of the work within one."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._told = ("", 0.0)
        self._visible = False

    def show(self) -> None:
        with self._lock:
            self._visible = True
            if self._told[0]:
                self._tell()

    def update(self, stage: str, fraction: float) -> None:
        with self._lock:
            known, done = self._told
            if stage == known and fraction < done + _LEAST_NEWS:
                return
            self._told = (stage, max(fraction, done))  # a stage that comes again undoes nothing
            if self._visible:
                self._tell()

    def _tell(self) -> None:
        stage, done = self._told
        say(f"{stage}, {100.0 * done:.0f} % …")

    def close(self) -> None:
        with self._lock:
            self._visible = False


class _Bar:
    """Progress for a terminal: a bar that disappears when the work is done."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._bar: Progress | None = None
        self._task: TaskID | None = None
        self._last = ("working", 0.0)
        self._closed = False

    def show(self) -> None:
        from rich.console import Console
        from rich.progress import Progress

        with self._lock:
            if self._closed:
                return
            self._bar = Progress(console=Console(stderr=True), transient=True)
            self._task = self._bar.add_task(
                self._last[0], total=_BAR_STEPS, completed=_steps(self._last[1])
            )
            self._bar.start()

    def update(self, stage: str, fraction: float) -> None:
        with self._lock:
            self._last = (stage, fraction)
            if self._bar is not None and self._task is not None:
                self._bar.update(self._task, description=stage, completed=_steps(fraction))

    def close(self) -> None:
        with self._lock:
            self._closed = True
            if self._bar is not None:
                self._bar.stop()


def _steps(fraction: float) -> int:
    return round(fraction * _BAR_STEPS)


@contextmanager
def announce_compilation(*, quiet: bool) -> Iterator[None]:
    """Say when a run compiles, for it takes far longer than any later one."""
    if quiet:
        yield
        return
    from softid.kernels import cache_folder, when_compiling

    kept = cache_folder() is not None
    with when_compiling(lambda: say(COMPILING if kept else COMPILING_IN_VAIN)):
        yield


def report_failure(error: BaseException, *, debug: bool) -> int:
    """Print one line about an error and return the exit code.

    Parameters
    ----------
    error
        Anything that ended a command.
    debug
        Whether to print the traceback first.
    """
    if debug:
        traceback.print_exception(error)
    sentence, code = _told(error)
    _settle_stdout()
    if sentence:
        with suppress(OSError):  # stderr may be as closed or full as stdout
            click.echo(f"softid: {sentence}", err=True)
    return code


def _told(error: BaseException) -> tuple[str, int]:
    if isinstance(error, SoftidError):
        return f"error: {_one_line(str(error))}", error.exit_code
    if isinstance(error, NoCommandError):
        return f"no command was given\n{error.format_message()}", error.exit_code
    if isinstance(error, click.UsageError):
        path = error.ctx.command_path if error.ctx else "softid"
        message = _SUGGESTION.sub(r" (did you mean \1?)", _one_line(error.format_message()))
        message = message.replace(". (Did", " (did").rstrip(".")
        return f"error: {lowered(message)}; see `{path} --help`.", error.exit_code
    if isinstance(error, click.ClickException):
        return f"error: {lowered(_one_line(error.format_message()))}", error.exit_code
    if isinstance(error, KeyboardInterrupt | click.Abort):
        return f"interrupted: {error}." if str(error) else "interrupted.", INTERRUPTED
    if isinstance(error, BrokenPipeError):
        return "", BROKEN_PIPE
    if isinstance(error, MemoryError):
        return "error: there is not enough memory; use a shorter log.", BAD_OUTPUT
    if isinstance(error, OSError):
        return f"error: {_os_sentence(error)}", BAD_OUTPUT
    return (
        f"error: this is a fault of softid, not of your input ({_where(error)}: "
        f"{type(error).__name__}: {_one_line(str(error))}); please report what "
        "`softid --debug …` prints.",
        UNEXPECTED,
    )


def _os_sentence(error: OSError) -> str:
    place = error.filename if error.filename is not None else "standard output"
    reason = (error.strerror or str(error)).lower()
    full = error.errno in (errno.ENOSPC, errno.EDQUOT)
    remedy = "free some space" if full else "check the path and its permissions"
    return f"{place}: {reason}; {remedy}."


def _where(error: BaseException) -> str:
    frames = traceback.extract_tb(error.__traceback__)
    ours = [f for f in frames if "softid" in f.filename]
    last = (ours or list(frames))[-1:]
    return f"{os.path.basename(last[0].filename)}, line {last[0].lineno}" if last else "nowhere"


def _one_line(text: str) -> str:
    return " ".join(text.split())


def _settle_stdout() -> None:
    """Flush stdout; where that fails, point it elsewhere lest the interpreter's flush fail too."""
    try:
        sys.stdout.flush()
        return
    except OSError:
        pass
    with suppress(OSError, ValueError):
        devnull = os.open(os.devnull, os.O_WRONLY)
        os.dup2(devnull, sys.stdout.fileno())
        os.close(devnull)
