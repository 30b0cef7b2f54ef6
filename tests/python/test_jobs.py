"""Long work: progress, Ctrl-C, the GIL, threads."""

import os
import signal
import threading
import time

import numpy as np
import pytest
from conftest import GEAR

import isowave


def test_progress_tells_stages_and_shares_on_the_thread_that_called():
    calls = []
    isowave.lod(GEAR, voxels=64, levels=0, progress=lambda share, stage: calls.append((share, stage, threading.get_ident())))
    assert len({stage for _, stage, _ in calls}) >= 2
    assert all(0 <= share <= 1 for share, _, _ in calls)
    assert {thread for _, _, thread in calls} == {threading.get_ident()}


def test_what_a_callback_raises_ends_the_work_and_comes_out():
    class Enough(Exception):
        pass

    def stop(share, stage):
        raise Enough(stage)

    start = time.time()
    with pytest.raises(Enough):
        isowave.lod(GEAR, voxels=256, progress=stop)
    assert time.time() - start < 20


class Bar:
    """What isowave asks a bar of tqdm for."""

    total = 100
    n = 0

    def __init__(self):
        self.seen = []

    def set_description(self, text, refresh=True):
        self.text = text

    def refresh(self):
        self.seen.append((self.text, self.n))


def test_a_bar_of_tqdm_moves():
    bar = Bar()
    isowave.lod(GEAR, voxels=64, levels=0, progress=bar)
    assert bar.seen and all(0 <= n <= 100 for _, n in bar.seen)
    with pytest.raises(isowave.UsageError, match="progress"):
        isowave.lod(GEAR, progress=3)


def test_tqdm_itself():
    tqdm = pytest.importorskip("tqdm")
    with open(os.devnull, "w") as nowhere, tqdm.tqdm(total=100, file=nowhere) as bar:
        isowave.lod(GEAR, voxels=64, levels=0, progress=bar)
        assert bar.desc and 0 < bar.n <= 100


def test_ctrl_c_ends_with_keyboard_interrupt_and_leaves_no_file(tmp_path):
    timer = threading.Timer(1.0, os.kill, (os.getpid(), signal.SIGINT))
    timer.start()
    start = time.time()
    with pytest.raises(KeyboardInterrupt):
        isowave.lod(GEAR, voxels=700).save(tmp_path / "out")
    assert time.time() - start < 30  # alone it takes minutes
    assert list(tmp_path.iterdir()) == []


def test_other_threads_run_meanwhile():
    ticks, done = [], threading.Event()

    def tick():
        while not done.is_set():
            ticks.append(time.time())
            time.sleep(0.01)

    clock = threading.Thread(target=tick)
    clock.start()
    isowave.lod(GEAR, voxels=96, levels=0)
    done.set()
    clock.join()
    assert max(np.diff(ticks)) < 1  # seen 0.06: the machine's own; with the GIL held it would be the whole job


def test_work_runs_on_several_threads_of_python_at_once():
    results = {}

    def work(n):
        results[n] = isowave.lod(GEAR, voxels=48, levels=0)[0].report["volume"]

    workers = [threading.Thread(target=work, args=(n,)) for n in range(4)]
    for worker in workers:
        worker.start()
    for worker in workers:
        worker.join()
    assert len(set(results.values())) == 1 and len(results) == 4


def test_the_result_does_not_depend_on_threads_to_the_bit():
    one, two = (isowave.lod(GEAR, voxels=48, threads=n) for n in (1, 2))
    assert one.report["threads"] == 1
    for a, b in zip(one, two):
        assert np.array_equal(a.points, b.points) and np.array_equal(a.triangles, b.triangles)


def test_remarks_are_kept_and_logged(caplog):
    with caplog.at_level("INFO", "isowave"):
        ladder = isowave.lod(GEAR, voxels=48, levels=0)
    assert ladder.remarks and [record.getMessage() for record in caplog.records] == ladder.remarks
