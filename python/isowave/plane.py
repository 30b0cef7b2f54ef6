"""Closed curves in the plane at every level of detail."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any, NamedTuple, Optional, Union, overload

import numpy as np
import numpy.typing as npt

from . import _native
from ._html import grouped, short, table
from ._meshes import PathLike, is_path
from ._options import given
from ._volumes import _checked
from ._watch import ProgressLike, Watch
from .errors import InputError, UsageError
from .solids import Range

__all__ = ["CurveLadder", "CurveLevel", "Ring", "curves"]


class Ring(NamedTuple):
    """A closed polyline; the last point is joined to the first, which is not repeated."""

    points: npt.NDArray[np.float64]  #: (N, 2), the input's coordinates
    parent: int  #: the ring directly around it, -1 for none
    hole: bool


class CurveLevel:
    """The curves of one level, or with ``steps`` of one step."""

    def __init__(self, ladder: CurveLadder, index: int, report: dict[str, Any]) -> None:
        self._native = ladder._native
        self._index = index
        #: The entry of ``isowave curves --json`` for this step.
        self.report = report

    @property
    def step(self) -> int:
        return self._native.step(self._index)

    @property
    def level(self) -> Optional[int]:
        """None for a step between two levels."""
        return None if self.step % 2 else self.step // 2

    @property
    def rings(self) -> list[Ring]:
        """Outer rings and holes: simple, pairwise disjoint, inside to the left where y points up."""
        return [Ring(points, parent, hole) for points, parent, hole in self._native.rings(self._index)]

    def text(self, format: str = "svg") -> str:
        """The curves as "svg", "geojson" or "txt" (GMT's multiple segments)."""
        return self._native.text(self._index, format)

    def save(self, path: PathLike) -> None:
        """Writes .svg, .geojson or .txt."""
        _write(path, self.text(os.path.splitext(os.fspath(path))[1][1:].lower()))

    def _repr_svg_(self) -> str:
        return self.text("svg")

    def __repr__(self) -> str:
        name = f"step {self.step}" if self.level is None else f"level {self.level}"
        return f"<isowave.CurveLevel: {name}, {self.report['rings']} rings, {self.report['holes']} holes>"


def _write(path: PathLike, text: str) -> None:
    _native.write_text(os.fspath(path), text)


class CurveLadder(Sequence[CurveLevel]):
    """Levels or steps, finest first; one at which nothing is left is not among them."""

    def __init__(self, native: _native.Curves, remarks: list[str]) -> None:
        self._native = native
        self.remarks = remarks
        #: What ``isowave curves --json`` writes.
        self.report: dict[str, Any] = {**json.loads(native.report()), "remarks": list(remarks)}
        by_step = {step["step"]: step for step in self.report["steps"]}
        self._levels = [CurveLevel(self, i, by_step[native.step(i)]) for i in range(len(native))]

    def __len__(self) -> int:
        return len(self._levels)

    @overload
    def __getitem__(self, index: int) -> CurveLevel: ...

    @overload
    def __getitem__(self, index: slice) -> list[CurveLevel]: ...

    def __getitem__(self, index: Union[int, slice]) -> Union[CurveLevel, list[CurveLevel]]:
        return self._levels[index]

    def sheet(self) -> str:
        """One SVG with all levels side by side."""
        return self._native.sheet()

    def _repr_html_(self) -> str:
        header = ["level", "outer rings", "holes", "points", "area", "rms to level 0", "max to level 0"]
        rows = [
            [f"{level.step // 2}{'a' if level.step % 2 else ''}"]
            + [grouped(level.report[key]) for key in ("rings", "holes", "points")]
            + [short(level.report[key]) for key in ("area", "rms_to_level0", "max_to_level0")]
            for level in self
        ]
        return table(f"{os.path.basename(self.report['input']['path'])}: {len(self)} levels", header, rows)

    def __repr__(self) -> str:
        return f"<isowave.CurveLadder of {self.report['input']['path']}: {len(self)} levels>"


Rings = list[list[npt.NDArray[np.float64]]]


def _ring(values: Any, number: int) -> npt.NDArray[np.float64]:
    array = np.asarray(values)
    if array.ndim != 2 or array.shape[1] < 2 or array.dtype.kind not in "iuf":
        raise InputError(f"polygons: ring {number} has the shape {array.shape}; expected (N, 2) numbers")
    if not np.isfinite(array).all():
        raise InputError(f"polygons: ring {number} has a coordinate that is not finite; leave it out")
    closed = len(array) > 1 and bool((array[0] == array[-1]).all())
    return np.ascontiguousarray(array[: len(array) - closed, :2], dtype=np.float64)


_PARTS = {"FeatureCollection": "features", "GeometryCollection": "geometries"}


def _geometries(shape: Any) -> Iterator[Any]:
    """The geometries of a GeoJSON object, one by one; a feature may have none."""
    kind = shape.get("type") if isinstance(shape, Mapping) else None
    try:
        if kind in _PARTS:
            for part in shape[_PARTS[kind]]:
                yield from _geometries(part)
        elif kind == "Feature":
            if shape["geometry"] is not None:
                yield from _geometries(shape["geometry"])
        elif kind is None:
            raise InputError('polygons: an object without a "type"; expected GeoJSON')
        else:
            yield shape
    except KeyError as key:
        raise InputError(f"polygons: a {kind} without {key}; expected GeoJSON") from None


def _of_geojson(shape: Any, remark: Callable[[str], None]) -> list[Any]:
    polygons: list[Any] = []
    others = []
    for geometry in _geometries(shape):
        if geometry["type"] not in ("Polygon", "MultiPolygon"):
            others.append(geometry["type"])
        elif "coordinates" not in geometry:
            raise InputError(f"polygons: a {geometry['type']} without 'coordinates'; expected GeoJSON")
        else:
            polygons += [geometry["coordinates"]] if geometry["type"] == "Polygon" else geometry["coordinates"]
    if not polygons:
        found = f"is a {others[0]}" if others else "holds no geometry"
        raise InputError(f"polygons: {found}; expected Polygon or MultiPolygon")
    if others:
        kind = "geometry that is no polygon" if len(others) == 1 else "geometries that are no polygons"
        remark(f"{len(others)} {kind} left out (first: {others[0]})")
    return polygons


def _polygons(source: Any, remark: Callable[[str], None]) -> Rings:
    shape = getattr(source, "__geo_interface__", source if isinstance(source, Mapping) else None)
    if shape is not None:
        source = _of_geojson(shape, remark)
    if not isinstance(source, (list, tuple)):
        raise UsageError(
            f"{type(source).__name__} holds no curves; expected a path, a picture (rows, columns), or a list of polygons, "
            "each a list of rings (N, 2)"
        )
    for number, polygon in enumerate(source):
        if isinstance(polygon, np.ndarray) and polygon.ndim == 2:
            raise InputError(
                f"polygons: polygon {number} is one ring of the shape {polygon.shape}; expected a list of rings, the outline first: [ring]"
            )
    return [[_ring(ring, number) for number, ring in enumerate(polygon)] for polygon in source]


def curves(
    source: Any,
    *,
    levels: Optional[Range] = None,
    steps: Optional[Range] = None,
    hold: Optional[str] = None,
    smooth: bool = False,
    flatness: Optional[float] = None,
    iso: Optional[float] = None,
    pixels: Optional[int] = None,
    invert: bool = False,
    fit: Optional[str] = None,
    half_width: Optional[float] = None,
    band: Optional[float] = None,
    add: Union[None, PathLike, Sequence[PathLike]] = None,
    cut: Union[None, PathLike, Sequence[PathLike]] = None,
    edit_level: Optional[int] = None,
    pyramid: Optional[PathLike] = None,
    threads: Optional[int] = None,
    progress: Optional[ProgressLike] = None,
) -> CurveLadder:
    """A bitmap or polygons -> closed curves, one set a level. Arguments are the options of ``isowave curves``.

    source: a path (PNG, TIFF, GeoJSON, a pyramid .iwc, ...), a picture (rows, columns) of any numbers, a list of polygons, each a list of
    rings (N, 2), GeoJSON as a dict, or an object with ``__geo_interface__`` (shapely, geopandas).

    add, cut: files of polygons that are united with what was fitted, or taken away; all are added before any is cut.
    pyramid: a file (.iwc) that gets what was fitted, to be given as source again.

    Coordinates are the input's; of a picture pixels, (0, 0) in the middle of the first one, y pointing down.

    Raises UsageError, InputError as lod() does.

    >>> y, x = np.mgrid[:64, :64]
    >>> rings = curves(np.hypot(x - 31.5, y - 31.5) < 20)[0].rings
    >>> len(rings), rings[0].hole, rings[0].points.shape[1]
    (1, False, 2)
    """
    options = given(levels=levels, steps=steps, hold=hold, smooth=smooth, flatness=flatness, iso=iso, pixels=pixels, invert=invert,
                    fit=fit, half_width=half_width, band=band, add=add, cut=cut, edit_level=edit_level,
                    pyramid=None if pyramid is None else os.fspath(pyramid))  # fmt: skip
    watch = Watch(progress, threads)
    if is_path(source):
        native = _native.curves_of_file(os.fspath(source), options, watch)
    elif hasattr(source, "dtype"):
        picture = _checked(source)
        if picture.ndim != 2:
            raise InputError(f"picture: has {picture.ndim} dimensions; expected 2, (rows, columns)")
        native = _native.curves_of_picture(picture.astype(np.float32), options, watch)
    else:
        native = _native.curves_of_polygons(_polygons(source, watch.remark), options, watch)
    return CurveLadder(native, watch.remarks)
