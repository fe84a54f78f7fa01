"""All plots of a diagnosis, by name."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

import numpy as np
from matplotlib.figure import Figure

from softid.diagnosis_results import Diagnosis, dropped_from
from softid.plots.before_after import Scored, draw_before_after
from softid.plots.canvas import Display, names_and_count, shortened
from softid.plots.chain import draw_chain
from softid.plots.cycles import find_cycles
from softid.plots.drawings import Drawing, applying, file_name
from softid.plots.evidence import Mark, draw_evidence, spoken
from softid.plots.gallery import FEWEST_RESIDUALS, STILL_SHARE, scored
from softid.plots.loop_area import LoopWidth, draw_loop_area, loop_width
from softid.plots.residual_scatter import residual_points
from softid.plots.what_is_left import draw_what_is_left
from softid.results import FitResult, FitStatistics, Simulation

MOST_LOGS = 3
"""Logs shown before and after; those held out come first, then those that gain the most."""


def diagnosis_drawings(diagnosis: Diagnosis) -> list[tuple[str, Drawing]]:
    """What draws the plots of a diagnosis, each by itself, at most seven.

    Parameters
    ----------
    diagnosis
        What was found. The simulations of its fits must be there.

    Returns
    -------
    list of tuple of str and callable
        File name without suffix, and what draws the plot: ``before_after_LOG`` for up to
        `MOST_LOGS` logs, then ``what_is_left``, ``loop_area``, ``evidence`` and ``chain``, as far
        as they apply.
    """
    taken: set[str] = set()
    several = len(diagnosis.base.outputs) > 1
    found: list[tuple[str, Drawing]] = []
    for before, after in chosen_logs(diagnosis):
        channel = f"_{before.statistics.channel}" if several else ""
        name = f"before_after_{before.simulation.log}{channel}"
        found.append((file_name(name, taken), partial(draw_before_after, before, after)))
    for name, draw in (
        ("what_is_left", what_is_left_figure),
        ("loop_area", loop_area_figure),
        ("evidence", evidence_figure),
        ("chain", chain_figure),
    ):
        found.append((file_name(name, taken), partial(draw, diagnosis)))
    return found


def diagnosis_figures(diagnosis: Diagnosis) -> Iterator[tuple[str, Figure]]:
    """Draw the plots of a diagnosis one after the other, at most seven.

    Parameters
    ----------
    diagnosis
        As in `diagnosis_drawings`.

    Yields
    ------
    tuple of str and Figure
        File name without suffix, and the plot, of those that apply.
    """
    yield from applying(diagnosis_drawings(diagnosis))


def chosen_logs(diagnosis: Diagnosis) -> list[tuple[Scored, Scored | None]]:
    """The logs and channels worth showing, each with both models."""
    extended = diagnosis.extended
    after = {
        (score.log, score.channel): Scored(extended_label(extended), simulation, score)
        for simulation, score in (scored(extended) if extended is not None else ())
        if extended is not None
    }
    pairs = [
        (Scored("base", simulation, score), after.get((score.log, score.channel)))
        for simulation, score in scored(diagnosis.base)
    ]

    def rank(pair: tuple[Scored, Scored | None]) -> tuple[bool, float]:
        base, better = pair
        gain = base.statistics.nrmse - (better.statistics.nrmse if better is not None else 0.0)
        return base.statistics.in_sample, -gain if np.isfinite(gain) else 0.0

    return sorted(pairs, key=rank)[:MOST_LOGS]


def extended_label(extended: FitResult) -> str:
    """What was added, for a legend."""
    names = [spoken(key) for key in extended.model.effects]
    return "with " + shortened(", ".join(names), longest=44) if names else "extended"


def what_is_left_figure(diagnosis: Diagnosis) -> Figure | None:
    """Residual of the fitted logs, of the first output."""
    base, extended = diagnosis.base, diagnosis.extended
    channel = base.outputs[0]
    fitted = fitted_simulations(base, channel)
    before = residual_points(fitted, channel) if fitted else None
    if before is None or before.residual.size < FEWEST_RESIDUALS:
        return None
    later = fitted_simulations(extended, channel) if extended is not None else ()
    names = names_and_count([simulation.log for simulation in fitted])
    return draw_what_is_left(
        before,
        residual_points(later, channel) if later else None,
        input=Display(base.input, fitted[0].input_unit),
        output=shown_output(base),
        title=f"What is left: {names}",
    )


def loop_area_figure(diagnosis: Diagnosis) -> Figure | None:
    """Loops of all logs by rate; None when the input makes no cycles."""
    base, extended = diagnosis.base, diagnosis.extended
    channel = base.outputs[0]
    simulations = [s for s in base.simulations if channel in s.measured]
    later = {s.log: s for s in extended.simulations} if extended is not None else {}
    spans = [float(np.ptp(s.input)) for s in simulations]
    widths: list[LoopWidth] = []
    for simulation in simulations:
        still = STILL_SHARE * max(spans)
        widths += cycle_widths(simulation, later.get(simulation.log), channel, still=still)
    if extended is not None:
        widths = [w for w in widths if w.after is not None]
    if not widths:
        return None
    return draw_loop_area(
        widths,
        output=shown_output(base),
        title=f"Loop area over span of the input: {names_and_count([s.log for s in simulations])}",
    )


def cycle_widths(
    before: Simulation, after: Simulation | None, channel: str, *, still: float
) -> list[LoopWidth]:
    """Widths of the loops of one log, cycle by cycle."""
    measured = np.where(before.used[channel], before.measured[channel], np.nan)
    first = before.residual(channel)
    second = after.residual(channel) if after is not None else None
    found: list[LoopWidth] = []
    for cycle in find_cycles(
        before.time_s, before.input, before.segment_starts, smallest_span=still
    ):
        span = slice(cycle.start, cycle.stop)
        whole = loop_width(before.input[span], measured[span])
        own = loop_width(before.input[span], first[span])
        later = loop_width(before.input[span], second[span]) if second is not None else None
        if whole is not None and own is not None:
            found.append(LoopWidth(cycle.rate_hz, whole, own, later))
    return found


def evidence_figure(diagnosis: Diagnosis) -> Figure | None:
    """Every candidate of every round; None when no candidate was tried."""
    if not any(one.effect for one in diagnosis.evidence):
        return None
    chosen = taken_candidates(diagnosis)
    return draw_evidence(
        diagnosis.evidence,
        chosen=chosen,
        tied=tied_candidates(diagnosis, chosen),
        title=f"Evidence per candidate: verdict {diagnosis.verdict.value}",
    )


def taken_candidates(diagnosis: Diagnosis) -> frozenset[Mark]:
    """Round and key of every link: the best of a round that is part of the extended model."""
    keys = {cause.key for cause in (*diagnosis.causes, *diagnosis.descriptive)}
    found: set[Mark] = set()
    for number in sorted({one.round for one in diagnosis.evidence}):
        racing = [
            (one.delta_bic, one.effect)
            for one in diagnosis.evidence
            if one.round == number and one.effect in keys and one.delta_bic is not None
        ]
        if racing:
            found.add((number, max(racing)[1]))
            keys.discard(max(racing)[1])
    return frozenset(found)


def tied_candidates(diagnosis: Diagnosis, chosen: frozenset[Mark]) -> frozenset[Mark]:
    """Round and key of the rivals of what each round took; of a name, its best variant."""
    found: set[Mark] = set()
    for number, key in chosen:
        own = plain_name(key)
        rivals = {
            name
            for other in diagnosis.alternatives
            if own in map(plain_name, other.effects)
            for name in map(plain_name, other.effects)
        } - {own}
        for rival in rivals:
            racing = [
                (one.delta_bic, one.effect)
                for one in diagnosis.evidence
                if one.round == number
                and one.delta_bic is not None
                and plain_name(one.effect) == rival
            ]
            if racing:
                found.add((number, max(racing)[1]))
    return frozenset(found)


def plain_name(key: str) -> str:
    """A key without the variant of its law.

    Examples
    --------
    >>> plain_name("pneumatic_lag.separate")
    'pneumatic_lag'
    """
    return key.split(".")[0]


def chain_figure(diagnosis: Diagnosis) -> Figure | None:
    """Held-out error by link; None when nothing was added."""
    links = sorted((*diagnosis.causes, *diagnosis.descriptive), key=lambda link: link.round)
    if not links:
        return None
    what = "causes" if diagnosis.causes else "laws that describe and do not explain"
    described = {link.key for link in diagnosis.descriptive} if diagnosis.causes else set()
    dropped = dropped_from(diagnosis)
    without = f" without {names_and_count(dropped)}" if dropped else ""
    return draw_chain(
        links,
        output=shown_output(diagnosis.base),
        base=f"{diagnosis.base.model.name} model{without}",
        title=f"Held-out error along the chain of {what}",
        tied={effect: tie.keys for tie in diagnosis.alternatives for effect in tie.effects},
        step="cause" if not diagnosis.descriptive else "law",
        described=described,
    )


def first_scores(result: FitResult) -> tuple[FitStatistics, ...]:
    """Scores of the first output."""
    return tuple(s for s in result.statistics if s.channel == result.outputs[0])


def shown_output(result: FitResult) -> Display:
    """How the first output is shown: in the unit of the first log's file."""
    first = first_scores(result)[0]
    return Display(first.channel, first.display_unit, first.display_factor)


def fitted_simulations(result: FitResult, channel: str) -> tuple[Simulation, ...]:
    """Simulations of the fitted logs that have the channel."""
    return tuple(
        simulation
        for simulation, score in scored(result)
        if score.in_sample and score.channel == channel
    )
