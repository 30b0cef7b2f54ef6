"""Slabs by the workers of a Dask cluster: processes of their own, on this machine."""

import os
import signal
import threading
import time
from pathlib import Path

import dask.array
import numpy as np
import pytest
from distributed import Client, LocalCluster

import isowave
import isowave.distributed
from isowave import _native

SHAPE = (64, 56, 88)


def gyroid():
    x, y, z = np.meshgrid(*(0.3 * np.arange(n) for n in SHAPE), indexing="ij")
    g = np.sin(x) * np.cos(y) + np.sin(y) * np.cos(z) + np.sin(z) * np.cos(x)
    return np.round(200 * np.clip(0.6 - np.abs(g), -1, 1)).astype(np.int16)


@pytest.fixture(scope="module")
def image(tmp_path_factory):
    path = tmp_path_factory.mktemp("scan") / "gyroid.nrrd"
    header = "NRRD0004\ntype: int16\ndimension: 3\nsizes: %d %d %d\nspacings: 1 1 1\nendian: little\nencoding: raw\n\n" % SHAPE
    path.write_bytes(header.encode() + np.asfortranarray(gyroid()).tobytes(order="F"))
    return path


@pytest.fixture(scope="module")
def whole(image, tmp_path_factory):
    folder = tmp_path_factory.mktemp("whole")
    isowave.analyse(str(image), iso=0).save(folder / "p.vdb")
    return (folder / "p.vdb").read_bytes()


@pytest.fixture(scope="module")
def client():
    with LocalCluster(n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None) as cluster:
        with Client(cluster) as client:
            yield client


def saved(pyramid, folder):
    pyramid.save(folder / "p.vdb")
    return (folder / "p.vdb").read_bytes()


@pytest.mark.parametrize("slabs", [1, 3, 5])
def test_pyramids_are_those_of_one_process_to_the_byte(image, whole, client, tmp_path, slabs):
    out = tmp_path / "out"
    assert saved(isowave.distributed.analyse(image, iso=0, client=client, out=out, slabs=slabs), tmp_path) == whole
    assert list(out.iterdir()) == []


def test_levels_and_reports_are_those_of_one_process(image, client, tmp_path):
    shares = []
    ladder = isowave.distributed.lod(image, iso=0, levels=(0, 2), client=client, out=tmp_path, slabs=4,
                                     progress=lambda share, stage: shares.append(stage))  # fmt: skip
    direct = isowave.lod(str(image), iso=0, levels=(0, 2))
    assert len(ladder) == len(direct) == 3
    for ours, theirs in zip(ladder, direct):
        assert (ours.points == theirs.points).all() and (ours.triangles == theirs.triangles).all()
        assert ours.report["parts"] == theirs.report["parts"] and ours.report["rms_to_level0"] == theirs.report["rms_to_level0"]
    assert "slabs" in shares


@pytest.mark.parametrize("axes", ["xyz", "zyx"])
def test_dask_arrays_lie_where_arguments_say(client, tmp_path, axes):
    voxels = gyroid()
    array = dask.array.from_array(voxels if axes == "xyz" else voxels.T, chunks=32)
    place = dict(axes=axes, spacing=(0.5, 0.5, 0.75), origin=(3, -2, 8))
    ladder = isowave.distributed.lod(array, iso=0, levels=1, client=client, out=tmp_path, slabs=3, **place)
    direct = isowave.lod(np.ascontiguousarray(voxels if axes == "xyz" else voxels.T), iso=0, levels=1, **place)
    np.testing.assert_allclose(ladder[0].points, direct[0].points, rtol=0, atol=1e-9)
    assert (ladder[0].triangles == direct[0].triangles).all()


def test_another_array_in_the_same_place_is_not_taken_for_the_first(client, tmp_path):
    first, second = gyroid(), gyroid()[::-1].copy()
    job = dict(client=client, out=tmp_path, slabs=3, spacing=(1, 1, 1))

    class Enough(Exception):
        pass

    def stop(share, stage):
        raise Enough

    with pytest.raises(Enough):
        isowave.distributed.analyse(dask.array.from_array(first, chunks=48), iso=0, progress=stop, **job)
    ladder = isowave.distributed.lod(dask.array.from_array(second, chunks=48), iso=0, levels=2, hold="none", **job)
    direct = isowave.lod(second, iso=0, levels=2, hold="none", spacing=(1, 1, 1))
    assert (ladder[0].points == direct[0].points).all()


def test_a_worker_that_is_killed_changes_nothing(image, whole, tmp_path):
    out = tmp_path / "out"
    for phase in ("fit_", "step_0_", "field_"):  # what lies there when it is killed
        killed = []

        def kill_when_it_is_there(pids, phase=phase, killed=killed):
            while not killed:
                if any(name.startswith(phase) for name in (os.listdir(out / ".slabs") if (out / ".slabs").exists() else [])):
                    os.kill(pids[0], signal.SIGKILL)
                    killed.append(pids[0])
                time.sleep(0.002)

        with LocalCluster(n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None) as cluster, Client(cluster) as client:
            pids = list(client.run(os.getpid).values())
            thread = threading.Thread(target=kill_when_it_is_there, args=(pids,), daemon=True)
            thread.start()
            pyramid = isowave.distributed.analyse(image, iso=0, client=client, out=out, slabs=6)
            thread.join(30)
        assert killed, phase
        assert saved(pyramid, tmp_path) == whole, phase
        assert list(out.iterdir()) == []


def test_a_job_that_was_stopped_goes_on_from_what_is_complete(image, whole, client, tmp_path):
    class Enough(Exception):
        pass

    out = tmp_path / "out"

    def stop(share, stage):
        if (out / ".slabs").exists() and any(n.startswith("told_") for n in os.listdir(out / ".slabs")):
            raise Enough

    with pytest.raises(Enough):
        isowave.distributed.analyse(image, iso=0, client=client, out=out, slabs=6, progress=stop)
    told = {path: path.stat().st_mtime_ns for path in (out / ".slabs").glob("told_*")}
    assert told
    kept = {}

    def look(share, stage):
        kept.update({path: path.stat().st_mtime_ns for path in told if path.exists()})

    again = isowave.distributed.analyse(image, iso=0, client=client, out=out, slabs=6, progress=look)
    assert saved(again, tmp_path) == whole
    assert kept == told


def test_slabs_are_made_thinner_until_a_worker_has_the_memory(client, tmp_path, monkeypatch):
    x, y, z = np.meshgrid(*(np.arange(n, dtype=np.float32) for n in (40, 40, 400)), indexing="ij")
    rod = np.round(20 * np.clip(15 - np.hypot(x - 19.3, y - 20.2), -4, 4) + 0 * z).astype(np.int16)
    array = dask.array.from_array(rod, chunks=(40, 40, 100))
    asked = []
    gathered = isowave.distributed._Cluster._gathered
    monkeypatch.setattr(isowave.distributed._Cluster, "_gathered",
                        lambda self, options, tasks, report: asked.append(len(tasks)) or gathered(self, options, tasks, report))  # fmt: skip
    job = dict(iso=0, client=client, slabs=2)
    whole = saved(isowave.distributed.analyse(array, out=tmp_path / "out", memory="1GB", **job), tmp_path)
    assert asked[0] == 2 and len(set(asked)) <= 2
    asked.clear()
    assert saved(isowave.distributed.analyse(array, out=tmp_path / "out", memory=133e6, **job), tmp_path) == whole
    assert asked[0] == 2 and asked[1] > 2
    with pytest.raises(isowave.InputError, match="slabs are 8 slices thick as they are"):
        isowave.distributed.analyse(array, out=tmp_path / "out", memory=130.1e6, **job)
    with pytest.raises(isowave.UsageError, match="the program alone takes 130 MB"):
        isowave.distributed.analyse(array, out=tmp_path / "out", memory="1MB", **job)
    for wrong in ("much", 0, -1, float("nan"), [1]):
        with pytest.raises(isowave.UsageError, match="is no number of bytes above 0"):
            isowave.distributed.analyse(array, out=tmp_path / "out", memory=wrong, **job)


def test_masks_are_those_of_one_process(client, tmp_path):
    x, y, z = np.meshgrid(*(np.arange(n) for n in (20, 24, 90)), indexing="ij")
    mask = (np.hypot(x - 9.4, y - 12) < 6 + np.sin(0.2 * z)).astype(np.uint8)
    path = tmp_path / "mask.npy"
    np.save(path, mask)
    ladder = isowave.distributed.lod(path, levels=(0, 1), client=client, out=tmp_path / "out", slabs=3)
    for ours, theirs in zip(ladder, isowave.lod(str(path), levels=(0, 1))):
        assert (ours.points == theirs.points).all() and ours.report["parts"] == theirs.report["parts"]


def test_what_cannot_work_is_said(image, client, tmp_path):
    job = dict(client=client, out=tmp_path / "out", slabs=2)
    with pytest.raises(isowave.InputError, match="no such file"):
        isowave.distributed.lod(tmp_path / "nothing.nrrd", iso=0, **job)
    with pytest.raises(isowave.UsageError, match="--iso is missing"):
        isowave.distributed.lod(image, **job)
    with pytest.raises(isowave.UsageError, match="expected a path or a dask array"):
        isowave.distributed.lod(np.zeros((4, 4, 4)), iso=0, **job)
    with pytest.raises(isowave.UsageError, match="belong to a dask array"):
        isowave.distributed.lod(image, iso=0, spacing=(1, 1, 1), **job)
    with LocalCluster(n_workers=0, dashboard_address=None) as cluster, Client(cluster) as nobody:
        with pytest.raises(isowave.OperationError, match="has no workers"):
            isowave.distributed.lod(image, iso=0, client=nobody, out=tmp_path / "out", slabs=2)


def test_a_file_that_goes_away_half_way_ends_the_job(tmp_path, image, client):
    copy = tmp_path / "copy.nrrd"
    copy.write_bytes(Path(image).read_bytes())
    seen = []

    def remove(share, stage):
        seen.append(stage)
        if stage == "fitting" or stage == "slabs":
            copy.unlink(missing_ok=True)

    copy_path = str(copy)
    with pytest.raises((isowave.InputError, isowave.OperationError)):
        # Many slabs: the last ones are still to be read when the file has gone.
        isowave.distributed.analyse(copy_path, iso=0, client=client, out=tmp_path / "out", slabs=10, progress=remove)
    with pytest.raises(isowave.InputError, match="no such file"):
        _native.open_file(copy_path, [], 0, None)
