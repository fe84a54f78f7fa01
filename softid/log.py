"""One recording as softid sees it: times, channels, roles and the samples to leave out."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import pairwise
from types import MappingProxyType

import numpy as np
import numpy.typing as npt

from softid.channels import Channel, default_outputs, make_channel, read_only
from softid.errors import Issue, UsageError, entry_named
from softid.given_values import as_mask, as_seconds, require_names, require_whole
from softid.intersample import Intersample
from softid.log_rules import require_intersample, require_lengths, require_roles, require_times
from softid.segment import Segment, with_knots

Array = npt.NDArray[np.float64]
BoolArray = npt.NDArray[np.bool_]

STALL_MIN_S = 0.5
"""Interval up to which no log is cut, however fast its sampling, as when a logger is blocked for a
moment; a judgement."""

STALL_MIN_PERIODS = 10.0
"""Interval in sampling periods up to which no log is cut, where these are longer than 50 ms: a slow
log is not cut where a few samples are lost, for each piece needs an initial state of its own."""


def stall_of(period_s: float) -> float:
    """Longest interval in a channel that has not stalled: max(0.5 s, 10 periods)."""
    return max(STALL_MIN_S, STALL_MIN_PERIODS * period_s)


@dataclass(frozen=True)
class Source:
    """Where a log came from.

    Attributes
    ----------
    path
        File as the user named it.
    sha256
        Fingerprint of the file's bytes.
    file_format
        Name of the reader: ``"csv"``, ``"mat"``, …
    """

    path: str
    sha256: str
    file_format: str


@dataclass(frozen=True, eq=False)
class Log:
    """One recording.

    Sampling may be irregular: a log holds what was recorded. Where the clock stalls for longer than
    `stall_s`, the log falls into segments, each with its own initial state.

    Attributes
    ----------
    name
        Short name used in tables and plots, normally the file's stem.
    time_s
        Strictly increasing times, shape (n,).
    channels
        Channel name → `Channel`; all of shape (n,).
    input
        Name of the channel that drives.
    outputs
        Names of the channels to be explained.
    masked
        Samples to leave out of every residual, shape (n,); None leaves out none.
    source
        File of origin, or None for arrays.
    issues
        What the reader repaired or noticed.
    metadata
        Free text facts from the file's preamble or sidecar.
    intersample
        What the input does between samples: ``"straight"`` (first-order hold), ``"smooth"``, a
        cubic where it bends, ``"held"`` until the next sample where it jumps, ``"zoh"`` (zero-order
        hold) held at every sample, or None to let a fit decide, which elsewhere means straight.
    input_read_s, input_read_range
        When a gauge slower than the log read the input, shape (R,), and the least and the most
        that it read; None if it was read at every sample.
    is_bridged
        Whether it is one segment, in which the input goes straight on through every stall.

    Raises
    ------
    InputError
        Times not finite and strictly increasing, shapes that differ, or an input with missing
        samples.
    UsageError
        A role names a channel that the log does not have, an output is named twice, or there is no
        such intersample behaviour.
    """

    name: str
    time_s: Array = field(repr=False)
    channels: Mapping[str, Channel]
    input: str
    outputs: tuple[str, ...]
    masked: BoolArray = field(default=None, repr=False)  # type: ignore[arg-type]  # until checked
    source: Source | None = None
    issues: tuple[Issue, ...] = ()
    metadata: Mapping[str, str] = field(default_factory=dict)
    intersample: Intersample | None = None
    input_read_s: Array | None = field(default=None, repr=False)
    input_read_range: tuple[float, float] | None = None
    is_bridged: bool = False

    def __post_init__(self) -> None:
        time = read_only(self.time_s)
        object.__setattr__(self, "time_s", time)
        object.__setattr__(self, "channels", MappingProxyType(dict(self.channels)))
        object.__setattr__(self, "metadata", MappingProxyType(dict(self.metadata)))
        require_times(time, where=self.name)
        require_lengths(self.channels, time, where=self.name)
        require_roles(self.channels, self.input, self.outputs, where=self.name)
        require_intersample(self.intersample, where=self.name)
        given = np.zeros(time.size, bool) if self.masked is None else self.masked
        masked = as_mask(given, time.size, where=self.name)
        if masked.flags.writeable or not masked.flags.owndata:
            masked = masked.copy()
            masked.setflags(write=False)
        object.__setattr__(self, "masked", masked)

    def __len__(self) -> int:
        return int(self.time_s.size)

    @property
    def place(self) -> str:
        """The log's file, or its name where it was given as arrays, for messages."""
        return self.source.path if self.source else self.name

    @property
    def pressure_kpa(self) -> Array:
        """Measured pressure, shape (n,)."""
        return self._known("pressure")

    @property
    def pressure_command_kpa(self) -> Array:
        """Commanded pressure, shape (n,)."""
        return self._known("pressure_command")

    def _known(self, name: str) -> Array:
        if name not in self.channels:
            raise UsageError(
                f"the log has no channel {name}",
                where=self.name,
                remedy=f"choose from {', '.join(self.channels)}",
            )
        return self.channels[name].values

    @cached_property
    def period_s(self) -> float:
        """Median sampling interval."""
        return float(np.median(np.diff(self.time_s)))

    @property
    def stall_s(self) -> float:
        """Longest interval in which the clock has not stalled: max(0.5 s, 10 periods)."""
        return stall_of(self.period_s)

    @cached_property
    def stretches(self) -> tuple[tuple[int, int], ...]:
        """Half-open ranges of samples between stalls; a single sample between two is none."""
        interval_s = np.diff(self.time_s)
        is_short = interval_s.max() <= STALL_MIN_S  # as in most logs, and no median is due
        breaks = [] if is_short else (np.flatnonzero(interval_s > self.stall_s) + 1).tolist()
        return tuple((a, b) for a, b in pairwise((0, *breaks, len(self))) if b - a >= 2)

    def segments(self) -> tuple[Segment, ...]:
        """The stretches in order, each with a state of its own; one for all in a bridged log."""
        return self._segments

    @cached_property
    def _segments(self) -> tuple[Segment, ...]:
        spans = ((0, len(self)),) if self.is_bridged else self.stretches
        return tuple(self._segment(k, a, b) for k, (a, b) in enumerate(spans))

    def _segment(self, index: int, start: int, stop: int) -> Segment:
        return with_knots(self._rows(index, start, stop), self.between_samples)

    def _rows(self, index: int, start: int, stop: int) -> Segment:
        span = slice(start, stop)
        outputs = {name: self.channels[name].values[span] for name in self.outputs}
        used = {name: ~self.masked[span] & np.isfinite(values) for name, values in outputs.items()}
        u = self.channels[self.input].values[span]
        time_s, read_s, begins_s = self.time_s[span], self.input_read_s, float(self.time_s[0])
        if read_s is not None:
            read_s = read_s[(read_s >= time_s[0]) & (read_s <= time_s[-1])]
        return Segment(
            self.name, index, start, stop, time_s, u, outputs, used, begins_s, input_read_s=read_s
        )

    @property
    def effective_intersample(self) -> Intersample:
        """What the input is taken to have done between the samples that were recorded."""
        return self.intersample or "straight"

    @property
    def between_samples(self) -> Intersample:
        """What it is taken to do between the samples of this log, which may be averages."""
        return self.effective_intersample

    @property
    def as_recorded(self) -> Log:
        """The log that this one was made from, with samples as they were recorded, or itself."""
        return self

    def with_roles(self, *, input: str | None = None, outputs: Sequence[str] = ()) -> Log:
        """The same recording with other input and output channels."""
        named = require_names(outputs, where="outputs")
        return replace(self, input=input or self.input, outputs=named or self.outputs)

    def with_intersample(self, intersample: Intersample | None) -> Log:
        """The same recording with an intersample behaviour, if nothing declared one before.

        Parameters
        ----------
        intersample
            That of a fit; with None nothing changes.
        """
        require_intersample(intersample, where=self.name)
        if self.intersample is not None or intersample is None:
            return self
        return replace(self, intersample=intersample)

    def with_masked(self, masked: npt.ArrayLike) -> Log:
        """The same recording with more samples left out of the residuals."""
        return replace(self, masked=self.masked | as_mask(masked, len(self), where=self.name))

    def between(self, start_s: float, stop_s: float) -> Log:
        """The samples with ``start_s <= time_s < stop_s`` as a log of its own.

        Raises
        ------
        InputError
            Fewer than two samples lie in the range.
        """
        return self._taking(slice(*np.searchsorted(self.time_s, (start_s, stop_s)).tolist()))

    def every(self, step: int) -> Log:
        """Every ``step``-th sample as a log of its own; ``step`` is one or more."""
        return self._taking(slice(None, None, require_whole(step, least=1, where="step")))

    def _taking(self, rows: slice) -> Log:
        channels = {k: replace(c, values=c.values[rows]) for k, c in self.channels.items()}
        return replace(self, time_s=self.time_s[rows], channels=channels, masked=self.masked[rows])

    @classmethod
    def from_arrays(
        cls,
        time_s: npt.ArrayLike,
        channels: Mapping[str, npt.ArrayLike],
        *,
        units: Mapping[str, str] | None = None,
        input: str = "pressure",
        outputs: Sequence[str] = (),
        name: str = "log",
    ) -> Log:
        """Build a log from arrays.

        Parameters
        ----------
        time_s
            Times, shape (n,); dates and durations are taken from the first on.
        channels
            Channel name → samples of shape (n,); NaN or masked where nothing was recorded.
        units
            Name of one of the channels → unit; others are in their canonical unit.
        input, outputs
            Roles; without outputs the first known output channel is taken.
        name
            Name shown in tables.

        Raises
        ------
        InputError, UsageError
            As `Log`; values are no vector of numbers; a unit belongs to no channel or does not
            measure it; no output is named or recognised.

        Examples
        --------
        >>> log = Log.from_arrays(
        ...     [0.0, 0.1], {"pressure": [0.0, 1.0], "angle": [0.0, 30.0]},
        ...     units={"pressure": "bar", "angle": "deg"},
        ... )
        >>> log.pressure_kpa.tolist()
        [0.0, 100.0]
        """
        units = units or {}
        for known in units:
            entry_named(known, channels, unknown="there is no such channel", where="units")
        times = as_seconds(time_s, where=f"{name}, time")
        made = {k: make_channel(k, v, units.get(k)) for k, v in channels.items()}
        named = require_names(outputs, where="outputs")
        chosen = named or default_outputs(made, input, where=name)
        return cls(name=name, time_s=times, channels=made, input=input, outputs=chosen)


@dataclass(frozen=True)
class LogSet:
    """Several logs of one actuator, in the order given.

    Attributes
    ----------
    logs
        The logs, one at least; each has a name of its own, and all have the same roles.

    Raises
    ------
    UsageError
        Two logs share a name, or the logs differ in input or outputs.
    """

    logs: tuple[Log, ...]

    def __post_init__(self) -> None:
        if not self.logs:
            raise UsageError("no log was given", remedy="name at least one file")
        names = [log.name for log in self.logs]
        twice = sorted({n for n in names if names.count(n) > 1})
        if twice:
            raise UsageError(
                f"two logs are called {twice[0]}", remedy="give each log once, or rename one"
            )
        first = self.logs[0]
        for log in self.logs[1:]:
            if (log.input, log.outputs) != (first.input, first.outputs):
                raise UsageError(
                    f"{log.name} has {log.input} → {', '.join(log.outputs)}, but {first.name} has "
                    f"{first.input} → {', '.join(first.outputs)}",
                    remedy="name the roles with --input and --output (input= and outputs= in "
                    f"Python), or in {log.name}.toml",
                )

    def __iter__(self) -> Iterator[Log]:
        return iter(self.logs)

    def __len__(self) -> int:
        return len(self.logs)

    @property
    def input(self) -> str:
        """Channel that drives, the same in every log."""
        return self.logs[0].input

    @property
    def outputs(self) -> tuple[str, ...]:
        """Channels to be explained, the same in every log."""
        return self.logs[0].outputs

    @property
    def input_unit(self) -> str:
        """Unit of the input channel."""
        return self.logs[0].channels[self.input].unit
