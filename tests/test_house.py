"""The house: imports point one way, no module hides a public name, engines name no mission."""

import ast
import re
from collections import defaultdict
from pathlib import Path

import pytest

import usvjax
import usvkernels
from usvjax.exports import HOME

ROOT = Path(__file__).parents[1]

STANDS_ON = {"aggregate": ("fleet",)}
"""Missions that are made of others."""

COMING = {"search_mission", "hunt", "sweep"}
"""Names that the public contract reserves."""

FLOORS = (
    ("errors", "suggest", "exports", "version", "ambient", "units", "angles"),
    ("checks",),
    ("devices", "pictures", "statistics"),
    ("report",),
    ("programs", "public"),
    ("batches",),
    ("keys", "memory", "tables"),
    ("sections",),
    ("maps",),
    ("mission", "swarms"),
    ("registry", "search", "tours", "plots"),
    ("presets", "paths", "planners"),
    ("study",),
    ("missions",),
    ("cli",),
)
"""From the ground up; a module imports its own floor's folder, or one from below."""


def modules():
    """Every module of ours by name, and its file."""
    for package, base in (
        ("usvjax", ROOT / "usvjax"),
        ("usvkernels", ROOT / "kernels" / "usvkernels"),
    ):
        for file in base.rglob("*.py"):
            parts = file.relative_to(base).with_suffix("").parts
            yield ".".join((package, *parts)).removesuffix(".__init__"), file


MODULES = dict(modules())


def imported(file):
    """Our modules that a file imports anywhere, for type checkers too."""
    found = set()
    for node in ast.walk(ast.parse(file.read_text())):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            for alias in node.names:
                full = f"{node.module}.{alias.name}"
                found.add(full if full in MODULES else node.module)
    return found & set(MODULES)


GRAPH = {
    name: imported(file) for name, file in MODULES.items() if name not in ("usvjax", "usvkernels")
}


def floor_of(name):
    part = name.split(".")[1]
    return next(number for number, names in enumerate(FLOORS) if part in names)


def test_there_is_no_circle():
    state, path = {}, []

    def visit(name):
        state[name] = "open"
        path.append(name)
        for other in GRAPH.get(name, ()):
            assert state.get(other) != "open", [*path[path.index(other) :], other]
            if other not in state:
                visit(other)
        state[name] = "done"
        path.pop()

    for name in GRAPH:
        if name not in state:
            visit(name)


def test_arrows_point_down():
    for name, others in GRAPH.items():
        if not name.startswith("usvjax."):
            continue
        for other in others - {"usvjax"}:
            if other.startswith("usvjax.") and other.split(".")[1] != name.split(".")[1]:
                assert floor_of(other) < floor_of(name), (name, other)


def test_folders_have_no_circle_either():
    arrows = defaultdict(set)
    for name, others in GRAPH.items():
        if name.startswith("usvjax."):
            arrows[name.split(".")[1]] |= {
                o.split(".")[1] for o in others if o.startswith("usvjax.")
            }
    for one, others in arrows.items():
        for other in others - {one}:
            assert one not in arrows[other], (one, other)


def test_missions_do_not_know_one_another():
    for name, others in GRAPH.items():
        if name.startswith("usvjax.missions."):
            own = name.split(".")[2]
            assert all(
                other.split(".")[2] in (own, *STANDS_ON.get(own, ()))
                for other in others
                if other.startswith("usvjax.missions.")
            ), name


def test_kernels_know_nothing_of_usvjax():
    for name, others in GRAPH.items():
        if name.startswith("usvkernels"):
            assert not any(other.startswith("usvjax") for other in others), name


def test_text_files_have_an_encoding():
    """Without one they have the locale's, and a study is not read as it was written."""
    bare = []
    for folder in ("usvjax", "kernels", "experiments", "benchmarks"):
        for file in (ROOT / folder).rglob("*.py"):
            for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
                if isinstance(node, ast.Call) and _opens_text(node):
                    bare.append((str(file.relative_to(ROOT)), node.lineno))
    assert not bare


def _opens_text(node):
    """Whether a call opens a text file and names no encoding."""
    name = node.func.id if isinstance(node.func, ast.Name) else getattr(node.func, "attr", "")
    if name in ("read_text", "write_text"):
        # Ours of the same name take the file as well.
        return len(node.args) <= (name == "write_text") and not _has_encoding(node)
    if isinstance(node.func, ast.Name) and name == "open":
        mode = node.args[1].value if len(node.args) > 1 else "r"
        return "b" not in mode and not _has_encoding(node)
    return False


def _has_encoding(node):
    return any(keyword.arg == "encoding" for keyword in node.keywords)


def test_only_the_console_prints_by_rich():
    """What prints elsewhere may read markup in a user's words, or cut them."""
    for name, file in MODULES.items():
        if name not in ("usvjax.cli.console", "usvjax.cli.maps", "usvjax.report.sheets"):
            assert "rich" not in re.findall(r"^from (\w+)", file.read_text(), re.MULTILINE), name


def test_no_module_hides_a_public_name():
    beside = {path.stem for path in (ROOT / "usvjax").iterdir()} - {"__init__"}
    functions = set(usvjax.__all__) | COMING
    assert not beside & functions


@pytest.mark.parametrize("folder", ["study", "plots"])
def test_engines_and_primitives_name_no_mission(folder):
    for file in (ROOT / "usvjax" / folder).rglob("*.py"):
        found = re.findall(
            r'"(?:dwa|route|cruise|fleet|aggregate)"|missions\.\w+', file.read_text()
        )
        assert not found, (file, found)


def test_every_public_name_is_there():
    for name in usvjax.__all__:
        assert getattr(usvjax, name) is not None
    assert Path(usvkernels.__file__).is_relative_to(ROOT)


def test_type_checkers_see_the_names_that_are_exported():
    tree = ast.parse((ROOT / "usvjax" / "__init__.py").read_text())
    (block,) = (
        node
        for node in tree.body
        if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING"
    )
    seen = defaultdict(set)
    for node in block.body:
        assert all(alias.asname == alias.name for alias in node.names), ast.unparse(node)
        seen[node.module] |= {alias.name for alias in node.names}
    assert seen == {module: set(names) for module, names in HOME.items()}


def test_exports_are_sorted_each_once_and_of_one_home():
    names = [name for names in HOME.values() for name in names]
    assert usvjax.__all__ == sorted({*names, "__version__", "register_mission", "use_all_cores"})
    assert len(names) == len(set(names))
