"""The architecture: imports point downward, run in no circle, and side effects have their places.

A new module must be given its layer here and in softid/README.md first.
"""

from __future__ import annotations

import ast
import re
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
SOURCES = {"softid": ROOT / "softid", "softid_cli": ROOT / "cli" / "softid_cli"}

LAYERS: tuple[tuple[str, ...], ...] = (
    ("errors", "interrupts", "sentences"),
    ("units", "kernels", "parallel", "even_times", "given_values", "long_series", "toml_files"),
    ("channels", "chi_square", "fingerprint", "intersample", "tie_expressions"),
    ("log_rules", "segment"),
    ("log", "parameters", "results"),
    ("arguments", "diagnosis_results", "interval_words", "log_kinds"),
    ("readers", "excitation", "models", "residuals", "scores"),
    ("effects", "quality"),
    ("records", "plots"),
    ("simulation", "uncertainty"),
    ("fitters",),
    ("identification", "synthesis"),
    ("prediction", "validation"),
    ("diagnosis",),
)
"""Modules and packages of softid, lowest first; above them come the public face and softid_cli."""

DIAGNOSIS: tuple[tuple[str, ...], ...] = (
    ("logs",),
    ("refit",),
    ("residual",),
    ("base",),
    ("changes",),
    ("search",),
    ("verdict",),
    ("searches",),
    ("report",),
    ("answer",),
    ("best_answer",),
    ("completion",),
    ("resumption",),
    ("workflow",),
    ("",),
)
"""Packages and modules of softid.diagnosis, lowest first, and the package itself."""

FAMILIES = ("models", "effects")
SHARED = ("base", "scale", "division")
"""Modules of a family that belong to all of its variants."""

WORKFLOWS = ("simulation", "uncertainty", "identification", "prediction", "validation", "diagnosis")

LONGEST_FILE = 400
LONGEST_FUNCTION = 60
ONLY_IN = {
    "matplotlib": ("softid/plots/",),
    "numba": ("softid/kernels/", "softid/effects/"),
}
WRITERS = {
    "write_text",
    "write_bytes",
    "savetxt",
    "savez",
    "savez_compressed",
    "to_csv",
    "to_parquet",
    "tofile",
    "mkdir",
    "unlink",
    "savefig",
}
MAY_WRITE = ("softid/records/", "cli/")


@dataclass(frozen=True)
class Module:
    """One source file."""

    name: str
    path: Path
    tree: ast.Module

    @property
    def place(self) -> str:
        return self.path.relative_to(ROOT).as_posix()


@dataclass(frozen=True)
class Import:
    """One import statement, resolved to the module it names."""

    target: str
    line: int
    for_types: bool


@cache
def modules() -> dict[str, Module]:
    found = {}
    for package, folder in SOURCES.items():
        for path in sorted(folder.rglob("*.py")):
            parts = path.relative_to(folder).with_suffix("").parts
            name = ".".join((package, *(p for p in parts if p != "__init__")))
            found[name] = Module(name, path, ast.parse(path.read_text(encoding="utf-8")))
    return found


def imports(module: Module, known: set[str]) -> Iterator[Import]:
    """All imports, those inside functions too; ``from a import b`` means a.b where that exists."""
    for_types = {
        id(node)
        for guard in ast.walk(module.tree)
        if isinstance(guard, ast.If) and "TYPE_CHECKING" in ast.unparse(guard.test)
        for child in guard.body
        for node in ast.walk(child)
    }
    for node in ast.walk(module.tree):
        typed = id(node) in for_types
        if isinstance(node, ast.Import):
            for alias in node.names:
                yield Import(alias.name, node.lineno, typed)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{module.place}:{node.lineno}: write the import in full"
            for alias in node.names:
                inner = f"{node.module}.{alias.name}"
                yield Import(inner if inner in known else str(node.module), node.lineno, typed)


def layer_of(name: str) -> int:
    if name.split(".")[0] == "softid_cli":
        return len(LAYERS) + 1
    if name == "softid":
        return len(LAYERS)
    part = name.split(".")[1]
    for depth, layer in enumerate(LAYERS):
        if part in layer:
            return depth
    raise AssertionError(
        f"{name} has no layer: add {part!r} to LAYERS in tests/test_layers.py and softid/README.md"
    )


def ours(target: str) -> bool:
    return target.split(".")[0] in SOURCES


def test_every_module_has_a_layer() -> None:
    """Stands on LAYERS; a module that is not there fails with the instruction."""
    for name in modules():
        layer_of(name)


def test_the_readme_shows_these_layers() -> None:
    """Row by row, lowest last; that of the diagnosis names its steps, too."""
    table = (ROOT / "softid" / "README.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| (\d+) \| (.*) \|$", table, re.MULTILINE)
    shown = {int(layer): tuple(re.findall(r"`([\w.]+)`", row)) for layer, row in rows}
    expected = dict(enumerate(LAYERS, start=1)) | {len(LAYERS) + 1: ("__init__.py", "softid_cli")}
    expected[1 + layer_of("softid.diagnosis")] += tuple(s for step in DIAGNOSIS for s in step if s)
    assert shown == expected


def part_of(name: str) -> str:
    """The module or package of softid that a module is or belongs to; one for all of softid_cli."""
    first, *rest = name.split(".")
    return rest[0] if first == "softid" and rest else first


def test_imports_point_downward() -> None:
    """No module needs one of a higher layer, or another of its own, not even for its types."""
    known = set(modules())
    upward = [
        f"{module.place}:{found.line}: {module.name} imports {found.target}, which is not lower"
        for module in modules().values()
        for found in imports(module, known)
        if ours(found.target)
        and part_of(found.target) != part_of(module.name)
        and layer_of(found.target) >= layer_of(module.name)
    ]
    assert not upward, "\n".join(upward)


def is_step(name: str) -> bool:
    """Whether a module is softid.diagnosis or in it, rather than beside it with a longer name."""
    return name.split(".")[:2] == ["softid", "diagnosis"]


def step_of(name: str) -> int:
    """Depth of a module within softid.diagnosis."""
    part = name.removeprefix("softid.diagnosis").removeprefix(".").split(".")[0]
    for depth, step in enumerate(DIAGNOSIS):
        if part in step:
            return depth
    raise AssertionError(f"{name} has no place: add {part!r} to DIAGNOSIS in tests/test_layers.py")


def test_a_diagnosis_is_made_in_steps_that_import_downward() -> None:
    """Logs, one refit, what it leaves, the base, the search, the verdict, the words: so ordered."""
    known = set(modules())
    inside = [m for m in modules().values() if is_step(m.name)]
    assert len(inside) > len(DIAGNOSIS)
    upward = [
        f"{module.place}:{found.line}: {module.name} imports {found.target} of a later step"
        for module in inside
        for found in imports(module, known)
        if is_step(found.target) and step_of(found.target) > step_of(module.name)
    ]
    assert not upward, "\n".join(upward)


def test_imports_run_in_no_circle() -> None:
    """Depth-first search over files; imports for types alone do not run."""
    known = set(modules())
    graph = {
        module.name: sorted(
            {f.target for f in imports(module, known) if ours(f.target) and not f.for_types}
        )
        for module in modules().values()
    }
    done: set[str] = set()

    def visit(name: str, trail: tuple[str, ...]) -> None:
        if name in trail:
            raise AssertionError("circle: " + " → ".join((*trail[trail.index(name) :], name)))
        if name in done:
            return
        for target in graph.get(name, []):
            visit(target, (*trail, name))
        done.add(name)

    for name in graph:
        visit(name, ())


def test_nobody_inside_imports_the_public_face() -> None:
    """`import softid` inside softid makes every module depend on all."""
    known = set(modules())
    wrong = [
        f"{module.place}:{found.line}: import from the module that defines it"
        for module in modules().values()
        if module.name.split(".")[0] == "softid" and module.name != "softid"
        for found in imports(module, known)
        if found.target == "softid"
    ]
    assert not wrong, "\n".join(wrong)


def test_workflows_know_no_variant() -> None:
    """Workflows reach models and effects through the family's base and table."""
    known = set(modules())
    wrong = [
        f"{module.place}:{found.line}: {found.target} is a variant; use the table of its family"
        for module in modules().values()
        if module.name.split(".")[1:2] and module.name.split(".")[1] in WORKFLOWS
        for found in imports(module, known)
        for family in FAMILIES
        if found.target.startswith(f"softid.{family}.")
        and found.target.removeprefix(f"softid.{family}.") not in SHARED
        and not found.for_types
    ]
    assert not wrong, "\n".join(wrong)


@pytest.mark.parametrize("library", sorted(ONLY_IN))
def test_heavy_libraries_have_their_places(library: str) -> None:
    """matplotlib draws in plots, numba compiles in kernels; anywhere else they cost everybody."""
    known = set(modules())
    wrong = [
        f"{module.place}:{found.line}: {library} belongs into {' or '.join(ONLY_IN[library])}"
        for module in modules().values()
        if not module.place.startswith(ONLY_IN[library])
        for found in imports(module, known)
        if found.target.split(".")[0] == library
    ]
    assert not wrong, "\n".join(wrong)


def writes(call: ast.Call) -> bool:
    name = call.func.attr if isinstance(call.func, ast.Attribute) else None
    if isinstance(call.func, ast.Name):
        name = call.func.id
    if name == "open":
        modes = [a.value for a in (*call.args, *(k.value for k in call.keywords)) if _is_mode(a)]
        return any(set("wax+") & set(mode) for mode in modes)
    return name in WRITERS or name == "print"


def _is_mode(node: ast.expr) -> bool:
    return (
        isinstance(node, ast.Constant)
        and isinstance(node.value, str)
        and 0 < len(node.value) <= 3
        and set(node.value) <= set("rwaxbt+")
    )


def test_only_records_and_the_command_line_write() -> None:
    """The library returns values; what touches files or the terminal is in two known places."""
    wrong = [
        f"{module.place}:{node.lineno}: {ast.unparse(node.func)} belongs into softid/records/"
        for module in modules().values()
        if not module.place.startswith(MAY_WRITE)
        for node in ast.walk(module.tree)
        if isinstance(node, ast.Call) and writes(node)
    ]
    assert not wrong, "\n".join(wrong)


def test_package_files_hold_imports_and_tables_only() -> None:
    """Code in `__init__.py` runs for everybody who imports anything below it."""
    plain = (ast.Import, ast.ImportFrom, ast.Assign, ast.AnnAssign, ast.Expr, ast.If)
    lazy = ("__getattr__", "__dir__")
    wrong = [
        f"{module.place}:{node.lineno}: move {type(node).__name__} into a module"
        for module in modules().values()
        if module.path.name == "__init__.py"
        for node in module.tree.body
        if not isinstance(node, plain)
        and not (isinstance(node, ast.FunctionDef) and node.name in lazy)
    ]
    assert not wrong, "\n".join(wrong)


def python_files() -> list[Path]:
    return sorted(
        path for folder in (*SOURCES.values(), ROOT / "tests") for path in folder.rglob("*.py")
    )


def test_no_file_is_long() -> None:
    """One concept a file; the limit is the style's."""
    counts = {
        p.relative_to(ROOT).as_posix(): len(p.read_text().splitlines()) for p in python_files()
    }
    assert not {name: n for name, n in counts.items() if n > LONGEST_FILE}


def test_no_function_is_long() -> None:
    """Lines of code without signature and docstring; the limit is the style's."""
    wrong = []
    for path in python_files():
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if not isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
                continue
            body = node.body[1:] if ast.get_docstring(node) else node.body
            if body and (body[-1].end_lineno or 0) - body[0].lineno + 1 > LONGEST_FUNCTION:
                wrong.append(f"{path.relative_to(ROOT).as_posix()}:{node.lineno}: {node.name}")
    assert not wrong, "\n".join(wrong)


def test_names_of_test_files_are_unique() -> None:
    """pytest imports test files by their bare name, so two of one name would hide each other."""
    names = Counter(path.name for path in (ROOT / "tests").rglob("test_*.py"))
    assert not [name for name, n in names.items() if n > 1]


@pytest.mark.parametrize(
    ("code", "found"),
    [
        ("open(p)", False),
        ("open(p, 'rb')", False),
        ("open(p, 'w')", True),
        ("p.open(mode='ab')", True),
        ("p.write_text(t)", True),
        ("print(1)", True),
        ("np.savetxt(p, a)", True),
        ("p.read_text()", False),
    ],
)
def test_the_search_for_writes_finds_them(code: str, found: bool) -> None:
    """The rule above is only worth what its detector sees."""
    call = ast.parse(code, mode="eval").body
    assert isinstance(call, ast.Call)
    assert writes(call) is found


def test_a_module_without_a_layer_is_told_what_to_do() -> None:
    """A newcomer's first failing test should say how to pass it."""
    with pytest.raises(AssertionError, match="add 'novelty' to LAYERS"):
        layer_of("softid.novelty.law")
