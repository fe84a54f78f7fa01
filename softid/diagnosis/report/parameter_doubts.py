"""Parameters that are known less well than their intervals say."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace

from softid.diagnosis.report.phrases import VARIABLE_WORDS
from softid.diagnosis_results import Diagnosis, Verdict
from softid.results import FitResult, ParameterEstimate
from softid.sentences import lowered


def outside_intervals(
    parameters: Sequence[ParameterEstimate], values: Mapping[str, float]
) -> dict[str, float]:
    """Other values of parameters that lie outside their intervals.

    Parameters
    ----------
    parameters
        What was estimated.
    values
        Parameter → its value with something else in the model; those it lacks stay out.
    """
    return {
        p.name: values[p.name]
        for p in parameters
        if p.ci95 is not None and p.name in values and not p.ci95[0] <= values[p.name] <= p.ci95[1]
    }


def other_values(parameters: Sequence[ParameterEstimate], values: Mapping[str, float]) -> str:
    """Other values of parameters beside their own, as a part of a sentence.

    Parameters
    ----------
    parameters
        What was estimated.
    values
        Some of their names → the other values.
    """
    return ", ".join(
        f"{p.name} {values[p.name]:.4g} in place of {p.value:.4g} {p.unit}"
        for p in parameters
        if p.name in values
    )


def less_sure(found: Diagnosis, names: Collection[str], reason: str, remedy: str) -> Diagnosis:
    """The diagnosis with some identified parameters known less well than their intervals say.

    Parameters
    ----------
    found
        A diagnosis in numbers.
    names
        The parameters, of the extended model or, without causes, of the base.
    reason, remedy
        As in `ParameterEstimate`.
    """
    if found.extended is None:
        return replace(found, base=_weakened(found.base, names, reason, remedy))
    extended = _weakened(found.extended, names, reason, remedy)
    told = {p.name: p for p in extended.parameters}
    causes = (
        replace(c, parameters=tuple(told.get(p.name, p) for p in c.parameters))
        for c in found.causes
    )
    return replace(found, causes=tuple(causes), extended=extended)


def with_varying_sizes(found: Diagnosis) -> Diagnosis:
    """The diagnosis with the parameters of causes whose size is not the same throughout.

    An interval holds for the law that was fitted, and theirs may not be exactly that one.

    Parameters
    ----------
    found
        A diagnosis in numbers.
    """
    for cause in found.causes:
        if cause.variation is not None:
            found = less_sure(
                found,
                [p.name for p in cause.parameters],
                f"the size of {lowered(cause.title)} varies with "
                f"{VARIABLE_WORDS[cause.variation.by]}, so its law may not be exactly this one",
                "see in the plots of what is left where it does, and fit a law of your own",
            )
    return found


def with_unnamed_misfit(found: Diagnosis) -> Diagnosis:
    """The diagnosis with parameters that what has no name may have bent, in both of its models.

    An interval holds for a model that leaves noise. Beside a misfit that nothing in the catalogue
    explains, or that is described by laws which are not believed, it may be far off.

    Parameters
    ----------
    found
        A diagnosis in numbers.
    """
    if found.verdict is not Verdict.UNKNOWN:
        return found
    reason = "what the model misses has no name, and may have bent it"
    remedy = "find the cause first, with what the diagnosis asks for"
    names = {p.name for p in found.base.parameters}
    base = _weakened(found.base, names, reason, remedy)
    if found.extended is None:
        return replace(found, base=base)
    names = {p.name for p in found.extended.parameters}
    return replace(found, base=base, extended=_weakened(found.extended, names, reason, remedy))


def _weakened(fit: FitResult, names: Collection[str], reason: str, remedy: str) -> FitResult:
    parameters = tuple(
        replace(p, verdict="weakly identified", reason=reason, remedy=remedy)
        if p.name in names and p.verdict == "identified"
        else p
        for p in fit.parameters
    )
    return replace(fit, parameters=parameters)
