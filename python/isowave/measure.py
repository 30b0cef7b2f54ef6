"""What a mesh is, and how far two meshes are apart."""

from __future__ import annotations

import json
import os
from typing import Any, Optional

from . import _native
from ._meshes import is_path, triangles_of
from ._watch import ProgressLike, Watch

__all__ = ["Check", "Comparison", "Distance", "check", "compare"]


def _measured(mesh: Any, faces: Any, name: str, watch: Watch) -> _native.Measured:
    if faces is None and is_path(mesh):
        return _native.read_mesh(os.fspath(mesh), watch)
    points, triangles = triangles_of(mesh, faces)
    return _native.take_mesh(points, triangles, name)


class Check:
    """What a mesh is. ``bool(check)``: closed, 2-manifold and oriented."""

    def __init__(self, report: dict[str, Any]) -> None:
        #: What ``isowave check --json`` writes.
        self.report = report

    @property
    def closed(self) -> bool:
        """No edge has only one triangle."""
        return bool(self.report["closed"])

    @property
    def manifold(self) -> bool:
        """No edge has more than two triangles, no vertex more than one fan of them."""
        return bool(self.report["manifold"])

    @property
    def oriented(self) -> bool:
        """No two neighbours run along their edge the same way."""
        return bool(self.report["oriented"])

    @property
    def genus(self) -> Optional[int]:
        """Handles, summed over components; None where the mesh is open or not 2-manifold."""
        genus: Optional[int] = self.report["genus"]
        return genus

    @property
    def components(self) -> int:
        return int(self.report["components"])

    @property
    def volume(self) -> float:
        """World units cubed; above 0 where triangles are counter-clockwise from outside."""
        return float(self.report["volume"])

    @property
    def area(self) -> float:
        """World units squared."""
        return float(self.report["area"])

    @property
    def self_intersections(self) -> Optional[int]:
        """Pairs of triangles; None unless they were counted."""
        count: Optional[int] = self.report["self_intersections"]
        return count

    def __bool__(self) -> bool:
        return self.closed and self.manifold and self.oriented

    def __repr__(self) -> str:
        state = "closed, 2-manifold, oriented" if self else "DEFECTIVE"
        return f"<isowave.Check: {self.report['triangles']:,} triangles, {state}>"


def check(
    mesh: Any,
    faces: Any = None,
    *,
    self_intersections: bool = False,
    threads: Optional[int] = None,
    progress: Optional[ProgressLike] = None,
) -> Check:
    """Counts what a mesh is, and repairs nothing; equal points are merged first.

    mesh: a path, (points (V, 3), triangles (F, 3)), or a mesh of isowave, trimesh, pyvista, open3d or vtk.
    self_intersections: count the pairs of triangles that intersect, which takes longer.

    Raises InputError for a file that cannot be read, a corner that is no point, a point that is not finite.

    >>> points = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
    >>> faces = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]
    >>> tetrahedron = check(points, faces)
    >>> bool(tetrahedron), tetrahedron.genus, round(tetrahedron.volume, 6)
    (True, 0, 0.166667)
    >>> check(points, faces[1:]).closed
    False
    """
    watch = Watch(progress, threads)
    report = json.loads(_native.check(_measured(mesh, faces, "mesh", watch), self_intersections, watch))
    return Check({**report, "remarks": watch.remarks})


class Distance:
    """Distances from samples of one surface to another; world units."""

    def __init__(self, report: dict[str, Any]) -> None:
        #: Weighted by area.
        self.mean = float(report["mean"])
        #: Weighted by area.
        self.rms = float(report["rms"])
        #: The largest of the samples: a lower bound of the Hausdorff distance.
        self.max = float(report["max"])
        #: No point of the surface is farther.
        self.max_bound = float(report["max_bound"])

    def __repr__(self) -> str:
        return f"<isowave.Distance: rms {self.rms:.4g}, max {self.max:.4g} (at most {self.max_bound:.4g})>"


class Comparison(Distance):
    """Both ways together; ``a_to_b`` and ``b_to_a`` are the two."""

    def __init__(self, report: dict[str, Any]) -> None:
        super().__init__(report["symmetric"])
        #: What ``isowave compare --json`` writes.
        self.report = report
        self.a_to_b = Distance(report["a_to_b"])
        self.b_to_a = Distance(report["b_to_a"])
        #: Of b less that of a; world units cubed.
        self.volume_difference = float(report["volume_difference"])


def compare(
    a: Any,
    b: Any,
    *,
    sampling: Optional[float] = None,
    threads: Optional[int] = None,
    progress: Optional[ProgressLike] = None,
) -> Comparison:
    """How far two surfaces are apart, both ways.

    a, b: paths or meshes, as check() takes them.
    sampling: no point of a surface is farther from a sample than this, world units; without it 1/500 of a's diagonal.

    Raises InputError for what is no mesh or has no triangles; OperationError in a build without CGAL's GPL packages.

    >>> import numpy as np
    >>> points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], float)
    >>> faces = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]
    >>> moved = compare((points, faces), (points + [0, 0, 0.1], faces))
    >>> round(moved.max, 9), abs(moved.volume_difference) < 1e-12
    (0.1, True)
    """
    watch = Watch(progress, threads)
    first, second = _measured(a, None, "a", watch), _measured(b, None, "b", watch)
    report = json.loads(_native.compare(first, second, sampling, watch))
    return Comparison({**report, "remarks": watch.remarks})
