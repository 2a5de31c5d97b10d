"""Run tests on small faults: one process collects the tests of a room, and a copy of it is made for each fault.

The copy has the fault in the code of its functions, so that nothing is written and nothing imported again; a compiled
kernel with the fault, and those that call it, are compiled anew in it.
"""

from __future__ import annotations

import ast
import contextlib
import dataclasses
import functools
import gc
import json
import os
import pickle
import shutil
import signal
import sys
import tempfile
import time
import types
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pytest
from mutation.sites import Site

LEAST, FACTOR = 15.0, 4.0
"""A fault may take so many seconds, and so many times as long as its tests do without it; then it counts as seen: a
loop that does not end."""
COMPILING = 45.0
"""Seconds that are added where kernels are compiled anew."""
MOST_SECONDS = 60.0
"""Tests of a fault that take longer in all are left out, the longest first."""


@dataclass
class Cover:
    """Which tests run which lines, and how long they take."""

    seconds: dict[str, float] = field(default_factory=dict)
    lines: dict[str, dict[int, list[str]]] = field(default_factory=dict)
    """By file and line."""


class Runner:
    """A plugin of pytest that takes the place of its loop.

    Parameters
    ----------
    root : Path
        Of the project.
    sites : sequence of Site
        What is tried.
    cover_file : Path
        Where the coverage is kept.
    versions : mapping
        Keys of the files of tests.
    tried : mapping
        Such keys of the tests that a site has survived.
    jobs : int
        Copies that run at a time.
    report : callable
        Takes a site, its state, the test that saw it and the seconds.
    """

    def __init__(
        self,
        root: Path,
        sites: Sequence[Site],
        cover_file: Path,
        versions: Mapping[str, str],
        tried: Mapping[Site, Mapping[str, str]],
        jobs: int,
        report: Any,
    ) -> None:
        self.root, self.sites, self.cover_file, self.jobs, self.report = root, sites, cover_file, jobs, report
        self.versions, self.tried = versions, tried

    def pytest_configure(self) -> None:
        """Let hypothesis search, but not shrink what it found, nor keep it."""
        from hypothesis import Phase, settings

        settings.register_profile(
            "mutation", settings.get_profile("strikewave"), phases=(Phase.explicit, Phase.generate), database=None
        )
        settings.load_profile("mutation")

    @pytest.hookimpl(tryfirst=True)
    def pytest_runtestloop(self, session: pytest.Session) -> bool:
        """Measure which tests run what unless that is kept, then try all sites."""
        self.items = {item.nodeid: item for item in session.items}
        self.session = session
        self._sound: dict[tuple[str, str], bool] = {}
        cover = self._cover()
        running: dict[int, tuple[Site, float, float, Path]] = {}
        waiting = list(self.sites)
        while waiting or running:
            while waiting and len(running) < self.jobs:
                site = waiting.pop(0)
                tests = self._tests_of(site, cover)
                if not tests:
                    self.report(site, "survived" if site in self.tried else "not covered", "", 0.0, 0)
                    continue
                answer = Path(tempfile.mkdtemp(prefix="mutant-"))
                limit = LEAST + FACTOR * sum(cover.seconds[test] for test in tests) + COMPILING * site.kernel
                running[self._begin(site, tests, answer)] = (site, time.monotonic(), limit, answer)
            self._end_some(running, cover)
        return True

    def _is_sound(self, site: Site, test: str) -> bool:
        """Tell whether a test passes where kernels are compiled anew without a fault; else it is not asked again."""
        key = (site.file, test)
        if key not in self._sound:
            answer = Path(tempfile.mkdtemp(prefix="control-"))
            os.waitpid(self._begin(dataclasses.replace(site, after=site.before), [test], answer), 0)
            told = answer / "answer.json"
            self._sound[key] = told.exists() and json.loads(told.read_text())[0] == "survived"
            shutil.rmtree(answer, ignore_errors=True)
        return self._sound[key]

    def _end_some(self, running: dict[int, tuple[Site, float, float, Path]], cover: Cover) -> None:
        """Take what has ended, and end what takes too long."""
        time.sleep(0.02)
        for process, (site, begun, limit, answer) in list(running.items()):
            late = time.monotonic() - begun > limit
            if late:
                with contextlib.suppress(ProcessLookupError):
                    os.killpg(process, signal.SIGKILL)
            ended, _ = os.waitpid(process, 0 if late else os.WNOHANG)
            if not ended:
                continue
            with contextlib.suppress(ProcessLookupError, PermissionError):
                os.killpg(process, signal.SIGKILL)  # what it started
            told = answer / "answer.json"
            state, test, count = json.loads(told.read_text()) if told.exists() else ("killed", "it ended", 0)
            if late:
                state, test = "killed", "it took too long"
            shutil.rmtree(answer, ignore_errors=True)
            del running[process]
            if site.kernel and state == "killed" and test in self.items and not self._is_sound(site, test):
                again = Path(tempfile.mkdtemp(prefix="mutant-"))
                running[self._begin(site, self._tests_of(site, cover), again)] = (site, begun, limit * 2, again)
                continue
            self.report(site, state, test, time.monotonic() - begun, count)

    def _begin(self, site: Site, tests: Sequence[str], answer: Path) -> int:
        process = os.fork()
        if process:
            return process
        os.setpgid(0, 0)
        self._silence(answer)
        try:
            apply(site, self.root)
            state = ("survived", "", len(tests))
            failed = Failures()
            self.session.config.pluginmanager.register(failed)
            for k, test in enumerate(tests):
                self._run(test, tests[k + 1] if k + 1 < len(tests) else None)
                if failed.any:
                    state = ("killed", test, k + 1)
                    break
        except (Unreached, SyntaxError) as error:
            state = ("not reached", str(error), 0)
        except BaseException as error:  # a fault that not even pytest outlives
            state = ("killed", f"{type(error).__name__}: {error}"[:200], 0)
        (answer / "answer.json").write_text(json.dumps(state))
        os._exit(0)

    def _silence(self, folder: Path) -> None:
        """Let what a copy prints lead nowhere, and its files lie in a folder of its own."""
        nowhere = os.open(os.devnull, os.O_RDWR)
        for number in (0, 1, 2):
            os.dup2(nowhere, number)
        self.session.config._tmp_path_factory._given_basetemp = folder / "temporary"  # type: ignore[attr-defined]
        self.session.config.pluginmanager.unregister(name="terminalreporter")
        os.chdir(self.root)

    def _run(self, test: str, following: str | None) -> None:
        item = self.items[test]
        item.config.hook.pytest_runtest_protocol(item=item, nextitem=self.items[following] if following else None)

    def _cover(self) -> Cover:
        kept: dict[tuple[str, str], Cover] = {}
        if self.cover_file.exists():
            kept = pickle.loads(self.cover_file.read_bytes())  # written by this program, in the folder of the project
        keys = [(module, self.versions[module]) for module in dict.fromkeys(map(_module_of_test, self.items))]
        missing = [module for module, version in keys if (module, version) not in kept]
        if missing:
            print(f"measuring what {len(missing)} files of tests run ...", flush=True)
            for module, part in self._measured(missing).items():
                kept[module, self.versions[module]] = part
            self.cover_file.parent.mkdir(parents=True, exist_ok=True)
            self.cover_file.write_bytes(pickle.dumps({key: kept[key] for key in keys}))
        cover = Cover()
        for key in keys:
            cover.seconds |= kept[key].seconds
            for file, lines in kept[key].lines.items():
                for line, tests in lines.items():
                    cover.lines.setdefault(file, {}).setdefault(line, []).extend(tests)
        return cover

    def _measured(self, modules: Sequence[str]) -> dict[str, Cover]:
        """Return what the tests of files run; they are shared among copies, each takes every so-manieth file."""
        parts: list[tuple[int, Path]] = []
        for job in range(self.jobs):
            folder = Path(tempfile.mkdtemp(prefix="cover-"))
            process = os.fork()
            if not process:
                try:
                    self._silence(folder)
                    found = {
                        module: self._measure([test for test in self.items if _module_of_test(test) == module])
                        for module in modules[job :: self.jobs]
                    }
                    (folder / "cover").write_bytes(pickle.dumps(found))
                finally:
                    os._exit(0)
            parts.append((process, folder))
        covers: dict[str, Cover] = {}
        for process, folder in parts:
            os.waitpid(process, 0)
            covers |= pickle.loads((folder / "cover").read_bytes())
            shutil.rmtree(folder, ignore_errors=True)
        return covers

    def _measure(self, tests: Sequence[str]) -> Cover:
        import coverage

        measured = coverage.Coverage(data_file=None, source=[str(self.root / "src")], config_file=False)
        failed, cover = Failures(), Cover()
        self.session.config.pluginmanager.register(failed)
        measured.start()
        for k, test in enumerate(tests):
            measured.switch_context(test)
            failed.any, begun = False, time.perf_counter()
            self._run(test, tests[k + 1] if k + 1 < len(tests) else None)
            if not failed.any:  # what fails without a fault says nothing of one
                cover.seconds[test] = time.perf_counter() - begun
        measured.stop()
        self.session.config.pluginmanager.unregister(failed)
        data = measured.get_data()
        for name in data.measured_files():
            file = Path(name).relative_to(self.root).as_posix()
            for line, contexts in data.contexts_by_lineno(name).items():
                found = [test for test in contexts if test in cover.seconds]
                if found:
                    cover.lines.setdefault(file, {})[line] = found
        return cover

    def _tests_of(self, site: Site, cover: Cover) -> list[str]:
        """Return the tests that run what a site is in, the shortest first."""
        tests: set[str] = set()
        if site.kernel:
            tests = self._tests_of_kernel(site, cover)
        elif site.kind == "constant":
            tests = self._tests_of_name(site, cover)
        else:
            lines = cover.lines.get(site.file, {})
            first, last = _lines_of_statement((self.root / site.file).read_text("utf-8"), site.line)
            for line in range(first, last + 1):
                tests.update(lines.get(line, ()))
        kept, seconds = list[str](), 0.0
        tried = self.tried.get(site, {})
        tests = {
            test
            for test in tests
            if self._sound.get((site.file, test), True)
            and tried.get(_module_of_test(test)) != self.versions[_module_of_test(test)]
        }
        for test in sorted(tests, key=lambda one: (cover.seconds[one], one)):
            seconds += cover.seconds[test]
            if kept and seconds > MOST_SECONDS:
                break
            kept.append(test)
        return kept

    def _tests_of_name(self, site: Site, cover: Cover) -> set[str]:
        """Return the tests that enter a function that uses a constant."""
        tests: set[str] = set()
        for function in _functions():
            if site.scope in _names(function.__code__) and _own_constant(function.__globals__, site):
                tests |= _entering(function.__code__, self.root, cover)
        for dispatcher in _dispatchers():
            code = dispatcher.py_func.__code__
            if site.scope in _names(code) and _own_constant(dispatcher.py_func.__globals__, site):
                tests |= self._callers([dispatcher], cover)
        return tests

    def _tests_of_kernel(self, site: Site, cover: Cover) -> set[str]:
        module = _module_of(site)
        dispatcher = getattr(module, site.scope, None) if module is not None else None
        if dispatcher is None:
            return set()
        # those affected find it by its type, or are handed it
        return self._callers([dispatcher, *_affected(dispatcher)], cover)

    def _callers(self, dispatchers: Iterable[Any], cover: Cover) -> set[str]:
        """Return the tests that enter what calls any of some kernels, or that name one, or what does beside them."""
        tests: set[str] = set()
        callers = {id(one) for one in _calling(dispatchers)}
        handed = _attributes_with(callers)
        for function in _functions():
            names = function.__code__.co_names
            if not _used(function).isdisjoint(callers) or not handed.isdisjoint(names):
                tests |= _entering(function.__code__, self.root, cover)
        reaching = callers | _helpers_of(callers, self.root / "tests")
        for test, item in self.items.items():
            function = getattr(item, "function", None)
            function = getattr(getattr(function, "hypothesis", None), "inner_test", function)
            if not isinstance(function, types.FunctionType) or test not in cover.seconds:
                continue
            named = {id(value) for value in function.__globals__.values()}
            if not named.isdisjoint(callers) or not _used(function).isdisjoint(reaching):
                tests.add(test)
        return tests


class Failures:
    """A plugin that notes whether any test failed."""

    any = False

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """Note a failure of a test, or of what it is set up with."""
        if report.failed:
            self.any = True


class Unreached(Exception):  # noqa: N818
    """The code with a fault is in no function that runs."""


def apply(site: Site, root: Path) -> None:
    """Put a fault into this process.

    Raises
    ------
    Unreached
        If no function has the code.
    """
    path = root / site.file
    text = path.read_text("utf-8")
    if site.kind == "constant":
        return _apply_constant(site)
    old, new = (compile(one, str(path), "exec", dont_inherit=True) for one in (text, site.applied(text)))
    changed = dict(_pairs(old, new))
    reached = not changed  # a control, without a fault
    for function in _functions():
        if function.__code__ in changed and Path(function.__code__.co_filename) == path:
            function.__code__ = changed[function.__code__]
            reached = True
    if site.kernel:
        _compile_anew(_affected(getattr(_module_of(site), site.scope)))
    if not reached:
        raise Unreached(site.scope)
    return None


def _apply_constant(site: Site) -> None:
    """Change a constant of a module, wherever it was imported."""
    value = ast.literal_eval(site.after)
    before = ast.literal_eval(site.before)
    reached = False
    for module in _modules():
        names = vars(module)
        if _own_constant(names, site) and names[site.scope] == before:
            names[site.scope] = value
            reached = True
    using = [one for one in _dispatchers() if one.py_func.__globals__.get(site.scope) == value]
    for dispatcher in using:
        if site.scope in _names(dispatcher.py_func.__code__):
            _compile_anew(_affected(dispatcher))
    if not reached:
        raise Unreached(site.scope)


def _own_constant(names: dict[str, Any], site: Site) -> bool:
    """Tell whether a module has the constant of a site: its own, or imported from there."""
    if site.scope not in names:
        return False
    home = sys.modules.get(_module_name(site))
    return home is None or _same(vars(home).get(site.scope), names[site.scope])


def _same(one: Any, other: Any) -> bool:
    return type(one) is type(other) and isinstance(one, int | float) and one == other


def _module_name(site: Site) -> str:
    return site.file.removeprefix("src/").removesuffix(".py").replace("/", ".").removesuffix(".__init__")


def _module_of(site: Site) -> types.ModuleType | None:
    return sys.modules.get(_module_name(site))


def _pairs(old: types.CodeType, new: types.CodeType) -> Iterator[tuple[types.CodeType, types.CodeType]]:
    """Pair the functions of both versions of a file that differ."""
    olds = [one for one in old.co_consts if isinstance(one, types.CodeType)]
    news = [one for one in new.co_consts if isinstance(one, types.CodeType)]
    for one, other in zip(olds, news, strict=True):
        yield from _pairs(one, other)
        if one != other and one.co_flags & 2:  # a function, no body of a class: it has names of its own
            yield one, other


def _functions() -> list[types.FunctionType]:
    """Return all functions of the project."""
    gc.unfreeze()  # tests freeze what was collected, and the collector does not list what is frozen
    return [one for one in gc.get_objects() if type(one) is types.FunctionType and _is_ours(one.__module__)]


@functools.cache
def _dispatchers() -> list[Any]:
    """Return all kernels of the project."""
    from numba.core.registry import CPUDispatcher

    gc.unfreeze()
    return [one for one in gc.get_objects() if isinstance(one, CPUDispatcher) and _is_ours(one.py_func.__module__)]


def _modules() -> Iterable[types.ModuleType]:
    return [module for name, module in list(sys.modules.items()) if _is_ours(name)]


def _module_of_test(test: str) -> str:
    return test.split("::")[0]


def _is_ours(name: str | None) -> bool:
    return bool(name) and (name == "strikewave" or str(name).startswith("strikewave."))


def _names(code: types.CodeType) -> set[str]:
    """Return the global names that a function uses, and those within it."""
    names = set(code.co_names)
    for one in code.co_consts:
        if isinstance(one, types.CodeType):
            names |= _names(one)
    return names


@functools.cache
def _used(function: types.FunctionType) -> set[int]:
    """Return which objects a function names: global ones, what stands in them, and those of the modules it names."""
    names, home = _names(function.__code__), function.__globals__
    values = [home[name] for name in names if name in home]
    for module in [one for one in values if isinstance(one, types.ModuleType) and _is_ours(one.__name__)]:
        values += [getattr(module, name) for name in names if hasattr(module, name)]
    for table in [one for one in values if isinstance(one, dict | tuple | list)]:
        values += table.values() if isinstance(table, dict) else table
    if function.__closure__:
        values += [cell.cell_contents for cell in function.__closure__ if _filled(cell)]
    return {id(value) for value in values}


def _attributes_with(kernels: set[int]) -> set[str]:
    """Return the names of attributes by which classes of the project hold kernels."""
    classes = [one for module in _modules() for one in vars(module).values() if isinstance(one, type)]
    members = [(name, value) for one in classes for name, value in vars(one).items()]
    return {name for name, value in members if id(getattr(value, "__func__", value)) in kernels}


def _helpers_of(kernels: set[int], tests: Path) -> set[int]:
    """Return the functions and classes beside tests that name kernels, or others of them that do."""
    used: dict[int, set[int]] = {}
    for module in list(sys.modules.values()):
        if not str(getattr(module, "__file__", None)).startswith(str(tests)):
            continue
        for value in vars(module).values():
            members = vars(value).values() if isinstance(value, type) else [value]
            functions = [getattr(one, "__func__", getattr(one, "fget", one)) for one in members]
            own = [_used(one) for one in functions if isinstance(one, types.FunctionType)]
            used[id(value)] = set().union(*own)
    found: set[int] = set()
    while more := {key for key, names in used.items() if key not in found and not names.isdisjoint(kernels | found)}:
        found |= more
    return found


def _filled(cell: types.CellType) -> bool:
    try:
        cell.cell_contents  # noqa: B018
    except ValueError:
        return False
    return True


def _calling(dispatchers: Iterable[Any]) -> list[Any]:
    """Return some kernels and all that call them by name."""
    found = {id(one): one for one in dispatchers}
    while True:
        more = {
            id(one): one for one in _dispatchers() if id(one) not in found and not _used(one.py_func).isdisjoint(found)
        }
        if not more:
            return list(found.values())
        found |= more


def _affected(dispatcher: Any) -> list[Any]:
    """Return a kernel and all that may call it: by name, by type, or of modules that import from its module."""
    home = dispatcher.py_func.__module__
    modules = {home}
    while True:
        for name in list(modules):  # what is overloaded for a type calls the kernel without naming it
            names = vars(sys.modules[name])
            if "overload" in names:
                modules |= {
                    one.__name__
                    for one in names.values()
                    if isinstance(one, types.ModuleType) and _is_ours(one.__name__)
                }
        more = {
            one.py_func.__module__
            for one in _dispatchers()
            for value in one.py_func.__globals__.values()
            if getattr(value, "__module__", None) in modules
        } - modules
        if not more:
            break
        modules |= more
    return [one for one in _dispatchers() if one.py_func.__module__ in modules]


def _compile_anew(dispatchers: Iterable[Any]) -> None:
    """Let kernels be compiled when they are called next, and kept nowhere."""
    import numba
    from numba.core.caching import NullCache

    numba.config.OPT = numba.core.config._OptLevel(0)  # type: ignore[attr-defined]  # half the time of compiling
    for one in dispatchers:
        one._cache = NullCache()
        one._reset_overloads()
        one.overloads.clear()


def _entering(code: types.CodeType, root: Path, cover: Cover) -> set[str]:
    """Return the tests that run any line of a function."""
    path = Path(code.co_filename)
    if not path.is_relative_to(root):
        return set()
    lines = cover.lines.get(path.relative_to(root).as_posix(), {})
    tests: set[str] = set()
    own = {line for _, _, line in code.co_lines() if line} - {code.co_firstlineno}
    for line in own:
        tests.update(lines.get(line, ()))
    return tests


def _lines_of_statement(text: str, line: int) -> tuple[int, int]:
    """Return the lines of the smallest statement without statements in it around a line; of another, its head."""
    first, last = line, line
    best = None
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.stmt) and node.lineno <= line <= (node.end_lineno or node.lineno):
            size = (node.end_lineno or node.lineno) - node.lineno
            if best is None or size <= best:
                best = size
                body = getattr(node, "body", None)
                last = max(body[0].lineno - 1, node.lineno) if body else node.end_lineno or node.lineno
                first = node.lineno
    return first, last
