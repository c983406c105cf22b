"""The house keeps its shape: arrows go down, nobody reaches into another's private rooms."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from graphlib import TopologicalSorter
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
PACKAGE = ROOT / "fuzzyq_bullet"
LONGEST = 350
"""Lines of a module; whatever is longer holds more than one concept."""


def name_of(path: Path) -> str:
    parts = path.relative_to(ROOT).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


MODULES = {name_of(path): ast.parse(path.read_text()) for path in sorted(PACKAGE.rglob("*.py"))}


def imports(module: str, tree: ast.AST) -> Iterator[tuple[str, str]]:
    """Yield the package's modules that a module imports, with the name taken from each."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from ((alias.name, "") for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{module}: imports are absolute"
            for alias in node.names:
                inner = f"{node.module}.{alias.name}"
                yield (inner, "") if inner in MODULES else (str(node.module), alias.name)


def at_load(tree: ast.Module) -> ast.Module:
    """Return what runs when a module is loaded: no body of a function, no import for types."""

    class Loaded(ast.NodeTransformer):
        def visit_FunctionDef(self, node: ast.FunctionDef) -> None:
            return None

        def visit_If(self, node: ast.If) -> ast.AST | None:
            types = isinstance(node.test, ast.Name) and node.test.id == "TYPE_CHECKING"
            return None if types else self.generic_visit(node)

    copy = Loaded().visit(ast.parse(ast.unparse(tree)))
    assert isinstance(copy, ast.Module)
    return copy


def test_no_modules_import_each_other_in_a_circle() -> None:
    graph = {
        module: {other for other, _ in imports(module, at_load(tree)) if other in MODULES}
        - {module}
        for module, tree in MODULES.items()
    }
    TopologicalSorter(graph).prepare()  # raises CycleError, which names the circle


@pytest.mark.slow
@pytest.mark.parametrize("folder", ["fuzzyq_bullet", "tests", "examples"])
def test_no_private_name_of_another_module_is_used(folder: str) -> None:
    used = [
        f"{path.relative_to(ROOT)}: {module}.{name}"
        for path in sorted((ROOT / folder).rglob("*.py"))
        for module, name in imports(str(path), ast.parse(path.read_text()))
        if module.startswith("fuzzyq_bullet") and name.startswith("_") and name != "__version__"
    ]
    assert used == []


def test_no_module_is_longer_than_its_concept() -> None:
    lengths = {path: len(path.read_text().splitlines()) for path in PACKAGE.rglob("*.py")}
    assert [f"{path.name}: {n}" for path, n in lengths.items() if n > LONGEST] == []


def importing(*rooms: str) -> Iterator[tuple[str, str]]:
    for module, tree in MODULES.items():
        if module.split(".")[1:2] and module.split(".")[1] in rooms:
            yield from ((module, other) for other, _ in imports(module, tree))


def test_only_physics_knows_pybullet() -> None:
    users = {
        module.split(".")[1]
        for module, tree in MODULES.items()
        if any(other == "pybullet" for other, _ in imports(module, tree))
    }
    assert users == {"physics"}


@pytest.mark.parametrize(
    ("rooms", "unknown"),
    [
        (("fuzzy", "learning"), ("planning", "scenario", "physics", "drives", "robots")),
        (("planning",), ("physics", "drives", "video", "checks", "studies", "recording")),
        (("planning", "drives", "physics", "fuzzy"), ("ground_truth",)),
        (
            ("planning", "scenario", "physics", "drives", "video", "checks", "studies", "training"),
            ("cli", "gym", "pytest_plugin"),
        ),
    ],
)
def test_what_is_below_knows_nothing_of_what_is_above(
    rooms: tuple[str, ...], unknown: tuple[str, ...]
) -> None:
    seen = [
        f"{module} imports {other}"
        for module, other in importing(*rooms)
        if other.startswith("fuzzyq_bullet.") and other.split(".")[1] in unknown
    ]
    assert seen == []
