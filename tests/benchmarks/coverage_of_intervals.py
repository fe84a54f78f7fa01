"""Print how often nominal 95 % intervals cover the truth, for several noises and methods.

Run from the root of the project::

    python tests/benchmarks/coverage_of_intervals.py --draws 400

Estimates are ordinary least squares; the truth is zero. The regressors are those of a step
experiment: a constant (sensor zero), a sine, a step response and a trend. Columns:

white
    The textbook covariance σ² H⁻¹.
hac
    Newey and West's Bartlett-kernel estimate with Andrews' AR(1) bandwidth.
plug-in
    The sandwich with an autoregression fitted to the residuals as they are, normal quantile.
softid
    `softid.uncertainty.sandwich_covariance`.
"""
# ruff: noqa: T201 (a script that prints its result)

from __future__ import annotations

import argparse
from collections.abc import Callable

import numpy as np
from scipy.signal import lfilter
from scipy.special import stdtrit

from softid.uncertainty import ResidualBlock, autocovariance, fit_ar, sandwich_covariance
from softid.uncertainty.lag_form import LagForm
from softid.uncertainty.linearisation import linearise

NORMAL = 1.959963984540054
REGRESSORS = ("zero", "sine", "step", "trend")
METHODS = ("white", "hac", "plug-in", "softid")
BURN_IN = 10_000

Draw = Callable[[np.random.Generator, int], np.ndarray]


def coloured(rho: float, share: float = 1.0) -> Draw:
    """AR(1) noise of unit variance, of which ``share`` is coloured and the rest white."""

    def draw(rng: np.random.Generator, n: int) -> np.ndarray:
        shocks = rng.normal(size=n + BURN_IN) * np.sqrt(1.0 - rho**2)
        slow = lfilter([1.0], [1.0, -rho], shocks)[BURN_IN:]
        return np.sqrt(share) * slow + np.sqrt(1.0 - share) * rng.normal(size=n)

    return draw


def resonant(rng: np.random.Generator, n: int) -> np.ndarray:
    """AR(2) noise that rings: root radius 0.99, period 45 samples."""
    return lfilter([1.0], [1.0, -1.9609, 0.9801], rng.normal(size=n + BURN_IN))[BURN_IN:]


NOISES: dict[str, Draw] = {
    "white": coloured(0.0),
    "AR(1) 0.9": coloured(0.9),
    "AR(1) 0.99": coloured(0.99),
    "90 % AR 0.9 + 10 % white": coloured(0.9, 0.9),
    "90 % AR 0.99 + 10 % white": coloured(0.99, 0.9),
    "50 % AR 0.99 + 50 % white": coloured(0.99, 0.5),
    "10 % AR 0.99 + 90 % white": coloured(0.99, 0.1),
    "AR(1) 0.999": coloured(0.999),
    "AR(2) ringing": resonant,
}


def regressors(n: int) -> np.ndarray:
    """Constant, sine of five periods, step response with a tenth of the record, trend: (n, 4)."""
    t = np.linspace(0.0, 1.0, n)
    sine, step = np.sin(10.0 * np.pi * t), 1.0 - np.exp(-t / 0.1)
    return np.column_stack((np.ones(n), sine, step, t))


def half_widths(design: np.ndarray, residual: np.ndarray) -> dict[str, np.ndarray]:
    """Half-width of the interval of each regressor by each method."""
    n, count = design.shape
    block = ResidualBlock("y", (design,), (residual,))
    inverse = linearise([block]).inverse
    weights = [design @ inverse]  # δθ = Σ_t W_t r_t
    ar = fit_ar([residual])
    plug_in = LagForm.of(weights).diagonal(autocovariance(ar, n))
    found = sandwich_covariance([block], REGRESSORS)
    quantile = stdtrit(np.array(found.degrees_of_freedom, float), 0.975)
    variance = float(residual @ residual) / (n - count)
    hac = LagForm.of([weights[0] * residual[:, None]]).diagonal(bartlett_weights(residual))
    return {
        "white": NORMAL * np.sqrt(variance * np.diag(inverse)),
        "hac": NORMAL * np.sqrt(hac * n / (n - count)),
        "plug-in": NORMAL * np.sqrt(plug_in),
        "softid": quantile * np.array(found.sd, float),
    }


def bartlett_weights(residual: np.ndarray) -> np.ndarray:
    """Newey and West's weights with Andrews' (1991) bandwidth for an AR(1)."""
    n = residual.size
    rho = min(float(residual[1:] @ residual[:-1]) / float(residual @ residual), 0.995)
    alpha = 4.0 * rho**2 / ((1.0 - rho) ** 2 * (1.0 + rho) ** 2)
    bandwidth = min(1.1447 * (alpha * n) ** (1.0 / 3.0), n - 1.0)
    return np.clip(1.0 - np.arange(n) / (bandwidth + 1.0), 0.0, None)


def coverage(noise: Draw, *, draws: int, n: int, seed: int) -> dict[str, np.ndarray]:
    """Per cent of draws in which the interval covers, per method and regressor."""
    rng = np.random.default_rng(seed)
    design = regressors(n)
    hits: dict[str, list[np.ndarray]] = {method: [] for method in METHODS}
    for _ in range(draws):
        e = noise(rng, n)
        estimate = np.linalg.lstsq(design, e, rcond=None)[0]
        for method, half in half_widths(design, e - design @ estimate).items():
            hits[method].append(np.abs(estimate) <= half)
    return {method: 100.0 * np.mean(rows, axis=0) for method, rows in hits.items()}


def unequal_logs(*, draws: int, seed: int) -> dict[str, float]:
    """Coverage for a shared slope when one log of three is four times as noisy and as lively.

    The logs are taken as one block with a pooled noise model, and as a block each.
    """
    rng = np.random.default_rng(seed)
    hits: dict[str, list[bool]] = {"one block": [], "a block for each log": []}
    sizes = (1.0, 1.0, 4.0)
    lively = np.outer(regressors(700)[:, 2], sizes)
    designs = [np.column_stack((lively[:, k], np.tile(np.eye(3)[k], (700, 1)))) for k in range(3)]
    names = ["gain", "zero 1", "zero 2", "zero 3"]
    for _ in range(draws):
        noises = [size * coloured(0.9)(rng, 700) for size in sizes]
        design, e = np.concatenate(designs), np.concatenate(noises)
        estimate = np.linalg.lstsq(design, e, rcond=None)[0]
        left = [y - x @ estimate for x, y in zip(designs, noises, strict=True)]
        apart = [ResidualBlock("y", (x,), (r,)) for x, r in zip(designs, left, strict=True)]
        pooled = [ResidualBlock("y", tuple(designs), tuple(left))]
        for way, blocks in zip(hits, (pooled, apart), strict=True):
            found = sandwich_covariance(blocks, names)
            half = stdtrit(found.degrees_of_freedom[0], 0.975) * found.sd[0]
            hits[way].append(bool(abs(estimate[0]) <= half))
    return {way: 100.0 * float(np.mean(rows)) for way, rows in hits.items()}


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--draws", type=int, default=400)
    parser.add_argument("--samples", type=int, default=2000)
    parser.add_argument("--seed", type=int, default=20)
    options = parser.parse_args()
    error = 100.0 * np.sqrt(0.95 * 0.05 / options.draws)
    print(f"coverage in %, {options.draws} draws of {options.samples} samples, ±{error:.1f}")
    print(f"each: {', '.join(REGRESSORS)}\n")
    print(f"{'noise':<27}" + "".join(f"{method:>25}" for method in METHODS))
    for name, noise in NOISES.items():
        found = coverage(noise, draws=options.draws, n=options.samples, seed=options.seed)
        cells = [" ".join(f"{v:5.1f}" for v in found[method]) for method in METHODS]
        print(f"{name:<27}" + "".join(f"{cell:>25}" for cell in cells), flush=True)

    print("\nthree logs, one of them four times as noisy and as lively, AR(1) 0.9:")
    for way, percent in unequal_logs(draws=options.draws, seed=options.seed).items():
        print(f"  {way:<22}{percent:6.1f}")


if __name__ == "__main__":
    main()
