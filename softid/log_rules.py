"""What times, channels and roles must be to make one recording."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import numpy.typing as npt

from softid.channels import Channel
from softid.errors import InputError, UsageError
from softid.intersample import INTERSAMPLE_CHOICES

Array = npt.NDArray[np.float64]


def require_times(time_s: Array, *, where: str) -> None:
    """Refuse times that do not order the samples.

    Raises
    ------
    InputError
        There are fewer than two, one is not finite, or they do not strictly increase.
    """
    if time_s.size < 2:
        raise InputError(
            "a log needs at least two samples",
            where=where,
            value=int(time_s.size),
            remedy="record the response over time",
        )
    if (time_s[1:] > time_s[:-1]).all() and np.isfinite(time_s[[0, -1]]).all():
        return
    unknown = np.flatnonzero(~np.isfinite(time_s))
    if unknown.size:
        raise InputError(
            "the time is missing or infinite",
            where=f"{where}, sample {int(unknown[0]) + 1}",
            value=float(time_s[unknown[0]]),
            remedy="leave out samples whose time is not known",
        )
    backward = np.flatnonzero(~(np.diff(time_s) > 0))
    raise InputError(
        "the time does not increase",
        where=f"{where}, sample {int(backward[0]) + 2}",
        value=float(time_s[backward[0] + 1]),
        remedy="sort the log or remove the repeated samples",
    )


def require_lengths(channels: Mapping[str, Channel], time_s: Array, *, where: str) -> None:
    """Refuse a channel that has not one sample per time.

    Raises
    ------
    InputError
        There is one.
    """
    for channel in channels.values():
        if channel.values.shape != time_s.shape:
            raise InputError(
                f"the channel has {channel.values.size} samples, the time {time_s.size}",
                where=f"{where}, {channel.name}",
                remedy="give one sample per time",
            )


def require_roles(
    channels: Mapping[str, Channel], input: str, outputs: Sequence[str], *, where: str
) -> None:
    """Refuse an input or outputs that the channels cannot be.

    Raises
    ------
    UsageError
        A role names a channel that is not there, or two of them the same one.
    InputError
        Samples of the input are missing.
    """
    for role in (input, *outputs):
        if role not in channels:
            raise UsageError(
                f"the log has no channel {role}",
                where=where,
                remedy=f"choose from {', '.join(channels)}, or add it to the channels",
            )
    if input in outputs:
        raise UsageError(
            f"{input} cannot be input and output at once",
            where=where,
            remedy="choose another --output (outputs= in Python)",
        )
    for k, name in enumerate(outputs):
        if name in outputs[:k]:
            raise UsageError(
                f"{name} is an output twice", where=where, remedy="name each output once"
            )
    there = np.isfinite(channels[input].values)
    if not there.all():
        missing = np.flatnonzero(~there)
        raise InputError(
            f"the input {input} has {missing.size} missing samples",
            where=f"{where}, sample {int(missing[0]) + 1}",
            remedy="drop those samples",
        )


def require_intersample(intersample: str | None, *, where: str) -> None:
    """Refuse what no input does between its samples.

    Raises
    ------
    UsageError
        It is none of the known behaviours.
    """
    if intersample is not None and intersample not in INTERSAMPLE_CHOICES:
        raise UsageError(
            "there is no such intersample behaviour",
            where=where,
            value=intersample,
            remedy=f"choose from {', '.join(INTERSAMPLE_CHOICES)}",
        )
