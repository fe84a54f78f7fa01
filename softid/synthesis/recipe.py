"""Recipes: TOML files that say what a synthetic log contains."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields
from pathlib import Path
from types import MappingProxyType
from typing import Annotated, Literal

from softid.errors import InputError, refuse_unknown
from softid.synthesis.bending_law import Bender, equilibrium_units
from softid.synthesis.columns import Column, parse_column
from softid.synthesis.laws import (
    Arc,
    parameter_units,
    polynomial_units,
)
from softid.synthesis.sensors import Sampling, Sensor
from softid.synthesis.tables import Checked, Range, read_record, require_table
from softid.synthesis.truth import Valve
from softid.synthesis.waveforms import Waveform, read_waveform
from softid.toml_files import TomlKind, parse_toml, read_toml_bytes

PRESSURE_CHANNELS = ("pressure", "pressure_command")
ZERO_OR_MORE = ("a2", "b2", "offset", "G", "a", "b", "rest_torque", "drift")
"""Parameters of dynamic laws that need not be positive."""

_KIND = TomlKind("recipe", "name a TOML recipe, such as one of datasets_synthetic/recipes")


@dataclass(frozen=True)
class Recipe(Checked):
    """Everything that decides the bytes of a synthetic log.

    Attributes
    ----------
    name
        Stem of the CSV.
    model
        ``"muscle"``, ``"oscillator"``, ``"polynomial"`` or ``"equilibrium"``.
    parameters
        Name → true value; for the polynomial ``"angle.p1"``, channel and coefficient.
    excitation
        Commanded pressure.
    sampling
        Clock of the rig.
    sensors
        Column of the CSV → its sensor, in the order of the columns.
    seed
        Of all that is random.
    title
        One line for people.
    x_unit
        Unit of x in the law of motion: ``"mm"`` or ``"rad"``.
    geometry
        Arc that links contraction, distance and angle, or None.
    actuator
        Section, length and material of the bending actuator; needed for ``"equilibrium"`` only.
    valve
        Valve between command and pressure, or None for an ideal one.
    assumed
        Parameters and lengths that no paper prints.
    notes
        Sentences for the reader of the manifest.
    group, role
        Logs of one group share their truth and are fitted together, or held out.

    Raises
    ------
    InputError
        Parameters, columns and geometry do not belong together.
    """

    name: str
    model: Literal["muscle", "oscillator", "polynomial", "equilibrium"]
    parameters: Mapping[str, float]
    excitation: Waveform
    sampling: Sampling
    sensors: Mapping[str, Sensor]
    seed: Annotated[int, Range(lower=0)]
    title: str = ""
    x_unit: Literal["mm", "rad"] = "mm"
    geometry: Arc | None = None
    actuator: Bender | None = None
    valve: Valve | None = None
    assumed: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()
    group: str = ""
    role: Literal["fit", "hold_out"] = "fit"

    def __post_init__(self) -> None:
        super().__post_init__()
        object.__setattr__(self, "parameters", MappingProxyType(dict(self.parameters)))
        object.__setattr__(self, "sensors", MappingProxyType(dict(self.sensors)))
        if not re.fullmatch(r"[A-Za-z0-9_-]{1,80}", self.name):
            raise InputError(
                "the name cannot be the stem of a file",
                value=self.name,
                remedy="use letters, digits, _ and -",
            )
        self._check_columns()
        self._check_parameters()
        if (self.model == "equilibrium") != (self.actuator is not None):
            raise InputError(
                "the table actuator belongs to the equilibrium model, which needs it",
                where="actuator",
                value=self.model,
                remedy="add or remove [actuator]",
            )
        parts = [part for part in (self.geometry, self.actuator) if part is not None]
        lengths = [f.name for part in parts for f in fields(part)]
        refuse_unknown(self.assumed, [*self.parameters, *lengths], where="assumed")

    @property
    def columns(self) -> dict[str, Column]:
        """Column of the CSV → channel and unit."""
        return {name: parse_column(name) for name in self.sensors}

    @property
    def output_channels(self) -> tuple[str, ...]:
        """Channels other than the pressures, in the order of the columns."""
        channels = [column.channel for column in self.columns.values()]
        return tuple(c for c in channels if c not in PRESSURE_CHANNELS)

    @property
    def units(self) -> dict[str, str]:
        """Unit of each parameter."""
        if self.model == "equilibrium":
            return equilibrium_units()
        if self.model != "polynomial":
            return parameter_units(self.model, self.x_unit)
        canonical = {c.channel: c.canonical_unit for c in self.columns.values()}
        return {
            f"{channel}.{name}": unit
            for channel in self.output_channels
            for name, unit in polynomial_units(canonical[channel]).items()
        }

    def _check_columns(self) -> None:
        possible = _possible_outputs(self)
        for name, column in self.columns.items():
            if column.channel not in (*PRESSURE_CHANNELS, *possible):
                raise InputError(
                    f"a {self.model} with x in {self.x_unit} "
                    f"{'and' if self.geometry else 'without'} geometry has no such column",
                    where="sensors",
                    value=name,
                    remedy=f"choose from {', '.join((*PRESSURE_CHANNELS, *possible))}",
                )
        channels = [column.channel for column in self.columns.values()]
        if len(set(channels)) < len(channels) or not self.output_channels:
            raise InputError(
                "the columns need one pressure and one output, each channel once",
                where="sensors",
                value=list(self.sensors),
                remedy="add or remove [sensors.…] tables",
            )
        if not set(PRESSURE_CHANNELS) & set(channels):
            raise InputError(
                "no pressure is recorded", where="sensors", remedy="add [sensors.pressure_kpa]"
            )

    def _check_parameters(self) -> None:
        wanted = list(self.units)
        refuse_unknown(self.parameters, wanted, where="parameters")
        for name in wanted:
            if name not in self.parameters:
                raise InputError(
                    f"the parameter {name} is missing",
                    where="parameters",
                    remedy=f"give {', '.join(wanted)}",
                )
            value = self.parameters[name]
            free = self.model == "polynomial" or name in ZERO_OR_MORE
            if not Range().holds(value) or not (free or value > 0.0):
                raise InputError(
                    f"the parameter {name} must be {'finite' if free else 'positive'}",
                    where="parameters",
                    value=value,
                    remedy="correct it",
                )


def _possible_outputs(recipe: Recipe) -> tuple[str, ...]:
    if recipe.model == "polynomial":
        return ("angle", "torque", "force", "contraction", "distance", "position")
    if recipe.x_unit == "rad" or recipe.model == "equilibrium":
        return ("angle",)
    if recipe.model == "oscillator":
        return ("contraction", "position", "distance")
    plain = ("contraction", "position")
    return (*plain, "length", "distance", "angle") if recipe.geometry is not None else plain


_KEYS = tuple(f.name for f in fields(Recipe))


def load_recipe(path: Path | str) -> Recipe:
    """Read and check a recipe.

    Parameters
    ----------
    path
        A TOML file; its keys are the fields of `Recipe`.

    Returns
    -------
    Recipe
        What `synthesize` makes a log of.

    Raises
    ------
    InputError
        The file cannot be read, is no TOML, or a key is unknown, missing or of another type.

    Examples
    --------
    >>> from softid.synthesis import bundled_datasets
    >>> recipe = load_recipe(bundled_datasets() / "recipes" / "oscillator_steps.toml")
    >>> recipe.model, recipe.seed, recipe.parameters["Q"]
    ('oscillator', 301, 60.0)
    """
    path = Path(path)
    return parse_recipe(read_recipe_bytes(path), where=path.name)


def read_recipe_bytes(path: Path) -> bytes:
    """The bytes of a recipe.

    Raises
    ------
    InputError
        The file is missing, a folder, too large or may not be read.
    """
    return read_toml_bytes(path, _KIND)


def parse_recipe(content: bytes, *, where: str) -> Recipe:
    """Check the content of a recipe.

    Parameters
    ----------
    content
        TOML text in UTF-8.
    where
        Name of the file, for the errors.

    Raises
    ------
    InputError
        As `load_recipe`.
    """
    table: dict[str, object] = parse_toml(content, _KIND, where=where)
    refuse_unknown(table, _KEYS, where=where)
    known: dict[str, object] = {"geometry": None, "actuator": None, "valve": None}
    for name, reader in _TABLES.items():
        if name in table:
            known[name] = reader(table.pop(name), f"{where}, [{name}]")
        elif name not in known:
            raise InputError(f"the table {name} is missing", where=where, remedy=f"add [{name}]")
    return read_record(Recipe, table, where=where, known=known)


def _read_parameters(table: object, where: str) -> dict[str, float]:
    """Numbers by name; a table of a channel's coefficients becomes ``channel.name``."""
    found: dict[str, float] = {}
    for name, value in require_table(table, where=where).items():
        if isinstance(value, dict):
            inner = _read_parameters(value, f"{where}.{name}")
            found.update({f"{name}.{key}": number for key, number in inner.items()})
        elif isinstance(value, bool) or not isinstance(value, int | float):
            raise InputError("a number is expected", where=f"{where}, {name}", value=value)
        else:
            found[name] = float(value)
    return found


def _read_sensors(table: object, where: str) -> dict[str, Sensor]:
    found = {}
    for column, inner in require_table(table, where=where).items():
        parse_column(column, where=where)
        found[column] = read_record(Sensor, inner, where=f"{where}.{column}")
    return found


_TABLES: dict[str, Callable[[object, str], object]] = {
    "parameters": _read_parameters,
    "excitation": lambda table, where: read_waveform(table, where=where),
    "sampling": lambda table, where: read_record(Sampling, table, where=where),
    "sensors": _read_sensors,
    "geometry": lambda table, where: read_record(Arc, table, where=where),
    "actuator": lambda table, where: read_record(Bender, table, where=where),
    "valve": lambda table, where: read_record(Valve, table, where=where),
}
