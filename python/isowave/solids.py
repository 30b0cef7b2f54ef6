"""Solids: ladders of meshes, pyramids, fields."""

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from functools import partial
from typing import Any, Callable, Optional, Union, overload

import numpy as np
import numpy.typing as npt

from . import _native
from ._adapters import Adapters
from ._edits import Move, Tool, edits_of, listed
from ._html import grouped, ladder_html, short
from ._meshes import Mesh, PathLike, is_mesh, is_path, triangles_of
from ._options import Given, given
from ._volumes import Geometry, is_image, voxels_of
from ._watch import ProgressLike, Watch
from .errors import UsageError

__all__ = ["Field", "FieldMesh", "Ladder", "Level", "Pyramid", "analyse", "field", "lod"]

Range = Union[int, str, range, tuple[Optional[int], Optional[int]]]
Labels = Union[float, "Sequence[float]"]


# ---- what comes in


class InSlabs:
    """An image whose slabs others work on; see isowave.distributed."""

    def __init__(self, path: str, slabs: int, folder: str, memory: Optional[float] = None) -> None:
        self.path, self.slabs, self.folder, self.memory = path, slabs, folder, memory  # memory: bytes a slab

    def run(self, options: Given, tasks: list[str], report: Callable[[float], bool]) -> Optional[list[str]]:
        """What _native.run_slab_task(path, options, ...) gives for each task, in order; None where report(share) was False."""
        raise NotImplementedError

    def open(self, options: Given, watch: Watch) -> _native.Solid:
        return _native.open_in_slabs(self.path, options, self.slabs, self.memory, self.folder, partial(self.run, options), watch)


def _open_for_field(source: Any, faces: Any, geometry: Geometry, options: Given, watch: Watch, finest: int = 0) -> _native.Solid:
    """No levels are made: they would take most of the memory that is allowed for."""
    if isinstance(source, Pyramid):
        return _open(source, faces, geometry, options, watch)
    return _open(source, faces, geometry, [*options, ("--field-only", "")], watch, finest)


def _open(source: Any, faces: Any, geometry: Geometry, options: Given, watch: Watch, finest: int = 0) -> _native.Solid:
    if isinstance(source, InSlabs):
        geometry.refuse(f"{source.path} has a place of its own")
        return source.open(options, watch)
    if isinstance(source, Pyramid):
        geometry.refuse("a pyramid has a place of its own")
        if options:
            raise UsageError(f"{options[0][0]} says how a solid is read or fitted; a pyramid has been; leave it out")
        return _native.solid_of(source._native)
    if faces is None and is_path(source):
        geometry.refuse(f"{os.fspath(source)} has a place of its own", spacing_too=False)
        if geometry.spacing is not None:
            options = options + given(spacing=geometry.spacing)
        return _native.open_file(os.fspath(source), options, finest, watch)
    if faces is not None or (not is_image(source) and is_mesh(source)):
        geometry.refuse("a mesh has a place of its own")
        points, triangles = triangles_of(source, faces)
        return _native.open_triangles(points, triangles, options, watch)
    return _open_voxels(source, geometry, options, watch)


def _open_voxels(source: Any, geometry: Geometry, options: Given, watch: Watch) -> _native.Solid:
    numbers = [value for name, value in options if name == "--volume"]
    if numbers and not numbers[0].isdigit():
        raise UsageError(f"--volume: '{numbers[0]}' is not a whole number from 1 on")
    number = int(numbers[0]) if numbers else None
    foreign = ("--size", "--type", "--endian", "--header-bytes", "--series", "--stack", "--channel", "--time",
               "--resample-slices")  # fmt: skip
    for name, _ in options:
        if name in foreign:
            raise UsageError(f"{name} says how a file is read; voxels in memory have been; leave it out")
    voxels = voxels_of(source, geometry, number)
    if voxels.remark is not None:
        watch.remark(voxels.remark)
    rest = [option for option in options if option[0] != "--volume"]
    return _native.open_voxels(voxels.array, voxels.big_endian, voxels.affine, rest, watch)


# ---- fields and pyramids


class FieldMesh(Adapters):
    """The mesh of a field: ``mesh``, ``normals``, ``to_...``."""

    def __init__(self, arrays: tuple[npt.NDArray[Any], npt.NDArray[Any], npt.NDArray[Any]]) -> None:
        self._mesh = Mesh(arrays[0], arrays[1])
        self._normals = arrays[2]

    @property
    def mesh(self) -> Mesh:
        return self._mesh

    @property
    def normals(self) -> npt.NDArray[np.float32]:
        return self._normals


class Field:
    """The function whose zero set is a surface: a cubic B-spline, negative inside.

    >>> ball = np.linalg.norm(np.indices((24, 24, 24)) - 11.5, axis=0) < 8
    >>> step0 = analyse(ball, spacing=(1, 1, 1)).field(0)
    >>> step0([[11.5, 11.5, 11.5], [23, 23, 23]]) * [1, -1] < 0
    array([ True,  True])
    """

    def __init__(self, native: _native.Field) -> None:
        self._native = native

    @property
    def K(self) -> float:
        """The field is K far outside and -K far inside."""
        return self._native.K

    @property
    def control_points(self) -> int:
        return self._native.control_point_count

    @property
    def spacing(self) -> tuple[float, float, float]:
        """Between lattice points along the lattice's three axes; world units."""
        x, y, z = self._native.spacing
        return x, y, z

    def __call__(self, points: npt.ArrayLike) -> npt.NDArray[np.float64]:
        """The field's values at points (..., 3) of the world: an array (...)."""
        array = _points_of(points)
        return self._native.values(array.reshape(-1, 3)).reshape(array.shape[:-1])

    def gradient(self, points: npt.ArrayLike) -> npt.NDArray[np.float64]:
        """Its gradients at points (..., 3), by world units: an array (..., 3)."""
        array = _points_of(points)
        return self._native.gradients(array.reshape(-1, 3)).reshape(array.shape)

    def polygonize(
        self, *, refine: int = 1, iso: float = 0.0, threads: Optional[int] = None, progress: Optional[ProgressLike] = None
    ) -> FieldMesh:
        """The closed mesh of the place where the field is ``iso`` (-K < iso < K).

        refine: samples of a node along each axis, 1, 2 or 4.

        >>> ball = np.linalg.norm(np.indices((24, 24, 24)) - 11.5, axis=0) < 8
        >>> points, triangles = field(ball, spacing=(1, 1, 1)).polygonize().mesh
        >>> points.shape[1], triangles.dtype
        (3, dtype('int32'))
        """
        if refine not in (1, 2, 4):
            raise UsageError(f"--refine: '{refine}' is not one of 1, 2, 4")
        if not -self.K < iso < self.K:
            raise UsageError(f"--iso: {iso} is not between -{self.K:g} and {self.K:g}, the field's values")
        return FieldMesh(self._native.polygonize(refine, iso, Watch(progress, threads)))

    def save(self, path: PathLike) -> None:
        """Writes the control points into a .vdb, as ``isowave field`` does; the file appears whole or not at all."""
        self._native.save(os.fspath(path))

    def __repr__(self) -> str:
        return f"<isowave.Field: {self.control_points:,} control points>"


def _points_of(points: npt.ArrayLike) -> npt.NDArray[np.float64]:
    array = np.asarray(points, dtype=np.float64)
    if array.ndim == 0 or array.shape[-1] != 3:
        raise UsageError(f"points: have the shape {array.shape}; expected (..., 3)")
    return array


def _value_of(text: str) -> Any:
    """A value of a pyramid's source: JSON, or what another program wrote there.

    >>> _value_of("2.5"), _value_of('"distance"'), _value_of("by hand")
    (2.5, 'distance', 'by hand')
    """
    try:
        return json.loads(text)
    except ValueError:
        return text


class Pyramid:
    """A solid taken apart step by step, without loss. Step s has s directions halved.

    Level l is step 3 l of voxels that are cubes; ``steps`` says which step is which level of others.

    >>> ball = np.linalg.norm(np.indices((24, 24, 24)) - 11.5, axis=0) < 8
    >>> pyramid = analyse(ball, spacing=(1, 1, 1))
    >>> pyramid.field(3).spacing
    (2.0, 2.0, 2.0)
    >>> len(lod(pyramid, levels=(0, 1)))
    2
    """

    def __init__(self, native: _native.Pyramid, remarks: Sequence[str] = (), report: Optional[str] = None) -> None:
        self._native = native
        #: Decisions that were taken, a line each.
        self.remarks = list(remarks)
        #: Of what edit() made: what ``isowave edit --json`` writes, without files' names; None of all else.
        self.report: Optional[dict[str, Any]] = json.loads(report) if report else None

    @classmethod
    def load(cls, path: PathLike) -> Pyramid:
        """Reads a file of save(), ``isowave analyse`` or ``isowave pack``, whose steps are computed again.

        Raises InputError for what is no pyramid or damaged.
        """
        watch = Watch()
        return cls(_native.load_pyramid(os.fspath(path), watch), watch.remarks)

    def save(self, path: PathLike) -> None:
        """Writes one .vdb, or level 0 alone, packed, into an .iwz; it appears whole or not at all.

        Raises UsageError for another extension, OperationError.
        """
        self._native.save(os.fspath(path))

    @property
    def K(self) -> float:
        return self._native.K

    @property
    def step_count(self) -> int:
        """Steps 0 to step_count, included, can be had."""
        return self._native.step_count

    @property
    def coefficients_stored(self) -> int:
        return self._native.coefficients_stored

    @property
    def control_points(self) -> int:
        """Of step 0."""
        return self._native.control_points

    @property
    def memory_bytes(self) -> int:
        return self._native.memory_bytes

    @property
    def source(self) -> dict[str, Any]:
        """Where the solid came from: "input.path", "fit.method", ..."""
        return {key: _value_of(text) for key, text in self._native.source.items()}

    @property
    def steps(self) -> list[dict[str, Any]]:
        """A dictionary a step, finest first, with the keys of ``isowave info --json``."""
        steps: list[dict[str, Any]] = json.loads(self._native.steps())
        return steps

    def field(self, step: int = 0, *, threads: Optional[int] = None, progress: Optional[ProgressLike] = None) -> Field:
        """The field of a step. Raises UsageError where there is no such step."""
        if not 0 <= step <= self.step_count:
            raise UsageError(f"--step: there is no step {step}; the pyramid has steps 0 to {self.step_count}")
        return Field(self._native.field(step, Watch(progress, threads)))

    def edit(
        self,
        *,
        add: Union[Tool, list[Tool], None] = None,
        cut: Union[Tool, list[Tool], None] = None,
        move: Union[Move, list[Move], None] = None,
        with_: Union[Pyramid, Field, PathLike, None] = None,
        level: int = 0,
        blend: Optional[float] = None,
        check: bool = False,
        max_memory: Optional[float] = None,
        threads: Optional[int] = None,
        progress: Optional[ProgressLike] = None,
    ) -> Pyramid:
        """A new pyramid, to which something is added, of which something is cut or moved, as ``isowave edit`` does it.

        This one stays what it is. Away from the tools level 0 of the new one is the same to the bit. ``report`` has the
        volumes before and after. Edits are made in the order add, cut, move, with_; another order is several calls, which
        make the same bits as one.

        add, cut: a tool or a list of tools: "ball:X,Y,Z,R" or (centre, radius); "X,Y,Z:X,Y,Z" or (low, high), a box; a path, a closed
        mesh's file; a mesh, as check() takes it. World coordinates, LPS mm for images.
        move: (box, by) or a list of these: what of the solid lies in the box, moved by (x, y, z).
        with_: a Pyramid, whose level 0 is taken whole, which undoes edits; a Field of this level, changed elsewhere; the file of either.
        level: tools are sampled on its lattice, so that their edges are as round as its surfaces are.
        blend: radius of the fillet where a tool meets the surface, world units; without it the edge is sharp.
        check: makes the mesh of every step and counts the closed ones, as ``report["steps_closed"]``.
        max_memory: GB; tools that would take more are refused. Without it 70 % of the computer's.

        Raises UsageError: no edit, a level that there is not, numbers that make no sense; InputError: a tool that misses the solid, an
        edit that changes nothing or removes everything, a mesh that is open, a field of another lattice.

        >>> ball = np.linalg.norm(np.indices((24, 24, 24)) - 11.5, axis=0) < 8
        >>> pyramid = analyse(ball, spacing=(1, 1, 1))
        >>> drilled = pyramid.edit(cut=((11.5, 11.5, 3.5), 3))
        >>> -57 < drilled.report["edits"][0]["volume_change"] < -45  # about half a ball of radius 3
        True
        >>> np.array_equal(drilled.edit(with_=pyramid).field(0)([[8, 8, 4]]), pyramid.field(0)([[8, 8, 4]]))
        True
        """
        watch = Watch(progress, threads)
        edits = edits_of(add, cut, move, level, blend, check, max_memory)
        for other in listed(with_):
            if isinstance(other, Pyramid):
                edits.with_pyramid(other._native)
            elif isinstance(other, Field):
                edits.with_field(other._native)
            elif is_path(other):
                edits.with_file(os.fspath(other))
            else:
                raise UsageError(f"--with: {other!r} is a {type(other).__name__}; expected a Pyramid, a Field or a path")
        native, report = _native.edit(self._native, edits, watch)
        return Pyramid(native, self.remarks + watch.remarks, report)

    def __repr__(self) -> str:
        return f"<isowave.Pyramid: {self.step_count} steps, {self.coefficients_stored:,} coefficients>"


# ---- ladders


class Level(Adapters):
    """One mesh of a ladder, and what it has kept and lost."""

    def __init__(self, ladder: Ladder, index: int, report: dict[str, Any]) -> None:
        self._ladder = ladder
        self._index = index
        #: The entry of ``report.json`` for this mesh.
        self.report = report
        points, triangles, normals = ladder._native.arrays(index)
        self._mesh = Mesh(points, triangles)
        self._normals = normals

    @property
    def mesh(self) -> Mesh:
        """points (V, 3) float64 and triangles (F, 3) int32: read-only views of the ladder's memory, no copies.

        World units; for images millimetres, LPS. Triangles are counter-clockwise seen from outside.
        """
        return self._mesh

    @property
    def normals(self) -> npt.NDArray[np.float32]:
        """(V, 3), unit vectors that point outside; (0, 3) where a mesh has none."""
        return self._normals

    @property
    def step(self) -> int:
        """Of a budget: that its mesh was made of."""
        return int(self.report["step"])

    @property
    def level(self) -> Optional[int]:
        """None between two levels: step / 3 of cubic voxels, where that is whole. Of a budget as for step."""
        level = self.report["level"]
        return None if level is None else int(level)

    @property
    def field(self) -> Field:
        """The wavelet transform's field of this step, as ``isowave field`` writes it.

        It knows nothing of what was done to the mesh alone: thin parts held, volume kept, triangles collapsed. The first
        call analyses the solid down to this step. Raises UsageError for a ladder made with keep_field=False.
        """
        return self._ladder._field(self.step)

    def save(self, path: PathLike, *, space: Optional[str] = None, colour: Optional[str] = None) -> None:
        """Writes the mesh as .stl, .ply, .obj, .off, .glb, .vtp or .3mf; the file appears whole or not at all.

        space: "lps" or "ras", the axes of the written coordinates, for images.
        colour: "distance", in .ply, .glb and .vtp: each vertex's distance to level 0 of the ladder, as distance_to_level0.
        """
        self._ladder._native.write(self._index, os.fspath(path), (space or "").lower(), (colour or "").lower())

    def __repr__(self) -> str:
        name = f"level {self.level}" if self.level is not None else f"step {self.step}"
        return f"<isowave.Level: {name}, {len(self.triangles):,} triangles, volume {short(self.report['volume'])}>"


class Ladder(Sequence[Level]):
    """Closed meshes, finest first: the levels, then the budgets. A level at which nothing is left is not among them.

    >>> ball = np.linalg.norm(np.indices((24, 24, 24)) - 11.5, axis=0) < 8
    >>> ladder = lod(ball, spacing=(1, 1, 1))
    >>> [level.level for level in ladder][:2], ladder[0].report["genus"]
    ([0, 1], 0)
    >>> points, triangles = ladder[1].mesh
    """

    def __init__(
        self, native: _native.Ladder, solid: Optional[_native.Solid], inputs: list[str], unit: str, remarks: list[str]
    ) -> None:
        self._native = native
        self._solid = solid
        self._fields: dict[int, Field] = {}
        self._inputs = inputs
        self._unit = unit
        #: Decisions and defaults that were taken, a line each; the logger "isowave" has them too.
        self.remarks = remarks
        #: What ``isowave lod`` writes as report.json; ``file`` is None until save() has given names.
        self.report: dict[str, Any] = {**json.loads(native.report()), "remarks": list(remarks)}
        count = native.level_count
        reports = self.report["levels"][:count] + self.report["budgets"]
        self._levels = [Level(self, i, report) for i, report in enumerate(reports)]

    @property
    def levels(self) -> list[Level]:
        """Those of levels or steps."""
        return self._levels[: self._native.level_count]

    @property
    def budgets(self) -> list[Level]:
        """Those of triangles, ratio, tolerance, min_component, in this order."""
        return self._levels[self._native.level_count :]

    def __len__(self) -> int:
        return len(self._levels)

    @overload
    def __getitem__(self, index: int) -> Level: ...

    @overload
    def __getitem__(self, index: slice) -> list[Level]: ...

    def __getitem__(self, index: Union[int, slice]) -> Union[Level, list[Level]]:
        return self._levels[index]

    def save(
        self,
        folder: PathLike,
        *,
        format: str = "ply",
        space: Optional[str] = None,
        colour: Optional[str] = None,
        tiles: Optional[str] = None,
        threads: Optional[int] = None,
        progress: Optional[ProgressLike] = None,
    ) -> list[str]:
        """Writes what ``isowave lod -o folder`` writes: one mesh a level, and report.json. Returns the files' paths.

        ``save("out/cranium")`` makes out/cranium/cranium_L0.ply, ... All files appear at once, or none does.

        format: stl, ply, obj, off, glb, vtp or 3mf.
        space: "lps" or "ras", the axes of the written coordinates, for images and meshes that say SPACE=.
        colour: "distance", with ply, glb and vtp: each vertex's distance to level 0, as distance_to_level0.

        tiles: "neuroglancer" or "3d-tiles": also the levels in tiles, a folder, as ``isowave lod --tiles`` has it.

        Raises UsageError for a file that is the ladder's own input, for tiles of steps, and for a colour where the format has no place for it or the ladder no
        level 0; OperationError where writing fails.
        """
        watch = Watch(progress, threads)
        paths = self._native.save(os.fspath(folder), format, (space or "").lower(), (colour or "").lower(), tiles or "", self._inputs, self.remarks, watch)
        return [os.fspath(path) for path in paths]

    def _field(self, step: int) -> Field:
        if self._solid is None:
            raise UsageError("this ladder was made with keep_field=False; make it without, or take isowave.field()")
        if step not in self._fields:
            self._fields[step] = Field(_native.field_of(self._solid, step, Watch()))
        return self._fields[step]

    def _repr_html_(self) -> str:
        return ladder_html([level.report for level in self], os.path.basename(self.report["input"]["path"]), self._unit)

    def __repr__(self) -> str:
        counts = ", ".join(grouped(len(level.triangles)) for level in self)
        return f"<isowave.Ladder of {self.report['input']['path']}: {len(self)} meshes of {counts} triangles>"


def lod(
    source: Any,
    faces: Any = None,
    *,
    # where an array lies
    affine: Any = None,
    spacing: Any = None,
    origin: Any = None,
    direction: Any = None,
    axes: Optional[str] = None,
    space: Optional[str] = None,
    # what is inside
    iso: Optional[float] = None,
    label: Optional[Labels] = None,
    invert: bool = False,
    open_border: bool = False,
    nan: Optional[float] = None,
    # meshes
    voxels: Optional[int] = None,
    voxel: Optional[float] = None,
    close_holes: Optional[float] = None,
    thicken: Optional[float] = None,
    unit: Optional[str] = None,
    # which meshes
    levels: Optional[Range] = None,
    steps: Optional[Range] = None,
    triangles: Union[None, int, Sequence[int]] = None,
    ratio: Union[None, float, Sequence[float]] = None,
    tolerance: Union[None, float, Sequence[float]] = None,
    max_genus: Optional[int] = None,
    max_parts: Optional[int] = None,
    min_component: Optional[float] = None,
    # how they are made
    refine: Optional[int] = None,
    hold: Optional[str] = None,
    preserve_volume: bool = False,
    keep_specks: bool = False,
    features: bool = False,
    refit: bool = False,
    compact: bool = False,
    relax: Optional[int] = None,
    deviation: bool = False,
    fine: Union[None, str, PathLike, Sequence[Union[str, PathLike]]] = None,
    fine_within: Optional[float] = None,
    adaptive: Union[None, float, str] = None,
    # the fit
    fit: Optional[str] = None,
    half_width: Optional[float] = None,
    band: Optional[float] = None,
    # what steps halve
    step_axes: Optional[str] = None,
    # files
    volume: Optional[int] = None,
    size: Optional[Sequence[int]] = None,
    type: Optional[str] = None,
    endian: Optional[str] = None,
    header_bytes: Optional[int] = None,
    series: Optional[str] = None,
    stack: Optional[int] = None,
    channel: Optional[int] = None,
    time: Optional[int] = None,
    resample_slices: bool = False,
    grid: Optional[str] = None,
    # the job
    threads: Optional[int] = None,
    max_memory: Optional[float] = None,
    slabs: Optional[int] = None,
    progress: Optional[ProgressLike] = None,
    keep_field: bool = True,
) -> Ladder:
    """A solid in, closed meshes out: one a level, or one a budget, each with a report.

    Arguments have the names, defaults and meanings of the options of ``isowave lod`` (``isowave help lod``).

    source: one of
        - a path: whatever ``isowave lod`` reads (NIfTI, NRRD, DICOM folders, OME-Zarr, STL, PLY, .vdb, ...)
        - a NumPy array of three dimensions, bool, int8 to int64, uint8 to uint64, float32 or float64, of any strides and
          byte order; nothing is copied but a slab at a time. Its place is given by ``affine``, or by ``spacing``,
          ``origin`` and ``direction``
        - an image of nibabel or SimpleITK, which has a place of its own
        - a mesh: (points (V, 3), triangles (F, 3)), or one of isowave, trimesh, pyvista, open3d, vtk
        - a Pyramid
    faces: triangles (F, 3), where ``source`` is points.

    affine: (4, 4) or (3, 4), indices (x, y, z) -> mm.
    spacing: mm along x, y, z. origin: of voxel (0, 0, 0), mm. direction: (3, 3), columns are the axes' unit vectors.
    axes: "xyz" (without it) or "zyx", the order of the array's indices; the other arguments are always x, y, z.
    space: "LPS" (without it) or "RAS", the world of affine, origin and direction. Meshes are LPS.

    levels, steps: a number, (first, last) with both included and either None, a range, or the command's text "1..3".
    step_axes: the option --axes: "auto" (without it), where a voxel's edges differ by a factor of 2 or more, lets the first levels halve
        the short ones alone; "cubes" does so wherever that brings voxels nearer to a cube; "xyz" lets every level halve all three.
    fine: a region "x,y,z:x,y,z" or "mesh.stl", ":1" behind it for level 1 instead of 0; or several. Coarser levels keep the
        details of that level there; ``fine_within`` widens all of them.
    adaptive: coarser levels keep finer ones wherever they would be farther than this from level 0: a number (world units), or a text
        with a unit, "0.3voxel" (of level 0) or "0.2mm".
    progress: a callback (share of the stage 0 to 1, stage), always called by the thread that called lod(), or a bar of tqdm.
    keep_field: keep the field in memory, for Level.field.

    Ctrl-C ends it with KeyboardInterrupt; the GIL is free meanwhile. Results are the same to the bit for any ``threads``.

    Raises UsageError for arguments that contradict each other or the input, InputError for bad data, OperationError.

    >>> ball = np.linalg.norm(np.indices((24, 24, 24)) - 11.5, axis=0) < 8
    >>> ladder = lod(ball, spacing=(0.5, 0.5, 0.5), levels=(0, 1))
    >>> len(ladder), ladder[0].report["closed"], round(ladder[0].report["volume"] / (0.5**3 * ball.sum()), 3)
    (2, True, 1.0)
    >>> lod(ball, affine=np.eye(4), spacing=(1, 1, 1))
    Traceback (most recent call last):
    isowave.errors.UsageError: affine and spacing exclude each other; an affine holds spacing, origin and direction
    """
    geometry = Geometry(affine, spacing, origin, direction, axes, space)
    watch = Watch(progress, threads)
    making = given(
        levels=levels, steps=steps, refine=refine, hold=hold, preserve_volume=preserve_volume, keep_specks=keep_specks,
        features=features, refit=refit, compact=compact, relax=relax, deviation=deviation, fine=fine, fine_within=fine_within,
        adaptive=adaptive,
        triangles=triangles, ratio=ratio, tolerance=tolerance, max_genus=max_genus, max_parts=max_parts, min_component=min_component,
    )  # fmt: skip
    opening = given(
        iso=iso, label=label, invert=invert, open_border=open_border, nan=nan, voxels=voxels, voxel=voxel,
        close_holes=close_holes, thicken=thicken, unit=unit, fit=fit, half_width=half_width, band=band, volume=volume,
        step_axes=step_axes, size=size, type=type, endian=endian, header_bytes=header_bytes, series=series, stack=stack, channel=channel,
        time=time, resample_slices=resample_slices, grid=grid, max_memory=max_memory, slabs=slabs,
    )  # fmt: skip
    _native.check_ladder_options(making + given(open_border=open_border))
    solid = _open(source, faces, geometry, opening, watch)
    unit_known = "mm" if solid.space else unit or ""
    native = _native.make_ladder(solid, making, keep_field, watch)
    inputs = [os.fspath(source)] if faces is None and is_path(source) else []
    return Ladder(native, solid if keep_field else None, inputs, unit_known, watch.remarks)


def analyse(
    source: Any,
    faces: Any = None,
    *,
    affine: Any = None,
    spacing: Any = None,
    origin: Any = None,
    direction: Any = None,
    axes: Optional[str] = None,
    space: Optional[str] = None,
    iso: Optional[float] = None,
    label: Optional[Labels] = None,
    invert: bool = False,
    open_border: bool = False,
    nan: Optional[float] = None,
    voxels: Optional[int] = None,
    voxel: Optional[float] = None,
    close_holes: Optional[float] = None,
    thicken: Optional[float] = None,
    unit: Optional[str] = None,
    fit: Optional[str] = None,
    half_width: Optional[float] = None,
    band: Optional[float] = None,
    step_axes: Optional[str] = None,
    volume: Optional[int] = None,
    size: Optional[Sequence[int]] = None,
    type: Optional[str] = None,
    endian: Optional[str] = None,
    header_bytes: Optional[int] = None,
    series: Optional[str] = None,
    stack: Optional[int] = None,
    channel: Optional[int] = None,
    time: Optional[int] = None,
    resample_slices: bool = False,
    grid: Optional[str] = None,
    threads: Optional[int] = None,
    max_memory: Optional[float] = None,
    slabs: Optional[int] = None,
    progress: Optional[ProgressLike] = None,
) -> Pyramid:
    """A solid -> its pyramid, from which every step can be had back. Arguments are those of lod() that say what the solid is.

    Raises as lod() does.

    >>> points = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
    >>> faces = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]
    >>> pyramid = analyse(points, faces, voxels=16)
    >>> pyramid.source["input.kind"], pyramid.field(0)([[0.2, 0.2, 0.2]]) < 0
    ('mesh', array([ True]))
    """
    geometry = Geometry(affine, spacing, origin, direction, axes, space)
    watch = Watch(progress, threads)
    opening = given(
        iso=iso, label=label, invert=invert, open_border=open_border, nan=nan, voxels=voxels, voxel=voxel,
        close_holes=close_holes, thicken=thicken, unit=unit, fit=fit, half_width=half_width, band=band, volume=volume,
        step_axes=step_axes, size=size, type=type, endian=endian, header_bytes=header_bytes, series=series, stack=stack, channel=channel,
        time=time, resample_slices=resample_slices, grid=grid, max_memory=max_memory, slabs=slabs,
    )  # fmt: skip
    return Pyramid(_native.analyse(_open_for_field(source, faces, geometry, opening, watch), watch), watch.remarks)


def field(
    source: Any,
    faces: Any = None,
    *,
    step: int = 0,
    threads: Optional[int] = None,
    progress: Optional[ProgressLike] = None,
    affine: Any = None,
    spacing: Any = None,
    origin: Any = None,
    direction: Any = None,
    axes: Optional[str] = None,
    space: Optional[str] = None,
    **options: Any,
) -> Field:
    """The field of one step of a solid, as ``isowave field`` makes it. Arguments and errors are those of analyse().

    Raises InputError where the solid does not go so far.

    >>> ball = np.linalg.norm(np.indices((24, 24, 24)) - 11.5, axis=0) < 8
    >>> field(ball, spacing=(1, 1, 1), step=3).spacing
    (2.0, 2.0, 2.0)
    """
    if step < 0:
        raise UsageError(f"--step: '{step}' is below 0")
    watch = Watch(progress, threads)
    geometry = Geometry(affine, spacing, origin, direction, axes, space)
    return Field(_native.field_of(_open_for_field(source, faces, geometry, given(**options), watch, step), step, watch))
