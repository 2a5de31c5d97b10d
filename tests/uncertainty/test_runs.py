"""A copy of the process that computes beside it: its answer, its failures, and that nothing of it is left."""

import os
import subprocess
import sys
import threading

import pytest

from strikewave import load_case
from strikewave.analyses.machine.band import fast_runs, machine_bands
from strikewave.analyses.machine.run import run_case
from strikewave.uncertainty.runs import computed_beside

HEAD = "import os, time\nfrom strikewave.uncertainty.runs import computed_beside\n"
LEFT = "try:\n    os.waitpid(-1, os.WNOHANG)\n    print('left')\nexcept ChildProcessError:\n    print('none left')\n"


def _run(program, environment):
    command = [sys.executable, "-c", HEAD + program + LEFT]
    buffered = {**environment, "PYTHONUNBUFFERED": ""}
    return subprocess.run(command, env=buffered, capture_output=True, text=True, check=True)


@pytest.mark.skipif(sys.platform != "linux", reason="copies are made on Linux alone")
@pytest.mark.parametrize(
    ("function", "said"),
    [
        ("lambda: list(range(100_000))", "100000"),  # more than a pipe holds
        ("lambda: 1 / 0", "nothing"),
        ("lambda: os._exit(1)", "nothing"),
    ],
)
def test_answer_of_a_copy_or_nothing_and_no_process_left(environment, function, said):
    """A copy that fails, or ends before its time, gives nothing and says nothing; what was not flushed stays single."""
    program = (
        "os.sched_getaffinity = lambda process: {0, 1}\n"
        "print('once', end=' ')\n"
        f"with computed_beside({function}) as result:\n"
        "    found = result()\n"
        "print('nothing' if found is None else len(found))\n"
    )
    done = _run(program, environment)
    assert done.stdout.split("\n")[:2] == [f"once {said}", "none left"]
    assert done.stderr == ""


@pytest.mark.skipif(sys.platform != "linux", reason="copies are made on Linux alone")
def test_copy_ends_with_a_block_that_fails(environment):
    program = (
        "os.sched_getaffinity = lambda process: {0, 1}\n"
        "begun = time.monotonic()\n"
        "try:\n"
        "    with computed_beside(lambda: time.sleep(60)) as result:\n"
        "        raise KeyboardInterrupt\n"
        "except KeyboardInterrupt:\n"
        "    print('early' if time.monotonic() - begun < 50 else 'late')\n"
    )
    assert _run(program, environment).stdout.split("\n")[:2] == ["early", "none left"]


def test_no_copy_of_a_process_with_threads(environment):
    """Locks that another thread holds would stay locked in the copy."""
    program = (
        "import threading\n"
        "os.sched_getaffinity = lambda process: {0, 1}\n"
        "threading.Thread(target=time.sleep, args=(1,), daemon=True).start()\n"
        "with computed_beside(lambda: 1) as result:\n"
        "    print(result())\n"
    )
    assert _run(program, environment).stdout.split("\n")[:2] == ["None", "none left"]


@pytest.mark.skipif(sys.platform != "linux", reason="copies are made on Linux alone")
@pytest.mark.parametrize(
    ("processors", "threads", "platform", "copied"),
    [
        (2, 1, "linux", True),
        (3, 1, "linux", True),
        (1, 1, "linux", False),
        (2, 2, "linux", False),
        (2, 1, "darwin", False),
    ],
)
def test_a_copy_is_made_on_linux_with_another_processor_and_no_other_thread(
    monkeypatch, processors, threads, platform, copied
):
    """It answers with a number of its own process, and has ended with the block."""
    asked = []
    monkeypatch.setattr(os, "sched_getaffinity", lambda process: asked.append(process) or set(range(processors)))
    monkeypatch.setattr(threading, "active_count", lambda: threads)
    monkeypatch.setattr(sys, "platform", platform)
    with computed_beside(lambda: (os.getpid(), "all")) as result:
        found = result()
    assert (found is not None) is copied
    assert asked == ([0] if platform == "linux" else [])  # of this process
    if found is not None:
        assert found[0] != os.getpid()
        assert found[1] == "all"
        with pytest.raises(ProcessLookupError):
            os.kill(found[0], 0)


@pytest.mark.verify
def test_bands_of_runs_at_hand_are_those_of_runs_made_on_the_way():
    case = load_case("li-ma-2019", ["feed.blows=2"])
    solution = run_case(case)
    with computed_beside(lambda: fast_runs(case)) as runs:
        found = machine_bands(case, solution.blows, solution.readings, runs=runs())
    assert found == machine_bands(case, solution.blows, solution.readings)
