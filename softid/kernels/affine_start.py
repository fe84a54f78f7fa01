"""Where a motion begins under a law that is affine in its state, and how that follows θ.

See `softid.kernels.affine_blocks` for the law.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from softid.kernels import affine_blocks
from softid.kernels.affine_blocks import MUSCLE, N_PARAMETERS
from softid.kernels.cache_invalidation import follow_sources
from softid.kernels.decorators import kernel

Array = npt.NDArray[np.float64]


@kernel
def begin(
    law: int, theta: Array, u: float, start: Array, from_rest: bool, state: Array, tangent: Array
) -> None:
    """State at the first sample, x = E₁/(a1·E₁ + c1) and v = 0 at rest, and its derivatives.

    Parameters
    ----------
    law
        MUSCLE or OSCILLATOR.
    theta
        m, a1, b1, c1, a2, b2, c2 and the oscillator's gain, shape (8,).
    u
        Input at the first sample.
    start
        (x₀, v₀), shape (2,).
    from_rest
        Whether they are a deviation from rest, so that the start follows the parameters.
    state
        Receives (x, v), shape (2,); x is NaN without a spring.
    tangent
        Receives ∂(x, v)/∂(m, a1, b1, c1, a2, b2, c2, x₀, v₀), shape (2, 9).
    """
    state[:] = start
    tangent[:] = 0.0
    tangent[0, N_PARAMETERS] = tangent[1, N_PARAMETERS + 1] = 1.0
    if not from_rest:
        return
    a1, b1, c1, gain = theta[1], theta[2], theta[3], theta[7]
    force, force_by = gain * (u - b1), -gain
    if law == MUSCLE:
        force = np.exp(b1 * u)
        force_by = u * force
    stiffness = a1 * force + c1
    rest = force / stiffness if stiffness != 0.0 else np.nan
    state[0] += rest
    tangent[0, 1] = -rest * force / stiffness
    tangent[0, 2] = force_by * (1.0 - a1 * rest) / stiffness
    tangent[0, 3] = -rest / stiffness


follow_sources(begin, (affine_blocks,))
