"""What is in a log and what is wrong with it, found on the data alone."""

from softid.quality.findings import (
    Ability,
    ChannelReport,
    CommandLag,
    Dropout,
    Frozen,
    Hum,
    Inspection,
    Saturation,
    SignCheck,
    StepResponse,
)
from softid.quality.holding import Hold
from softid.quality.inspection import dropout_mask, inspect, misleading_channels
from softid.quality.sampling import Gap, Sampling

__all__ = [
    "Ability",
    "ChannelReport",
    "CommandLag",
    "Dropout",
    "Frozen",
    "Gap",
    "Hold",
    "Hum",
    "Inspection",
    "Sampling",
    "Saturation",
    "SignCheck",
    "StepResponse",
    "dropout_mask",
    "inspect",
    "misleading_channels",
]
