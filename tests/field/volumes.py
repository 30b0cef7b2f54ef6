#!/usr/bin/python3
"""Volumes as numpy, nibabel and VTK write them: what isowave says of them, and where it puts a solid.

    tests/field/volumes.py PROGRAM

A box of other size and place along each axis stands in a volume of 9 x 11 x 13 voxels. Each library writes it in every way that
it knows; `isowave info` must give the library's own size, spacing, directions and origin, and the mesh of the box must have the
bounding box that the library's affine map gives its voxels, to half of a voxel. What VTK is needed for is left out,
with a line that says so, where Python has no vtk.
"""
import gzip, itertools, json, os, struct, subprocess, sys, tempfile

import nibabel
import numpy as np

SIZE = (9, 11, 13)
LOW, HIGH = np.array([2, 3, 5]), np.array([4, 8, 10])  # voxels of the box, inclusive


def box(dtype=np.int16):
    volume = np.zeros(SIZE, dtype)
    volume[LOW[0]:HIGH[0] + 1, LOW[1]:HIGH[1] + 1, LOW[2]:HIGH[2] + 1] = 1
    return volume


def run(program, *arguments):
    done = subprocess.run([program, *map(str, arguments)], capture_output=True, text=True)
    if done.returncode:
        raise SystemExit(f"{' '.join(map(str, arguments))}: ends with {done.returncode}: {done.stderr}")
    return done


def points_of(stl):
    with open(stl, 'rb') as file:
        data = file.read()
    triangles = np.frombuffer(data[84:], np.dtype([('n', '<f4', 3), ('p', '<f4', (3, 3)), ('a', '<u2')]))
    return triangles['p'].reshape(-1, 3)


def check(program, folder, path, affine, space, options=(), mesh=True):
    """affine: from indices to isowave's world, 4 x 4. mesh: make one, too, which takes longer."""
    info = json.loads(run(program, 'info', path, '--json', '-', *options).stdout)
    spacing = np.linalg.norm(affine[:3, :3], axis=0)
    for key, expected in (('dimensions', SIZE), ('spacing', spacing), ('origin', affine[:3, 3]),
                          ('direction', (affine[:3, :3] / spacing).T), ('range', (0, 1))):
        if not np.allclose(info[key], expected, rtol=1e-6, atol=1e-6 * spacing.max()):
            raise SystemExit(f'{path}: {key} is {info[key]}; expected {expected}')
    print('same', os.path.basename(path), *options)
    if info['space'] != space:
        raise SystemExit(f"{path}: space is '{info['space']}'; expected '{space}'")
    if not mesh:
        return
    out = os.path.join(folder, 'out')
    run(program, 'lod', path, '-o', out, '--levels', '0', '--format', 'stl', '--fit', 'binary', *options)
    points = points_of(os.path.join(out, 'out_L0.stl'))
    corners = np.array([affine @ [*c, 1] for c in itertools.product(*zip(LOW - 0.5, HIGH + 0.5))])[:, :3]
    for side in ('min', 'max'):
        seen, expected = getattr(points, side)(axis=0), getattr(corners, side)(axis=0)
        # The spline rounds corners; faces stay within half of a voxel.
        if np.abs(seen - expected).max() > 0.5 * spacing.max():
            raise SystemExit(f'{path}: the mesh has its {side} at {seen}; expected {expected}')
    with open(os.path.join(out, 'report.json')) as file:
        found = json.load(file)['input']['space']
    if found != space:
        raise SystemExit(f"{path}: the report's space is '{found}'; expected '{space}'")


def zipped(path):
    with open(path, 'rb') as file, gzip.open(path + '.gz', 'wb') as out:
        out.write(file.read())
    return path + '.gz'


def numpy_files(program, folder):
    def save(name, array):
        path = os.path.join(folder, name)
        np.save(path, array)
        return path
    eye = np.eye(4)
    for dtype in '?bBhHiIlLefd':
        for order, name in (('<', 'little'), ('>', 'big')):
            kind = np.dtype(dtype).newbyteorder(order)
            if np.dtype(dtype).itemsize == 1 and order == '>':
                continue
            for layout in 'CF':
                path = save(f'{np.dtype(dtype).name}_{name}_{layout}.npy', np.asarray(box(kind), order=layout))
                check(program, folder, path, eye, 'unspecified', mesh=dtype == 'h')
    check(program, folder, zipped(save('c.npy', box())), eye, 'unspecified')
    check(program, folder, zipped(save('f.npy', np.asfortranarray(box()))), eye, 'unspecified')
    check(program, folder, save('s.npy', box()), np.diag([0.5, 1, 2, 1]), 'unspecified', ('--spacing', '0.5x1x2'))
    four = np.stack([0 * box(), 1 - box(), box()], axis=3)
    for layout in 'CF':
        check(program, folder, save(f'four_{layout}.npy', np.asarray(four, order=layout)), eye, 'unspecified',
              ('--volume', '3'))


def nibabel_files(program, folder):
    flip = np.diag([-1.0, -1, 1, 1])
    for cls in (nibabel.AnalyzeImage, nibabel.Spm99AnalyzeImage, nibabel.Spm2AnalyzeImage):
        image = cls(box(), None)
        image.header.set_zooms((0.5, 1.5, 2))
        path = os.path.join(folder, cls.__name__ + '.img')
        nibabel.save(image, path)
        # nibabel puts the origin into the middle, and isowave into the first voxel.
        affine = flip @ image.header.get_base_affine()
        affine[:3, 3] = 0
        for name in (path, path[:-3] + 'hdr'):
            check(program, folder, name, affine, 'unspecified')
        zipped(path), zipped(path[:-3] + 'hdr')
        os.remove(path), os.remove(path[:-3] + 'hdr')
        check(program, folder, path[:-3] + 'hdr.gz', affine, 'unspecified')
    affine = np.array([[0.5, 0.1, 0, -7], [0, 1.5, 0.2, 8], [0, 0, 2, 9], [0, 0, 0, 1]])
    path = os.path.join(folder, 'a.nii.gz')
    nibabel.save(nibabel.Nifti1Image(box(), affine), path)
    check(program, folder, path, flip @ affine, 'lps')


def mrc_files(program, folder):
    """Written by hand after the description of MRC2014."""
    for mode, dtype in ((0, 'i1'), (1, 'i2'), (2, 'f4'), (6, 'u2'), (12, 'f2')):
        for order, stamp in (('<', b'DD\0\0'), ('>', b'\x11\x11\0\0')):
            for axes in itertools.permutations((1, 2, 3)):
                header = bytearray(1024)
                kind = np.dtype(dtype).newbyteorder(order)
                struct.pack_into(order + '10i6f3i', header, 0, *SIZE, mode, 0, 0, 0, 1, 1, 1, 1, 1, 1, 90, 90, 90, *axes)
                along = np.array(axes) - 1
                cell, samples = np.zeros(3), np.zeros(3, int)
                for a, n in zip(along, SIZE):
                    cell[a], samples[a] = n * (0.5, 1.5, 2)[a], n
                struct.pack_into(order + '3i3f', header, 28, *samples, *cell)
                struct.pack_into(order + '2i', header, 88, 1, 80)  # 80 bytes of an extended header
                struct.pack_into(order + '3f', header, 196, -3, 4, 5)
                header[208:216] = b'MAP ' + stamp
                affine = np.eye(4)
                affine[:3, :3] = 0
                for a in range(3):
                    affine[along[a], a] = (0.5, 1.5, 2)[along[a]]
                affine[:3, 3] = -3, 4, 5
                path = os.path.join(folder, f'm{mode}{order}{"".join(map(str, axes))}.mrc'.replace('<', 'l').replace('>', 'b'))
                with open(path, 'wb') as file:
                    file.write(bytes(header) + bytes(80) + box(kind).tobytes(order='F'))
                if axes in ((1, 2, 3), (3, 1, 2)) or mode == 2:
                    check(program, folder, path, affine, 'unspecified', mesh=mode == 2 and order == '<')
    check(program, folder, zipped(path), affine, 'unspecified')


def vtk_files(program, folder):
    try:
        import vtk
        from vtk.util.numpy_support import numpy_to_vtk
    except ImportError:
        print('left out: .vti, for Python has no vtk')
        return
    turn = np.array([[0.0, -1, 0], [0.6, 0, -0.8], [0.8, 0, 0.6]])
    types = (np.int8, np.uint8, np.int16, np.uint16, np.int32, np.uint32, np.int64, np.uint64, np.float32, np.float64)
    modes = {'ascii': 0, 'binary': 1, 'appended': 2}
    for dtype, mode, packed, encoded in itertools.product(types, modes, (False, True), (False, True)):
        if mode == 'ascii' and (packed or encoded) or mode == 'binary' and encoded:
            continue
        for order in ('little', 'big'):
            if order == 'big' and dtype != np.float32:
                continue
            image = vtk.vtkImageData()
            image.SetDimensions(SIZE)
            image.SetSpacing(0.5, 1.5, 2)
            image.SetOrigin(-7, 8, 9)
            image.SetDirectionMatrix(turn.ravel())
            scalars = numpy_to_vtk(box(dtype).ravel(order='F'), deep=True)
            scalars.SetName('density')
            image.GetPointData().SetScalars(scalars)
            other = numpy_to_vtk(np.random.default_rng(1).random((box().size, 3)), deep=True)
            other.SetName('velocity')
            writer = vtk.vtkXMLImageDataWriter()
            writer.SetInputData(image)
            writer.SetDataMode(modes[mode])
            writer.SetCompressorTypeToZLib() if packed else writer.SetCompressorTypeToNone()
            writer.SetEncodeAppendedData(encoded)
            writer.SetByteOrder(0 if order == 'big' else 1)
            writer.SetHeaderTypeToUInt64() if dtype == np.uint8 else writer.SetHeaderTypeToUInt32()
            writer.SetBlockSize(256)
            affine = np.eye(4)
            affine[:3, :3] = turn * (0.5, 1.5, 2)
            affine[:3, 3] = -7, 8, 9
            name = f'{np.dtype(dtype).name}_{mode}{"_zlib" * packed}{"_base64" * encoded}_{order}'
            path = os.path.join(folder, name + '.vti')
            writer.SetFileName(path)
            writer.Write()
            check(program, folder, path, affine, 'unspecified', mesh=dtype == np.float32)
            if dtype == np.uint16:
                check(program, folder, zipped(path), affine, 'unspecified')
                image.GetPointData().AddArray(other)
                writer.Write()
                check(program, folder, path, affine, 'unspecified')
                check(program, folder, path, affine, 'unspecified', ('--volume', '1'))


if __name__ == '__main__':
    with tempfile.TemporaryDirectory() as scratch:
        for files in (numpy_files, nibabel_files, mrc_files, vtk_files):
            files(sys.argv[1], scratch)
