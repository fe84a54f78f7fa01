"""The inspection of one log: every finding in one record."""

from __future__ import annotations

from dataclasses import replace
from typing import Literal

import numpy as np
import numpy.typing as npt

from softid.arguments import require_explainable
from softid.channels import Channel
from softid.errors import Issue
from softid.excitation import (
    UNRESOLVED_STEPS,
    SettledWindow,
    Stretch,
    excitation_and_holds,
    find_dead_band,
    find_hold,
    find_quantisation,
    noise_std,
    segment_excitation,
)
from softid.log import Log
from softid.quality.abilities import LEVEL_SPACING, Evidence, judge_abilities
from softid.quality.causality import leading_outputs
from softid.quality.dropouts import find_dropouts, may_drop_out
from softid.quality.findings import ChannelReport, CommandLag, Inspection, Role
from softid.quality.gauge_pressure import absolute_pressures, is_vacuum, vacuums
from softid.quality.holding import describe_holds
from softid.quality.hum import find_hum
from softid.quality.issues import list_issues, list_stuck
from softid.quality.relations import check_sign, command_lag, step_response
from softid.quality.sampling import describe_sampling
from softid.quality.second_inputs import independent_inputs, other_inputs, second_input_issues
from softid.quality.stuck import find_frozen, find_saturation, may_be_stuck
from softid.quality.trace import Runs, Trace
from softid.quality.two_recorders import at_output_rows
from softid.quality.wrapped_angles import wrapped_angles

Array = npt.NDArray[np.float64]
BoolArray = npt.NDArray[np.bool_]

MIN_CHANGES = 20
"""Runs of equal values from which a quantised channel is alive and has a grid."""

LEAST_CHANGING = 0.02
"""Runs of equal values, as a share of the samples, from which a quantised channel is alive: a long
record of a command has many runs, too."""

LEAST_REST_SAMPLES = 100
"""Samples at rest from which noise is measured there alone: it is then known to about a tenth. With
fewer, all samples are taken."""


def inspect(log: Log) -> Inspection:
    """Say what is in a log, what is wrong with it, and what can be identified from it.

    Nothing is resampled or changed: all findings refer to the log's own samples and times. Where
    two recorders have rows of their own, those of the outputs count.

    Parameters
    ----------
    log
        The recording.

    Returns
    -------
    Inspection
        Sampling, one report per channel, excitation, what can be identified, and issues.

    Raises
    ------
    UsageError
        What was given is not a log, or has no output.

    Examples
    --------
    >>> time_s = np.arange(1200) * 0.01
    >>> pressure = np.repeat([0.0, 20.0, 40.0, 60.0, 40.0, 20.0], 200)
    >>> angle = 0.5 * pressure + 0.01 * np.sin(1e4 * time_s)
    >>> found = inspect(Log.from_arrays(time_s, {"pressure": pressure, "angle": angle}))
    >>> found.excitation[0].kind, found.ability("static curve").possible
    ('staircase', 'yes')
    """
    log = at_output_rows(require_explainable(log))
    driving = log.channels[log.input].values
    stretches, windows = excitation_and_holds(log.time_s, driving)
    windows = _at_levels(windows, stretches, LEVEL_SPACING * float(np.ptp(driving)))
    rest, sampling = _at_rest(windows, len(log)), describe_sampling(log)
    channels = _reports(log, rest, windows)
    noise = {report.name: report.noise_std for report in channels}
    judged = next((name for name in log.outputs if name != "pressure"), log.outputs[0])
    stuck = next(c.frozen for c in channels if c.role == "input")
    alive = _without_faults(log, channels)
    holds = {name: describe_holds(alive, name, windows, noise[name]) for name in log.outputs}
    responses = (
        step_response(alive, name, windows, noise, holds=holds[name], stuck=stuck)
        for name in log.outputs
    )
    found = tuple(filter(None, responses))
    signs = tuple(filter(None, (check_sign(log, name) for name in log.outputs)))
    lag = command_lag(log)
    evidence = Evidence(
        time_s=log.time_s,
        input_name=log.input,
        input_unit=log.channels[log.input].display_unit,
        shown=log.channels[log.input].display_factor,
        span=float(np.ptp(driving)),
        output_name=judged,
        stretches=stretches,
        windows=windows,
        holds=holds[judged],
        response=next((r for r in found if r.output == judged), None),
        input_stuck=bool(stuck),
        sampling=sampling,
        no_lag=_why_no_lag(log, lag),
    )
    return Inspection(
        log=log.name,
        path=log.source.path if log.source else None,
        file_format=log.source.file_format if log.source else None,
        input=log.input,
        outputs=log.outputs,
        sampling=sampling,
        channels=channels,
        excitation=stretches,
        command_excitation=_command_excitation(log, lag),
        command_lag=lag,
        signs=signs,
        holds=holds[judged],
        responses=found,
        abilities=judge_abilities(evidence),
        issues=list_issues(
            sampling,
            channels,
            () if is_vacuum(log) else signs,  # its own sign is the one to turn
            stretches,
            holds=holds,
            other_inputs=other_inputs(log, judged),
            second_inputs=independent_inputs(log),
            from_reader=(*log.issues, *_misread(log)),
        ),
    )


def dropout_mask(log: Log) -> BoolArray:
    """Samples at which an output drops out or is stale, shape (n,), for `Log.with_masked`.

    Parameters
    ----------
    log
        The recording.
    """
    mask = np.zeros(len(log), bool)
    for name in log.outputs:
        values, is_command = log.channels[name].values, _kind(log, name) == "command"
        drops_out, sticks = may_drop_out(values) or is_command, may_be_stuck(values)
        if not (drops_out or sticks):
            continue
        trace = _trace(log, log.channels[name], None)
        for dropout in find_dropouts(trace) if drops_out else ():
            mask[dropout.start : dropout.stop] = True
        driving = log.channels[log.input].values
        for frozen in find_frozen(trace, driving) if sticks and not is_command else ():
            if frozen.reason == "stale":
                mask[frozen.start : frozen.stop] = True
    return mask


def misleading_channels(log: Log) -> tuple[Issue, ...]:
    """What a fit takes for motion that the input makes, and is not.

    Outputs that saturate, repeat one value, begin again at the end of a turn, or move before the
    input does, a second input, and a pressure that seems to be absolute or is a vacuum.

    Parameters
    ----------
    log
        The recording.
    """
    found: list[Issue] = []
    for name in log.outputs:
        channel = log.channels[name]
        if may_be_stuck(channel.values):
            found += list_stuck(_report(log, channel, "output", None, ()))
    found += second_input_issues(independent_inputs(log), log.input)
    found += _misread(log)
    return tuple(replace(issue, message=f"{log.name}: {issue.message}") for issue in found)


def _misread(log: Log) -> tuple[Issue, ...]:
    """What is told of channels that may not be what they are taken for."""
    return (*wrapped_angles(log), *leading_outputs(log), *absolute_pressures(log), *vacuums(log))


def _without_faults(log: Log, channels: tuple[ChannelReport, ...]) -> Log:
    """The log whose outputs have no value where they drop out or are stale."""
    known = dict(log.channels)
    for report in channels:
        spans = [(dropout.start, dropout.stop) for dropout in report.dropouts]
        spans += [(f.start, f.stop) for f in report.frozen if f.reason == "stale"]
        if report.role != "output" or not spans:
            continue
        values = known[report.name].values.copy()
        for start, stop in spans:
            values[start:stop] = np.nan
        known[report.name] = replace(known[report.name], values=values)
    return replace(log, channels=known)


def _roles(log: Log) -> list[tuple[str, Role]]:
    """Channels with their roles: input, outputs, command, then the others."""
    roles: dict[str, Role] = {log.input: "input", **dict.fromkeys(log.outputs, "output")}
    if "pressure_command" in log.channels:
        roles.setdefault("pressure_command", "command")
    for name in log.channels:
        roles.setdefault(name, "other")
    return list(roles.items())


def _at_rest(windows: tuple[SettledWindow, ...], n: int) -> BoolArray | None:
    rest = np.zeros(n, bool)
    for window in windows:
        rest[window.start : window.stop] = True
    return rest if int(rest.sum()) >= LEAST_REST_SAMPLES else None


def _at_levels(
    windows: tuple[SettledWindow, ...], stretches: tuple[Stretch, ...], near: float
) -> tuple[SettledWindow, ...]:
    """The windows at a level of their stretch, without brief stops on the way to the next one."""
    return tuple(
        w
        for w in windows
        if any(
            s.start <= w.start < s.stop and any(abs(w.level - v) <= near for v in s.levels)
            for s in stretches
        )
    )


def _why_no_lag(log: Log, lag: CommandLag | None) -> str | None:
    if lag is not None:
        return None
    for name, called in (("pressure_command", "commanded"), ("pressure", "measured")):
        if name not in log.channels:
            return f"there is no {called} pressure in the log"
        values = log.channels[name].values
        if float(np.nanmax(values) - np.nanmin(values)) == 0.0:
            return f"the {called} pressure does not move"
    return "the measured pressure does not follow the commanded one"


def _trace(log: Log, channel: Channel, rest: BoolArray | None) -> Trace:
    finite = np.isfinite(channel.values)
    times, values = log.time_s[finite], channel.values[finite]
    grid = find_quantisation(values)
    step = grid.step if grid else None
    hold = find_hold(times, values, step) if values.size > 1 else None
    where = None if rest is None else rest[finite]
    noise = noise_std(times, values, step=step, hold=hold, where=where)
    return Trace(
        log.time_s,
        channel.values,
        grid,
        hold,
        noise,
        channel.display_factor,
        _kind(log, channel.name),
    )


def _noise_bound(trace: Trace) -> float | None:
    """What the noise stays below where the quantisation hides it.

    A channel that hardly ever changes, such as a command, has levels rather than a grid.
    """
    hidden = trace.noise_std is None and trace.quantisation is not None
    changes = Runs.of(trace.values).start.size
    alive = changes >= max(MIN_CHANGES, LEAST_CHANGING * trace.values.size)
    return UNRESOLVED_STEPS * trace.step if hidden and alive else None


def _kind(log: Log, name: str) -> Literal["command", "input", "output"]:
    if name == "pressure_command":
        return "command"
    return "input" if name == log.input else "output"


def _reports(
    log: Log, rest: BoolArray | None, windows: tuple[SettledWindow, ...]
) -> tuple[ChannelReport, ...]:
    return tuple(
        _report(log, log.channels[name], role, rest, windows) for name, role in _roles(log)
    )


def _report(
    log: Log,
    channel: Channel,
    role: Role,
    rest: BoolArray | None,
    windows: tuple[SettledWindow, ...],
) -> ChannelReport:
    trace = _trace(log, channel, rest)
    finite = np.isfinite(channel.values)
    values = channel.values[finite]
    dead = bool(values.size) and float(np.ptp(values)) == 0.0
    watched = role != "other" and not dead
    driving = log.channels[log.input].values if role == "output" else None
    measured = watched and role != "command"
    whole = bool(finite.all())
    dead_band = None
    if watched and values.size > 1:
        dead_band = find_dead_band(log.time_s[finite], values, trace.step or None)
    return ChannelReport(
        name=channel.name,
        role=role,
        column=channel.column,
        unit=channel.unit,
        display_unit=channel.display_unit,
        display_factor=channel.display_factor,
        low=float(values.min()) if values.size else None,
        high=float(values.max()) if values.size else None,
        missing=int((~finite).sum()),
        dead=dead,
        quantisation=trace.quantisation,
        hold=trace.hold,
        dead_band=dead_band,
        noise_std=trace.noise_std,
        noise_below=_noise_bound(trace) if dead_band is None else None,
        hum=find_hum(log.time_s, values, windows, trace.noise_std)
        if measured and whole and trace.hold is None
        else None,
        dropouts=find_dropouts(trace) if watched else (),
        frozen=find_frozen(trace, driving) if measured else (),
        saturation=find_saturation(trace) if measured else (),
    )


def _command_excitation(log: Log, lag: CommandLag | None) -> tuple[Stretch, ...] | None:
    if lag is None or log.input == "pressure_command":
        return None
    command = log.channels["pressure_command"].values
    if not np.isfinite(command).all():
        return None
    return segment_excitation(log.time_s, command)
