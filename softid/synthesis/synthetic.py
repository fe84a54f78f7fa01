"""From a recipe to a log whose truth is known, and to the bytes of its CSV."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
import numpy.typing as npt

from softid.arguments import refused
from softid.channels import read_only
from softid.errors import InputError
from softid.log import Log
from softid.synthesis.bending_law import equilibrium_motion
from softid.synthesis.columns import Column
from softid.synthesis.laws import (
    POLYNOMIAL_PARAMETERS,
    Motion,
    muscle_motion,
    oscillator_motion,
    quartic,
)
from softid.synthesis.recipe import PRESSURE_CHANNELS, Recipe
from softid.synthesis.truth import Truth, integrate

Array = npt.NDArray[np.float64]

TIME_COLUMN = "time_s"


@dataclass(frozen=True, eq=False)
class SyntheticLog:
    """A log with known truth.

    Attributes
    ----------
    name
        Stem of the CSV.
    recipe
        What it was made from.
    seed
        Seed used; the recipe's unless another was asked for.
    time_s
        Recorded times, shape (n,).
    columns
        CSV column → recorded values in the unit of its name, shape (n,); NaN where blank.
    truth
        Parameter → true value.
    units
        Parameter → unit.
    sigma
        CSV column → standard deviation of what its sensor added, in the column's unit.
    truth_columns
        CSV column → noise-free values, shape (n,), without sensor zero. For tests alone: they are
        never written to a file.
    """

    name: str
    recipe: Recipe
    seed: int
    time_s: Array
    columns: Mapping[str, Array]
    truth: Mapping[str, float]
    units: Mapping[str, str]
    sigma: Mapping[str, float]
    truth_columns: Mapping[str, Array]

    def to_log(self, *, input: str = "pressure", outputs: Sequence[str] = ()) -> Log:
        """The recorded columns as a log, the same that the CSV reads back to.

        Parameters
        ----------
        input
            Channel that drives.
        outputs
            Channels to be explained; none takes the first that is known.
        """
        columns = self.recipe.columns
        return Log.from_arrays(
            self.time_s,
            {columns[name].channel: values for name, values in self.columns.items()},
            units={column.channel: column.unit for column in columns.values()},
            input=input,
            outputs=outputs,
            name=self.name,
        )


def synthesize(recipe: Recipe, *, seed: int | None = None) -> SyntheticLog:
    """Make the log that a recipe describes.

    The law is integrated by an adaptive solver with a relative tolerance of 1e-11, apart from every
    simulator that fits; sampling and sensors come afterwards.

    Parameters
    ----------
    recipe
        What to make.
    seed
        Used in place of the recipe's.

    Returns
    -------
    SyntheticLog
        Recorded columns, with the parameters and the noise that made them.

    Raises
    ------
    InputError
        The law has no finite response, or too few rows are left.
    UsageError
        This is no recipe, such as the name of a file.

    Examples
    --------
    >>> from softid.synthesis import bundled_datasets, load_recipe
    >>> recipe = load_recipe(bundled_datasets() / "recipes" / "zhao_middle.toml")
    >>> made = synthesize(recipe, seed=1)
    >>> list(made.columns), len(made.to_log())
    (['pressure_kpa', 'angle_rad', 'torque_nmm'], 1201)
    """
    if not isinstance(recipe, Recipe):
        raise refused("a recipe", recipe, "read one from its file with softid.load_recipe")
    used = recipe.seed if seed is None else seed
    if used < 0:
        raise InputError("a seed cannot be negative", value=used, remedy="give 0 or more")
    # One stream each, so that a change of one sensor leaves the noise of the others alone.
    excitation_rng, clock_rng, *sensor_rngs = np.random.default_rng(used).spawn(
        2 + len(recipe.sensors)
    )
    pieces = recipe.excitation.pieces(0.0, excitation_rng)
    time_s = recipe.sampling.times(pieces[-1].stop_s, clock_rng)
    truth = integrate(
        pieces, time_s + recipe.sampling.skip_s, motion=_motion(recipe), valve=recipe.valve
    )
    true_columns = {
        name: read_only(_true_channel(recipe, column, truth) / column.factor)
        for name, column in recipe.columns.items()
    }
    recorded = {
        name: read_only(sensor.read(true_columns[name], rng))
        for (name, sensor), rng in zip(recipe.sensors.items(), sensor_rngs, strict=True)
    }
    return SyntheticLog(
        name=recipe.name,
        recipe=recipe,
        seed=used,
        time_s=read_only(time_s),
        columns=MappingProxyType(recorded),
        truth=recipe.parameters,
        units=MappingProxyType(recipe.units),
        sigma=MappingProxyType({name: s.sigma for name, s in recipe.sensors.items()}),
        truth_columns=MappingProxyType(true_columns),
    )


def to_csv_bytes(synthetic: SyntheticLog) -> bytes:
    """The CSV of a synthetic log: header, decimal points, line feeds, empty cells where blank.

    Every number has a fixed count of decimals, far coarser than the solver's error, so that another
    machine's last binary digit does not show.
    """
    recipe = synthetic.recipe
    decimals = (recipe.sampling.decimals, *(s.decimals for s in recipe.sensors.values()))
    return csv_bytes(synthetic.time_s, synthetic.columns, decimals)


def csv_bytes(time_s: Array, columns: Mapping[str, Array], decimals: Sequence[int]) -> bytes:
    """A CSV of times and columns; NaN becomes an empty cell.

    Parameters
    ----------
    time_s
        Times, shape (n,).
    columns
        Header → values, shape (n,).
    decimals
        Decimals of the time and of each column.
    """
    written = [
        ["" if v != v else f"{v:.{places}f}" for v in values.tolist()]  # NaN differs from itself
        for places, values in zip(decimals, (time_s, *columns.values()), strict=True)
    ]
    lines = [",".join((TIME_COLUMN, *columns))]
    lines += [",".join(row) for row in zip(*written, strict=True)]
    return ("\n".join(lines) + "\n").encode("ascii")


def _motion(recipe: Recipe) -> Motion | None:
    if recipe.model == "muscle":
        return muscle_motion(recipe.parameters)
    if recipe.model == "oscillator":
        return oscillator_motion(recipe.parameters)
    if recipe.actuator is not None:
        return equilibrium_motion(recipe.parameters, recipe.actuator)
    return None


def _true_channel(recipe: Recipe, column: Column, truth: Truth) -> Array:
    """Noise-free values of a channel in its canonical unit, shape (n,)."""
    channel = column.channel
    if channel in PRESSURE_CHANNELS:
        return truth.pressure_kpa if channel == "pressure" else truth.command_kpa
    if truth.position is None:
        coefficients = tuple(recipe.parameters[f"{channel}.{p}"] for p in POLYNOMIAL_PARAMETERS)
        return quartic(coefficients, truth.pressure_kpa)
    if recipe.model == "equilibrium":
        drifted_s = truth.time_s - recipe.sampling.skip_s
        return truth.position + recipe.parameters["drift"] * drifted_s
    if recipe.geometry is not None and channel != "contraction":
        if channel == "distance":
            return recipe.geometry.distance_mm(truth.position)
        if channel == "angle":
            return recipe.geometry.angle_rad(truth.position)
        if channel == "length":
            return recipe.geometry.fixed_length_mm - truth.position
    return truth.position
