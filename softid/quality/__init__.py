"""What is in a log and what is wrong with it, found on the data alone."""

from softid.quality.findings import (
    Ability,
    ChannelReport,
    CommandLag,
    Dropout,
    Frozen,
    Gap,
    Hum,
    Inspection,
    Sampling,
    Saturation,
    SignCheck,
    StepResponse,
)
from softid.quality.inspection import dropout_mask, inspect

__all__ = [
    "Ability",
    "ChannelReport",
    "CommandLag",
    "Dropout",
    "Frozen",
    "Gap",
    "Hum",
    "Inspection",
    "Sampling",
    "Saturation",
    "SignCheck",
    "StepResponse",
    "dropout_mask",
    "inspect",
]
