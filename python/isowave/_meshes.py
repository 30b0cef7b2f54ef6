"""Whatever holds a mesh -> points and faces as arrays."""

from __future__ import annotations

import os
import sys
from typing import Any, NamedTuple, Sequence, Union

import numpy as np
import numpy.typing as npt

from .errors import InputError, UsageError

__all__ = ["Mesh", "PathLike", "is_mesh", "is_path", "polygons_of", "triangles_of"]

PathLike = Union[str, "os.PathLike[str]"]
Faces = Union[npt.NDArray[np.int32], list[npt.NDArray[np.int32]]]


class Mesh(NamedTuple):
    """Points and triangles; unpacks into both.

    >>> points, triangles = Mesh(np.zeros((4, 3)), np.zeros((4, 3), np.int32))
    >>> points.shape
    (4, 3)
    """

    points: npt.NDArray[np.float64]  #: (V, 3), world units; for images mm, LPS
    triangles: npt.NDArray[np.int32]  #: (F, 3), counter-clockwise seen from outside


def is_path(source: Any) -> bool:
    return isinstance(source, (str, os.PathLike))


def is_mesh(source: Any) -> bool:
    """By what it holds: (points, faces), or an object of isowave, trimesh, open3d, pyvista, vtk."""
    if isinstance(source, (tuple, list)):
        return isinstance(source, Mesh) or (len(source) == 2 and all(np.ndim(part) >= 1 for part in _parts(source)))
    return (
        hasattr(source, "mesh")
        or (hasattr(source, "vertices") and (hasattr(source, "faces") or hasattr(source, "triangles")))
        or (hasattr(source, "points") and hasattr(source, "faces"))
        or hasattr(source, "GetPolys")
    )


def _parts(source: Any) -> list[Any]:
    """Faces of several sizes make no array: a list counts as one."""
    return [np.empty(1) if isinstance(part, (list, tuple)) else part for part in source]


def _counted(flat: Any) -> list[npt.NDArray[np.int64]]:
    """VTK's and pyvista's faces: how many corners, then the corners."""
    values = np.asarray(flat).ravel()
    faces, at = [], 0
    while at < len(values):
        count = int(values[at])
        faces.append(values[at + 1 : at + 1 + count])
        at += count + 1
    return faces


def _of_vtk(mesh: Any) -> tuple[Any, Any]:
    support = __import__("vtkmodules.util.numpy_support", fromlist=["vtk_to_numpy"])
    offsets = support.vtk_to_numpy(mesh.GetPolys().GetOffsetsArray())
    corners = support.vtk_to_numpy(mesh.GetPolys().GetConnectivityArray())
    points = support.vtk_to_numpy(mesh.GetPoints().GetData())
    sizes = np.diff(offsets)
    if len(sizes) and (sizes == sizes[0]).all():
        return points, corners.reshape(-1, int(sizes[0]))
    return points, np.split(corners, offsets[1:-1])


def _raw(mesh: Any, faces: Any) -> tuple[Any, Any]:
    if faces is not None:
        return mesh, faces
    if isinstance(mesh, (tuple, list)):
        return mesh[0], mesh[1]
    if hasattr(mesh, "mesh"):
        return mesh.mesh[0], mesh.mesh[1]
    if hasattr(mesh, "vertices"):
        return mesh.vertices, mesh.faces if hasattr(mesh, "faces") else mesh.triangles
    if hasattr(mesh, "points"):
        flat = np.asarray(mesh.faces)
        if flat.ndim == 1 and len(flat) % 4 == 0 and (flat[::4] == 3).all():
            return mesh.points, flat.reshape(-1, 4)[:, 1:]
        return mesh.points, _counted(flat) if flat.ndim == 1 else flat
    if hasattr(mesh, "GetPolys"):
        return _of_vtk(mesh)
    raise UsageError(
        f"{type(mesh).__name__} holds no mesh; expected (points, faces), a path, or a mesh of trimesh, pyvista, open3d, vtk"
    )


def _points(values: Any) -> npt.NDArray[np.float64]:
    array = np.asarray(values)
    if array.ndim != 2 or array.shape[1] != 3 or array.dtype.kind not in "biuf":
        raise InputError(f"mesh: its points have the shape {array.shape} and type {array.dtype}; expected (V, 3) numbers")
    return np.ascontiguousarray(array, dtype=np.float64)


def _whole(values: Any) -> npt.NDArray[np.int64]:
    array = np.asarray(values)
    if array.dtype.kind not in "iu":
        raise InputError(f"mesh: its faces have the type {array.dtype}; expected whole numbers, points counted from 0")
    return np.ascontiguousarray(array, dtype=np.int64)


def triangles_of(mesh: Any, faces: Any = None) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.int64]]:
    """Points (V, 3) and triangles (F, 3). Raises InputError for faces that are no triangles."""
    points, corners = _raw(mesh, faces)
    if isinstance(corners, (list, tuple)):
        for number, face in enumerate(corners):
            if np.ndim(face) != 1:
                raise InputError(f"mesh: face {number} is {face!r}; expected three points' numbers, counted from 0")
            if len(face) != 3:
                raise InputError(f"mesh: face {number} has {len(face)} corners; expected triangles; cut it into some")
    array = _whole(corners)
    if array.ndim != 2 or array.shape[1] != 3:
        raise InputError(f"mesh: its faces have the shape {array.shape}; expected triangles, (F, 3); cut them into some")
    return _points(points), array


def polygons_of(
    mesh: Any, faces: Any = None
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.int64], npt.NDArray[np.int64]]:
    """Points (V, 3), the corners of all faces, and how many each face has."""
    points, corners = _raw(mesh, faces)
    if isinstance(corners, (list, tuple)) and len({len(face) for face in corners}) > 1:
        sizes = np.array([len(face) for face in corners], np.int64)
        return _points(points), np.concatenate([_whole(face) for face in corners]), sizes
    array = _whole(corners)
    if array.ndim != 2:
        raise InputError(f"mesh: its faces have the shape {array.shape}; expected (F, corners), or a list of lists")
    return _points(points), array.ravel(), np.full(len(array), array.shape[1], np.int64)


def faces_of(corners: npt.NDArray[np.int32], sizes: npt.NDArray[np.int32]) -> Faces:
    """An array (F, corners) where all faces have as many; else a list of arrays."""
    if len(sizes) == 0 or (sizes == sizes[0]).all():
        return corners.reshape(len(sizes), -1)
    return np.split(corners, np.cumsum(sizes)[:-1])


def need_module(name: str) -> Any:
    """An optional package. Raises ImportError that says which one."""
    try:
        __import__(name)
    except ImportError as error:
        raise ImportError(f"this needs the package {name.split('.')[0]}, which is not installed") from error
    return sys.modules[name]


def names(all_of: Sequence[str]) -> str:
    return ", ".join(all_of)
