"""Whether a clock jumped within a log, though what comes behind is faster than what came before.

Lost samples put the reading early from a moment on. Where the log moves faster from there on, a
delay throughout would look the same, unless the rest of the log tells that there is none.
"""

from __future__ import annotations

from collections.abc import Mapping

from softid.diagnosis.changes.changed_numbers import DELAY
from softid.diagnosis.changes.log_differences import LogDifferences
from softid.diagnosis.changes.probes import ReadingProbe
from softid.diagnosis.refit.candidates import Candidate, advance, begun
from softid.diagnosis.refit.extension import extend, named_values, start_unknowns
from softid.diagnosis.refit.parts_of_logs import REFIT_EVALUATIONS, white_standard_errors
from softid.effects import extended_name
from softid.effects.scale import Scale
from softid.fitters.problem import Problem

THROUGHOUT = 0.25
"""Share of a delay behind a moment from which on the rest of the log may have it, too."""

STANDARD_ERRORS = 3.0
"""Standard errors of the delay of the rest that are added to it."""


def is_clock_jump(
    change: LogDifferences | None,
    reference: Candidate,
    scale: Scale,
    sigma: Mapping[str, float],
) -> bool:
    """Whether a change is a delay that the rest of the log surely does not have.

    Parameters
    ----------
    change
        What changes in spells of a log.
    reference
        A model without effects, fitted to the rest of it.
    scale
        Sizes of the base fit.
    sigma
        Output channel → scale that its residual is divided by.
    """
    if change is None or change.kinds[0] != DELAY:
        return False
    probe = ReadingProbe()
    values = named_values(probe, probe.starts(scale)[0])
    own = extended_name(probe, DELAY)
    held = {name: value for name, value in values.items() if name != own}
    extended = extend(reference.problem, (probe,), scale)
    parameters = extended.parameters.with_values(values).with_fixed(held)
    problem = Problem(extended.model, parameters, reference.problem.logs)
    z = start_unknowns(problem, reference.problem, reference.minimum.point, values)
    free = advance(begun(reference, (probe,), problem, z), sigma, REFIT_EVALUATIONS)
    unsure = STANDARD_ERRORS * float(white_standard_errors(free)[problem.free.index(own)])
    least = min(abs(size) for size in change.sizes)
    return abs(free.parameters[own]) + unsure < THROUGHOUT * least
