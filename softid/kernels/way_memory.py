"""What goes by the way of its input and not by the time: play, and a loop of two branches."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from softid.kernels.decorators import kernel

Array = npt.NDArray[np.float64]


@kernel
def play(values: Array, width: float, side: float) -> None:
    """Follow the input with play: move only when it leaves a band of ± a width.

    Parameters
    ----------
    values
        Input, shape (n,); overwritten by the output.
    width
        Half width of the band, not negative.
    side
        Output less input at the beginning, in widths, from −1 after a rise to 1 after a fall.
    """
    y = values[0] + side * width
    for k in range(values.size):
        y = min(max(y, values[k] - width), values[k] + width)
        values[k] = y


@kernel
def loop(values: Array, distance: float, branch: Array) -> None:
    """Where a law of Dahl is between its branches, zs ż = u̇ − |u̇| z, exact for any steps of u.

    Within a step that goes one way z nears the sign of it: z⁺ = ±1 + (z ∓ 1) e^{−|Δu|/zs}.

    Parameters
    ----------
    values
        Input u, shape (n,).
    distance
        Distance zs over which the branch changes, positive.
    branch
        z, shape (n,), overwritten; the first is given.
    """
    for k in range(1, values.size):
        step = values[k] - values[k - 1]
        side = 1.0 if step > 0.0 else -1.0
        branch[k] = side + (branch[k - 1] - side) * np.exp(-abs(step) / distance)
