"""Work that is shared by the processor's cores."""

from softid.parallel.known_objects import KnownObjects, NotKnownError
from softid.parallel.matrix_threads import matrices_on_one_thread
from softid.parallel.sharing import (
    Keeper,
    both,
    in_parallel,
    in_step,
    is_copy,
    kept_in,
    on_two_threads,
    usable_cores,
)

__all__ = [
    "Keeper",
    "KnownObjects",
    "NotKnownError",
    "both",
    "in_parallel",
    "in_step",
    "is_copy",
    "kept_in",
    "matrices_on_one_thread",
    "on_two_threads",
    "usable_cores",
]
