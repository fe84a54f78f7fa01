"""Whether logs that are held out differ in one number or two from those that were fitted."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from softid.diagnosis.base.base_fit import BaseFit
from softid.diagnosis.changes.changed_numbers import squares_of
from softid.diagnosis.changes.input_levels import have_same_levels
from softid.diagnosis.changes.log_differences import (
    LogDifferences,
    log_differences,
    squares_with,
    turned_output,
)
from softid.diagnosis.logs.one_frequency import sine_lag
from softid.diagnosis.refit.candidates import Candidate
from softid.diagnosis.refit.held_out import HeldOut
from softid.diagnosis_results import Remainder
from softid.effects.scale import Scale
from softid.log import Log


def held_out_difference(
    model: Candidate, remainder: Remainder, held: HeldOut, scale: Scale
) -> LogDifferences | None:
    """What is another number in the logs that are held out than in those that were fitted.

    Parameters
    ----------
    model
        The last model; what leaves more than noise fits none of the logs, and shows no more of
        others than that they are turned.
    remainder
        What it leaves, there and on what is held out.
    held
        What is held out.
    scale
        Sizes of the base fit.

    Returns
    -------
    LogDifferences or None
        None where it carries over, or where no other number explains that it does not.
    """
    judged = held.standing(model) if remainder.misses_held_out else None
    if judged is None:
        return None
    logs = judged.problem.logs
    before = squares_of(judged.problem, judged.minimum.point)
    if remainder.structured:
        return turned_output(model, logs, before)
    if not _are_comparable(model.problem.logs, logs):
        return None
    noise = remainder.noise_power * held.first_errors(model).size
    return log_differences(model, scale, logs, before=before, noise=noise)


def is_another_actuator(model: Candidate, remainder: Remainder, base: BaseFit) -> bool:
    """Whether the logs that are held out differ in a number that no cause owns.

    Parameters
    ----------
    model, remainder
        As in `held_out_difference`.
    base
        The model without causes, and what is held out.
    """
    found = held_out_difference(model, remainder, base.held_out, base.scale)
    return found is not None and not _is_owned(found, model, base)


def gain_beside_difference(
    found: LogDifferences | None, model: Candidate, base: BaseFit
) -> float | None:
    """Share of the held-out error that goes with causes where each log has its own of what differs.

    Parameters
    ----------
    found
        From `held_out_difference`.
    model, base
        As in `is_another_actuator`.

    Returns
    -------
    float or None
        None where nothing differs, or a cause owns what does.
    """
    judged = base.held_out.standing(model)
    if found is None or judged is None or _is_owned(found, model, base):
        return None
    before, after = (
        squares_with(one, base.scale, judged.problem.logs, found) for one in (base.candidate, model)
    )
    return 1.0 - (after / before) ** 0.5 if np.isfinite(before) and before > 0.0 else None


def _is_owned(found: LogDifferences, model: Candidate, base: BaseFit) -> bool:
    """Whether a cause owns what differs: a law that is wrong asks for another size in every log."""
    of_causes = set(model.problem.free) - set(base.candidate.problem.free)
    return not of_causes.isdisjoint({found.kinds[0], (found.beside or found).kinds[0]})


def _are_comparable(fitted: Sequence[Log], others: Sequence[Log]) -> bool:
    """Whether a model of some logs is to follow others: over their levels, and as fast."""
    return have_same_levels(fitted, others) and shows_motion_of(fitted, others)


def shows_motion_of(fitted: Sequence[Log], others: Sequence[Log]) -> bool:
    """Whether logs show how the actuator moves in others: one frequency says nothing of another.

    Parameters
    ----------
    fitted, others
        The logs.
    """
    output = fitted[0].outputs[0]
    return sine_lag(fitted, output) is None or sine_lag((*fitted, *others), output) is not None
