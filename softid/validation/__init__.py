"""Scores on logs that were not fitted, and the check of softid against known truths."""

from softid.validation.scoring import validate
from softid.validation.self_check import SelfCheck, SelfCheckGroup, SelfCheckRow, self_check

__all__ = ["SelfCheck", "SelfCheckGroup", "SelfCheckRow", "self_check", "validate"]
