"""What goes wrong, each with the one line that the command prints.

Messages name options as the command spells them: ``--close-holes`` is the argument ``close_holes``.
"""

__all__ = ["Error", "InputError", "OperationError", "UsageError"]


class Error(Exception):
    """What all errors of isowave are.

    >>> issubclass(InputError, Error) and issubclass(InputError, ValueError)
    True
    """


class UsageError(Error, ValueError):
    """Arguments contradict each other, or do not suit the input (the command's exit code 2)."""


class InputError(Error, ValueError):
    """The data is not what it must be: object, place, what was found, what was expected, what to do (exit code 3)."""


class OperationError(Error, RuntimeError):
    """The data was fine, the world was not: a disk is full, a file cannot be written (exit code 1)."""
