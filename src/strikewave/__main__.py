"""``python -m strikewave`` is the command line."""

import sys
from pathlib import Path

if not sys.flags.safe_path and Path(sys.path[0]) != Path(__file__).parents[1]:
    del sys.path[0]  # the folder it is run in, which `python -m` puts first, holds data: no module is taken from there

from strikewave.cli.app import main

main()
