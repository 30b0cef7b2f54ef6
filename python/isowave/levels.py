"""Curves and heights at coarser levels by reversing subdivision, and their files of details."""

from __future__ import annotations

import os
from typing import Any, NamedTuple, Optional, Sequence

import numpy as np
import numpy.typing as npt

from . import _native
from ._details import check_dropping, checked_depth, depth_of, report_of
from ._meshes import PathLike, is_path
from ._volumes import refuse_masked
from ._watch import ProgressLike, Watch
from .errors import UsageError

__all__ = ["Curve", "CurveDetails", "ReliefDetails", "curve_levels", "relief"]

_MOST_CURVES, _MOST_RELIEF = 60, 20  # decompositions, as the command has them


class Curve(NamedTuple):
    """Points and whether the last is joined to the first; unpacks into both."""

    points: npt.NDArray[np.float64]  #: (N, 2) or (N, 3); of a closed curve the first is not repeated
    closed: bool


def _curve(curve: Any, number: int) -> tuple[npt.NDArray[np.float64], bool]:
    """
    >>> _curve([[0, 0], [1, 0], [1, 1], [0, 0]], 0)[1], _curve(Curve(np.zeros((3, 2)), True), 0)[1]
    (True, True)
    """
    closed = None
    if isinstance(curve, tuple) and len(curve) == 2 and isinstance(curve[1], (bool, np.bool_)):
        curve, closed = curve
    try:
        points = np.ascontiguousarray(curve, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise UsageError(f"curves: curve {number} is no array of numbers ({error})") from None
    if points.ndim != 2 or points.shape[1] not in (2, 3):
        raise UsageError(f"curves: curve {number} has the shape {points.shape}; expected (N, 2) or (N, 3)")
    if closed is None:  # as in files
        closed = len(points) > 1 and bool((points[0] == points[-1]).all())
        points = points[:-1] if closed else points
    return points, bool(closed)


def _curves(curves: Any) -> list[tuple[npt.NDArray[np.float64], bool]]:
    """One, or several of any lengths.

    >>> len(_curves([[0, 0], [1, 0]])), len(_curves([Curve(np.zeros((3, 2)), True)])), len(_curves([np.zeros((3, 2)), np.ones((4, 2))]))
    (1, 1, 2)
    """
    one = isinstance(curves, Curve)
    if not one and not any(isinstance(curve, tuple) for curve in curves):
        one = all(np.ndim(point) == 1 for point in curves) and all(np.ndim(x) == 0 for point in curves for x in point)
    return [_curve(curve, number) for number, curve in enumerate([curves] if one else curves)]


class CurveDetails:
    """Curves taken apart: the coarsest level of each, and the details that lead back. What ``curve-levels --details`` writes."""

    def __init__(self, native: _native.CurveDetails, remarks: Sequence[str] = ()) -> None:
        self._native = native
        #: What ``isowave curve-levels --json`` writes; None for one that was loaded.
        self.report = report_of(native.report, [*remarks, *native.remarks])

    @classmethod
    def load(cls, path: PathLike) -> CurveDetails:
        """Reads a file of save() or of ``isowave curve-levels --details``. Raises InputError."""
        return cls(_native.load_curve_details(os.fspath(path), Watch()))

    def save(self, path: PathLike) -> None:
        """The file of details, as ``isowave curve-levels --details`` writes it; it appears whole or not at all."""
        self._native.save(os.fspath(path))

    @property
    def scheme(self) -> str:
        """Its name, or the mask."""
        return self._native.scheme

    @property
    def coarse(self) -> list[Curve]:
        """Every curve at the coarsest level that it has."""
        return [Curve(*parts) for parts in self._native.coarse()]

    def __len__(self) -> int:
        """How many decompositions; curves that are too short have fewer."""
        return self._native.levels

    def rebuild(
        self,
        depth: Optional[int] = None,
        *,
        moved: Any = None,
        frames: str = "global",
        threshold: Optional[float] = None,
        keep: Optional[int] = None,
        limit: bool = False,
        progress: Optional[ProgressLike] = None,
    ) -> list[Curve]:
        """The curves ``depth`` subdivisions above the coarse ones; without it as they were.

        moved: the coarse curves after an edit, as ``coarse`` has them. frames: "global", details keep their direction; "local", they
        turn with the curve. threshold: leave out details shorter than this. keep: only that many of the longest of each
        curve. limit: points at their limit positions, on the curve that they control; for looking at.

        Raises UsageError for a depth beyond len(self); InputError for edited curves of another size.
        """
        check_dropping(threshold, keep)
        if depth is not None and depth > len(self):
            raise UsageError(f"--depth: there are {len(self)} levels")
        places = None if moved is None else _curves(moved)
        wanted = depth_of(depth, _MOST_CURVES, -1)
        curves, _ = self._native.rebuild(wanted, places, frames, threshold, keep, limit, Watch(progress))
        return [Curve(*parts) for parts in curves]

    def __repr__(self) -> str:
        return f"<isowave.CurveDetails: {self.scheme}, {len(self)} levels of {len(self.coarse):,} curves>"


def curve_levels(
    curves: Any,
    *,
    scheme: Optional[str] = None,
    mask: Optional[str] = None,
    width: Optional[int] = None,
    depth: int = 6,
    resample: Optional[int] = None,
    threshold: Optional[float] = None,
    keep: Optional[int] = None,
    progress: Optional[ProgressLike] = None,
) -> CurveDetails:
    """Curves -> the same curves at coarser levels and the details that lead back, without loss.

    curves: a path (text, GeoJSON, SVG), an array (N, 2) or (N, 3), or a list of these or of Curve. An array whose last point repeats its
    first is closed.
    scheme: chaikin-W, cubic-W, dlg-trial, dlg-refined (the usual one), dlg-optimal. mask: instead, a subdivision of your own for closed
    curves, "1/8 1/2 3/4 1/2 1/8"; width: of A for it.
    depth: how many decompositions; curves too short for them stay at the coarsest level that they have, which ``report["remarks"]`` says.
    resample: first put that many points at equal steps along each curve.
    threshold: drop details shorter than this. keep: keep only that many of the longest of each curve. The file is smaller then.

    Raises InputError: no curve that is long enough, a coordinate that is not finite, an unknown scheme; UsageError.

    >>> angle = np.linspace(0, 2 * np.pi, 64, endpoint=False)
    >>> wave = np.stack([np.cos(angle), np.sin(angle)], axis=1) * (1 + 0.1 * np.sin(9 * angle))[:, None]
    >>> levels = curve_levels(Curve(wave, closed=True), depth=3)
    >>> [len(curve.points) for curve in levels.coarse], len(levels)
    ([8], 3)
    >>> bool(np.allclose(levels.rebuild()[0].points, wave))
    True
    """
    if mask is not None and scheme is not None:
        raise UsageError("--mask: is a scheme of its own; leave --scheme out")
    if width is not None and mask is None:
        raise UsageError("--width: belongs to --mask; write --scheme cubic-7 otherwise")
    if resample is not None and resample < 2:
        raise UsageError(f"--points: '{resample}' is below 2")
    check_dropping(threshold, keep)
    watch = Watch(progress)
    path = os.fspath(curves) if is_path(curves) else None
    parts = [] if path is not None else _curves(curves)
    native = _native.curve_levels(parts, path, scheme or "dlg-refined", mask or "", width or 0, checked_depth(depth, _MOST_CURVES),
                                  resample, threshold, keep, watch)  # fmt: skip
    return CurveDetails(native, watch.remarks)


def _heights(heights: npt.ArrayLike, name: str) -> npt.NDArray[np.float64]:
    refuse_masked(heights, name)
    values = np.ascontiguousarray(heights, dtype=np.float64)
    if values.ndim not in (2, 3) or (values.ndim == 3 and not 1 <= values.shape[2] <= 4):
        raise UsageError(f"{name}: has the shape {values.shape}; expected (rows, columns), or with up to 4 channels last")
    return values


class ReliefDetails:
    """Heights taken apart: the coarsest level, and the details that lead back. What ``relief --details`` writes."""

    def __init__(self, native: _native.ReliefDetails, remarks: Sequence[str] = ()) -> None:
        self._native = native
        #: What ``isowave relief --json`` writes; None for one that was loaded.
        self.report = report_of(native.report, remarks)

    @classmethod
    def load(cls, path: PathLike) -> ReliefDetails:
        """Reads a file of save() or of ``isowave relief --details``. Raises InputError."""
        return cls(_native.load_relief_details(os.fspath(path), Watch()))

    def save(self, path: PathLike) -> None:
        """The file of details, as ``isowave relief --details`` writes it; it appears whole or not at all."""
        self._native.save(os.fspath(path))

    @property
    def scheme(self) -> str:
        return self._native.scheme

    @property
    def coarse(self) -> npt.NDArray[np.float64]:
        """The heights of the coarsest level: (rows, columns), or with channels last."""
        return self._native.coarse()

    def __len__(self) -> int:
        """How many decompositions."""
        return self._native.levels

    def rebuild(
        self,
        depth: Optional[int] = None,
        *,
        edited: Optional[npt.ArrayLike] = None,
        threshold: Optional[float] = None,
        keep: Optional[int] = None,
        limit: bool = False,
        progress: Optional[ProgressLike] = None,
    ) -> npt.NDArray[np.float64]:
        """The heights ``depth`` subdivisions above the coarse ones; without it as they were.

        edited: the coarse heights after an edit, as large as ``coarse``. threshold: leave out details smaller than this. keep: only
        that many of the largest. limit: heights at their limit positions; for looking at.

        Raises UsageError for a depth beyond len(self); InputError for edited heights of another size.
        """
        check_dropping(threshold, keep)
        if depth is not None and depth > len(self):
            raise UsageError(f"--depth: there are {len(self)} levels")
        places = None if edited is None else _heights(edited, "edited")
        wanted = depth_of(depth, _MOST_RELIEF, -1)
        return self._native.rebuild(wanted, places, threshold, keep, limit, Watch(progress))[0]

    def __repr__(self) -> str:
        return f"<isowave.ReliefDetails: {self.scheme}, {len(self)} levels above {self.coarse.shape}>"


def relief(
    heights: Any,
    *,
    scheme: str = "butterfly-3",
    depth: int = 2,
    progress: Optional[ProgressLike] = None,
) -> ReliefDetails:
    """A height field -> a coarser one and the details that lead back, on the triangular lattice, without loss.

    heights: a path (PNG, TIFF, .npy, .asc), or an array (rows, columns), or with up to 4 channels last.
    scheme: butterfly-W, loop-W (W rings), loop-like:ALPHA,GAMMA. depth: how many decompositions.

    Raises InputError: too small for so many levels, a height that is not finite, an unknown scheme.

    >>> y, x = np.mgrid[0:33, 0:33]
    >>> hill = np.exp(-((x - 16) ** 2 + (y - 16) ** 2) / 64)
    >>> levels = relief(hill, depth=2)
    >>> levels.coarse.shape, bool(np.allclose(levels.rebuild(), hill))
    ((9, 9), True)
    """
    watch = Watch(progress)
    path = os.fspath(heights) if is_path(heights) else None
    values = None if path is not None else _heights(heights, "heights")
    return ReliefDetails(_native.relief(values, path, scheme, checked_depth(depth, _MOST_RELIEF), watch), watch.remarks)
