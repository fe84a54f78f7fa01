"""File formats, by suffix."""
