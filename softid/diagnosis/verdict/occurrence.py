"""Whether an effect does anything in what is held out: what does not occur there cannot gain."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from softid.diagnosis.refit.candidates import Candidate
from softid.diagnosis.refit.extension import with_fewer_effects
from softid.diagnosis.refit.held_out import HeldOut
from softid.effects.base import Effect
from softid.effects.scale import Scale

NO_EFFECT = 0.05
"""An effect does nothing where leaving it out moves the simulation by less than this share of what
the model misses."""


def occurs(
    effect: Effect, final: Candidate, base: Candidate, held_out: HeldOut, scale: Scale
) -> bool:
    """Whether what is held out would be simulated otherwise without an effect, all else unchanged.

    A limit of a sensor that is never reached, a wall that is never touched, leave no trace.

    Parameters
    ----------
    effect
        One of the effects of the model.
    final
        The model with all of them.
    base, scale
        That without any, and the sizes of its fit.
    held_out
        What is held out.
    """
    others = [e for e in final.acting if e.key != effect.key]
    problem, z = with_fewer_effects(final.problem, final.minimum.point, base.problem, others, scale)
    without = replace(final, problem=problem, minimum=replace(final.minimum, point=z))
    errors, bare = held_out.first_errors(final), held_out.first_errors(without)
    return not np.linalg.norm(bare - errors) < NO_EFFECT * np.linalg.norm(errors)
