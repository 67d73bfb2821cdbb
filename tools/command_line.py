"""How the tools in Python end: faults of the user become one line on standard error and an exit status."""
import pathlib
import sys


class InputError(Exception):
    """The user's file or command is wrong; the text is one complete line."""


def run(main, arguments):
    """Exit status of main(arguments): its own, 2 after an InputError, 3 where the system refuses a file."""
    try:
        return main(arguments)
    except InputError as fault:
        print(fault, file=sys.stderr)
        return 2
    except OSError as fault:
        print(f"{pathlib.Path(main.__code__.co_filename).name}: error: {fault}", file=sys.stderr)
        return 3
