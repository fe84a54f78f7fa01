"""Readers: from a file to a log, one file format per module."""

from softid.readers.base import Reader, Table
from softid.readers.formats import READERS
from softid.readers.loading import load

__all__ = ["READERS", "Reader", "Table", "load"]
