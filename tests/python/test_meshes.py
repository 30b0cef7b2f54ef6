"""Meshes of all kinds, in and out."""

import sys
import types

import numpy as np
import pytest
from conftest import DATA, GEAR, command

import isowave

POINTS = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], float)
FACES = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])


class Trimesh:
    vertices, faces = POINTS, FACES


class Open3d:
    vertices, triangles = POINTS.tolist(), FACES.tolist()


class PyVista:
    points = POINTS.astype(np.float32)
    faces = np.column_stack([np.full(4, 3), FACES]).ravel()


@pytest.mark.parametrize("mesh", [Trimesh(), Open3d(), PyVista(), (POINTS, FACES), (POINTS.tolist(), FACES.tolist()),
                                  isowave.Mesh(POINTS, FACES.astype(np.int32)), (POINTS.astype(">f4"), FACES.astype(np.uint8))])  # fmt: skip
def test_a_mesh_by_what_it_holds(mesh):
    assert isowave.check(mesh).volume == pytest.approx(1 / 6)
    assert isowave.lod(mesh, voxels=24, levels=0)[0].report["volume"] == pytest.approx(1 / 6, rel=0.02)
    assert len(isowave.subdivide(mesh, scheme="loop").faces) == 16


def test_a_path_is_read():
    assert isowave.check(GEAR).report["input"]["path"] == str(GEAR)
    assert isowave.check(str(GEAR)).closed


@pytest.mark.parametrize(
    "mesh, words",
    [
        ((POINTS, FACES + 1), "face 1 has the corner 4; there are 4 points"),
        ((POINTS, FACES - 1), "face 0 has the corner -1"),
        ((POINTS, FACES[:0]), "has no triangles"),
        ((POINTS * [1, 1, np.nan], FACES), r"point 0 .* is not finite"),
        ((POINTS[:, :2], FACES), r"points have the shape \(4, 2\)"),
        ((POINTS, FACES.astype(float)), "faces have the type float64"),
        ((POINTS, FACES[:, [0, 1, 2, 0]]), r"faces have the shape \(4, 4\); expected triangles"),
        ((POINTS, [[0, 1, 2], [0, 1, 2, 3]]), "face 1 has 4 corners"),
    ],
)
def test_what_is_no_mesh_of_triangles_is_refused(mesh, words):
    for use in (isowave.check, isowave.lod):
        with pytest.raises(isowave.InputError, match=words) as caught:
            use(mesh)
        assert "\n" not in str(caught.value)


def test_a_place_is_not_for_meshes():
    with pytest.raises(isowave.UsageError, match="spacing says where an array lies; a mesh has a place"):
        isowave.lod(POINTS, FACES, spacing=(1, 1, 1))


def test_check_is_that_of_the_command(tmp_path):
    import json

    result = command("check", GEAR, "--json", "-", "--self-intersections")
    assert json.loads(result.stdout) == isowave.check(GEAR, self_intersections=True).report
    opened = isowave.check(POINTS, FACES[1:])
    assert not opened and not opened.closed and opened.genus is None
    assert not isowave.check(POINTS, [[0, 1, 2], *FACES[1:].tolist()]).oriented


def test_compare_is_that_of_the_command(tmp_path):
    import json

    ladder = isowave.lod(GEAR, voxels=48, levels=2)
    ladder[0].save(tmp_path / "coarse.ply")
    result = command("compare", GEAR, tmp_path / "coarse.ply", "--json", "-", "--sampling", 0.5)
    of_files = isowave.compare(GEAR, tmp_path / "coarse.ply", sampling=0.5)
    assert of_files.report == json.loads(result.stdout)
    of_arrays = isowave.compare(GEAR, ladder[0], sampling=0.5)
    assert of_arrays.rms == pytest.approx(of_files.rms, rel=1e-3) and of_arrays.max <= of_arrays.max_bound
    with pytest.raises(isowave.UsageError, match="--sampling"):
        isowave.compare(GEAR, GEAR, sampling=-1)


# ---- adapters: with the package itself where it is installed, else with what it is asked for


@pytest.fixture(scope="module")
def level():
    return isowave.lod(GEAR, voxels=48, levels=1)[0]


def test_to_vtk_and_back(level):
    pytest.importorskip("vtkmodules.vtkCommonDataModel")
    from vtkmodules.vtkFiltersCore import vtkMassProperties

    data = level.to_vtk()
    assert data.GetNumberOfCells() == len(level.triangles) and data.GetNumberOfPoints() == len(level.points)
    measured = vtkMassProperties()
    measured.SetInputData(data)
    assert measured.GetVolume() == pytest.approx(level.report["volume"], rel=1e-5)
    back = isowave.check(data)
    assert back and back.volume == pytest.approx(level.report["volume"], rel=1e-12)


def test_to_open3d_and_back(level):
    pytest.importorskip("open3d")
    mesh = level.to_open3d()
    assert mesh.is_watertight() and mesh.get_volume() == pytest.approx(level.report["volume"], rel=1e-9)
    assert isowave.check(mesh).volume == pytest.approx(level.report["volume"], rel=1e-12)


def test_to_trimesh_and_back(level, monkeypatch):
    try:
        import trimesh
    except ImportError:
        made = lambda vertices, faces, process: types.SimpleNamespace(vertices=vertices, faces=faces, process=process)  # noqa: E731
        monkeypatch.setitem(sys.modules, "trimesh", types.SimpleNamespace(Trimesh=made))
    mesh = level.to_trimesh()
    assert len(mesh.faces) == len(level.triangles) and mesh.vertices.flags.writeable
    assert isowave.check(mesh).volume == pytest.approx(level.report["volume"], rel=1e-12)


def test_to_pyvista_and_back(level, monkeypatch):
    try:
        import pyvista
    except ImportError:
        made = lambda points, faces: types.SimpleNamespace(points=points, faces=faces, point_data={})  # noqa: E731
        monkeypatch.setitem(sys.modules, "pyvista", types.SimpleNamespace(PolyData=made))
    mesh = level.to_pyvista()
    assert mesh.point_data["Normals"].shape == level.points.shape
    assert isowave.check(mesh).volume == pytest.approx(level.report["volume"], rel=1e-12)


def test_a_missing_package_is_named(level, monkeypatch):
    monkeypatch.setitem(sys.modules, "open3d", None)
    with pytest.raises(ImportError, match="needs the package open3d"):
        level.to_open3d()
