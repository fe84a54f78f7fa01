"""The whole road on a log whose truth is known in closed form, with nothing replaced."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from desk import Outcome

Cli = Callable[..., Outcome]

TIME_CONSTANT_S = 0.25
GAIN_DEG_PER_KPA = 0.4
NOISE_DEG = 0.1


def first_order_log(path: Path, *, period_s: float, seed: int) -> None:
    """Steps of 80 kPa through N ẋ + Q x = u: exponentials between the jumps, solved by hand."""
    time_s = np.arange(400) * 0.02
    pressure = np.where((time_s % period_s) < period_s / 2, 0.0, 80.0)
    angle = np.zeros_like(time_s)
    decay = np.exp(-0.02 / TIME_CONSTANT_S)
    slope = TIME_CONSTANT_S / 0.02 * (1 - decay)
    for k in range(1, time_s.size):
        before, after = GAIN_DEG_PER_KPA * pressure[k - 1], GAIN_DEG_PER_KPA * pressure[k]
        # exact for an input that is straight between two samples
        angle[k] = decay * angle[k - 1] + (slope - decay) * before + (1 - slope) * after
    noisy = angle + NOISE_DEG * np.random.default_rng(seed).standard_normal(time_s.size)
    rows = np.column_stack([time_s, pressure, noisy])
    np.savetxt(path, rows, "%.6f", ",", header="time_s,pressure_kpa,angle_deg", comments="")


@pytest.fixture
def logs(tmp_path: Path) -> tuple[Path, Path]:
    fitted, other = tmp_path / "slow.csv", tmp_path / "fast.csv"
    first_order_log(fitted, period_s=2.0, seed=1)
    first_order_log(other, period_s=1.2, seed=2)
    return fitted, other


def test_fit_validate_simulate(softid: Cli, logs: tuple[Path, Path]) -> None:
    """Q = 1/gain and N = time constant · Q (in the units of the files: kPa and rad).

    Held-out rmse is the noise; intervals are 95 %, so four standard errors is safe.
    """
    fitted, other = logs
    told = softid("fit", fitted, "--model", "oscillator", "--json", "--quiet", "--no-plots")
    assert (told.code, told.err) == (0, "")
    found = {p["name"]: p for p in json.loads(told.out)["parameters"]}
    stiffness = 1.0 / (GAIN_DEG_PER_KPA * np.pi / 180)
    for name, truth in (("Q", stiffness), ("N", TIME_CONSTANT_S * stiffness)):
        assert abs(found[name]["value"] - truth) < 4 * found[name]["stderr"]
        assert found[name]["stderr"] < 0.02 * truth
    assert found["M"]["verdict"] != "identified"  # there is none in the law

    params = "softid-out/slow/params.json"
    scored = softid("validate", params, other, "--threshold", "90", "--json", "--quiet")
    assert scored.code == 0, scored.err
    (row,) = json.loads(scored.out)["statistics"]
    assert row["in_sample"] is False
    assert row["rmse"] * row["display_factor"] == pytest.approx(NOISE_DEG, rel=0.15)
    assert softid("validate", params, other, "--threshold", "99.9").code == 1

    simulated = softid("simulate", params, "--input", other, "--quiet")
    angle_deg = np.genfromtxt(simulated.out.splitlines(), delimiter=",", names=True)["angle_deg"]
    measured = np.genfromtxt(other, delimiter=",", names=True)["angle_deg"]
    assert np.sqrt(np.mean((angle_deg - measured) ** 2)) == pytest.approx(NOISE_DEG, rel=0.3)


def test_the_same_twice(softid: Cli, logs: tuple[Path, Path]) -> None:
    """One seed, one result: the documents are equal byte for byte."""
    printed = {
        softid(
            "fit",
            logs[0],
            "--model",
            "oscillator",
            "--json",
            "--quiet",
            "--out",
            "same",
            "--force",
            "--no-plots",
        ).out
        for _ in range(2)
    }
    assert len(printed) == 1


README = (Path(__file__).resolve().parents[2] / "README.md").read_text(encoding="utf-8")
NUMBER = re.compile(r"\d+(?:\.\d+)?")


def last_digit(number: str) -> float:
    """The unit of the last digit, which may be another one on another machine."""
    return float(10.0 ** -len(number.partition(".")[2]))


def assert_shown(printed: str, shown: str) -> None:
    """The same words, and numbers that differ in their last digit at most."""
    words = [re.sub(r"─+", "─", NUMBER.sub("#", text)).split() for text in (printed, shown)]
    assert words[0] == words[1]
    for number, known in zip(NUMBER.findall(printed), NUMBER.findall(shown), strict=True):
        assert float(number) == pytest.approx(float(known), abs=1.01 * last_digit(known))


def test_the_demo(softid: Cli) -> None:
    """The README's first command: its table and verdicts, the plots where it says they are."""
    told = softid("demo", "--quiet")
    assert (told.code, told.err) == (0, "")
    shown = README.split("<!-- demo -->\n```\n")[1]
    assert_shown(*(text.split("\ninfo:")[0] for text in (told.out, shown)))
    assert max(map(len, told.out.splitlines())) <= 80
    folder = Path("softid-out/demo_step")
    assert f"Written to {folder}/" in told.out
    pictures = sorted(p.name for p in folder.glob("*.png"))
    assert "response_demo_step.png" in pictures
    for name in pictures:
        assert name in told.out
        assert (folder / name).read_bytes().startswith(b"\x89PNG")


def test_the_diagnosis(softid: Cli) -> None:
    """The README's two commands, and the report that it shows below them."""
    before, rest = README.split("<!-- diagnosis -->\n```\n")
    synthesize, diagnose = re.findall(r"`softid ([^`]+)`", before.rsplit("\n\n", 1)[1])
    assert softid(*synthesize.split(), "--quiet").code == 0
    told = softid(*diagnose.split(), "--quiet", "--no-plots")
    assert (told.code, told.err) == (0, "")
    assert_shown(told.out.split("\n\n")[0], rest.split("```\n<!-- /diagnosis -->")[0])
