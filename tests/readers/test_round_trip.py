"""A generated table written in any dialect is read back exactly.

Stands on a property: ``repr`` of a float is the shortest text that reads back to the same bits, and
every unit of the header has the factor of softid's table.
"""

from __future__ import annotations

import gzip
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

from softid.readers import load
from softid.units import parse_unit

FACTS = {"rig": "finger 3", "rate": "100 Hz"}


@dataclass(frozen=True)
class Dialect:
    separator: str
    decimal: str
    end: str
    encoding: str
    mark: str | None
    unit_row: bool
    index: bool
    compressed: bool
    time_unit: str
    pressure_unit: str
    angle_unit: str
    spaces: int


dialects = st.builds(
    Dialect,
    separator=st.sampled_from([",", ";", "\t", "|", " "]),
    decimal=st.sampled_from([".", ","]),
    end=st.sampled_from(["\n", "\r\n", "\r"]),
    encoding=st.sampled_from(["utf-8", "utf-8-sig", "utf-16", "latin-1"]),
    mark=st.sampled_from([None, "#", "%", "//", ""]),
    unit_row=st.booleans(),
    index=st.booleans(),
    compressed=st.booleans(),
    time_unit=st.sampled_from(["s", "ms", "us"]),
    pressure_unit=st.sampled_from(["kPa", "bar", "psi", "Pa"]),
    angle_unit=st.sampled_from(["deg", "rad", "°"]),
    spaces=st.integers(0, 2),
)
rows = st.lists(
    st.tuples(
        st.floats(1e-3, 2.0),
        st.floats(0.0, 1.0),
        st.floats(-1.0, 1.0),
        st.floats(-1e12, 1e12, allow_subnormal=False),
    ),
    min_size=3,
    max_size=15,
)


def write(path: Path, table: list[list[float]], dialect: Dialect) -> None:
    units = [dialect.time_unit, dialect.pressure_unit, dialect.angle_unit, ""]
    names = ["time", "pressure", "angle", "raw"]
    if not dialect.unit_row:
        names = [
            f"{name} [{unit}]" if unit else name for name, unit in zip(names, units, strict=True)
        ]
    cells = [names] + ([[unit or "-" for unit in units]] if dialect.unit_row else [])
    cells += [[repr(v).replace(".", dialect.decimal) for v in row] for row in table]
    if dialect.index:
        head = 1 + dialect.unit_row
        first = ["index", "-"][:head] + [str(k) for k in range(len(table))]
        cells = [[cell, *row] for cell, row in zip(first, cells, strict=True)]
    gap = dialect.separator + " " * dialect.spaces
    lines = [] if dialect.mark is None else [f"{dialect.mark} {k}: {v}" for k, v in FACTS.items()]
    lines += [gap.join(row) for row in cells]
    data = (dialect.end.join(lines) + dialect.end).encode(dialect.encoding)
    path.write_bytes(gzip.compress(data) if dialect.compressed else data)


@settings(
    max_examples=250,
    deadline=None,
    derandomize=True,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)
@given(dialect=dialects, steps=rows)
def test_what_is_written_is_read(
    tmp_path: Path, dialect: Dialect, steps: list[tuple[float, float, float, float]]
) -> None:
    assume(dialect.separator != "," or dialect.decimal != ",")
    assume(dialect.decimal != "," or any("." in repr(v) for row in steps for v in row))
    counts = np.cumsum([step for step, *_ in steps])
    assume(dialect.time_unit != "us" or min(step for step, *_ in steps) > 0.11)  # else above 10 MHz
    pressures = [p for _, p, *_ in steps]
    assume(np.ptp(pressures) > 0.01)  # a smaller span in some unit makes the range check ask
    factor = {"Pa": 1e5, "kPa": 100.0, "psi": 15.0, "bar": 1.0}[dialect.pressure_unit]
    table = [[float(t), p * factor, a, x] for t, (_, p, a, x) in zip(counts, steps, strict=True)]
    path = tmp_path / ("log.csv.gz" if dialect.compressed else "log.csv")
    write(path, table, dialect)

    log = load(path)

    values = np.array(table)
    np.testing.assert_array_equal(log.time_s, values[:, 0] * parse_unit(dialect.time_unit).factor)
    for column, (name, unit) in enumerate(
        [("pressure", dialect.pressure_unit), ("angle", dialect.angle_unit)], start=1
    ):
        expected = values[:, column] * parse_unit(unit).factor
        np.testing.assert_array_equal(log.channels[name].values, expected)
    np.testing.assert_array_equal(log.channels["raw"].values, values[:, 3])
    assert set(log.channels) == {"pressure", "angle", "raw"}
    assert {issue.code for issue in log.issues} <= {"time-unit-doubtful"}  # steps of 1 µs are odd
    assert dialect.mark is None or dict(log.metadata) == FACTS
