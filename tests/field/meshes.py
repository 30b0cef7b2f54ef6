#!/usr/bin/python3
"""Meshes as VTK and Python's zipfile write them: what isowave says of them; and what isowave writes: what they say of it.

    tests/field/meshes.py PROGRAM

A VTP in every way that VTK knows, of polygons, quads and strips, and a 3MF in every unit, plain and deflated. `isowave info` must
give the bounds, `isowave check` the volume, triangles and topology that the shape has. Levels that isowave writes as VTP are for VTK
the points and triangles that they are as PLY, and their distances those that VTK measures to level 0; as 3MF they are well-formed
XML with the volume in the unit that is asked for, and for prusa-slicer a manifold of that volume. What VTK or prusa-slicer is needed
for is left out, with a line that says so, where it is not there.
"""
import itertools, json, os, re, shutil, subprocess, sys, tempfile, xml.etree.ElementTree, zipfile

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


GEAR = os.path.join(os.path.dirname(__file__), '../data/meshes/gearwheel.bin.stl')


def ladder(program, folder, name, *options):
    out = os.path.join(folder, name)
    subprocess.run([program, 'lod', GEAR, '--voxels', '32', '--levels', '0..2', '-o', out, '--quiet', *options], check=True, stdout=subprocess.DEVNULL)
    with open(os.path.join(out, 'report.json')) as file:
        return [os.path.join(out, level['file']) for level in json.load(file)['levels']]


def vtk_of(reader, path):
    reader.SetFileName(path)
    reader.Update()
    return reader.GetOutput()


def written_vtp(program, folder):
    try:
        import vtk
        from vtk.util.numpy_support import vtk_to_numpy
    except ImportError:
        print('left out: .vtp written, for Python has no vtk')
        return
    plain = ladder(program, folder, 'plain', '--format', 'ply')
    coloured = ladder(program, folder, 'coloured', '--format', 'vtp', '--colour', 'distance')
    level0 = vtk_of(vtk.vtkXMLPolyDataReader(), coloured[0])
    locator = vtk.vtkStaticCellLocator()
    locator.SetDataSet(level0)
    locator.BuildLocator()
    cell, closest = vtk.vtkGenericCell(), [0.0] * 3
    for ply, vtp in zip(plain, coloured):
        expected, mesh = vtk_of(vtk.vtkPLYReader(), ply), vtk_of(vtk.vtkXMLPolyDataReader(), vtp)
        points, triangles = (vtk_to_numpy(mesh.GetPoints().GetData()), vtk_to_numpy(mesh.GetPolys().GetConnectivityArray()))
        assert (points == vtk_to_numpy(expected.GetPoints().GetData())).all(), vtp
        assert (triangles == vtk_to_numpy(expected.GetPolys().GetConnectivityArray())).all() and len(triangles) > 3, vtp
        assert (vtk_to_numpy(mesh.GetPolys().GetOffsetsArray())[1:] % 3 == 0).all(), vtp
        assert mesh.GetPointData().GetScalars().GetName() == 'distance_to_level0', vtp
        assert mesh.GetPointData().GetNormals().GetNumberOfTuples() == len(points), vtp
        distances = vtk_to_numpy(mesh.GetPointData().GetScalars())
        assert (vtp == coloured[0]) == (distances.max() == 0), vtp
        for point, distance in zip(points, distances):
            squared = vtk.reference(0.0)
            locator.FindClosestPoint([float(x) for x in point], closest, cell, vtk.reference(0), vtk.reference(0), squared)
            # float32 coordinates about 20: 2e-6 apart.
            assert abs(float(squared) ** 0.5 - distance) < 1e-5, (vtp, point, distance, float(squared) ** 0.5)
        print('same', os.path.basename(vtp), len(points), 'points, the farthest', distances.max())


def written_3mf(program, folder):
    name = '{http://schemas.microsoft.com/3dmanufacturing/core/2015/02}'
    slicer = shutil.which('prusa-slicer')
    for unit, word in ('mm', 'millimeter'), ('in', 'inch'):
        for path in ladder(program, folder, unit, '--format', '3mf', '--unit', unit):
            with zipfile.ZipFile(path) as archive:
                assert archive.testzip() is None, path
                model = xml.etree.ElementTree.fromstring(archive.read('3D/3dmodel.model'))
            assert model.get('unit') == word, path
            objects = model.findall(f'{name}resources/{name}object')
            assert len(objects) == len(model.findall(f'{name}build/{name}item')) >= 1, path
            volume = told(program, 'check', path)['volume']
            six = 0
            for mesh in model.iter(name + 'mesh'):
                at = [[float(v.get(a)) for a in 'xyz'] for v in mesh.iter(name + 'vertex')]
                for t in mesh.iter(name + 'triangle'):
                    (a, b, c), (d, e, f), (g, h, i) = (at[int(t.get(v))] for v in ('v1', 'v2', 'v3'))
                    six += a * (e * i - f * h) + b * (f * g - d * i) + c * (d * h - e * g)
            scale = 25.4 ** 3 if unit == 'in' else 1
            assert abs(six / 6 * scale / volume - 1) < 1e-6, (path, six, volume)
            if slicer:
                info = subprocess.run([slicer, '--info', path], capture_output=True, text=True, check=True).stdout
                assert 'manifold = yes' in info, (path, info)
                volumes = [float(v) for v in re.findall(r'volume = ([0-9.]+)', info)]
                assert abs(sum(volumes) / volume - 1) < 1e-3, (path, info)
            print('same', os.path.basename(path), unit)
    if not slicer:
        print('left out: what prusa-slicer says of a .3mf, for it is not there')


if __name__ == '__main__':
    with tempfile.TemporaryDirectory() as scratch:
        for files in (three_mf_files, vtk_files, written_vtp, written_3mf):
            files(sys.argv[1], scratch)
