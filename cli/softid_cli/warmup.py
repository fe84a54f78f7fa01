"""`softid warmup`: compile all kernels now, so that no later run has to."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from itertools import product
from multiprocessing import get_context
from typing import TYPE_CHECKING

import click

from softid.errors import OutputError
from softid_cli.console import progress
from softid_cli.options import quiet_option

if TYPE_CHECKING:
    from softid.effects.base import Effect
    from softid.log import Log
    from softid.models.base import Model
    from softid.segment import Segment

Job = tuple[str, Callable[[], object]]

SAMPLES = 400
PERIOD_S = 0.01
SEED = 0


@click.command()
@quiet_option
def warmup(quiet: bool) -> None:
    """Compile all kernels now and print the folder that keeps them.

    Without it they are compiled on first use. Kernels that are compiled already are only loaded.
    Useful as a step in building a container image. With two processors or more to use, a second
    process compiles part of them.
    """
    from softid.kernels import cache_folder
    from softid.parallel import usable_cores

    folder = cache_folder()
    if folder is None:
        raise OutputError(
            "there is no folder in which compiled kernels can be kept",
            remedy="let NUMBA_CACHE_DIR name a folder in which you may write",
        )
    helper = None
    if usable_cores() > 1:
        helper = ProcessPoolExecutor(1, mp_context=get_context("spawn"))
        beside = helper.submit(_compile_beside)
    try:
        with progress(quiet=quiet) as report:
            jobs = list(_jobs())
            for k, (what, run) in enumerate(jobs):
                if report is not None:
                    report(f"compiling for {what}", k / (len(jobs) + 1))
                run()
            if report is not None:
                report(
                    "compiling for effects in the motion and equilibrium",
                    len(jobs) / (len(jobs) + 1),
                )
            if helper is None:
                _compile_beside()
            else:
                beside.result()
    finally:
        if helper is not None:
            helper.shutdown(cancel_futures=True)
    click.echo(f"All kernels are compiled. They are kept in {folder}.")


def _compile_beside() -> None:
    """About half of the work: effects in the equation of motion, and the equilibrium model."""
    from softid.models.equilibrium import Equilibrium

    for _, run in _effects(inside=True):
        run()
    _moved(Equilibrium(), _drawn().segments()[0])


def _jobs() -> Iterator[Job]:
    """What compiles everything else between them, with the words for it."""
    from softid.identification import fit

    log = _drawn()
    yield "fits of the muscle", partial(fit, log, model="muscle")
    yield "fits of the oscillator", partial(fit, log, model="oscillator")
    yield from _effects(inside=False)
    yield _pair()


def _effects(*, inside: bool) -> Iterator[Job]:
    """Simulations of the effects that act inside the equation of motion, or of all others."""
    from softid.diagnosis.changes.probes import PROBES
    from softid.diagnosis.verdict.unlisted_laws import LAWS_BESIDE, UNLISTED_LAWS
    from softid.effects import EFFECTS, StateEffect
    from softid.models.muscle import Muscle
    from softid.models.oscillator import Oscillator

    (segment,) = _drawn().segments()
    laws = (*EFFECTS.values(), *UNLISTED_LAWS, *LAWS_BESIDE, *PROBES)
    for law, base in product(laws, (Muscle(), Oscillator())):
        if issubclass(law, StateEffect) == inside:
            yield "effects", partial(_extended, base, (law(),), segment)


def _pair() -> Job:
    """Two effects with states of their own: there is an integrator for every number of them."""
    from softid.effects import EFFECTS
    from softid.models.muscle import Muscle

    (segment,) = _drawn().segments()
    effects = (EFFECTS["creep"](), EFFECTS["softening"]())
    return "two effects at once", partial(_extended, Muscle(), effects, segment)


def _drawn() -> Log:
    """A first-order response to two steps, with noise."""
    import numpy as np

    from softid.log import Log

    time_s = PERIOD_S * np.arange(SAMPLES)
    pressure = np.where(time_s < 1.0, 20.0, 100.0) + 20.0 * (time_s > 2.5)
    angle = 0.3 * np.convolve(pressure, np.exp(-time_s / 0.2) / 20.0)[:SAMPLES]
    noise = np.random.default_rng(SEED).normal(0.0, 0.05, SAMPLES)
    return Log.from_arrays(time_s, {"pressure": pressure, "angle": angle + noise})


def _moved(model: Model, segment: Segment) -> None:
    """Simulate once, with derivatives and without, and look for start values."""
    import numpy as np

    theta = np.array([p.value for p in model.parameters().values()])
    for derivatives in (False, True):
        model.response(theta, segment, ("angle",), start=None, derivatives=derivatives)
    model.guess([segment], "angle")


def _extended(base: Model, effects: tuple[Effect, ...], segment: Segment) -> None:
    """Simulate a model with effects."""
    import numpy as np

    from softid.effects import ExtendedModel, Scale

    angle = segment.outputs["angle"]
    low, high = float(angle.min()), float(angle.max())
    scale = Scale(
        u_low=float(segment.input.min()),
        u_high=float(segment.input.max()),
        x_low=low,
        x_high=high,
        v_max=(high - low) / 0.2,
        force=1.0,
        y_low=low,
        y_high=high,
        period_s=PERIOD_S,
        duration_s=PERIOD_S * SAMPLES,
        motion_s=0.2,
        travel=3.0 * (high - low),
        x_unit="rad",
        y_unit="rad",
    )
    model = ExtendedModel(base.adapted({"input": "kPa", "angle": "rad"}), effects, scale)
    theta = np.array([p.value for p in model.parameters().values()])
    for derivatives in (False, True):
        model.response(theta, segment, ("angle",), start=None, derivatives=derivatives)
