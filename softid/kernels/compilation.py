"""Whether the kernels lie compiled on disk, so that a first run can say why it is slow."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from softid.kernels.affine import move, move_with_derivatives, sum_products
from softid.kernels.affine_descent import descend
from softid.kernels.division import count_steps
from softid.kernels.muscle import coefficients

KERNELS: tuple[Any, ...] = (
    descend,
    move,
    move_with_derivatives,
    sum_products,
    count_steps,
    coefficients,
)
"""What a fit of the muscle model needs."""


def needs_compiling() -> bool:
    """Whether any kernel is missing in numba's cache for this version of its source.

    The compiled code lies beside the source or, where that is read-only, in numba's cache folder
    of the user. numba has no public question for this; where its internals differ the answer is
    False, which costs a message and nothing else.
    """
    for kernel in KERNELS:
        try:
            known = kernel._cache._cache_file._load_index()
        except (AttributeError, OSError):
            return False
        if not known:
            return True
    return False


def cache_folder() -> Path:
    """Where the compiled kernels are kept.

    Beside the source; where that is read-only, in numba's cache folder of the user or in the folder
    that ``NUMBA_CACHE_DIR`` names.
    """
    return Path(str(move.stats.cache_path))
