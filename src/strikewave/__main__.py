"""``python -m strikewave`` is the command line."""

from strikewave.cli.app import main

main()
