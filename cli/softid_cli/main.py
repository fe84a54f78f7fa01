"""The `softid` command: a table of commands, each loaded when it is called."""

from __future__ import annotations

import signal
import sys
import warnings
from collections.abc import Sequence
from importlib import import_module

import click

from softid_cli.console import (
    INTERRUPTED,
    NoCommandError,
    collect_output,
    leave_at_once,
    note_interruption,
    report_failure,
    was_interrupted,
)

COMMANDS: dict[str, tuple[str, str]] = {
    "inspect": (
        "softid_cli.inspect",
        "Report what is in a log and what can be identified from it.",
    ),
    "fit": ("softid_cli.fit", "Identify a model from logs: parameters with errors, plots."),
    "diagnose": (
        "softid_cli.diagnose",
        "Name the cause of a model's misfit and measure the gain.",
    ),
    "validate": (
        "softid_cli.validate",
        "Score a fitted model on other logs, or check softid itself.",
    ),
    "simulate": ("softid_cli.simulate", "Predict the response to the input of a log, as CSV."),
    "synthesize": ("softid_cli.synthesize", "Make logs whose true parameters are known."),
    "models": (
        "softid_cli.models",
        "List the models: equation, parameters, what identifies them.",
    ),
    "effects": (
        "softid_cli.effects",
        "List the physical effects: law, meaning, signature, remedy.",
    ),
    "demo": ("softid_cli.demo", "Fit a bundled synthetic log, to see what comes out."),
    "warmup": ("softid_cli.warmup", "Compile all kernels ahead of the first fit."),
}
"""Command → module that holds the click command of that name, and its line in the help."""


class LazyGroup(click.Group):
    """A group that imports a command's module only to run it or to print its own help."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Refuse to run without any argument."""
        if not args:
            raise NoCommandError(ctx)
        return super().parse_args(ctx, args)

    def list_commands(self, ctx: click.Context) -> list[str]:
        """Names in the order of a user's work, not of the alphabet."""
        del ctx
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """Import the command, or None when there is none of that name."""
        del ctx
        if cmd_name not in COMMANDS:
            return None
        command = getattr(import_module(COMMANDS[cmd_name][0]), cmd_name)
        assert isinstance(command, click.Command)
        return command

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """List the commands from the table, without importing any."""
        del ctx
        with formatter.section("Commands"):
            formatter.write_dl([(name, line) for name, (_, line) in COMMANDS.items()])


def _print_version(ctx: click.Context, _: click.Parameter, wanted: bool) -> None:
    if not wanted or ctx.resilient_parsing:
        return
    from importlib import metadata  # 20 ms, and only the version needs it

    try:
        click.echo(f"softid {metadata.version('softid')}")
    except metadata.PackageNotFoundError:
        click.echo("softid, run from a source tree that is not installed")
    ctx.exit()


@click.group(cls=LazyGroup, context_settings={"help_option_names": ["-h", "--help"]})
@click.option(
    "--version",
    is_flag=True,
    expose_value=False,
    is_eager=True,
    callback=_print_version,
    help="Print the version and exit.",
)
@click.option("--debug", is_flag=True, help="Show the traceback of an error.")
def softid(debug: bool) -> None:
    """Identify models of soft pneumatic actuators from measured logs.

    Results go to stdout, messages and progress to stderr. Exit codes: 0 done, 1 a check failed,
    2 wrong usage, 3 bad input or output, 4 the identification failed.
    """
    if not debug and not sys.warnoptions:
        warnings.simplefilter("ignore")  # numerical remarks of libraries are not for users


def _called(context: click.Context | None) -> click.Context | None:
    """The context of the command that was called, for click names none where a value is missing."""
    name = context.invoked_subcommand if context is not None else None
    command = softid.get_command(context, name) if context is not None and name else None
    return click.Context(command, parent=context, info_name=name) if command else context


def run(arguments: Sequence[str]) -> int:
    """Run the command line and return its exit code; nothing is raised.

    Beside the codes that the help names there are 70, a fault of softid itself, 130, interrupted,
    and 141, when the reader of a pipe went away.

    Parameters
    ----------
    arguments
        What the user typed after ``softid``.
    """
    context: click.Context | None = None
    try:
        try:
            context = softid.make_context("softid", list(arguments))
            with context, warnings.catch_warnings():
                softid.invoke(context)
            code = 0
        except click.exceptions.Exit as ended:
            code = ended.exit_code
        sys.stdout.flush()
    except (Exception, KeyboardInterrupt) as met:  # noqa: BLE001 - the last line of defence
        pressed = was_interrupted() and not isinstance(met, KeyboardInterrupt)
        error = KeyboardInterrupt() if pressed else met
        if isinstance(error, click.UsageError) and error.ctx is None:
            error.ctx = _called(context)
        debug = context is not None and bool(context.params.get("debug"))
        return report_failure(error, debug=debug)
    return code


def main() -> None:
    """Run `softid` with the arguments of the process, and exit.

    An interruption counts even where a library took it for a failure of its own; once all is done
    it comes too late and is not heard.
    """
    collect_output()
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="replace")  # a terminal without θ shows a ?
    try:
        signal.signal(signal.SIGINT, note_interruption)
        code = run(sys.argv[1:])
        signal.signal(signal.SIGINT, signal.SIG_IGN)
    except KeyboardInterrupt as error:  # while the end of the run was reported
        code = report_failure(error, debug=False)
    if code == INTERRUPTED:
        leave_at_once(code)
    sys.exit(code)


if __name__ == "__main__":
    main()
