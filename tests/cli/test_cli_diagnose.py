"""`softid diagnose`: what is asked of the library, what is written and what is printed."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
from desk import Desk, Outcome
from extended_fits import extended_fit
from handmade import failed_fit, fit_result
from handmade_diagnosis import FRICTION, cause, diagnosis, estimate

from softid.diagnosis.report.summary import write_summary
from softid.diagnosis.report.unlisted_texts import UNLISTED_LAW
from softid.diagnosis_results import Diagnosis, Verdict
from softid.errors import IdentificationError, Issue
from softid.log import Log
from softid.records import load_params, save_fit

Cli = Callable[..., Outcome]


@pytest.fixture
def bench(desk: Desk, monkeypatch: pytest.MonkeyPatch) -> Desk:
    """Diagnosing gives a hand-made answer."""
    desk.answer = write_summary(diagnosis(Verdict.NAMED))

    def diagnose(logs: Sequence[Log], **options: Any) -> Diagnosis:
        desk.asked |= {"logs": [log.name for log in logs], **options}
        desk.asked["hold_out"] = [log.name for log in options["hold_out"]]
        desk.asked["intersample"] = {log.intersample for log in (*logs, *options["hold_out"])}
        if isinstance(desk.answer, BaseException):
            raise desk.answer
        found: Diagnosis = desk.answer
        return found

    fake = ModuleType("softid.diagnosis")
    fake.diagnose = diagnose  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "softid.diagnosis", fake)
    drawn = {"before_after.png": b"\x89PNG"}
    monkeypatch.setattr("softid.plots.png_files", lambda _: drawn)
    return desk


def test_a_second_pressure_is_told_before_the_search(
    softid: Cli, bench: Desk, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As an output that leads: a user with the wrong log need not wait for the answer."""
    bench.answer = IdentificationError("stopped here")
    monkeypatch.setattr("softid.quality.second_inputs.independent_inputs", lambda log: ("p2",))
    told = softid("diagnose", "step_1.csv")
    assert "warning: step_1: p2 moves as an input does, and not with pressure" in told.err
    assert "as an input does" not in softid("diagnose", "step_1.csv", "--quiet").err


def test_exchanged_columns_are_told_before_the_search(
    softid: Cli, bench: Desk, monkeypatch: pytest.MonkeyPatch
) -> None:
    """On the error stream, for it takes minutes; with --quiet nothing is said."""
    bench.answer = IdentificationError("stopped here")
    issue = Issue("output-leads", "warning", "angle moves before pressure does", "look")
    monkeypatch.setattr("softid.quality.causality.leading_outputs", lambda log: (issue,))
    told = softid("diagnose", "step_1.csv")
    assert "warning: step_1: angle moves before pressure does" in told.err
    assert "moves before" not in softid("diagnose", "step_1.csv", "--quiet").err


def test_the_answer(softid: Cli, bench: Desk, tmp_path: Path) -> None:
    """The paragraph, the table in the unit of the log, issues and files; 2 and 0.5 degrees."""
    told = softid("diagnose", "step_1.csv", "--hold-out", "step_2.csv")
    assert told.code == 0, told.err
    flat = " ".join(told.out.split())
    assert flat.startswith("The muscle model misses angle by 2 deg rms on held-out samples")
    assert "coulomb_friction Fc = 0.08 [0.076, 0.084] 412 2 → 0.5 deg" in flat
    assert "vs = 0.02 [0.019, 0.021] rad/s gain 70 to 80 %" in flat
    assert "info: step_2 is short" in flat
    assert max(map(len, told.out.splitlines())) <= 80
    folder = tmp_path / "softid-out" / "step_1-diagnosis"
    names = ["before_after.png", "diagnosis.json", "extended_params.json", "params.json"]
    assert sorted(p.name for p in folder.iterdir()) == names
    assert all(name in told.out for name in names)
    assert load_params(folder / "extended_params.json").model.effects == ("coulomb_friction",)


def test_what_is_asked(softid: Cli, bench: Desk) -> None:
    """Options reach the library as they are meant."""
    told = softid(
        "diagnose", "a.csv", "b.csv", "--hold-out", "c.csv", "d.csv", "--model", "muscle",
        "--damping", "constant", "--effects", "delay, creep,delay", "--seed", "5", "--quiet",
    )  # fmt: skip
    assert told.code == 0, told.err
    assert told.err == ""
    asked = bench.asked
    assert (asked["logs"], asked["hold_out"]) == (["a", "b"], ["c", "d"])
    assert asked["model"].damping == "constant"
    assert asked["effects"] == ("delay", "creep")
    assert (asked["seed"], asked["progress"], asked["parameters"]) == (5, None, None)
    assert asked["intersample"] == {None}
    assert softid("diagnose", "a.csv", "--intersample", "held", "--out", "held").code == 0
    assert bench.asked["intersample"] == {"held"}
    assert softid("diagnose", "a.csv", "--intersample", "linear").code == 2


def test_a_saved_model_is_the_base(softid: Cli, bench: Desk, tmp_path: Path) -> None:
    """Its options, roles and values, of which the values are starts."""
    save_fit(fit_result(), tmp_path / "params.json")
    told = softid("diagnose", "a.csv", "--params", "params.json")
    assert told.code == 0, told.err
    assert bench.asked["model"].spec() == fit_result().model
    assert bench.asked["parameters"].values_dict() == fit_result().values
    assert bench.asked["load"]["input"] == "pressure"
    assert bench.asked["load"]["outputs"] == ("angle",)


def test_json(softid: Cli, bench: Desk) -> None:
    """stdout is the record and the files; the record on disk is the same without them."""
    bench.answer = write_summary(diagnosis(Verdict.AMBIGUOUS))
    told = softid("diagnose", "step_1.csv", "--json", "--out", "here", "--no-plots")
    document = json.loads(told.out)
    assert [Path(f).name for f in document.pop("files")] == [
        "diagnosis.json",
        "params.json",
        "extended_params.json",
    ]
    assert document == json.loads(Path("here/diagnosis.json").read_text())
    assert document["verdict"] == "ambiguous"
    assert document["alternatives"][0]["effects"] == ["delay", "pneumatic_lag"]
    assert document["next_experiment"]


@pytest.mark.parametrize("verdict", Verdict)
def test_every_verdict_is_printed(softid: Cli, bench: Desk, verdict: Verdict) -> None:
    """A negative verdict is an answer, so the exit code is 0; ties and descriptions are marked."""
    bench.answer = write_summary(diagnosis(verdict))
    told = softid("diagnose", "step_1.csv", "--no-plots")
    assert told.code == 0, told.err
    flat = " ".join(told.out.split())
    assert bench.answer.summary in flat
    assert ("Cannot be split: delay, pneumatic_lag." in flat) is (verdict is Verdict.AMBIGUOUS)
    assert ("Description, not a cause:" in flat) is (verdict is Verdict.UNKNOWN)
    assert ("ΔBIC" in flat) is (verdict is not Verdict.ADEQUATE)


def test_a_law_in_no_catalogue_is_told_in_words(softid: Cli, bench: Desk) -> None:
    """`softid effects` does not list its key."""
    answer = diagnosis(Verdict.AMBIGUOUS)
    tie = replace(answer.alternatives[0], effects=("contact", "power_spring"), forms=())
    bench.answer = replace(answer, alternatives=(tie,))
    flat = " ".join(softid("diagnose", "step_1.csv", "--no-plots").out.split())
    assert "Cannot be split: contact; a spring that stiffens with another power of" in flat


def test_a_law_that_is_told_stands_before_descriptions(softid: Cli, bench: Desk) -> None:
    """The table says that what it holds is not what the paragraph tells."""
    found = diagnosis(Verdict.UNKNOWN)
    law = Issue(UNLISTED_LAW, "info", "what is missing behaves like play")
    bench.answer = write_summary(replace(found, issues=(*found.issues, law)))
    flat = " ".join(softid("diagnose", "a.csv").out.split())
    assert "What is missing behaves like play." in flat
    assert "A description, which explains less than what is told above:" in flat
    assert "Description, not a cause" not in flat


def test_results_are_replaced_when_told(softid: Cli, bench: Desk, tmp_path: Path) -> None:
    """Refused before the work without --force; with it old plots and models of softid go."""
    assert softid("diagnose", "a.csv", "--out", "here").code == 0
    bench.asked.clear()
    told = softid("diagnose", "a.csv", "--out", "here")
    assert told.code == 3
    assert "--force" in told.err
    assert bench.asked == {}
    bench.answer = write_summary(diagnosis(Verdict.ADEQUATE))
    assert softid("diagnose", "a.csv", "--out", "here", "--force", "--no-plots").code == 0
    assert sorted(p.name for p in Path("here").iterdir()) == ["diagnosis.json", "params.json"]
    assert softid("diagnose", "a.csv", "--no-plots").code == 0
    assert softid("diagnose", "a.csv", "--no-plots").code == 0
    assert Path("softid-out/step_1-diagnosis-2/diagnosis.json").exists()


MISTAKES: dict[str, tuple[tuple[str, ...], int, str]] = {
    "no log": ((), 2, "no log was given to diagnose"),
    "held out only": (("--hold-out", "a.csv"), 2, "before --hold-out"),
    "effect": (
        ("a.csv", "--effects", "dely"),
        2,
        "--effects: there is no such effect (got 'dely'); did you mean delay",
    ),
    "no effect": (("a.csv", "--effects", " ,"), 2, "no effect is named"),
    "model": (("a.csv", "--model", "musle"), 2, "there is no such model"),
    "twice": (
        ("a.csv", "--params", "p.json", "--model", "muscle"),
        2,
        "--params, --model: the base",
    ),
    "no params": (("a.csv", "--params", "p.json"), 3, "no such file"),
    "extended": (("a.csv", "--params", "extended.json"), 3, "has effects already"),
    "geometry": (("a.csv", "--geometry", "g.toml"), 3, "the geometry cannot be read"),
    "a file": (("a.csv", "--out", "extended.json"), 3, "a file, not a folder"),
}


@pytest.mark.parametrize("mistake", MISTAKES)
def test_what_is_wrong_is_said(softid: Cli, bench: Desk, tmp_path: Path, mistake: str) -> None:
    """One line, the code of its kind, and nothing written."""
    save_fit(extended_fit("muscle", "delay"), tmp_path / "extended.json")
    arguments, code, said = MISTAKES[mistake]
    told = softid("diagnose", *arguments)
    assert told.code == code
    assert said in told.err
    assert len(told.err.splitlines()) == 1
    assert [p.name for p in tmp_path.iterdir()] == ["extended.json"]


def test_a_failure_writes_nothing(softid: Cli, bench: Desk, tmp_path: Path) -> None:
    """4 when the library refuses."""
    bench.answer = IdentificationError("no start gave a finite response")
    assert softid("diagnose", "a.csv").code == 4
    assert list(tmp_path.iterdir()) == []


def test_a_base_short_of_its_optimum_is_told_of(softid: Cli, bench: Desk, tmp_path: Path) -> None:
    """The answer stands; only the values that are parameters of nothing have no file."""
    bench.answer = Diagnosis(
        **{**vars(write_summary(diagnosis(Verdict.NAMED))), "base": failed_fit()}
    )
    told = softid("diagnose", "a.csv", "--out", "out")
    assert told.code == 0
    assert "diagnosis.json  extended_params.json" in told.out
    assert not (tmp_path / "out" / "params.json").exists()


def test_the_tables_tell_what_a_cause_was_added_to(softid: Cli, bench: Desk) -> None:
    """2 → 1.5 → 1 → 0.5 with a description in the middle: each of the tables has a gap in it."""
    size = [estimate("delay_tau", 0.05, "s")]
    first = cause("coulomb_friction", FRICTION.parameters, before=2.0, after=1.5)
    creep = [estimate("creep_k", 0.1, "1")]
    between = cause("creep", creep, before=1.5, after=1.0, added_to=[first.key])
    second = cause("delay", size, before=1.0, after=0.5, added_to=[first.key, between.key])
    made = diagnosis(Verdict.PARTIAL)
    bench.answer = replace(made, causes=(first, second), descriptive=(between,))
    flat = " ".join(softid("diagnose", "a.csv").out.split())
    assert "2 → 1.5 deg vs" in flat
    assert "1 → 0.5 deg after creep" in flat
    assert "1.5 → 1 deg after coulomb_friction" in flat
    bench.answer = replace(made, causes=(first, between, second))
    assert "deg after" not in " ".join(softid("diagnose", "b.csv").out.split())


@pytest.mark.parametrize(
    ("given", "sooner"),
    [
        ((), ", or be done sooner with --model NAME or --effects NAME[,NAME...]"),
        (("--model", "muscle"), ", or be done sooner with --effects NAME[,NAME...]"),
        (("--effects", "delay,creep"), ", or be done sooner with --model NAME or fewer --effects"),
        (("--effects", "delay"), ", or be done sooner with --model NAME"),
        (("--model", "muscle", "--effects", "delay"), ""),
    ],
)
def test_an_interruption_says_how_to_go_on(
    softid: Cli, bench: Desk, tmp_path: Path, given: tuple[str, ...], sooner: str
) -> None:
    """130 is 128 + SIGINT; one sentence without what was given already, nothing written."""
    bench.answer = KeyboardInterrupt()
    told = softid("diagnose", "a.csv", "--quiet", *given)
    assert told.code == 130
    (line,) = told.err.splitlines()
    again = "softid: interrupted: no result was written; run the same command again"
    assert line.rstrip(".") == f"{again}{sooner}".rstrip(".")
    assert list(tmp_path.iterdir()) == []
