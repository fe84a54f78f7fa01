"""Evidence for every candidate cause in every round."""

from __future__ import annotations

from collections.abc import Collection, Sequence

from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from softid.diagnosis_results import Evidence
from softid.plots.canvas import (
    BOTTOM,
    INK,
    NOTE_SIZE,
    RIGHT,
    SIMULATED,
    TOP_BELOW_TWO,
    add_panel,
    finish,
    new_figure,
)

MOST_ROUNDS = 4
MOST_ROWS = 26
_LEFT = 0.2
_GAP = 0.012
_ROOM_FOR_NUMBER = 1.42
_CHOSEN, _TIED, _OTHER = "#003f7f", "#9db4cf", "#dcdcdc"
_HATCH = "////"

Mark = tuple[int, str]


def draw_evidence(
    evidence: Sequence[Evidence],
    *,
    chosen: Collection[Mark] = (),
    tied: Collection[Mark] = (),
    title: str = "Evidence per candidate",
) -> Figure:
    """Draw the fall of the BIC of every candidate as bars, one panel a round.

    A candidate that left the race early has no bar; its share of the drop in the sum of squares
    is printed instead.

    Parameters
    ----------
    evidence
        Candidates of every round.
    chosen
        Round and key of what was taken.
    tied
        Round and key of what cannot be told from it.
    title
        Heading.

    Returns
    -------
    Figure
    """
    rounds = sorted({e.round for e in evidence})[:MOST_ROUNDS]
    order = row_order(evidence, rounds)
    left_out = len({e.effect for e in evidence}) - len(order)
    figure = new_figure()
    width = (RIGHT - _LEFT - _GAP * (len(rounds) - 1)) / max(len(rounds), 1)
    first: Axes | None = None
    for k, number in enumerate(rounds):
        left = _LEFT + k * (width + _GAP)
        axes = add_panel(
            figure,
            (left, BOTTOM, left + width, TOP_BELOW_TWO - 0.02),
            x_label="fall of the BIC" if len(rounds) > 1 else "fall of the BIC (ΔBIC)",
            y_label="" if k == 0 else None,
            x_ticks=6 if len(rounds) == 1 else 4,
            share_y=first,
        )
        first = first or axes
        axes.set_title(f"round {number}", fontsize=NOTE_SIZE, loc="left", pad=5.0)
        _draw_round(axes, [e for e in evidence if e.round == number], order, chosen, tied)
    if first is not None:
        first.set_yticks(range(len(order)), [spoken(key) for key in order])
        first.tick_params(axis="y", length=0)
        first.set_ylim(len(order) - 0.4, -0.6)
    heading = (
        title if not left_out else f"{title}, the first {len(order)} of {len(order) + left_out}"
    )
    finish(figure, heading, _handles())
    return figure


def row_order(evidence: Sequence[Evidence], rounds: Sequence[int]) -> list[str]:
    """Keys by their best fall of the BIC; then those out of every race, by their share."""
    best: dict[str, tuple[bool, float]] = {}
    for one in evidence:
        if one.round not in rounds:
            continue
        racing = one.delta_bic is not None
        own = (racing, one.delta_bic if one.delta_bic is not None else one.drop_share)
        best[one.effect] = max(best.get(one.effect, own), own)
    return sorted(best, key=lambda key: best[key], reverse=True)[:MOST_ROWS]


def spoken(key: str) -> str:
    """A key of the catalogue as words.

    Examples
    --------
    >>> spoken("pneumatic_lag.separate")
    'pneumatic lag, separate'
    """
    return key.replace("_", " ").replace(".", ", ")


def _draw_round(
    axes: Axes,
    evidence: Sequence[Evidence],
    order: Sequence[str],
    chosen: Collection[Mark],
    tied: Collection[Mark],
) -> None:
    longest = max((e.delta_bic for e in evidence if e.delta_bic is not None), default=0.0)
    reach = longest if longest > 0.0 else 1.0
    axes.set_xlim(0.0, _ROOM_FOR_NUMBER * reach)
    axes.set_xticks([tick for tick in axes.get_xticks() if tick <= reach])
    for one in evidence:
        if one.effect not in order:
            continue
        row = order.index(one.effect)
        mark = (one.round, one.effect)
        if one.delta_bic is None:
            text = f"out, {100.0 * one.drop_share:.2g} %"
            colour, at = "#5a5a5a", 0.0
        else:
            face, edge, hatch = _look(mark in chosen, mark in tied)
            at = max(one.delta_bic, 0.0)
            axes.barh(row, at, height=0.72, fc=face, ec=edge, hatch=hatch, lw=0.8)
            text, colour = f"{one.delta_bic:.0f}".replace("-", "−"), INK
        weight = "bold" if mark in chosen else "normal"
        axes.annotate(
            text,
            (at, row),
            xytext=(4, 0),
            textcoords="offset points",
            va="center",
            fontsize=NOTE_SIZE - 1.5,
            color=colour,
            fontweight=weight,
            parse_math=False,
        )


def _look(chosen: bool, tied: bool) -> tuple[str, str, str | None]:
    """Face, edge and hatching of a bar."""
    if chosen:
        return _CHOSEN, INK, None
    if tied:
        return _TIED, SIMULATED, _HATCH
    return _OTHER, "#8a8a8a", None


def _handles() -> list[Artist]:
    return [
        Patch(fc=_CHOSEN, ec=INK, label="taken"),
        Patch(fc=_TIED, ec=SIMULATED, hatch=_HATCH, label="cannot be told from it"),
        Patch(fc=_OTHER, ec="#8a8a8a", label="another candidate"),
        Line2D([], [], ls="none", label="out: left early, share of the misfit"),
    ]
