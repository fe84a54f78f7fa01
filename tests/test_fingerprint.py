"""The fingerprint of samples is that of their values, that of a file the sha256 of its bytes."""

from __future__ import annotations

import io

import numpy as np

from softid.fingerprint import (
    CHUNK_BYTES,
    content_fingerprint,
    data_fingerprint,
    facts_fingerprint,
    stream_fingerprint,
)

TIME_S, ANGLE = np.arange(5) / 10.0, np.array([0.0, 1.0, np.nan, 3.0, 4.0])


def test_equal_samples_have_one_fingerprint() -> None:
    """In whatever order, layout and sign of zero; two channels do not change places."""
    both = {"angle": ANGLE, "force": TIME_S}
    known = data_fingerprint(TIME_S, both)
    spread = np.column_stack((ANGLE, ANGLE))[:, 0]
    assert data_fingerprint(TIME_S, {"force": TIME_S, "angle": spread}) == known
    assert data_fingerprint(TIME_S, {"force": -0.0 + TIME_S, "angle": ANGLE * 1.0}) == known
    assert data_fingerprint(np.where(TIME_S == 0.0, -0.0, TIME_S), both) == known
    assert data_fingerprint(TIME_S, {"angle": ANGLE, "force": -np.nan * ANGLE}) != known
    assert data_fingerprint(TIME_S, {"force": ANGLE, "angle": TIME_S}) != known


def test_one_other_bit_has_another() -> None:
    """A later start, one sample, one fewer."""
    known = data_fingerprint(TIME_S, {"angle": ANGLE})
    other = ANGLE.copy()
    other[1] = np.nextafter(1.0, 2.0)
    assert data_fingerprint(TIME_S, {"angle": other}) != known
    assert data_fingerprint(TIME_S + 1.0, {"angle": ANGLE}) != known
    assert data_fingerprint(TIME_S[:-1], {"angle": ANGLE[:-1]}) != known


def test_files_have_the_fingerprint_that_everybody_computes() -> None:
    """The sha256 of "abc" is that of FIPS 180-4; pieces of a stream have that of their whole."""
    known = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"
    assert content_fingerprint("abc") == content_fingerprint(b"abc") == known
    long = bytes(range(256)) * (CHUNK_BYTES // 128)
    assert stream_fingerprint(io.BytesIO(long)) == content_fingerprint(long)


def test_facts_are_known_in_any_order() -> None:
    """A record read back may have its keys in another order."""
    assert facts_fingerprint({"a": 1, "b": [2.5]}) == facts_fingerprint({"b": [2.5], "a": 1})
    assert facts_fingerprint({"a": 1}) != facts_fingerprint({"a": 2})
