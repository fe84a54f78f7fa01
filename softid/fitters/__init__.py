"""How parameters are found: simultaneous output error, and each paper's own protocol by name."""

from softid.fitters import muscle, polynomial, protocol_spread

__all__ = ["muscle", "polynomial", "protocol_spread"]
