"""Geometry and material of the bi-directional actuator: section, static moments, TOML file."""

from __future__ import annotations

import re
from dataclasses import dataclass, fields
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from softid.errors import InputError, refuse_unknown
from softid.kernels.bending_body import Body, tabulated
from softid.models.bending_inertia import Inertia, Kernels, Stretch, inertia_series
from softid.models.option_kinds import require_kinds
from softid.toml_files import TomlKind, parse_toml, read_toml_bytes

Array = npt.NDArray[np.float64]

PRINTED = ("layer_modulus_pa",)
"""What the paper prints: the ABS layer's 2 GPa. Every other value below is an assumption."""

WALL_POINTS = 10
"""Gauss points over the height of a side wall; the torque then errs by less than 1e-9 up to 3.2."""

PA_PER_KPA = 1e3
_KIND = TomlKind("geometry", "name a TOML file with the tables [geometry] and [material]", 100_000)
_NUMBER = re.compile(r"\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s*(\S.*)")
_UNIT = re.compile(r"[^\W\d]\w*(\^-?\d)?( ?[*/·. ] ?[^\W\d]\w*(\^-?\d)?)*")
_SI = {"_m": "m", "_kg_m3": "kg/m^3", "_pa": "Pa"}
_RANGES = {"m": (1e-6, 10.0), "kg/m^3": (1.0, 1e5), "Pa": (1.0, 1e13), "": (1, 1000)}
"""Unit → smallest and largest value that an actuator can have; more is a slip of the unit."""


@dataclass(frozen=True)
class Actuator:
    """The bi-directional actuator of DEE 2022 in SI units; the values are softid's assumptions.

    N chambers of length a lie between N + 1 ribs of thickness t_r, so l0 = N·a + (N + 1)·t_r. Both
    sides of the neutral layer are alike.

    Attributes
    ----------
    chamber_width_m, chamber_height_m
        B and h0.
    wall_m, layer_m, rib_m
        t_w, t_n and t_r.
    chamber_length_m, chambers
        a and N.
    rubber_density_kg_m3, layer_density_kg_m3
        ρ and ρ_abs.
    layer_modulus_pa
        Young's modulus E of the neutral layer; the one value that the paper prints.
    c10_pa, c20_pa
        Yeoh coefficients of the walls.
    assumed
        Names of the values that were assumed, not measured or printed, joined by commas.

    Source: DEE 2022, Figure 1 and Eq 2 to 11.
    """

    chamber_width_m: float = 0.020
    chamber_height_m: float = 0.012
    wall_m: float = 0.002
    layer_m: float = 0.0005
    rib_m: float = 0.003
    chamber_length_m: float = 0.008
    chambers: int = 10
    rubber_density_kg_m3: float = 1070.0
    layer_density_kg_m3: float = 1040.0
    layer_modulus_pa: float = 2e9
    c10_pa: float = 17e3
    c20_pa: float = -200.0
    assumed: str = (
        "chamber_width_m, chamber_height_m, wall_m, layer_m, rib_m, chamber_length_m, chambers, "
        "rubber_density_kg_m3, layer_density_kg_m3, c10_pa, c20_pa"
    )

    def __post_init__(self) -> None:
        require_kinds(self)
        for name in VALUES:
            _refuse_impossible(getattr(self, name), name, f"geometry, {name}")
        unknown = sorted(set(self.assumed_names) - set(VALUES))
        if unknown:
            raise InputError(
                "there is no such value to be assumed",
                where="geometry, assumed",
                value=unknown[0],
                remedy=f"choose from {', '.join(VALUES)}",
            )

    @property
    def assumed_names(self) -> tuple[str, ...]:
        """Names of the assumed values."""
        return tuple(name.strip() for name in self.assumed.split(",") if name.strip())

    @property
    def length_m(self) -> float:
        """l0 = N·a + (N + 1)·t_r."""
        return self.chambers * self.chamber_length_m + (self.chambers + 1) * self.rib_m

    @property
    def outer_width_m(self) -> float:
        """B + 2·t_w."""
        return self.chamber_width_m + 2.0 * self.wall_m

    @property
    def line_densities_kg_m(self) -> tuple[float, float]:
        """ρ_c at a chamber and ρ_r at a rib; DEE Eq 9."""
        width, wall, height = self.outer_width_m, self.wall_m, self.chamber_height_m
        rubber, layer = self.rubber_density_kg_m3, self.layer_density_kg_m3 * self.layer_m
        around = self.chamber_width_m + 2.0 * height + 2.0 * wall
        chamber = width * layer + 2.0 * wall * around * rubber
        return chamber, width * (2.0 * rubber * (height + wall) + layer)

    @property
    def rotations_kg_m(self) -> tuple[float, float]:
        """J_c at a chamber, J_r at a rib; DEE Eq 11 with B + 2·t_w for B and the missing plus."""
        width, h, t, n = self.outer_width_m, self.chamber_height_m, self.wall_m, self.layer_m
        rubber, layer = self.rubber_density_kg_m3, self.layer_density_kg_m3
        top = 3.0 * n**2 + 6.0 * n * t + 4.0 * t**2
        outer = 2.0 * width * rubber * t * (12.0 * h**2 + 12.0 * h * (n + t) + top)
        sides = 4.0 * h * rubber * t * (4.0 * h**2 + 6.0 * h * n + 3.0 * n**2)
        chamber = (outer + width * layer * n**3 + sides) / 12.0
        whole = 8.0 * h**3 + 12.0 * h**2 * (n + 2.0 * t) + 6.0 * h * (n + 2.0 * t) ** 2
        rib = width / 12.0 * (rubber * (whole + 2.0 * t * top) + layer * n**3)
        return chamber, rib

    @property
    def stretches(self) -> tuple[Stretch, ...]:
        """Ribs and chambers from the root to the end; ribs begin at i·(a + t_r)."""
        (chamber, rib), (turn_c, turn_r) = self.line_densities_kg_m, self.rotations_kg_m
        pitch, found = self.chamber_length_m + self.rib_m, []
        for i in range(self.chambers + 1):
            start = i * pitch
            found.append(Stretch(start, start + self.rib_m, rib, turn_r))
            if i < self.chambers:
                found.append(Stretch(start + self.rib_m, start + pitch, chamber, turn_c))
        return tuple(found)

    def body(self, inertia: Inertia, kernels: Kernels) -> Body:
        """Arrays for the compiled equation of motion.

        The static moments close what the paper leaves to its references, by this project's rule:
        only the chambers stretch, λ(y) = 1 ± y·θ/(N·a), the walls carry the plane-strain Yeoh
        stress σ = (λ⁴ − 1)/λ³·(2·C10 + 4·C20·(λ − 1/λ)²), the top wall at y = h0 + t_w/2 and the
        side walls over 0 … h0; the neutral layer adds E·I·θ/l0 and the pressure F = p·B·h0²/2.

        Source: DEE 2022, Eq 2 to 6, with the stress of softid.
        """
        height, wall = self.chamber_height_m, self.wall_m
        nodes, weights = np.polynomial.legendre.leggauss(WALL_POINTS)
        y = 0.5 * height * (nodes + 1.0)
        sides = 0.5 * height * weights * 2.0 * wall * y
        top = height + 0.5 * wall
        levers = np.append(sides, wall * self.outer_width_m * top)
        stretch = np.append(y, top) / (self.chambers * self.chamber_length_m)
        layer = self.layer_modulus_pa * self.outer_width_m * self.layer_m**3 / 12.0 / self.length_m
        drive = PA_PER_KPA * self.chamber_width_m * height**2 / 2.0
        mass, velocity = inertia_series(self.stretches, self.length_m, inertia, kernels)
        constants = np.array([2.0 * self.c10_pa, 4.0 * self.c20_pa, layer, drive])
        return tabulated(mass, velocity, stretch, levers, constants)


VALUES = tuple(f.name for f in fields(Actuator) if f.name != "assumed")
"""Names of the numbers of an `Actuator`."""

_STEMS = {name: next((s for s in _SI if name.endswith(s)), "") for name in VALUES}
KEYS = {name.removesuffix(stem): name for name, stem in _STEMS.items()}
"""Key in a geometry file → name of the value."""


def load_actuator(path: Path | str) -> Actuator:
    r"""Read geometry and material from a TOML file.

    The tables ``[geometry]`` and ``[material]`` hold the names of `Actuator` without their units,
    and texts such as ``"20 mm"``. Geometry must be complete; a material that is missing is taken
    from softid and labelled as assumed, and so are the keys listed under ``assumed``.

    Parameters
    ----------
    path
        The file.

    Returns
    -------
    Actuator
        Sizes in m and Pa, and which of them are assumed.

    Raises
    ------
    InputError
        The file cannot be read, a key is unknown or missing, or a value has no proper unit.

    Examples
    --------
    >>> import pathlib, tempfile
    >>> lengths = "chamber_width='20mm'\nchamber_height='1.2 cm'\nwall='2mm'\nlayer='0.5mm'"
    >>> more = "rib='3mm'\nchamber_length='8mm'\nchambers=10"
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = pathlib.Path(folder, "actuator.toml")
    ...     _ = file.write_text(f"[geometry]\n{lengths}\n{more}")
    ...     found = load_actuator(file)
    >>> found.chamber_height_m, found.chambers
    (0.012, 10)
    """
    path = Path(path)
    return _actuator(parse_toml(read_toml_bytes(path, _KIND), _KIND, where=path.name), path.name)


def read_actuator(text: str, *, where: str) -> Actuator:
    r"""Geometry and material from the text of a TOML file; see `load_actuator`.

    Raises
    ------
    InputError
        The text is no TOML, a key is unknown or missing, or a value has no proper unit.

    Examples
    --------
    >>> lengths = "chamber_width='20mm'\nchamber_height='1.2 cm'\nwall='2mm'\nlayer='0.5mm'"
    >>> more = "rib='3mm'\nchamber_length='8mm'\nchambers=10"
    >>> found = read_actuator(f"[geometry]\n{lengths}\n{more}", where="a.toml")
    >>> found.chamber_height_m, found.assumed
    (0.012, 'rubber_density_kg_m3, layer_density_kg_m3, c10_pa, c20_pa')
    """
    return _actuator(parse_toml(text.encode(), _KIND, where=where), where)


def _actuator(table: dict[str, Any], where: str) -> Actuator:
    refuse_unknown(table, ("title", "assumed", "geometry", "material"), where=where)
    given: dict[str, Any] = {}
    for part in ("geometry", "material"):
        inner = table.get(part, {})
        if not isinstance(inner, dict):
            raise InputError("a table is expected", where=f"{where}, {part}", value=inner)
        refuse_unknown(inner, _keys_of(part), where=f"{where}, [{part}]")
        given |= inner
    missing = [key for key in _keys_of("geometry") if key not in given]
    if missing:
        raise InputError(
            f"{missing[0]} is missing",
            where=f"{where}, [geometry]",
            remedy=f"give {', '.join(missing)}",
        )
    values = {KEYS[key]: _si(value, KEYS[key], f"{where}, {key}") for key, value in given.items()}
    for key in given:
        _refuse_impossible(values[KEYS[key]], KEYS[key], f"{where}, {key}")
    said = table.get("assumed", [])
    if not isinstance(said, list) or not all(isinstance(key, str) for key in said):
        raise InputError("a list of names is expected", where=f"{where}, assumed", value=said)
    refuse_unknown(said, tuple(KEYS), where=f"{where}, assumed")
    filled = [name for name in VALUES if name not in values and name not in PRINTED]
    taken = {KEYS[key] for key in said} | set(filled)
    listed = ", ".join(name for name in VALUES if name in taken)
    options: dict[str, Any] = {**values, "assumed": listed}
    return Actuator(**options)


def _keys_of(part: str) -> tuple[str, ...]:
    first_material = VALUES.index("rubber_density_kg_m3")
    chosen = VALUES[:first_material] if part == "geometry" else VALUES[first_material:]
    return tuple(key for key, name in KEYS.items() if name in chosen)


def _refuse_impossible(value: object, name: str, where: str) -> None:
    """A number outside what an actuator can have; C20 may have either sign."""
    unit = _SI.get(_STEMS[name], "")
    low, high = (-1e13, 1e13) if name == "c20_pa" else _RANGES[unit]
    if not isinstance(value, int | float) or not low <= value <= high:
        raise InputError(
            f"a value between {low:g} and {f'{high:g} {unit}'.strip()} is expected",
            where=where,
            value=value,
            remedy="correct the number or its unit",
        )


def _si(value: object, name: str, where: str) -> float | int:
    """A text with a unit as a number in SI; the number of chambers is a whole number."""
    unit = _SI.get(_STEMS[name])
    if unit is None:
        if isinstance(value, bool) or not isinstance(value, int):
            raise InputError("a whole number is expected", where=where, value=value)
        return value
    match = _NUMBER.fullmatch(value) if isinstance(value, str) else None
    if match is None or not _UNIT.fullmatch(match[2].strip()):
        raise InputError(
            "a number with its unit is expected",
            where=where,
            value=value,
            remedy=f'write it as "1.5 {unit}"',
        )

    try:
        size = _registry().Quantity(float(match[1]), match[2].strip().replace("·", "*"))
        return float(size.to(unit).magnitude)
    except Exception as error:
        # pint raises tokenizer, attribute, dimension and value errors alike.
        raise InputError(
            f"this is not a quantity in {unit}",
            where=where,
            value=value,
            remedy=f'write it as "1.5 {unit}"',
        ) from error


@cache
def _registry() -> Any:
    import pint  # 0.2 s, and only a geometry file needs it

    return pint.UnitRegistry()
