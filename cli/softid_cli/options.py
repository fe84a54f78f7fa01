"""Options that several commands share, and the loading of logs as those options say."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, ParamSpec, TypeVar, cast

import click

from softid.errors import UsageError

if TYPE_CHECKING:
    from softid.intersample import Intersample
    from softid.log import Log

P = ParamSpec("P")
R = TypeVar("R")
Names = TypeVar("Names", str | None, tuple[str, ...])


class FilePath(click.Path):
    """A path that the library, not click, finds wanting: its errors name the remedy."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """Refuse the empty name, which would mean the folder in which one is."""
        if value == "":
            raise UsageError(
                "the name of a file is empty",
                where=param.opts[0] if isinstance(param, click.Option) else None,
                value=value,
                remedy="name a file; an unset variable of the shell makes such a name",
            )
        return super().convert(value, param, ctx)


def length_mm(_: click.Context, param: click.Parameter, value: str | None) -> float | None:
    """Turn an option's text into a length in mm, which is positive and finite."""
    if value is None:
        return None
    try:
        length = float(value)
    except ValueError:
        length = math.nan
    if not 0.0 < length < math.inf:
        raise UsageError(
            "this is not a length",
            where=param.opts[0],
            value=value,
            remedy="measure it on the actuator and give it in mm",
        )
    return length


def number(text: str, *, where: str) -> float:
    """A finite number.

    Parameters
    ----------
    text
        What the user wrote.
    where
        The option, for the error.

    Raises
    ------
    UsageError
        It is none.
    """
    from softid.readers.decoding import with_plain_minus

    try:
        value = float(with_plain_minus(text))
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise UsageError(
            "this is not a number", where=where, value=text, remedy="write it as 0.5 or 5e-1"
        )
    return value


def channel_names(_: click.Context, param: click.Parameter, value: Names) -> Names:
    """Refuse the empty name, which an unset variable of the shell makes."""
    if "" in ((value,) if isinstance(value, str) else value or ()):
        raise UsageError(
            "the name of a channel is empty",
            where=param.opts[0],
            value="",
            remedy="name a channel, or leave the option out",
        )
    return value


FILE = FilePath(path_type=Path, readable=False)


class GreedyCommand(click.Command):
    """A command some of whose options take all values up to the next option.

    ``--hold-out a.csv b.csv``, or ``--hold-out=a.csv b.csv``, then means what the shell's
    ``--hold-out held/*.csv`` needs.
    """

    def __init__(self, *args: Any, greedy: tuple[str, ...] = (), **attributes: Any) -> None:
        super().__init__(*args, **attributes)
        self._greedy = greedy

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Repeat a greedy option before each of its values, as click knows it."""
        spread: list[str] = []
        option: str | None = None
        for position, arg in enumerate(args):
            if arg == "--":
                spread += args[position:]
                break
            if arg in self._greedy:
                option = arg
                if all(following.startswith("-") for following in args[position + 1 :][:1]):
                    raise click.BadOptionUsage(arg, f"{arg} needs at least one value", ctx)
            elif arg.startswith("-"):
                name, equals, _ = arg.partition("=")
                option = name if equals and name in self._greedy else None
                spread.append(arg)
            else:
                spread += [option, arg] if option else [arg]
        return super().parse_args(ctx, spread)


def logs_argument(command: Callable[P, R]) -> Callable[P, R]:
    """Add the argument ``LOG...`` (keyword: logs)."""
    return click.argument("logs", nargs=-1, type=FILE, metavar="LOG...")(command)


def hold_out_option(logs: str) -> Callable[[Callable[P, R]], Callable[P, R]]:
    """Add ``--hold-out`` of a `GreedyCommand` (keyword: hold_out); ``logs`` says what they do."""
    return click.option(
        "--hold-out",
        multiple=True,
        type=FILE,
        metavar="LOG...",
        help=f"{logs}. Takes every file up to the next option, so name the logs to fit first.",
    )


def channel_option(command: Callable[P, R]) -> Callable[P, R]:
    """Add ``--channel`` (keyword: channel)."""
    return click.option(
        "--channel",
        multiple=True,
        metavar="NAME=COL:UNIT",
        help="Take channel NAME from column COL, a name or a number from 1; a minus before the "
        "unit (angle=3:-deg) turns the sign; may be repeated.",
    )(command)


def log_options(command: Callable[P, R]) -> Callable[P, R]:
    """Add ``--channel``, ``--input`` and ``--output`` (keywords: channel, input, output)."""
    command = click.option(
        "--output",
        multiple=True,
        callback=channel_names,
        metavar="CH",
        help="Output channel, such as angle; may be repeated.",
    )(command)
    command = click.option(
        "--input",
        callback=channel_names,
        metavar="CH",
        help="Input channel, such as pressure_command.",
    )(command)
    return channel_option(command)


def intersample_option(command: Callable[P, R]) -> Callable[P, R]:
    """Add ``--intersample`` (keyword: intersample)."""
    return click.option(
        "--intersample",
        type=click.Choice(("straight", "smooth", "held", "zoh")),
        help="What the input does between samples: straight, smooth (a cubic where it bends), held "
        "where it jumps, or held at every sample (zero-order hold); without it, what fits better.",
    )(command)


def seed_option(command: Callable[P, R]) -> Callable[P, R]:
    """Add ``--seed`` (keyword: seed)."""
    return click.option(
        "--seed",
        type=click.IntRange(min=0),
        default=0,
        show_default=True,
        metavar="N",
        help="Random seed.",
    )(command)


def no_plots_option(written: str) -> Callable[[Callable[P, R]], Callable[P, R]]:
    """Add ``--no-plots`` (keyword: no_plots); ``written`` says what is left of the results."""
    return click.option("--no-plots", is_flag=True, help=f"Write {written} only.")


def quiet_option(command: Callable[P, R]) -> Callable[P, R]:
    """Add ``--quiet`` (keyword: quiet)."""
    return click.option(
        "--quiet", is_flag=True, help="No progress and no messages on stderr but errors."
    )(command)


def json_option(command: Callable[P, R]) -> Callable[P, R]:
    """Add ``--json`` (keyword: as_json)."""
    return click.option(
        "--json", "as_json", is_flag=True, help="Print JSON instead of tables on stdout."
    )(command)


def out_options(
    written: str = "Folder for the results.",
) -> Callable[[Callable[P, R]], Callable[P, R]]:
    """Add ``--out`` and ``--force`` (keywords: out, force); ``written`` says what ``--out`` is."""

    def adding(command: Callable[P, R]) -> Callable[P, R]:
        force = click.option(
            "--force", is_flag=True, help="Replace results that are there already."
        )
        return click.option("--out", type=FILE, metavar="DIR", help=written)(force(command))

    return adding


def named_if(given: Mapping[str, object]) -> tuple[str, ...]:
    """Names of the options that were given, for an error about no others.

    Examples
    --------
    >>> named_if({"--out": False, "--channel": ("angle=2:deg",)})
    ('--channel',)
    """
    return tuple(name for name, value in given.items() if value)


def split_assignment(text: str, *, option: str, form: str) -> tuple[str, str]:
    """Split ``NAME=REST``.

    Raises
    ------
    UsageError
        There is no ``=``, or nothing on one side of it.
    """
    name, equals, rest = text.partition("=")
    if not equals or not name.strip() or not rest.strip():
        raise UsageError(
            f"this is not of the form {form}",
            where=option,
            value=text,
            remedy=f"write {option} {form}",
        )
    return name.strip(), rest.strip()


def assignments(texts: Sequence[str], *, option: str, form: str) -> dict[str, str]:
    """Turn a repeated ``NAME=REST`` option into a mapping.

    Raises
    ------
    UsageError
        A text is malformed or a name is given twice.
    """
    found: dict[str, str] = {}
    for text in texts:
        name, rest = split_assignment(text, option=option, form=form)
        if name in found:
            raise UsageError(
                f"{name} is given twice", where=option, remedy=f"give {option} once per name"
            )
        found[name] = rest
    return found


def load_logs(
    paths: Sequence[Path],
    channel: Sequence[str],
    input: str | None,
    output: Sequence[str],
    *,
    roles_of: Path | None = None,
    intersample: str | None = None,
) -> list[Log]:
    """Read logs with the channels and roles of the command line.

    Logs of equal file name from different folders get the folder into their name.

    Parameters
    ----------
    paths
        Files, in the order given.
    channel
        ``NAME=COL:UNIT`` texts.
    input, output
        Roles, or None and empty for those that the reader chooses.
    roles_of
        The params.json whose roles they are; None when the user gave them.
    intersample
        What the input does between samples, or None to let the fit decide.

    Raises
    ------
    UsageError
        A malformed option, or the same file twice.
    InputError
        A file cannot be read.
    """
    columns = assignments(channel, option="--channel", form="NAME=COL:UNIT")
    _refuse_repeated(paths)

    from softid.readers import load  # numpy and the readers, not wanted by `softid --help`

    logs = [
        load(
            path,
            channels=columns or None,
            input=input,
            outputs=tuple(output),
            roles_of=f"the model {roles_of}" if roles_of else None,
        )
        for path in paths
    ]
    if intersample is not None:
        declared = cast("Intersample", intersample)  # one of the option's choices
        logs = [replace(log, intersample=declared) for log in logs]
    names = [log.name for log in logs]
    return [
        replace(log, name=f"{path.resolve().parent.name}/{log.name}")
        if names.count(log.name) > 1
        else log
        for path, log in zip(paths, logs, strict=True)
    ]


def _refuse_repeated(paths: Sequence[Path]) -> None:
    seen: set[Path] = set()
    for path in paths:
        real = path.resolve()
        if real in seen:
            raise UsageError("the log is given twice", where=str(path), remedy="give it once")
        seen.add(real)
