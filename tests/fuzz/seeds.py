#!/usr/bin/env python3
"""Writes small valid files of every format that a fuzz target reads:  seeds.py FOLDER  ->  FOLDER/TARGET/NAME

Each is written here from its format's description, not by isowave. The files of tests/data that are small enough come
beside them. The same bytes every time.
"""
import base64
import gzip
import io
import json
import pathlib
import shutil
import struct
import sys
import zipfile
import zlib

DATA = pathlib.Path(__file__).resolve().parent.parent / "data"
LARGEST = 64 << 10  # of a file of tests/data: larger seeds make a fuzzer slow

# ---- a tetrahedron and a cube

TETRAHEDRON = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
TRIANGLES = [(0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)]
CUBE = [(x, y, z) for z in (0, 1) for y in (0, 1) for x in (0, 1)]
QUADS = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]


def ascii_stl():
    text = "solid t\n"
    for triangle in TRIANGLES:
        text += "facet normal 0 0 0\nouter loop\n"
        text += "".join("vertex %g %g %g\n" % TETRAHEDRON[i] for i in triangle) + "endloop\nendfacet\n"
    return (text + "endsolid t\n").encode()


def binary_stl():
    body = b"".join(struct.pack("<12fH", 0, 0, 0, *(x for i in t for x in TETRAHEDRON[i]), 0) for t in TRIANGLES)
    return b"binary".ljust(80, b"\0") + struct.pack("<I", len(TRIANGLES)) + body


def meshes():
    points = "".join("%g %g %g\n" % p for p in CUBE)
    faces = "".join("4 %d %d %d %d\n" % q for q in QUADS)
    yield "stl/ascii.stl", ascii_stl()
    yield "stl/binary.stl", binary_stl()
    yield "off/cube.off", f"OFF\n8 6 0\n{points}{faces}# t crease 2/1/0 0 1 2\n".encode()
    yield "off/one_line.off", b"OFF 4 4 0 0 0 0 1 0 0 0 1 0 0 0 1 3 0 2 1 3 0 1 3 3 1 2 3 3 0 3 2"
    yield "off/coff.off", ("COFF\n8 6 0\n" + points.replace("\n", " 255 0 0 255\n") + faces).encode()
    vertices = "".join("v %g %g %g\n" % p for p in CUBE)
    yield "obj/cube.obj", ("\ufeff# cube\no a\n" + vertices + "vn 0 0 1\nvt 0 1\nusemtl m\ng x\ns 1\n" + "".join(
        "f %d/1/1 %d/1/1 %d//1 %d\r\n" % tuple(i + 1 for i in q) for q in QUADS) + "t crease 2/1/0 0 1 2\nl 1 2\n").encode()
    yield "obj/negative.obj", (vertices + "".join(
        "f %d %d \\\n %d %d\n" % tuple(i - 8 for i in q) for q in QUADS)).encode()
    yield from plys()
    yield from glbs()
    yield from xmls()


def xmls():
    def array(kind, name, numbers, components=1):
        return (f'<DataArray type="{kind}" Name="{name}" NumberOfComponents="{components}" format="ascii">' +
                " ".join(map(str, numbers)) + "</DataArray>")
    ends = range(4, 4 * len(QUADS) + 1, 4)
    yield "vtp/quads.vtp", ('<VTKFile type="PolyData"><PolyData><Piece NumberOfPoints="8" NumberOfPolys="6"><Points>' +
                            array("Float32", "Points", (x for p in CUBE for x in p), 3) + "</Points><Polys>" +
                            array("Int64", "connectivity", (i for q in QUADS for i in q)) + array("Int32", "offsets", ends) +
                            "</Polys></Piece></PolyData></VTKFile>").encode()
    vertices = "".join(f'<vertex x="{x}" y="{y}" z="{z}"/>' for x, y, z in TETRAHEDRON)
    triangles = "".join(f'<triangle v1="{a}" v2="{b}" v3="{c}"/>' for a, b, c in TRIANGLES)
    for name, method in (("stored", zipfile.ZIP_STORED), ("deflated", zipfile.ZIP_DEFLATED)):
        out = io.BytesIO()
        with zipfile.ZipFile(out, "w", method) as archive:
            archive.writestr(zipfile.ZipInfo("3D/3dmodel.model"), (
                f'<model unit="inch"><resources><object id="1"><mesh><vertices>{vertices}</vertices><triangles>{triangles}'
                '</triangles></mesh></object></resources><build><item objectid="1" transform="1 0 0 0 1 0 0 0 1 1 2 3"/></build>'
                '</model>'), method)
        yield f"3mf/{name}.3mf", out.getvalue()


def plys():
    head = ("ply\nformat {} 1.0\ncomment SPACE=LPS\nelement vertex 8\nproperty {} x\nproperty {} y\nproperty {} z\n"
            "property uchar red\nelement face 6\nproperty list uchar int vertex_indices\nend_header\n")
    text = "".join("%g %g %g 7\n" % p for p in CUBE) + "".join("4 %d %d %d %d\n" % q for q in QUADS)
    yield "ply/ascii.ply", (head.format("ascii", *["float"] * 3) + text).encode()
    for name, order, kind, code in (("little", "<", "double", "d"), ("big", ">", "float", "f")):
        body = b"".join(struct.pack(f"{order}3{code}B", *p, 7) for p in CUBE)
        body += b"".join(struct.pack(f"{order}B4i", 4, *q) for q in QUADS)
        yield f"ply/{name}.ply", head.format(f"binary_{name}_endian", *[kind] * 3).encode() + body
    yield "ply/strips.ply", (
        b"ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
        b"element face 4\nproperty list uint8 uint16 vertex_index\nproperty list uchar float texcoord\nend_header\n"
        + "".join("%g %g %g\n" % p for p in TETRAHEDRON).encode()
        + "".join("3 %d %d %d 2 0.5 1\n" % t for t in TRIANGLES).encode())


def glb(document, data):
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    data += b"\0" * (-len(data) % 4)
    chunks = struct.pack("<II", len(text), 0x4E4F534A) + text + struct.pack("<II", len(data), 0x004E4942) + data
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks


def glbs():
    data = b"".join(struct.pack("<3f", *p) for p in TETRAHEDRON)
    indices = b"".join(struct.pack("<3H", *t) for t in TRIANGLES)
    document = {
        "asset": {"version": "2.0", "extras": {"SPACE": "LPS"}}, "scene": 0, "scenes": [{"nodes": [0]}],
        "nodes": [{"children": [1], "translation": [1, 2, 3], "rotation": [0, 0, 0, 1], "scale": [1, 2, 1]},
                  {"mesh": 0, "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "mode": 4}]}],
        "buffers": [{"byteLength": len(data) + len(indices)}],
        "bufferViews": [{"buffer": 0, "byteLength": len(data)},
                        {"buffer": 0, "byteOffset": len(data), "byteLength": len(indices)}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
                      {"bufferView": 1, "componentType": 5123, "count": 12, "type": "SCALAR"}]}
    yield "glb/indexed.glb", glb(document, data + indices)
    plain = dict(document, meshes=[{"primitives": [{"attributes": {"POSITION": 0}, "mode": 5}]}])
    yield "glb/strip.glb", glb(plain, data)
    small = b"".join(struct.pack("<3hH", *(100 * x for x in p), 0) for p in TETRAHEDRON)
    quantized = dict(document, extensionsRequired=["KHR_mesh_quantization"],
                     bufferViews=[{"buffer": 0, "byteLength": len(small), "byteStride": 8},
                                  {"buffer": 0, "byteOffset": len(small), "byteLength": len(indices)}],
                     buffers=[{"byteLength": len(small) + len(indices)}],
                     accessors=[{"bufferView": 0, "componentType": 5122, "count": 4, "type": "VEC3"},
                                {"bufferView": 1, "componentType": 5123, "count": 12, "type": "SCALAR"}])
    quantized["nodes"] = [{"mesh": 0, "scale": [0.01, 0.01, 0.01]}]
    quantized["scenes"] = [{"nodes": [0]}]
    yield "glb/quantized.glb", glb(quantized, small + indices)


# ---- images of 4 x 3 x 2 voxels

SIZE = (4, 3, 2)
VOXELS = bytes(range(10, 34))
SHORTS = struct.pack("<24h", *(20 * v - 300 for v in VOXELS))


def nifti(volumes=1, kind=4, order="<", code=1):
    head = bytearray(348)
    struct.pack_into(order + "i", head, 0, 348)
    struct.pack_into(order + "8h", head, 40, 4 if volumes > 1 else 3, *SIZE, volumes, 1, 1, 1)
    struct.pack_into(order + "2h", head, 70, kind, 16)
    struct.pack_into(order + "8f", head, 76, 1, 0.5, 0.5, 2, 1, 0, 0, 0)
    struct.pack_into(order + "3f", head, 108, 352, 2, -5)  # vox_offset, slope, intercept
    head[123] = 2  # mm
    struct.pack_into(order + "2h", head, 252, 1 - code, code)
    struct.pack_into(order + "6f", head, 256, 0.1, 0.2, 0.3, 1, 2, 3)
    struct.pack_into(order + "12f", head, 280, 0.5, 0, 0, 1, 0, 0.5, 0.1, 2, 0, 0, 2, 3)
    head[344:348] = b"n+1\0"
    values = [20 * v - 300 for v in VOXELS] * volumes
    return bytes(head) + bytes(4) + struct.pack(f"{order}{len(values)}h", *values)


def nifti2():
    head = bytearray(540)
    struct.pack_into("<i8s2h", head, 0, 540, b"n+2\0\r\n\032\n", 4, 16)
    struct.pack_into("<8q", head, 16, 3, *SIZE, 1, 1, 1, 1)
    struct.pack_into("<8d", head, 104, 1, 0.5, 0.5, 2, 1, 0, 0, 0)
    struct.pack_into("<q", head, 168, 544)
    struct.pack_into("<2i", head, 344, 1, 0)
    return bytes(head) + bytes(4) + SHORTS


def images():
    yield "nifti/sform.nii", nifti()
    yield "nifti/qform_big.nii", nifti(order=">", code=0)
    yield "nifti/volumes.nii", nifti(volumes=2)
    yield "nifti/packed.nii", gzip.compress(nifti(), mtime=0)
    yield "nifti/second.nii", nifti2()
    nrrd = "NRRD0004\n# made\ntype: {}\ndimension: 3\nsizes: 4 3 2\nendian: little\nencoding: {}\n{}\n"
    space = ("space: left-posterior-superior\nspace directions: (0.5,0,0) (0,0.5,0.1) (0,0,2)\nspace origin: (1,2,3)\n"
             'kinds: domain domain domain\nspace units: "mm" "mm" "mm"\nkey:=value\n')
    yield "nrrd/raw.nrrd", nrrd.format("short", "raw", space).encode() + SHORTS
    yield "nrrd/gzip.nrrd", nrrd.format("short", "gzip", space).encode() + gzip.compress(SHORTS, mtime=0)
    yield "nrrd/text.nrrd", nrrd.format("float", "text", "spacings: 1 1 2\n").encode() + b" ".join(
        b"%d.5" % v for v in VOXELS)
    yield "nrrd/hex.nrrd", nrrd.format("uchar", "hex", "spacings: 1 1 2\naxis mins: 0 1 2\n").encode() + VOXELS.hex().encode()
    yield "nrrd/beside.nrrd", nrrd.format("uchar", "raw", "byte skip: 3\ndata file: voxels.raw\nspacings: 1 1 1\n").encode()
    yield "nrrd/list.nrrd", nrrd.format("uchar", "raw", "spacings: 1 1 1\ndata file: LIST 2\nvoxels.raw\nvoxels.raw").encode()
    yield "nrrd/layers.nrrd", (b"NRRD0005\ntype: uchar\ndimension: 4\nsizes: 2 4 3 2\nspace: RAS\nkinds: list domain domain domain\n"
                               b"space directions: none (1,0,0) (0,1,0) (0,0,1)\nspace origin: (0,0,0)\nencoding: raw\n"
                               b"Segment0_Name:=liver\nSegment0_Layer:=0\nSegment0_LabelValue:=1\n\n" + VOXELS * 2)
    meta = ("ObjectType = Image\nNDims = 3\nDimSize = 4 3 2\nElementType = {}\nElementSpacing = 0.5 0.5 2\nOffset = 1 2 3\n"
            "TransformMatrix = 1 0 0 0 1 0 0 0 1\nBinaryDataByteOrderMSB = False\n{}ElementDataFile = {}\n")
    packed = zlib.compress(SHORTS)
    yield "metaimage/raw.mha", meta.format("MET_SHORT", "", "LOCAL").encode() + SHORTS
    yield "metaimage/packed.mha", meta.format(
        "MET_SHORT", f"CompressedData = True\nCompressedDataSize = {len(packed)}\n", "LOCAL").encode() + packed
    yield "metaimage/text.mha", meta.format("MET_FLOAT", "BinaryData = False\n", "LOCAL").encode() + b" ".join(
        b"%d.5" % v for v in VOXELS)
    yield "metaimage/beside.mha", meta.format("MET_UCHAR", "HeaderSize = 7\nDistanceUnits = um\n", "voxels.raw").encode()
    yield "metaimage/list.mha", meta.format("MET_UCHAR", "", "LIST").encode() + b"voxels.raw\nvoxels.raw\n"
    mgh = struct.pack(">7ih3f12f", 1, *SIZE, 1, 4, 0, 1, 0.5, 0.5, 2, -1, 0, 0, 0, 0, -1, 0, 1, 0, 1, 2, 3).ljust(284, b"\0")
    yield "mgh/short.mgh", mgh + struct.pack(">24h", *VOXELS)
    yield "mgh/packed.mgh", gzip.compress(mgh + struct.pack(">24h", *VOXELS), mtime=0)
    mrc = struct.pack("<10i6f3i", *SIZE, 1, 0, 0, 0, *SIZE, 2, 3, 4, 90, 90, 90, 1, 2, 3).ljust(208, b"\0") + b"MAP DD\0\0"
    yield "mrc/short.mrc", mrc.ljust(1024, b"\0") + SHORTS
    yield "mrc/packed.mrc", gzip.compress(mrc.ljust(1024, b"\0") + SHORTS, mtime=0)
    for order, dtype, data in (("True", "<i2", SHORTS), ("False", "|u1", VOXELS), ("False", "<f2", struct.pack("<24e", *VOXELS))):
        head = f"{{'descr': '{dtype}', 'fortran_order': {order}, 'shape': ({', '.join(map(str, SIZE))}), }}".ljust(117) + "\n"
        yield f"npy-volume/{dtype[1:]}_{order}.npy", b"\x93NUMPY\1\0\x76\0" + head.encode() + data
    vti = ('<VTKFile type="ImageData" byte_order="LittleEndian" header_type="UInt32"{}><ImageData Origin="1 2 3"><Piece Extent='
           '"0 3 0 2 0 1"><PointData><DataArray type="Int16" Name="a" {}</DataArray></PointData></Piece></ImageData>')
    length = struct.pack("<I", len(SHORTS))
    yield "vti/ascii.vti", (vti.format("", 'format="ascii">' + " ".join(map(str, VOXELS))) + "</VTKFile>").encode()
    yield "vti/binary.vti", (vti.format("", 'format="binary">' + base64.b64encode(length + SHORTS).decode()) + "</VTKFile>").encode()
    yield "vti/appended.vti", (vti.format("", 'format="appended" offset="0">').encode() + b'<AppendedData encoding="raw">_' +
                               length + SHORTS + b"</AppendedData></VTKFile>")
    head = struct.pack("<4I", 1, len(SHORTS), 0, len(packed))
    yield "vti/zlib.vti", (vti.format(' compressor="vtkZLibDataCompressor"', 'format="binary">' + (
        base64.b64encode(head) + base64.b64encode(packed)).decode()) + "</VTKFile>").encode()
    yield from tiffs()
    yield from dicoms()


def tiff(pages, order="<", compression=1, description=None, bits=8, photometric=1, extra=()):
    """pages: the bytes of each, 4 x 3 pixels."""
    out = bytearray(struct.pack(order + "2sHI", b"II" if order == "<" else b"MM", 42, 0))
    last = 4
    for page in pages:
        stored = zlib.compress(page) if compression == 8 else packbits(page) if compression == 32773 else page
        place = len(out)
        out += stored + b"\0" * (len(stored) % 2)
        tags = [(256, 3, 4), (257, 3, 3), (258, 3, bits), (259, 3, compression), (262, 3, photometric),
                (273, 4, place), (277, 3, 1), (278, 3, 3), (279, 4, len(stored)), *extra]
        if description:
            tags.append((270, 2, (len(description) + 1, len(out))))
            out += description + b"\0" * (2 - len(description) % 2)
        struct.pack_into(order + "I", out, last, len(out))
        out += struct.pack(order + "H", len(tags))
        for tag, kind, value in sorted(tags):
            count, value = value if isinstance(value, tuple) else (1, value)
            out += struct.pack(order + "HHI", tag, kind, count)
            out += struct.pack(order + ("HH" if kind == 3 else "I"), *([value, 0] if kind == 3 else [value]))
        last = len(out)
        out += bytes(4)
    return bytes(out)


def packbits(data):
    return bytes([len(data) - 1]) + data


def tiffs():
    pages = [VOXELS[:12], VOXELS[12:]]
    imagej = b"ImageJ=1.53t\nimages=2\nslices=2\nspacing=1.2\nunit=mm\n"
    channels = b"ImageJ=1.53t\nimages=4\nchannels=2\nslices=2\nspacing=1.2\nunit=um\n"
    ome = (b'<OME><Image><Pixels DimensionOrder="XYZCT" SizeX="4" SizeY="3" SizeZ="2" SizeC="1" SizeT="1" Type="uint8" '
           b'PhysicalSizeX="0.5" PhysicalSizeZ="1.2" PhysicalSizeZUnit="mm"><Channel/><TiffData IFD="0" FirstZ="0"/>'
           b'<TiffData IFD="1" FirstZ="1"/></Pixels></Image></OME>')
    shaped = b'{"shape": [2, 3, 4], "axes": "ZYX"}'
    for name, stack in (("plain", tiff(pages)), ("imagej", tiff(pages, description=imagej)),
                        ("channels", tiff(pages * 2, description=channels)), ("ome", tiff(pages, description=ome)),
                        ("shaped", tiff(pages, description=shaped)), ("big", tiff(pages, ">")),
                        ("deflated", tiff(pages, compression=8)), ("packbits", tiff(pages, compression=32773)),
                        ("short", tiff([SHORTS[:24], SHORTS[24:]], bits=16, extra=[(339, 3, 2)]))):
        yield f"tiff/{name}.tif", stack
    yield "tiff-picture/grey.tif", tiff(pages[:1])
    yield "tiff-picture/white.tif", tiff(pages[:1], photometric=0)
    yield "tiff-picture/bits.tif", tiff([bytes([0x50, 0xA0, 0xF0])], bits=1)
    yield "tiff-picture/deflated.tif", tiff(pages[:1], compression=8)


def element(group, number, vr, value, implicit=False):
    if isinstance(value, str):
        value = value.encode()
    if len(value) % 2:
        value += b"\0" if vr == "UI" else b" "
    head = struct.pack("<HH", group, number)
    if implicit:
        return head + struct.pack("<I", len(value)) + value
    if vr in ("OB", "OW", "SQ", "UN"):
        return head + vr.encode() + bytes(2) + struct.pack("<I", len(value)) + value
    return head + vr.encode() + struct.pack("<H", len(value)) + value


def item(value):
    return struct.pack("<HHI", 0xFFFE, 0xE000, len(value)) + value


def dicom(frames=2, functional=False, pixels=None, syntax="1.2.840.10008.1.2.1", implicit=False):
    def put(group, number, vr, value):
        return element(group, number, vr, value, implicit)

    def short(value):
        return struct.pack("<H", value)
    position = [put(0x0020, 0x0032, "DS", "1\\2\\%d" % (3 + 2 * f)) for f in range(frames)]
    place = put(0x0020, 0x0037, "DS", "1\\0\\0\\0\\1\\0")
    spacing = put(0x0018, 0x0050, "DS", "2") + put(0x0028, 0x0030, "DS", "0.5\\0.5")
    body = put(0x0008, 0x0016, "UI", "1.2.840.10008.5.1.4.1.1.2.1" if functional else "1.2.840.10008.5.1.4.1.1.77")
    body += put(0x0008, 0x0060, "CS", "CT") + put(0x0020, 0x000E, "UI", "1.2.3")
    if not functional:
        body += put(0x0018, 0x0088, "DS", "2") + spacing + position[0] + place
    body += put(0x0028, 0x0002, "US", short(1)) + put(0x0028, 0x0004, "CS", "MONOCHROME2")
    body += put(0x0028, 0x0008, "IS", str(frames)) + put(0x0028, 0x0010, "US", short(3)) + put(0x0028, 0x0011, "US", short(4))
    for number, value in ((0x0100, 16), (0x0101, 12), (0x0102, 11), (0x0103, 1)):
        body += put(0x0028, number, "US", short(value))
    body += put(0x0028, 0x1052, "DS", "-1024") + put(0x0028, 0x1053, "DS", "1.5")
    if functional:
        shared = element(0x0020, 0x9116, "SQ", item(place)) + element(0x0028, 0x9110, "SQ", item(spacing))
        body += element(0x5200, 0x9229, "SQ", item(shared))
        body += element(0x5200, 0x9230, "SQ", b"".join(item(element(0x0020, 0x9113, "SQ", item(p))) for p in position))
    body += pixels or put(0x7FE0, 0x0010, "OW", (SHORTS * frames)[: 24 * frames])
    return bytes(128) + b"DICM" + element(0x0002, 0x0010, "UI", syntax) + body


def dicoms():
    yield "dicom/explicit.dcm", dicom()
    yield "dicom/implicit.dcm", dicom(implicit=True, syntax="1.2.840.10008.1.2")
    yield "dicom/enhanced.dcm", dicom(functional=True)
    # RLE: PS3.5 annex G, two segments of bytes a frame.
    def run(data):
        packed = packbits(data)
        return packed + b"\0" * (len(packed) % 2)
    pieces = b""
    for f in range(2):
        frame = SHORTS[24 * f:24 * f + 24]
        high, low = run(frame[1::2]), run(frame[0::2])
        pieces += item(struct.pack("<16I", 2, 64, 64 + len(high), *[0] * 13) + high + low)
    pixels = struct.pack("<HH2sHI", 0x7FE0, 0x0010, b"OB", 0, 0xFFFFFFFF) + item(b"") + pieces
    pixels += struct.pack("<HHI", 0xFFFE, 0xE0DD, 0)
    yield "dicom-compressed/rle.dcm", dicom(pixels=pixels, syntax="1.2.840.10008.1.2.5")


# ---- pictures

def png(kind, depth, rows, *chunks):
    def chunk(name, data):
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))
    head = struct.pack(">2I5B", 4, len(rows), depth, kind, 0, 0, 0)
    data = zlib.compress(b"".join(b"\0" + row for row in rows))
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + b"".join(chunk(*c) for c in chunks) + chunk(b"IDAT", data)
            + chunk(b"IEND", b""))


def bmp(bits, rows, compression=0, palette=b""):
    start = 54 + len(palette)
    data = rows if compression else b"".join(row + b"\0" * (-len(row) % 4) for row in rows)
    return (struct.pack("<2sIHHI", b"BM", start + len(data), 0, 0, start)
            + struct.pack("<IiiHHIIiiII", 40, 4, 3, 1, bits, compression, len(data), 0, 0, len(palette) // 4, 0) + palette + data)


def jpeg(components, progressive=False):
    """8 x 8 pixels of one value a component, 5/8 of a step from the middle; of two codes for first coefficients and one for the rest."""
    def segment(mark, data):
        return struct.pack(">BBH", 0xFF, mark, len(data) + 2) + data
    def table(kind, counts, values):
        return segment(0xC4, bytes([kind]) + bytes(counts).ljust(16, b"\0") + bytes(values))
    def scan(numbers, last, bits):
        bits += "1" * (-len(bits) % 8)
        head = bytes([len(numbers)]) + b"".join(bytes([n, 0]) for n in numbers) + bytes([*last, 0])
        return segment(0xDA, head) + bytes(int(bits[i:i + 8], 2) for i in range(0, len(bits), 8))
    numbers = range(1, components + 1)
    frame = struct.pack(">BHHB", 8, 8, 8, components) + b"".join(bytes([n, 0x11, 0]) for n in numbers)
    tables = table(0x00, [1, 1], [0, 3]) + table(0x10, [1], [0])
    if progressive:  # the first coefficients of all, then the others of each
        scans = scan(numbers, (0, 0), "10101" * components) + b"".join(scan([n], (1, 63), "0") for n in numbers)
    else:
        scans = scan(numbers, (0, 63), "101010" * components)
    return (b"\xff\xd8" + segment(0xE0, b"JFIF\0\1\1\0\0\1\0\1\0\0") + segment(0xDB, b"\0" + bytes([8] * 64)) +
            segment(0xC2 if progressive else 0xC0, frame) + tables + scans + b"\xff\xd9")


def npy(kind, shape, data, fortran=False):
    head = "{'descr': '%s', 'fortran_order': %s, 'shape': %s, }" % (kind, fortran, shape)
    head = head.ljust(117) + "\n"
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(head)) + head.encode() + data


def pictures():
    grey = [VOXELS[4 * y:4 * y + 4] for y in range(3)]
    yield "png/grey.png", png(0, 8, grey, (b"sCAL", b"\x010.5\x000.5"))
    yield "png/deep.png", png(4, 16, [row * 4 for row in grey])
    yield "png/colours.png", png(6, 8, [row * 4 for row in grey], (b"sRGB", b"\0"))
    yield "png/palette.png", png(3, 2, [b"\x1b"] * 3, (b"PLTE", bytes(range(12))), (b"tRNS", b"\xff\x80"))
    yield "pnm/bytes.pgm", b"P5\n# made\n4 3\n255\n" + VOXELS[:12]
    yield "pnm/deep.pgm", b"P5 4 3 4095\n" + bytes([1, 2] * 12)
    yield "pnm/text.pgm", b"P2\n4 3\n99\n" + b" ".join(b"%d" % v for v in VOXELS[:12])
    yield "pnm/bits.pbm", b"P4\n4 3\n\x50\xa0\xf0"
    yield "pnm/text.pbm", b"P1\n4 3\n0 1 0 1 1 1 0 0 0101"
    yield "bmp/colours.bmp", bmp(24, [bytes(range(12))] * 3)
    yield "bmp/palette.bmp", bmp(8, grey, palette=bytes(range(256)) * 4)
    yield "bmp/runs.bmp", bmp(8, b"\x04\x01\0\0\x04\x02\0\0\0\x04\1\2\3\4\0\1", 1, bytes(range(256)) * 4)
    yield "jpeg/grey.jpg", jpeg(1)
    yield "jpeg/colours.jpg", jpeg(3)
    yield "jpeg/progressive.jpg", jpeg(3, True)
    yield "npy/bytes.npy", npy("|u1", (3, 4), VOXELS[:12])
    yield "npy/doubles.npy", npy(">f8", (3, 4), struct.pack(">12d", *VOXELS[:12]), True)
    yield "npy/colours.npy", npy("<u2", (2, 2, 3), bytes(VOXELS))
    yield "asc/grid.asc", (b"ncols 4\nnrows 3\nxllcorner 0\nyllcorner 0\ncellsize 10\nNODATA_value -9999\n"
                           b"1 2 3 4\n5 6 7 8.5\n9 10 11 12\n")


# ---- lines

def vectors():
    yield "svg/paths.svg", (b'<?xml version="1.0"?>\n<!-- made --><svg xmlns="http://www.w3.org/2000/svg"><g>'
                            b'<path d="M 0 0 L10,0 l 0 5 H 3 v2 h-1 V 9 z m 20 1 L 3e1 4-2.5 7 z"/>'
                            b'<polyline points="0,0 1,2 3,4"/><polygon points="0 0 4 0 4 4"/></g></svg>\n')
    ring = [[0, 0], [10, 0], [10, 10], [0, 10], [0, 0]]
    hole = [[2, 2], [2, 4], [4, 4], [2, 2]]
    yield "geojson/collection.geojson", json.dumps({"type": "FeatureCollection", "features": [
        {"type": "Feature", "properties": {"name": "a"}, "geometry": {"type": "Polygon", "coordinates": [ring, hole]}},
        {"type": "Feature", "geometry": {"type": "MultiPolygon", "coordinates": [[ring], [hole]]}},
        {"type": "Feature", "geometry": {"type": "GeometryCollection", "geometries": [
            {"type": "LineString", "coordinates": hole}, {"type": "MultiLineString", "coordinates": [ring, hole]}]}}]}).encode()
    yield "geojson/topology.json", json.dumps({
        "type": "Topology", "transform": {"scale": [0.5, 0.5], "translate": [1, 2]},
        "arcs": [[[0, 0], [10, 0], [0, 10]], [[10, 10], [-10, 0], [0, -10]]],
        "objects": {"land": {"type": "Polygon", "arcs": [[0, 1]]}}}).encode()
    yield "points/rings.txt", b"# made\n> one\n0 0\n10 0\n10 10\n0 10\n0 0\n>\n2,2\n2,4\n4,4\n2,2\n"


# ---- our own

def hierarchy():
    def section(name, data, count):
        return {"name": name, "count": count, "crc32": zlib.crc32(data)}, data
    points = b"".join(struct.pack("<3d", *p) for p in CUBE)
    faces = struct.pack("<6I", *[4] * 6)
    corners = struct.pack("<24I", *(i for q in QUADS for i in q))
    details = struct.pack("<54d", *(i / 100 for i in range(54)))
    order = struct.pack("<26I", *range(26)), struct.pack("<24I", *range(0, 96, 4))
    parts = [section("points", points, 8), section("faces", faces, 6), section("corners", corners, 24),
             section("creases", struct.pack("<IId", 0, 1, 1), 1), section("pinned", struct.pack("<I", 7), 1),
             section("details-1", details, 18), section("order-vertices", order[0], 26), section("order-corners", order[1], 24)]
    text = json.dumps({"scheme": "catmull-clark", "variant": "refined", "steps": 1, "sections": [p[0] for p in parts]}).encode()
    return (b"isowmesh" + struct.pack("<3I", 1, len(text), zlib.crc32(text)) + text + b"".join(p[1] for p in parts))


def varint(value):
    out = b""
    while value >= 128:
        out, value = out + bytes([value & 127 | 128]), value >> 7
    return out + bytes([value])


def folded(value):
    return varint(2 * value if value >= 0 else -2 * value - 1)


def numbers(values):
    """All first bytes, then all second ones, ..., without compression."""
    packed = struct.pack(f"<{len(values)}d", *values)
    return bytes(packed[8 * i + k] for k in range(8) for i in range(len(values)))


def sections(magic, first, *others):
    """Both ways in which a target takes them: as a file, and with all sections but the first without compression."""
    def one(kind, content):
        head = struct.pack("<IQ", kind, len(content))
        return head + struct.pack("<I", zlib.crc32(head + content)) + content
    start = magic + struct.pack("<I", 1) + one(*first)
    return (start + b"".join(one(kind, zlib.compress(content)) for kind, content in others),
            b"plain" + start + b"".join(one(kind, content) for kind, content in others))


def text(value):
    return struct.pack("<I", len(value)) + value.encode()


def curve_pyramid(side, inside, kind):
    """A square of control points, of which those in the middle are inside. Values as their bits (kind 4)."""
    rows = varint(side)
    for row in range(side):
        rows += folded(1 if row else 0) + varint(1) + folded(0) + varint(2 * (side - 4))
    bits = [struct.pack("<f", -1 if {x in inside and y in inside} == {True} else 1) for y in range(side) for x in range(side)]
    values = b"".join(bits)
    head = (struct.pack("<5d2Q4dI", 1, 0, 0, 1, 1, len(rows), side * side, 0, 0, side, side, 0) + text(kind) +
            struct.pack("<dI2d2QIIdQ", 1, 1, 4, 2, side * side, 0, 0, 1, 0.01, 0))
    return sections(b"ISOWAVEC", (1, head), (2, rows), (4, values))


def curve_details(scheme, curves, mask="", width=0):
    """curves: closed, dimension, points of the coarsest level and of the finer ones."""
    levels = max(len(points) - 1 for _, _, points in curves)
    sizes = varint(len(curves)) + b"".join(
        varint(2 * dimension + closed) + varint(len(points) - 1) + b"".join(map(varint, points)) for closed, dimension, points in curves)
    head = text(scheme) + text(mask) + struct.pack("<iIQ", width, levels, len(sizes))
    parts = [(2, sizes), (3, numbers([i % 7 + 0.5 * (i % 2) for _, d, points in curves for i in range(d * points[0])]))]
    for level in range(levels, 0, -1):
        count = 0
        for _, dimension, points in curves:
            if level < len(points):
                at = len(points) - 1 - level
                count += dimension * (points[at + 1] - points[at])
        parts.append((4, numbers([i / 100 for i in range(count)])))
    return sections(b"ISOWCURV", (1, head), *parts)


def quincunx_details(scheme, levels, channels, rows, columns):
    side = min((rows - 1) // 2, (columns - 1) // 4) >> levels
    def nodes(level):
        return 3 * (side << level) * ((side << level) + 1) + 1
    head = text(scheme) + struct.pack("<IIQQI", levels, channels, rows, columns, 1)
    parts = [(2, numbers([i % 5 for i in range(channels * nodes(0))]))]
    parts += [(3, numbers([i / 100 for i in range(channels * (nodes(k + 1) - nodes(k)))])) for k in range(levels)]
    return sections(b"ISOWGRID", (1, head), *parts)


def relief_details(scheme, levels, channels, rows, columns):
    def side(n):
        return (n - 1 + (1 << levels) - 1) >> levels
    def nodes(level):
        return ((side(columns) << level) + 1) * ((side(rows) << level) + 1)
    head = text(scheme) + struct.pack("<IIQQ", levels, channels, rows, columns)
    parts = [(2, numbers([i % 5 for i in range(channels * nodes(0))]))]
    parts += [(3, numbers([i / 100 for i in range(channels * (nodes(k + 1) - nodes(k)))])) for k in range(levels)]
    return sections(b"ISOWGRID", (1, head), *parts)


def section_files():
    made = {
        "curve-pyramid/square": curve_pyramid(16, range(5, 11), "image 16 x 16"),
        "curve-pyramid/thin": curve_pyramid(12, range(6, 7), "1 polygon"),
        "curve-details/closed": curve_details("cubic-7", [(1, 2, [8, 16, 32])]),
        "curve-details/open": curve_details("dlg-refined", [(0, 2, [9, 17, 33]), (0, 2, [9, 17])]),
        "curve-details/space": curve_details("chaikin-4", [(1, 3, [6, 12])]),
        "curve-details/mask": curve_details("", [(1, 2, [8, 16])], "1/8 1/2 3/4 1/2 1/8", 7),
        "relief-details/heights": relief_details("butterfly-3", 1, 1, 9, 11),
        "relief-details/points": relief_details("loop-2", 2, 3, 9, 9),
        "relief-details/quincunx": quincunx_details("butterfly-3", 2, 1, 20, 37),
        "relief-details/like": relief_details("loop-like:1/16,1/8", 1, 1, 9, 9),
    }
    for name, (packed, plain) in made.items():
        yield f"{name}.packed", packed
        yield f"{name}.plain", plain


def zarrs():
    def store(array, attributes, chunk):
        return b"\0".join([json.dumps(array).encode(), json.dumps(attributes).encode() if attributes else b"", chunk])
    array = {"zarr_format": 2, "shape": [2, 3, 4], "chunks": [2, 3, 4], "dtype": "|u1", "compressor": None, "fill_value": 0, "order": "C",
             "filters": None}
    axes = [{"name": n, "type": "space", "unit": "micrometer"} for n in "zyx"]
    image = {"multiscales": [{"version": "0.4", "axes": axes, "datasets": [{"path": "0", "coordinateTransformations": [
        {"type": "scale", "scale": [2, 0.5, 0.5]}, {"type": "translation", "translation": [1, 2, 3]}]}]}]}
    yield "zarr/plain", store(array, None, VOXELS)
    yield "zarr/packed", store(dict(array, compressor={"id": "zlib", "level": 1}, dtype="<i2"), None, zlib.compress(SHORTS))
    yield "zarr/gzip_fortran", store(dict(array, compressor={"id": "gzip", "level": 1}, order="F", fill_value="NaN", dtype=">f4"), None,
                                     gzip.compress(struct.pack(">24f", *VOXELS), mtime=0))
    yield "zarr/image", store(array, image, VOXELS)
    five = dict(array, shape=[1, 2, 2, 3, 4], chunks=[1, 1, 2, 3, 4], dimension_separator="/")
    named = [{"name": n, "type": t} for n, t in zip("tczyx", ("time", "channel", "space", "space", "space"))]
    yield "zarr/five_axes", store(five, {"multiscales": [{"version": "0.4", "axes": named, "datasets": [{"path": "0"}]}]}, VOXELS)
    yield "zarr/old_image", store(five, {"multiscales": [{"version": "0.1", "datasets": [{"path": "0"}]}]}, VOXELS)


def shapes():
    """Bytes of tests/fuzz/solids/shapes.cpp: options, size, boxes; sizes there are value % 8 + 2."""
    plain = bytes([1, 0, 3])  # iso 0.5, not inverted, the fit that suits
    size, spacing = bytes([7, 7, 7]), bytes([0, 0, 0])
    block = bytes([1, 2, 4, 2, 4, 2, 4])
    wall = bytes([1, 1, 8, 4, 0, 1, 8])
    yield "lattice-solid/block", plain + size + spacing + bytes([1]) + block
    yield "lattice-solid/walls", plain + size + spacing + bytes([3]) + block + wall + bytes([1, 4, 0, 1, 8, 1, 8])
    yield "lattice-solid/hollow", plain + size + spacing + bytes([2, 1, 1, 7, 1, 7, 1, 7, 0, 3, 3, 3, 3, 3, 3])
    yield "lattice-solid/noise", bytes([1, 0, 0]) + size + spacing + bytes([0, 0, 1]) + bytes(range(256)) * 4
    yield "lattice-solid/grey", bytes([1, 0, 2]) + size + spacing + bytes([1]) + block + bytes([1, 0]) + bytes(range(256)) * 4
    box = bytes([1, 2, 2, 2, 14, 14, 14])
    tetrahedron = bytes([0, 0, 0, 0, 20, 0, 0, 0, 20, 0, 0, 0, 20])
    yield "mesh-solid/box", bytes([8, 0, 0, 0]) + box
    yield "mesh-solid/tetrahedron", bytes([8, 0, 0, 0]) + tetrahedron
    yield "mesh-solid/overlap", bytes([8, 0, 0, 1]) + box + tetrahedron
    yield "mesh-solid/nested", bytes([8, 0, 0, 1]) + box + bytes([1, 10, 10, 10, 6, 6, 6])
    yield "pyramid/renamed", bytes([0, 4, 9])
    yield "packed/lossless", bytes([1, 0])
    yield "packed/bounded", bytes([0, 0])
    yield "vdb/ball_blosc.vdb", (DATA / "vdb/ball_blosc.vdb").read_bytes()


def own():
    yield "hierarchy/cube.details", hierarchy()
    yield from section_files()
    yield from zarrs()
    for name, text in (("number", "1.5e3"), ("range", "2..5"), ("open_range", "..3"), ("triple", "0.5x0.5x1"),
                       ("list", "20000,5000"), ("place", "out/part")):
        yield f"values/{name}", text.encode()


# ---- files of tests/data

FROM_DATA = {"stl": ["broken_stl/*.stl"], "off": ["meshes/pinion.off"], "obj": ["subdiv/catmark_torus.obj", "meshes/*.obj"],
             "dicom-compressed": ["dicom_damaged/*.dcm"], "dicom": ["dicom_damaged/*.dcm"], "geojson": ["curves2d/africa.geojson"], "png": ["curves2d/*.png"],
             "points": ["coast/iceland.txt"], "nrrd": ["ct/cranium_crop.nrrd"]}


def main():
    out = pathlib.Path(sys.argv[1])
    made = [*meshes(), *images(), *pictures(), *vectors(), *shapes(), *own()]
    for target in {name.split("/")[0] for name, _ in made}:
        shutil.rmtree(out / target, ignore_errors=True)  # what an earlier version made is no seed of this one
    for name, data in made:
        (out / name).parent.mkdir(parents=True, exist_ok=True)
        (out / name).write_bytes(data)
    # Damaged ones too: not all of these are read, so they have folders of their own.
    for target, patterns in FROM_DATA.items():
        folder = out / "data" / target
        folder.mkdir(parents=True, exist_ok=True)
        for path in sorted(p for pattern in patterns for p in DATA.glob(pattern)):
            if path.stat().st_size <= LARGEST:
                (folder / path.name).write_bytes(path.read_bytes())
    print(f"{len(made)} seeds in {out}")


if __name__ == "__main__":
    main()
