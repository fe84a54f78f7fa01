"""`softid inspect`: what is in a log, what is wrong with it, what it can identify."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

from softid_cli.console import progress
from softid_cli.options import FILE, json_option, load_logs, log_options, quiet_option
from softid_cli.tables import WIDTH, folded, issue_lines, table_of, terminal_width

if TYPE_CHECKING:
    from rich.table import Table

    from softid.excitation import Stretch
    from softid.quality import ChannelReport, Gap, Inspection

SCHEMA = "softid.inspection/1"
MOST_STRETCHES = 12
MOST_OTHERS = 6
NO_JITTER = 1e-6
UNLIKE_RATES = 0.02
LARGE_HZ = 1e4
LARGE_S = 1e3
CHANNEL_COLUMNS = (
    ("channel", "left"),
    ("role", "left"),
    ("column", "left"),
    ("range", "right"),
    ("step", "right"),
    ("noise", "right"),
)
COLUMN_AT = 2
SHORTEST_NAME = 15
"""A channel's name is not shortened to less."""

ENDLESS = 10_000
"""Columns of a terminal on which no table is too wide."""


@click.command()
@click.argument("logs", nargs=-1, required=True, type=FILE, metavar="LOG...")
@log_options
@json_option
@quiet_option
def inspect(
    logs: tuple[Path, ...],
    channel: tuple[str, ...],
    input: str | None,
    output: tuple[str, ...],
    as_json: bool,
    quiet: bool,
) -> None:
    """Report what is in LOGs: sampling, faults, excitation, and what they can identify."""
    from softid.quality import inspect as inspect_log
    from softid.records import dump_json

    loaded = load_logs(logs, channel, input, output)
    inspections = []
    with progress(quiet=quiet) as report:
        for k, log in enumerate(loaded):
            if report is not None:
                report(f"inspecting {log.name}", k / len(loaded))
            inspections.append(inspect_log(log))
    if as_json:
        click.echo(dump_json({"schema": SCHEMA, "logs": inspections}), nl=False)
        return
    width = terminal_width()
    click.echo("\n\n".join(render(found, width=width) for found in inspections))


def render(inspection: Inspection, *, width: int = WIDTH) -> str:
    """An inspection as text.

    Parameters
    ----------
    inspection
        What was found in one log.
    width
        Columns of the terminal.
    """
    blocks: list[str | Table] = [
        f"{inspection.log}: {inspection.input} → {', '.join(inspection.outputs)}",
        folded(_sampling_text(inspection), width),
        "",
        *_channel_table(inspection.channels, width),
        "",
        "Findings" if inspection.issues else "Findings: none",
        *issue_lines(inspection.issues, width),
        "",
        f"Excitation of {inspection.input}",
        *_excitation(inspection),
        "",
        "What this log can identify",
        table_of(
            [("property", "left"), ("", "left"), ("why", "left")],
            [(a.name, a.possible, a.reason) for a in inspection.abilities],
        ),
        *_wanted_lines(inspection, width),
    ]
    return _as_text(blocks, width)


def _sampling_text(inspection: Inspection) -> str:
    from softid.quality.wording import seconds

    s = inspection.sampling
    text = f"{s.n} samples in {s.duration_s:.2f} s, every {seconds(s.period_s)} ({_rate(s.rate_hz)}"
    if abs(s.mean_rate_hz / s.rate_hz - 1.0) > UNLIKE_RATES:
        text += f" by the median, {_rate(s.mean_rate_hz)} on average"
    text += "), "
    text += f"jitter {100 * s.jitter:.2g} %" if s.jitter > NO_JITTER else "no jitter"
    if s.clock_step_s is not None:
        text += f", clock in steps of {seconds(s.clock_step_s)}"
    if not s.gaps and not s.stalls:
        return f"{text}; no gaps, no stalls"
    return f"{text}; {_lengths(s.gaps, 'gap')}; {_lengths(s.stalls, 'stall')}"


def _rate(rate_hz: float) -> str:
    return f"{rate_hz:.4g} Hz" if rate_hz < LARGE_HZ else f"{1e-3 * rate_hz:.4g} kHz"


def _lengths(gaps: Sequence[Gap], noun: str) -> str:
    text = _counted(len(gaps), noun)
    if not gaps:
        return text
    longest_s = max(g.length_s for g in gaps)
    return (
        f"{text} of {longest_s:.2f} s" if len(gaps) == 1 else f"{text} of up to {longest_s:.2f} s"
    )


def _counted(count: int, noun: str) -> str:
    return f"{count or 'no'} {noun}" + ("" if count == 1 else "s")


def _channel_table(channels: Sequence[ChannelReport], width: int) -> list[str | Table]:
    """The table of channels; what a terminal has no room for is told in full below it."""
    others = [c.name for c in channels if c.role == "other"]
    hidden = set(others[MOST_OTHERS:])
    shown = [c for c in channels if c.name not in hidden]
    rows = [_channel_row(c) for c in shown]
    more = [(f"… {len(hidden)} more", "other", "", "", "", "")] if hidden else []
    table = table_of(CHANNEL_COLUMNS, [*rows, *more])
    if _natural_width(table) <= width:
        return [table]

    def narrow(names: Sequence[str]) -> Table:
        named = [(name, *row[1:]) for name, row in zip(names, rows, strict=True)]
        kept = [(*row[:COLUMN_AT], *row[COLUMN_AT + 1 :]) for row in (*named, *more)]
        return table_of([*CHANNEL_COLUMNS[:COLUMN_AT], *CHANNEL_COLUMNS[COLUMN_AT + 1 :]], kept)

    names = [c.name for c in shown]
    room = max(map(len, names)) - (_natural_width(narrow(names)) - width)
    names = [_shortened(name, max(room, SHORTEST_NAME)) for name in names]
    told = [
        f"  {name} is the column {c.column or c.name}"
        for name, c, row in zip(names, shown, rows, strict=True)
        if row[COLUMN_AT] or name != c.name
    ]
    return [narrow(names), *(["", *told] if told else [])]


def _shortened(name: str, room: int) -> str:
    """A name with its middle left out where it needs more than the room there is."""
    if len(name) <= room:
        return name
    tail = (room - 1) // 2
    return f"{name[: room - 1 - tail]}…{name[len(name) - tail :]}"


def _channel_row(c: ChannelReport) -> tuple[str, ...]:
    if c.low is None or c.high is None:
        reach = "empty"
    else:
        low, high = (v * c.display_factor + 0.0 for v in (c.low, c.high))
        reach = f"{low:.3g} … {high:.3g}"
        reach += "" if c.display_unit == "1" else f" {c.display_unit}"
    step = f"{c.quantisation.step * c.display_factor:.3g}" if c.quantisation else "–"
    noise = "–" if c.noise_std is None else f"{c.noise_std * c.display_factor:.2g}"
    if c.noise_below is not None:
        noise = f"< {c.noise_below * c.display_factor:.2g}"
    column = "" if c.column is None or c.column == c.name else c.column
    return (c.name, c.role, column, reach, step, noise)


def _excitation(inspection: Inspection) -> list[str | Table]:
    given = inspection.channel(inspection.input)
    blocks: list[str | Table] = [_stretch_table(inspection.excitation, given)]
    command, lag = inspection.command_excitation, inspection.command_lag
    if command is not None:
        blocks += ["", "Excitation of pressure_command"]
        blocks.append(_stretch_table(command, inspection.channel("pressure_command")))
    if lag is not None:
        period_s = inspection.sampling.period_s
        much = f"roughly {lag.lag_s:.2g} s" if lag.lag_s >= period_s else "less than a sample"
        blocks += ["", f"pressure lags behind pressure_command by {much}"]
    return blocks


def _stretch_table(stretches: Sequence[Stretch], channel: ChannelReport) -> Table:
    shown = stretches[:MOST_STRETCHES]
    rows: list[tuple[str, ...]] = [
        (f"{s.start_s:.2f}", f"{s.stop_s:.2f}", s.shape or s.kind, _stretch_text(s, channel))
        for s in shown
    ]
    if len(stretches) > len(shown):
        rows.append(("", f"{stretches[-1].stop_s:.2f}", "…", f"{len(stretches) - len(shown)} more"))
    columns = [("from s", "right"), ("to s", "right"), ("kind", "left"), ("what", "left")]
    return table_of(columns, rows)


def _stretch_text(s: Stretch, channel: ChannelReport) -> str:
    factor = channel.display_factor
    unit = "" if channel.display_unit == "1" else f" {channel.display_unit}"
    reach = f"{s.low * factor:.4g} to {s.high * factor:.4g}{unit}"
    if s.kind == "rest" and s.levels:
        return f"at {s.levels[0] * factor:.4g}{unit}"
    if s.kind in ("step", "staircase"):
        changes = f"{s.transitions} changes" if s.transitions != 1 else "1 change"
        levels = ", ".join(f"{level * factor:.4g}" for level in s.levels[:6])
        more = ", …" if len(s.levels) > 6 else ""
        return f"{changes}, levels {levels}{more}{unit}, {_held_text(s)}"
    if s.shape == "chirp":
        return f"{s.frequency_hz:.3g} to {s.frequency_end_hz:.3g} Hz, {reach}"
    if s.frequency_hz is not None and s.amplitude is not None and s.offset is not None:
        middle = f"{s.offset * factor:.4g} ± {s.amplitude * factor:.4g}{unit}"
        return f"{s.frequency_hz:.4g} Hz, {middle}, {s.cycles:.1f} cycles"
    if s.rate is not None:
        return f"{reach} at {s.rate * factor:.3g}{unit}/s"
    return reach


def _held_text(s: Stretch) -> str:
    if s.hold_s is None or s.shortest_hold_s is None or s.longest_hold_s is None:
        return "never held"
    shortest, median, longest = (
        f"{h:.3g}" if h < LARGE_S else f"{h:.0f}"
        for h in (s.shortest_hold_s, s.hold_s, s.longest_hold_s)
    )
    if shortest == longest:
        return f"held {median} s"
    return f"held {shortest} to {longest} s, median {median} s"


def _wanted_lines(inspection: Inspection, width: int) -> list[str]:
    wanted: dict[str, list[str]] = {}
    for ability in inspection.abilities:
        if ability.wanted:
            wanted.setdefault(ability.wanted, []).append(ability.name)
    if not wanted:
        return []
    lines = [folded(f"  for {', '.join(names)}: {what}", width) for what, names in wanted.items()]
    return ["", "Logs that would help", *lines]


def _natural_width(table: Table) -> int:
    """Columns that a table takes where no cell is folded."""
    from rich.console import Console
    from rich.measure import Measurement

    console = Console(width=ENDLESS)
    return Measurement.get(console, console.options, table).maximum


def _as_text(blocks: Iterable[str | Table], width: int) -> str:
    from rich.console import Console

    console = Console(width=width, highlight=False, markup=False, emoji=False, color_system=None)
    with console.capture() as captured:
        for block in blocks:
            console.print(block, soft_wrap=isinstance(block, str))
    return "\n".join(line.rstrip() for line in captured.get().rstrip().split("\n"))
