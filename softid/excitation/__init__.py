"""How an input excites: stretches of one kind each, and the windows in which it stands still."""

from softid.excitation.holds import SettledWindow, distinct_levels
from softid.excitation.motion import median_of_five
from softid.excitation.noise import (
    NORMAL_QUARTILE,
    SECOND_DIFFERENCE,
    UNRESOLVED_STEPS,
    noise_std,
    second_difference_noise,
)
from softid.excitation.segmentation import (
    Kind,
    Stretch,
    excitation_and_holds,
    segment_excitation,
    settled_windows,
)
from softid.excitation.texture import (
    Quantisation,
    SampleHold,
    find_dead_band,
    find_hold,
    find_quantisation,
    fresh_samples,
    run_starts,
)

__all__ = [
    "NORMAL_QUARTILE",
    "SECOND_DIFFERENCE",
    "UNRESOLVED_STEPS",
    "Kind",
    "Quantisation",
    "SampleHold",
    "SettledWindow",
    "Stretch",
    "distinct_levels",
    "excitation_and_holds",
    "find_dead_band",
    "find_hold",
    "find_quantisation",
    "fresh_samples",
    "median_of_five",
    "noise_std",
    "run_starts",
    "second_difference_noise",
    "segment_excitation",
    "settled_windows",
]
