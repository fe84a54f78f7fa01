"""Naming the cause of what a simulation gets wrong."""

from softid.diagnosis.workflow import diagnose

__all__ = ["diagnose"]
