"""Whatever holds voxels -> an array whose indices are (x, y, z), without a copy, and where it lies."""

from __future__ import annotations

import os
import sys
from dataclasses import dataclass
from typing import Any, Optional

import numpy as np
import numpy.typing as npt

from .errors import InputError, UsageError

__all__ = ["Geometry", "Voxels", "is_image", "voxels_of"]

_TYPES = "bool, int8 to int64, uint8 to uint64, float32, float64"


@dataclass
class Geometry:
    """The arguments that say where an array lies; None: not given."""

    affine: Any = None
    spacing: Any = None
    origin: Any = None
    direction: Any = None
    axes: Optional[str] = None
    space: Optional[str] = None

    def refuse(self, what: str, spacing_too: bool = True) -> None:
        """Raises UsageError when one was given for what has a place of its own."""
        for name, value in vars(self).items():
            if value is not None and (spacing_too or name != "spacing"):
                raise UsageError(f"{name} says where an array lies; {what}; leave it out")


@dataclass
class Voxels:
    array: npt.NDArray[Any]  # (x, y, z), any strides
    big_endian: bool
    affine: list[float]  # 3 x 4, row by row: indices -> LPS, mm
    remark: Optional[str] = None


def is_image(source: Any) -> bool:
    """Whether it is an image of nibabel or SimpleITK, by what it can do."""
    return _is_nibabel(source) or _is_itk(source)


def _is_nibabel(source: Any) -> bool:
    return hasattr(source, "dataobj") and hasattr(source, "affine")


def _is_itk(source: Any) -> bool:
    return all(hasattr(source, name) for name in ("GetSpacing", "GetOrigin", "GetDirection", "GetSize"))


def _numbers(name: str, value: Any, shape: tuple[int, ...]) -> npt.NDArray[np.float64]:
    """value as finite numbers of that shape; a flat list of as many is one too."""
    try:
        array = np.asarray(value, dtype=np.float64)
    except (TypeError, ValueError):
        raise UsageError(f"{name}: {value!r} is not made of numbers") from None
    if array.size == int(np.prod(shape)) and array.ndim == 1:
        array = array.reshape(shape)
    if array.shape != shape:
        expected = " x ".join(map(str, shape))
        raise UsageError(f"{name}: has the shape {array.shape}; expected {expected} numbers")
    if not np.isfinite(array).all():
        raise UsageError(f"{name}: holds a number that is not finite")
    return array


def _affine(geometry: Geometry) -> npt.NDArray[np.float64]:
    """3 x 4, in the space that was named."""
    if geometry.affine is not None:
        for name in ("spacing", "origin", "direction"):
            if getattr(geometry, name) is not None:
                raise UsageError(f"affine and {name} exclude each other; an affine holds spacing, origin and direction")
        if np.shape(geometry.affine) == (3, 4):
            return _numbers("affine", geometry.affine, (3, 4))
        matrix = _numbers("affine", geometry.affine, (4, 4))
        if not np.array_equal(matrix[3], [0, 0, 0, 1]):
            raise UsageError(f"affine: its last row is {matrix[3].tolist()}; expected [0, 0, 0, 1]")
        return matrix[:3]
    spacing = _numbers("spacing", (1, 1, 1) if geometry.spacing is None else geometry.spacing, (3,))
    if not (spacing > 0).all():
        raise UsageError(f"--spacing: {tuple(spacing.tolist())} is not above 0 along each axis")
    origin = _numbers("origin", (0, 0, 0) if geometry.origin is None else geometry.origin, (3,))
    direction = _numbers("direction", np.eye(3) if geometry.direction is None else geometry.direction, (3, 3))
    return np.column_stack([direction * spacing, origin])


def _in_lps(affine: npt.NDArray[np.float64], space: Optional[str]) -> list[float]:
    if space not in (None, "LPS", "RAS"):
        raise UsageError(f"space: '{space}' is not one of LPS, RAS")
    turn = np.array([[-1.0], [-1.0], [1.0]] if space == "RAS" else [[1.0], [1.0], [1.0]])
    return [float(v) for v in (affine * turn).ravel()]


def _shape(array: npt.NDArray[Any]) -> str:
    return " x ".join(map(str, array.shape))


def _one_volume(array: npt.NDArray[Any], number: Optional[int], last: bool) -> npt.NDArray[Any]:
    """Of an array of four dimensions the volume that was named, from 1 on; it lies along the last or the first axis."""
    if array.ndim == 4:
        axis = 3 if last else 0
        count = array.shape[axis]
        if number is None and count == 1:
            number = 1
        if number is None:
            raise InputError(f"array: holds {count} volumes ({_shape(array)}); choose one with --volume 1 to {count}")
        if not 1 <= number <= count:
            raise UsageError(f"--volume: there is no volume {number}; the array holds {count}, from 1 on")
        return np.asarray(np.moveaxis(array, axis, 0)[number - 1])
    if number is not None:
        raise UsageError(f"--volume: the array has {array.ndim} dimensions, not the volumes of a fourth; leave it out")
    if array.ndim != 3:
        raise InputError(f"array: has {array.ndim} dimensions ({_shape(array)}); expected 3, one volume")
    return array


def refuse_masked(values: Any, name: str) -> None:
    """A masked array would lose its mask on the way."""
    if isinstance(values, np.ma.MaskedArray):
        raise InputError(f"{name}: is masked, and its mask would be lost; give array.filled(value)")


def _checked(values: Any) -> npt.NDArray[Any]:
    refuse_masked(values, "array")
    array = np.asarray(values)
    numeric = array.dtype.kind in "biu" or (array.dtype.kind == "f" and array.dtype.itemsize in (4, 8))
    if not numeric:
        raise InputError(f"array: has the type {array.dtype}; expected {_TYPES}")
    return array


def _voxels(array: npt.NDArray[Any], affine: npt.NDArray[np.float64], space: Optional[str]) -> Voxels:
    order = array.dtype.byteorder
    big = order == ">" or (order == "=" and sys.byteorder == "big")
    return Voxels(array, big, _in_lps(affine, space))


def _of_nibabel(image: Any, number: Optional[int]) -> Voxels:
    array = _one_volume(_checked(np.asanyarray(image.dataobj)), number, last=True)
    return _voxels(array, _numbers("affine", image.affine, (4, 4))[:3], "RAS")


def _of_itk(image: Any, number: Optional[int]) -> Voxels:
    module = sys.modules[type(image).__module__.split(".")[0]]
    array = _one_volume(_checked(module.GetArrayViewFromImage(image)), number, last=False)
    if len(image.GetSpacing()) != 3:
        raise InputError(f"array: its image has {len(image.GetSpacing())} dimensions; expected 3, one volume")
    place = Geometry(spacing=image.GetSpacing(), origin=image.GetOrigin(), direction=image.GetDirection())
    return _voxels(array.transpose(2, 1, 0), _affine(place), "LPS")


def _of_array(values: Any, geometry: Geometry, number: Optional[int]) -> Voxels:
    if geometry.axes not in (None, "xyz", "zyx"):
        raise UsageError(f"axes: '{geometry.axes}' is not one of xyz, zyx")
    reverse = geometry.axes == "zyx"
    affine = _affine(geometry)
    array = _one_volume(_checked(values), number, last=not reverse)
    voxels = _voxels(array.transpose(2, 1, 0) if reverse else array, affine, geometry.space)
    if geometry.affine is None and geometry.spacing is None:
        voxels.remark = "array: no spacing; 1 x 1 x 1 mm is assumed; give spacing or affine"
    return voxels


def voxels_of(source: Any, geometry: Geometry, number: Optional[int] = None) -> Voxels:
    """number: which volume of a fourth dimension, from 1 on.

    >>> voxels_of(np.zeros((4, 5, 6), np.int16), Geometry(spacing=(1, 1, 2), axes="zyx")).array.shape
    (6, 5, 4)
    """
    if is_image(source):
        geometry.refuse("an image has a place of its own")
        return _of_nibabel(source, number) if _is_nibabel(source) else _of_itk(source, number)
    if isinstance(source, (bytes, os.PathLike)) or source is None:
        raise UsageError(f"{source!r} holds no voxels; expected an array, an image of nibabel or SimpleITK, or a path")
    return _of_array(source, geometry, number)
