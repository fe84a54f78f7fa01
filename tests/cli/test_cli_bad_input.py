"""Every bad log ends `softid fit` in one line, exit code 3, and without a trace on the disk."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

import pytest
from desk import Outcome

Cli = Callable[..., Outcome]
BOUND = ("--bound", "N=50:")

HEADER = "time_s,pressure_kpa,angle_deg"
ROWS = tuple(f"{0.02 * k:.2f},{80 if k > 20 else 0},{0.5 * k:.2f}" for k in range(60))


def log(rows: list[str] | tuple[str, ...], header: str = HEADER) -> bytes:
    return "\n".join((header, *rows, "")).encode()


def columns(pressure: str, angle: str = "{k}") -> list[str]:
    cells = f"{{t:.2f}},{pressure},{angle}"
    return [cells.format(t=0.02 * k, k=k, p=80.0 * (k > 20)) for k in range(60)]


BAD = {
    "empty": (b"", "the file is empty; "),
    "header_only": (log([]), "no row of numbers; "),
    "text": (log([*ROWS[:30], "0.60,high,15", *ROWS[31:]]), "row 32: this is not a number"),
    "all_missing": (
        log(columns("nan", "nan")),
        "no number at all: its 60 values are all empty, NaN",
    ),
    "all_infinite": (log(columns("inf")), "no number at all: its 60 values are all empty, NaN"),
    "zeros": (bytes(512), "the file is 512 bytes of nothing but zeros; "),
    "plain_names": (
        log([f"{r},1" for r in ROWS], "time_s,P_kPa,angle_deg,pressure [bar]"),
        "2 columns look like pressure: P_kPa, pressure [bar]; choose one",
    ),
    "one_sample": (log(ROWS[:1]), "only one sample is left; "),
    "constant": (log(columns("50")), "is constant, so nothing can be identified"),
    "dead_output": (log(columns("{p}", "7")), "never changes although the input does"),
    "backward": (log([*ROWS[:30], *ROWS[10:]]), "the time runs backward, from 0.58 s to 0.2 s"),
    "unknown": (log(ROWS, "a,b,c"), "no time column is recognised"),
    "no_time": (log([r.split(",", 1)[1] for r in ROWS], "pressure_kpa,angle_deg"), "no time"),
    "no_output": (log([r.rsplit(",", 1)[0] for r in ROWS], "time_s,pressure_kpa"), "no output"),
    "two_pressures": (
        log([f"{r},1" for r in ROWS], "time_s,pressure_a_kpa,angle_deg,pressure_b_kpa"),
        "2 columns look like pressure: pressure_a_kpa, pressure_b_kpa; choose one",
    ),
    "wrong_unit": (log(ROWS, "time_s,pressure [deg],angle_deg"), "deg is a unit of angle"),
    "pa_as_bar": (log(columns("{p}000"), "time_s,pressure_bar,angle_deg"), "is that its unit?"),
    "binary": (bytes(range(256)) * 20, "not text but binary data"),
}


@pytest.mark.parametrize("name", sorted(BAD))
def test_a_bad_log(softid: Cli, tmp_path: Path, name: str) -> None:
    """What, where and what to do; the file named first, nothing printed, nothing left behind."""
    content, said = BAD[name]
    path = tmp_path / f"{name}.csv"
    path.write_bytes(content)
    refuse(softid("fit", path.name, "--model", "oscillator", "--quiet"), name, said)


def refuse(told: Outcome, name: str, said: str) -> None:
    assert told.code == 3
    assert said in told.err
    assert told.err.startswith(f"softid: error: {name}")
    assert "; " in told.err  # the remedy
    assert told.err.count("\n") == 1
    assert told.out == ""
    assert not Path("softid-out").exists()


def test_the_file_is_named_not_only_the_log(softid: Cli, tmp_path: Path) -> None:
    """Two folders may hold logs of one name, so an error names the path as it was typed."""
    (tmp_path / "day1").mkdir()
    (tmp_path / "day1" / "run.csv").write_bytes(log(columns("{p}", "7")))
    told = softid("fit", "day1/run.csv", "--model", "oscillator", "--quiet")
    refuse(told, "day1/run.csv", "never changes although the input does")


def test_a_bound_of_the_user_is_not_softids(softid: Cli, tmp_path: Path) -> None:
    """At N ≥ 50, far above its value, the optimum rests on that bound, whoever gave it."""
    rows = [
        f"{0.02 * k:.2f},{80.0 * (k // 20 % 2)},{k // 20 % 2 * 9 + k % 3:.2f}" for k in range(90)
    ]
    (tmp_path / "step.csv").write_bytes(log(rows))
    told = softid(*("fit", "step.csv", "--model", "oscillator", "--quiet", "--no-plots"), *BOUND)
    assert "rests on its lower bound" in " ".join(told.out.split()), told.err


def test_a_file_that_is_not_there(softid: Cli) -> None:
    """A slip of the hand."""
    refuse(softid("fit", "stpe.csv"), "stpe.csv", "there is no such file")


def test_a_folder(softid: Cli, tmp_path: Path) -> None:
    """The shell completes to folders."""
    (tmp_path / "logs").mkdir()
    refuse(softid("fit", "logs"), "logs", "this is a folder")


def test_two_gigabytes(softid: Cli, tmp_path: Path) -> None:
    """Refused with the reason before anything is read; the file is sparse and costs no space."""
    with (tmp_path / "big.csv").open("wb") as stream:
        stream.write(log(ROWS))
        stream.truncate(2 * 1024**3)
    refuse(softid("fit", "big.csv"), "big.csv", "more than the 512 MB")


def test_no_permission(softid: Cli, tmp_path: Path) -> None:
    """Refused by the system, not by a check of ours."""
    path = tmp_path / "closed.csv"
    path.write_bytes(log(ROWS))
    path.chmod(0)
    if os.access(path, os.R_OK):
        pytest.skip("this user may read everything")
    refuse(softid("fit", "closed.csv"), "closed.csv", "there is no permission to read it")


def test_what_can_be_repaired_is_said_and_used(softid: Cli, tmp_path: Path) -> None:
    """Four samples without pressure and a repeated time do not stop a fit, but are told."""
    rows = [r if not 30 <= k < 34 else f"{0.02 * k:.2f},,{k}" for k, r in enumerate(ROWS)]
    (tmp_path / "gap.csv").write_bytes(log([*rows[:50], rows[49], *rows[50:]]))
    told = softid("fit", "gap.csv", "--model", "oscillator", "--no-plots", "--quiet")
    assert told.code == 0, told.err
    words = " ".join(told.out.split())
    assert "dropped 4 of 61 samples, which have no pressure" in words
    assert "which repeat the one before" in words
