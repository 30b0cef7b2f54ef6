"""Inputs of the cases: small files of tests/data under short names, and files made here, the same in every run."""
import gzip
import json
import math
import shutil
import struct
import zlib

# name in in/ -> file or folder in tests/data
TAKEN = {
    "ct.nrrd": "ct/cranium_crop.nrrd",
    "mr": "images/dicom_mr",
    "gear.stl": "meshes/gearwheel.bin.stl",
    "pinion.off": "meshes/pinion.off",
    "bones.off": "meshes/bones.off",
    "tet.obj": "meshes/catmark_toroidal_tet.obj",
    "tri.off": "meshes/anchor_semiregular_tri.off",
    "quad.off": "meshes/anchor_semiregular_quad.off",
    "car.obj": "subdiv/catmark_car.obj",
    "rook.obj": "subdiv/catmark_rook.obj",
    "torus_quads.obj": "subdiv/catmark_torus.obj",
    "broken": "broken_stl",
    "ball.vdb": "vdb/ball_blosc.vdb",
    "horse.png": "curves2d/horse.png",
    "keyring.png": "curves2d/keyring.png",
    "africa.geojson": "curves2d/africa.geojson",
    "iceland.txt": "coast/iceland.txt",
    "terrain.npy": "terrain/jacksboro.npy",
}


# ---- meshes ----

def torus(large, small, n=48, m=24):
    """Points, and triangles seen counterclockwise from outside."""
    points, triangles = [], []
    for i in range(n):
        for j in range(m):
            u, v = 2 * math.pi * i / n, 2 * math.pi * j / m
            around = large + small * math.cos(v)
            points.append(tuple(round(c, 6) + 0.0 for c in
                                (around * math.cos(u), around * math.sin(u), small * math.sin(v))))
            a, b = i * m + j, (i + 1) % n * m + j
            c, d = (i + 1) % n * m + (j + 1) % m, i * m + (j + 1) % m
            triangles += [(a, b, c), (a, c, d)]
    return points, triangles


def joined(*meshes):
    points, triangles = [], []
    for more, faces in meshes:
        triangles += [tuple(v + len(points) for v in face) for face in faces]
        points += more
    return points, triangles


def moved(mesh, x, y, z):
    return [(px + x, py + y, pz + z) for px, py, pz in mesh[0]], mesh[1]


def off(mesh):
    points, triangles = mesh
    lines = ["OFF", f"{len(points)} {len(triangles)} 0"]
    lines += ["%.6g %.6g %.6g" % p for p in points] + ["3 %d %d %d" % t for t in triangles]
    return "\n".join(lines) + "\n"


def obj(mesh):
    points, triangles = mesh
    return "".join("v %.6f %.6f %.6f\n" % p for p in points) + \
        "".join("f %d %d %d\n" % tuple(v + 1 for v in t) for t in triangles)


def ply(mesh, comment=""):
    points, triangles = mesh
    head = f"ply\nformat ascii 1.0\n{comment}element vertex {len(points)}\nproperty float x\nproperty float y\n" \
           f"property float z\nelement face {len(triangles)}\nproperty list uchar int vertex_indices\nend_header\n"
    return head + "".join("%.6f %.6f %.6f\n" % p for p in points) + "".join("3 %d %d %d\n" % t for t in triangles)


def stl(mesh):
    points, triangles = mesh
    result = bytes(80) + struct.pack("<I", len(triangles))
    for t in triangles:
        result += struct.pack("<12fH", 0, 0, 0, *points[t[0]], *points[t[1]], *points[t[2]], 0)
    return result


def meshes():
    ring = torus(10, 4)
    points, triangles = ring
    return {
        "torus.off": off(ring), "torus.obj": obj(ring), "torus.ply": ply(ring), "torus.stl": stl(ring),
        "torus_ras.ply": ply(ring, "comment SPACE=RAS\n"),
        "rings.off": off(joined(ring, moved(torus(2, 1, 12, 8), 30, 0, 0), moved(torus(3, 1, 16, 8), 0, 0, 12))),
        "flipped.off": off((points, [t[::-1] if i % 7 == 0 else t for i, t in enumerate(triangles)])),
        "hole.obj": obj((points, triangles[3:])),
        "open.off": off((points, triangles[: len(triangles) // 2])),
        "thin.off": off(torus(10, 0.01)),
        "huge.off": off(([(x * 1e200, y, z) for x, y, z in points], triangles)),
        "none.stl": stl(([], [])),
        "none.off": "OFF\n0 0 0\n",
        "index.obj": "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n",
        "packed.stl.gz": gzip.compress(stl(ring), mtime=0),
        "cube.obj": "".join(f"v {x} {y} {z}\n" for x in (0, 1) for y in (0, 1) for z in (0, 1)) +
                    "f 1 2 4 3\nf 5 7 8 6\nf 1 5 6 2\nf 3 4 8 7\nf 1 3 7 5\nf 2 6 8 4\n",
        "icosahedron.off": off(icosahedron()),
        "grid.obj": "".join(f"v {x} {y} {(x * y) % 3 * 0.25}\n" for y in range(9) for x in range(9)) +
                    "".join("f %d %d %d %d\n" % (9 * y + x + 1, 9 * y + x + 2, 9 * y + x + 11, 9 * y + x + 10)
                            for y in range(8) for x in range(8)),
    }


def icosahedron():
    g = (1 + 5 ** 0.5) / 2
    points = [(-1, g, 0), (1, g, 0), (-1, -g, 0), (1, -g, 0), (0, -1, g), (0, 1, g),
              (0, -1, -g), (0, 1, -g), (g, 0, -1), (g, 0, 1), (-g, 0, -1), (-g, 0, 1)]
    triangles = [(0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4), (11, 10, 2),
                 (10, 7, 6), (7, 1, 8), (3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8), (3, 8, 9), (4, 9, 5),
                 (2, 4, 11), (6, 2, 10), (8, 6, 7), (9, 8, 1)]
    return points, triangles


# ---- images of three dimensions ----

SIZE = 30, 26, 22


def sampled(code, value, size=SIZE):
    """`value` at every voxel, x fastest, as struct's `code`, which has the byte order in front."""
    numbers = [value(x, y, z) for z in range(size[2]) for y in range(size[1]) for x in range(size[0])]
    return struct.pack(f"{code[0]}{len(numbers)}{code[1]}", *numbers)


def from_middle(x, y, z):
    return math.sqrt((x - 14.5) ** 2 + (y - 12.5) ** 2 + (z - 10.5) ** 2)


def grey(x, y, z):
    return round(10 * (8 - from_middle(x, y, z)))


def mask(x, y, z):
    return 255 if from_middle(x, y, z) < 8 and (x - 14) ** 2 + (y - 12) ** 2 > 8 else 0


def label(x, y, z):
    return 1 if from_middle(x, y, z) < 5 else 3 if from_middle(x, y, z) < 8 else 4 if x > 26 and y > 22 else 0


def plates(x, y, z):
    """A block with a plate and a rod of one voxel."""
    return 1 if (4 <= x < 12 and 4 <= y < 20 and 4 <= z < 18) or (12 <= x < 27 and 5 <= y < 18 and z == 10) or \
        (12 <= x < 27 and y == 21 and z == 6) or (x == 26 and 18 <= y < 22 and 6 <= z < 11) else 0


def nrrd(kind, content, size=SIZE, more="spacings: 1 1 1\n"):
    endian = "endian: little\n" if kind != "uint8" else ""
    return (f"NRRD0004\ntype: {kind}\ndimension: {len(size)}\nsizes: {' '.join(map(str, size))}\n"
            f"{endian}{more}encoding: raw\n\n").encode() + content


def nifti(datatype, bits, content, slope=1.0, offset=0.0):
    head = bytearray(352)
    struct.pack_into("<i", head, 0, 348)
    struct.pack_into("<8h", head, 40, 3, *SIZE, 1, 1, 1, 1)
    struct.pack_into("<2h", head, 70, datatype, bits)
    struct.pack_into("<8f", head, 76, 1, 0.8, 0.8, 1.5, 1, 1, 1, 1)
    struct.pack_into("<3f", head, 108, 352, slope, offset)
    struct.pack_into("<B", head, 123, 2)     # millimetres
    struct.pack_into("<2h", head, 252, 0, 1)  # sform
    struct.pack_into("<12f", head, 280, 0.8, 0, 0, -12, 0, 0.8, 0, -10, 0, 0, 1.5, -5)
    head[344:348] = b"n+1\0"
    return bytes(head) + content


def images():
    oblique = "space: left-posterior-superior\nspace directions: (0.6,0.8,0) (-0.8,0.6,0) (0,0,1.25)\n" \
              "space origin: (5,-3,20)\n"
    meta = "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\n" \
           "TransformMatrix = 1 0 0 0 1 0 0 0 1\nOffset = -3 4 5\nElementSpacing = 0.5 0.5 1\n" \
           "DimSize = %d %d %d\nElementType = MET_FLOAT\nElementDataFile = " % SIZE
    whole = sampled("<h", grey)
    result = {
        "grey.nrrd": nrrd("int16", whole),
        "oblique.nrrd": nrrd("int16", whole, more=oblique),
        "mask.nrrd": nrrd("uint8", sampled("<B", mask)),
        "thin.nrrd": nrrd("uint8", sampled("<B", plates)),
        "labels.nii": nifti(4, 16, sampled("<h", label), 2.0, 0.0),
        "labels.nii.gz": gzip.compress(nifti(4, 16, sampled("<h", label)), mtime=0),
        "grey.nii": nifti(16, 32, sampled("<f", grey)),
        "grey.mha": meta.encode() + b"LOCAL\n" + sampled("<f", grey),
        "meta/grey.mhd": meta + "grey.raw\n",
        "meta/grey.raw": sampled("<f", grey),
        "grey.raw": bytes(16) + sampled(">h", grey),
        "volume.tif": tiff([page(z, grey_page) for z in range(SIZE[2])]),
        # What must be refused.
        "nan.nrrd": nrrd("float", sampled("<f", lambda x, y, z: math.nan if x == y == z == 7 else x)),
        "constant.nrrd": nrrd("int16", sampled("<h", lambda x, y, z: 7)),
        "flat.nrrd": nrrd("uint8", bytes(64), (8, 8), "spacings: 1 1\n"),
        "spacing.nrrd": nrrd("int16", whole, more="spacings: 1 0 1\n"),
        "colour.nrrd": nrrd("uint8", bytes(3 * 512), (3, 8, 8, 8), "kinds: RGB-color domain domain domain\n"),
        "empty.nrrd": "",
        "notes.xyz": "hello\n",
        "part.step": "ISO-10303-21;\nHEADER;\n",
    }
    for z in range(SIZE[2]):
        result[f"pngs/slice_{z:02}.png"] = png(SIZE[0], SIZE[1], 8, page(z, grey_page))
        result[f"tiffs/slice_{z:02}.tif"] = tiff([page(z, grey_page)])
    return result


def grey_page(x, y, z):
    return max(0, min(255, 128 + grey(x, y, z)))


def page(z, value):
    return [[value(x, y, z) for x in range(SIZE[0])] for y in range(SIZE[1])]


# ---- pictures and grids ----

def png(width, height, bits, rows):
    def chunk(kind, content):
        return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))
    code = ">%dB" if bits == 8 else ">%dH"
    lines = b"".join(b"\0" + struct.pack(code % width, *row) for row in rows)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, bits, 0, 0, 0, 0)) + \
        chunk(b"IDAT", zlib.compress(lines, 9)) + chunk(b"IEND", b"")


def tiff(pages, code="B"):
    """Little-endian, one strip a page, uint8 or float32."""
    bits, sample = {"B": (8, 1), "f": (32, 3)}[code]
    result = b"II*\0" + struct.pack("<I", 8)
    for number, rows in enumerate(pages):
        height, width = len(rows), len(rows[0])
        content = b"".join(struct.pack(f"<{width}{code}", *row) for row in rows)
        content += b"\0" * (len(content) % 2)
        tags = [(256, 4, width), (257, 4, height), (258, 3, bits), (259, 3, 1), (262, 3, 1), (273, 4, 0),
                (277, 3, 1), (278, 4, height), (279, 4, len(content)), (339, 3, sample)]
        strip = len(result) + 2 + 12 * len(tags) + 4
        result += struct.pack("<H", len(tags))
        for tag, kind, value in tags:
            result += struct.pack("<HHII", tag, kind, 1, strip if tag == 273 else value)
        result += struct.pack("<I", strip + len(content) if number + 1 < len(pages) else 0) + content
    return result


def hill(x, y):
    return round(100 * math.exp(-((x - 20) ** 2 + (y - 15) ** 2) / 120) + 20 * math.sin(x / 3) * math.cos(y / 4), 4)


def npy(rows):
    shape = len(rows), len(rows[0])
    head = "{'descr': '<f8', 'fortran_order': False, 'shape': %s, }" % (shape,)
    head = head.ljust(117) + "\n"
    return b"\x93NUMPY\1\0" + struct.pack("<H", len(head)) + head.encode() + \
        b"".join(struct.pack(f"<{len(r)}d", *r) for r in rows)


def pictures():
    hills = [[hill(x, y) for x in range(49)] for y in range(41)]
    disc = [[255 if 8 < math.hypot(x - 31, y - 27) < 22 else 10 for x in range(64)] for y in range(56)]
    bits = b"".join(int("".join("1" if v > 99 else "0" for v in row), 2).to_bytes(8, "big") for row in disc)
    ascii_grid = "ncols 49\nnrows 41\nxllcorner 0\nyllcorner 0\ncellsize 10\nNODATA_value -9999\n"
    rows = "".join(" ".join(map(str, row)) + "\n" for row in hills)
    return {
        "hill.npy": npy(hills),
        "hill16.png": png(49, 41, 16, [[round(300 * (v + 30)) for v in row] for row in hills]),
        "hill8.png": png(49, 41, 8, [[round(max(0, v + 30)) for v in row] for row in hills]),
        "hill.tif": tiff([hills], "f"),
        "hill.asc": ascii_grid + rows,
        "nodata.asc": ascii_grid + rows.replace(str(hills[5][5]), "-9999", 1),
        "short.asc": ascii_grid + rows[: len(rows) // 2],
        "disc.pgm": b"P5\n64 56\n255\n" + bytes(v for row in disc for v in row),
        "disc.pbm": b"P4\n64 56\n" + bits,
        "disc.png": png(64, 56, 8, disc),
        "disc.bmp": bmp(disc),
        "disc.tif": tiff([disc]),
        "white.png": png(32, 24, 8, [[255] * 32] * 24),
    }


def bmp(rows):
    """24 bits a pixel."""
    height, width = len(rows), len(rows[0])
    content = b"".join(bytes(v for v in row for _ in range(3)) for row in reversed(rows))
    assert width % 4 == 0
    return b"BM" + struct.pack("<IHHI", 54 + len(content), 0, 0, 54) + \
        struct.pack("<IiiHHIIiiII", 40, width, height, 1, 24, 0, len(content), 2835, 2835, 0, 0) + content


# ---- curves ----

def wave(n, closed, third=False):
    points = []
    for i in range(n):
        t = 2 * math.pi * i / (n if closed else n - 1)
        radius = 10 + math.sin(7 * t) + 0.3 * math.sin(31 * t)
        points.append((radius * math.cos(t), radius * math.sin(t)) if closed else (10 * t, radius))
        if third:
            points[-1] += (math.sin(2 * t),)
    return [tuple(round(c, 4) + 0.0 for c in p) for p in points]


def lines(points):
    return "".join(" ".join(map(str, p)) + "\n" for p in points)


def curves():
    ring, hole = wave(120, True), [(round(x / 3, 4), round(y / 3, 4)) for x, y in wave(60, True)]
    closed, inner = ring + ring[:1], hole[::-1] + hole[-1:]
    square = {"type": "Topology", "transform": {"scale": [0.1, 0.1], "translate": [5, 7]},
              "arcs": [[[0, 0], [90, 0], [0, 60]], [[90, 60], [-90, 0], [0, -60]], [[30, 20], [0, 20], [20, 0], [0, -20], [-20, 0]]],
              "objects": {"land": {"type": "Polygon", "arcs": [[0, 1], [2]]}}}
    path = "M " + " L ".join(f"{x} {y}" for x, y in ring) + " Z"
    return {
        "rings.txt": lines(closed) + "\n" + lines(inner),
        "open.txt": lines(wave(133, False)),
        "space.txt": lines(wave(97, False, True)),
        "two.geojson": json.dumps({"type": "Feature", "properties": {}, "geometry": {
            "type": "Polygon", "coordinates": [closed, inner]}}),
        "line.geojson": json.dumps({"type": "LineString", "coordinates": wave(80, False)}),
        "square.topojson": json.dumps(square),
        "drawing.svg": '<svg xmlns="http://www.w3.org/2000/svg" viewBox="-12 -12 24 24">'
                       f'<path d="{path}"/><path d="M 0 0 L 1 2 L 3 1 L 5 5 L 8 4 L 9 7"/></svg>\n',
        "words.txt": "1 2\n3 four\n5 6\n",
        "untyped.json": '{"coordinates": []}',
        "broken.geojson": '{"type": "Polygon", "coordinates": [[[0, 0], [1, 0], ',
        "empty.txt": "",
    }


def level_set(field):
    """The control points of a small field without isowave's marks: for the program a level set like any other."""
    for mark in b"isowave:K", b"isowave:parts", b"isowave:file_bytes":
        assert field.count(mark) == 1
        field = field.replace(mark, mark.replace(b"isowave", b"comment"))
    version = 21 + 14  # the digit of the UUID that says 8, a hash, in isowave's files and 4, random, in OpenVDB's
    assert field[version:version + 1] == b"8"
    return field[:version] + b"4" + field[version + 1:]


def make(folder, data):
    folder.mkdir(parents=True)
    for name, source in TAKEN.items():
        if (data / source).is_dir():
            shutil.copytree(data / source, folder / name, ignore=shutil.ignore_patterns("LICENSE*", "README*"))
        else:
            shutil.copyfile(data / source, folder / name)
    (folder / "level_set.vdb").write_bytes(level_set((folder / "ball.vdb").read_bytes()))
    for name, content in {**meshes(), **images(), **pictures(), **curves()}.items():
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).write_bytes(content if isinstance(content, bytes) else content.encode())
