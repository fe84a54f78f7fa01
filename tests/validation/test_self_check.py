"""The self-check refits every bundled log and judges the parameters of each fit together."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from handmade import fit_result
from scipy.stats import chi2

from softid.results import FitResult
from softid.validation import SelfCheck, SelfCheckGroup, SelfCheckRow, self_check
from softid.validation.self_check import judged, together

README = (Path(__file__).resolve().parents[2] / "README.md").read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def found() -> SelfCheck:
    return self_check()


def test_the_self_check_passes_and_covers_every_group(found: SelfCheck) -> None:
    """48 truths of thirteen logs."""
    assert found.passed
    assert len(found.rows) == 48
    groups = {row.group for row in found.rows}
    assert {"demo_step", "muscle", "oscillator_steps"} <= groups
    assert [group.name for group in found.groups] == list(
        dict.fromkeys(r.group for r in found.rows)
    )
    assert sum(group.parameters for group in found.groups) == 48


def test_the_figures_are_those_of_the_readme(found: SelfCheck) -> None:
    """To the digits that it gives."""
    outside = [row for row in found.rows if not row.inside]
    off = [row.distance for row in outside]
    (pair,) = (g for g in found.groups if g.name in {row.group for row in outside})
    count, whole = len(found.rows), sum(group.distance for group in found.groups)
    assert len(outside) == 4
    for told in (
        f"{count - 4} of {count} truths lie inside their 95 % interval. The four outside belong to "
        f"one pair of logs and are off by {min(off):.2f} to {max(off):.2f} half-widths.",
        f"χ² = {pair.distance:.1f} for the {pair.parameters} parameters of that pair, which chance "
        f"exceeds with a probability of {100 * pair.chance:.0f} %, and {whole:.1f} for all "
        f"{count}, which chance exceeds with {100 * found.chance:.0f} %.",
    ):
        assert told in " ".join(README.split())


def test_the_whole_is_judged_by_the_sum_of_its_fits(found: SelfCheck) -> None:
    """Fits of different logs are independent, so that their distances and freedoms add up."""
    distances = [group.distance for group in found.groups]
    assert None not in distances
    expected = chi2.sf(sum(d for d in distances if d is not None), 48)
    assert found.chance == pytest.approx(expected, rel=1e-9)


def row(result: FitResult, name: str, off: float) -> SelfCheckRow:
    """A row whose truth lies ``off`` standard errors above the estimate."""
    estimate = result.parameter(name)
    assert estimate.stderr is not None
    relative = estimate.stderr / estimate.value
    if estimate.scale == "log":
        truth = estimate.value * float(np.exp(off * relative))
    else:
        truth = estimate.value + off * estimate.stderr
    return SelfCheckRow(
        "g", name, estimate.unit, truth, estimate.value, estimate.ci95, True, abs(off) / 1.96
    )


def two_parameters(correlation: float) -> tuple[FitResult, list[str]]:
    result = fit_result()
    names = [p.name for p in result.parameters if p.stderr][:2]
    matrix = np.array([[1.0, correlation], [correlation, 1.0]])
    return replace(result, free=tuple(names), correlation=matrix), names


@pytest.mark.parametrize("off", [(1.5, 1.5), (1.5, -1.5)])
def test_parameters_that_err_together_count_once(off: tuple[float, float]) -> None:
    """zᵀ C⁻¹ z for two parameters: (a² − 2 r a b + b²)/(1 − r²), 2.4 with the correlation of 0.9
    and 45 against it, where each alone would be inside its interval both times."""
    result, names = two_parameters(0.9)
    rows = [row(result, name, each) for name, each in zip(names, off, strict=True)]
    group = together("g", result, rows)
    a, b = off
    expected = (a * a - 2 * 0.9 * a * b + b * b) / (1 - 0.81)
    assert group.distance == pytest.approx(expected, rel=1e-6)
    assert group.chance == pytest.approx(chi2.sf(expected, 2), rel=1e-6)


def test_without_a_correlation_there_is_no_distance() -> None:
    """A singular fit has none, and what cannot be judged does not pass."""
    result, names = two_parameters(0.9)
    group = together("g", replace(result, correlation=None), [row(result, names[0], 0.0)])
    assert (group.distance, group.chance) == (None, None)
    assert not judged([row(result, names[0], 0.0)], [group]).passed


@pytest.mark.parametrize(
    ("distance", "count", "passed"), [(48.0, 48, True), (90.0, 48, False), (15.0, 48, False)]
)
def test_intervals_that_are_too_narrow_or_too_wide_fail(
    distance: float, count: int, passed: bool
) -> None:
    """48 parameters have a sum of 48 ± 10: 90 is that of errors stated a quarter too small, which
    would leave 88 % inside, and 15 that of errors stated nearly twice too large."""
    result, names = two_parameters(0.0)
    rows = [row(result, names[0], 0.0)]
    group = SelfCheckGroup("g", count, distance, float(chi2.sf(distance, count)))
    assert judged(rows, [group]).passed is passed


def test_one_parameter_far_away_fails() -> None:
    """Two half-widths are four standard errors, however well the others do."""
    result, names = two_parameters(0.0)
    rows = [row(result, names[0], 4.0)]
    assert not judged(rows, [SelfCheckGroup("g", 7, 7.0, 0.43)]).passed
