"""What a docstring must tell, as rules on source code: nothing is imported, nothing is run.

- Every public module, class, function and method has a docstring.
- Arrays have a shape: in the annotation (jaxtyping), in the line of the parameter or field, in the
  sentences on top, or once for a whole class or module in a line ``Shapes: …``.
- Numbers whose name is that of a physical quantity have a unit, in their line or on top.
- Errors that leave a function from its own body stand under ``Raises:``.

- Every effect and every model of a valve says where it is from, under ``Source:``.

A method that stands for a documented one of a class above has its arguments documented there.
"""

import ast
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

QUANTITIES: Final = frozenset(
    (
        "acceleration", "amplitude", "amplitudes", "centre", "current", "currents", "damping",
        "displacement", "duration", "energy", "force", "forces", "frequency", "frequencies",
        "omega", "period", "phase", "position", "pressure", "speed", "stiffness", "stroke",
        "temperature", "temperatures", "time", "times", "travel", "velocity", "voltage",
    )
)  # fmt: skip
"""Last words of the names of physical quantities."""
NUMBERS: Final = frozenset(("float", "np.ndarray", "NDArray", "Array", "Scalar", "Float"))
"""Annotations of numbers, beside the aliases that modules make of them."""

_BARE: Final = re.compile(
    r"\b(?:np\.ndarray|jnp\.ndarray|jax\.Array|NDArray\[[^\]]*\]|Arrays?|ArrayLike)\b"
)
"""Arrays whose annotation says nothing of their shape."""
_SHAPED: Final = re.compile(r"\b(?:Float|Int|Bool|Complex|Num|Shaped|Inexact|UInt\d*)\[[^\]]*\]")
"""Annotations that do (jaxtyping)."""
_SHAPE: Final = re.compile(
    r"\[[^\]]*\]|\bscalar|\bshapes?\b|\b[oO]ne (?:number |value |row )?an? |\bflat\b"
)
"""How a docstring says a shape: [L, J], or in words."""
_ONE: Final = r"(?:[kMmµ]?(?:Hz|Pa|rad|kg|min|N|m|s|A|V|K|J|W)|°C|degC|°|degrees|SI|1)[²³]?"
_UNIT: Final = re.compile(
    r"(?:^|[,;:(\]]\s*|\bin |\bof |\d\s*)(?:(?<=\] )|(?!A\s+[a-z]))"
    rf"{_ONE}(?:[·/]{_ONE})*(?=[\s,.;:)]|$)"
    r"|\bdimensionless\b|\bparts?\b|\b[sS]hares?\b|\bper cent\b|\b(?:any|same|its|own) units?\b"
)
"""A unit as docstrings write it: ``m, of the fundamental``, ``[L] N``, ``largest speed, m/s``."""
_ENTRY: Final = re.compile(r"^(\s*)\*{0,2}([A-Za-z_]\w*)(?:, \w+)*\s*:(.*)$")
_SECTION: Final = re.compile(r"^(Args|Attributes|Returns|Raises|Yields|Source|Note|Example)s?:\s*$")
_MADE_OF: Final = re.compile(r"(?:Float|np\.ndarray|NDArray)\b")
_ERROR: Final = re.compile(r"(?:[A-Z]\w*)?(?:Error|Exception|Stopped)")

_Def = ast.FunctionDef | ast.AsyncFunctionDef


@dataclass(frozen=True)
class Fault:
    """Something that a docstring does not tell.

    Attributes:
        name: Qualified name of what it belongs to.
        rule: Which rule: docstring, shape, unit, raises or source.
        what: What is not told.
    """

    name: str
    rule: str
    what: str

    def __str__(self) -> str:
        return f"{self.name}: {self.what}"


@dataclass(frozen=True)
class _Known:
    """What one module has to know of all others.

    Attributes:
        classes: Name → its bases, and those of its methods that have a docstring.
        numbers: Names of types that are numbers.
    """

    classes: Mapping[str, tuple[Sequence[str], frozenset[str]]]
    numbers: re.Pattern[str]

    def is_number(self, annotation: str) -> bool:
        return not annotation.startswith("Callable") and bool(self.numbers.search(annotation))

    def overrides(self, name: str, method: str) -> bool:
        """Whether a class's method stands for one that is documented in a class above."""
        return any(
            method in self.classes.get(base, ((), frozenset()))[1] or self.overrides(base, method)
            for base in self.classes.get(name, ((), frozenset()))[0]
        )


def faults_of(modules: Mapping[str, str]) -> list[Fault]:
    """Everything that docstrings of public things leave out.

    Args:
        modules: Qualified name → source; those with a private part in their name are passed over.
    """
    trees = {
        name: ast.parse(source)
        for name, source in modules.items()
        if not any(part.startswith("_") for part in name.split("."))
    }
    known = _known(trees.values())
    found = []
    for name, tree in trees.items():
        text = ast.get_docstring(tree)
        if not text:
            found.append(Fault(name, "docstring", "the module has no docstring"))
        shapes = sections(text or "")["Shapes"]
        for node in tree.body:
            if isinstance(node, _Def) and not node.name.startswith("_"):
                found += _function(node, f"{name}.{node.name}", shapes, known, in_class=False)
            elif isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
                found += _class(node, f"{name}.{node.name}", shapes, known)
    return found


def package(root: Path) -> dict[str, str]:
    """Sources of a package, by qualified name."""
    found = {}
    for path in sorted(root.rglob("*.py")):
        parts = path.relative_to(root.parent).with_suffix("").parts
        name = ".".join(parts[:-1] if parts[-1] == "__init__" else parts)
        found[name] = path.read_text(encoding="utf-8")
    return found


def sections(text: str, above: str = "") -> dict[str, str]:
    """Text of a docstring by its sections; what stands before the first is under "".

    Args:
        text: The docstring.
        above: What the class or module around says after ``Shapes:``.
    """
    shapes = re.search(r"^Shapes: (.+)$", text, flags=re.MULTILINE)
    found, current = {"": "", "Shapes": shapes[1] if shapes else above}, ""
    for line in text.splitlines():
        heading = _SECTION.match(line)
        if heading:
            current = heading[1]
            found.setdefault(current, "")
        else:
            found[current] += f"{line}\n"
    return found


def entries(text: str) -> dict[str, str]:
    """Name → its description, of an Args or Attributes section."""
    found: dict[str, str] = {}
    outer: int | None = None
    names: list[str] = []
    for line in text.splitlines():
        match = _ENTRY.match(line)
        if match and (outer is None or len(match[1]) <= outer):
            outer = len(match[1])
            names = re.findall(r"\w+", line.split(":")[0])
            found |= dict.fromkeys(names, match[3].strip())
        else:
            found |= {name: f"{found[name]} {line.strip()}" for name in names}
    return found


def _known(trees: Iterable[ast.Module]) -> _Known:
    classes: dict[str, tuple[Sequence[str], frozenset[str]]] = {}
    numbers = set(NUMBERS)
    for tree in trees:
        for node in ast.walk(tree):
            if isinstance(node, ast.ClassDef):
                bases = [ast.unparse(b).split("[")[0].rpartition(".")[2] for b in node.bases]
                told = {f.name for f in node.body if isinstance(f, _Def) and ast.get_docstring(f)}
                classes[node.name] = (bases, frozenset(told))
        for node in tree.body:  # aliases, such as Samples = Float[np.ndarray, " n"]
            if isinstance(node, ast.Assign) and _MADE_OF.match(ast.unparse(node.value)):
                numbers |= {target.id for target in node.targets if isinstance(target, ast.Name)}
    return _Known(classes, re.compile(rf"\b(?:{'|'.join(map(re.escape, sorted(numbers)))})\b"))


def _class(node: ast.ClassDef, name: str, shapes: str, known: _Known) -> Iterator[Fault]:
    text = ast.get_docstring(node)
    if not text:
        yield Fault(name, "docstring", "the class has no docstring")
    told = sections(text or "", shapes)
    described = entries(told.get("Attributes", ""))
    for field in node.body:
        if not isinstance(field, ast.AnnAssign) or not isinstance(field.target, ast.Name):
            continue
        annotation = ast.unparse(field.annotation).strip("'\"")
        declared = isinstance(field.value, ast.Call) and ast.unparse(field.value.func) == "param"
        if field.target.id.startswith("_") or "ClassVar" in annotation or declared:
            continue  # a model's parameter has symbol, name and unit in its declaration
        yield from _quantity(name, field.target.id, annotation, told, described, known)
    if _is_physics(node) and not told.get("Source", "").strip():
        yield Fault(name, "source", "an effect or a model of a valve without `Source:`")
    for method in node.body:
        if not isinstance(method, _Def) or method.name.startswith("_"):
            continue
        whole = f"{name}.{method.name}"
        if known.overrides(node.name, method.name):
            yield from _raises(method, whole)
        else:
            yield from _function(method, whole, told["Shapes"], known, in_class=True)


def _is_physics(node: ast.ClassDef) -> bool:
    """Whether a class is an effect or a model of a valve, and not the abstract one of its kind."""
    bases = {ast.unparse(b).split("[")[0].rpartition(".")[2] for b in node.bases}
    return not node.name.startswith("Abstract") and any(
        re.fullmatch(r"Abstract\w*(?:Effect|Valve)", base) for base in bases
    )


def _function(
    node: _Def, name: str, shapes: str, known: _Known, *, in_class: bool
) -> Iterator[Fault]:
    decorators = {ast.unparse(d).rpartition(".")[2] for d in node.decorator_list}
    if "overload" in decorators or "setter" in decorators:
        return
    text = ast.get_docstring(node)
    if not text:
        yield Fault(name, "docstring", "has no docstring")
        return
    told = sections(text, shapes)
    described = entries(told.get("Args", ""))
    every = [*node.args.posonlyargs, *node.args.args, *node.args.kwonlyargs]
    for argument in every[1:] if in_class and "staticmethod" not in decorators else every:
        if argument.annotation is not None and not argument.arg.startswith("_"):
            annotation = ast.unparse(argument.annotation).strip("'\"")
            yield from _quantity(name, argument.arg, annotation, told, described, known)
    returned = "" if node.returns is None else ast.unparse(node.returns).strip("'\"")
    spoken = "".join(told.get(z, "") for z in ("Shapes", "Returns", "Yields"))
    if _is_bare(returned) and not told["Shapes"] and not _SHAPE.search(spoken + told[""]):
        yield Fault(name, "shape", f"the shape of what it returns ({returned}) is not told")
    yield from _raises(node, name)


def _raises(node: _Def, name: str) -> Iterator[Fault]:
    told = sections(ast.get_docstring(node) or "").get("Raises", "")
    for error in sorted({error for statement in node.body for error in _leaving(statement)}):
        if not re.search(rf"\b{error}\b", told):
            yield Fault(name, "raises", f"raises {error}, which has no line under `Raises:`")


def _quantity(
    owner: str,
    name: str,
    annotation: str,
    told: Mapping[str, str],
    described: Mapping[str, str],
    known: _Known,
) -> Iterator[Fault]:
    """Shape and unit of a parameter or field, in its own line or in the sentences on top."""
    about = described.get(name) or told[""]
    if _is_bare(annotation) and not told["Shapes"] and not _SHAPE.search(about):
        yield Fault(owner, "shape", f"the shape of {name} ({annotation}) is not told")
    physical = name.rpartition("_")[2] in QUANTITIES and known.is_number(annotation)
    if physical and not _UNIT.search(about):
        yield Fault(owner, "unit", f"the unit of {name} is not told")


def _is_bare(annotation: str) -> bool:
    if annotation.startswith("Callable"):
        return False  # a function tells of its arrays in its own docstring
    return bool(_BARE.search(_SHAPED.sub("", annotation)))


def _leaving(node: ast.AST) -> set[str]:
    """Names of errors that a statement raises and does not catch itself."""
    if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef | ast.Lambda):
        return set()
    if isinstance(node, ast.Raise):
        error = node.exc.func if isinstance(node.exc, ast.Call) else node.exc
        name = "" if error is None else ast.unparse(error)
        return {name} if _ERROR.fullmatch(name) else set()
    if isinstance(node, ast.Try):
        caught = " ".join(ast.unparse(h.type) for h in node.handlers if h.type is not None)
        tried = {name for statement in node.body for name in _leaving(statement)}
        rest = [*node.orelse, *node.finalbody, *(z for h in node.handlers for z in h.body)]
        kept = {name for name in tried if not re.search(rf"\b{name}\b", caught)}
        return kept | {name for statement in rest for name in _leaving(statement)}
    return {name for child in ast.iter_child_nodes(node) for name in _leaving(child)}
