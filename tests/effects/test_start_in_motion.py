"""Logs that begin while the material still creeps: where its own state starts is not known."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from linear_motion import MODEL, TRUTH, linear_log, linear_problem

from softid.diagnosis.refit.characteristic_scales import scale_of
from softid.effects import effects_of
from softid.effects.extension.extended_model import ExtendedModel
from softid.fitters.problem import Problem
from softid.kernels.filters import lag
from softid.log import Log
from softid.results import LogNuisance, SegmentStart
from softid.simulation import simulate

TAU_S = 6.0
BEGIN = 700
"""Sample of the whole log with which the cut one begins."""


def creeping(*keys: str) -> tuple[ExtendedModel, dict[str, float]]:
    """The linear actuator with creep and other effects, and its parameters."""
    problem = linear_problem((linear_log(),))
    model = ExtendedModel(
        MODEL, effects_of(["creep", *keys]), scale_of(problem, problem.unknowns(TRUTH))
    )
    own = {"creep_k": 20.0, "creep_tau": TAU_S, "hysteresis_alpha": 2.0, "hysteresis_zs": 0.1}
    declared = model.parameters()
    known = {name: value for name, value in (TRUTH | own).items() if name in declared}
    values = declared.with_values(known)
    return model, dict(zip(values.names, values.values_vector().tolist(), strict=True))


def behind(log: Log, first: int) -> Log:
    """The log from a sample on."""
    return log.between(log.time_s[first], np.inf)


def test_only_what_rests_at_the_position_may_start_off_it() -> None:
    """A hysteresis rests at zero, and has no state among the starts."""
    assert creeping("hysteresis")[0].start_states == ("x", "v", "creep")
    assert creeping()[0].states == ("x", "v", "creep")


def test_a_log_that_is_cut_goes_on_from_its_state() -> None:
    """Known truth: the rest of a whole log, with the state in which it was there. The own state is
    the position behind a lag of its time, here by an exact filter."""
    model, values = creeping()
    whole = linear_log(samples=1500)
    found = simulate(model, values, whole).outputs["angle"]
    late = found.copy()
    lag(np.diff(whole.time_s), late, TAU_S, TAU_S)
    v = np.gradient(found, whole.time_s)[BEGIN]
    state = (float(found[BEGIN]), float(v), float(late[BEGIN] - found[BEGIN]))
    start = SegmentStart(float(whole.time_s[BEGIN]), at_rest=False, state=state)
    begun = LogNuisance(whole.name, {"angle": 0.0}, {"angle": None}, (start,))
    again = simulate(model, values, behind(whole, BEGIN), nuisance=begun).outputs["angle"]
    np.testing.assert_allclose(again, found[BEGIN:], atol=3e-3 * np.ptp(found))
    settled = replace(begun, starts=(replace(start, state=(*state[:2], 0.0)),))
    other = simulate(model, values, behind(whole, BEGIN), nuisance=settled).outputs["angle"]
    assert np.abs(other - found[BEGIN:]).max() > 0.05 * np.ptp(found)


def test_the_start_has_its_derivative() -> None:
    """By central differences of the simulation."""
    model, values = creeping("hysteresis")
    declared = model.parameters().with_values(values)
    problem = Problem(model, declared, (behind(linear_log(), 70),))
    at = problem.state_positions(0)
    assert len(at) == 3
    z = problem.free_unknowns(values)
    z[at] = (0.2, -0.5, 0.3)
    (block,) = problem.blocks(z, derivatives=True)
    assert block.jacobian is not None
    for column in at:
        up, down = z.copy(), z.copy()
        up[column] += 1e-5
        down[column] -= 1e-5
        ((above,), (below,)) = (list(problem.blocks(x, derivatives=False)) for x in (up, down))
        slope = (below.residual - above.residual) / 2e-5
        np.testing.assert_allclose(block.jacobian[:, column], slope, atol=1e-5)


def test_nuisances_go_over_by_name() -> None:
    """From a model without effects to one with creep and back; what the other has not stays."""
    model, values = creeping()
    log = behind(linear_log(), 70)
    extended = Problem(model, model.parameters().with_values(values), (log,))
    base = Problem(MODEL, MODEL.parameters().with_values(TRUTH), (log,))
    z, unknowns = extended.free_unknowns(values), base.free_unknowns(TRUTH)
    unknowns[base.state_positions(0)] = (0.1, 0.2)
    z[extended.state_positions(0)] = (0.0, 0.0, 0.7)
    moved = extended.with_nuisance_of(z, base, unknowns)
    assert moved[extended.state_positions(0)].tolist() == [0.1, 0.2, 0.7]
    back = base.with_nuisance_of(unknowns, extended, extended.free_unknowns(values))
    assert back[base.state_positions(0)].tolist() == [0.0, 0.0]
