"""Fingerprints, each a sha256 in hexadecimal digits: of samples, of files and of plain values.

By that of its samples a log is known however it was given.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from typing import BinaryIO

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

CHUNK_BYTES = 2**20
"""Bytes of a stream that are held at a time."""


def data_fingerprint(time_s: Array, measured: Mapping[str, Array]) -> str:
    """sha256 of times and measured samples, whatever the order of the channels.

    Parameters
    ----------
    time_s
        Times, shape (n,).
    measured
        Output channel → samples, shape (n,), in its canonical unit; NaN where there is none.

    Examples
    --------
    >>> time_s, angle = np.array([0.0, 0.1]), np.array([0.0, 0.5])
    >>> data_fingerprint(time_s, {"angle": angle})[:8]
    'd6ee4012'
    """
    digest = hashlib.sha256(_bytes(time_s))
    for name in sorted(measured):
        digest.update(b"\0" + name.encode() + b"\0")
        digest.update(_bytes(measured[name]))
    return digest.hexdigest()


def content_fingerprint(content: str | bytes) -> str:
    """sha256 of the content of a file; of text as it is written, in UTF-8.

    Examples
    --------
    >>> content_fingerprint("softid") == content_fingerprint(b"softid")
    True
    """
    data = content.encode() if isinstance(content, str) else content
    return hashlib.sha256(data).hexdigest()


def stream_fingerprint(stream: BinaryIO) -> str:
    """sha256 of what a stream holds from here on, read piece by piece."""
    digest = hashlib.sha256()
    while piece := stream.read(CHUNK_BYTES):
        digest.update(piece)
    return digest.hexdigest()


def facts_fingerprint(facts: Mapping[str, object]) -> str:
    """sha256 of plain values as JSON, whatever the order of the keys.

    Parameters
    ----------
    facts
        What `json.dumps` takes.
    """
    return content_fingerprint(json.dumps(facts, sort_keys=True))


def _bytes(values: Array) -> bytes:
    """The same for equal values: there are two zeros and many numbers that are none."""
    plain = np.asarray(values, "<f8") + 0.0
    return np.where(np.isnan(plain), np.nan, plain).tobytes()
