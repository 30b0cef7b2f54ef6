#!/usr/bin/python3
"""Images of a folder, as isowave reads them and as the format's own library does: a table, one line a file.

    tests/field/compare_images.py FOLDER [--isowave PROGRAM] [--timeout SECONDS] [--mesh]

Every file below FOLDER is given to `isowave info --json -`. What it says (voxels on each axis, place of each corner voxel in
LPS mm, least and greatest value) is compared with nibabel (NIfTI, MGH), pynrrd (NRRD), tifffile (TIFF), pydicom (DICOM) and
SimpleITK (MetaImage), as far as these are installed for the Python that runs this. --mesh: files of less than a million
voxels are meshed, too, at the middle of their range, and the mesh's bounding box must lie in the image's.

    same      both read it and agree           refused   isowave refuses it in one line, which is shown
    DIFFERS   they disagree                    alone     isowave reads it, the library does not, or is not installed
    BROKEN    a crash, several lines, no output, or more than SECONDS

Ends with 4 when a line says DIFFERS or BROKEN, otherwise with 0.
"""
import argparse, collections, gzip, json, os, subprocess, sys, tempfile
import numpy as np

RAS2LPS = np.diag([-1.0, -1.0, 1.0])
Truth = collections.namedtuple('Truth', 'size step origin values note')  # step: columns, mm, LPS; None: not known


def library(name):
    try:
        return __import__(name)
    except ImportError:
        return None


nibabel, nrrd, tifffile, pydicom, sitk = map(library, ('nibabel', 'nrrd', 'tifffile', 'pydicom', 'SimpleITK'))


def first_bytes(path, count=400):
    with open(path, 'rb') as file:
        head = file.read(count)
    if head[:2] != b'\x1f\x8b':
        return head
    try:
        with gzip.open(path) as file:
            return file.read(count)
    except (OSError, EOFError):
        return b''


def kind_of(path):
    head = first_bytes(path)
    if head[:4] == b'NRRD':
        return 'nrrd'
    if head[128:132] == b'DICM':
        return 'dicom'
    if head[:2] in (b'II', b'MM') and head[2:4] in (b'*\0', b'\0*', b'+\0', b'\0+'):
        return 'tiff'
    if head[344:347] in (b'n+1', b'ni1') or head[4:7] in (b'n+2', b'ni2'):
        return 'nifti'
    if path.lower().endswith(('.mha', '.mhd')):
        return 'meta'
    return 'mgh' if path.lower().endswith(('.mgz', '.mgh')) else None


# ---- what the libraries say

def by_nibabel(path):
    if nibabel is None:
        return None
    image = nibabel.load(path)
    affine, size = np.array(image.affine), image.shape[:3]
    header, note = image.header, ''
    if kind_of(path) == 'nifti':
        if header['sform_code'] <= 0 and header['qform_code'] <= 0:  # nibabel centres and mirrors; NIfTI's method 1 does not
            affine, note = np.diag([*header.get_zooms()[:3], 1.0]), 'no orientation: method 1'
        affine[:3] *= {1: 1e3, 3: 1e-3}.get(int(header['xyzt_units']) & 7, 1.0)
    values = np.asanyarray(image.dataobj)
    while values.ndim > 3:
        values = values[..., 0]
    return Truth(size, RAS2LPS @ affine[:3, :3], RAS2LPS @ affine[:3, 3], values, note)


SIDES = {'right': (0, -1), 'left': (0, 1), 'anterior': (1, -1), 'posterior': (1, 1), 'superior': (2, 1), 'inferior': (2, -1)}
UNITS = {'um': 1e-3, 'microns': 1e-3, 'micron': 1e-3, '\u00b5m': 1e-3, 'm': 1e3, 'cm': 10.0, 'nm': 1e-6, 'mm': 1.0}


def by_nrrd(path):
    if nrrd is None:
        return None
    values, header = nrrd.read(path)
    directions = header.get('space directions')
    if directions is None:
        spacing = np.array(header.get('spacings', np.ones(values.ndim)), float)
        spacing[np.isnan(spacing)] = 1
        return Truth(values.shape[:3], np.diag(spacing[:3]), np.zeros(3), values, '') if values.ndim == 3 else None
    rows = [np.array(d, float) for d in directions]
    spatial = [i for i, d in enumerate(rows) if d.ndim and np.all(np.isfinite(d))]
    if values.ndim > len(spatial) and values.size == np.prod([values.shape[i] for i in spatial]):
        values = values.reshape([values.shape[i] for i in spatial])
    factor = np.ones(3)
    space = header.get('space', '').lower()
    letters = {k[0]: k for k in SIDES}
    words = space.split('-')[:3] if '-' in space else [letters.get(c, c) for c in space[:3]]
    if all(w in SIDES for w in words) and len(words) == 3:
        for word in words:
            factor[SIDES[word][0]] *= SIDES[word][1]
    units = [u.strip('"') for u in header.get('space units', [])]
    for axis, unit in enumerate(units[:3]):
        factor[axis] *= UNITS.get(unit, 1.0)
    step = np.array([rows[i][:3] for i in spatial[:3]]).T * factor[:, None]
    origin = np.array(header.get('space origin', np.zeros(3)), float)[:3] * factor
    return Truth(values.shape, step, origin, values, '') if values.ndim == 3 else None


def by_tifffile(path):
    if tifffile is None:
        return None
    values = tifffile.imread(path)
    if values.ndim != 3:
        return None
    return Truth(values.shape[::-1], None, None, values, '')


def by_pydicom(path):
    if pydicom is None:
        return None
    image = pydicom.dcmread(path)
    size = (image.Columns, image.Rows, int(getattr(image, 'NumberOfFrames', 1)))
    try:
        values = image.pixel_array * float(getattr(image, 'RescaleSlope', 1)) + float(getattr(image, 'RescaleIntercept', 0))
    except Exception:  # a compressed transfer syntax that needs another library
        values = None
    return Truth(size, None, None, values, '')


def by_simpleitk(path):
    if sitk is None:
        return None
    image = sitk.ReadImage(path)
    if image.GetDimension() != 3:
        return None
    step = np.array(image.GetDirection()).reshape(3, 3) * np.array(image.GetSpacing())
    return Truth(image.GetSize(), step, np.array(image.GetOrigin()), sitk.GetArrayFromImage(image), '')


READERS = {'nifti': by_nibabel, 'mgh': by_nibabel, 'nrrd': by_nrrd, 'tiff': by_tifffile, 'dicom': by_pydicom,
           'meta': by_simpleitk}


def truth_of(path, kind):
    "(Truth or None, what the library said when it refused)"
    try:
        return READERS[kind](path), ''
    except Exception as e:
        return None, f'{type(e).__name__}: {str(e)[:60]}'.replace('\n', ' ')


# ---- what isowave says

def run(options, *arguments):
    try:
        done = subprocess.run([options.isowave, *arguments], capture_output=True, text=True, errors='replace',
                              timeout=options.timeout)
    except subprocess.TimeoutExpired:
        return 'timeout', '', ''
    return done.returncode, done.stdout, done.stderr


def corners(size, step, origin):
    grid = np.array([[i, j, k] for i in (0, size[0] - 1) for j in (0, size[1] - 1) for k in (0, size[2] - 1)], float)
    return grid @ np.asarray(step).T + origin


def place_of(info):
    step = np.array(info['direction']).T * np.array(info['spacing'])
    return step, np.array(info['origin'])


def differences(info, truth):
    found = []
    if tuple(info['dimensions']) != tuple(int(n) for n in truth.size):
        return [f"size {info['dimensions']} for {list(truth.size)}"]
    if truth.step is not None:
        mine, theirs = corners(truth.size, *place_of(info)), corners(truth.size, truth.step, truth.origin)
        far, voxel = np.abs(mine - theirs).max(), np.linalg.norm(truth.step, axis=0).min()
        if not far <= 1e-3 * voxel + 1e-6 * np.abs(theirs).max():  # float32 in some headers
            found.append(f'corner {far:.4g} mm away')
    if truth.values is not None and truth.values.dtype.names is None:
        low, high = (float(np.float32(x)) for x in (truth.values.min(), truth.values.max()))
        near = 1e-5 * max(abs(low), abs(high), 1e-30)
        if not (abs(low - info['range'][0]) <= near and abs(high - info['range'][1]) <= near):
            found.append(f"values {info['range']} for {[low, high]}")
    return found


def mesh_complaint(options, path, info, volume):
    "whether the box of a mesh at the middle of the range lies in the image's, a voxel beyond it allowed"
    low, high = info['range']
    if np.prod(info['dimensions']) > 1e6 or low is None or high is None or low == high:
        return ''
    with tempfile.TemporaryDirectory() as folder:
        out = os.path.join(folder, 'mesh.off')
        code, _, _ = run(options, 'mesh', path, *volume, '--iso', repr((low + high) / 2), '-o', out)
        if code != 0:
            return '' if code in (1, 2, 3) else f'mesh ends with {code}'
        with open(out) as file:
            words = [word for line in file if not line.startswith('#') for word in line.split()]
        points = np.array(words[4:4 + 3 * int(words[1])], float).reshape(-1, 3)
    step, origin = place_of(info)
    box, edge = corners(info['dimensions'], step, origin), np.abs(step).sum(1)
    inside = np.all(points.min(0) >= box.min(0) - edge) and np.all(points.max(0) <= box.max(0) + edge)
    return '' if inside else 'mesh lies outside the image'


def judge(options, path, kind):
    volume = []
    code, out, err = run(options, 'info', path, '--json', '-')
    if code == 3 and '--volume' in err:  # of several the first one
        volume = ['--volume', '1']
        code, out, err = run(options, 'info', path, '--json', '-', *volume)
    lines = [line for line in err.replace('\r', '\n').splitlines() if line.strip()]
    if code in (2, 3):
        said = lines[-1] if lines else ''
        return ('refused' if len(lines) == 1 else 'BROKEN'), said.replace(path, os.path.basename(path))
    if code != 0:
        return 'BROKEN', f'ends with {code}: {lines[-1] if lines else ""}'
    try:
        info = json.loads(out)
    except ValueError:
        return 'BROKEN', 'no JSON'
    if info.get('kind') != 'image':
        return 'alone', f"read as {info.get('kind')}"
    truth, said = truth_of(path, kind)
    complaint = mesh_complaint(options, path, info, volume) if options.mesh else ''
    if truth is None:
        return ('DIFFERS', complaint) if complaint else ('alone', said)
    found = differences(info, truth) + ([complaint] if complaint else [])
    return ('DIFFERS', '; '.join(found)) if found else ('same', truth.note + (' volume 1' if volume else ''))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('folder')
    parser.add_argument('--isowave', default=os.environ.get('ISOWAVE', 'isowave'))
    parser.add_argument('--timeout', type=float, default=60)
    parser.add_argument('--mesh', action='store_true')
    options = parser.parse_args()
    count = collections.Counter()
    for folder, _, names in sorted(os.walk(options.folder)):
        for name in sorted(names):
            path = os.path.join(folder, name)
            kind = kind_of(path)
            if kind is None:
                continue
            verdict, why = judge(options, path, kind)
            count[verdict] += 1
            print(f'{verdict:8} {kind:6} {os.path.relpath(path, options.folder)}  {why}', flush=True)
    print(', '.join(f'{n} {verdict}' for verdict, n in sorted(count.items())) or 'no images found')
    return 4 if count['DIFFERS'] + count['BROKEN'] else 0


if __name__ == '__main__':
    sys.exit(main())
