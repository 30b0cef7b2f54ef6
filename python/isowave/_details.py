"""What meshes, curves and heights that were taken apart have in common."""

from __future__ import annotations

import json
from typing import Any, Optional, Sequence

from .errors import UsageError

__all__ = ["check_dropping", "checked_depth", "depth_of", "report_of"]


def checked_depth(depth: int, most: int) -> int:
    if not 0 <= depth <= most:
        raise UsageError(f"--depth: '{depth}' is not between 0 and {most}")
    return depth


def depth_of(depth: Optional[int], most: int, fallback: int) -> int:
    return fallback if depth is None else checked_depth(depth, most)


def check_dropping(threshold: Optional[float], keep: Optional[int]) -> None:
    """Of details: those shorter than a threshold, or all but so many."""
    if threshold is not None and keep is not None:
        raise UsageError("--threshold and --keep exclude each other; give one of them")
    if threshold is not None and not 0 < threshold < float("inf"):
        raise UsageError(f"--threshold: '{threshold}' is not above 0")
    if keep is not None and keep < 0:
        raise UsageError(f"--keep: '{keep}' is below 0")


def report_of(text: str, remarks: Sequence[str]) -> Optional[dict[str, Any]]:
    """What the command's --json writes; None for what was read, of which nothing is told.

    >>> report_of('{"levels": 2}', ["2 curves are short"]), report_of("", [])
    ({'levels': 2, 'remarks': ['2 curves are short']}, None)
    """
    return {**json.loads(text), "remarks": list(remarks)} if text else None
