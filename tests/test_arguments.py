"""The public functions say in one sentence what they cannot be called with, and what to do."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from handmade import fit_result, step_log

import softid


def _log() -> softid.Log:
    time_s = 0.01 * np.arange(300)
    return softid.Log.from_arrays(time_s, {"pressure": time_s, "angle": time_s})


@pytest.mark.parametrize(
    "function",
    [softid.fit, softid.diagnose, softid.inspect, lambda log: softid.fit([log])],
    ids=["fit", "diagnose", "inspect", "fit of several"],
)
@pytest.mark.parametrize("name", ["step.csv", Path("step.csv")], ids=["text", "path"])
def test_the_name_of_a_file_is_no_log(function: Callable[..., object], name: str | Path) -> None:
    with pytest.raises(softid.UsageError, match=r"'step\.csv'.*softid\.load") as raised:
        function(name)
    assert raised.value.exit_code == 2


def test_arrays_are_no_log_either() -> None:
    with pytest.raises(softid.UsageError, match=r"ndarray.*Log\.from_arrays"):
        softid.fit([np.arange(3.0)])  # type: ignore[list-item]
    with pytest.raises(softid.UsageError, match=r"float.*Log\.from_arrays"):
        softid.fit(np.arange(3.0))  # type: ignore[arg-type]


@pytest.mark.parametrize(
    "function",
    [
        softid.inspect,
        softid.fit,
        softid.diagnose,
        lambda log: softid.fit(_log(), hold_out=log),
        lambda log: softid.validate(fit_result(), log),
    ],
    ids=["inspect", "fit", "diagnose", "hold-out", "validate"],
)
def test_a_log_that_was_read_for_its_input_alone_explains_nothing(
    function: Callable[[softid.Log], object],
) -> None:
    with pytest.raises(softid.UsageError, match=r"^log: the log has no output.*outputs=None"):
        function(replace(_log(), outputs=()))


def test_the_key_of_a_model_is_no_model() -> None:
    with pytest.raises(softid.UsageError, match=r"'muscle'.*MODELS"):
        softid.simulate("muscle", {}, _log())  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"model": softid.Muscle}, r"not a model \(got 'the class Muscle'\); give an instance"),
        ({"preferred": ["spring"]}, r"no such model \(got 'spring'\); choose from muscle"),
        ({"preferred": [3]}, r"not a model \(got 'int'\).*or a name: muscle,"),
        ({"preferred": "muscle"}, r"preferred: .*list of models \(got 'muscle'\).*brackets"),
        ({"preferred": softid.Muscle()}, r"preferred: .*list of models \(got 'muscle'\).*brackets"),
        ({"model": 3}, r"not a model \(got 'int'\).*or a name: muscle,"),
        (
            {"model": "muscle", "parameters": {"M": 1.0}},
            r"'dict'.*lmfit Parameters.*parameters\(\)",
        ),
        ({"seed": -1}, r"seed: .*got -1"),
        ({"seed": 0.5}, r"seed: .*got 0\.5"),
    ],
    ids=[
        "class",
        "preferred name",
        "preferred number",
        "name alone",
        "model alone",
        "number",
        "dict",
        "negative seed",
        "no seed",
    ],
)
@pytest.mark.parametrize("function", [softid.fit, softid.diagnose], ids=["fit", "diagnose"])
def test_wrong_options_are_told(
    function: Callable[..., object], options: dict[str, object], said: str
) -> None:
    with pytest.raises(softid.UsageError, match=said):
        function(step_log(samples=400), **options)


def test_a_seed_of_redrawn_residuals_is_not_negative() -> None:
    with pytest.raises(softid.UsageError, match=r"seed: .*got -1"):
        softid.bootstrap_parameters(fit_result(), _log(), seed=-1)


@pytest.mark.parametrize("bar", ["70", float("nan"), 101.0])
def test_a_bar_that_nothing_can_be_held_against(bar: float) -> None:
    with pytest.raises(softid.UsageError, match=r"threshold_percent: .*such as 70"):
        softid.validate(fit_result(), _log(), threshold_percent=bar)


@pytest.mark.parametrize(
    ("effects", "said"),
    [
        ("creep", r"effects: .*'creep'.*write effects=\['creep'\]"),
        (3, "effects: .*got 3"),
        ([3], r"effects: .*got \[3\]"),
        (["crep"], "no such effect .*'crep'.*creep"),
    ],
)
def test_effects_are_several_names(effects: Sequence[str], said: str) -> None:
    """One name alone would be taken letter by letter."""
    with pytest.raises(softid.UsageError, match=said):
        softid.diagnose(_log(), effects=effects)


def test_the_name_of_a_recipe_is_no_recipe() -> None:
    with pytest.raises(softid.UsageError, match=r"'x\.toml'.*load_recipe"):
        softid.synthesize("x.toml")  # type: ignore[arg-type]


def test_what_was_never_fitted_cannot_be_validated() -> None:
    with pytest.raises(softid.UsageError, match=r"dict.*softid\.fit"):
        softid.validate({"M": 1.0}, _log())  # type: ignore[arg-type]


def test_a_file_of_parameters_that_is_not_there_is_named(tmp_path: Path) -> None:
    with pytest.raises(softid.InputError, match=r"none\.json: there is no such file"):
        softid.validate(tmp_path / "none.json", _log())
