"""Diagnoses of measured logs from real rigs, against what is published or was computed apart."""

from __future__ import annotations

from pathlib import Path

import pytest

from softid.diagnoses import Diagnosis, Verdict
from softid.diagnosis import diagnose
from softid.models import Oscillator
from softid.readers import load
from softid.results import ParameterEstimate

NEAR = 0.2
"""A published value counts as met within the interval or within a fifth of it."""


def estimate(found: Diagnosis, name: str) -> ParameterEstimate:
    assert found.extended is not None
    return found.extended.parameter(name)


@pytest.fixture(scope="module")
def drive(measured: Path) -> Diagnosis:
    """Half a minute of one core."""
    log = load(measured / "linear-drive-friction" / "DATA_EMPS.csv")
    return diagnose([log], model=Oscillator(spring="none"))


@pytest.mark.slow
def test_the_drive_has_dry_friction(drive: Diagnosis) -> None:
    """Stands on the published friction model of the EMPS benchmark (nonlinearbenchmark.org).

    M q̈ = τ − Fv q̇ − Fc sign q̇ − offset with M = 95.1 kg, Fv = 203.5 N·s/m and Fc = 20.4 N; here
    in N and mm.
    """
    assert drive.verdict in (Verdict.NAMED, Verdict.PARTIAL)
    assert "coulomb_friction" in {cause.effect for cause in drive.causes}
    for name, published in (("coulomb_friction_Fc", 20.4), ("M", 0.0951), ("N", 0.2035)):
        told = estimate(drive, name)
        inside = told.ci95 is not None and told.ci95[0] <= published <= told.ci95[1]
        assert inside or abs(told.value - published) <= NEAR * published, told
    offset = estimate(drive, "offset")
    assert offset.verdict == "not identified" or abs(offset.value - -3.2) <= NEAR * 3.2, offset


@pytest.mark.slow
@pytest.mark.xfail(
    strict=True,
    reason="an asymmetric damping, which the published model does not have, takes its place",
)
def test_the_drive_has_an_offset(drive: Diagnosis) -> None:
    """The same source: −3.2 N. It is missed, and comes out at −0.5 [−2.4, 1.3] N."""
    interval = estimate(drive, "offset").ci95
    assert interval is not None
    assert interval[0] <= -3.2 <= interval[1]


def test_the_arm_fills_faster_than_it_vents(measured: Path) -> None:
    """Command to pressure of one chamber: an asymmetric cause with a ratio well above one.

    On the same arm, steps take 0.82 s up and 1.4 s down (ratio 1.7), computed apart.
    """
    log = load(
        measured / "three-chamber-arm" / "0706_pressure_only_square_1.csv",
        input="pressure_command",
        outputs=("pressure",),
    )
    found = diagnose([log], model="oscillator")
    keys = {cause.key for cause in found.causes}
    (key,) = keys & {"pneumatic_lag.separate", "asymmetric_damping"}
    assert estimate(found, f"{key.split('.')[0]}_ratio").value > 1.3
    (held,) = [gain for gain in found.gains if gain.held_out]
    assert held.rmse_after < 0.5 * held.rmse_before
