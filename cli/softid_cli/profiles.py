"""Profile likelihoods that the user asked for: computed, printed, drawn, recorded."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from softid.errors import UsageError
from softid.sentences import listed

if TYPE_CHECKING:
    from softid.log import Log
    from softid.records.plain import Plain
    from softid.results import FitResult
    from softid.uncertainty.profile import ProfileResult
    from softid_cli.console import ProgressCallback


def profiled(
    result: FitResult,
    logs: Sequence[Log],
    names: Sequence[str],
    *,
    progress: ProgressCallback | None,
) -> dict[str, ProfileResult]:
    """Profile the named parameters of a finished fit.

    Raises
    ------
    UsageError
        A name is not a parameter that was free.
    """
    if not names:
        return {}
    from softid.identification.profile_likelihood import profile_parameter

    free = [p.name for p in result.parameters if not p.fixed and p.tie is None]
    for name in names:
        if name not in free:
            raise UsageError(
                "this parameter was not free in the fit",
                where="--profile",
                value=name,
                remedy=f"choose from {', '.join(free)}",
            )
    found = {}
    for k, name in enumerate(dict.fromkeys(names)):
        if progress is not None:
            progress(f"refitting along {name}", k / len(names))
        found[name] = profile_parameter(result, logs, name)
    return found


def print_profiles(result: FitResult, profiles: Mapping[str, ProfileResult]) -> None:
    """Print the interval of every profile in a sentence."""
    from softid.interval_words import interval_in_words
    from softid_cli.tables import print_text

    for name, profile in profiles.items():
        unit = result.parameter(name).unit
        text = f"{name} by profile: 95 % interval {interval_in_words(profile.ci95)} {unit}"
        open_sides = [
            side for side, end in zip(("below", "above"), profile.ci95, strict=True) if end is None
        ]
        if open_sides:
            text += f", open {listed(open_sides)}: the logs set no limit there"
        if profile.better_value is not None:
            text += f"; a better fit lies near {profile.better_value:.4g}, so fit again from there"
        print_text(text)


def profile_entries(profiles: Mapping[str, ProfileResult]) -> dict[str, Plain]:
    """The profiles as params.json holds them."""
    from softid.records import to_jsonable

    return {name: to_jsonable(profile) for name, profile in profiles.items()}


def profile_figures(
    result: FitResult, profiles: Mapping[str, ProfileResult]
) -> dict[str, str | bytes]:
    """Draw the profiles: file name → PNG."""
    import numpy as np

    from softid.plots import draw_profile, png_bytes

    drawn: dict[str, str | bytes] = {}
    for name, profile in profiles.items():
        estimate = result.parameter(name)
        figure = draw_profile(
            np.array(profile.values),
            np.array(profile.cost_rise),
            name=name,
            unit=estimate.unit,
            threshold=profile.threshold,
            estimate=estimate.value,
            ci95=profile.ci95,
        )
        drawn[f"profile_{name}.png"] = png_bytes(figure)
    return drawn
