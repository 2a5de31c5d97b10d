"""``python -m strikewave`` is the command line."""

import os.path
import sys

# The folder it is run in, which `python -m` puts first, holds data: no module is taken from there. Python has imported
# these two before.
if not sys.flags.safe_path and sys.path[0] != os.path.dirname(os.path.dirname(os.path.abspath(__file__))):
    del sys.path[0]

from strikewave.cli.app import main

main()
