"""Arguments -> options of the command. Ranges and choices are checked by the command's own table, in C++."""

from __future__ import annotations

import numbers
import os
from typing import Any, Iterable

from .errors import UsageError

__all__ = ["Given", "given"]

Given = list[tuple[str, str]]

_BY_X = {"spacing", "size"}  # 0.9x0.9x1.5; other lists take commas
_RANGES = {"levels", "steps"}
_SEVERAL = {"fine", "add", "cut"}  # an option for each of them
_RENAMED = {"step_axes": "axes"}  # axes is the order of an array's indices


def _number(name: str, value: Any) -> str:
    if isinstance(value, numbers.Integral):
        return str(int(value))
    if isinstance(value, numbers.Real):
        return repr(float(value))
    if isinstance(value, str):
        return value
    raise UsageError(f"{_option(name)}: {value!r} is a {type(value).__name__}; expected a number or a text")


def _option(name: str) -> str:
    return "--" + _RENAMED.get(name, name).replace("_", "-")


def _range(name: str, value: Any) -> str:
    if isinstance(value, range):
        if value.step != 1 or len(value) == 0:
            raise UsageError(f"{_option(name)}: {value} is empty or leaves some out; give a range of step 1")
        return f"{value.start}..{value.stop - 1}"
    if isinstance(value, slice):
        raise UsageError(f"{_option(name)}: is no slice; give (first, last), both included, or a range")
    if isinstance(value, tuple):
        if len(value) != 2:
            raise UsageError(f"{_option(name)}: {value} has {len(value)} numbers; expected (first, last)")
        first, last = value
        return f"{'' if first is None else _number(name, first)}..{'' if last is None else _number(name, last)}"
    if isinstance(value, list):
        whole = value and all(isinstance(number, numbers.Integral) for number in value)
        if not whole or value != list(range(value[0], value[0] + len(value))):
            raise UsageError(f"{_option(name)}: {value} leaves some out; give (first, last), both included, or all of them in order")
        return f"{value[0]}..{value[-1]}"
    return _number(name, value)


def _text(name: str, value: Any) -> str:
    if name in _RANGES:
        return _range(name, value)
    if isinstance(value, str) or isinstance(value, numbers.Number):
        return _number(name, value)
    if isinstance(value, Iterable):
        return ("x" if name in _BY_X else ",").join(_number(name, v) for v in value)
    return _number(name, value)


def given(**arguments: Any) -> Given:
    """The arguments that were given, as options and their values.

    >>> given(voxels=256, hold=None, open_border=True, invert=False, levels=range(0, 3), triangles=[20000, 5000])
    [('--voxels', '256'), ('--open-border', ''), ('--levels', '0..2'), ('--triangles', '20000,5000')]
    """
    options: Given = []
    for name, value in arguments.items():
        if value is None or value is False:
            continue
        if name in _SEVERAL:
            one = isinstance(value, (str, os.PathLike))
            options += [(_option(name), os.fspath(v)) for v in ([value] if one else value)]
            continue
        options.append((_option(name), "" if value is True else _text(name, value)))
    return options
