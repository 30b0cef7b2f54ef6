#!/usr/bin/python3
"""Tiles that isowave writes, as others read them.

    tests/tiles/judged.py PROGRAM

Neuroglancer's own decoder (its npm package, run by node) unpacks every fragment of every level and sorts its triangles into octants;
put together they must be closed, oriented and of the level's volume, and each octant's triangles must lie in it. Khronos' validator must
find no fault in any GLB of the 3D tiles, of levels with colours, or of all levels in one. Both packages: scripts/setup --test. Exit code 77 without them.
"""
import json, os, shutil, struct, subprocess, sys, tempfile

import numpy as np

HERE = os.path.dirname(os.path.abspath(__file__))
PART = os.path.join(HERE, '..', 'data', 'meshes', 'gearwheel.bin.stl')
MODULES = os.path.join(os.environ.get('XDG_CACHE_HOME', os.path.expanduser('~/.cache')), 'isowave', 'node_modules')
STEPS = 65535


def run(*words):
    done = subprocess.run([str(w) for w in words], capture_output=True, text=True)
    if done.returncode:
        raise SystemExit(f'{" ".join(map(str, words))[:200]}: ends with {done.returncode}: {done.stderr}')


def manifest(folder):
    """chunk, origin, and of each level its fragments' positions (n, 3) and sizes."""
    with open(os.path.join(folder, '1.index'), 'rb') as file:
        data = file.read()
    chunk, origin = np.frombuffer(data, '<f4', 3), np.frombuffer(data, '<f4', 3, 12)
    levels = struct.unpack_from('<I', data, 24)[0]
    counts = np.frombuffer(data, '<u4', levels, 28 + 16 * levels)
    place, all_levels = 28 + 20 * levels, []
    for count in counts:
        words = np.frombuffer(data, '<u4', 4 * int(count), place).reshape(4, -1)
        all_levels.append((words[:3].T.astype(np.int64), words[3]))
        place += 16 * int(count)
    return chunk, origin, all_levels


def fragment(path, level):
    """Triangles as points of the fragment's lattice (n, 3, 3), and the octant of each."""
    words = np.fromfile(path, '<u4')
    indices, positions = words[11:11 + words[0]], words[11 + words[0]:11 + words[0] + words[1]]
    octants = np.zeros(words[0] // 3, int)
    if level > 0:
        for octant in range(8):
            octants[words[2 + octant] // 3:words[3 + octant] // 3] = octant
    return positions.reshape(-1, 3)[indices].reshape(-1, 3, 3).astype(np.int64), octants


def check_level(level, corners, chunk, report):
    """corners: (n, 3, 3) points of the level's lattice."""
    points, ids = np.unique(corners.reshape(-1, 3), axis=0, return_inverse=True)
    triangles = ids.reshape(-1, 3)
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    forward = np.unique(edges, axis=0)
    if len(forward) != len(edges):
        raise SystemExit(f'level {level}: an edge runs the same way in two triangles')
    if not np.array_equal(forward, np.unique(edges[:, ::-1], axis=0)):
        raise SystemExit(f'level {level}: open edges')
    step = chunk.astype(float) * 2 ** level / STEPS
    p = (points - points.min(axis=0)) * step
    a, b, c = (p[triangles[:, k]] for k in range(3))
    volume = np.einsum('ij,ij->i', a, np.cross(b, c)).sum() / 6
    if abs(volume - report['volume']) > step.max() * report['area']:
        raise SystemExit(f'level {level}: volume {volume}; expected {report["volume"]}')
    print(f'level {level}: {len(triangles)} triangles, closed, volume {volume:.6g} (mesh {report["volume"]:.6g})')


def judge_neuroglancer(program, work):
    run(program, 'lod', PART, '--voxels', 200, '--levels', '0..3', '--tiles', 'neuroglancer', '-o', f'{work}/part')
    folder, out = f'{work}/part/part_neuroglancer', f'{work}/decoded'
    os.mkdir(out)
    run('node', f'{HERE}/decode.mjs', MODULES, folder, out)
    with open(f'{work}/part/report.json') as file:
        reports = json.load(file)['levels']
    chunk, _, levels = manifest(folder)
    for level, (positions, sizes) in enumerate(levels):
        corners = []
        for i, position in enumerate(positions):
            if not sizes[i]:
                continue
            local, octants = fragment(f'{out}/{level}_{i}', level)
            if local.min() < 0 or local.max() > STEPS:
                raise SystemExit(f'level {level}: a vertex lies beyond its tile')
            for axis in range(3 if level else 0):
                upper = (octants >> axis & 1).astype(bool)
                if (local[upper, :, axis] < 32768).any() or (local[~upper, :, axis] > 32768).any():
                    raise SystemExit(f'level {level}: a triangle crosses its tile\'s middle')
            corners.append(local + position * STEPS)
        check_level(level, np.concatenate(corners), chunk, reports[level])


def judge_glb(program, work):
    run(program, 'lod', PART, '--voxels', 200, '--levels', '0..3', '--tiles', '3d-tiles', '-o', f'{work}/part')
    tiles = [os.path.join(at, name) for at, _, names in os.walk(f'{work}/part/part_3d-tiles') for name in names
             if name.endswith('.glb')]
    run('node', f'{HERE}/decode.mjs', MODULES, '--glb', *tiles)
    print(f'{len(tiles)} GLBs, no error and no warning')


def judge_levels(program, work):
    for kind in 'quantized', 'float':
        run(program, 'lod', PART, '--voxels', 100, '--levels', '0..3', '--format', 'glb', '--colour', 'distance',
            '--glb-lods', kind, '-o', f'{work}/{kind}')
        files = [f'{work}/{kind}/{name}' for name in os.listdir(f'{work}/{kind}') if name.endswith('.glb')]
        if len(files) != 5:
            raise SystemExit(f'{len(files)} GLBs; expected four levels and one of all')
        run('node', f'{HERE}/decode.mjs', MODULES, '--glb', *files)
        print(f'{kind}: {len(files)} GLBs with colours, no error and no warning')


def main():
    program = os.path.abspath(sys.argv[1])
    if not shutil.which('node') or not all(os.path.isdir(f'{MODULES}/{m}') for m in ('neuroglancer', 'gltf-validator')):
        print('skipped: needs node and npm packages; scripts/setup --test gets them')
        return 77
    with tempfile.TemporaryDirectory() as work:
        judge_neuroglancer(program, work)
        judge_glb(program, work)
        judge_levels(program, work)
    return 0


if __name__ == '__main__':
    sys.exit(main())
