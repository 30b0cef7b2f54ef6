"""What long work says while it runs."""

from __future__ import annotations

import logging
from typing import Any, Callable, Optional, Union

from .errors import UsageError

__all__ = ["ProgressLike", "Watch"]

ProgressLike = Union[Callable[[float, str], object], Any]

_log = logging.getLogger("isowave")


def _bar(bar: Any) -> Callable[[float, str], object]:
    """A callback that moves a bar of tqdm: its description is the stage, its length the share of the stage."""
    if bar.total is None:
        bar.total = 100

    def move(share: float, stage: str) -> None:
        bar.set_description(stage, refresh=False)
        bar.n = round(share * bar.total, 2)
        bar.refresh()

    return move


class Watch:
    """Takes progress and remarks; the thread that called is the one that calls it.

    >>> watch = Watch(lambda share, stage: print(f"{stage} {share:.0%}"))
    >>> watch.progress(0.5, "analysing")
    analysing 50%
    """

    def __init__(self, progress: Optional[ProgressLike] = None, threads: Optional[int] = None) -> None:
        if threads is not None and not 1 <= threads <= 4096:
            raise UsageError(f"--threads: '{threads}' is not between 1 and 4096")
        self.threads = threads or 0
        self.remarks: list[str] = []
        looks_like_bar = hasattr(progress, "set_description") and hasattr(progress, "total")
        self._report = _bar(progress) if looks_like_bar else progress
        if self._report is not None and not callable(self._report):
            raise UsageError(f"progress: {progress!r} can neither be called nor is it a bar of tqdm")

    def progress(self, share: float, stage: str) -> None:
        if self._report is not None:
            self._report(min(max(share, 0.0), 1.0), stage)

    def remark(self, line: str) -> None:
        self.remarks.append(line)
        _log.info("%s", line)
