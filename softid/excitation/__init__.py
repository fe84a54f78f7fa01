"""How an input excites: stretches of one kind each, and the windows in which it stands still."""

from softid.excitation.holds import SettledWindow, distinct_levels, settled_windows
from softid.excitation.segmentation import Kind, Stretch, dominant_kind, segment_excitation
from softid.excitation.texture import (
    Quantisation,
    SampleHold,
    find_hold,
    find_quantisation,
    noise_std,
)

__all__ = [
    "Kind",
    "Quantisation",
    "SampleHold",
    "SettledWindow",
    "Stretch",
    "distinct_levels",
    "dominant_kind",
    "find_hold",
    "find_quantisation",
    "noise_std",
    "segment_excitation",
    "settled_windows",
]
