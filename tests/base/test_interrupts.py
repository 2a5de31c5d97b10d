"""An interrupt ends a program, wherever it comes."""

import subprocess
import sys

import pytest

PROGRAM = """
import signal, sys, time
from strikewave.base.interrupts import exit_code, heed

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
