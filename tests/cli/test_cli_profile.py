"""`softid fit --profile` and `--option` on a bundled log, as a user would."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from handmade import fit_result

from softid.synthesis import bundled_datasets
from softid.uncertainty.profile import ProfileResult
from softid_cli.main import run
from softid_cli.profiles import print_profiles

LOG = str(bundled_datasets() / "data" / "oscillator_steps.csv")


def test_a_profile_is_printed_drawn_and_recorded(tmp_path: Path) -> None:
    out = tmp_path / "fit"
    code = run(
        ["fit", LOG, "--model", "oscillator", "--profile", "M", "--out", str(out), "--quiet"]
    )
    assert code == 0
    assert (out / "profile_M.png").read_bytes().startswith(b"\x89PNG")
    profile = json.loads((out / "params.json").read_text())["profiles"]["M"]
    low, high = profile["ci95"]
    # The truth of the bundled log is 0.68; both ends are finite since the log oscillates.
    assert 0.6 < low < high < 0.75


def test_an_open_side_is_called_open(capsys: pytest.CaptureFixture[str]) -> None:
    """The word of the documentation, and the side."""
    profile = ProfileResult((0.1, 0.2, 0.5), (0.3, 0.0, 4.0), 3.84, (None, 0.49), 2)
    print_profiles(fit_result(), {"M": profile})
    told = " ".join(capsys.readouterr().out.split())
    assert "at most 0.49 s²/rad" in told
    assert "open below: the logs set no limit there" in told


def test_an_unknown_profile_is_refused_in_a_sentence(tmp_path: Path) -> None:
    code = run(
        ["fit", LOG, "--model", "oscillator", "--profile", "G", "--out", str(tmp_path / "x")]
    )
    assert code == 2
    assert not (tmp_path / "x").exists()


def test_options_reach_the_model(tmp_path: Path) -> None:
    out = tmp_path / "fit"
    code = run(
        [
            *("fit", LOG, "--model", "oscillator", "--option", "order=first"),
            *("--out", str(out), "--quiet", "--no-plots"),
        ]
    )
    assert code == 0
    model = json.loads((out / "params.json").read_text())["model"]
    assert model["options"]["order"] == "first"


def test_a_wrong_option_is_refused(tmp_path: Path) -> None:
    base = ["fit", LOG, "--model", "oscillator", "--out", str(tmp_path / "x"), "--option"]
    assert run([*base, "order=third"]) == 2
    assert run([*base, "colour=red"]) == 2
