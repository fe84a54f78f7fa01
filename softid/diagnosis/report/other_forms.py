"""Parameters that another form of a cause's law would make others."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

from softid.diagnosis.base.base_fit import BaseFit
from softid.diagnosis.refit.candidates import Candidate
from softid.diagnosis.report.ambiguity import is_linear, is_linear_beside
from softid.diagnosis.report.parameter_doubts import less_sure, other_values, outside_intervals
from softid.diagnosis.report.phrases import title_of
from softid.diagnosis.search.bic_ranking import rank
from softid.diagnosis.search.contenders import INDISTINCT
from softid.diagnosis.search.forms import is_richer
from softid.diagnosis.search.forward_selection import Link
from softid.diagnosis.verdict.refitted_laws import PROMISING_RATIO, refitted_with, standing_of
from softid.diagnosis_results import Diagnosis
from softid.effects import EFFECTS, effect_of
from softid.effects.base import Effect
from softid.effects.scale import Scale
from softid.errors import Issue

OTHER_FORM = "other-form"
"""Code of the remark that parameters are others under another form of a cause's law."""


def with_other_forms(
    found: Diagnosis, links: Sequence[Link], final: Candidate, base: BaseFit
) -> Diagnosis:
    """The diagnosis with what another form of a cause would make of its parameters.

    A creep of the material relaxes a part of the stiffness, and one in series with the actuator
    lets the reading creep on: the stiffness that a fit finds is the one at rest in the first and
    the one before the creep in the second. Where the logs do not tell which, what leaves its
    interval under the other form is known less well than that says. So it is under a richer form
    that is likelier, if too little to be taken.

    Parameters
    ----------
    found
        A diagnosis in numbers.
    links
        The named links of its chain.
    final
        Its model.
    base
        What that extends.
    """
    if found.extended is None:
        return found
    told = found.extended.parameters
    for key, form, other in _with_forms(links, final, base):
        moved = outside_intervals(told, other.parameters)
        if moved:
            found = _told(found, key, form, other_values(told, moved), moved)
    return found


def _with_forms(
    links: Sequence[Link], final: Candidate, base: BaseFit
) -> Iterator[tuple[str, Effect, Candidate]]:
    """Key of a cause, another form of it, and the model with that in its place."""
    for link in links:
        effect = link.added
        for row in link.extending:
            form = link.added_by(row)
            is_whole = len(row.plain.effects) == len(final.effects)
            if is_whole and row.bic < link.chosen.bic and is_richer(form, effect, base.scale):
                yield effect.key, form, row.plain
        for form in _other_forms(effect, base.scale):
            other = _alike_with(form, effect, final, base)
            if other is not None:
                yield effect.key, form, other


def _told(
    found: Diagnosis, key: str, form: Effect, values: str, moved: Mapping[str, float]
) -> Diagnosis:
    """The diagnosis with a remark on another form, and what it moves as weakly identified."""
    other = f"{title_of(form.key)} ({form.key})"
    remedy = f"record {form.shown_by}, which would tell the two apart"
    laws = (*found.causes, *found.descriptive)
    linear = is_linear_beside(laws, (form.name,), linear=is_linear(found.base))
    if linear and form.stage != effect_of(key).stage:  # one transfer function
        remedy = "read off what both have in common, such as the response, or fix what is known"
    issue = Issue(
        OTHER_FORM,
        "warning",
        f"{other} in place of {key} explains these logs as well, and makes {values}",
        remedy,
    )
    reason = f"it is another one with {other}, which explains these logs as well"
    return less_sure(replace(found, issues=(*found.issues, issue)), moved, reason, remedy)


def _other_forms(effect: Effect, scale: Scale) -> Iterator[Effect]:
    """Forms of a law that are neither richer nor plainer."""
    for key in EFFECTS:
        other = effect_of(key)
        if other.name != effect.name or key == effect.key:
            continue
        if not is_richer(other, effect, scale) and not is_richer(effect, other, scale):
            yield other


def _alike_with(form: Effect, effect: Effect, final: Candidate, base: BaseFit) -> Candidate | None:
    """The model with another form in the place of an effect, if that explains the logs as well."""
    kept = [other for other in final.acting if other.key != effect.key]
    other = refitted_with(
        standing_of(final, base), kept, (form,), near=PROMISING_RATIO * final.squares
    )
    if other is None or other.squares > PROMISING_RATIO * final.squares:
        return None
    bic = {id(row.plain): row.bic for row in rank([final, other], base.sigma)}
    return other if bic[id(other)] - bic[id(final)] < INDISTINCT else None
