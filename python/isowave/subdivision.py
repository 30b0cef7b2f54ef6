"""Levels of detail by reversing subdivision, and the filters behind it."""

from __future__ import annotations

import os
from fractions import Fraction
from typing import Any, NamedTuple, Optional, Sequence, Union

import numpy as np
import numpy.typing as npt

from . import _native
from ._details import check_dropping, depth_of, report_of
from ._meshes import Faces, PathLike, faces_of, is_path, polygons_of
from ._watch import ProgressLike, Watch
from .errors import UsageError

__all__ = ["Filter", "Filters", "Hierarchy", "PolygonMesh", "filters", "reverse", "subdivide"]

_MOST = 15  # levels: a quad becomes 2^30

Node = Union[int, tuple[int, int]]


class PolygonMesh(NamedTuple):
    """Points and faces; unpacks into both."""

    points: npt.NDArray[np.float64]  #: (V, 3)
    faces: Faces  #: (F, corners) where all faces have as many, else a list of arrays


class Filter(NamedTuple):
    """A row of A or B, or a column of P or Q."""

    at: Node  #: the node it stands for: of A and P the coarse node 0, of B and Q an edge node
    taps: dict[Node, Fraction]  #: fine node -> exact value; those that are not 0


class Filters:
    """A, B, P and Q with c = A f, d = B f, f = P c + Q d. Nodes are numbers on the line, pairs on a lattice."""

    def __init__(self, parts: dict[str, Any]) -> None:
        self.subdivision: str = parts["subdivision"]
        self.lattice: str = parts["lattice"]
        #: Of A: taps on the line, rings else.
        self.width: int = parts["width"]
        self.P = self._filter(parts["P"])
        self.A = self._filter(parts["A"])
        #: One a detail: one on the line, three else.
        self.B = [self._filter(part) for part in parts["B"]]
        self.Q = [self._filter(part) for part in parts["Q"]]
        #: How many products of diagrams were checked, in rationals.
        self.products: int = parts["products"]
        #: The first that is wrong; empty, as it must be.
        self.failure: str = parts["failure"]

    def _filter(self, part: Any) -> Filter:
        (x, y), taps = part
        line = self.lattice == "line"
        return Filter(x if line else (x, y), {tx if line else (tx, ty): Fraction(value) for tx, ty, value in taps})

    @property
    def holds(self) -> bool:
        """AP = I, BP = 0, AQ = 0, BQ = I."""
        return not self.failure

    def __repr__(self) -> str:
        return f"<isowave.Filters: {self.subdivision}, A of width {self.width}>"


def filters(
    name: Optional[str] = None, *, width: Optional[int] = None, mask: Optional[str] = None, lattice: Optional[str] = None
) -> Filters:
    """The four filters of a subdivision's multiresolution, exactly, with proof.

    name: chaikin, cubic, dlg, butterfly, loop, catmull-clark, bspline-D, ..., or cubic-7 with the width in it.
    mask: instead, a subdivision of your own: "1/8 1/2 3/4 1/2 1/8". lattice: where it lives, line, triangular or quad.
    width: of A; without it the usual one, or the smallest there is.

    Raises InputError: an unknown name, no A of this width.

    >>> cubic = filters("cubic", width=7)
    >>> cubic.A.taps[0], cubic.holds
    (Fraction(52, 49), True)
    """
    if (name is None) == (mask is None):
        raise UsageError("filters: name a subdivision or give your own with --mask, not both")
    if mask is not None:
        return Filters(_native.mask_filters(mask, lattice or "line", width))
    if lattice is not None:
        raise UsageError(f"--lattice: says where a --mask lives; {name} has its own")
    return Filters(_native.named_filters(str(name), width))


Creases = Sequence[tuple[int, int, float]]


def _polygons(mesh: Any, faces: Any, creases: Creases, watch: Watch) -> _native.Polygons:
    if faces is None and is_path(mesh):
        if creases:
            raise UsageError("creases belong to points and faces; a file marks its own ('t crease ...')")
        return _native.read_polygons(os.fspath(mesh), watch)
    points, corners, sizes = polygons_of(mesh, faces)
    return _native.take_polygons(points, corners, sizes, list(creases))


def _mesh(parts: tuple[Any, Any, Any]) -> PolygonMesh:
    points, corners, sizes = parts
    return PolygonMesh(points, faces_of(corners, sizes))


def subdivide(
    mesh: Any,
    faces: Any = None,
    *,
    scheme: str = "catmull-clark",
    depth: int = 1,
    creases: Creases = (),
    limit: bool = False,
    progress: Optional[ProgressLike] = None,
) -> PolygonMesh:
    """A polygon mesh, subdivided ``depth`` times.

    mesh: a path (OBJ, OFF, PLY), (points (V, 3), faces), or a mesh of another package; faces: (F, corners) or lists.
    scheme: catmull-clark (any faces), loop or butterfly (triangles). creases: (vertex, vertex, sharpness), for catmull-clark.
    limit: points at their limit positions, where more subdivisions would take them; with depth=0 those of the mesh itself.

    Raises InputError for an unknown scheme, a defect of the mesh, faces that the scheme does not take.

    >>> cube = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
    >>> sides = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    >>> points, faces = subdivide(cube, sides, depth=2)
    >>> points.shape, faces.shape
    ((98, 3), (96, 4))
    >>> subdivide(cube, sides, depth=0, limit=True).points[0]
    array([0.25, 0.25, 0.25])
    """
    watch = Watch(progress)
    return _mesh(_native.subdivide(_polygons(mesh, faces, creases, watch), scheme, depth_of(depth, _MOST, 1), limit, watch))


class Hierarchy:
    """A mesh taken apart: a coarse base, and the details that each subdivision needs to get the mesh back."""

    def __init__(self, native: _native.Hierarchy, remarks: Sequence[str] = ()) -> None:
        self._native = native
        #: What ``isowave reverse --json`` writes; None for one that was loaded.
        self.report = report_of(native.report, remarks)

    @classmethod
    def load(cls, path: PathLike) -> Hierarchy:
        """Reads a file of save() or of ``isowave reverse --details``. Raises InputError."""
        return cls(_native.load_hierarchy(os.fspath(path), Watch()))

    def save(self, path: PathLike, *, threshold: Optional[float] = None, keep: Optional[int] = None) -> None:
        """Base and details in one file, as ``isowave reverse --details`` writes it; it appears whole or not at all.

        threshold: without details shorter than this. keep: with only that many of the longest. The file is smaller then.
        """
        check_dropping(threshold, keep)
        self._native.save(os.fspath(path), threshold, keep)

    @property
    def scheme(self) -> str:
        return self._native.scheme

    @property
    def variant(self) -> str:
        return self._native.variant

    @property
    def base(self) -> PolygonMesh:
        return _mesh(self._native.base())

    @property
    def details(self) -> list[npt.NDArray[np.float64]]:
        """(D, 3) a subdivision; the first leads from the base to the next finer level."""
        return self._native.details()

    def __len__(self) -> int:
        """How many subdivisions lead from the base to the mesh."""
        return self._native.steps

    def rebuild(
        self,
        depth: Optional[int] = None,
        *,
        moved: Optional[npt.ArrayLike] = None,
        frames: str = "global",
        threshold: Optional[float] = None,
        keep: Optional[int] = None,
        limit: bool = False,
        progress: Optional[ProgressLike] = None,
    ) -> PolygonMesh:
        """The mesh ``depth`` subdivisions above the base; without it the finest, with its own order of vertices and faces.

        moved: the base's points (V, 3) after an edit. frames: "global", details keep their direction; "local", they turn
        with the surface. threshold: leave out details shorter than this. keep: only that many of the longest.
        limit: the points at their limit positions, on the surface that they control. They are for looking at: as ``moved``
        they are refused.

        Raises UsageError for a depth beyond len(self), InputError.
        """
        points = None
        if moved is not None:
            points = np.ascontiguousarray(moved, dtype=np.float64)
            count = len(self.base.points)
            if points.shape != (count, 3):
                raise UsageError(f"moved: has the shape {points.shape}; the base has ({count}, 3)")
        if threshold is not None and keep is not None:
            raise UsageError("--threshold and --keep exclude each other; give one of them")
        watch = Watch(progress)
        return _mesh(self._native.rebuild(depth_of(depth, _MOST, -1), points, frames, threshold, keep, limit, watch)[0])

    def __repr__(self) -> str:
        return f"<isowave.Hierarchy: {self.scheme}, {len(self)} subdivisions above {len(self.base.points):,} vertices>"


def reverse(
    mesh: Any,
    faces: Any = None,
    *,
    scheme: str = "catmull-clark",
    variant: str = "",
    depth: Optional[int] = None,
    crease: Optional[float] = None,
    creases: Creases = (),
    progress: Optional[ProgressLike] = None,
) -> Hierarchy:
    """A mesh that subdivision has made, moved points and all -> a coarse base and details, without loss.

    mesh, faces, scheme, creases: as subdivide() takes them; vertices and faces may come in any order.
    variant: how the coarse mesh is fitted. depth: how many levels coarser; without it as many as there are.
    crease: edges of the base that fold by more than so many degrees are creases too (catmull-clark).

    Raises InputError: an unknown scheme or variant, a defect of the mesh, no subdivision connectivity.

    >>> tetrahedron = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], float)
    >>> fine = subdivide(tetrahedron, [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]], scheme="loop", depth=3)
    >>> levels = reverse(fine, scheme="loop")
    >>> len(levels), bool(np.allclose(levels.rebuild().points, fine.points))
    (3, True)
    """
    watch = Watch(progress)
    polygons = _polygons(mesh, faces, creases, watch)
    if crease is not None and not 0 <= crease <= 180:
        raise UsageError(f"--crease: '{crease}' is not between 0 and 180")
    if crease is not None and scheme != "catmull-clark":
        raise UsageError(f"--crease: belongs to --scheme catmull-clark; {scheme} has no creases")
    return Hierarchy(_native.reverse(polygons, scheme, variant, depth_of(depth, _MOST, -1), crease, watch), watch.remarks)
