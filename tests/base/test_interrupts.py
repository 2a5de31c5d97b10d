"""An interrupt ends a program, wherever it comes."""

import os
import subprocess
import sys

import pytest

PROGRAM = """
import signal, sys, time
from strikewave.base.processes import exit_code, heed

class Struck:
    def __del__(self):
        signal.raise_signal(signal.{name})
        for _ in range(1000):
            pass

heed()
try:
    struck = Struck()
    del struck
    time.sleep(30.0)
except KeyboardInterrupt as stop:
    sys.exit(exit_code(stop))
"""


@pytest.mark.parametrize(("name", "code"), [("SIGINT", 130), ("SIGTERM", 143)])
def test_an_interrupt_in_a_destructor_is_not_lost(name, code):
    """Python prints what a destructor raises, and goes on."""
    words = [sys.executable, "-c", PROGRAM.format(name=name)]
    ended = subprocess.run(words, capture_output=True, text=True, timeout=25.0, check=False)
    assert (ended.returncode, ended.stderr) == (code, "")


IMPORTING = """
import signal, sys, time
from strikewave.base.processes import heed

heed()
try:
    import half
    time.sleep(30.0)
except KeyboardInterrupt:
    sys.exit(0 if sys.modules["half"].whole else 1)
"""


def test_an_interrupt_waits_until_a_module_is_imported(tmp_path):
    """Modules in C fail in ways of their own, or write where they must not, if they are left half imported."""
    body = "import signal, time\nwhole = False\nsignal.raise_signal(signal.SIGINT)\ntime.sleep(0.1)\nwhole = True\n"
    (tmp_path / "half.py").write_text(body)
    words = [sys.executable, "-c", IMPORTING]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(tmp_path), *filter(None, sys.path)])}
    ended = subprocess.run(words, env=environment, capture_output=True, text=True, timeout=25.0, check=False)
    assert (ended.returncode, ended.stderr) == (0, "")


MANGLED = """
import signal, sys
from strikewave.base.processes import exit_code, heed, interrupts_as_such

heed()
try:
    with interrupts_as_such():
        if {struck}:
            try:
                signal.raise_signal(signal.SIGTERM)
            except KeyboardInterrupt:
                raise ValueError("what a library made of it") from None
        raise ValueError("of its own")
except KeyboardInterrupt as stop:
    sys.exit(exit_code(stop))
except ValueError as error:
    sys.exit(str(error))
"""


@pytest.mark.parametrize(("struck", "ends"), [(True, (143, "")), (False, (1, "of its own\n"))])
def test_an_interrupt_of_which_a_library_made_an_error_is_one(struck, ends):
    """A serializer in C raises an error of its own where its callback is interrupted."""
    words = [sys.executable, "-c", MANGLED.format(struck=struck)]
    ended = subprocess.run(words, capture_output=True, text=True, timeout=25.0, check=False)
    assert (ended.returncode, ended.stderr) == ends
