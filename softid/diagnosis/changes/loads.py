"""What a constant load does to an output, throughout or from one moment on.

Where stiffness or damping follow the input, a load shifts the output by another amount at every
level of it, so that its course is simulated.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from softid.diagnosis.changes.probes import MotionProbe
from softid.diagnosis.refit.candidates import FINE_STEPS, Candidate, limited_plans
from softid.diagnosis.refit.extension import extend, named_values, start_unknowns
from softid.effects import extended_name
from softid.effects.scale import Scale

Array = npt.NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class LoadInLog:
    """How a load that is put on at a moment of a log shifts the output, as a share of the mean.

    Attributes
    ----------
    time_s
        Times after the moment, shape (n,).
    share
        What is shifted then, divided by its mean behind the moment, shape (n,).
    whole
        What a load from the start would shift, likewise, shape (n,).
    """

    time_s: Array
    share: Array
    whole: Array

    def __call__(self, since_s: Array) -> Array:
        """Share of the mean, times after the moment."""
        return np.interp(since_s, self.time_s, self.share)

    def throughout(self, since_s: Array) -> Array:
        """That of a load from the start, at the same times."""
        return np.interp(since_s, self.time_s, self.whole)


def by_load(model: Candidate, scale: Scale, begins_s: float = -np.inf) -> Array:
    """Derivative of the first output by a load, at the used samples of all logs, shape (m,).

    Parameters
    ----------
    model
        A model.
    scale
        Sizes of the base fit.
    begins_s
        Time of each log at which the load is put on; at the start without one.
    """
    probe, first = MotionProbe(begins_s), model.problem.outputs[0]
    problem = extend(model.problem, (probe,), scale)
    none = named_values(probe, probe.starts(scale)[0])
    z = start_unknowns(problem, model.problem, model.minimum.point, none)
    load = problem.free.index(extended_name(probe, "load"))
    blocks = problem.blocks(z, derivatives=True, plans=limited_plans(problem, z, FINE_STEPS))
    columns = [b.jacobian[:, load] for b in blocks if b.channel == first and b.jacobian is not None]
    return np.concatenate(columns)
