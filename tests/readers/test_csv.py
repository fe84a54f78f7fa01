"""Delimited text in its dialects: what is written is what is read, to the last digit."""

from __future__ import annotations

import gzip
import json
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from softid.errors import InputError
from softid.readers import load

WriteFile = Callable[..., Path]

TIME = [0.0, 0.1, 0.25]
PRESSURE = [0.5, 1.0, 1.5]
ANGLE = [0.0, -30.0, 45.0]
NAMES = ["time_s", "pressure_kpa", "angle_deg"]


def text(separator: str = ",", *, decimal: str = ".", end: str = "\n", above: str = "") -> str:
    rows = [separator.join(map(str, row)) for row in zip(TIME, PRESSURE, ANGLE, strict=True)]
    body = end.join(rows).replace(".", decimal)
    return above + separator.join(NAMES) + end + body + end


def check(path: Path, **options: object) -> None:
    log = load(path, **options)  # type: ignore[arg-type]
    assert log.time_s.tolist() == TIME
    assert log.pressure_kpa.tolist() == PRESSURE
    np.testing.assert_allclose(np.rad2deg(log.channels["angle"].values), ANGLE, rtol=1e-14)


@pytest.mark.parametrize("separator", [",", ";", "\t", "|", " ", " , ", ", ", " \t "])
@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_separators_and_line_ends(write_log: WriteFile, separator: str, end: str) -> None:
    check(write_log(text(separator, end=end)))


@pytest.mark.parametrize("separator", [";", "\t", "|", " "])
def test_decimal_comma(write_log: WriteFile, separator: str) -> None:
    check(write_log(text(separator, decimal=",")))


@pytest.mark.parametrize(
    "encoding", ["utf-8", "utf-8-sig", "utf-16", "utf-16-le-bom", "utf-32", "latin-1"]
)
def test_encodings(write_log: WriteFile, encoding: str) -> None:
    """The degree sign differs between UTF-8 and Latin-1, so it shows a wrong guess."""
    content = text().replace("angle_deg", "angle [°]")
    if encoding == "utf-16-le-bom":
        check(write_log(b"\xff\xfe" + content.encode("utf-16-le")))
    else:
        check(write_log(content.encode(encoding)))


@pytest.mark.parametrize("name", ["log.csv", "log.CSV", "log.txt", "log.tsv", "log.dat"])
def test_endings(write_log: WriteFile, name: str) -> None:
    check(write_log(text("\t"), name))


@pytest.mark.parametrize("name", ["log.csv.gz", "log.txt.gz", "a.b.CSV.GZ"])
def test_gzip(write_log: WriteFile, name: str) -> None:
    path = write_log(gzip.compress(text().encode()), name)
    check(path)
    assert load(path).name == name[: -len(".csv.gz")]


@pytest.mark.parametrize("mark", ["#", "%", "//", ""])
def test_preamble(write_log: WriteFile, mark: str) -> None:
    """``key: value`` lines become metadata, other lines the comment."""
    above = f"{mark} Rig: finger 3\n{mark} gain = 2.5\n{mark} first day\n\n"
    path = write_log(text(above=above))
    check(path)
    said = dict(load(path).metadata)
    assert said == {"Rig": "finger 3", "gain": "2.5", "comment": "first day"}


def test_header_in_a_comment(write_log: WriteFile) -> None:
    """As `numpy.savetxt` writes it."""
    check(write_log("# " + text(" ")))


@pytest.mark.parametrize("units", ["s;kPa;deg", "[s];[kPa];[deg]", "(s);(kPa);(°)"])
def test_unit_row(write_log: WriteFile, units: str) -> None:
    rows = text(";").split("\n", 1)[1]
    check(write_log(f"time;pressure;angle\n{units}\n{rows}"))


def test_a_unit_row_against_the_name_asks(write_log: WriteFile) -> None:
    rows = text(";").split("\n", 1)[1]
    with pytest.raises(InputError, match="the name says kPa, but the row of units says bar"):
        load(write_log(f"time;pressure_kPa;angle\ns;bar;deg\n{rows}"))


@pytest.mark.parametrize("first", ["", "index", "Unnamed: 0", "#"])
def test_index_column(write_log: WriteFile, first: str) -> None:
    header, *rows = text().splitlines()
    lines = [f"{first},{header}", *(f"{k},{row}" for k, row in enumerate(rows))]
    path = write_log("\n".join(lines))
    check(path)
    assert set(load(path).channels) == {"pressure", "angle"}


def test_index_without_a_name_as_r_writes_it(write_log: WriteFile) -> None:
    header, *rows = text().splitlines()
    check(write_log("\n".join([header, *(f"{k},{row}" for k, row in enumerate(rows, 1))])))


def test_no_header(write_log: WriteFile) -> None:
    rows = text().split("\n", 1)[1]
    path = write_log(rows)
    check(path, channels={"time": "1:s", "pressure": "2:kPa", "angle": "3:deg"})
    with pytest.raises(InputError, match="no names"):
        load(path)


def test_quotes(write_log: WriteFile) -> None:
    """A quoted name may hold the separator, a quoted number a decimal comma."""
    rows = zip(TIME, PRESSURE, ANGLE, strict=True)
    lines = ['"time_s","pressure, left [kPa]",angle_deg']
    lines += [",".join(f'"{cell}"'.replace(".", ",") for cell in row) for row in rows]
    log = load(write_log("\n".join(lines)))
    assert log.time_s.tolist() == TIME
    assert log.channels["pressure"].column == "pressure, left [kPa]"


@pytest.mark.parametrize("missing", ["", "NaN", "nan", "NA", "null", "None", "-", "n/a", " "])
def test_missing_values(write_log: WriteFile, missing: str) -> None:
    log = load(write_log(f"time_s,pressure_kpa,angle_deg\n0,1,2\n1,2,{missing}\n2,3,4\n"))
    assert np.isnan(log.channels["angle"].values).tolist() == [False, True, False]
    assert [i.code for i in log.issues] == ["missing-output"]


def test_trailing_separators_open_no_column(write_log: WriteFile) -> None:
    header, *rows = text().splitlines()
    check(write_log("\n".join([header, *(f"{row}," for row in rows)])))


def test_blank_and_comment_lines_inside_do_not_shift_row_numbers(write_log: WriteFile) -> None:
    lines = ["time_s,pressure_kpa,angle_deg", "0,1,2", "", "# pause", "1,2,ERR", "2,3,4"]
    with pytest.raises(InputError) as caught:
        load(write_log("\n".join(lines)))
    assert "column angle_deg, row 5" in str(caught.value)


def test_an_incomplete_last_row_is_dropped_and_said(write_log: WriteFile) -> None:
    path = write_log(text() + "0.3,2")
    check(path)
    (issue,) = load(path).issues
    assert issue.code == "incomplete-last-row"
    assert "row 5" in issue.message


def test_thousands_separators_are_not_taken_for_decimals(write_log: WriteFile) -> None:
    """In a file with decimal points ``1,000`` cannot be one: refused, not read as 1."""
    with pytest.raises(InputError, match="not a number") as caught:
        load(write_log("time_s;pressure_kpa;angle_deg\n0;1,000;2.5\n1;2;3\n"))
    assert caught.value.value == "1,000"


@pytest.mark.parametrize("cell", ["1_000", "0x1F", "1.2.3", "1,2.3", "--1", "5 kPa"])
def test_what_is_no_number_is_refused(write_log: WriteFile, cell: str) -> None:
    """Python's float() would take 1_000; a log never means it."""
    with pytest.raises(InputError, match="not a number") as caught:
        load(write_log(f"time_s;pressure_kpa;angle_deg\n0;1.5;2\n1;{cell};3\n"))
    assert "column pressure_kpa, row 3" in str(caught.value)


def test_a_column_of_text_that_nobody_needs_is_left_out_and_said(write_log: WriteFile) -> None:
    log = load(write_log("time_s,pressure_kpa,angle_deg,mode\n0,1,2,AUTO\n1,2,3,MAN\n"))
    assert "mode" not in log.channels
    (issue,) = log.issues
    assert (issue.code, issue.severity) == ("column-left-out", "info")
    assert "'AUTO'" in issue.message


def test_the_source_is_fingerprinted(write_log: WriteFile) -> None:
    """sha256 of the text below, from coreutils' sha256sum."""
    log = load(write_log("time_s,pressure_kpa,angle_deg\n0,1,2\n1,2,3\n"))
    assert log.source is not None
    assert log.source.file_format == "csv"
    assert log.source.sha256 == "e7da3e88984f12b56fd999bb0eb12f5d90141d9426258fffcd555250c1afdf5c"


def big_text(rows: int, last: str = "1.5") -> str:
    lines = (f"{k * 1e-3:.3f},{k % 50:.3f},{k % 30:.3f},{last}" for k in range(rows))
    return "time_s,pressure_kpa,angle_deg,x\n" + "\n".join(lines)


def test_a_thousand_rows_load_at_once_and_without_heavy_imports(write_log: WriteFile) -> None:
    """Less than 50 ms (3 ms measured), best of five because the machine may be busy.

    pandas alone costs 0.37 s to import.
    """
    path = write_log(big_text(1000))
    code = (
        "import json, sys, timeit; from softid.readers import load;"
        f"seconds = min(timeit.repeat(lambda: load({str(path)!r}), number=1, repeat=5));"
        "heavy = {'pandas', 'pint', 'scipy', 'pyarrow', 'matplotlib', 'numba', 'lmfit'};"
        "print(json.dumps([seconds, sorted(heavy & set(sys.modules))]))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, check=True, text=True)
    seconds, heavy = json.loads(done.stdout)
    assert heavy == []
    assert seconds < 0.05


@pytest.mark.parametrize("last", ["1.5", "", "NA"])
def test_long_files_take_seconds(write_log: WriteFile, last: str) -> None:
    """100,000 rows in less than 2 s of processor time (0.1 to 0.3 s measured)."""
    path = write_log(big_text(100_000, last))
    start = time.process_time()
    assert len(load(path)) == 100_000
    assert time.process_time() - start < 2.0


def test_points_between_thousands_are_blamed_not_the_decimal_commas(write_log: WriteFile) -> None:
    """0,000 is a good cell where 50.039 is the only kind of point: that one is named."""
    with pytest.raises(InputError, match="write 50039") as caught:
        load(write_log("time_s;pressure_pa;angle_deg\n0,000;50.039;2,5\n0,020;50.127;3,5\n"))
    assert caught.value.value == "50.039"
    assert "column pressure_pa, row 2" in str(caught.value)


@pytest.mark.parametrize("separator", [",", ";"])
def test_a_typographic_minus_is_a_minus(write_log: WriteFile, separator: str) -> None:
    """A spreadsheet or a thesis writes U+2212; alone in a cell it stands for nothing, as - does."""
    minus = "\N{MINUS SIGN}"
    check(write_log(text(separator).replace("-", minus)))
    cells = [f"{minus}0.5", f"{minus}.25", f"1e{minus}3", minus]
    rows = [separator.join(map(str, (0.1 * k, k, cell))) for k, cell in enumerate(cells)]
    log = load(write_log("\n".join([separator.join(NAMES), *rows])))
    angle = np.rad2deg(log.channels["angle"].values)
    np.testing.assert_allclose(angle, [-0.5, -0.25, 1e-3, np.nan], rtol=1e-14)


@pytest.mark.parametrize(
    ("cells", "said"),
    [
        (["1", "ERR", "3", "4"], r"row 3: this is not a number \(got 'ERR'\)"),
        (["1", "ERR", "", "ERR"], r"row 3: this is not a number, nor is 1 more in its column \("),
        (["ERR", "x", "3", "ERR"], r"row 2: this is not a number, nor are 2 more in its column \("),
    ],
)
def test_cells_that_are_no_numbers_are_counted(
    write_log: WriteFile, cells: list[str], said: str
) -> None:
    """An empty cell is missing, which is no fault."""
    rows = [f"{0.1 * k},{k},{cell}" for k, cell in enumerate(cells)]
    with pytest.raises(InputError, match=said):
        load(write_log("\n".join([",".join(NAMES), *rows])))
