#!/usr/bin/python3
"""What users have beside isowave, each one process from a file to files. Called by bench/whole/run.

    rivals.py vtk IMAGE ISO OUT SHARE...        VTK: FlyingEdges, then quadric decimation to these shares of the triangles
    rivals.py pooled IMAGE ISO OUT LEVELS       NumPy and scikit-image: mean-pooling by two, marching cubes

IMAGE: .nii.gz, .nhdr/.nrrd with raw data. Meshes are written as binary PLY and STL.
"""
import pathlib
import sys

import numpy as np


def voxels_of(path):
    """The array in (x, y, z) order, and the spacing."""
    if ".nii" in path.name:
        import nibabel

        image = nibabel.load(path)
        return np.asarray(image.dataobj), image.header.get_zooms()[:3]
    head, _, rest = path.read_bytes().partition(b"\n\n")
    fields = dict(line.split(": ", 1) for line in head.decode().splitlines() if ": " in line)
    raw = (path.parent / fields["data file"]).read_bytes() if "data file" in fields else rest
    size = [int(n) for n in fields["sizes"].split()]
    return np.frombuffer(raw, fields["type"]).reshape(size, order="F"), [float(s) for s in fields["spacings"].split()]


def vtk_levels(path, iso, out, shares):
    import vtkmodules.all as vtk
    from vtkmodules.util.numpy_support import numpy_to_vtk

    voxels, spacing = voxels_of(path)
    image = vtk.vtkImageData()
    image.SetDimensions(voxels.shape)
    image.SetSpacing(*map(float, spacing))
    image.GetPointData().SetScalars(numpy_to_vtk(voxels.ravel(order="F"), deep=False))
    contour = vtk.vtkFlyingEdges3D()
    contour.SetInputData(image)
    contour.SetValue(0, iso)
    contour.ComputeNormalsOff()
    contour.ComputeScalarsOff()
    contour.Update()
    mesh, all_triangles = contour.GetOutput(), contour.GetOutput().GetNumberOfCells()
    for level, share in enumerate([1.0, *shares]):
        if level > 0:  # each from the one before, which is the fastest way to have them all
            decimate = vtk.vtkQuadricDecimation()
            decimate.SetInputData(mesh)
            decimate.SetTargetReduction(1 - min(1, share * all_triangles / max(1, mesh.GetNumberOfCells())))
            decimate.Update()
            mesh = decimate.GetOutput()
        writer = vtk.vtkPLYWriter()
        writer.SetFileName(f"{out}_L{level}.ply")
        writer.SetFileTypeToBinary()
        writer.SetInputData(mesh)
        writer.Write()


def pooled(voxels):
    even = voxels[tuple(slice(0, n // 2 * 2) for n in voxels.shape)]
    return even.reshape(sum(((n // 2, 2) for n in voxels.shape), ())).mean(axis=(1, 3, 5), dtype=np.float32)


def write_stl(path, points, triangles):
    record = np.zeros(len(triangles), dtype=[("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("rest", "<u2")])
    record["corners"] = points[triangles]
    path.write_bytes(bytes(80) + np.uint32(len(triangles)).tobytes() + record.tobytes())


def pooled_levels(path, iso, out, levels):
    from skimage.measure import marching_cubes

    voxels, spacing = voxels_of(path)
    for level in range(levels + 1):
        if voxels.min() < iso < voxels.max():
            points, triangles, _, _ = marching_cubes(voxels.astype(np.float32), iso, spacing=[s * 2**level for s in spacing])
            write_stl(pathlib.Path(f"{out}_L{level}.stl"), points, triangles)
        voxels = pooled(voxels)


def main():
    kind, path, iso, out = sys.argv[1], pathlib.Path(sys.argv[2]), float(sys.argv[3]), sys.argv[4]
    if kind == "vtk":
        vtk_levels(path, iso, out, [float(s) for s in sys.argv[5:]])
    else:
        pooled_levels(path, iso, out, int(sys.argv[5]))


if __name__ == "__main__":
    main()
