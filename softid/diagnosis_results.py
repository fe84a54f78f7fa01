"""What a diagnosis finds; frozen, without live objects."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import Enum

from softid.errors import Issue
from softid.results import FitResult, ParameterEstimate

NOTABLE = 0.02
"""Structure of a smaller share of a residual's power is not worth a word."""

MOST = 0.5
"""A steady line that holds more of a residual's power is what it is, though it goes on in rests."""

CARRIED = 0.7
"""Causes of which less than this share of the held-out misfit goes do not carry over."""


class Verdict(Enum):
    """Answer of a diagnosis."""

    ADEQUATE = "adequate"
    NAMED = "named"
    PARTIAL = "partial"
    AMBIGUOUS = "ambiguous"
    UNKNOWN = "unknown"


class NotNoise(Enum):
    """What a misfit does and slow noise does not."""

    GROWS_WITH_SPEED = "grows with speed"
    STRAYS = "strays"
    SPECTRUM = "spectrum"


class Doubt(Enum):
    """Why the numbers of a law do not allow its name."""

    GAINS_NOTHING = "gains nothing"
    MAY_GAIN_NOTHING = "may gain nothing"
    DOES_NOT_OCCUR = "does not occur"
    VARIES = "varies"
    UNKNOWN_SIZE = "unknown size"
    AT_BOUND = "at bound"
    TOO_SLOW = "too slow"
    TOO_QUICK = "too quick"
    MAY_BE_ZERO = "may be zero"
    CANCELS = "cancels"
    DISPLACES = "displaces"
    ACTS_BEHIND = "acts behind"
    DWARFED = "dwarfed"
    ONE_STEP = "one step"
    MENDS = "mends another"
    FAST_NOISE = "fast noise"


@dataclass(frozen=True)
class Gain:
    """Error of one channel of one log before and after the extension.

    Attributes
    ----------
    log, channel, unit, n
        Where, and over how many samples.
    held_out
        Whether the samples were not fitted.
    rmse_before, rmse_after
        Root mean square error of the base and of the extended model.
    fit_percent_before, fit_percent_after
        100 (1 − nrmse) of both.
    """

    log: str
    channel: str
    unit: str
    held_out: bool
    n: int
    rmse_before: float
    rmse_after: float
    fit_percent_before: float
    fit_percent_after: float


@dataclass(frozen=True)
class Variation:
    """That the size of a cause is not the same throughout.

    Attributes
    ----------
    by
        The variable that it varies with: ``t``, ``x``, ``v`` or ``p``, as in `Remainder.by`.
    spread
        Standard deviation of the size over its mean.
    share
        What letting it vary would take away, beside what the cause takes away.
    chance
        Probability that a size that is the same throughout seems to vary so.
    """

    by: str
    spread: float
    share: float
    chance: float


@dataclass(frozen=True)
class Cause:
    """One link of the chain.

    Attributes
    ----------
    effect
        Its name in the catalogue.
    key
        Name with the variant of its law.
    title, law, meaning, remedy
        Words of the catalogue.
    parameters
        Its fitted parameters with errors.
    added_to
        Keys of the causes and descriptions before it in the chain, in their order: with them the
        model has the error ``holdout_rmse_before``. Empty for the first link.
    delta_bic
        By how much the noise-whitened BIC falls when it is added.
    holdout_rmse_before, holdout_rmse_after
        Root mean square error over all held-out samples without and with it, in the first output's
        unit.
    gain_ci95
        95 % interval of the relative gain 1 − after/before, by blocks longer than the memory of the
        residuals; None when the held-out samples are too few.
    holdout_rmse_without
        Where the cause may gain nothing beside the ones before it alone, and the others surely do
        worse without it: the held-out error of the model with all others, to be held against that
        of the whole.
    variation
        How its size varies; None where nothing shows that it does.
    doubt
        Why its numbers do not allow its name; None where they do.
    """

    effect: str
    key: str
    title: str
    law: str
    meaning: str
    remedy: str
    parameters: tuple[ParameterEstimate, ...]
    added_to: tuple[str, ...]
    delta_bic: float
    holdout_rmse_before: float
    holdout_rmse_after: float
    gain_ci95: tuple[float, float] | None
    holdout_rmse_without: float | None = None
    variation: Variation | None = None
    doubt: Doubt | None = None

    @property
    def round(self) -> int:
        """Its number in the chain: the `Evidence.round` in which it won."""
        return len(self.added_to) + 1


def cause_before(cause: Cause, others: Sequence[Cause]) -> Cause | None:
    """The link of the chain that a cause was added to; None where it is not among the others.

    Parameters
    ----------
    cause
        A cause or a description.
    others
        Causes and descriptions of the same diagnosis, in any order.
    """
    return next((other for other in others if cause.added_to[-1:] == (other.key,)), None)


@dataclass(frozen=True)
class Alternative:
    """A set of causes that the data cannot split.

    Attributes
    ----------
    effects
        Names that explain the same misfit equally well, the best first; after them those of causes
        in no catalogue that follow the law of one.
    delta_bic
        Name → BIC above the best.
    why
        Why they cannot be split, and what would split them.
    forms
        Keys of the forms that explain it best, in the order of the effects; empty for plain ones.
    """

    effects: tuple[str, ...]
    delta_bic: Mapping[str, float]
    why: str
    forms: tuple[str, ...] = ()

    @property
    def keys(self) -> tuple[str, ...]:
        """Keys of what is meant, the best first."""
        return self.forms or self.effects


@dataclass(frozen=True)
class Remainder:
    """What no named cause explains.

    Attributes
    ----------
    rms
        Root mean square of the residual, in the first output's unit.
    explained_share
        Share of the base's misfit above the noise that the chain explains; 1 when nothing is left.
    structure_share, structure_limit
        Share of the residual's power that follows from the motion, and what chance reaches.
    by
        Variable → share that it alone predicts.
    excess
        Variance of the residual above that of the noise, as a share of the latter.
    noise_from_rest
        Whether rest stretches told the noise; otherwise slow noise looks like a misfit.
    structured
        Whether there is more than chance.
    noise_sd
        Standard deviation of the noise's variance, as a share of it.
    held_out_share
        Share of the misfit above the noise that the chain explains on what was held out; 1 when
        nothing is left there but noise and what the errors of the parameters make.
    misses_held_out
        Whether the error there is larger than these two explain, whatever the fitted samples show.
    open_jumps
        Jumps of the input between two samples whose moments were left open, for what is left is
        noise then; 0 where it is more, or where it is noise without that.
    open_jumps_scatter
        Whether those moments lie on either side of the middles of their intervals, as they do by
        chance, and as no cause would ask for.
    open_jumps_held_out
        As ``open_jumps``, of what was held out.
    colour_s
        Correlation time of what is left, in s, where it has all marks of slow noise and no rest
        shows the noise alone; else None.
    noise_from_rounding
        Whether the rounding of the reading told it, for no noise blurs that.
    input_noise
        Share of the power of what is left that what is not known of the input leaves of a true
        model; 0 where the noise of the output explains it alone.
    input_course
        Share of that power which is due to the course of the input between its samples, and not to
        the noise of its gauge.
    line_hz, line_share
        Frequency of a steady line that the input does not have, at which the actuator could follow
        a force, and the share of the power of what is left that it holds; None and 0 without one.
    against_noise
        What slow noise, which no rest shows, would not do; None where nothing speaks against it, or
        the question does not arise.
    """

    rms: float
    explained_share: float
    structure_share: float
    structure_limit: float
    by: Mapping[str, float]
    excess: float
    noise_from_rest: bool
    structured: bool
    noise_sd: float = 0.0
    held_out_share: float = 1.0
    misses_held_out: bool = False
    open_jumps: int = 0
    open_jumps_scatter: bool = False
    open_jumps_held_out: int = 0
    colour_s: float | None = None
    against_noise: NotNoise | None = None
    noise_from_rounding: bool = False
    input_noise: float = 0.0
    input_course: float = 0.0
    line_hz: float | None = None
    line_share: float = 0.0

    @property
    def carries_over(self) -> bool:
        """Whether the chain explains what was held out, too."""
        return self.held_out_share > CARRIED

    @property
    def noise_power(self) -> float:
        """Mean square of the noise: what is left without its excess."""
        return self.rms**2 / max(1.0 + self.excess, 1.0)

    @property
    def noise_is_known(self) -> bool:
        """Whether something else than the residual itself told the noise."""
        return self.noise_from_rest or self.noise_from_rounding

    @property
    def leaves_something(self) -> bool:
        """Whether more than noise is left, on the fitted samples or on those held out."""
        return self.structured or self.misses_held_out or self.is_a_line

    @property
    def is_a_line(self) -> bool:
        """Whether most of what is left is a steady line, which rests hold as well as motions."""
        return self.line_share > MOST

    @property
    def predictable(self) -> bool:
        """Whether a notable part of the residual follows from the motion, beyond chance."""
        return self.structure_share > max(self.structure_limit, NOTABLE)


@dataclass(frozen=True)
class Evidence:
    """How one candidate did in one round.

    Attributes
    ----------
    round
        1 for the first link of the chain.
    effect
        Key of the candidate.
    delta_bic
        Fall of the BIC against what was to be extended; None when it was out of the race before.
    drop_share
        Share of the sum of squares that it explains, for white noise: after a refit, or as its
        signature promises where it was out of the race before.
    """

    round: int
    effect: str
    delta_bic: float | None
    drop_share: float


@dataclass(frozen=True, eq=False)
class Diagnosis:
    """What the simulation gets wrong, why, and what mending it gains.

    Attributes
    ----------
    verdict
        The answer.
    summary
        The answer as a short paragraph.
    base
        The fit of the model without effects.
    extended
        The fit with the chain of causes or descriptive laws; None when there is none.
    causes
        The chain, the cause without which most is left first; empty when nothing may be named.
    descriptive
        Laws that lower the error but may not be called causes, because too much is left that they
        do not explain, or because they take away too little of it.
    alternatives
        Sets of causes that cannot be split.
    remainder
        What is left.
    gains
        Error before and after, for each log and channel.
    evidence
        Every candidate of every round.
    next_experiment
        What to record next; None when nothing is open.
    issues
        Findings about the logs and the fits.
    gain_ci95
        95 % interval of the share of the held-out error that the whole chain takes away; None where
        it cannot be told.
    """

    verdict: Verdict
    summary: str
    base: FitResult
    extended: FitResult | None
    causes: tuple[Cause, ...]
    descriptive: tuple[Cause, ...]
    alternatives: tuple[Alternative, ...]
    remainder: Remainder
    gains: tuple[Gain, ...]
    evidence: tuple[Evidence, ...]
    next_experiment: str | None
    issues: tuple[Issue, ...] = ()
    gain_ci95: tuple[float, float] | None = None


def dropped_from(found: Diagnosis) -> tuple[str, ...]:
    """Parameters that the base has and the model that extends it does without.

    Parameters
    ----------
    found
        The diagnosis.
    """
    if found.extended is None:
        return ()
    kept = {p.name for p in found.extended.parameters if not p.fixed}
    return tuple(p.name for p in found.base.parameters if not p.fixed and p.name not in kept)
