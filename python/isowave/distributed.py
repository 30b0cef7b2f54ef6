"""Solids larger than one machine: slabs of an image, fitted and halved by the workers of a Dask cluster.

    from dask.distributed import Client
    import isowave.distributed

    with Client("scheduler:8786") as client:
        ladder = isowave.distributed.lod("scan.ome.zarr", iso=300, client=client, out="/shared/scan", slabs=16)

Every worker reads the slices that its slab needs, from the image itself, and leaves what it made in a folder that all of them see; the
process that asks plans, counts, and makes meshes of the levels. Meshes and pyramids are those of ``isowave.lod`` and ``isowave.analyse``
to the bit, whatever the number of slabs and workers.
"""

from __future__ import annotations

import glob
import json
import math
import os
import shutil
import threading
import time
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any, Callable, Optional, TypeVar, Union

from . import _native
from ._meshes import PathLike
from ._options import Given
from ._watch import Watch
from .errors import OperationError, UsageError
from .solids import InSlabs, Ladder, Pyramid
from .solids import analyse as _analyse
from .solids import lod as _lod

__all__ = ["analyse", "lod"]

_LOOK = 0.1  # seconds
_Made = TypeVar("_Made")


_BUSY: dict[str, threading.Lock] = {}  # by worker


def _run(path: str, options: Given, task: str) -> str:
    """On a worker, one slab at a time by all of its threads, so that the worker's memory is that of a slab."""
    from distributed import get_worker

    worker = get_worker()
    with _BUSY.setdefault(worker.address, threading.Lock()):
        return _native.run_slab_task(path, options, task, Watch(None, worker.state.nthreads))


def _version() -> str:
    import isowave

    return isowave.__version__


def _check(client: Any) -> int:
    """How many workers there are. All need this version."""
    workers = client.scheduler_info()["workers"]
    if not workers:
        raise OperationError(f"the cluster at {client.scheduler.address} has no workers; start some, and wait for them with "
                             "client.wait_for_workers(1)")  # fmt: skip
    here = _version()
    for worker, version in client.run(_version).items():
        if version != here:
            raise UsageError(f"worker {worker} has isowave {version}, and this process {here}; install one version everywhere")
    return len(workers)


class _Cluster(InSlabs):
    def __init__(self, path: str, slabs: int, memory: Optional[float], folder: Path, client: Any) -> None:
        super().__init__(path, slabs, str(folder), memory)
        self._client = client
        self.failure: Optional[BaseException] = None

    def run(self, options: Given, tasks: list[str], report: Callable[[float], bool]) -> Optional[list[str]]:
        try:
            return self._gathered(options, tasks, report)
        except BaseException as failure:
            self.failure = failure  # it goes through C++, which ends the job
            return None

    def _gathered(self, options: Given, tasks: list[str], report: Callable[[float], bool]) -> Optional[list[str]]:
        futures = [self._client.submit(_run, self.path, options, task, pure=False, key=f"isowave-slab-{i}-{time.time_ns()}")
                   for i, task in enumerate(tasks)]  # fmt: skip
        try:
            while not all(future.done() for future in futures):
                if not report(sum(future.done() for future in futures) / len(futures)):
                    return None
                if any(future.status == "error" for future in futures):
                    break
                time.sleep(_LOOK)
            return [future.result() for future in futures]
        finally:
            self._client.cancel([future for future in futures if not future.done()])


def _image_of(source: Any, folder: Path, axes: str, spacing: Optional[Sequence[float]], origin: Optional[Sequence[float]]) -> str:
    """A path that all workers read: of a dask array an OME-Zarr that they write, chunk by chunk."""
    if isinstance(source, (str, os.PathLike)):
        if spacing is not None or origin is not None:
            raise UsageError("spacing and origin belong to a dask array; a file has its own")
        path = os.fspath(source)
        if not glob.has_magic(path):
            return os.path.abspath(path)
        folders = {os.path.dirname(name) for name in glob.glob(path)}
        if len(folders) != 1:
            raise UsageError(f"{path}: names files in {len(folders)} folders; a stack lies in one")
        return os.path.abspath(folders.pop())
    if not hasattr(source, "to_zarr") or getattr(source, "ndim", 0) != 3:
        raise UsageError(f"source: expected a path or a dask array of three dimensions, found {type(source).__name__}")
    if axes not in ("xyz", "zyx"):
        raise UsageError(f"axes: {axes!r} is neither 'xyz' nor 'zyx'")
    from dask.base import tokenize

    token = tokenize(source, axes, spacing, origin)  # type: ignore[no-untyped-call]
    store = folder / f"volume-{token}.ome.zarr"  # of this array, should another one lie there
    if not (store / ".zattrs").exists():
        shutil.rmtree(store, ignore_errors=True)
        (source.T if axes == "xyz" else source).to_zarr(str(store / "0"), component=None)
        scale, shift = list(spacing or (1, 1, 1))[::-1], list(origin or (0, 0, 0))[::-1]
        names = [{"name": name, "type": "space", "unit": "millimeter"} for name in "zyx"]
        transforms = [{"type": "scale", "scale": scale}, {"type": "translation", "translation": shift}]
        scales = [{"version": "0.4", "axes": names, "datasets": [{"path": "0", "coordinateTransformations": transforms}]}]
        (store / ".zgroup").write_text(json.dumps({"zarr_format": 2}))
        (store / ".zattrs").write_text(json.dumps({"multiscales": scales}))  # last: then all is there
    return str(store)


def _bytes(memory: Union[None, float, str], client: Any) -> Optional[float]:
    """Of a worker's slab: as given, or 80 % of what Dask lets the smallest worker have, above which it pauses it."""
    from dask.utils import parse_bytes

    if memory is None:
        limits = [worker["memory_limit"] for worker in client.scheduler_info()["workers"].values() if worker["memory_limit"]]
        return 0.8 * min(limits) if limits else None
    try:
        count = float(parse_bytes(memory))
    except (AttributeError, OverflowError, TypeError, ValueError):
        count = 0
    if not 0 < count < math.inf:
        raise UsageError(f"memory: {memory!r} is no number of bytes above 0; give a number, or a text such as '2GB'")
    return count


def _job(make: Callable[..., _Made], source: Any, client: Any, out: Union[str, PathLike], slabs: Optional[int],
         memory: Union[None, float, str], axes: str, spacing: Optional[Sequence[float]], origin: Optional[Sequence[float]],
         arguments: dict[str, Any]) -> _Made:  # fmt: skip
    workers = _check(client)
    limit = _bytes(memory, client)
    folder = Path(out).absolute() / ".slabs"
    folder.mkdir(parents=True, exist_ok=True)
    cluster = _Cluster(_image_of(source, folder, axes, spacing, origin), slabs or max(4, 2 * workers), limit, folder, client)
    try:
        result = make(cluster, **arguments)
    except BaseException:
        with suppress(OSError):
            folder.rmdir()  # where nothing was begun
        if cluster.failure is not None:
            raise cluster.failure from None
        raise
    shutil.rmtree(folder)
    return result


def lod(source: Any, *, client: Any, out: Union[str, PathLike], slabs: Optional[int] = None,
        memory: Union[None, float, str] = None, axes: str = "xyz", spacing: Optional[Sequence[float]] = None,
        origin: Optional[Sequence[float]] = None, **arguments: Any) -> Ladder:  # fmt: skip
    """isowave.lod() of an image, by the workers of a Dask cluster.

    source: a path that all workers see (whatever isowave.lod reads as an image), a pattern that names the files of one folder
        ("stack/*.tif"), or a dask array of three dimensions with ``axes``, ``spacing`` and ``origin`` as isowave.lod has them, which
        the workers write into ``out`` first, chunk by chunk.
    client: a dask.distributed.Client; every worker has this version of isowave.
    out: a folder that all workers see. Slabs lie in out/.slabs until the job is done. After an interruption the same call goes on
        from what is complete.
    slabs: along z; None: two for each worker. More slabs take less memory a worker and read more slices twice.
    memory: bytes, or a text such as "2GB", that a worker takes at most for a slab, with the program. A worker finds out once it knows
        the surface in its slab, before it takes them; then all slabs are made thinner. None: 80 % of the workers' own limit in Dask.
    arguments: those of isowave.lod().

    Raises as isowave.lod(), UsageError for workers of another version, OperationError for a cluster without workers, InputError where
    slabs of 8 slices would take more than ``memory``.
    """
    return _job(_lod, source, client, out, slabs, memory, axes, spacing, origin, {**arguments, "keep_field": False})


def analyse(source: Any, *, client: Any, out: Union[str, PathLike], slabs: Optional[int] = None,
            memory: Union[None, float, str] = None, axes: str = "xyz", spacing: Optional[Sequence[float]] = None,
            origin: Optional[Sequence[float]] = None, **arguments: Any) -> Pyramid:  # fmt: skip
    """isowave.analyse() of an image, by the workers of a Dask cluster; arguments as lod() of this module has them.

    All steps are made by the workers; this process puts the parts together.
    """
    return _job(_analyse, source, client, out, slabs, memory, axes, spacing, origin, arguments)
