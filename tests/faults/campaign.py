"""Faults that befall commands that write: a kill, a full disk, a folder that cannot be written, a damaged cache ...

    python tests/faults/campaign.py [--rounds N] [--rows FILE] [--write] [COMMAND ...]

makes each fault to each command, or to those that are named, with real processes, limits of the system and, for root, a real small disk; what has a
random moment or size N times (1). It prints a table of what was tried and what survived, and `--write` puts it into docs/faults.md. `--rows` keeps
what became of each fault in a file, and goes on from what is there. `Bench.survives` is the judge.
"""

from __future__ import annotations

import argparse
import atexit
import hashlib
import importlib
import math
import os
import random
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
import traceback
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass, field
from itertools import product
from pathlib import Path

import h5py

from strikewave.base.output_folder import list_files, mark_text

IMPACT = ("impact", "--stiffness", "4.7e9", "--exponent", "1.5", "-e", "0.5", "--m1", "1", "--m2", "2", "--speed", "1")
COMMANDS: dict[str, tuple[str, ...]] = {
    "impact": IMPACT,
    "run": ("run", "li-ma-2019", "--no-band", "--set", "feed.blows=2"),
    "wave": ("wave", "li-ma-2019-fig13-bar", "--no-band"),
    "record": ("record", "blow.csv"),
    "srs": ("srs", "blow.csv", "--per-octave", "3"),
    "compare": ("compare", "blow.csv", "blow.csv"),
    "fem": ("fem", "two-bars-fem", "--set", "fem.duration=8 us", "--set", "fem.frames=3", "--animate"),
    "deck": ("deck", "two-bars-fem"),
    "sweep": ("sweep", "jesd22-b111-b", "--vary", "machine.height=0.2..0.3 m:2", "--workers", "2"),
    "map": ("map", "li-ma-2019", "--points", "2x2", "--workers", "2", "--train", "0", "--set", "feed.blows=2"),
    "settings": ("settings", "--spec", "jesd22-b110:A", "--programmer", "linear"),
    "rotary": ("settings", "--interval", "20 ms", "--peak", "4000 g", "--width", "200 us", "--blows", "2",
               "--strikers", "3"),
    "scatter": ("scatter", "li-ma-2019-equal-blows", "--runs", "10", "--workers", "2", "--set", "feed.blows=2"),
    "buffer": ("buffer", "li-ma-2019-fig5", "--sensor", "buffered", "--limit", "7000 g", "--layers", "2",
               "--set", "feed.blows=2"),
    "fit": ("fit", "li-ma-2019", "--to", "first.rigid_peak=4000 g", "--free", "object.frame_stiffness",
            "--set", "feed.blows=2"),
    "design": ("design", "design.toml", "--workers", "2"),
    "reproduce": ("reproduce", "li-ma-2019", "--without", "elements", "--without", "studies"),
}  # fmt: skip
"""A command of each kind that writes a folder, without its --out."""
DESIGN = """schema = 1
case = "li-ma-2019"
set = { feed.blows = 2 }
goals = ["first.rigid_peak = 4000 g +- 5 %", "cv < 3 %"]
runs = 64
[vary]
machine.speed = "500..900 rpm"
machine.engagement = "3..6 mm"
"""
"""What is designed."""
PAGE, TABLE = Path(__file__).parents[2] / "docs/faults.md", "what was tried"
"""Where the table goes."""
LIMIT = 600.0
"""Seconds after which a command is taken to hang: a hundred times what the longest takes on a processor of its own."""
LINGER = 5.0
"""Seconds in which processes of a command may end after it."""
TEXTS, MARKS = (".csv", ".json", ".svg", ".k"), ("case.toml", "record.toml")
"""Files of a result in which a test makes a difference, and those by which results are told apart."""
NOISE = ("Traceback", "internal error", "Segmentation")
"""Words of a command that broke."""


@dataclass
class Setting:
    """How a command is run: its environment, limits of the system, and what happens to it on the way."""

    folder: Path
    environment: dict[str, str]
    out: Path
    limits: dict[int, int] = field(default_factory=dict)
    stdout: str = os.devnull
    closed: tuple[int, ...] = ()
    umask: int = 0o022
    signal: int = 0
    after: float = 0.0


@dataclass
class Outcome:
    """How a command ended: exit code, words, and processes that it left."""

    code: int
    words: str
    orphans: list[int]


def run(command: tuple[str, ...], setting: Setting, forked: bool = False) -> Outcome:
    """Run a command in a session of its own, and look for what is left of it.

    A forked one begins with the modules that this process has imported: so half its time, or less, goes into imports.
    """
    with tempfile.TemporaryFile("w+", errors="replace") as words:
        child = (fork if forked else start)(command, setting, words.fileno())
        if setting.signal:
            time.sleep(setting.after)
            os.kill(child, setting.signal)
        code, told = wait(child), ""
        if code is None:
            os.killpg(child, signal.SIGKILL)
            code, told = wait(child), "Traceback: it did not end"
        end = time.monotonic() + LINGER
        while (left := of_session(child)) and time.monotonic() < end:
            time.sleep(0.05)  # workers look after their parent now and then
        for process in left:
            with suppress(ProcessLookupError):
                os.kill(process, signal.SIGKILL)
        words.seek(0)
        return Outcome(-signal.SIGKILL if code is None else code, words.read() + told, left)


def wait(child: int) -> int | None:
    """Return the exit code of a child, or None where it hangs."""
    end = time.monotonic() + LIMIT
    while time.monotonic() < end:
        ended, status = os.waitpid(child, os.WNOHANG)
        if ended:
            return os.waitstatus_to_exitcode(status)
        time.sleep(0.01)
    return None


def start(command: tuple[str, ...], setting: Setting, words: int) -> int:
    """Start a command as a program of its own; return its process."""
    child = os.fork()
    if not child:
        enter(setting, words)
        line = [sys.executable, "-m", "strikewave", *command, "--out", str(setting.out)]
        os.execve(sys.executable, line, setting.environment)
    return child


def fork(command: tuple[str, ...], setting: Setting, words: int) -> int:
    """Start a command as a copy of this process; return it."""
    child = os.fork()
    if child:
        return child
    code: object = 1
    try:
        enter(setting, words)
        os.environ.clear()
        os.environ.update(setting.environment)
        for name, number in (("stdin", 0), ("stdout", 1), ("stderr", 2)):
            setattr(sys, name, open(number, "w" if number else "r", closefd=False))
        sys.argv = ["strikewave", *command, "--out", str(setting.out)]
        importlib.import_module("strikewave.cli.app").main()
    except SystemExit as end:
        code = end.code or 0
    except BaseException:
        traceback.print_exc()
    finally:
        with suppress(BaseException):  # what Python does at its end; this process must not run on as the campaign
            threading._shutdown()
            atexit._run_exitfuncs()
            sys.stdout.flush()
            sys.stderr.flush()
        os._exit(int(str(code)))


def enter(setting: Setting, words: int) -> None:
    """Make this process what a setting asks for."""
    os.setsid()
    os.chdir(setting.folder)
    os.umask(setting.umask)
    os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
    os.dup2(os.open(setting.stdout, os.O_WRONLY), 1)
    os.dup2(words, 2)
    for which, most in setting.limits.items():
        resource.setrlimit(which, (most, most))
    for number in setting.closed:
        os.close(number)


def import_what(command: tuple[str, ...], setting: Setting) -> None:
    """Import into this process all modules that a command imports."""
    program = "import atexit, sys; from strikewave.cli.app import main; "
    program += "atexit.register(lambda: print(*sys.modules, file=sys.stderr)); main()"
    line = [sys.executable, "-P", "-c", program, *command, "--out", str(setting.out)]
    done = subprocess.run(line, cwd=setting.folder, env=setting.environment, capture_output=True, text=True, check=True)
    for name in done.stderr.splitlines()[-1].split():
        with suppress(ImportError):
            importlib.import_module(name)


def of_session(session: int) -> list[int]:
    """Return the processes of a session that still run."""
    found = []
    for entry in Path("/proc").iterdir():
        if entry.name.isdecimal():
            with suppress(OSError):
                fields = (entry / "stat").read_text().rpartition(")")[2].split()
                if int(fields[3]) == session and fields[0] != "Z":
                    found.append(int(entry.name))
    return found


def state_of(folder: Path) -> dict[str, str]:
    """Return the SHA-256 of each file of a result, but of the page, which says when it was made."""
    if not folder.is_dir():
        return {}
    files = (path for path in sorted(folder.iterdir()) if path.name != "report.html")
    return {path.name: _state_of(path) for path in files}


def _state_of(path: Path) -> str:
    """Return the SHA-256 of a file: of that which marks the result without those of the others, the page among them."""
    if path.suffix == ".vtkhdf":
        return fields_of(path)
    return digest(mark_text(path).encode() if path.name in MARKS else path.read_bytes())


def digest(content: bytes) -> str:
    """Return a SHA-256."""
    return hashlib.sha256(content).hexdigest()


def fields_of(path: Path) -> str:
    """Return the SHA-256 of all numbers of a file of fields, which lie in other places where a run went on."""
    numbers: dict[str, bytes] = {}
    with h5py.File(path) as file:
        file.visititems(lambda name, item: numbers.update({name: item[()].tobytes()} if hasattr(item, "shape") else {}))
    return digest(b"".join(name.encode() + numbers[name] for name in sorted(numbers)))


@contextmanager
def small_disk(place: Path, size: int) -> Iterator[bool]:
    """Give a disk of so many bytes at a place, for root on Linux; tell whether there is one."""
    place.mkdir(exist_ok=True)
    done = subprocess.run(
        ["mount", "-t", "tmpfs", "-o", f"size={size}", "tmpfs", place], capture_output=True, check=False
    )
    try:
        yield done.returncode == 0
    finally:
        if done.returncode == 0:
            subprocess.run(["umount", "-l", place], check=True)


class Bench:
    """A folder in which commands are run: an older result of each, what it is when whole, and how long it takes."""

    def __init__(self, home: Path, seed: int = 0) -> None:
        self.home, self.chance = home, random.Random(seed)
        pulse = [(1e-5 * k, math.sin(math.pi * (k - 50) / 100.0) if 50 < k < 150 else 0.0) for k in range(400)]
        lines = [f"{time:.5f},{1000.0 * value:.6g}" for time, value in pulse]
        (home / "blow.csv").write_text("time [s],board [g]\n" + "\n".join(lines) + "\n")
        (home / "design.toml").write_text(DESIGN)
        self.environment = {**os.environ, "NUMBA_CACHE_DIR": os.environ.get("NUMBA_CACHE_DIR", "")}
        if not self.environment["NUMBA_CACHE_DIR"]:
            del self.environment["NUMBA_CACHE_DIR"]
        self.whole: dict[str, dict[str, str]] = {}
        self.seconds: dict[str, float] = {}

    def setting(self, name: str) -> Setting:
        """Return how a command is run where nothing befalls it."""
        return Setting(self.home, dict(self.environment), self.home / "results" / name)

    def prepare(self, name: str) -> None:
        """Find what a command gives, and how long a copy of this process takes for it."""
        if name not in self.whole:
            import_what(COMMANDS[name], self.setting(name))
            self.whole[name] = state_of(self.home / "results" / name)
            begun = time.monotonic()
            made = run(COMMANDS[name], self.setting(name), forked=True)
            self.seconds[name] = time.monotonic() - begun
            assert made.code == 0, made.words
            assert state_of(self.home / "results" / name) == self.whole[name], f"{name} gives other bits each time"

    def age(self, name: str) -> None:
        """Change the result of a command, so that it is told from a new one, and a mixture of both from either."""
        folder = self.home / "results" / name
        if folder.exists():
            oldest = next(path for path in sorted(folder.iterdir()) if path.suffix in TEXTS and path.name not in MARKS)
            oldest.write_text(oldest.read_text() + "\n")
            list_files(folder)

    def survives(self, name: str, fault: Fault) -> str:
        """Let a fault befall a command; return what was lost, or nothing."""
        self.prepare(name)
        self.age(name)
        setting = self.setting(name)
        with ExitStack() as stack:
            if not fault(self, stack, setting, name):
                return "not tried"
            before = state_of(setting.out)
            ended = run(COMMANDS[name], setting, forked=fault in IN_A_COPY)
            after = state_of(setting.out)
        if ended.orphans:
            return f"processes left: {len(ended.orphans)}"
        if any(word in ended.words for word in NOISE) or ended.code in (1, -signal.SIGSEGV, -signal.SIGABRT, 139):
            return f"broke ({ended.code}): {ended.words.strip().splitlines()[-1:]}"
        whole = self.whole[name]
        if setting.out != self.setting(name).out:  # a record names the command that made it, its folder too
            whole, before, after = dict.fromkeys(whole, ""), dict.fromkeys(before, ""), dict.fromkeys(after, "")
        if after not in (before, whole):
            return f"half a result: {sorted(after)}"
        if ended.code == 0 and after != whole:
            return "exit 0 without the result"
        if ended.code == 2 and len([line for line in ended.words.splitlines() if "allowed:" in line]) > 1:
            return "more than one line"
        return "" if ended.code == 0 and not self.hidden() else self.goes_on(name)

    def hidden(self) -> list[str]:
        """Return what stands beside the results."""
        return [path.name for path in (self.home / "results").iterdir() if path.name not in COMMANDS]

    def goes_on(self, name: str) -> str:
        """Run a command again where nothing befalls it; return what is wrong with its result, or nothing."""
        unfinished = self.home / "results" / f"{name}.unfinished"
        more = ("--restart",) if (unfinished / "state.h5").exists() else ()
        again = run((*COMMANDS[name], *more), self.setting(name), forked=True)
        if again.code != 0:
            return f"does not go on: {again.words.strip().splitlines()[-1:]}"
        if state_of(self.home / "results" / name) != self.whole[name]:
            return "other bits on the next run"
        return f"left behind: {self.hidden()}" if self.hidden() else ""


Fault = Callable[[Bench, ExitStack, Setting, str], bool]
"""Changes how a command is run; false where it cannot be tried here."""


def signalled(number: int) -> Fault:
    """Send a signal at a random moment of the run."""

    def fault(bench: Bench, stack: ExitStack, setting: Setting, name: str) -> bool:
        setting.signal, setting.after = number, bench.chance.uniform(0.02, 1.05) * bench.seconds[name]
        return True

    return fault


def limited(which: int, low: float, high: float) -> Fault:
    """Set a limit of the system, at random between two numbers in equal ratios."""

    def fault(bench: Bench, stack: ExitStack, setting: Setting, name: str) -> bool:
        setting.limits[which] = int(math.exp(bench.chance.uniform(math.log(low), math.log(high))))
        return True

    return fault


def without(variable: str, value: str | None) -> Fault:
    """Take a variable of the environment away, or give it a value that is of no use."""

    def fault(bench: Bench, stack: ExitStack, setting: Setting, name: str) -> bool:
        setting.environment.pop(variable, None)
        if value is not None:
            setting.environment[variable] = value
        return True

    return fault


def full_disk(bench: Bench, stack: ExitStack, setting: Setting, name: str) -> bool:
    """Write to a real disk of a few kilobytes to megabytes, which holds an older result where that fits."""
    size = int(math.exp(bench.chance.uniform(math.log(8e3), math.log(4e6))))
    place = bench.home / "disk"
    if not stack.enter_context(small_disk(place, size)):
        return False
    setting.out = place / name
    return True


def full_cache(bench: Bench, stack: ExitStack, setting: Setting, name: str) -> bool:
    """Keep compiled kernels on a disk that is full: `impact` compiles the fewest."""
    place = bench.home / "cache-disk"
    if name != "impact" or not stack.enter_context(small_disk(place, 40_000)):
        return False
    setting.environment["NUMBA_CACHE_DIR"] = str(place)
    return True


def damaged_cache(bench: Bench, stack: ExitStack, setting: Setting, name: str) -> bool:
    """Empty, cut, or change a bit in each file of the cache of compiled kernels."""
    if name != "impact":
        return False
    cache = bench.home / "cache"
    setting.environment["NUMBA_CACHE_DIR"] = str(cache)
    run(COMMANDS[name], setting)
    for path in cache.rglob("*.nb[ic]"):
        data = bytearray(path.read_bytes())
        place = bench.chance.randrange(len(data) or 1)
        how = bench.chance.randrange(3)
        if how == 2 and data:
            data[place] ^= 1 << bench.chance.randrange(8)
        path.write_bytes((b"", data[:place], data)[how])
    return True


def read_only(bench: Bench, stack: ExitStack, setting: Setting, name: str) -> bool:
    """Write to a disk that is mounted to be read only."""
    place = bench.home / "disk"
    if not stack.enter_context(small_disk(place, 1_000_000)):
        return False
    setting.out = place / "deeper" / name
    return subprocess.run(["mount", "-o", "remount,ro", place], capture_output=True, check=False).returncode == 0


def closed_stdout(bench: Bench, stack: ExitStack, setting: Setting, name: str) -> bool:
    """Close stdout before the command begins."""
    setting.closed = (1,)
    return True


def closed_streams(bench: Bench, stack: ExitStack, setting: Setting, name: str) -> bool:
    """Close stdin, stdout and stderr before the command begins."""
    setting.closed = (0, 1, 2)
    return True


def nobody_reads(bench: Bench, stack: ExitStack, setting: Setting, name: str) -> bool:
    """Let the files be readable by nobody."""
    setting.umask = 0o777
    return os.geteuid() == 0


def settings_beside(bench: Bench, stack: ExitStack, setting: Setting, name: str) -> bool:
    """Put settings of libraries, which these take from where they are started, beside the data."""
    for file, text in SETTINGS.items():
        (bench.home / file).write_text(text)
        stack.callback((bench.home / file).unlink)
    return True


def full_stdout(bench: Bench, stack: ExitStack, setting: Setting, name: str) -> bool:
    """Let stdout be a disk without room; the result is written by then."""
    setting.stdout = "/dev/full"
    return Path("/dev/full").exists()


SETTINGS = {
    "matplotlibrc": "lines.linewidth: 20\nsavefig.dpi: 10\naxes.facecolor: black\n",
    "sitecustomize.py": "raise SystemExit('sitecustomize was executed')\n",
}
"""Files of settings by name."""
BY_CHANCE: dict[str, Fault] = {
    "kill -9 at a random moment": signalled(signal.SIGKILL),
    "SIGTERM at a random moment": signalled(signal.SIGTERM),
    "Ctrl-C at a random moment": signalled(signal.SIGINT),
    "SIGHUP at a random moment": signalled(signal.SIGHUP),
    "a real disk that is full": full_disk,
    "files limited to a few kB": limited(resource.RLIMIT_FSIZE, 1e3, 4e6),
}
"""Faults whose moment or size is drawn."""
IN_A_COPY = frozenset(BY_CHANCE.values())
"""What befalls a command once it runs; everything else befalls it as it starts."""
AT_START: dict[str, Fault] = {
    "a disk to be read only": read_only,
    "few file handles": limited(resource.RLIMIT_NOFILE, 8, 64),
    "1 GB of address space": limited(resource.RLIMIT_AS, 1e9, 1.001e9),
    "no HOME": without("HOME", None),
    "a HOME that is not there": without("HOME", "/nowhere"),
    "a TMPDIR that is not there": without("TMPDIR", "/nowhere"),
    "no PATH": without("PATH", None),
    "stdout in ASCII": without("PYTHONIOENCODING", "ascii"),
    "stdout in code page 437": without("PYTHONIOENCODING", "cp437"),
    "stdout in code page 932": without("PYTHONIOENCODING", "cp932"),
    "LC_ALL=C": without("LC_ALL", "C"),
    "COLUMNS=0": without("COLUMNS", "0"),
    "stdout closed": closed_stdout,
    "all streams closed": closed_streams,
    "stdout on a full disk": full_stdout,
    "files that nobody may read": nobody_reads,
    "settings of libraries beside the data": settings_beside,
    "compiled kernels damaged": damaged_cache,
    "compiled kernels on a full disk": full_cache,
}
"""Faults that a command finds as it starts."""
FAULTS = {**BY_CHANCE, **AT_START}
KINDS = {"chance": BY_CHANCE, "start": AT_START}


def read_rows(text: str) -> list[tuple[str, str, str]]:
    """Return fault, command and fate of the rows of a run; other lines are left out."""
    rows = (tuple(line.split(" | ", 2)) for line in text.splitlines())
    return [(row[0], row[1], row[2]) for row in rows if len(row) == 3 and row[0] in FAULTS]


def table_of(rows: list[tuple[str, str, str]]) -> tuple[str, int]:
    """Return the table of what was tried and what survived, and how many did not."""
    sys.path.append(str(Path(__file__).parents[2] / "scripts/validate"))
    from kit import table

    fates = {words: [fate for fault, _, fate in rows if fault == words] for words in FAULTS}
    counts = [(words, len(seen), seen.count("survived")) for words, seen in fates.items() if seen]
    tried, survived = (sum(column) for column in zip(*(count[1:] for count in counts), strict=True))
    counts.append(("all", tried, survived))
    return table(("Fault", "tried", "survived"), [[str(cell) for cell in count] for count in counts]), tried - survived


def main() -> int:
    """Make the faults and print the table; return how many were not survived."""
    parser = argparse.ArgumentParser(description="faults that befall commands")
    parser.add_argument("commands", nargs="*", choices=[[], *COMMANDS], metavar="COMMAND")
    parser.add_argument("--rounds", type=int, default=1, help="of faults by chance")
    parser.add_argument("--only", action="append", choices=[*KINDS, *FAULTS], help="one, or a kind; repeatable")
    parser.add_argument("--rows", type=Path, default=Path(os.devnull), help="file of rows, gone on with")
    parser.add_argument("--write", action="store_true", help="the table into docs/faults.md")
    asked = parser.parse_args()
    signal.signal(signal.SIGINT, signal.default_int_handler)  # shells and nohup let jobs in the background ignore them,
    signal.signal(signal.SIGHUP, signal.SIG_DFL)  # and commands would inherit that
    home = Path(tempfile.mkdtemp(prefix="strikewave-faults-"))
    chosen = [fault for words in asked.only or FAULTS for fault in KINDS.get(words, (words,))]
    rows = read_rows(asked.rows.read_text()) if asked.rows.exists() else []
    try:
        bench = Bench(home, seed=len(rows))
        for k, words, name in product(range(asked.rounds), chosen, asked.commands or COMMANDS):
            if words not in BY_CHANCE and (k > 0 or (words, name) in {row[:2] for row in rows}):
                continue
            fate = bench.survives(name, FAULTS[words]) or "survived"
            print(f"{words} | {name} | {fate}", flush=True)
            if fate != "not tried":
                rows.append((words, name, fate))
                with asked.rows.open("a") as file:
                    file.write(" | ".join(rows[-1]) + "\n")
    except KeyboardInterrupt:
        print("stopped: the table has what was tried")
    finally:
        shutil.rmtree(home, ignore_errors=True)
    text, lost = table_of(rows)
    print(text)
    if asked.write:
        from kit import write_into

        write_into(PAGE, TABLE, text)
    return lost


if __name__ == "__main__":
    sys.exit(bool(main()))
