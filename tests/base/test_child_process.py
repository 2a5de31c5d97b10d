"""Processes that are started run nothing from the folder of the data, and end with the one that started them."""

import os
import signal
import subprocess
import sys

import h5py
import numpy as np
import pytest

PLANTED = ("h5py", "json", "multiprocessing", "numpy", "pickle", "queue", "selectors", "signal", "struct", "typing")
"""Modules that a child imports."""


@pytest.fixture
def run(tmp_path):
    """Run a program, as a script of another folder, where modules are planted that do what nobody asked for."""
    data, home = tmp_path / "data", tmp_path / "home"
    data.mkdir()
    home.mkdir()

    def call(program):
        for name in PLANTED:
            (data / f"{name}.py").write_text(f"open({str(tmp_path / 'executed')!r}, 'a').write('{name} ')\n")
        (home / "program.py").write_text(program)
        command = [sys.executable, str(home / "program.py")]
        environment = {key: value for key, value in os.environ.items() if key != "PYTHONSAFEPATH"}
        done = subprocess.run(
            command, cwd=data, env=environment, capture_output=True, text=True, timeout=120.0, check=False
        )
        executed = tmp_path / "executed"
        return done.stdout.strip(), done.stderr, executed.read_text() if executed.exists() else ""

    call.data = data
    return call


def test_a_reader_in_a_child_takes_no_module_from_beside_the_file(run):
    with h5py.File(run.data / "shot.h5", "w") as file:
        file["time"] = np.arange(100) * 1e-6
        file["acceleration"] = np.arange(100.0)
    read = "from strikewave import read_record; print(read_record('shot.h5').channels[0].values[-1])"
    assert run(read)[0] == "99.0"
    assert run(read)[2] == ""


WORK = """
import os, sys, time
os.cpu_count = lambda: 2
from strikewave.base.processes import exit_code, heed
from strikewave.studies.engine.pools import ProcessPool

def tell(what):
    os.write(1, b"%d\\n" % what)
    time.sleep(600.0 if what > 2 else 0.0)
    return what

if __name__ == "__main__":
    heed()
    try:
        with ProcessPool(2) as workers:
            print([future.result() for future in [workers.submit(tell, int(what)) for what in sys.argv[1:] or ("1", "2")]])
    except KeyboardInterrupt as stop:
        sys.exit(exit_code(stop))
"""


def test_workers_take_no_module_from_the_folder_they_run_in(run):
    out, err, executed = run(WORK)
    assert out.endswith("[1, 2]"), err
    assert executed == ""


@pytest.mark.skipif(os.name == "nt", reason="signals of POSIX")
@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGTERM, signal.SIGHUP])
def test_no_worker_outlives_its_parent(tmp_path, number):
    """Workers asleep for minutes hold the pipe that is read here to its end. A signal that can be heeded gives the
    exit code of shells, 128 and its number."""
    (tmp_path / "program.py").write_text(WORK)
    command = [sys.executable, tmp_path / "program.py", "3", "4"]
    parent = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    assert {parent.stdout.readline(), parent.stdout.readline()} == {"3\n", "4\n"}
    parent.send_signal(number)
    assert parent.communicate(timeout=60.0) == ("", None)
    assert parent.returncode == (-number if number == signal.SIGKILL else 128 + number)


@pytest.mark.skipif(sys.platform != "linux", reason="copies of a process are made on Linux alone")
def test_no_copy_outlives_the_process_it_is_of():
    program = (
        "import os, time; from strikewave.uncertainty.runs import computed_beside\n"
        "os.sched_getaffinity = lambda process: {0, 1}\n"
        "with computed_beside(lambda: os.write(1, b'copied\\n') and time.sleep(600.0)):\n"
        "    time.sleep(600.0)\n"
    )
    parent = subprocess.Popen([sys.executable, "-c", program], stdout=subprocess.PIPE, text=True)
    assert parent.stdout.readline() == "copied\n"
    parent.kill()
    assert parent.communicate(timeout=60.0) == ("", None)
