"""How far two causes are apart in an experiment, and the one that tells causes apart."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

from softid.effects import EFFECTS

SINE = "a sine of 0.5 Hz"
STAIRCASE = "a slow staircase up and down"
STEPS = "fast steps"
HOLD = "a hold of 20 s followed by a rest of 20 s"
CHIRP = "a chirp from slow to fast"
EXPERIMENTS = (SINE, STAIRCASE, STEPS, HOLD, CHIRP)
"""What may be recorded to split two causes, in the order of `SEPARATIONS`."""

LISTED = 3
"""Causes whose own experiments are listed at most, the best first: more would be no advice."""

LEAST_SEPARATION = 0.2
"""Two causes that differ by less than this, in units of the noise of 0.5 %, are not told apart."""

_SEPARATIONS: dict[tuple[str, str], tuple[float, float, float, float, float]] = {
    ("delay", "pneumatic_lag"): (0.08, 0.3, 3, 0.23, 4.9),
    ("delay", "sensor_lag"): (0.15, 0.29, 1.5, 0.22, 4.8),
    ("pneumatic_lag", "sensor_lag"): (0.36, 0.2, 3.1, 0.31, 4),
    ("line_resonance", "pneumatic_lag"): (0.03, 0.94, 6.3, 1.5, 15),
    ("line_resonance", "sensor_resonance"): (0.3, 0.51, 5.9, 1.8, 14),
    ("sensor_lag", "sensor_resonance"): (0.81, 0.95, 4.6, 0.8, 10),
    ("creep", "sensor_warmup"): (3.8, 3.9, 3.3, 4.3, 1.9),
    ("creep", "hysteresis"): (4.1, 1, 3, 4.2, 2.7),
    ("hysteresis", "pneumatic_lag"): (2, 4.9, 5.4, 2.2, 5.5),
    ("coulomb_friction", "hysteresis"): (2, 1.6, 3.7, 2.2, 1.2),
    ("contact", "sensor_clipping"): (1.2, 1.6, 2, 0.39, 2.6),
    ("softening", "ageing"): (5, 1.8, 3.4, 3.9, 3.1),
    ("ageing", "sensor_gain_drift"): (1.4, 0.14, 1, 0.19, 1.2),
    ("pressure_mass", "quadratic_damping"): (0.7, 0.54, 2.5, 0.79, 3.1),
}
"""Rms difference of two causes of moderate size, in units of 0.5 % of the output's range, after
either was refitted to the other's data: for each of `EXPERIMENTS` on simulated muscles, as
`tests/benchmarks/separation_of_causes.py --draws 2` printed it. Other draws give other sizes (a
delay and a lag 6.5 in a chirp, 2.9 in fast steps) and the same experiment."""

SEPARATIONS = {frozenset(pair): values for pair, values in _SEPARATIONS.items()}
"""Rms differences of two causes by the unordered pair of their names, for each of `EXPERIMENTS`."""


@dataclass(frozen=True)
class Split:
    """The experiment that tells causes apart.

    Attributes
    ----------
    experiment
        What to record.
    separation
        Smallest difference of two of the causes, in units of the noise, on a simulated muscle; None
        where not every pair was simulated: then it is what shows those that were, or what the
        catalogue says of each.
    """

    experiment: str
    separation: float | None


def splitting_experiment(effects: Sequence[str]) -> Split | None:
    """The experiment in which causes that explain the same logs differ most.

    It is known where the best was simulated beside each of the others. Otherwise it is what the
    catalogue says of the best ones.

    Parameters
    ----------
    effects
        Names or keys of two effects or more.

    Returns
    -------
    Split or None
        None when there are fewer than two causes, or no experiment is known.

    Examples
    --------
    >>> splitting_experiment(["delay", "pneumatic_lag"])
    Split(experiment='a chirp from slow to fast', separation=4.9)
    """
    names = list(dict.fromkeys(key.split(".")[0] for key in effects))
    if len(names) < 2:
        return None
    known = [SEPARATIONS.get(frozenset(pair)) for pair in combinations(names, 2)]
    rows = [row for row in known if row is not None]
    if all(frozenset((names[0], other)) in SEPARATIONS for other in names[1:]):
        worst = [min(column) for column in zip(*rows, strict=True)]
        best = max(worst)
        if best >= LEAST_SEPARATION:
            measured = best if len(rows) == len(known) else None
            return Split(EXPERIMENTS[worst.index(best)], measured)
    shown = dict.fromkeys(EFFECTS[key].shown_by for key in effects[:LISTED] if key in EFFECTS)
    return Split("; ".join(shown), None) if shown else None


def why_unsplit(effects: Sequence[str], *, alike: bool = True) -> str:
    """Why causes are not told apart, and what would do it, in plain sentences.

    Parameters
    ----------
    effects
        Names or keys of the causes that are not told apart, the best first.
    alike
        Whether they explain the logs equally well; otherwise they differ by less than what all of
        them leave.

    Examples
    --------
    >>> print(why_unsplit(["delay", "pneumatic_lag"]).split(". ")[1])
    A chirp from slow to fast would tell them apart best.
    """
    sentences = [
        "After a refit of all other parameters they explain these logs equally well"
        if alike
        else "What none of them explains outweighs the little by which they differ"
    ]
    split = splitting_experiment(effects)
    if split is None:
        sentences.append("No experiment is known that would tell them apart")
    elif split.separation is None:
        sentences.append(f"What shows each of them: {split.experiment}")
    else:
        experiment = split.experiment[:1].upper() + split.experiment[1:]
        sentences.append(f"{experiment} would tell them apart best")
    return ". ".join(sentences) + "."
