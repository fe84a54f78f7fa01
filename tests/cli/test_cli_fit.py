"""`softid fit`: options to the library's arguments, the result to tables and files."""

from __future__ import annotations

import json
import os
from collections.abc import Callable
from pathlib import Path

import pytest
from desk import Desk, Outcome
from handmade import failed_fit, fit_result

from softid.errors import Issue

Cli = Callable[..., Outcome]


def test_the_table_says_everything(softid: Cli, desk: Desk) -> None:
    """Values of the hand-made result: errors to two digits, per cent and display unit."""
    desk.answer = fit_result(issues=(Issue("x", "warning", "step_2 goes beyond", "fit it too"),))
    told = softid("fit", "step_1.csv", "--hold-out", "step_2.csv")
    assert (told.code, told.err) == (0, "")
    assert "0.300 ± 0.015" in told.out
    assert "[0.27, 0.33]" in told.out
    assert "weakly identified: a faster step would show it" in told.out
    assert "0.573" in told.out  # 0.01 rad in the file's degrees
    assert "91.2  in sample" in told.out
    assert "88.5  held out" in told.out
    assert "Why this model: the steps show the inertia" in told.out
    assert "warning: step_2 goes beyond\n  → fit it too" in told.out
    assert "Written to softid-out/step_1/:\n  params.json  fit.png" in told.out
    assert max(map(len, told.out.splitlines())) <= 80


def test_the_options_reach_the_library(softid: Cli, desk: Desk) -> None:
    """Each option of the command line has its place in `softid.fit`."""
    told = softid(
        *("fit", "a.csv", "b.csv", "--hold-out", "c.csv", "d.csv", "--model", "muscle"),
        *("--fix", "M=0.5", "--bound", "b1=1:4", "--bound", "c1=2:", "--tie", "a2=0.1*c2"),
        *("--damping", "exponential", "--fixed-length", "150", "--diameter", "20"),
        *("--channel", "pressure=p1:bar", "--input", "pressure", "--output", "angle"),
        *("--seed", "3", "--no-plots", "--intersample", "straight"),
    )
    assert told.code == 0, told.err
    asked = desk.asked
    assert asked["logs"] == ["a", "b"]
    assert [log.name for log in asked["hold_out"]] == ["c", "d"]
    assert asked["seed"] == 3
    assert {log.intersample for log in asked["hold_out"]} == {"straight"}
    assert asked["model"].fixed_length_mm == 150.0
    p = asked["parameters"]
    assert (p["M"].value, p["M"].fixed) == (0.5, True)
    assert (p["b1"].lower, p["b1"].upper) == (1.0, 4.0)
    assert p["c1"].lower == 2.0
    assert p["c1"].lower <= p["c1"].value
    assert p["a2"].tie == "0.1*c2"
    assert not (Path("softid-out") / "a" / "fit.png").exists()


def test_a_greedy_option_takes_its_first_value_behind_a_sign_too(softid: Cli, desk: Desk) -> None:
    """``--hold-out=c.csv d.csv`` holds out both: a log that is to judge the fit is never fitted."""
    softid("fit", "a.csv", "--hold-out=c.csv", "d.csv", "--seed=3", "b.csv")
    assert desk.asked["logs"] == ["a", "b"]
    assert [log.name for log in desk.asked["hold_out"]] == ["c", "d"]


def test_without_options_the_library_chooses(softid: Cli, desk: Desk) -> None:
    """`softid fit LOG` leaves model and parameters open and asks for the reader's own roles."""
    softid("fit", "a.csv")
    assert desk.asked["model"] is None
    assert desk.asked["parameters"] is None
    assert desk.asked["hold_out"] == []


def test_json_is_the_file_and_where_it_is(softid: Cli, desk: Desk) -> None:
    """stdout holds one JSON document, equal to params.json but for the list of files."""
    told = softid("fit", "step_1.csv", "--json")
    document = json.loads(told.out)
    files = document.pop("files")
    assert files == ["softid-out/step_1/params.json", "softid-out/step_1/fit.png"]
    assert document == json.loads(Path(files[0]).read_text())


def test_earlier_results_stay(softid: Cli, desk: Desk) -> None:
    """Default folders count on; a folder that the user named is only replaced by force."""
    for expected in ("step_1", "step_1-2", "step_1-3"):
        assert f"Written to softid-out/{expected}/" in softid("fit", "step_1.csv").out
    assert softid("fit", "step_1.csv", "--out", "mine").code == 0
    desk.asked = {}
    refused = softid("fit", "step_1.csv", "--out", "mine")
    assert refused.code == 3
    assert "holds results already; say --force" in refused.err
    assert desk.asked == {}  # refused before the work
    assert softid("fit", "step_1.csv", "--out", "mine", "--force").code == 0


def test_a_failed_fit_writes_nothing(softid: Cli, desk: Desk) -> None:
    """Exit code 4, one line, the status, and no file that could be mistaken for a result."""
    desk.answer = failed_fit()
    told = softid("fit", "step_1.csv")
    assert told.code == 4
    assert told.out == ""
    assert "stopped short of the optimum, so no results were written" in told.err
    assert told.err.count("\n") == 1
    assert not Path("softid-out").exists()


def test_a_full_disk_is_no_result(softid: Cli, desk: Desk, monkeypatch: pytest.MonkeyPatch) -> None:
    """ENOSPC, error 28: nothing on stdout that looks like success, and no half-written folder."""

    def full(_: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    told = softid("fit", "step_1.csv")
    assert told.code == 3
    assert told.out == ""
    assert "no space left on device" in told.err
    assert told.err.count("\n") == 1
    assert not Path("softid-out").exists()


def test_a_file_in_the_way_is_told_before_the_work(softid: Cli, desk: Desk) -> None:
    """A fit may take minutes; that --out names a file is known at once."""
    Path("taken").write_text("mine")
    told = softid("fit", "step_1.csv", "--out", "taken")
    assert (told.code, told.out) == (3, "")
    assert "taken: this is a file, not a folder; name another folder with --out" in told.err
    assert "logs" not in desk.asked


@pytest.mark.parametrize("place", ["taken/results", "taken/deeper/results"])
def test_a_place_where_nothing_can_be_written_is_told_before_the_work(
    place: str, softid: Cli, desk: Desk
) -> None:
    """A folder below a file, which no user may make; what is tried leaves nothing behind."""
    Path("taken").write_text("mine")
    before = sorted(Path().iterdir())
    told = softid("fit", "step_1.csv", "--out", place)
    assert (told.code, told.out) == (3, "")
    assert f"{place}: nothing can be written here" in told.err
    assert "logs" not in desk.asked
    assert sorted(Path().iterdir()) == before


def test_no_plot_of_an_earlier_model_stays(
    softid: Cli, desk: Desk, monkeypatch: pytest.MonkeyPatch
) -> None:
    """--force: the old result's own plots go; the user's files and altered plots stay."""
    folder = Path("mine")
    earlier = {"damping.png": b"N", "loops.png": b"L", "touched.png": b"T"}
    monkeypatch.setattr("softid.plots.png_files", lambda _: dict(earlier))
    assert softid("fit", "step_1.csv", "--out", folder).code == 0
    (folder / "response_mine.png").write_bytes(b"mine")
    (folder / "touched.png").write_bytes(b"T with an arrow")
    monkeypatch.setattr("softid.plots.png_files", lambda _: {"loops.png": b"l"})
    assert softid("fit", "step_1.csv", "--out", folder, "--force").code == 0
    names = ["loops.png", "params.json", "response_mine.png", "touched.png"]
    assert sorted(p.name for p in folder.iterdir()) == names
    assert (folder / "loops.png").read_bytes() == b"l"
    assert softid("fit", "step_1.csv", "--out", folder, "--force", "--no-plots").code == 0
    assert sorted(p.name for p in folder.iterdir()) == names[1:]


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ([], "no log was given to fit; name at least one log"),
        (["--hold-out", "a.csv"], "before --hold-out"),
        (["a.csv", "--hold-out"], "--hold-out needs at least one value"),
        (["a.csv", "--hold-out", "--json"], "--hold-out needs at least one value"),
        (["a.csv", "--model", "spring"], "no such model (got 'spring')"),
        (["a.csv", "--model", "oscillator", "--damping", "constant"], "has no such option"),
        (["a.csv", "--option", "ordre=first"], "no model has all of these options"),
        (["a.csv", "--damping", "constant", "--option", "drift=linear"], "no model has all of"),
        (["a.csv", "--option", "order=first"], "several models have these options"),
        (["a.csv", "--fixed-length", "150"], "needs both lengths; give --diameter too"),
        (["a.csv", "--diameter", "20"], "needs both lengths; give --fixed-length too"),
        (["a.csv", "--fixed-length", "-3", "--diameter", "20"], "is not a length (got '-3')"),
        (["a.csv", "--fixed-length", "150", "--diameter", "nan"], "is not a length (got 'nan')"),
        (["a.csv", "--fixed-length", "long"], "is not a length (got 'long')"),
        (["a.csv", "--model", "muscle", "--bound", "M=-2:1"], "M must be positive"),
        (["a.csv", "--model", "muscle", "--bound", "M=:0"], "M must be positive"),
        (["a.csv", "--model", "muscle", "--profile", "Z"], "no such parameter (got 'Z')"),
        (["a.csv", "--model", "muscle", "--option", "inverted=maybe"], "follows from the logs"),
        (["a.csv", "--model", "muscle", "--option", "x_unit=parsec"], "follows from the logs"),
        ([""], "the name of a file is empty"),
        (["a.csv", "--hold-out", ""], "the name of a file is empty"),
        (["a.csv", "--hold-out=", "b.csv"], "the name of a file is empty"),
        (["a.csv", "--out", ""], "the name of a file is empty"),
        (["a.csv", "--fix", "M=1"], "error: --fix: parameters have no meaning before the model"),
        (["a.csv", "--model", "muscle", "--fix", "M"], "--fix NAME=VALUE"),
        (["a.csv", "--model", "muscle", "--fix", "M=x"], "not a number (got 'x')"),
        (["a.csv", "--model", "muscle", "--fix", "M=nan"], "not a number"),
        (["a.csv", "--model", "muscle", "--fix", "Z=1"], "no such parameter (got 'Z')"),
        (["a.csv", "--model", "muscle", "--fix", "M=1", "--fix", "M=2"], "M is given twice"),
        (["a.csv", "--model", "muscle", "--bound", "M=1"], "both ends with a colon"),
        (["a.csv", "--model", "muscle", "--bound", "M=2:1"], "lower bound is above"),
        (["a.csv", "--model", "muscle", "--tie", "a2=3*"], "not an expression"),
        (["a.csv", "--model", "muscle", "--tie", "a2=len(open('x').read())"], "cannot hold len(op"),
        (["a.csv", "--model", "muscle", "--tie", "a2=-1"], "write --fix a2=VALUE"),
        (["a.csv", "--input", ""], "--input: the name of a channel is empty"),
        (["a.csv", "--output", ""], "--output: the name of a channel is empty"),
        (["a.csv", "--model", "muscle", "--tie", "a2=d2"], "there is no parameter d2"),
        (["a.csv", "--model", "muscle", "--tie", "a2=2*a2"], "depends on itself"),
        (["a.csv", "--model", "muscle", "--tie", "a2=c2/0"], "ZeroDivisionError"),
        (["a.csv", "--model", "muscle", "--tie", "a2=c2", "--fix", "a2=1"], "fixed and tied"),
        (["a.csv", "a.csv"], "the log is given twice"),
        (["a.csv", "--hold-out", "./a.csv"], "the log is given twice"),
        (["a.csv", "--channel", "pressure"], "write --channel NAME=COL:UNIT"),
        (["a.csv", "--seed", "x"], "'x' is not a valid integer"),
        (["a.csv", "--outt", "x"], "no such option '--outt' (did you mean"),
    ],
)
def test_wrong_usage(softid: Cli, desk: Desk, arguments: list[str], said: str) -> None:
    """Exit code 2, one line that says what and how else, nothing on stdout, no work begun."""
    told = softid("fit", *arguments)
    assert told.code == 2
    assert said.lower() in told.err.lower()
    assert told.err.startswith("softid: error: ")
    assert told.err.count("\n") == 1
    assert told.out == ""
    assert "logs" not in desk.asked


def test_logs_of_one_name_get_their_folders(softid: Cli, desk: Desk) -> None:
    """day1/run.csv and day2/run.csv are two logs, not one given twice."""
    for day in ("day1", "day2"):
        Path(day).mkdir()
    assert softid("fit", "day1/run.csv", "day2/run.csv").code == 0
    assert desk.asked["logs"] == ["day1/run", "day2/run"]
    assert Path("softid-out/day1_run/params.json").is_file()
