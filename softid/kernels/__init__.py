"""Compiled array code: plain arrays in, plain arrays out, no import from the rest of softid."""

from softid.kernels.compilation import cache_folder, when_compiling

__all__ = ["cache_folder", "when_compiling"]
