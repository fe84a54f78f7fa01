"""What differs between logs, or in a spell of one, in words."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from softid.diagnosis.changes.changed_numbers import SIGN
from softid.diagnosis.changes.log_differences import LogDifferences
from softid.diagnosis.changes.shifts import EITHER, LOAD, ZERO, Shift
from softid.diagnosis.report.phrases import percent
from softid.errors import Issue
from softid.fitters.problem import Problem
from softid.log import Log
from softid.sentences import listed

LOG_DIFFERENCES = "logs-differ"
"""Code of the remark that a misfit is a difference between logs."""

DIFFERENCES = {
    ZERO: "the zero of the reading",
    SIGN: "the sign of the reading",
    "gain": "the gain of the reading",
    "delay": "the delay of the reading",
    "drift": "the drift of the reading",
    "settling_drift": "a drift of the reading that settles, as that of a sensor that warms up,",
    LOAD: "a constant load",
    "stiffness": "the stiffness",
    "damping": "the damping",
    "pressure_gain": "the gain of the pressure",
    "pressure_zero": "the zero of the pressure",
}
"""What may differ from log to log, in words; else it is a parameter of the model."""

ZERO_OR_LOAD = "the zero of the reading or a constant load"
"""A zero under one stiffness throughout, where a load adds the same once it is settled."""

SHIFTS = {ZERO: DIFFERENCES[ZERO], LOAD: DIFFERENCES[LOAD], EITHER: ZERO_OR_LOAD}
"""What shifts an output, in words."""

INERTIA = "the inertia {}"
"""The parameter of a model that is its inertia, in words."""

PAYLOAD = ", as with another payload"
"""Said where the inertia differs, alone or beside what the weight changes."""

SIZES = {
    "delay": "{0:+.3g} s",
    "drift": "{1:+.1f} % of the range",
    "settling_drift": "{1:+.1f} % of the range",
    "load": "{1:+.1f} % of the elastic force",
    "pressure_zero": "{1:+.1f} % of the range",
}
"""Format of the size of a difference by its kind; all others are told in per cent."""

APART = (
    "look at what was changed between the logs, such as a load, a mount or a calibration, and "
    "diagnose each of them apart"
)
"""What to do about logs that differ."""

MOST_KINDS = 3
"""Most kinds of a difference that a sentence names."""


@dataclass(frozen=True)
class DifferenceTexts:
    """Differences of one output in words.

    Attributes
    ----------
    output
        The output.
    shown
        The factor and the unit in which it is told.
    inertia
        The parameter of its model that is the inertia, if there is one.
    is_linear
        Whether the model is linear.
    """

    output: str
    shown: tuple[float, str]
    inertia: str | None
    is_linear: bool

    @classmethod
    def of(cls, problem: Problem) -> DifferenceTexts:
        """Of the first output of a problem.

        Parameters
        ----------
        problem
            The problem.
        """
        model, output = problem.model, problem.outputs[0]
        channel = problem.logs[0].channels[output]
        shown = (channel.display_factor, channel.display_unit)
        return cls(output, shown, model.inertia_parameter, model.is_linear)

    def issue(self, found: LogDifferences, logs: Sequence[Log], reference: str) -> Issue:
        """What differs from log to log.

        Parameters
        ----------
        found
            The difference.
        logs
            The logs that it is in.
        reference
            What they are compared with.
        """
        if found.kinds[0] == SIGN:
            return self._turned(found, logs, reference)
        changed, last = self._changed(found, logs), found.beside or found
        if found.beside is not None:
            changed = f"{changed} and {self._changed(found.beside, logs)}"
        payload = self.payload(found.kinds[0]) or self.payload(last.kinds[0])
        return Issue(
            LOG_DIFFERENCES,
            "warning",
            f"the logs differ: against {reference} {changed}{payload}, which takes away "
            f"{percent(last.share)} of the misfit of {self.output}{self._or_else(last)}",
            APART,
        )

    def in_spell(self, found: LogDifferences, shift: Shift | None = None) -> str:
        """What a spell of a log is like.

        Parameters
        ----------
        found
            How it differs from the rest of the log.
        shift
            What shifts the output there; None where that is not known.
        """
        last, shifts, payload = found.beside or found, "", ""
        numbers = [found] if found.beside is None else [found, last]
        changes = [f"{self.title(one.kinds[0])} changes{_by(one)}" for one in numbers]
        if found.kinds[0] == ZERO and self.is_linear:
            changes = [f"{ZERO_OR_LOAD if shift is None else SHIFTS[shift.kind]} changes"]
        elif shift is not None:
            changes.append(f"{SHIFTS[shift.kind]} changes")
            if shift.kind == LOAD:
                payload = next(filter(None, (self.payload(one.kinds[0]) for one in numbers)), "")
        if shift is not None:
            factor, unit = self.shown
            shifts = f"shifts {self.output} by {shift.size * factor:+.3g} {unit} and "
        return (
            f": there {' and '.join(changes)}{payload}, which {shifts}takes away "
            f"{percent(last.share)} of it{self._or_else(last)}"
        )

    def payload(self, kind: str) -> str:
        """What is said of a kind that is the inertia; nothing of others.

        Parameters
        ----------
        kind
            As in `LogDifferences`.
        """
        return PAYLOAD if kind == self.inertia else ""

    def _changed(self, found: LogDifferences, logs: Sequence[Log]) -> str:
        """What changes by how much in which log."""
        kind, pairs = found.kinds[0], zip(logs, found.sizes, strict=True)
        rows = [f"{_size(kind, size)} in {log.name}" for log, size in pairs]
        return f"{self.title(kind)} changes by {listed(rows)}"

    def _turned(self, found: LogDifferences, logs: Sequence[Log], reference: str) -> Issue:
        """That an output has the other sign in some logs."""
        names = [log.name for log, size in zip(logs, found.sizes, strict=True) if size]
        return Issue(
            LOG_DIFFERENCES,
            "warning",
            f"the logs differ: {self.output} has the other sign in {listed(names)} than in "
            f"{reference}, which makes {percent(found.share)} of its misfit",
            f"turn it where it is wrong, with --channel {self.output}=COLUMN:-UNIT or in a sidecar",
        )

    def _or_else(self, found: LogDifferences) -> str:
        """What explains nearly as much, if anything does."""
        others = listed([self.title(other) for other in found.kinds[1:MOST_KINDS]], last=" or ")
        return f"; {others} would explain nearly as much" if others else ""

    def title(self, kind: str) -> str:
        """What differs, in words.

        Parameters
        ----------
        kind
            As in `LogDifferences`.
        """
        if kind == self.inertia:
            return INERTIA.format(kind)
        return DIFFERENCES.get(kind, f"{kind} of the model")


def _by(found: LogDifferences) -> str:
    """By how much something changes in each spell; a zero and a sign have no size."""
    kind = found.kinds[0]
    if kind in (ZERO, SIGN):
        return ""
    return f" by {listed([_size(kind, size) for size in found.sizes])}"


def _size(kind: str, size: float) -> str:
    return SIZES.get(kind, "{1:+.1f} %").format(size, 100.0 * size)
