"""Whether a creep and a hysteresis are two laws, or pieces of one that is in no catalogue.

A material that creeps with many times looks like a creep and a hysteresis together, and so does one
that gives way over many distances. Each is closer to two elements of its own kind, though; where
both laws act, and one of them is not quite that of the catalogue, neither kind does without the
other.
"""

from __future__ import annotations

from softid.diagnosis.base.base_fit import BaseFit
from softid.diagnosis.refit.candidates import Candidate
from softid.diagnosis.verdict.chain_consistency import MORE_THAN_NOISE
from softid.diagnosis.verdict.refitted_laws import PROMISING_RATIO, refitted_with, standing_of
from softid.diagnosis.verdict.unlisted_memories import SecondCreep, SecondHysteresis
from softid.diagnosis_results import Remainder
from softid.parallel import in_parallel

MEMORIES = {"creep": SecondCreep, "hysteresis": SecondHysteresis}
"""Name of a cause → the law of a second element of its kind."""

LEAVES_MORE = 4.0
"""Two elements of one kind leave at least so many times of what the two kinds leave above the noise
where both act; a judgement. Of a fractional creep, which is one law, two creeps leave less than a
creep and a hysteresis do."""


def are_two_laws(final: Candidate, base: BaseFit, remainder: Remainder) -> bool:
    """Whether the creep and the hysteresis of a model cannot be two elements of one kind.

    Parameters
    ----------
    final
        The model with all causes, these two among them.
    base
        What it extends.
    remainder
        What it leaves.
    """
    noise = final.squares / (1.0 + remainder.excess)
    limit = noise * (1.0 + LEAVES_MORE * max(remainder.excess, MORE_THAN_NOISE))
    standing, near = standing_of(final, base), max(PROMISING_RATIO * final.squares, limit)

    def left_by(kind: str) -> float:
        (other,) = MEMORIES.keys() - {kind}
        kept = [effect for effect in final.acting if effect.name != other]
        twice = refitted_with(standing, kept, (MEMORIES[kind](),), near=near)
        return float("inf") if twice is None else twice.squares

    return min(in_parallel(left_by, list(MEMORIES))) > limit
