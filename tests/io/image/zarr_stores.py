#!/usr/bin/python3
"""zarr_stores.py FOLDER: stores as python3-zarr writes them, a folder each, and what must be read from them.

Of each store list.json has name, path, options, size (x, y, z), spacing, origin, and the file of its voxels: float32, x fastest. The values are
those that zarr itself reads back. Prints one word, "zarr" or "none", whether Python has zarr.
"""
import json, os, sys

import numpy as np

try:
    import numcodecs
    import zarr
except ImportError:
    print('none')
    sys.exit()

FOLDER = sys.argv[1]
RANDOM = np.random.default_rng(1)
CODECS = {'none': None, 'zlib': numcodecs.Zlib(1), 'gzip': numcodecs.GZip(1), 'zstd': numcodecs.Zstd(3), 'lz4': numcodecs.LZ4()}
for cname in ('blosclz', 'lz4', 'lz4hc', 'zlib', 'zstd'):
    for shuffle in (0, 1, 2):
        CODECS[f'blosc-{cname}-{shuffle}'] = numcodecs.Blosc(cname, 5, shuffle)
TYPES = ('|b1', '|u1', '|i1', '<u2', '>i2', '<i4', '>u4', '<f4', '>f4', '<f8', '<i8')
ENTRIES = []


def values(shape, dtype):
    kind = np.dtype(dtype).kind
    if kind == 'f':
        return RANDOM.normal(size=shape).astype('f4').astype(dtype)
    if kind == 'b':
        return RANDOM.random(shape) < 0.5
    info = np.iinfo(dtype)
    return RANDOM.integers(max(info.min, -30000), min(info.max, 60000), size=shape).astype(dtype)


def expect(name, volume_zyx, path=None, spacing=(1, 1, 1), origin=(0, 0, 0), remark='', **options):
    np.ascontiguousarray(volume_zyx, dtype='<f4').tofile(os.path.join(FOLDER, name + '.raw'))
    ENTRIES.append({'name': name, 'path': path or name, 'options': options, 'size': list(volume_zyx.shape[::-1]),
                    'spacing': list(spacing), 'origin': list(origin), 'remark': remark})


def store(name, data, chunks, dtype, attributes=None, **how):
    array = zarr.open(os.path.join(FOLDER, name), mode='w', shape=data.shape, chunks=chunks, dtype=dtype, **how)
    array[:] = data
    if attributes:
        array.attrs.update(attributes)
    return array


def plain_arrays():
    shape = (7, 10, 9)
    for codec, compressor in CODECS.items():
        for order in 'CF':
            data = values(shape, '<u2')
            array = store(f'{codec}-{order}', data, (3, 4, 5), '<u2', compressor=compressor, order=order)
            expect(f'{codec}-{order}', array[:], remark='z, y, x')
    for i, dtype in enumerate(TYPES):
        array = store(f'type-{i}', values(shape, dtype), (4, 10, 3), dtype, dimension_separator='/./'[2 * (i % 2):][:1])
        expect(f'type-{i}', array[:])
    array = store('one-chunk', values(shape, '<i2'), (16, 16, 16), '<i2')
    expect('one-chunk', array[:])
    array = store('named', values((9, 7, 10), '<i2'), (4, 4, 4), '<i2', {'_ARRAY_DIMENSIONS': ['x', 'z', 'y']})
    expect('named', array[:].transpose(1, 2, 0))
    array = zarr.open(os.path.join(FOLDER, 'sparse'), mode='w', shape=(8, 8, 8), chunks=(4, 4, 4), dtype='<i2', fill_value=-7)
    array[:4, :4] = values((4, 4, 8), '<i2')
    expect('sparse', array[:], remark='6 of 8 chunks are not there; their voxels are the fill value, -7')


def image(name, shapes, axes, scales, **attributes):
    group = zarr.open_group(os.path.join(FOLDER, name), mode='w')
    arrays, datasets = [], []
    for i, (shape, transforms) in enumerate(zip(shapes, scales)):
        array = group.create_dataset(str(i), shape=shape, chunks=tuple(min(4, n) for n in shape), dtype='<u2',
                                     dimension_separator='/')
        array[:] = values(shape, '<u2')
        arrays.append(array)
        datasets.append({'path': str(i), **({'coordinateTransformations': transforms} if transforms else {})})
    entry = {'version': '0.4', 'datasets': datasets, **({'axes': axes} if axes else {}), **attributes}
    group.attrs['multiscales'] = [entry]
    return arrays


def scale(*numbers):
    return {'type': 'scale', 'scale': numbers}


def move(*numbers):
    return {'type': 'translation', 'translation': numbers}


def ome_images():
    space = [{'name': n, 'type': 'space', 'unit': 'micrometer'} for n in 'zyx']
    fine, coarse = image('scan.ome.zarr', [(6, 8, 10), (3, 4, 5)], space,
                         [[scale(4, 2, 1), move(10, 20, 30)], [scale(8, 4, 2), move(12, 21, 30.5)]])
    expect('ome', fine[:], 'scan.ome.zarr', (0.001, 0.002, 0.004), (0.03, 0.02, 0.01), 'micrometer')
    expect('ome-1', coarse[:], 'scan.ome.zarr/1', (0.002, 0.004, 0.008), (0.0305, 0.021, 0.012))
    expect('ome-slash', fine[:], 'scan.ome.zarr/0/', (0.001, 0.002, 0.004), (0.03, 0.02, 0.01))
    nano = [{'name': n, 'type': 'space', 'unit': 'nanometer'} for n in 'zyx']
    array, = image('nano.zarr', [(4, 5, 6)], nano, [[scale(40, 8, 8)]],
                   coordinateTransformations=[scale(2, 2, 2), move(1000, 0, 0)])
    expect('nano', array[:], 'nano.zarr', (16e-6, 16e-6, 80e-6), (0, 0, 1e-3))
    times = [{'name': 't', 'type': 'time', 'unit': 'second'}, {'name': 'c', 'type': 'channel'}] + space
    array, = image('film.zarr', [(3, 2, 5, 6, 7)], times, [[scale(1, 1, 3, 2, 1)]])
    expect('film', array[2, 1], 'film.zarr', (0.001, 0.002, 0.003), time=3, channel=2)
    expect('film-first', array[0, 0], 'film.zarr', (0.001, 0.002, 0.003), time=1, channel=1)
    array, = image('old.zarr', [(1, 1, 5, 6, 7)], None, [None])
    expect('old', array[0, 0], 'old.zarr')
    array, = image('flipped.zarr', [(5, 6, 7)], [{'name': n, 'type': 'space'} for n in 'yxz'], [[scale(1, 2, 3)]])
    expect('flipped', array[:].transpose(2, 0, 1), 'flipped.zarr', (2, 1, 3), remark='no unit')


plain_arrays()
ome_images()
with open(os.path.join(FOLDER, 'list.json'), 'w') as file:
    json.dump(ENTRIES, file)
print('zarr')
