"""`softid demo`: the main job on a bundled log."""

from __future__ import annotations

from pathlib import Path

import click

from softid_cli.console import say
from softid_cli.fit import FitRequest, identify
from softid_cli.options import json_option, out_options, quiet_option

DEMO_LOG = Path("data") / "demo_step.csv"


@click.command()
@out_options()
@json_option
@quiet_option
def demo(out: Path | None, force: bool, as_json: bool, quiet: bool) -> None:
    """Fit a bundled synthetic log and print what `softid fit` prints.

    The log is simulated, not measured: pressure steps, a sine and a ramp on a bending muscle, with
    noise, valve lag, lost samples and a sensor zero as on a real rig. The true parameters are in
    manifest.json, in the folder above the log's.
    """
    from softid.synthesis import bundled_datasets

    log = bundled_datasets() / DEMO_LOG
    if not quiet:
        say(f"softid fit {log}")
    identify(FitRequest(logs=(log,), out=out, force=force, as_json=as_json, quiet=quiet))
