"""Errors and gains of the first output as sentences, in the unit in which people know it."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

from softid.diagnosis.report.phrases import percent_range
from softid.diagnosis.report.rest_phrases import with_open_moments
from softid.diagnosis.verdict.held_out_error import ASTRAY, spread_of
from softid.diagnosis_results import Cause, Gain, Remainder
from softid.results import FitResult
from softid.sentences import listed

MUCH_MORE = 1.25
"""What is held out keeps more when its error is so many times that of the fitted samples."""

HARDLY_ANY_FIT = 2.0
"""Fit in per cent below which a model says no more than a constant."""

RUNS_AWAY = -900.0
"""Fit in per cent below which a model errs by more than ten times what there is to explain."""


def judged_by_blocks(gains: Sequence[Gain]) -> bool:
    """Whether what is held out are parts of the fitted logs.

    Parameters
    ----------
    gains
        Those of a diagnosis.
    """
    fitted = {gain.log for gain in gains if not gain.held_out}
    return any(gain.held_out and gain.log in fitted for gain in gains)


class ErrorTexts:
    """What is said of the errors of one diagnosis.

    Parameters
    ----------
    base
        The fit of the base, whose first output is told.
    gains
        Errors before and after, of all logs.
    whole_gain
        Interval of the gain of all causes.
    dropped
        Parameters of the base that the extension does without.
    differs
        Whether it is told how what is held out differs.
    """

    def __init__(
        self,
        base: FitResult,
        gains: Sequence[Gain],
        whole_gain: tuple[float, float] | None = None,
        dropped: Sequence[str] = (),
        *,
        differs: bool = False,
    ) -> None:
        self.base = base
        self.differs = differs
        self.dropped = dropped
        self.whole_gain = whole_gain
        self.first = base.outputs[0]
        row = next((r for r in base.statistics if r.channel == self.first), None)
        self.unit = row.display_unit if row else ""
        self.factor = row.display_factor if row else 1.0
        mine = [g for g in gains if g.channel == self.first]
        held = [g for g in mine if g.held_out]
        self.rows = held or mine
        self.fitted = [g for g in mine if not g.held_out]
        self.held_out = bool(held)

    def size(self, value: float) -> str:
        """An error with its unit; a model whose response runs away has none."""
        if not math.isfinite(value):
            return "no finite response"
        unit = "" if self.unit == "1" else f" {self.unit}"
        return f"{value * self.factor:.3g}{unit}"

    def error(self, pick: Callable[[Gain], float]) -> float:
        """Root mean square over all logs; NaN when there is none."""
        return _error_of(self.rows, pick)

    def percents(self, pick: Callable[[Gain], float]) -> str:
        """The fit of the logs in per cent, of those in which anything moves."""
        values = [pick(g) for g in self.rows if math.isfinite(pick(g))]
        if not values:
            return "unknown"
        low, high = f"{min(values):z.0f}", f"{max(values):z.0f}"
        return f"{low} %" if low == high else f"{low} to {high} %"

    def misfit(self, *, is_extended: bool, is_adequate: bool = False) -> str:
        """What the base model reaches.

        Parameters
        ----------
        is_extended
            Whether causes or descriptions gain something there.
        is_adequate
            Whether nothing is wrong with it: then it follows the output, and does not miss it.
        """
        model = f"The {self.base.model.name} model"
        if not self.rows:
            return f"{model} was fitted, and no sample of {self.first} was left to judge it on."
        where = "held-out samples" if self.held_out else "the fitted samples"
        error, fitted = (_error_of(rows, _before) for rows in (self.rows, self.fitted))
        before = self.size(error)
        fit = self.percents(lambda g: g.fit_percent_before)
        if any(self._runs_away(g) for g in self.rows):
            return (
                f"{model} runs away on {where}, by {before} rms: nothing in the fitted ones holds "
                "its parameters there."
            )
        is_still = any(g.fit_percent_before < RUNS_AWAY for g in self.rows)
        known = "" if is_still else f" (fit {fit})"
        strays = self.held_out and error > ASTRAY * fitted
        follows = is_adequate and not strays and self._explains_something
        what = f"follows {self.first} to" if follows else f"misses {self.first} by"
        told = f"{model} {what} {before} rms on {where}{known}."
        if strays:
            gained = ", and what is gained there is in part better parameters"
            told += (
                f" On the fitted ones it is {self.size(fitted)}: the model does not carry over"
                f"{gained if is_extended else ''}."
            )
        return told

    @property
    def _explains_something(self) -> bool:
        """Whether the model does better than a constant wherever it is judged."""
        return not any(g.fit_percent_before < HARDLY_ANY_FIT for g in self.rows)

    def _runs_away(self, gain: Gain) -> bool:
        """Whether the model errs by far more than anything moves, there and in the fitted logs."""
        widest = max(map(spread_of, self.fitted), default=0.0)
        return gain.fit_percent_before < RUNS_AWAY and not gain.rmse_before <= ASTRAY * widest

    def more_held_out(self, remainder: Remainder, *, is_tied: bool = False) -> str:
        """That what is held out keeps more than what was fitted, where it does.

        Parameters
        ----------
        remainder
            What is left.
        is_tied
            Whether another cause of a tie may act in place of the one that was simulated.
        """
        after = self.error(lambda g: g.rmse_after)
        if self.held_out and remainder.misses_held_out:
            another = "another cause of the tie, or " if is_tied else ""
            why = f": {another}something that the fitted ones hardly show"
            return (
                f"The held-out samples keep more, {self.size(after)}, than noise and the errors of "
                f"the parameters make of them{'' if self.differs else why}."
            )
        if not (self.held_out and after > MUCH_MORE * remainder.rms):
            return ""
        if remainder.open_jumps_held_out:
            open_moments = with_open_moments(remainder.open_jumps_held_out)
            return (
                f"The held-out samples keep more, {self.size(after)}, which is noise{open_moments}."
            )
        return (
            f"The held-out samples keep more, {self.size(after)}: larger noise there, parameters "
            "that are a little off, or something that the fitted ones hardly show."
        )

    def nothing_to_mend(self, remainder: Remainder) -> str:
        """The last word on an adequate model, and what it is worth."""
        if not self._explains_something:
            return "But a constant would do as well: the logs show too little to judge the model."
        more = self.more_held_out(remainder)
        if more and not remainder.open_jumps_held_out:
            return f"{more} Record more of such moves to tell which."
        told = (
            "There is nothing to mend for logs like these."
            if remainder.noise_is_known
            else "As far as these logs show, there is nothing to mend."
        )
        return f"{more} {told}".lstrip()

    def mended(self, causes: Sequence[Cause]) -> str:
        """What the extension gains, over all links."""
        if not self.rows or not causes:
            return ""
        before, after = self.error(lambda g: g.rmse_before), self.error(lambda g: g.rmse_after)
        gain = f"{100.0 * (1.0 - after / before):.0f} %" if before > 0.0 else "nothing"
        alone = len(causes) == 1 and not self.dropped
        interval = causes[0].gain_ci95 if alone else self.whole_gain
        sure = f", 95 % interval {percent_range(interval)}" if interval else ""
        fit = self.percents(lambda g: g.fit_percent_after)
        with_it = "With it" if len(causes) == 1 else "With all of them"
        with_it += f" and without {listed(self.dropped)}" if self.dropped else ""
        return (
            f"{with_it} the error goes from {self.size(before)} to {self.size(after)} "
            f"(gain {gain}{sure}; fit {fit})."
        )


def _before(gain: Gain) -> float:
    return gain.rmse_before


def _error_of(rows: Sequence[Gain], pick: Callable[[Gain], float]) -> float:
    n = sum(g.n for g in rows)
    return math.sqrt(sum(g.n * pick(g) ** 2 for g in rows) / n) if n else math.nan
