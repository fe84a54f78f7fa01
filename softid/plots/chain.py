"""Held-out error after each link of the chain of causes."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.container import ErrorbarContainer
from matplotlib.figure import Figure

from softid.diagnosis_results import Cause
from softid.plots.canvas import (
    INK,
    LABEL_SIZE,
    LEFT,
    NOTE_SIZE,
    RIGHT,
    SIMULATED,
    TOP,
    Display,
    add_panel,
    finish,
    new_figure,
)
from softid.plots.evidence import spoken

_BOTTOM = 0.13
_HEADROOM = 1.25

NO_RESPONSE = "no response"
"""In place of the error of a model whose response runs away on what is held out."""

LONGEST_LINE = 17
"""Letters of a name that fit side by side below the bars."""

MOST_LOSS = 1.0
"""A bar ends where the error has doubled: what is known no better would hide all else."""


def draw_chain(
    causes: Sequence[Cause],
    *,
    output: Display,
    base: str = "base model",
    title: str = "The chain",
    tied: Mapping[str, Sequence[str]] | None = None,
    step: str = "cause",
    described: Collection[str] = (),
) -> Figure:
    """Draw the held-out error of the base and after each cause, with the interval of its gain.

    The bar of a link spans before · (1 − g) for g in the 95 % interval of its gain. A model whose
    response runs away has no point.

    Parameters
    ----------
    causes
        The chain, at least one link; errors are in the output's canonical unit.
    output
        How the first output is shown.
    base
        Name of what was extended.
    title
        Heading.
    tied
        Effect of a link → all effects of which it may be either.
    step
        What is added at each step.
    described
        Keys of links that describe a part and are no cause.

    Returns
    -------
    Figure
    """
    figure = new_figure()
    axes = add_panel(
        figure,
        (LEFT, _BOTTOM, RIGHT, TOP),
        x_label=f"model, one {step} more at each step",
        y_label=output.named("held-out rmse"),
        y_ticks=7,
    )
    rmse = np.array([causes[0].holdout_rmse_before, *(c.holdout_rmse_after for c in causes)])
    rmse *= output.factor
    highest = float(np.max(rmse, where=np.isfinite(rmse), initial=0.0))
    (line,) = axes.plot(
        rmse, color=SIMULATED, lw=1.6, marker="o", ms=9, zorder=3, label="held-out rmse"
    )
    handles = [line]
    unit = "" if output.unit in ("", "1") else f" {output.unit}"
    notes = [f"{rmse[0]:.3g}{unit}" if np.isfinite(rmse[0]) else NO_RESPONSE]
    tops = [float(rmse[0]) if np.isfinite(rmse[0]) else 0.0]
    for k, cause in enumerate(causes, start=1):
        if not np.isfinite(rmse[k]):
            notes.append(NO_RESPONSE)
            tops.append(0.0)
            continue
        top = float(rmse[k])
        if cause.gain_ci95 is not None:
            before = cause.holdout_rmse_before * output.factor
            bar, ends = _interval_bar(axes, k, before, cause.gain_ci95)
            if len(handles) == 1:
                handles.append(bar)  # type: ignore[arg-type]
            top = max(top, *ends)
        tops.append(top)
        notes.append(f"{rmse[k]:.3g}{unit}\n{_gain(cause)}")
    for k, (top, note) in enumerate(zip(tops, notes, strict=True)):
        axes.annotate(
            note,
            (k, top),
            xytext=(0, 10),
            textcoords="offset points",
            ha="center",
            va="bottom",
            fontsize=NOTE_SIZE,
            parse_math=False,
        )
    axes.set_ylim(0.0, _HEADROOM * max(highest, *tops))
    axes.set_xlim(-0.5, len(causes) + 0.5)
    either = {effect: keys for effect, keys in (tied or {}).items() if len(keys) > 1}
    told = [" or ".join(spoken(k) for k in either.get(c.effect, (c.key,))) for c in causes]
    marks = [" (description)" if c.key in described else "" for c in causes]
    names = [base, *(f"+ {name}{mark}" for name, mark in zip(told, marks, strict=True))]
    axes.set_xticks(range(len(names)), [_folded(n) for n in names])
    axes.tick_params(axis="x", labelsize=LABEL_SIZE - 1, length=0)
    axes.xaxis.set_label_coords(0.5, -0.105)
    finish(figure, title, handles)
    return figure


def _interval_bar(
    axes: Axes, k: int, before: float, gains: tuple[float, float]
) -> tuple[ErrorbarContainer, tuple[float, float]]:
    """The bar of a step, and the errors at its ends."""
    low, high = (before * (1.0 - max(gain, -MOST_LOSS)) for gain in reversed(gains))
    bar = axes.errorbar(
        k,
        0.5 * (low + high),
        yerr=0.5 * abs(high - low),
        fmt="none",
        ecolor=INK,
        elinewidth=1.6,
        capsize=9,
        capthick=1.6,
        zorder=2,
        label="95 % interval of the step",
    )
    return bar, (low, high)


def _gain(cause: Cause) -> str:
    if cause.holdout_rmse_before == 0.0 or not np.isfinite(cause.holdout_rmse_before):
        return ""
    gain = 100.0 * (1.0 - cause.holdout_rmse_after / cause.holdout_rmse_before)
    text = f"{-gain:+.0f} %".replace("-", "−")
    return text if cause.gain_ci95 is not None else f"{text}\nno interval"


def _folded(name: str) -> str:
    """A name on two lines when it is long."""
    if len(name) <= LONGEST_LINE:
        return name
    words = name.split()
    cut = min(
        range(1, len(words)) or (1,), key=lambda k: abs(len(" ".join(words[:k])) - len(name) / 2)
    )
    return " ".join(words[:cut]) + "\n" + " ".join(words[cut:])
