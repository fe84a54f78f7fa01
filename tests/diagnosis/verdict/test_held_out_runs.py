"""Held-out samples that follow each other, in blocks of logs and in other logs."""

from __future__ import annotations

import numpy as np
from linear_motion import TRUTH, linear_log, linear_problem, standing

from softid.diagnosis.refit.held_out import HeldOutLogs, hold_out_blocks
from softid.diagnosis.verdict.held_out_runs import held_out_lengths
from softid.log import LogSet


def test_blocks_are_runs_and_lost_samples_are_in_none() -> None:
    """Five blocks of 4 % of each log, 40 of 1000 samples and 60 of 1500; ten are lost in one."""
    logs = LogSet((linear_log(noise=0.01), linear_log(noise=0.01, seed=1, samples=1500)))
    fitted, held = hold_out_blocks(logs)
    first = int(np.flatnonzero(held.blocks[1])[0])
    whole = logs.logs[1].with_masked(np.arange(1500) // 10 == (first + 10) // 10)
    _, held = hold_out_blocks(LogSet((logs.logs[0], whole)))
    problem = linear_problem(fitted.logs)
    base = standing(problem, problem.unknowns(TRUTH))
    lengths = held_out_lengths(held, base)
    assert lengths == (40,) * 5 + (50,) + (60,) * 4
    assert sum(lengths) == held.first_errors(base).size


def test_other_logs_are_runs() -> None:
    """One for each."""
    log = linear_log(noise=0.01)
    problem = linear_problem([log])
    base = standing(problem, problem.unknowns(TRUTH))
    other = linear_log(noise=0.01, seed=1)
    held = HeldOutLogs((other, linear_log(noise=0.01, seed=2, samples=700)))
    assert held_out_lengths(held, base) == (1000, 700)
    assert sum(held_out_lengths(held, base)) == held.first_errors(base).size
