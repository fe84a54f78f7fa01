"""`softid synthesize --hide`: what it writes, prints and returns."""

from __future__ import annotations

import json
from collections.abc import Callable
from hashlib import sha256
from pathlib import Path

import numpy as np
import pytest
from desk import Outcome
from jsonschema import Draft202012Validator

from softid.readers import load
from softid.records.reading import load_schema
from softid.synthesis import HIDDEN, hidden_pair

Softid = Callable[..., Outcome]


def test_files_and_truth(softid: Softid, tmp_path: Path) -> None:
    """The CSVs read back to the logs of the Python function; the truth has every parameter."""
    out = tmp_path / "out"
    done = softid(
        "synthesize", "--hide", "creep,delay", "--protocol", "step", "--seed", "3", "--out", out
    )
    assert (done.code, "written to" in done.err) == (0, True)
    assert sorted(p.name for p in out.iterdir()) == ["hold_out.csv", "train.csv", "truth.json"]
    pair = hidden_pair(("creep", "delay"), seed=3, protocol="step")
    truth = json.loads((out / "truth.json").read_text())
    for log, entry, name in zip(pair.logs, truth["logs"], ("train", "hold_out"), strict=True):
        read = load(out / f"{name}.csv")
        assert (read.input, read.outputs) == (log.input, log.outputs)
        for channel, values in log.channels.items():
            assert np.array_equal(read.channels[channel].values, values.values)
        assert entry["sha256"] == sha256((out / f"{name}.csv").read_bytes()).hexdigest()
    assert [effect["effect"] for effect in truth["hidden"]] == ["creep", "delay"]
    assert truth["hidden"][0]["parameters"]["k"] == {
        "value": pair.hidden["creep"]["k"], "unit": "1/mm",
    }  # fmt: skip
    for name, value in pair.actuator.values.items():
        assert truth["parameters"][name]["value"] == value
        assert f"{value:.6g}" in done.out


def test_json_and_options(softid: Softid) -> None:
    """stdout is the truth as one document; every option has reached the log."""
    done = softid(
        "synthesize", "--hide", "none", "--model", "oscillator", "--protocol", "slow", "--size",
        "0.5", "--noise", "0.01", "--coloured", "0.9", "--rate", "50", "--rest", "30", "--unit",
        "deg", "--json", "--quiet",
    )  # fmt: skip
    assert (done.code, done.err) == (0, "")
    truth = json.loads(done.out)
    assert (truth["model"], truth["size"], truth["hidden"]) == ("oscillator", 0.5, [])
    rig = truth["rig"]
    assert (rig["noise"], rig["coloured_share"], rig["unit"]) == (0.01, 0.9, "deg")
    assert truth["logs"][0]["rows"] == 50 * (50 + 30) + 1
    assert (
        Path("softid-out/hidden/train.csv").read_text().startswith("time_s,pressure_kpa,angle_deg")
    )


@pytest.mark.parametrize(
    ("model", "names"), [("muscle", "creep,periodic_gain"), ("oscillator", "none")]
)
def test_the_truth_is_valid_by_its_schema(softid: Softid, model: str, names: str) -> None:
    """The schema is the published format; a law of no catalogue has no name that is right."""
    step = ("--protocol", "step", "--model", model)
    done = softid("synthesize", "--hide", names, *step, "--json", "--quiet", "--out", "here")
    assert done.code == 0, done.err
    truth = json.loads(Path("here/truth.json").read_text())
    schema = load_schema(truth["schema"])
    for document in (truth, json.loads(done.out)):
        Draft202012Validator(schema).validate(document)
    assert set(schema["properties"]) == set(truth)
    assert set(schema["$defs"]["rig"]["properties"]) == set(truth["rig"])
    assert set(schema["$defs"]["sizes"]["properties"]) == set(truth["sizes"])


def test_nothing_is_overwritten_unasked(softid: Softid) -> None:
    """The second run is refused with 3 and changes nothing, unless --force is said."""
    arguments = ("synthesize", "--hide", "delay", "--protocol", "step", "--out", "here")
    assert softid(*arguments).code == 0
    before = Path("here/train.csv").read_bytes()
    refused = softid(*arguments, "--seed", "1")
    assert (refused.code, "--force" in refused.err) == (3, True)
    assert Path("here/train.csv").read_bytes() == before
    assert softid(*arguments, "--seed", "1", "--force").code == 0
    assert Path("here/train.csv").read_bytes() != before


def test_an_unknown_name_gets_the_list(softid: Softid) -> None:
    """Exit 2, every name there, nothing written."""
    done = softid("synthesize", "--hide", "creep,creeep")
    assert done.code == 2
    assert all(name in done.err for name in HIDDEN)
    assert not Path("softid-out").exists()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("--hide", ""), "choose from"),
        (("--hide", "creep,creep"), "--hide: an effect is named twice"),
        (("--hide", "creep", "--check"), "--check"),
        (("--hide", "creep", "recipe.toml"), "leave out the recipes."),
        (("--hide", "creep", "--noise", "-1"), "--noise: noise is out of range"),
        (("--hide", "creep", "--coloured", "1.5"), "--coloured: coloured_share"),
        (("--hide", "creep", "--rate", "nan"), "--rate: rate_hz"),
        (("--hide", "creep", "--rest", "1e9"), "--rest: rest_s"),
        (("--hide", "creep", "--size", "0"), "--size: "),
        (("--hide", "creep", "--size", "nan"), "--size: "),
        (("--hide", "creep", "--protocol", "best"), "--protocol: there is no such"),
        (("--hide", "creep", "--model", "polynomial"), "--model: there is no generator"),
        (("--size", "2"), "error: --size: without --hide the recipe says this"),
        (
            ("--rate", "9", "--unit", "mm"),
            "error: --rate, --unit: without --hide the recipe says this",
        ),
        (("--hide", "creeep,"), "(got 'creeep')"),
        (("--check", "--force"), "leave out --force."),
        (("--unit", "deg"), "--hide"),
    ],
)
def test_wrong_usage(softid: Softid, arguments: tuple[str, ...], words: str) -> None:
    """Exit 2 with the remedy, and nothing is written."""
    done = softid("synthesize", *arguments)
    assert (done.code, words in done.err) == (2, True), done.err
    assert not Path("softid-out").exists()


def test_a_size_beyond_reason_is_bad_input(softid: Softid) -> None:
    """A softening spring of a million times its size has no response: exit 3, told in a line."""
    done = softid("synthesize", "--hide", "stiffening,pleats", "--size", "1e12")
    assert (done.code, done.err.count("\n")) == (3, 1)
    assert "smaller" in done.err
