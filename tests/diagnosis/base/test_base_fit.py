"""The fit that is extended: what is refused, what judges, what is negligible, what is restored."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from linear_motion import MODEL, RATE_HZ, TRUTH, linear_angle, linear_log, pressure_course

from softid.diagnosis.base.base_fit import (
    FEWEST_SAMPLES,
    HIDDEN_PERIODS,
    LEAST_MOVE,
    NEGLIGIBLE,
    BaseFit,
    Recordings,
    Request,
    _whole_values,
    require_driven,
    require_enough,
    require_moving,
)
from softid.diagnosis.refit.held_out import HeldOutBlocks, HeldOutLogs
from softid.errors import IdentificationError, InputError, UsageError
from softid.identification.preparation import require_excitation
from softid.log import Log, LogSet
from softid.models import Oscillator

MOVING = linear_log()
"""Its input has a range of 90 kPa."""


def driven(pressure: np.ndarray, name: str = "other") -> Log:
    """A log of some input whose output does not matter."""
    time_s = np.arange(pressure.size) / RATE_HZ
    return Log.from_arrays(time_s, {"pressure": pressure, "angle": 0.01 * pressure}, name=name)


def shortened(log: Log, samples: int) -> Log:
    """All but the first samples masked."""
    return log.with_masked(np.arange(len(log)) >= samples)


def request(model: Any = MODEL, **options: Any) -> Request:
    wishes: dict[str, Any] = {"parameters": None, "seed": 0, "progress": lambda *_: None}
    return Request(model, **(wishes | options))


def test_logs_with_too_few_samples_are_refused() -> None:
    """One below the limit is, the limit is not; what is masked does not count."""
    enough, short = (shortened(MOVING, FEWEST_SAMPLES - k) for k in (0, 1))
    require_enough(LogSet((enough,)))
    require_enough(LogSet((enough,)), [enough])
    with pytest.raises(IdentificationError, match="too few samples of the output to tell") as told:
        require_enough(LogSet((short,)))
    assert told.value.value == FEWEST_SAMPLES - 1
    with pytest.raises(IdentificationError, match="to judge a cause"):
        require_enough(LogSet((enough,)), [short])


def test_samples_of_all_logs_count_together() -> None:
    """Two halves make a whole."""
    half = shortened(MOVING, FEWEST_SAMPLES // 2)
    require_enough(LogSet((half, replace(half, name="second"))))
    with pytest.raises(IdentificationError):
        require_enough(LogSet((half,)))


def test_an_input_that_shows_its_noise_alone_is_refused() -> None:
    """One log that moves is enough; a step of ten times the noise is a move.

    What `fit` and `diagnose` say of an input that does not move has one exit code.
    """
    noise = np.random.default_rng(3).standard_normal(1000)
    still, stepped = driven(50.0 + noise), driven(50.0 + noise + 10.0 * (np.arange(1000) > 500))
    with pytest.raises(InputError, match="does not move beyond its noise") as told:
        require_driven(LogSet((still,)))
    assert "kPa" in str(told.value.value)
    require_driven(LogSet((still, replace(MOVING, name="moving"))))
    require_driven(LogSet((stepped,)))
    flat = LogSet((driven(np.full(1000, 50.0)),))
    for refuse in (require_excitation, require_driven):
        with pytest.raises(InputError):
            refuse(flat)


@pytest.mark.parametrize(("share", "judges"), [(1.1 * LEAST_MOVE, True), (0.9 * LEAST_MOVE, False)])
def test_what_is_held_out_must_move(share: float, judges: bool) -> None:
    """By a twentieth of the range of the fitted logs' input; one log that does is enough."""
    reach = share * float(np.ptp(MOVING.pressure_kpa))
    other = driven(50.0 + 0.5 * reach * np.sin(np.arange(1000) / 5.0))
    still = driven(np.full(1000, 50.0), name="still")
    if judges:
        require_moving(LogSet((MOVING,)), [still, other])
        return
    with pytest.raises(IdentificationError, match="hardly moves, so it cannot judge") as told:
        require_moving(LogSet((MOVING,)), [still, other])
    assert "a range of 4.05 kPa, and of 90 kPa in what is fitted" in str(told.value)


def test_a_log_of_one_level_a_segment_moves() -> None:
    """Stalls of the clock between the levels part it into segments, none of which moves."""
    time_s = np.concatenate([20.0 * k + np.arange(250) / RATE_HZ for k in range(4)])
    levels = np.repeat([0.0, 30.0, 60.0, 90.0], 250)
    stepped = Log.from_arrays(time_s, {"pressure": levels, "angle": levels / 100.0}, name="levels")
    assert len(list(stepped.segments())) == 4
    require_moving(LogSet((MOVING,)), [stepped])


def test_recordings_stay_the_same_object_where_nothing_changes() -> None:
    """Else every log is changed alike, those that judge as well."""
    whole = Recordings(LogSet((MOVING,)), (driven(MOVING.pressure_kpa),))
    assert whole.each(lambda log: log) is whole
    renamed = whole.each(lambda log: replace(log, name=f"{log.name}!"))
    assert [log.name for log in renamed.logs] == [f"{MOVING.name}!"]
    assert [log.name for log in renamed.hold_out] == ["other!"]
    one = whole.each(lambda log: replace(log, name="new") if log.name == "other" else log)
    assert one is not whole
    assert next(iter(one.logs)) is MOVING


@pytest.mark.parametrize(("share", "negligible"), [(0.99, True), (1.01, False)])
def test_a_negligible_misfit_by_hand(share: float, negligible: bool) -> None:
    """Closed form: rms = σ √(S/n) beside the output's range of 2, of the first output alone."""
    n, sigma, span = 400, 0.5, 2.0
    squares = n * (share * NEGLIGIBLE * span / sigma) ** 2
    problem: Any = SimpleNamespace(n_samples=n, outputs=("angle", "force"))
    candidate: Any = SimpleNamespace(problem=problem, squares=squares)
    optimum = SimpleNamespace(sigma={"angle": sigma, "force": 7.0})
    identified: Any = SimpleNamespace(found=SimpleNamespace(optimum=optimum))
    scale, nothing = SimpleNamespace(y_span=span), HeldOutLogs(())
    base = BaseFit(identified, candidate, scale, nothing)  # type: ignore[arg-type]
    assert base.sigma == {"angle": sigma, "force": 7.0}
    assert base.is_negligible is negligible
    assert base.asked_for is base
    assert replace(base, instead_of=base).asked_for is base


def test_a_static_model_is_refused() -> None:
    """Before anything is fitted."""
    with pytest.raises(UsageError, match="no motion"):
        request("polynomial").fit_base(LogSet((MOVING,)), (), thorough=False)


def test_other_logs_judge_or_blocks_do() -> None:
    """Known truth: the base is the law, and its sizes are those of the log either way."""
    log = linear_log(noise=0.001)
    other = replace(linear_log(noise=0.001, seed=1), name="other")
    on_blocks = request().fit_base(LogSet((log,)), (), thorough=False)
    assert isinstance(on_blocks.held_out, HeldOutBlocks)
    fitted = on_blocks.candidate.problem.logs[0].masked
    assert fitted is not None
    assert np.array_equal(fitted, on_blocks.held_out.blocks[0])
    on_log = request().fit_base(LogSet((log,)), (other,), thorough=False)
    assert isinstance(on_log.held_out, HeldOutLogs)
    assert [one.name for one in on_log.held_out.logs] == ["other"]
    for base in (on_blocks, on_log):
        assert base.candidate.effects == ()
        values = {name: base.candidate.parameters[name] for name in TRUTH}
        assert values == pytest.approx(TRUTH, rel=0.02)
        assert base.scale.u_span == pytest.approx(float(np.ptp(log.pressure_kpa)))


@pytest.mark.parametrize("asked", [MODEL, replace(MODEL, order="first")])
def test_a_term_that_cannot_be_seen_is_restored(asked: Oscillator) -> None:
    """Known truth: an inertia that dies out in M/N = 1e-5 s, between two samples 0.02 s apart.

    The fit drops it, the candidate has it, beginning at a tenth of an interval; what was asked for
    stays dropped.
    """
    time_s = np.arange(1000) / RATE_HZ
    pressure = pressure_course(time_s)
    angle = linear_angle(time_s, pressure, TRUTH | {"M": 1e-4})
    angle += 0.001 * np.random.default_rng(0).standard_normal(time_s.size)
    log = Log.from_arrays(time_s, {"pressure": pressure, "angle": angle}, name="light")
    base = request(asked).fit_base(LogSet((log,)), (), thorough=False)
    assert "M" not in base.identified.found.problem.free
    values = base.candidate.parameters
    restored = asked.order == "second"
    assert ("M" in base.candidate.problem.free) is restored
    assert (values["M"] > 0.0) is restored
    assert values["M"] / values["N"] < 2.0 * HIDDEN_PERIODS / RATE_HZ
    assert values["N"] == pytest.approx(TRUTH["N"], rel=0.02)
    if restored:
        begun = _whole_values(base.identified, base.candidate.problem)
        assert begun["M"] / begun["N"] == pytest.approx(HIDDEN_PERIODS / RATE_HZ)
