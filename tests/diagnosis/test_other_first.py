"""Other first causes, for a search that came to nothing from the best one."""

from __future__ import annotations

from linear_motion import SIGMA, TRUTH, Bow, linear_log, linear_problem, standing

from softid.diagnosis.chain import settled
from softid.diagnosis.other_first import other_beginnings
from softid.diagnosis.scale import scale_of
from softid.effects import effect_of


def test_the_others_begin_in_the_order_of_their_promise() -> None:
    """Known truth: a drift and a small parabola. Either pays; a delay does not, and the known first
    cause is not asked again."""
    time_s = linear_log().time_s
    bow = 0.04 * (time_s / time_s[-1]) ** 2
    problem = linear_problem([linear_log(noise=0.01, added=0.01 * time_s + bow)])
    z = problem.unknowns(TRUTH)
    base, scale = settled(standing(problem, z), SIGMA), scale_of(problem, z)
    effects = (effect_of("delay"), effect_of("sensor_drift"), Bow())
    for known, begun in ((None, ["sensor_drift", "bow"]), ("sensor_drift", ["bow"])):
        chains = list(other_beginnings(known, base, effects, scale, SIGMA))
        assert [chain.final.keys[-1] for chain in chains] == begun
        assert all(chain.final.squares < base.squares for chain in chains)
