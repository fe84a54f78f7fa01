"""The reading of the input between its samples, looked at again with a cause in the model."""

from __future__ import annotations

from dataclasses import replace

from linear_motion import SIGMA, TRUTH, linear_log, linear_problem, standing

from softid.diagnosis.other_reading import (
    better_reading,
    is_measured,
    is_open,
    last_reading,
    read_as,
    straight_unless_told,
)
from softid.log import LogSet

LOG = linear_log(noise=0.01)
"""Its pressure jumps every 5 s, and its answer is exact for straight lines between samples."""


def test_a_wrong_reading_is_left_for_the_true_one() -> None:
    """Stands on the truth of the log, at the true parameters."""
    held = linear_problem(read_as([LOG], "held"))
    z = held.unknowns(TRUTH)
    assert better_reading(standing(held, z), SIGMA) == "straight"
    straight = linear_problem(read_as([LOG], "straight"))
    assert better_reading(standing(straight, z), SIGMA) is None


def test_a_measured_input_is_straight_where_that_does_as_well() -> None:
    """Readings that explain alike: noise of the size of the motion hides what lies between."""
    log = linear_log(noise=1.0)
    held = linear_problem(read_as([log], "held"))
    z = held.unknowns(TRUTH)
    sigma = {"angle": 1.0}
    assert better_reading(standing(held, z, sigma), sigma) is None
    assert last_reading(standing(held, z, sigma), sigma) == "straight"
    command = replace(log, channels={
        "pressure_command": log.channels["pressure"], "angle": log.channels["angle"]
    }, input="pressure_command")  # fmt: skip
    commanded = linear_problem(read_as([command], "held"))
    assert last_reading(standing(commanded, z, sigma), sigma) is None


def test_only_what_nobody_declared_is_open() -> None:
    """Declared readings stay, and an input without a jump has but one."""
    assert is_open(LogSet((LOG,)))
    assert not is_open(LogSet(read_as([LOG], "straight")))
    smooth = LOG.between(1.2, 3.4)
    assert not is_open(LogSet((smooth,)))
    assert not is_open(LogSet((LOG, replace(linear_log(seed=1), intersample="held"))))


def test_a_reading_takes_the_place_of_another() -> None:
    """What the first one told goes with it."""
    held = read_as([LOG], "zoh")
    assert [issue.code for issue in held[0].issues] == ["held-input"]
    again = read_as(held, "straight")
    assert again[0].intersample == "straight"
    assert not again[0].issues
    assert read_as(again, "held")[0].intersample == "held"


def test_a_command_is_not_measured() -> None:
    """Only a measured input goes straight from one sample to the next by its nature."""
    assert is_measured(LogSet((LOG,)))
    renamed = {"pressure_command": LOG.channels["pressure"], "angle": LOG.channels["angle"]}
    command = replace(LOG, channels=renamed, input="pressure_command")
    assert not is_measured(LogSet((command,)))


def test_what_somebody_said_stays() -> None:
    """A declared reading is kept, and nothing is told of the other."""
    assert straight_unless_told(LOG).intersample == "straight"
    held = replace(LOG, intersample="held")
    assert straight_unless_told(held) is held
