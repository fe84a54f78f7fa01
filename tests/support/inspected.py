"""What an inspection remarks."""

from __future__ import annotations

from softid.quality import Inspection


def codes(found: Inspection) -> set[str]:
    """The codes of its remarks."""
    return {issue.code for issue in found.issues}
