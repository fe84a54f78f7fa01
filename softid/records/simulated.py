"""A simulated response as CSV."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from softid.results import Simulation


def simulation_csv(
    simulation: Simulation, *, display: Mapping[str, tuple[str, float]] | None = None
) -> str:
    """Write a simulation as CSV: time, input, outputs, and measured outputs where there are any.

    Parameters
    ----------
    simulation
        What `softid.simulate` returned.
    display
        Channel → (unit, factor to it) for channels to be shown in another unit than the canonical.

    Returns
    -------
    str
        Header ``time_s,pressure_kpa,angle_deg,…`` and one line per sample. Every number keeps all
        its digits; a value that was not simulated or measured is empty.

    Examples
    --------
    >>> s = Simulation("a", np.array([0.0, 0.5]), "pressure", np.array([0.0, 10.0]), "kPa",
    ...                {"angle": np.array([0.0, 0.25])}, {}, {}, {"angle": "rad"})
    >>> print(simulation_csv(s), end="")
    time_s,pressure_kpa,angle_rad
    0.0,0.0,0.0
    0.5,10.0,0.25
    """
    shown = display or {}
    columns: list[tuple[str, np.ndarray]] = [("time_s", simulation.time_s)]

    def add(prefix: str, name: str, canonical: str, values: np.ndarray) -> None:
        unit, factor = shown.get(name, (canonical, 1.0))
        columns.append((prefix + column_name(name, unit), values * factor))

    add("", simulation.input_name, simulation.input_unit, simulation.input)
    for name, values in simulation.outputs.items():
        add("", name, simulation.units[name], values)
    for name, values in simulation.measured.items():
        if np.isfinite(values).any():
            add("measured_", name, simulation.units[name], values)
    lines = [",".join(name for name, _ in columns)]
    rows = zip(*(values.tolist() for _, values in columns), strict=True)
    lines += [",".join("" if v != v else repr(v) for v in row) for row in rows]  # NaN is not itself
    return "\n".join(lines) + "\n"


def column_name(channel: str, unit: str) -> str:
    """A column's name with its unit: ``angle_deg``, ``torque_nmm``; no suffix without a unit."""
    suffix = "".join(c for c in unit.replace("°", "deg").lower() if c.isalnum())
    return f"{channel}_{suffix}" if suffix and suffix != "1" else channel
