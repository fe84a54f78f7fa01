"""The frame around all commands: start-up cost, help, and every way of ending."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import click
import pytest
from desk import Desk, Outcome

from softid.errors import IdentificationError, InputError, OutputError, UsageError
from softid_cli.console import progress
from softid_cli.main import COMMANDS, LazyGroup
from softid_cli.main import softid as group

Cli = Callable[..., Outcome]
ROOT = Path(__file__).resolve().parents[2]
HEAVY = ("numba", "matplotlib", "pandas", "scipy", "lmfit", "numpy", "rich", "pint", "jsonschema")


def environment() -> dict[str, str]:
    return os.environ | {"PYTHONPATH": f"{ROOT}{os.pathsep}{ROOT / 'cli'}"}


def python(code: str, **options: object) -> subprocess.CompletedProcess[str]:
    return subprocess.run(  # type: ignore[call-overload, no-any-return]
        [sys.executable, "-c", code], env=environment(), text=True, timeout=60, **options
    )


@pytest.mark.parametrize("arguments", [["--help"], ["--version"], ["fit", "--help"]])
def test_help_imports_nothing_heavy(arguments: list[str]) -> None:
    """`--help` should appear at once: the libraries are in sys.modules only if imported."""
    done = python(
        "import sys\n"
        "from softid_cli.main import run\n"
        f"code = run({arguments!r})\n"
        f"print('HEAVY', [m for m in {HEAVY!r} if m in sys.modules])\n"
        "sys.exit(code)",
        capture_output=True,
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines()[-1] == "HEAVY []"


def test_every_command_has_help(softid: Cli) -> None:
    """The table of commands is what exists, and the help line of each is a sentence."""
    told = softid("--help")
    assert told.code == 0
    for name, (_, line) in COMMANDS.items():
        assert f"  {name}" in told.out
        assert line.endswith(".")
        asked = softid(name, "--help")
        assert asked.code == 0
        assert asked.out.startswith(f"Usage: softid {name} ")
        assert max(map(len, asked.out.splitlines())) <= 80


def test_version(softid: Cli) -> None:
    """One line that starts with the program's name."""
    told = softid("--version")
    assert told.code == 0
    assert told.out.startswith("softid")
    assert told.out.count("\n") == 1


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["fti"], "no such command 'fti'"),
        (["--colour"], "no such option '--colour'"),
        ([], "Usage"),
    ],
)
def test_wrong_words(softid: Cli, arguments: list[str], said: str) -> None:
    """Exit code 2, on stderr, nothing on stdout."""
    told = softid(*arguments)
    assert told.code == 2
    assert said in told.err
    assert told.out == ""


@pytest.mark.parametrize(
    ("arguments", "said"), [(["fit", "--bogus"], "--bogus"), ([], "no command was given\nUsage: ")]
)
def test_an_older_click(
    softid: Cli, monkeypatch: pytest.MonkeyPatch, arguments: list[str], said: str
) -> None:
    """click 8.1 has no error for a missing command: it prints the help and succeeds."""
    monkeypatch.delattr(click.exceptions, "NoArgsIsHelpError", raising=False)
    told = softid(*arguments)
    assert (told.code, told.out) == (2, "")
    assert said in told.err


@pytest.mark.parametrize(
    ("error", "code", "said"),
    [
        (UsageError("odd", remedy="do so"), 2, "error: odd; do so."),
        (InputError("odd", where="a.csv", value=3), 3, "error: a.csv: odd (got 3)."),
        (OutputError("odd"), 3, "error: odd."),
        (IdentificationError("odd"), 4, "error: odd."),
        (KeyboardInterrupt(), 130, "interrupted."),
        (click.Abort(), 130, "interrupted."),
        (MemoryError(), 3, "error: there is not enough memory; use a shorter log."),
        (OSError(28, "No space left on device"), 3, "standard output: no space left on device"),
        (PermissionError(13, "Permission denied", "x.csv"), 3, "error: x.csv: permission denied;"),
        (ZeroDivisionError("a\nb"), 70, "a fault of softid, not of your input (fit.py, line"),
    ],
)
def test_every_ending_is_one_line(
    softid: Cli, desk: Desk, error: BaseException, code: int, said: str
) -> None:
    """The codes are those of the README; never a traceback without --debug."""
    desk.answer = error
    told = softid("fit", "step_1.csv")
    assert told.code == code
    assert told.err.startswith("softid: ")
    assert said in told.err
    assert told.err.count("\n") == 1
    assert told.out == ""


def test_debug_shows_the_traceback(softid: Cli, desk: Desk) -> None:
    """What a report of a fault needs."""
    desk.answer = ZeroDivisionError("deep inside")
    told = softid("--debug", "fit", "step_1.csv")
    assert told.code == 70
    assert "Traceback" in told.err
    assert "desk.py" in told.err


LOUD = """
import sys, types, click
from softid_cli.main import COMMANDS, main
sys.modules["loud"] = loud = types.ModuleType("loud")
loud.loud = click.Command("loud", callback=lambda: {}("x" * {}))
COMMANDS["loud"] = ("loud", "Loud.")
sys.argv = ["softid", "loud"]
main()
"""
LOUDNESS = [("click.echo", 10), ("click.echo", 10**6), ("print", 10), ("print", 10**6)]


@pytest.mark.parametrize(("function", "characters"), LOUDNESS)
def test_a_closed_pipe_is_quiet(function: str, characters: int) -> None:
    """`softid … | head` is normal use: the code of SIGPIPE (128 + 13), no message.

    More than a buffer fails in the command, less only when the interpreter flushes.
    """
    read, write = os.pipe()
    os.close(read)
    with os.fdopen(write, "w") as closed:
        done = python(LOUD.format(function, characters), stdout=closed, stderr=subprocess.PIPE)
    assert (done.returncode, done.stderr) == (141, "")


@pytest.mark.parametrize(("function", "characters"), LOUDNESS)
def test_a_full_disk_behind_stdout_is_said(function: str, characters: int) -> None:
    """Linux' /dev/full fails at the flush, after the command itself has ended well."""
    if not Path("/dev/full").exists():
        pytest.skip("no /dev/full on this system")
    with Path("/dev/full").open("w") as full:
        done = python(LOUD.format(function, characters), stdout=full, stderr=subprocess.PIPE)
    assert done.returncode == 3
    assert done.stderr == (
        "softid: error: standard output: no space left on device; free some space.\n"
    )


@pytest.mark.parametrize("unbuffered", ["", "1"])
@pytest.mark.parametrize("function", ["click.echo", "print"])
def test_a_disk_that_fills_up_half_way_is_said(
    tmp_path: Path, function: str, unbuffered: str
) -> None:
    """A limit of the file's size cuts a write short like the last free block of a disk does.

    Containers often set PYTHONUNBUFFERED, with which Python itself passes over a short write.
    """
    resource = pytest.importorskip("resource", reason="no limits on this system")
    code = (
        f"import resource\nresource.setrlimit(resource.RLIMIT_FSIZE, (50_000, 50_000))"
        f"{LOUD.format(function, 10**6)}"
    )
    with (tmp_path / "short.txt").open("w") as short:
        done = subprocess.run(
            [sys.executable, "-c", code],
            env=environment() | {"PYTHONUNBUFFERED": unbuffered},
            stdout=short,
            stderr=subprocess.PIPE,
            text=True,
            timeout=60,
            check=False,
        )
    assert resource is not None
    assert done.returncode == 3
    assert done.stderr.startswith("softid: error: standard output: file too large; ")
    assert done.stderr.count("\n") == 1


def test_a_terminal_without_greek_shows_question_marks() -> None:
    """An ASCII stdout must not end in UnicodeEncodeError."""
    code = (
        "import sys; from softid_cli import main\nmain.run = lambda _: print('θ') or 0\nmain.main()"
    )
    done = subprocess.run(
        [sys.executable, "-c", code],
        env=environment() | {"PYTHONIOENCODING": "ascii"},
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert (done.returncode, done.stdout) == (0, "?\n")


@pytest.fixture
def impatient(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    monkeypatch.setattr("softid_cli.console.PATIENCE_S", 0.01)
    return


@pytest.mark.usefixtures("impatient")
def test_long_work_tells_its_stages(capsys: pytest.CaptureFixture[str]) -> None:
    """Without a terminal: one line a stage, on stderr, also for a stage begun before the wait.

    A stage is told again after another tenth of the work, of which no part is undone.
    """
    import time

    with progress(quiet=False) as report:
        assert report is not None
        report("reading", 0.1)
        time.sleep(0.2)
        report("reading", 0.15)
        report("reading", 0.3)
        report("fitting", 0.5)
        report("reading", 0.1)
    said = [f"softid: {stage} % …" for stage in ("reading, 10", "reading, 30", "fitting, 50")]
    captured = capsys.readouterr()
    assert captured.err.splitlines() == [*said, "softid: reading, 50 % …"]
    assert captured.out == ""


def test_short_work_is_silent(capsys: pytest.CaptureFixture[str]) -> None:
    """Nothing is shown within the first second, and nothing at all when quiet."""
    with progress(quiet=False) as report:
        assert report is not None
        report("fitting", 0.5)
    with progress(quiet=True) as report:
        assert report is None
    assert capsys.readouterr().err == ""


def test_the_group_lists_without_loading() -> None:
    """An unknown name is None to click, which then suggests."""
    context = click.Context(group)
    assert isinstance(group, LazyGroup)
    assert group.get_command(context, "nonsense") is None
    assert group.list_commands(context) == list(COMMANDS)
