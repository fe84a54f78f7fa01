"""Cost, normal equations and the bend of a fit of an affine law, compiled as one.

Every segment and channel contributes columns C (seven derivatives, two by the initial state, one,
residual) and their products G = C Cᵀ; weights T make up the Jacobian, J = Cᵀ T, and t the residual.
Then JᵀJ = Tᵀ G T and Jᵀr = Tᵀ G t, and a zero moves to its optimum by changing t.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from numba import njit

from softid.kernels.affine_blocks import run_positions, sum_columns
from softid.kernels.affine_work import CHUNK, Drive, Measured, Room, Unknowns
from softid.kernels.decorators import inner, written_out
from softid.kernels.lanes import MUSCLE, N_COLUMNS, N_PARAMETERS, N_STATES, SUMMING

Array = npt.NDArray[np.float64]


ONE, RESIDUAL = N_COLUMNS - 2, N_COLUMNS - 1


@written_out
def set_parameters(drive: Drive, unknowns: Unknowns, z: Array) -> None:
    """The kernels' parameters at ``z``."""
    for f in range(unknowns.inner.size):
        value = np.exp(z[f]) if unknowns.logarithmic[f] else z[f]
        drive.theta[unknowns.inner[f]] = unknowns.factor[f] * value


@written_out
def _begin(
    drive: Drive, unknowns: Unknowns, z: Array, s: int, state: Array, tangent: Array
) -> None:
    """(x, v) at the first sample of a segment, shape (2,), and its derivatives, shape (2, 9)."""
    theta, u = drive.theta, drive.u[drive.edges[s]]
    tangent[:] = 0.0
    tangent[0, N_PARAMETERS] = tangent[1, N_PARAMETERS + 1] = 1.0
    state[0], state[1] = 0.0, 0.0
    if drive.anchored[s]:
        if drive.law == MUSCLE:
            force = np.exp(theta[2] * u)
            force_by = u * force
        else:
            force, force_by = theta[7] * (u - theta[2]), -theta[7]
        stiffness = theta[1] * force + theta[3]
        rest = force / stiffness
        state[0] = rest
        tangent[0, 1] = -rest * force / stiffness
        tangent[0, 2] = force_by * (1.0 - theta[1] * rest) / stiffness
        tangent[0, 3] = -rest / stiffness
    at = unknowns.state_at[s]
    if at >= 0:
        for k in range(unknowns.states):
            state[k] += z[at + k]


@written_out
def _sum_all(drive: Drive, measured: Measured, unknowns: Unknowns, room: Room, side: int) -> None:
    """Products of the columns of every segment and channel at a place."""
    z = room.point[side]
    kept = room.first if side == 0 else room.second
    rows = drive.time_s.size
    state, tangent, at = room.state, room.tangent, room.at
    set_parameters(drive, unknowns, z)
    for s in range(drive.rules.size):
        a, b = drive.edges[s], drive.edges[s + 1]
        for c in range(measured.gain.size):
            zero = unknowns.zero_at[s, c]
            level = measured.level[c] + (z[zero] if zero >= 0 else 0.0)
            _begin(drive, unknowns, z, s, state, tangent)
            sum_columns(
                drive.law, drive.rules[s], drive.theta, drive.time_s[a:b], drive.u[a:b],
                drive.counts[a : b - 1], measured.y[c * rows + a : c * rows + b],
                measured.used[c * rows + a : c * rows + b], measured.gain[c], level, state,
                tangent, room.work, room.ends, at, kept, c * N_COLUMNS, a, room.gram[side, s, c],
            )  # fmt: skip


@written_out
def _move_zeros(drive: Drive, measured: Measured, unknowns: Unknowns, room: Room, side: int) -> int:
    """Move every zero to its optimum, the mean residual of its log; returns the residuals."""
    z, shift, total = room.point[side], room.shift[side], room.small[0]
    shift[:] = 0.0
    total[:] = 0.0
    n = 0
    for s in range(drive.rules.size):
        for c in range(measured.gain.size):
            gram, zero = room.gram[side, s, c], unknowns.zero_at[s, c]
            n += round(gram[ONE, ONE]) if np.isfinite(gram[ONE, ONE]) else 0
            if zero >= 0:
                total[zero] += gram[ONE, ONE]
                shift[zero] += gram[ONE, RESIDUAL]
    for k in range(z.size):
        shift[k] = shift[k] / total[k] if total[k] > 0.0 and np.isfinite(shift[k]) else 0.0
        z[k] += shift[k]
    return n


@written_out
def _weigh(drive: Drive, measured: Measured, unknowns: Unknowns, s: int, c: int, t: Array) -> int:
    """T of one piece as the unknown and the weight of every column but the last two.

    Parameters k with an unknown stand at ``t[0, k]`` (the unknown, or −1) and ``t[1, k]``.
    """
    gain = measured.gain[c]
    for k in range(N_PARAMETERS + N_STATES):
        t[0, k], t[1, k] = -1.0, 0.0
    for f in range(unknowns.inner.size):
        k = unknowns.inner[f]
        t[0, k] = f
        t[1, k] = gain * (drive.theta[k] if unknowns.logarithmic[f] else unknowns.factor[f])
    at = unknowns.state_at[s]
    if at >= 0:
        for k in range(unknowns.states):
            t[0, N_PARAMETERS + k], t[1, N_PARAMETERS + k] = at + k, gain
    t[0, ONE], t[1, ONE] = unknowns.zero_at[s, c], 1.0
    return int(t[0, ONE])


@written_out
def evaluate(
    drive: Drive, measured: Measured, unknowns: Unknowns, room: Room, side: int
) -> tuple[float, int]:
    """Cost with its prior, and number of residuals, at a place of the room; fills the place."""
    _sum_all(drive, measured, unknowns, room, side)
    n = _move_zeros(drive, measured, unknowns, room, side)
    z, t = room.point[side], room.small[1:3]
    gradient, matrix = room.gradient[side], room.matrix[side]
    gradient[:] = 0.0
    matrix[:] = 0.0
    cost = 0.0
    for s in range(drive.rules.size):
        for c in range(measured.gain.size):
            zero = _weigh(drive, measured, unknowns, s, c, t)
            gram, weight = room.gram[side, s, c], measured.weight[c]
            moved = room.shift[side, zero] if zero >= 0 else 0.0
            left = gram[RESIDUAL, RESIDUAL] - moved * gram[RESIDUAL, ONE]
            left -= moved * (gram[ONE, RESIDUAL] - moved * gram[ONE, ONE])
            cost += 0.5 * weight * max(left, 0.0)
            for i in range(N_COLUMNS - 1):
                p = int(t[0, i])
                if p < 0:
                    continue
                gradient[p] += weight * t[1, i] * (gram[i, RESIDUAL] - moved * gram[i, ONE])
                for j in range(N_COLUMNS - 1):
                    q = int(t[0, j])
                    if q >= 0:
                        matrix[p, q] += weight * t[1, i] * t[1, j] * gram[i, j]
    total = cost
    for k in range(z.size):
        away = z[k] - unknowns.centre[k]
        cost += 0.5 * unknowns.prior[k] * away * away
        gradient[k] -= unknowns.prior[k] * away
        matrix[k, k] += unknowns.prior[k]
        for j in range(z.size):
            total += matrix[k, j]
        total += gradient[k]
    if not np.isfinite(total):
        cost = np.inf
    return cost, n


@njit(nogil=True, error_model="numpy", fastmath=SUMMING)
def _dot(kept: Array, row: int, a: int, b: int, away: Array) -> float:
    total = 0.0
    column = kept[row, a:b]
    for i in range(column.size):
        total += column[i] * away[i]
    return total


@inner
def _pull(kept: Array, row: int, a: int, b: int, made: Array, away: Array, pulled: Array) -> None:
    """Add columns times what is left of the straight line, over some samples."""
    for j in range(N_COLUMNS):
        weight = made[j]
        if weight != 0.0:
            column = kept[row + j, a:b]
            for i in range(column.size):
                away[i] += weight * column[i]
    for j in range(N_COLUMNS - 1):
        pulled[j] += _dot(kept, row + j, a, b, away)


@written_out
def _pull_piece(
    drive: Drive, measured: Measured, room: Room, side: int, c: int, a: int, b: int, level: float
) -> None:
    """Columns times (straight − true) residual of one piece, into the fifth small vector."""
    kept = room.first if side == 0 else room.second
    made, pulled = room.small[3], room.small[4]
    pulled[:] = 0.0
    away = room.away
    gain, rows = measured.gain[c], drive.time_s.size
    for begin in range(a, b, CHUNK):
        end = min(begin + CHUNK, b)
        for i in range(end - begin):
            k = c * rows + begin + i
            there = measured.y[k] - level - gain * room.x[begin + i]
            away[i] = -there if measured.used[k] else 0.0
        _pull(kept, c * N_COLUMNS, begin, end, made, away, pulled)


@written_out
def bend(
    drive: Drive,
    measured: Measured,
    unknowns: Unknowns,
    room: Room,
    side: int,
    step: Array,
    fraction: float,
    z: Array,
    total: Array,
) -> bool:
    """Jᵀ∂²ŷ/∂v² for v = ``step`` into ``total``, shape (U,); False where it is not finite.

    ``z`` is overwritten, shape (U,). Needs the kept columns at the place.
    """
    state, tangent, at = room.state, room.tangent, room.at
    t, made, pulled = room.small[1:3], room.small[3], room.small[4]
    for k in range(z.size):
        z[k] = room.point[side, k] + fraction * step[k]
        total[k] = 0.0
    for s in range(drive.rules.size):
        a, b = drive.edges[s], drive.edges[s + 1]
        set_parameters(drive, unknowns, z)
        _begin(drive, unknowns, z, s, state, tangent)
        run_positions(
            drive.law, drive.rules[s], drive.theta, drive.time_s[a:b], drive.u[a:b],
            drive.counts[a : b - 1], state, room.work, room.ends, at, room.x[a:b],
        )  # fmt: skip
        set_parameters(drive, unknowns, room.point[side])
        for c in range(measured.gain.size):
            zero = _weigh(drive, measured, unknowns, s, c, t)
            for j in range(N_COLUMNS - 1):
                p = int(t[0, j])
                made[j] = -fraction * t[1, j] * step[p] if p >= 0 else 0.0
            made[RESIDUAL] = 1.0
            made[ONE] -= room.shift[side, zero] if zero >= 0 else 0.0
            level = measured.level[c] + (z[zero] if zero >= 0 else 0.0)
            _pull_piece(drive, measured, room, side, c, a, b, level)
            weight = 2.0 / (fraction * fraction) * measured.weight[c]
            for j in range(N_COLUMNS - 1):
                p = int(t[0, j])
                if p >= 0:
                    total[p] += weight * t[1, j] * pulled[j]
    finite = True
    for k in range(z.size):
        finite = finite and np.isfinite(total[k])
    return finite
