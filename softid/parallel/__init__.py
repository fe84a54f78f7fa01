"""Work that is shared by the processor's cores."""

from softid.parallel.matrix_threads import matrices_on_one_thread
from softid.parallel.sharing import (
    both,
    in_parallel,
    in_step,
    is_copy,
    on_two_threads,
    usable_cores,
)

__all__ = [
    "both",
    "in_parallel",
    "in_step",
    "is_copy",
    "matrices_on_one_thread",
    "on_two_threads",
    "usable_cores",
]
