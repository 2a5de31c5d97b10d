"""Faults that befall commands that write: a kill, a full disk, a folder that cannot be written, a damaged cache ...

    python tests/faults/campaign.py [ROUNDS [COMMAND ...]]

makes each fault ROUNDS times (1) to each command, or to those that are named, with real processes, limits of the system and, for root, a real small disk, and
prints a table of what was tried and what survived. `survives` is the judge; the tests call it too.
"""

from __future__ import annotations

import hashlib
import math
import os
import random
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass, field
from pathlib import Path

import h5py

IMPACT = ("impact", "--stiffness", "4.7e9", "--exponent", "1.5", "-e", "0.5", "--m1", "1", "--m2", "2", "--speed", "1")
COMMANDS: dict[str, tuple[str, ...]] = {
    "impact": IMPACT,
    "run": ("run", "li-ma-2019", "--no-band", "--set", "feed.blows=2"),
    "wave": ("wave", "li-ma-2019-fig13-bar", "--no-band"),
    "record": ("record", "blow.csv"),
    "srs": ("srs", "blow.csv", "--per-octave", "3"),
    "compare": ("compare", "blow.csv", "blow.csv"),
    "fem": ("fem", "two-bars-fem", "--set", "fem.duration=8 us", "--set", "fem.frames=3"),
}
"""A command of each kind that writes a folder, without its --out."""
LIMIT = 120.0
"""Seconds after which a command is taken to hang: fifty times what the longest takes."""
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
    closed: bool = False
    signal: int = 0
    after: float = 0.0


@dataclass
class Outcome:
    """How a command ended: exit code, words, and processes that it left."""

    code: int
    words: str
    orphans: list[int]


def run(command: tuple[str, ...], setting: Setting) -> Outcome:
    """Run a command in a session of its own, and look for what is left of it."""

    def limit() -> None:
        for which, most in setting.limits.items():
            resource.setrlimit(which, (most, most))
        if setting.closed:
            os.close(1)

    with open(setting.stdout, "w") as stdout:
        child = subprocess.Popen(
            [sys.executable, "-m", "strikewave", *command, "--out", str(setting.out)],
            cwd=setting.folder,
            env=setting.environment,
            stdin=subprocess.DEVNULL,
            stdout=stdout,
            stderr=subprocess.PIPE,
            start_new_session=True,
            preexec_fn=limit,  # noqa: PLW1509 (one thread)
            text=True,
            errors="replace",
        )
    if setting.signal:
        time.sleep(setting.after)
        child.send_signal(setting.signal)
    try:
        _, words = child.communicate(timeout=LIMIT)
    except subprocess.TimeoutExpired:
        os.killpg(child.pid, signal.SIGKILL)
        _, words = child.communicate()
        words += "\nTraceback: it did not end"
    end = time.monotonic() + 5.0
    while (left := of_session(child.pid)) and time.monotonic() < end:
        time.sleep(0.05)  # workers look after their parent now and then
    for process in left:
        with suppress(ProcessLookupError):
            os.kill(process, signal.SIGKILL)
    return Outcome(child.returncode, words, left)


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
    return {path.name: fields_of(path) if path.suffix == ".vtkhdf" else digest(path.read_bytes()) for path in files}


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
        self.environment = {**os.environ, "NUMBA_CACHE_DIR": os.environ.get("NUMBA_CACHE_DIR", "")}
        if not self.environment["NUMBA_CACHE_DIR"]:
            del self.environment["NUMBA_CACHE_DIR"]
        self.whole: dict[str, dict[str, str]] = {}
        self.seconds: dict[str, float] = {}

    def setting(self, name: str) -> Setting:
        """Return how a command is run where nothing befalls it."""
        return Setting(self.home, dict(self.environment), self.home / "results" / name)

    def prepare(self, name: str) -> None:
        """Make the older result of a command."""
        if name not in self.whole:
            begun = time.monotonic()
            made = run(COMMANDS[name], self.setting(name))
            assert made.code in (0, 3), made.words
            self.seconds[name] = time.monotonic() - begun
            self.whole[name] = state_of(self.home / "results" / name)

    def survives(self, name: str, fault: Fault) -> str:
        """Let a fault befall a command; return what was lost, or nothing."""
        self.prepare(name)
        setting = self.setting(name)
        with ExitStack() as stack:
            if not fault(self, stack, setting, name):
                return "not tried"
            before = state_of(setting.out)
            ended = run(COMMANDS[name], setting)
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
        if ended.code in (0, 3) and after != whole:
            return "exit 0 without the result"
        if ended.code == 2 and len([line for line in ended.words.splitlines() if "allowed:" in line]) > 1:
            return "more than one line"
        return self.goes_on(name)

    def goes_on(self, name: str) -> str:
        """Run a command again where nothing befalls it; return what is wrong with its result, or nothing."""
        unfinished = self.home / "results" / f"{name}.unfinished"
        more = ("--restart",) if (unfinished / "state.h5").exists() else ()
        again = run((*COMMANDS[name], *more), self.setting(name))
        if again.code not in (0, 3):
            return f"does not go on: {again.words.strip().splitlines()[-1:]}"
        if state_of(self.home / "results" / name) != self.whole[name]:
            return "other bits on the next run"
        hidden = [path.name for path in (self.home / "results").iterdir() if path.name not in COMMANDS]
        return f"left behind: {hidden}" if hidden else ""


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
    setting.closed = True
    return True


def full_stdout(bench: Bench, stack: ExitStack, setting: Setting, name: str) -> bool:
    """Let stdout be a disk without room; the result is written by then."""
    setting.stdout = "/dev/full"
    return Path("/dev/full").exists()


FAULTS: dict[str, Fault] = {
    "kill -9 at a random moment": signalled(signal.SIGKILL),
    "SIGTERM at a random moment": signalled(signal.SIGTERM),
    "Ctrl-C at a random moment": signalled(signal.SIGINT),
    "SIGHUP at a random moment": signalled(signal.SIGHUP),
    "a real disk that is full": full_disk,
    "files limited to a few kB": limited(resource.RLIMIT_FSIZE, 1e3, 4e6),
    "a disk to be read only": read_only,
    "few file handles": limited(resource.RLIMIT_NOFILE, 8, 64),
    "1 GB of address space": limited(resource.RLIMIT_AS, 1e9, 1.001e9),
    "no HOME": without("HOME", None),
    "a HOME that is not there": without("HOME", "/nowhere"),
    "a TMPDIR that is not there": without("TMPDIR", "/nowhere"),
    "another locale, stdout in ASCII": without("PYTHONIOENCODING", "ascii"),
    "LC_ALL=C": without("LC_ALL", "C"),
    "COLUMNS=0": without("COLUMNS", "0"),
    "stdout closed": closed_stdout,
    "stdout on a full disk": full_stdout,
    "compiled kernels damaged": damaged_cache,
    "compiled kernels on a full disk": full_cache,
}


def main(rounds: int = 1, *commands: str) -> int:
    """Make all faults and print the table; return how many were not survived."""
    home = Path(tempfile.mkdtemp(prefix="strikewave-faults-"))
    lost, rows, tried = [], [], 0
    try:
        bench = Bench(home, seed=rounds)
        for words, fault in FAULTS.items():
            seen = [(name, bench.survives(name, fault)) for name in commands or COMMANDS for _ in range(rounds)]
            seen = [one for one in seen if one[1] != "not tried"]
            bad = [f"{name}: {what}" for name, what in seen if what]
            rows.append(f"| {words} | {len(seen)} | {len(seen) - len(bad)} |")
            print(rows[-1], *bad, sep="\n    ", flush=True)
            lost += bad
            tried += len(seen)
    finally:
        shutil.rmtree(home, ignore_errors=True)
    print("\n| fault | tried | survived |\n|---|---|---|", *rows, f"| all | {tried} | {tried - len(lost)} |", sep="\n")
    return len(lost)


if __name__ == "__main__":
    sys.exit(bool(main(int(sys.argv[1]) if sys.argv[1:] else 1, *sys.argv[2:])))
