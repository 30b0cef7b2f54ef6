"""Meshes for other packages, none of which isowave needs."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from ._meshes import Mesh, need_module

__all__ = ["Adapters"]


class Adapters:
    """``to_...`` of everything that has a mesh. Raises ImportError where the package is not installed."""

    @property
    def mesh(self) -> Mesh:
        raise NotImplementedError

    @property
    def points(self) -> npt.NDArray[np.float64]:
        """(V, 3)"""
        return self.mesh.points

    @property
    def triangles(self) -> npt.NDArray[np.int32]:
        """(F, 3)"""
        return self.mesh.triangles

    @property
    def normals(self) -> npt.NDArray[np.float32]:
        raise NotImplementedError

    def to_pyvista(self) -> Any:
        """A ``pyvista.PolyData`` with the point data "Normals"."""
        pyvista = need_module("pyvista")
        points, triangles = self.mesh
        corners = np.column_stack([np.full(len(triangles), 3, np.int32), triangles]).ravel()
        data = pyvista.PolyData(np.array(points), corners)
        if len(self.normals):
            data.point_data["Normals"] = np.array(self.normals)
        return data

    def to_trimesh(self) -> Any:
        """A ``trimesh.Trimesh``; nothing is merged or removed."""
        trimesh = need_module("trimesh")
        points, triangles = self.mesh
        return trimesh.Trimesh(vertices=np.array(points), faces=np.array(triangles), process=False)

    def to_vtk(self) -> Any:
        """A ``vtkPolyData`` (VTK 9) with normals."""
        need_module("vtkmodules.vtkCommonDataModel")
        model = need_module("vtkmodules.vtkCommonDataModel")
        core = need_module("vtkmodules.vtkCommonCore")
        support = need_module("vtkmodules.util.numpy_support")
        points, triangles = self.mesh
        vertices = core.vtkPoints()
        vertices.SetData(support.numpy_to_vtk(points, deep=True))
        offsets = np.arange(0, 3 * len(triangles) + 1, 3, dtype=np.int64)
        cells = model.vtkCellArray()
        cells.SetData(
            support.numpy_to_vtkIdTypeArray(offsets, deep=True),
            support.numpy_to_vtkIdTypeArray(triangles.astype(np.int64).ravel(), deep=True),
        )
        data = model.vtkPolyData()
        data.SetPoints(vertices)
        data.SetPolys(cells)
        if len(self.normals):
            normals = support.numpy_to_vtk(self.normals, deep=True)
            normals.SetName("Normals")
            data.GetPointData().SetNormals(normals)
        return data

    def to_open3d(self) -> Any:
        """An ``open3d.geometry.TriangleMesh`` with vertex normals."""
        open3d = need_module("open3d")
        points, triangles = self.mesh
        mesh = open3d.geometry.TriangleMesh(
            open3d.utility.Vector3dVector(np.array(points)), open3d.utility.Vector3iVector(np.array(triangles))
        )
        if len(self.normals):
            mesh.vertex_normals = open3d.utility.Vector3dVector(self.normals.astype(np.float64))
        return mesh
