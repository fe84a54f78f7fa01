"""Findings turned into sentences with a severity and a remedy."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence

from softid.errors import Issue, Severity
from softid.excitation import Stretch
from softid.quality.findings import ChannelReport, Gap, Role, Sampling, SignCheck

ORDER: dict[Severity, int] = {"error": 0, "warning": 1, "info": 2}
MUCH_JITTER = 0.2
MANY_CLOSE = 0.02
FEW_BITS = 6.0
VERY_FEW_BITS = 4.0
LITTLE_SIGNAL = 20.0
NAMED = 4
INTERMITTENT = 3
WATCHED: tuple[Role, ...] = ("input", "output", "command")


def list_issues(
    sampling: Sampling,
    channels: Sequence[ChannelReport],
    signs: Sequence[SignCheck],
    excitation: Sequence[Stretch],
    *,
    from_reader: Sequence[Issue] = (),
) -> tuple[Issue, ...]:
    """All issues of a log, most severe first.

    Parameters
    ----------
    sampling, channels, signs, excitation
        Findings.
    from_reader
        Issues that the log already carries; they are kept.
    """
    at_rest = list(_of_input(channels, excitation))
    found = [*from_reader, *at_rest, *_of_sampling(sampling)]
    for channel in channels:
        if channel.role in WATCHED:
            found += _of_channel(channel)
            found += [] if at_rest else _of_size(channel)
    found += [_of_sign(check) for check in signs if check.inverted]
    return tuple(sorted(found, key=lambda issue: ORDER[issue.severity]))


def _of_input(channels: Sequence[ChannelReport], excitation: Sequence[Stretch]) -> Iterator[Issue]:
    if all(s.kind == "rest" for s in excitation):
        name = next((c.name for c in channels if c.role == "input"), "input")
        yield Issue(
            "input-at-rest",
            "warning",
            f"{name} does not move beyond its noise, so this log shows noise and drift only",
            "add a log in which it moves, or choose another --input",
        )


def _of_sampling(sampling: Sampling) -> Iterator[Issue]:
    if sampling.stalls:
        yield Issue(
            "stalls",
            "warning",
            f"{_count(sampling.stalls, 'stall')} longer than {sampling.stall_limit_s:.3g} s "
            f"({_places(sampling.stalls)}) split the log into {sampling.segments} segments",
            "each segment gets its own initial state; find out what blocks the logger",
        )
    if sampling.gaps:
        yield Issue(
            "gaps",
            "info",
            f"{_count(sampling.gaps, 'gap')} of more than three sampling intervals "
            f"({_places(sampling.gaps)})",
            None,
        )
    if sampling.jitter > MUCH_JITTER:
        yield Issue(
            "irregular-sampling",
            "info",
            f"the sampling interval varies by {100 * sampling.jitter:.0f} % about "
            f"{1e3 * sampling.period_s:.3g} ms",
            "nothing to do: the log's own times are used",
        )
    if sampling.close_share > MANY_CLOSE:
        yield Issue(
            "close-samples",
            "info",
            f"{100 * sampling.close_share:.0f} % of the samples follow the one before within a "
            "fifth of the usual interval",
            "check whether two messages are logged as two samples",
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


def _of_dropouts(channel: ChannelReport) -> Iterator[Issue]:
    if not channel.dropouts:
        return
    causes = Counter(d.cause for d in channel.dropouts)
    kinds = ", ".join(f"{count} × {cause}" for cause, count in causes.items())
    places = ", ".join(
        f"{d.start_s:.2f} s" + ("" if d.value is None else f": {_shown(channel, d.value)}")
        for d in channel.dropouts[:NAMED]
    )
    more = ", …" if len(channel.dropouts) > NAMED else ""
    if channel.role == "command":
        yield Issue(
            "command-flicker",
            "info",
            f"{channel.name} flickers for a few samples at "
            f"{_count(channel.dropouts, 'place')}: {places}{more}",
            "fit with the measured pressure as input",
        )
        return
    remedy = "leave these samples out of the fit"
    if "lost digit" in causes:
        remedy += "; the first digit got lost on the way, so check the serial line"
    count = _count(channel.dropouts, "place")
    yield Issue(
        "drop-outs",
        "warning",
        f"{channel.name} drops out at {count} ({kinds}): {places}{more}",
        remedy,
    )


def _of_faults(channel: ChannelReport) -> Iterator[Issue]:
    yield from _of_frozen(channel)
    for flat in channel.saturation:
        yield Issue(
            "saturation",
            "warning",
            f"{channel.name} saturates at {_shown(channel, flat.value)} "
            f"({100 * flat.share:.2g} % of the samples, {flat.times} × from "
            f"{flat.first_s:.2f} s, at most {flat.longest_s:.2f} s)",
            "use a sensor or an amplifier with more range, or leave these samples out",
        )
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
    for frozen in channel.frozen:
        why = "its noise vanishes" if frozen.reason == "noise vanishes" else "the input moves"
        yield Issue(
            "frozen-channel",
            "warning",
            f"{channel.name} is stuck at {_shown(channel, frozen.value)} for "
            f"{frozen.length_s:.2f} s from {frozen.start_s:.2f} s, while {why}",
            "check the sensor; leave the stretch out if the value is stale",
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


def _of_sign(check: SignCheck) -> Issue:
    return Issue(
        "inverted-sign",
        "warning",
        f"{check.output} goes against the input (correlation {check.correlation:.2f} at a lag of "
        f"{check.lag_s:.2g} s)",
        "turn the sign of the channel if that is not how the sensor is mounted",
    )


def _shown(channel: ChannelReport, value: float | None) -> str:
    if value is None:
        return "no value"
    unit = "" if channel.display_unit == "1" else f" {channel.display_unit}"
    return f"{value * channel.display_factor:.4g}{unit}"


def _count(things: Sequence[object], noun: str) -> str:
    return f"{len(things)} {noun}" + ("" if len(things) == 1 else "s")


def _places(gaps: Sequence[Gap]) -> str:
    named = ", ".join(f"{g.length_s:.2f} s at {g.start_s:.2f} s" for g in gaps[:NAMED])
    return named + (", …" if len(gaps) > NAMED else "")
