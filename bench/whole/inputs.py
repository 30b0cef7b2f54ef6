"""What bench/whole measures: six real files and a made one, each with the options that make a ladder of it."""
import dataclasses
import gzip
import pathlib

import numpy as np


@dataclasses.dataclass
class Input:
    name: str
    path: pathlib.Path
    options: list  # of isowave lod, voxels or iso-value among them
    levels: int  # the ladder is levels 0..levels
    voxels: int = 0  # of a mesh
    iso: float = 0  # of an image

    @property
    def is_mesh(self):
        return self.voxels > 0


def mesh(path, voxels, levels=3):
    path = pathlib.Path(path)
    return Input(f"{path.name.split('.')[0]} {voxels}", path, ["--voxels", str(voxels)], levels, voxels=voxels)


def image(path, iso, levels=4, name=None, options=()):
    path = pathlib.Path(path)
    return Input(name or path.name.split(".")[0], path, ["--iso", str(iso), *options], levels, iso=iso)


def unpacked(path, folder):
    """Neither isowave nor vdb_tool reads a mesh through gzip; unpacking is not counted."""
    plain = pathlib.Path(folder) / path.stem
    if path.exists() and not plain.exists():
        plain.write_bytes(gzip.decompress(path.read_bytes()))
    return plain


def real_inputs(shared, folder):
    data = pathlib.Path(shared) / "data"
    wanted = [
        mesh(data / "cad/TR12J_OCC.stl", 512),
        mesh(data / "mesh/bunny.bin.stl", 512),
        mesh(unpacked(data / "cad/heatsink_aavid.stl.gz", folder), 256),
        image(data / "ct_cranium/cranium.nhdr", 300),
        image(data / "mri/ch2better.nii.gz", 100),
        image(data / "mri/wm_white_matter.nii.gz", 0.5),
    ]
    return [i for i in wanted if i.path.exists()], [i for i in wanted if not i.path.exists()]


def gyroid_ball(size, folder):
    """A ball of a gyroid, uint8, size^3, x fastest, its grey rising over two voxels; about 0.18 size^3 control points at 512."""
    path = pathlib.Path(folder) / f"gyroid{size}.nrrd"
    if not path.exists():
        write_gyroid(path, size)
    return image(path, 127.5, name=f"gyroid ball {size}")


def write_gyroid(path, size):
    part = path.with_suffix(".part")
    period = size * 36 / 512
    at = np.arange(size) - (size - 1) / 2
    k = 2 * np.pi / period
    s, c = np.sin(k * at).astype(np.float32), np.cos(k * at).astype(np.float32)
    with open(part, "wb") as out:
        out.write(f"NRRD0004\ntype: uint8\ndimension: 3\nsizes: {size} {size} {size}\nspacings: 1 1 1\nencoding: raw\n\n".encode())
        for z in range(size):
            gyroid = s[None, :] * c[:, None] + s[:, None] * c[z] + s[z] * c[None, :]
            distance = np.sqrt(at[None, :] ** 2 + at[:, None] ** 2 + at[z] ** 2) - 0.45 * size
            inside = -np.maximum(gyroid / (1.5 * k), distance)
            out.write(np.clip(127.5 + 63.75 * inside, 0, 255).round().astype(np.uint8).tobytes())
    part.replace(path)
