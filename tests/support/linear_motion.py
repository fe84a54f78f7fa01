"""Logs of a mass–spring–damper in closed form, and candidates of a diagnosis that stand on them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import numpy.typing as npt

from softid.diagnosis.refit.candidates import Candidate, TemperedPrior
from softid.diagnosis.refit.characteristic_scales import scale_of
from softid.diagnosis.search.forward_selection import converged
from softid.effects.base import OutputEffect
from softid.effects.scale import Scale
from softid.fitters.levenberg_marquardt import Minimum, NormalEquations
from softid.fitters.problem import Problem
from softid.log import Log
from softid.models import Oscillator
from softid.parameters import Parameter, ParameterSet

Array = npt.NDArray[np.float64]

TRUTH = {"M": 0.4, "N": 10.0, "Q": 50.0}
"""kPa·s²/rad, kPa·s/rad, kPa/rad: a time constant N/Q of 0.2 s, overdamped."""

RATE_HZ = 50.0
SIGMA = {"angle": 0.01}
MODEL = Oscillator(x_unit="rad", u_unit="kPa")


def pressure_course(time_s: Array) -> Array:
    """A rest of 1 s, then a level of 60 kPa with a sine of 30 kPa, back to zero every 5 s."""
    course = 60.0 + 30.0 * np.sin(2.0 * np.pi * 0.7 * time_s)
    return np.where((time_s >= 1.0) & (time_s % 5.0 < 3.5), course, 0.0)


def linear_angle(time_s: Array, pressure: Array, truth: Mapping[str, float] = TRUTH) -> Array:
    """The exact answer of M·ẍ + N·ẋ + Q·x = p to an input that is straight between samples."""
    from scipy.signal import lsim

    system = ([1.0], [truth["M"], truth["N"], truth["Q"]])
    angle: Array = lsim(system, pressure, time_s, interp=True)[1]
    return angle


def linear_log(
    *, noise: float = 0.0, seed: int = 0, samples: int = 1000, added: Array | float = 0.0
) -> Log:
    """A log of the linear actuator; ``added`` is put on the angle, in rad, and so is the noise."""
    time_s = np.arange(samples) / RATE_HZ
    pressure = pressure_course(time_s)
    trembling = noise * np.random.default_rng(seed).standard_normal(samples)
    angle = linear_angle(time_s, pressure) + added + trembling
    return Log.from_arrays(time_s, {"pressure": pressure, "angle": angle}, name=f"linear-{seed}")


def smoothed_levels(time_s: Array, seed: int) -> Array:
    """A rest of 1 s, then random levels of 10 to 100 kPa for 50 samples each, with slow edges."""
    levels = np.random.default_rng(100 + seed).uniform(10.0, 100.0, time_s.size // 50)
    smooth = np.convolve(np.repeat(levels, 50), np.ones(10) / 10.0, mode="same")
    return np.where(time_s < 1.0, 0.0, smooth)


def swinging_log(seed: int, delay_s: float = 0.0, *, polyline: bool = False) -> Log:
    """A chirp of the pressure up to 5 Hz at 50 Hz, and the exact answer of the linear actuator.

    The pressure is smooth between the samples, or goes straight.
    """
    fine = 20
    time_s = np.arange(40 * RATE_HZ) / RATE_HZ
    fine_s = np.arange(time_s.size * fine) / (RATE_HZ * fine)

    def course(at_s: Array) -> Array:
        since = np.maximum(at_s, 0.0)
        return 50.0 + 40.0 * np.sin(2.0 * np.pi * (0.2 * since + 0.06 * since**2) + seed)

    arriving = np.interp(fine_s, time_s, course(time_s)) if polyline else course(fine_s - delay_s)
    angle = linear_angle(fine_s, arriving)[::fine]
    angle += 0.003 * np.ptp(angle) * np.random.default_rng(seed).standard_normal(angle.size)
    channels = {"pressure": course(time_s), "angle": angle}
    return Log.from_arrays(time_s, channels, outputs=("angle",), name=f"swinging-{seed}")


def linear_problem(logs: Sequence[Log], *, fixed: bool = False) -> Problem:
    """The oscillator over some logs, at the truth; fixed leaves the sensor zeros alone."""
    declared = MODEL.parameters().with_values(TRUTH)
    return Problem(MODEL, declared.with_fixed(TRUTH) if fixed else declared, logs)


def base_problem() -> tuple[Problem, Scale]:
    """The oscillator over one log under noise of 0.01 rad, and its sizes at the truth."""
    problem = linear_problem([linear_log(noise=0.01)])
    return problem, scale_of(problem, problem.unknowns(TRUTH))


def standing(problem: Problem, z: Array, sigma: Mapping[str, float] = SIGMA) -> Candidate:
    """The candidate without effects that stands at ``z``, held by no prior."""
    cost = sum(
        0.5 * float(block.residual @ block.residual) / sigma[block.channel] ** 2
        for block in problem.blocks(z, derivatives=False)
    )
    size = problem.size
    normal = NormalEquations(z, cost, np.zeros(size), np.eye(size), problem.n_samples)
    prior = TemperedPrior(z.copy(), np.zeros(size), 1.0)
    return Candidate((), problem, Minimum(z, normal, 0, 0.0), prior)


def sizes_of(model: Candidate) -> Scale:
    """The sizes by which bounds and starts go, of a model where it stands."""
    return scale_of(model.problem, model.minimum.point)


def excess_over(noise: float, model: Candidate) -> float:
    """Variance above that of a known noise that a model leaves, as a share of the latter."""
    blocks = model.problem.blocks(model.minimum.point, derivatives=False)
    left = np.concatenate([block.residual for block in blocks])
    return float(np.mean(left**2) / noise**2 - 1.0)


def at_truth(log: Log) -> Candidate:
    """The candidate without effects that stands at the truth over one log."""
    problem = linear_problem([log])
    return standing(problem, problem.unknowns(TRUTH))


def parabolic() -> tuple[Candidate, Scale]:
    """The linear actuator fitted to a parabola of 0.05 under noise of 0.01."""
    time_s = linear_log().time_s
    problem = linear_problem([linear_log(noise=0.01, added=0.05 * (time_s / time_s[-1]) ** 2)])
    z = problem.unknowns(TRUTH)
    return converged(standing(problem, z), SIGMA), scale_of(problem, z)


@dataclass(frozen=True)
class Bow(OutputEffect):
    """A reading that is bent by a parabola of time, + c (t/T)²."""

    name: ClassVar[str] = "bow"
    title: ClassVar[str] = "Bow"
    law: ClassVar[str] = "recorded y = y + c (t/T)^2"
    meaning: ClassVar[str] = "A reading that bends."
    signature: ClassVar[str] = "A parabola."
    shown_by: ClassVar[str] = "a long log"
    source: ClassVar[str] = "a test"
    amplitude: ClassVar[str] = "c"

    def parameters(self, scale: Scale) -> ParameterSet:
        """The size c, of one sign."""
        del scale
        return ParameterSet((Parameter("c", 0.1, "rad", 0.0, 10.0, meaning="size"),))

    def starts(self, scale: Scale) -> tuple[Mapping[str, float], ...]:
        """One."""
        del scale
        return ({"c": 0.1},)

    def apply(self, eta: Array, time_s: Array, y: Array, scale: Scale) -> Array:
        """Add the parabola."""
        bent: Array = y + eta[0] * (time_s / scale.duration_s) ** 2
        return bent


@dataclass(frozen=True)
class Gain(Bow):
    """A reading that is too large by a share, + c y: the stiffness of the base can mimic it."""

    name: ClassVar[str] = "gain"

    def apply(self, eta: Array, time_s: Array, y: Array, scale: Scale) -> Array:
        """Enlarge."""
        del time_s, scale
        larger: Array = (1.0 + eta[0]) * y
        return larger
