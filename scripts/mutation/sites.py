"""Where the code of a room can be made wrong by a little: a sign, an operator, a comparison, an index, a number."""

from __future__ import annotations

import ast
import hashlib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

OPERATORS = {ast.Add: "-", ast.Sub: "+", ast.Mult: "/", ast.Div: "*", ast.FloorDiv: "*", ast.Mod: "*", ast.Pow: "*"}
SIGNS = {ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.Div: "/", ast.FloorDiv: "//", ast.Mod: "%", ast.Pow: "**"}
COMPARISONS = {ast.Lt: ("<", ">="), ast.LtE: ("<=", ">"), ast.Gt: (">", "<="), ast.GtE: (">=", "<")} | {
    ast.Eq: ("==", "!="),
    ast.NotEq: ("!=", "=="),
}
CALLS = {"min": "max", "max": "min", "minimum": "maximum", "maximum": "minimum", "floor": "ceil", "ceil": "floor"} | {
    "sin": "cos",
    "cos": "sin",
    "argmin": "argmax",
    "argmax": "argmin",
    "any": "all",
    "all": "any",
}
SMALL, LARGE = 1e-5, 1e8
"""Numbers beyond are taken for tolerances and guards, of which 1 % more is as good: they are multiplied by 1000."""
THRESHOLD = 2.0
"""Factor of a constant of a module: of a threshold or a tolerance, too, 1 % more is as good."""


@dataclass(frozen=True)
class Site:
    """One small fault.

    Attributes
    ----------
    file : str
        Path below the root.
    scope : str
        Qualified name of the function, or of the constant of the module.
    kind : str
        sign, operator, comparison, call, condition, index, number or constant.
    line, begin, end : int
        Line (from 1), and the part of the text of the file that is replaced.
    before, after : str
        What stands there, and what is put there.
    kernel : bool
        Whether it lies in a compiled kernel.
    """

    file: str
    scope: str
    kind: str
    line: int
    begin: int
    end: int
    before: str
    after: str
    kernel: bool

    def applied(self, text: str) -> str:
        """Return the text of the file with the fault."""
        return text[: self.begin] + self.after + text[self.end :]

    def name(self, text: str) -> str:
        """Return what names the fault as long as its line stands: file, function, line's text and both versions."""
        around = text.splitlines()[self.line - 1].strip()
        column = self.begin - text.rfind("\n", 0, self.begin)
        digest = hashlib.sha256(f"{self.scope}|{around}|{self.before}|{self.after}|{column}".encode()).hexdigest()[:10]
        return f"{self.file}:{self.scope}:{digest}"


def sites_of(path: Path, root: Path) -> list[Site]:
    """Return all small faults of a file, in the order of its text."""
    return _Finder(path.read_text("utf-8"), path.relative_to(root).as_posix()).sites


class _Finder:
    """Walks a file; messages, annotations, decorators, defaults and bodies of classes are left as they are."""

    def __init__(self, text: str, file: str) -> None:
        self.text, self.file = text, file
        lines = text.splitlines(keepends=True)
        self._starts = [0]
        for line in lines:
            self._starts.append(self._starts[-1] + len(line))
        self._lines = lines
        self.sites: list[Site] = []
        self._kernel = False
        module = ast.parse(text)
        for statement in module.body:
            self._statement(statement, "")
        self.sites.sort(key=lambda site: (site.begin, site.after))

    def _statement(self, node: ast.stmt, scope: str) -> None:
        if isinstance(node, ast.ClassDef):
            for one in node.body:
                if isinstance(one, ast.FunctionDef | ast.ClassDef):
                    self._statement(one, f"{scope}{node.name}.")
        elif isinstance(node, ast.FunctionDef):
            if node.name in ("__repr__", "__str__"):
                return
            self._kernel = any("kernel" in ast.unparse(one) for one in node.decorator_list)
            for one in node.body:
                self._within(one, f"{scope}{node.name}")
            self._kernel = False
        elif isinstance(node, ast.Assign | ast.AnnAssign) and not scope:
            targets = node.targets if isinstance(node, ast.Assign) else [node.target]
            value = node.value
            sign = isinstance(value, ast.UnaryOp)
            constant = value.operand if isinstance(value, ast.UnaryOp) else value
            if isinstance(targets[0], ast.Name) and isinstance(constant, ast.Constant) and _is_number(constant.value):
                assert value is not None
                after = ("-" if sign else "") + repr(type(constant.value)(constant.value * THRESHOLD) or 1)
                self._add(value, after, "constant", targets[0].id)

    def _within(self, node: ast.AST, scope: str) -> None:
        """Find the faults of a statement or an expression of a function."""
        if isinstance(node, ast.Raise | ast.Assert | ast.JoinedStr | ast.ClassDef | ast.Import | ast.ImportFrom):
            return
        if isinstance(node, ast.FunctionDef):  # one within
            for one in node.body:
                self._within(one, scope)
            return
        if isinstance(node, ast.AnnAssign):
            if node.value is not None:
                self._within(node.value, scope)
            return
        for site in self._own(node, scope):
            self.sites.append(site)
        for field, child in ast.iter_fields(node):
            if field in ("annotation", "returns", "decorator_list", "type_params"):
                continue
            for one in child if isinstance(child, list) else [child]:
                if isinstance(one, ast.AST):
                    self._within(one, scope)

    def _own(self, node: ast.AST, scope: str) -> Iterator[Site]:
        if isinstance(node, ast.BinOp) and type(node.op) in OPERATORS:
            if not _is_text(node.left) and not _is_text(node.right):
                yield from self._between(node.left, node.right, SIGNS[type(node.op)], OPERATORS[type(node.op)], scope)
        elif isinstance(node, ast.AugAssign) and type(node.op) in OPERATORS:
            before, after = f"{SIGNS[type(node.op)]}=", f"{OPERATORS[type(node.op)]}="
            yield from self._between(node.target, node.value, before, after, scope)
        elif isinstance(node, ast.Compare) and len(node.ops) == 1 and type(node.ops[0]) in COMPARISONS:
            before, after = COMPARISONS[type(node.ops[0])]
            yield from self._between(node.left, node.comparators[0], before, after, scope, "comparison")
        elif isinstance(node, ast.BoolOp):
            before, after = ("and", "or") if isinstance(node.op, ast.And) else ("or", "and")
            yield from self._between(node.values[0], node.values[1], before, after, scope, "condition")
        elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub | ast.Not):
            begin, sign = self._place(node)[0], isinstance(node.op, ast.USub)
            end = begin + len("-" if sign else "not ")  # brackets may follow
            yield self._site(scope, "sign" if sign else "condition", node.lineno, begin, end, "")
        elif isinstance(node, ast.Call):
            name = node.func
            word = name.id if isinstance(name, ast.Name) else name.attr if isinstance(name, ast.Attribute) else ""
            if word in CALLS:
                end = self._place(name)[1]
                yield self._site(scope, "call", name.end_lineno or 0, end - len(word), end, CALLS[word])
        elif isinstance(node, ast.Constant) and _is_number(node.value):
            begin, end = self._place(node)
            yield self._site(scope, "number", node.lineno, begin, end, _changed(node.value))
        elif isinstance(node, ast.Subscript) and isinstance(node.slice, ast.Name | ast.BinOp):
            begin, end = self._place(node.slice)
            if not isinstance(node.value, ast.Name) or node.value.id[:1].islower():  # no type
                yield self._site(scope, "index", node.lineno, begin, end, f"{self.text[begin:end]} - 1")

    def _between(
        self, left: ast.AST, right: ast.AST, before: str, after: str, scope: str, kind: str = "operator"
    ) -> Iterator[Site]:
        """Find an operator between two expressions; comments and brackets may stand there too."""
        begin, end = self._place(left)[1], self._place(right)[0]
        at = self.text.find(before, begin, end)
        if at >= 0 and "#" not in self.text[begin:end]:
            line = self.text.count("\n", 0, at) + 1
            yield self._site(scope, kind, line, at, at + len(before), after)

    def _add(self, node: ast.AST, after: str, kind: str, scope: str) -> None:
        begin, end = self._place(node)
        self.sites.append(self._site(scope, kind, self.text.count("\n", 0, begin) + 1, begin, end, after))

    def _site(self, scope: str, kind: str, line: int, begin: int, end: int, after: str) -> Site:
        return Site(self.file, scope, kind, line, begin, end, self.text[begin:end], after, self._kernel)

    def _place(self, node: ast.AST) -> tuple[int, int]:
        """Return where in the text a node begins and ends; the tree counts in bytes."""
        ends = []
        for line, column in ((node.lineno, node.col_offset), (node.end_lineno, node.end_col_offset)):  # type: ignore[attr-defined]
            ends.append(self._starts[line - 1] + len(self._lines[line - 1].encode()[:column].decode()))
        return ends[0], ends[1]


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _is_text(node: ast.AST) -> bool:
    return isinstance(node, ast.JoinedStr) or (isinstance(node, ast.Constant) and isinstance(node.value, str))


def _changed(value: float) -> str:
    """Return another number: an integer one more, any other 1 % more."""
    if isinstance(value, int):
        return str(value + 1)
    if value == 0.0:
        return "0.01"
    return repr(value * (1000.0 if not SMALL <= abs(value) <= LARGE else 1.01))
