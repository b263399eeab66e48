"""The house rules, kept by reading the sources: who imports whom, what kernels may do, what a file may be."""

import ast
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
SOURCES = sorted((ROOT / "parsim").rglob("*.py"))
CHECKED = [ROOT / place for place in tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["mypy"]["files"]]
HINTED = sorted(path for place in CHECKED for path in ([place] if place.is_file() else place.rglob("*.py")))
TESTS = sorted((ROOT / "tests").rglob("*.py"))
SCRIPTS = sorted([*(ROOT / "jobs").glob("*.sh"), *(ROOT / "tests").glob("*.sh"), ROOT / ".ci" / "run"])
TOP = {"pyproject.toml", "parsim", "tests", "cases", "jobs", "README.md", "LICENSE", "CHANGELOG.md", "CITATION.cff"}

# what the kernels of particle loops may not call: sums in an order of their own, and functions whose last bit
# depends on the vector length they are compiled for
REDUCTIONS = {
    "sum",
    "dot",
    "vdot",
    "matmul",
    "einsum",
    "mean",
    "average",
    "cumsum",
    "prod",
    "trapezoid",
    "inner",
    "norm",
}
ROUNDED = {"pow", "power", "exp", "expm1", "log", "log1p", "log2", "log10", "sin", "cos", "tan", "tanh", "sinh", "cosh"}
COMPILED = {"kernel", "inlined", "each", "rows", "implements", "compiled"}
STRICT = ("fluid/", "particles/", "coupling/")
SEEN_ONLY = "fluid/wcmps/energy.py"  # goes into no step
ABOVE_KERNELS = {"case", "commands", "launch", "observe", "output", "report", "run"}
BESIDE_REPORT = {"output", "errors", "case", "report", "launch", "river"}
BESIDE_RIVER = {"output", "case", "geometry", "machine", "river"}
PHYSICS = ("boundary/", "coupling/", "fluid/", "particles/", "solid/")


def name(path):
    return str(path.relative_to(ROOT))


def tree(path):
    return ast.parse(path.read_text(), str(path))


def imports(parsed):
    """Full dotted names of everything a module imports, at any depth, but for what it imports for its hints alone."""
    found, unmet = set(), set()
    for node in ast.walk(parsed):
        if isinstance(node, ast.If) and _last(node.test) == "TYPE_CHECKING":
            unmet |= set(node.body)
        elif node in unmet:
            continue
        elif isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, "imports are absolute here"
            found |= {f"{node.module}.{alias.name}" for alias in node.names}
    return found


def own(parsed):
    """The parts of parsim a module imports: `domain`, `fluid`, ..."""
    return {word.split(".")[1] for word in imports(parsed) if word.startswith("parsim.")}


def kernels(parsed):
    """Functions compiled by @kernel, @each or @rows, or with those that call them by @implements(...)."""
    for node in ast.walk(parsed):
        if isinstance(node, ast.FunctionDef) and {_last(d) for d in node.decorator_list} & COMPILED:
            yield node


def _last(node):
    node = node.func if isinstance(node, ast.Call) else node
    return node.attr if isinstance(node, ast.Attribute) else node.id if isinstance(node, ast.Name) else ""


def arithmetic_faults(function):
    """What in a kernel can give different last bits for another length, order or vector width."""
    for node in ast.walk(function):
        if isinstance(node, ast.Call) and _last(node.func) in REDUCTIONS | ROUNDED:
            yield f"line {node.lineno}: {_last(node.func)}()"
        elif isinstance(node, ast.BinOp | ast.AugAssign) and isinstance(node.op, ast.Pow | ast.MatMult):
            yield f"line {node.lineno}: {'**' if isinstance(node.op, ast.Pow) else '@'}"


def reductions(function):
    """Scalars summed up over the iterations of a prange: their order depends on the number of threads."""
    for loop in ast.walk(function):
        if isinstance(loop, ast.For) and isinstance(loop.iter, ast.Call) and _last(loop.iter.func) == "prange":
            inside = {_last(t) for n in ast.walk(loop) if isinstance(n, ast.Assign) for t in _targets(n)}
            inside |= {_last(loop.target)} | {_last(n.target) for n in ast.walk(loop) if isinstance(n, ast.For)}
            for node in ast.walk(loop):
                summed = isinstance(node, ast.AugAssign) and isinstance(node.target, ast.Name)
                if summed and node.target.id not in inside:
                    yield f"line {node.lineno}: {node.target.id} is summed over a prange"


def lost_writes(function):
    """What numba drops: inside a prange, writes through a tuple, or to names that a parameter was unpacked into."""
    given, unpacked = {arg.arg for arg in function.args.args}, set()
    for node in ast.walk(function):
        if (
            isinstance(node, ast.Assign)
            and isinstance(node.targets[0], ast.Tuple)
            and isinstance(node.value, ast.Name | ast.Attribute)
        ):
            unpacked |= {_last(target) for target in node.targets[0].elts}
    for loop in ast.walk(function):
        if isinstance(loop, ast.For) and isinstance(loop.iter, ast.Call) and _last(loop.iter.func) == "prange":
            for node in ast.walk(loop):
                if isinstance(node, ast.Subscript) and isinstance(node.ctx, ast.Store):
                    root = node.value
                    if (isinstance(root, ast.Attribute) and _last(root.value) in given) or _last(root) in unpacked:
                        yield f"line {node.lineno}: {_last(root)}[...] is written, and lost"


def crowded(function, most=8):
    """What says that a kernel takes too many arguments: arrays that belong together go into a tuple by role."""
    if (count := len(function.args.args)) > most:
        yield f"takes {count} arguments, more than {most}"


def _targets(assign):
    for target in assign.targets:
        yield from target.elts if isinstance(target, ast.Tuple) else [target]


def public(parsed):
    """Public functions and classes of a module, and the public methods of these classes."""
    for node in parsed.body:
        if isinstance(node, ast.FunctionDef | ast.ClassDef) and not node.name.startswith("_"):
            yield node
            for inner in node.body if isinstance(node, ast.ClassDef) else ():
                if isinstance(inner, ast.FunctionDef) and not inner.name.startswith("_"):
                    yield inner


def unhinted(parsed):
    """Public functions and methods, kernels aside, that lack the hint of a parameter or of what they return."""
    compiled, known = set(kernels(parsed)), list(public(parsed))
    made = [one for node in known for one in getattr(node, "body", ()) if getattr(one, "name", "") == "__init__"]
    for node in known + made:
        if isinstance(node, ast.FunctionDef) and node not in compiled:
            a = node.args
            every = [*a.posonlyargs, *a.args, *a.kwonlyargs, *filter(None, (a.vararg, a.kwarg))]
            bare = [arg.arg for arg in every if not arg.annotation and arg.arg not in ("self", "cls")]
            if bare or not node.returns:
                yield f"{node.name}: {', '.join(bare) or 'what it returns'}"


def test_the_rules_can_be_broken():
    bad = ast.parse(
        "@rows\ndef f(x, y):\n  t = 0.0\n  for i in prange(9):\n    s = 0.0\n    for j in range(3):\n"
        "      s += x[j] ** 2\n    t += s\n    y[i] = np.sum(x) + math.exp(s) + x @ y\n  return t\n"
    )
    (function,) = kernels(bad)
    (weight,) = kernels(ast.parse("@implements(Gauss)\ndef f(weight, r2, inverse):\n  return math.exp(-r2), r2**2\n"))
    assert [fault.split(": ")[1] for fault in arithmetic_faults(weight)] == ["exp()", "**"]
    assert sorted(fault.split(": ")[1] for fault in arithmetic_faults(function)) == ["**", "@", "exp()", "sum()"]
    assert list(reductions(function)) == ["line 8: t is summed over a prange"]
    (lost,) = kernels(
        ast.parse(
            "@each\ndef f(p, q):\n  x, y = p\n  z = q.z\n  for i in prange(9):\n    x[i] = z[i]\n"
            "    z[i] = y[i]\n    q.y[i] += 1\n"
        )
    )
    assert list(lost_writes(lost)) == ["line 6: x[...] is written, and lost", "line 8: y[...] is written, and lost"]
    told = (
        "from parsim import comm\nfrom parsim.fluid.weights import w\nif TYPE_CHECKING:\n  from parsim.run import r\n"
    )
    assert own(ast.parse(told)) == {"comm", "fluid"}
    half = ast.parse(
        "def f(x: int, *y): ...\n@rows\ndef g(x): ...\ndef _h(x): ...\nclass C:\n  def __init__(self): ...\n"
        "  def i(self) -> int: ...\n"
    )
    assert sorted(unhinted(half)) == ["__init__: what it returns", "f: y"]


@pytest.mark.parametrize("path", SOURCES, ids=name)
def test_imports(path):
    parsed = tree(path)
    used, inside = imports(parsed), name(path).removeprefix("parsim/")
    roots = {word.split(".")[0] for word in used}
    assert "mpi4py" not in roots or inside == "domain/comm.py", "only domain/comm.py imports mpi4py"
    assert not {"numba.njit", "numba.jit"} & used or inside == "machine/jit.py", "kernels are made by machine/jit.py"
    if any(word.startswith("parsim.machine.jit.") for word in used) and not inside.startswith(("bench/", "observe/")):
        assert not own(parsed) & ABOVE_KERNELS, "kernels import downward only"
    if inside.startswith("report/"):
        assert own(parsed) <= BESIDE_REPORT, "report reads files and knows no solver"
    if inside.startswith("river/"):
        assert own(parsed) <= BESIDE_RIVER, "measures are of arrays and files, and know no solver"
    if inside.startswith(PHYSICS):
        assert not own(parsed) & {"domain", "launch", "run"}, "the physics never sees a rank"


@pytest.mark.parametrize("path", SOURCES, ids=name)
def test_kernels_keep_their_bits(path):
    inside = name(path).removeprefix("parsim/")
    strict = inside.startswith(STRICT) and inside != SEEN_ONLY
    faults = []
    for function in kernels(tree(path)):
        every = (*reductions(function), *lost_writes(function), *crowded(function))
        faults += [f"{function.name} {fault}" for fault in every]
        faults += [f"{function.name} {fault}" for fault in arithmetic_faults(function) if strict]
    assert not faults


@pytest.mark.parametrize("path", SOURCES, ids=name)
def test_public_things_are_described(path):
    parsed = tree(path)
    assert ast.get_docstring(parsed), "a module says what it is for"
    assert [node.name for node in public(parsed) if not ast.get_docstring(node)] == []


@pytest.mark.parametrize("path", HINTED, ids=name)
def test_public_things_have_type_hints(path):
    assert list(unhinted(tree(path))) == []


@pytest.mark.long
def test_the_type_hints_are_right(tmp_path):
    words = [sys.executable, "-m", "mypy", "--cache-dir", tmp_path]
    ran = subprocess.run(words, cwd=ROOT, capture_output=True, text=True)
    assert ran.returncode == 0, ran.stdout + ran.stderr


@pytest.mark.parametrize("path", SOURCES + TESTS + SCRIPTS, ids=name)
def test_files_are_short_and_finished(path):
    text = path.read_text()
    assert text.count("\n") <= (350 if path in TESTS else 300), "split it"
    assert not re.search(r"\b(TO" + r"DO|FIX" + r"ME|XX" + r"X)\b", text)


def test_top_level_holds_only_what_it_should():
    listed = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True).stdout.split("\n")
    names = {line.split("/")[0] for line in listed if line and not line.startswith(".")}
    assert names <= TOP


def test_files_named_in_the_readme_exist():
    text = (ROOT / "README.md").read_text()
    named = set(re.findall(r"\]\((?!https?:)([^)#]+)\)", text))
    named |= set(re.findall(r"\b((?:parsim|tests|cases|jobs)/[\w./-]*\w)", text))
    assert len(named) > 10
    assert sorted(path for path in named if not (ROOT / path).exists()) == []


@pytest.mark.parametrize("path", SCRIPTS, ids=name)
def test_scripts_parse(path):
    subprocess.run(["bash", "-n", path], check=True)


@pytest.mark.parametrize("words", [["check"], ["format", "--check"]])
def test_ruff_finds_nothing(words):
    ran = subprocess.run([sys.executable, "-m", "ruff", *words, "."], cwd=ROOT, capture_output=True, text=True)
    assert ran.returncode == 0, ran.stdout
