#!/usr/bin/python3
"""Meshes as VTK and Python's zipfile write them: what isowave says of them.

    tests/field/meshes.py PROGRAM

A VTP in every way that VTK knows, of polygons, quads and strips, and a 3MF in every unit, plain and deflated. `isowave info` must
give the bounds, `isowave check` the volume, triangles and topology that the shape has. What VTK is needed for is left out, with
a line that says so, where Python has no vtk.
"""
import itertools, json, os, subprocess, sys, tempfile, zipfile

CORNERS = [(x, y, z) for z in (0, 3) for y in (0, 2) for x in (0, 1)]
# The box's sides, counter-clockwise from outside.
QUADS = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]


def told(program, command, path):
    done = subprocess.run([program, command, path, '--json', '-'], capture_output=True, text=True)
    if done.returncode:
        raise SystemExit(f'{path}: {command} ends with {done.returncode}: {done.stderr}')
    return json.loads(done.stdout)


def check(program, path, scale=1.0):
    mesh, info = told(program, 'check', path), told(program, 'info', path)
    expected = {'volume': 6 * scale ** 3, 'area': 22 * scale ** 2, 'triangles': 12, 'vertices': 8, 'components': 1}
    for key, value in expected.items():
        if abs(mesh[key] - value) > 1e-6 * value:
            raise SystemExit(f'{path}: {key} is {mesh[key]}; expected {value}')
    low, high = info['bounds'][:2] if isinstance(info['bounds'], list) else (info['bounds']['low'], info['bounds']['high'])
    for a in range(3):
        if abs(low[a]) > 1e-6 * scale or abs(high[a] - scale * (1, 2, 3)[a]) > 1e-6 * scale:
            raise SystemExit(f'{path}: bounds are {info["bounds"]}')
    print('same', os.path.basename(path))


def three_mf_files(program, folder):
    vertices = ''.join(f'<vertex x="{x}" y="{y}" z="{z}"/>' for x, y, z in CORNERS)
    triangles = ''.join(f'<triangle v1="{a}" v2="{b}" v3="{c}"/><triangle v1="{a}" v2="{c}" v3="{d}"/>' for a, b, c, d in QUADS)
    units = {'micron': 1e-3, 'millimeter': 1, 'centimeter': 10, 'inch': 25.4, 'foot': 304.8, 'meter': 1000}
    for (unit, scale), packed in itertools.product(units.items(), (False, True)):
        path = os.path.join(folder, f'{unit}{"_deflated" * packed}.3mf')
        with zipfile.ZipFile(path, 'w', zipfile.ZIP_DEFLATED if packed else zipfile.ZIP_STORED) as file:
            file.writestr('[Content_Types].xml', '<Types/>')
            file.writestr('3D/3dmodel.model', f'<model unit="{unit}" xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02">'
                          f'<resources><object id="1"><mesh><vertices>{vertices}</vertices><triangles>{triangles}</triangles></mesh>'
                          '</object></resources><build><item objectid="1"/></build></model>')
        check(program, path, scale)


def vtk_files(program, folder):
    try:
        import vtk
    except ImportError:
        print('left out: .vtp, for Python has no vtk')
        return
    points = vtk.vtkPoints()
    for corner in CORNERS:
        points.InsertNextPoint(corner)
    quads = vtk.vtkPolyData()
    quads.SetPoints(points)
    cells = vtk.vtkCellArray()
    for quad in QUADS:
        cells.InsertNextCell(4, quad)
    quads.SetPolys(cells)
    triangles = vtk.vtkTriangleFilter()
    triangles.SetInputData(quads)
    strips = vtk.vtkStripper()
    strips.SetInputConnection(triangles.GetOutputPort())
    strips.Update(), triangles.Update()
    shapes = {'quads': quads, 'triangles': triangles.GetOutput(), 'strips': strips.GetOutput()}
    for (name, shape), mode, packed, encoded, big in itertools.product(shapes.items(), (0, 1, 2), *[(False, True)] * 3):
        if mode == 0 and (packed or encoded) or mode == 1 and encoded:
            continue
        writer = vtk.vtkXMLPolyDataWriter()
        writer.SetInputData(shape)
        writer.SetDataMode(mode)
        writer.SetCompressorTypeToZLib() if packed else writer.SetCompressorTypeToNone()
        writer.SetEncodeAppendedData(encoded)
        writer.SetByteOrder(0 if big else 1)
        path = os.path.join(folder, f'{name}_{mode}{"_zlib" * packed}{"_base64" * encoded}{"_big" * big}.vtp')
        writer.SetFileName(path)
        writer.Write()
        check(program, path)


if __name__ == '__main__':
    with tempfile.TemporaryDirectory() as scratch:
        for files in (three_mf_files, vtk_files):
            files(sys.argv[1], scratch)
