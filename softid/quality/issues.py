"""Findings turned into sentences with a severity and a remedy."""

from __future__ import annotations

import shlex
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence

from softid.errors import Issue, Severity
from softid.excitation import Stretch
from softid.quality.findings import ChannelReport, Dropout, Role, SignCheck
from softid.quality.holding import Hold
from softid.quality.sampling import Sampling
from softid.quality.sampling_issues import sampling_issues
from softid.quality.second_inputs import second_input_issues
from softid.quality.two_recorders import beside_two_recorders
from softid.quality.wording import NAMED, count, first_names
from softid.units import CHANNEL_QUANTITY

SEVERITY_ORDER: dict[Severity, int] = {"error": 0, "warning": 1, "info": 2}

FEW_BITS = 6.0
"""Bits below which a grid is told: 64 levels, whose rounding is 0.5 % of the range rms."""

VERY_FEW_BITS = 4.0
"""Bits below which a grid of an output is a warning: 16 levels, rounded by 2 % of the range rms."""

LITTLE_SIGNAL = 20.0
"""Range of an output over its noise below which it says little; white noise spans 5 to 8."""

INTERMITTENT = 3
"""Distinct stuck values from which on the noise itself is said to come and go."""

STALE_REMEDY = "leave the stretch out if the value is stale"

TOLD_HERE = ("missing-output",)
"""What a log carries and is told here with more."""

WATCHED: tuple[Role, ...] = ("input", "output", "command")


def list_issues(
    sampling: Sampling,
    channels: Sequence[ChannelReport],
    signs: Sequence[SignCheck],
    excitation: Sequence[Stretch],
    *,
    holds: Mapping[str, Sequence[Hold]] | None = None,
    other_inputs: Sequence[str] = (),
    second_inputs: Sequence[str] = (),
    from_reader: Sequence[Issue] = (),
) -> tuple[Issue, ...]:
    """All issues of a log, most severe first.

    Parameters
    ----------
    sampling, channels, signs, excitation
        Findings.
    holds
        Output → what it does while the input is held.
    other_inputs
        Channels that move like an input.
    second_inputs
        Those that move on their own.
    from_reader
        Issues that the log already carries; kept but for missing samples, which are told here.
    """
    at_rest = list(_of_input(channels, excitation))
    read = [issue for issue in from_reader if issue.code not in TOLD_HERE]
    found = [*read, *at_rest, *sampling_issues(sampling)]
    if not at_rest:
        driving = next(c.name for c in channels if c.role == "input")
        found += second_input_issues(second_inputs, driving)
        found += _of_other_inputs([n for n in other_inputs if n not in second_inputs])
        for name, held in (holds or {}).items():
            found += _of_holds(next(c for c in channels if c.name == name), held)
    for channel in channels:
        if channel.role in WATCHED:
            found += _of_channel(channel)
            found += [] if at_rest else _of_size(channel)
        elif channel.dead and channel.name in CHANNEL_QUANTITY:
            found.append(_of_dead_neighbour(channel))
    by_name = {channel.name: channel for channel in channels}
    found += [_of_sign(check, by_name[check.output]) for check in signs if check.inverted]
    return beside_two_recorders(sorted(found, key=lambda issue: SEVERITY_ORDER[issue.severity]))


def _of_input(channels: Sequence[ChannelReport], excitation: Sequence[Stretch]) -> Iterator[Issue]:
    if all(s.kind == "rest" for s in excitation):
        name = next((c.name for c in channels if c.role == "input"), "input")
        yield Issue(
            "input-at-rest",
            "warning",
            f"{name} does not move beyond its noise, so this log shows noise and drift only",
            "add a log in which it moves, or choose another --input",
        )


def _of_channel(channel: ChannelReport) -> Iterator[Issue]:
    if channel.dead and channel.role != "command":
        if channel.role == "output":
            yield Issue(
                "dead-channel",
                "error",
                f"{channel.name} is constant at {_shown(channel, channel.low)} throughout",
                "check the sensor and its wiring, or choose another --output",
            )
        return
    yield from _of_dropouts(channel)
    yield from _of_faults(channel)
    yield from _of_texture(channel)


def _of_dead_neighbour(channel: ChannelReport) -> Issue:
    return Issue(
        "dead-channel",
        "info",
        f"{channel.name} is constant at {_shown(channel, channel.low)} throughout",
        "check the sensor and its wiring, if it was to move",
    )


def _of_dropouts(channel: ChannelReport) -> Iterator[Issue]:
    missing = [d for d in channel.dropouts if d.cause == "missing"]
    if missing:
        yield Issue(
            "missing-samples",
            "warning",
            f"{channel.name} is missing in {count(range(channel.missing), 'sample')} at "
            f"{count(missing, 'place')}: {_drops(channel, missing)}",
            "nothing: these samples are left out of the residuals",
        )
    wrong = [d for d in channel.dropouts if d.cause != "missing"]
    if not wrong:
        return
    if channel.role == "command":
        yield Issue(
            "command-flicker",
            "info",
            f"{channel.name} flickers for a few samples at "
            f"{count(wrong, 'place')}: {_drops(channel, wrong)}",
            "fit with the measured pressure as input",
        )
        return
    causes = Counter(d.cause for d in wrong)
    kinds = ", ".join(f"{count} × {cause}" for cause, count in causes.items())
    remedy = "leave these samples out of the fit"
    if "lost digit" in causes:
        remedy += "; the first digit got lost on the way, so check the serial line"
    yield Issue(
        "drop-outs",
        "warning",
        f"{channel.name} drops out at {count(wrong, 'place')} ({kinds}): {_drops(channel, wrong)}",
        remedy,
    )


def _drops(channel: ChannelReport, dropouts: Sequence[Dropout]) -> str:
    places = ", ".join(
        f"{d.start_s:.2f} s" + ("" if d.value is None else f": {_shown(channel, d.value)}")
        for d in dropouts[:NAMED]
    )
    return places + (", …" if len(dropouts) > NAMED else "")


def _of_holds(channel: ChannelReport, holds: Sequence[Hold]) -> Iterator[Issue]:
    for first in (h for h in holds if h.at_start is not None and h.unexplained is None):
        yield Issue(
            "moving-at-start",
            "info",
            f"{channel.name} moves by {_shown(channel, first.at_start)} before the input does "
            f"({first.start_s:.2f} to {first.stop_s:.2f} s)",
            "it does not start at rest; if that is not left over from before, something else "
            "drives it",
        )
    moving = [h for h in holds if h.unexplained is not None]
    if not moving:
        return
    most = max(h.unexplained or 0.0 for h in moving)
    places = ", ".join(f"{h.start_s:.2f} to {h.stop_s:.2f} s" for h in moving[:NAMED])
    more = ", …" if len(moving) > NAMED else ""
    others = list(dict.fromkeys(name for h in moving for name in h.moving))
    if others:
        remedy = f"{first_names(others)} move meanwhile, and a model of one input cannot know that"
    elif channel.name == "pressure":
        remedy = "hold longer, so that it settles"
    else:
        remedy = (
            "hold longer if it is still on its way; or find what else drives it: a controller, "
            "a second chamber, a load, or a drive without a spring"
        )
    yield Issue(
        "moves-by-itself",
        "warning",
        f"{channel.name} moves by up to {_shown(channel, most)} while the input is held "
        f"({places}{more})",
        remedy,
    )


def _of_other_inputs(names: Sequence[str]) -> Iterator[Issue]:
    if names:
        yield Issue(
            "other-inputs",
            "info",
            f"{count(names, 'other channel')} of the input's unit, {first_names(names)}, "
            f"move{'s' if len(names) == 1 else ''} at least a quarter as far as the input",
            "if they drive the actuator too, fit only logs in which they move alike",
        )


def list_stuck(channel: ChannelReport) -> list[Issue]:
    """Issues of a channel that does not follow what it measures.

    Parameters
    ----------
    channel
        What was found of it.
    """
    return [*_of_frozen(channel), *_of_saturation(channel)]


def _of_faults(channel: ChannelReport) -> Iterator[Issue]:
    yield from list_stuck(channel)
    if channel.hold is not None:
        answering = channel.role == "output"
        yield Issue(
            "zero-order-hold",
            "warning" if answering else "info",
            f"{channel.name} holds each value for about {channel.hold.factor:.1f} samples: it "
            f"brings {channel.hold.rate_hz:.3g} new values per second",
            "repeated samples carry no news and lag by half a hold: log at the sensor's own rate"
            if answering
            else None,
        )


def _of_saturation(channel: ChannelReport) -> Iterator[Issue]:
    for flat in channel.saturation:
        yield Issue(
            "saturation",
            "warning",
            f"{channel.name} saturates at {_shown(channel, flat.value)} "
            f"({100 * flat.share:.2g} % of the samples, in runs of up to {flat.longest_s:.2f} s, "
            f"the first of them at {flat.first_s:.2f} s)",
            "use a sensor or an amplifier with more range, or leave these samples out",
        )


def _of_frozen(channel: ChannelReport) -> Iterator[Issue]:
    if len({f.value for f in channel.frozen if f.reason == "noise vanishes"}) >= INTERMITTENT:
        yield Issue(
            "intermittent-noise",
            "info",
            f"the noise of {channel.name} comes and goes: on {len(channel.frozen)} stretches it "
            "repeats one value",
            "find out what makes the noise, such as a running pump; its size is not constant",
        )
        return
    for reason in dict.fromkeys(f.reason for f in channel.frozen):
        first, *later = [f for f in channel.frozen if f.reason == reason]
        again = f", and {len(later)} × later" if later else ""
        remedy = "a fit leaves what is stale out" if reason == "stale" else STALE_REMEDY
        yield Issue(
            "frozen-channel",
            "warning",
            f"{channel.name} is stuck at {_shown(channel, first.value)} for {first.length_s:.2f} s "
            f"from {first.start_s:.2f} s{again}, while {first.meanwhile}",
            f"check the sensor; {remedy}",
        )


def _of_texture(channel: ChannelReport) -> Iterator[Issue]:
    grid = channel.quantisation
    if grid is not None and grid.bits < FEW_BITS and channel.role != "command":
        yield Issue(
            "coarse-quantisation",
            "warning" if channel.role == "output" and grid.bits < VERY_FEW_BITS else "info",
            f"{channel.name} is quantised in steps of {_shown(channel, grid.step)}: "
            f"{grid.levels} levels in this log",
            None,
        )
    if channel.dead_band is not None:
        yield Issue(
            "dead-band",
            "warning" if channel.role == "output" else "info",
            f"{channel.name} moves in jumps of about {_shown(channel, channel.dead_band)} and "
            "stands still between them",
            "expect residuals of that size; use a finer converter or undo the filter that does it",
        )
    if channel.hum is not None:
        known = f", which is mains at {channel.hum.mains_hz:g} Hz" if channel.hum.mains_hz else ""
        yield Issue(
            "hum",
            "info",
            f"{channel.name} holds a line at {channel.hum.frequency_hz:.2f} Hz of amplitude "
            f"{_shown(channel, channel.hum.amplitude)}{known}",
            "shield the sensor's cable, or filter before sampling"
            if channel.hum.mains_hz
            else "look for what swings at this frequency: pump, controller or structure",
        )


def _of_size(channel: ChannelReport) -> Iterator[Issue]:
    noise = channel.noise_std or 0.0
    span = (channel.high or 0.0) - (channel.low or 0.0)
    if channel.role == "output" and span < LITTLE_SIGNAL * noise:
        yield Issue(
            "little-signal",
            "warning",
            f"{channel.name} moves by only {span / noise:.0f} times its noise of "
            f"{_shown(channel, noise)}",
            "use a larger input, or average several repetitions",
        )


def _of_sign(check: SignCheck, channel: ChannelReport) -> Issue:
    """An inverted sign; a length that grows may well be right, and models take it either way."""
    column = channel.column or check.output
    flag = shlex.quote(f"{check.output}={column}:-{channel.display_unit}")
    doubt = (
        "unless the actuator extends" if check.output == "length" else "if the sensor is so mounted"
    )
    return Issue(
        "inverted-sign",
        "warning",
        f"{check.output} goes against the input (correlation {check.correlation:.2f} at a lag of "
        f"{check.lag_s:.2g} s)",
        f"turn its sign with --channel {flag} {doubt}",
    )


def _shown(channel: ChannelReport, value: float | None) -> str:
    if value is None:
        return "no value"
    unit = "" if channel.display_unit == "1" else f" {channel.display_unit}"
    return f"{value * channel.display_factor:.4g}{unit}"
