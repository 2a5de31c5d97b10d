"""The peers that strikewave is timed beside: which can be run here, in which version, and what is told of one that cannot.

``make bench`` installs those of benchmarks/requirements.txt; CalculiX is a program that the system brings.
"""

import functools
import importlib
import importlib.metadata
import importlib.util

import calculix

MODULES = {
    "scipy": "scipy.integrate",
    "pyyeti": "pyyeti.srs",
    "endaq": "endaq.calc.shock",
    "elwaspatid": "elwaspatid",
    "exudyn": "exudyn",
    "mujoco": "mujoco",
    "streamlit": "streamlit",
    "dash": "dash",
}
"""What is run of each peer."""


@functools.cache
def absent(peer):
    """Say why a peer cannot be run; return None where it can."""
    if importlib.util.find_spec(peer) is None:
        return "not installed"
    try:
        importlib.import_module(MODULES[peer])
    except Exception as error:  # a broken installation of a peer must not end the run
        return f"does not load ({type(error).__name__})"
    return None


def version(peer):
    """Return the version of a peer that is installed."""
    return importlib.metadata.version(peer)


def rows():
    """Return each peer with its version, or why it was not run."""
    found = [(peer, absent(peer) or version(peer)) for peer in MODULES]
    return [*found, ("CalculiX", calculix.version() or calculix.HOW_TO_GET)]


if __name__ == "__main__":
    for row in rows():
        print(*row, sep=": ")
