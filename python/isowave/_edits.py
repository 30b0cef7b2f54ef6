"""Edits of a pyramid: what Python gives -> what the command's table and the library take."""

from __future__ import annotations

import numbers
import os
from collections.abc import Iterator
from typing import Any, Callable, Optional, Union

import numpy as np

from . import _native
from ._meshes import is_mesh, triangles_of
from ._options import given
from .errors import InputError, UsageError

__all__ = ["Move", "Tool", "edits_of", "listed"]

#: "ball:X,Y,Z,R", "X,Y,Z:X,Y,Z", (centre, radius), (low, high), a path, a mesh.
Tool = Any
Move = tuple[Any, Any]

_TOOLS = (
    "expected a text (ball:X,Y,Z,R, X,Y,Z:X,Y,Z, a file's name), (centre, radius), (low, high), a path or a mesh; "
    "a list holds several"
)


def listed(value: Any) -> list[Any]:
    """Nothing, one, or a list of several.

    >>> listed(None), listed("ball:0,0,0,1"), listed([1, 2])
    ([], ['ball:0,0,0,1'], [1, 2])
    """
    if value is None:
        return []
    return value if isinstance(value, list) else [value]


def _numbers(value: Any) -> Optional[list[float]]:
    """Three numbers; None for all else."""
    if isinstance(value, (str, bytes)) or np.ndim(value) != 1 or len(value) != 3:
        return None
    if not all(isinstance(number, numbers.Real) for number in value):
        return None
    return [float(number) for number in value]


def _point(value: Any) -> Optional[str]:
    """
    >>> _point((1, 2.5, 0)), _point((1, 2))
    ('1.0,2.5,0.0', None)
    """
    three = _numbers(value)
    return None if three is None else ",".join(map(repr, three))


def _pair(value: Any) -> Optional[tuple[Any, Any]]:
    if isinstance(value, np.ndarray) or isinstance(value, (tuple, list)):
        return (value[0], value[1]) if len(value) == 2 else None
    return None


def _ball_or_box(value: Any) -> Optional[str]:
    """What the command calls it; None for what is neither.

    >>> _ball_or_box(((1, 2, 3), 4)), _ball_or_box(((0, 0, 0), (1, 1, 1))), _ball_or_box("part.stl")
    ('ball:1.0,2.0,3.0,4.0', '0.0,0.0,0.0:1.0,1.0,1.0', None)
    """
    pair = _pair(value)
    first = _point(pair[0]) if pair else None
    if pair is None or first is None:
        return None
    if isinstance(pair[1], numbers.Real):
        return f"ball:{first},{float(pair[1])!r}"
    second = _point(pair[1])
    return None if second is None else f"{first}:{second}"


def _take_tool(option: Callable[[str], None], file: Callable[[str], None], mesh: Callable[[Any, Any], None],
               name: str, tool: Tool) -> None:  # fmt: skip
    text = tool if isinstance(tool, str) else _ball_or_box(tool)
    if text is not None:
        option(text)
    elif isinstance(tool, os.PathLike):
        file(os.fspath(tool))
    elif is_mesh(tool):
        try:
            mesh(*triangles_of(tool))
        except InputError as error:
            raise InputError(f"{name}: {error}") from None
    else:
        raise UsageError(f"{name}: {tool!r} is no tool; {_TOOLS}")


def _texts_of_move(move: Any) -> Iterator[tuple[str, str]]:
    pair = None if isinstance(move, str) else _pair(move)
    if pair is None:
        raise UsageError(f"--move: {move!r} is not (box, by); expected a box and by how much it moves")
    box = pair[0] if isinstance(pair[0], str) else _ball_or_box(pair[0])
    if box is None:
        raise UsageError(f"--move: {pair[0]!r} is no box; expected two opposite corners, (low, high) or X,Y,Z:X,Y,Z")
    by = pair[1] if isinstance(pair[1], str) else _point(pair[1])
    if by is None:
        raise UsageError(f"--by: {pair[1]!r} is not three numbers; expected (x, y, z)")
    yield "--move", box
    yield "--by", by


def edits_of(
    add: Any, cut: Any, move: Any, level: int, blend: Optional[float], check: bool, max_memory: Optional[float]
) -> _native.Edits:
    """Adds, then cuts, then moves. Raises UsageError for what the command's table refuses."""
    edits = _native.Edits()
    for tool in listed(add):
        _take_tool(lambda text: edits.option("--add", text), edits.add_file, edits.add_mesh, "--add", tool)
    for tool in listed(cut):
        _take_tool(lambda text: edits.option("--cut", text), edits.cut_file, edits.cut_mesh, "--cut", tool)
    for one in listed(move):
        for name, text in _texts_of_move(one):
            edits.option(name, text)
    for name, text in given(level=level, blend=blend, max_memory=max_memory, check=check):
        edits.option(name, text)
    return edits
