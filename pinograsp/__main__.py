"""The command line as `python -m pinograsp`."""

from .cli import main

main()
