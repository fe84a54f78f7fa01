"""That a material creeps with more than one time, or gives way over more than one distance."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from softid.diagnosis.base.base_fit import BaseFit
from softid.diagnosis.refit.candidates import Candidate
from softid.diagnosis.report.phrases import percent
from softid.diagnosis.search.bic_ranking import rank
from softid.diagnosis.search.contenders import INDISTINCT
from softid.diagnosis.search.forward_selection import Link
from softid.diagnosis.verdict.chain_consistency import may_hold_more
from softid.diagnosis.verdict.refitted_laws import PROMISING_RATIO, refitted_with, standing_of
from softid.diagnosis.verdict.two_memories import MEMORIES
from softid.diagnosis.verdict.unlisted_laws import Law
from softid.diagnosis_results import Diagnosis, Verdict
from softid.effects import extended_name
from softid.errors import Issue

SEVERAL_ELEMENTS = "several-elements"
"""Code of the remark that a second element of the same kind stands beside a named one."""

SECOND: Mapping[str, tuple[str, str]] = {
    "creep": ("tau", "creeps with more than one time"),
    "hysteresis": ("zs", "gives way over more than one distance"),
}
"""Named cause → which parameter tells a second element from it, and what both together are."""

MOST_OF_THE_REST = 0.5
"""Share of what the named causes leave above the noise that a second element takes at least."""


def with_several_elements(
    found: Diagnosis, links: Sequence[Link], final: Candidate, base: BaseFit
) -> Diagnosis:
    """The diagnosis with a second element of a named cause, where that is not the whole of it.

    Where more than noise may be left, or something is described, the second element is refitted
    beside the named causes, in the place of what is described. It is told where it is likelier than
    that, takes away most of what the named ones leave and lowers the error on what is held out. Of
    what passes for slow noise as a whole none is taken.

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
    rows = [
        (MEMORIES[link.added.name], *SECOND[link.added.name])
        for link in links
        if link.added.name in SECOND
    ]
    is_open = may_hold_more(found.remainder) or bool(found.descriptive)
    if not (rows and is_open and found.verdict in (Verdict.NAMED, Verdict.PARTIAL)):
        return found
    named = {link.added.name for link in links}
    kept = [effect for effect in final.acting if effect.name in named]
    standing, near = standing_of(final, base), PROMISING_RATIO * final.squares
    noise = final.squares / (1.0 + found.remainder.excess)
    for law, which, together in rows:
        other = refitted_with(standing, kept, (law(),), near=near)
        if other is None or not _is_better(other, final, base):
            continue
        alone = final
        if found.descriptive:
            alone = refitted_with(standing, kept[:-1], kept[-1:], near=np.inf) or final
        left, taken = alone.squares - noise, alone.squares - other.squares
        if left > 0.0 and taken > MOST_OF_THE_REST * left:
            issue = _issue(law(), which, together, other, min(taken / left, 1.0))
            found = replace(found, issues=(*found.issues, issue))
    return found


def _is_better(other: Candidate, final: Candidate, base: BaseFit) -> bool:
    """Whether a model is likelier than the final one, and predicts what is held out better."""
    bic = {id(row.plain): row.bic for row in rank([final, other], base.sigma)}
    is_likelier = bic[id(other)] < bic[id(final)] - INDISTINCT
    return is_likelier and base.held_out.rms(other) < base.held_out.rms(final)


def _issue(law: Law, which: str, together: str, model: Candidate, taken: float) -> Issue:
    second = extended_name(law, which)
    first = second.removeprefix("second_")
    values, unit = model.parameters, model.problem.parameters[second].unit
    return Issue(
        SEVERAL_ELEMENTS,
        "info",
        f"the material {together}: with a {law.title.lower()} beside the first, which is in no "
        f"catalogue, {which} is {values[first]:.3g} {unit} for the one and {values[second]:.3g} "
        f"{unit} for the other, {percent(taken)} of what the first alone leaves above the noise is "
        "gone, and the held-out error falls",
        f"record {law.shown_by}, and read the values of the first one as those of both together",
    )
