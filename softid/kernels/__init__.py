"""Compiled array code: plain arrays in, plain arrays out, no import from the rest of softid."""

from softid.kernels.compilation import needs_compiling

__all__ = ["needs_compiling"]
