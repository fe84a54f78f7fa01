"""The same fit of seven parameters with other tools, each as its users write it."""

from __future__ import annotations

import numpy as np
from numba import njit
from work import NAMES, START

FINE = dict.fromkeys(("ftol", "xtol", "gtol"), 1e-8)


def _rest(theta: np.ndarray, pressure: float) -> list[float]:
    force = np.exp(theta[2] * pressure)
    return [force / (theta[1] * force + theta[3]), 0.0]


def _rates(y, p, mass, a1, b1, c1, a2, b2, c2):
    force = np.exp(b1 * p)
    return [y[1], (force - (a2 * np.exp(b2 * p) + c2) * y[1] - (a1 * force + c1) * y[0]) / mass]


def _lmfit(simulate, y):
    import lmfit

    table = lmfit.Parameters()
    for name, value in zip(NAMES, START, strict=True):
        table.add(name, value=float(value), min=None if name == "b2" else 1e-12)

    def residual(parameters):
        return simulate(np.array([parameters[name].value for name in NAMES])) - y

    # Differences must be larger than the solver's own error, or nothing moves.
    found = lmfit.minimize(residual, table, method="leastsq", epsfcn=1e-8, ftol=1e-8, xtol=1e-8)
    return np.array([found.params[name].value for name in NAMES])


def lmfit_solve_ivp(time_s: np.ndarray, pressure: np.ndarray, y: np.ndarray) -> np.ndarray:
    """lmfit around scipy's solve_ivp with rtol 1e-8."""
    from scipy.integrate import solve_ivp

    def simulate(theta):
        return solve_ivp(
            lambda t, s: _rates(s, np.interp(t, time_s, pressure), *theta),
            (time_s[0], time_s[-1]),
            _rest(theta, pressure[0]),
            t_eval=time_s,
            rtol=1e-8,
            atol=1e-8,
        ).y[0]

    return _lmfit(simulate, y)


def lmfit_odeint(time_s: np.ndarray, pressure: np.ndarray, y: np.ndarray) -> np.ndarray:
    """lmfit around scipy's odeint."""
    from scipy.integrate import odeint

    def simulate(theta):
        return odeint(
            lambda s, t: _rates(s, np.interp(t, time_s, pressure), *theta),
            _rest(theta, pressure[0]),
            time_s,
            rtol=1e-8,
            atol=1e-8,
            hmax=time_s[1] - time_s[0],
            mxstep=100_000,
        )[:, 0]

    return _lmfit(simulate, y)


@njit
def _rk4(theta, time_s, pressure, out):
    mass, a1, b1, c1, a2, b2, c2 = theta
    e0, g0 = np.exp(b1 * pressure[0]), np.exp(b2 * pressure[0])
    x, v = e0 / (a1 * e0 + c1), 0.0
    out[0] = x
    for i in range(time_s.size - 1):
        h = time_s[i + 1] - time_s[i]
        middle = 0.5 * (pressure[i] + pressure[i + 1])
        e1, g1 = np.exp(b1 * middle), np.exp(b2 * middle)
        e2, g2 = np.exp(b1 * pressure[i + 1]), np.exp(b2 * pressure[i + 1])
        q0, q1, q2 = a1 * e0 + c1, a1 * e1 + c1, a1 * e2 + c1
        n0, n1, n2 = a2 * g0 + c2, a2 * g1 + c2, a2 * g2 + c2
        k1 = (e0 - n0 * v - q0 * x) / mass
        v2 = v + 0.5 * h * k1
        k2 = (e1 - n1 * v2 - q1 * (x + 0.5 * h * v)) / mass
        v3 = v + 0.5 * h * k2
        k3 = (e1 - n1 * v3 - q1 * (x + 0.5 * h * v2)) / mass
        v4 = v + h * k3
        k4 = (e2 - n2 * v4 - q2 * (x + h * v3)) / mass
        x += h / 6 * (v + 2 * (v2 + v3) + v4)
        v += h / 6 * (k1 + 2 * (k2 + k3) + k4)
        out[i + 1] = x
        e0, g0 = e2, g2


def numba_least_squares(time_s: np.ndarray, pressure: np.ndarray, y: np.ndarray) -> np.ndarray:
    """A compiled Runge–Kutta loop, finite differences and scipy's least_squares on logarithms."""
    from scipy.optimize import least_squares

    out = np.empty(time_s.size)

    def residual(z):
        _rk4(np.exp(z), time_s, pressure, out)
        return out - y

    return np.exp(least_squares(residual, np.log(START), method="lm", **FINE).x)


def casadi_fit(time_s: np.ndarray, pressure: np.ndarray, y: np.ndarray) -> np.ndarray:
    """CasADi's exact derivatives of a mapped Runge–Kutta step, and least_squares on logarithms."""
    import casadi as ca
    from scipy.optimize import least_squares

    z, s, u = ca.SX.sym("z", 7), ca.SX.sym("s", 2), ca.SX.sym("u", 3)
    t = [ca.exp(z[k]) for k in range(7)]
    h = u[2]

    def rate(at, p):
        force = ca.exp(t[2] * p)
        damping = t[4] * ca.exp(t[5] * p) + t[6]
        return ca.vertcat(at[1], (force - damping * at[1] - (t[1] * force + t[3]) * at[0]) / t[0])

    k1 = rate(s, u[0])
    k2 = rate(s + h / 2 * k1, (u[0] + u[1]) / 2)
    k3 = rate(s + h / 2 * k2, (u[0] + u[1]) / 2)
    k4 = rate(s + h * k3, u[1])
    step = ca.Function("step", [s, u, z], [s + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)])
    n = time_s.size
    inputs = np.vstack([pressure[:-1], pressure[1:], np.diff(time_s)])
    free = ca.MX.sym("free", 7)
    theta = ca.exp(free)
    force = ca.exp(theta[2] * pressure[0])
    start = ca.vertcat(force / (theta[1] * force + theta[3]), 0)
    states = step.mapaccum(n - 1)(start, inputs, ca.repmat(free, 1, n - 1))
    x = ca.vertcat(start[0], states[0, :].T)
    simulate = ca.Function("x", [free], [x])
    slopes = ca.Function("j", [free], [ca.jacobian(x, free)])
    return np.exp(
        least_squares(
            lambda at: np.asarray(simulate(at)).ravel() - y,
            np.log(START),
            jac=lambda at: np.asarray(slopes(at).full()),
            method="lm",
            **FINE,
        ).x
    )


def diffrax_fit(time_s: np.ndarray, pressure: np.ndarray, y: np.ndarray) -> np.ndarray:
    """diffrax with fixed steps on the samples and optimistix' Levenberg–Marquardt."""
    import diffrax
    import jax
    import jax.numpy as jnp
    import optimistix

    jax.config.update("jax_enable_x64", True)
    line = diffrax.LinearInterpolation(jnp.asarray(time_s), jnp.asarray(pressure))

    def rates(t, s, z):
        th = jnp.exp(z)
        p = line.evaluate(t)
        force = jnp.exp(th[2] * p)
        damping = th[4] * jnp.exp(th[5] * p) + th[6]
        return jnp.array([s[1], (force - damping * s[1] - (th[1] * force + th[3]) * s[0]) / th[0]])

    def residual(z, _):
        th = jnp.exp(z)
        force = jnp.exp(th[2] * pressure[0])
        found = diffrax.diffeqsolve(
            diffrax.ODETerm(rates),
            diffrax.Bosh3(),
            time_s[0],
            time_s[-1],
            None,
            jnp.array([force / (th[1] * force + th[3]), 0.0]),
            z,
            saveat=diffrax.SaveAt(ts=jnp.asarray(time_s)),
            stepsize_controller=diffrax.StepTo(jnp.asarray(time_s)),
            max_steps=time_s.size + 1,
            adjoint=diffrax.ForwardMode(),
        )
        return found.ys[:, 0] - y

    solver = optimistix.LevenbergMarquardt(rtol=1e-8, atol=1e-8)
    found = optimistix.least_squares(
        residual, solver, jnp.log(START), options={"jac": "fwd"}, max_steps=200
    )
    return np.exp(np.asarray(found.value))
