"""The command line, as `pinograsp` and as `python -m pinograsp`."""

from .asked import end_when_asked


def main() -> None:
    """Run the command line and end the process; from here on Ctrl-C and SIGTERM give one line, and no traceback."""
    end_when_asked()
    from .cli import main as run

    run()


if __name__ == "__main__":  # worker processes import this module under another name
    main()
