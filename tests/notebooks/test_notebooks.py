"""The notebooks: stored clean, on public names alone, and every cell runs."""

from __future__ import annotations

import ast
import json
import os
import re
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import pytest

ROOT = Path(__file__).resolve().parents[2]
FOLDER = ROOT / "notebooks"
NOTEBOOKS = sorted(FOLDER.glob("*.ipynb"))
PUBLIC = re.compile(r"softid|softid\.(effects|fitters|models|plots)(\.\w+)?")
LIMIT_S = 600
"""Two minutes on an idle machine, with room for a busy one."""

RUNNER = """
import ast, json, sys
from pathlib import Path
import matplotlib
matplotlib.use("Agg")
pictures = Path(sys.argv[2]) if len(sys.argv) > 2 else None
space, shown = {"__name__": "__main__"}, 0
for cell in json.loads(Path(sys.argv[1]).read_text(encoding="utf-8"))["cells"]:
    if cell["cell_type"] != "code":
        continue
    tree = ast.parse("".join(cell["source"]))
    last = tree.body.pop() if tree.body and isinstance(tree.body[-1], ast.Expr) else None
    exec(compile(tree, cell["id"], "exec"), space)
    if last is None:
        continue
    value = eval(compile(ast.Expression(last.value), cell["id"], "eval"), space)
    if hasattr(value, "_repr_png_"):
        shown += 1
        png = value._repr_png_()
        assert png.startswith(b"\\x89PNG"), cell["id"]
        if pictures:
            (pictures / (cell["id"] + ".png")).write_bytes(png)
print("pictures:", shown)
"""


def _read(path: Path) -> dict:
    return json.loads(path.read_text(encoding="utf-8"))


def _code(path: Path) -> list[str]:
    return ["".join(c["source"]) for c in _read(path)["cells"] if c["cell_type"] == "code"]


def test_the_contents_page_names_every_notebook() -> None:
    """Stands on the folder: each notebook has a link, and each link a file."""
    page = (FOLDER / "README.md").read_text(encoding="utf-8")
    linked = set(re.findall(r"\]\(([^)]+\.ipynb)\)", page))
    assert NOTEBOOKS
    assert linked == {path.name for path in NOTEBOOKS}


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda p: p.stem)
def test_it_is_stored_clean(path: Path) -> None:
    """Stands on the notebook format, version 4.5: cells with ids, no outputs, no machine paths."""
    text = path.read_text(encoding="utf-8")
    notebook = _read(path)
    assert notebook["nbformat"] == 4
    assert notebook["nbformat_minor"] >= 5
    ids = [cell["id"] for cell in notebook["cells"]]
    assert len(set(ids)) == len(ids)
    for cell in notebook["cells"]:
        assert re.fullmatch(r"[A-Za-z0-9_-]{1,64}", cell["id"])
        assert cell["cell_type"] in ("code", "markdown")
        if cell["cell_type"] == "code":
            assert cell["outputs"] == []
            assert cell["execution_count"] is None
    assert not re.search(r"(/home/|/tmp/|/root/|/Users/|[A-Z]:\\\\)", text)
    assert str(ROOT) not in text


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda p: p.stem)
def test_it_imports_public_names_alone(path: Path) -> None:
    """Stands on softid and its four public families; names without an underscore."""
    for source in _code(path):
        for node in ast.walk(ast.parse(source)):
            names = [a.name for a in node.names] if isinstance(node, ast.Import) else []
            if isinstance(node, ast.ImportFrom):
                names = [str(node.module)]
                assert not any(alias.name.startswith("_") for alias in node.names)
            for name in names:
                assert not name.startswith("softid") or PUBLIC.fullmatch(name), name


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda p: p.stem)
def test_what_it_takes_from_modules_is_there(path: Path) -> None:
    """Stands on softid: every imported name, and every attribute that a cell takes of a module."""
    trees = [ast.parse(source) for source in _code(path)]
    imports = [
        node
        for tree in trees
        for node in ast.walk(tree)
        if isinstance(node, ast.Import | ast.ImportFrom)
    ]
    space: dict[str, object] = {}
    exec(compile(ast.Module(list(imports), []), str(path), "exec"), space)
    taken = {
        (node.value.id, node.attr)
        for tree in trees
        for node in ast.walk(tree)
        if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name)
    }
    of_modules = [(n, attribute) for n, attribute in taken if isinstance(space.get(n), ModuleType)]
    assert of_modules
    assert [(n, a) for n, a in of_modules if not hasattr(space[n], a)] == []


@pytest.mark.slow
@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda p: p.stem)
def test_it_runs(path: Path) -> None:
    """Stands on the notebook itself: its cells in order in a fresh process, pictures rendered."""
    environment = os.environ | {"PYTHONPATH": os.pathsep.join((str(ROOT), str(ROOT / "cli")))}
    done = subprocess.run(
        [sys.executable, "-c", RUNNER, str(path)],
        cwd=FOLDER,
        env=environment,
        capture_output=True,
        text=True,
        timeout=LIMIT_S,
        check=False,
    )
    assert done.returncode == 0, done.stderr[-3000:]
    expected = sum(source.splitlines()[-1].startswith(("Picture(", ")")) for source in _code(path))
    assert expected > 0
    assert f"pictures: {expected}" in done.stdout
