"""Levels of detail of solids, curves and meshes, by wavelets and by reversing subdivision.

>>> import numpy as np, isowave
>>> ball = np.linalg.norm(np.indices((24, 24, 24)) - 11.5, axis=0) < 8
>>> ladder = isowave.lod(ball, spacing=(1, 1, 1))
>>> points, triangles = ladder[1].mesh
>>> ladder[1].report["genus"]
0

lod() makes closed meshes of an image, a mesh or a file; analyse() takes a solid apart without loss; check() and compare()
measure meshes; curves() does in the plane what lod() does in space; filters(), subdivide() and reverse() are subdivision and
its way back, curve_levels() and relief() the same of curves and of heights. The page docs/python.md has it all.
"""

from ._native import version as __version__
from .errors import Error, InputError, OperationError, UsageError
from ._meshes import Mesh
from .labels import LabelLadders, each_label
from .levels import Curve, CurveDetails, ReliefDetails, curve_levels, relief
from .measure import Check, Comparison, Distance, check, compare
from .plane import CurveLadder, CurveLevel, Ring, curves
from .solids import Field, FieldMesh, Ladder, Level, Pyramid, analyse, field, lod
from .subdivision import Filter, Filters, Hierarchy, PolygonMesh, filters, reverse, subdivide

__all__ = [
    "Check",
    "Comparison",
    "Curve",
    "CurveDetails",
    "CurveLadder",
    "CurveLevel",
    "Distance",
    "Error",
    "Field",
    "FieldMesh",
    "Filter",
    "Filters",
    "Hierarchy",
    "InputError",
    "LabelLadders",
    "Ladder",
    "Level",
    "Mesh",
    "OperationError",
    "PolygonMesh",
    "Pyramid",
    "ReliefDetails",
    "Ring",
    "UsageError",
    "__version__",
    "analyse",
    "check",
    "compare",
    "curve_levels",
    "curves",
    "each_label",
    "field",
    "filters",
    "lod",
    "relief",
    "reverse",
    "subdivide",
]
