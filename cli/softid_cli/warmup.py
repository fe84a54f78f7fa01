"""`softid warmup`: compile all kernels now, so that no later run has to."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from itertools import product
from typing import TYPE_CHECKING

import click

from softid_cli.console import progress
from softid_cli.options import quiet_option

if TYPE_CHECKING:
    from softid.log import Log, Segment
    from softid.models.base import Model

Job = tuple[str, Callable[[], object]]

SAMPLES = 400
PERIOD_S = 0.01
SEED = 0


@click.command()
@quiet_option
def warmup(quiet: bool) -> None:
    """Compile all kernels now and say where they are kept.

    Fits small made-up logs with every model that has kernels and simulates every effect. What is
    compiled already is only loaded. Worth a line in the recipe of a container or a CI image.
    """
    from softid.kernels import cache_folder

    with progress(quiet=quiet) as report:
        jobs = list(_jobs())
        for k, (what, run) in enumerate(jobs):
            if report is not None:
                report(f"compiling for {what}", k / len(jobs))
            run()
    click.echo(f"All kernels are compiled. They are kept in {cache_folder()}.")


def _jobs() -> Iterator[Job]:
    """What compiles everything between them, with the words for it."""
    from softid.effects import EFFECTS
    from softid.identification import fit
    from softid.models.equilibrium import Equilibrium
    from softid.models.muscle import Muscle
    from softid.models.oscillator import Oscillator

    log = _drawn()
    (segment,) = log.segments()
    yield "fits of the muscle", partial(fit, log, model="muscle")
    yield "fits of the oscillator", partial(fit, log, model="oscillator")
    yield "equilibrium", partial(_moved, Equilibrium(), segment)
    for key, base in product(EFFECTS, (Muscle(), Oscillator())):
        yield "effects", partial(_extended, base, key, segment)


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


def _extended(base: Model, key: str, segment: Segment) -> None:
    """Simulate a model with one effect."""
    import numpy as np

    from softid.effects import EFFECTS, ExtendedModel, Scale

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
    model = ExtendedModel(base.adapted({"input": "kPa", "angle": "rad"}), (EFFECTS[key](),), scale)
    theta = np.array([p.value for p in model.parameters().values()])
    for derivatives in (False, True):
        model.response(theta, segment, ("angle",), start=None, derivatives=derivatives)
