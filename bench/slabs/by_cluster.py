"""One run of isowave.distributed.analyse() with a scheduler and workers of its own, and what its processes took, as JSON:

    by_cluster.py MODULES IMAGE ISO WORKERS SLABS FOLDER OUT.vdb [MEMORY]

MEMORY: what a worker may take for a slab, "0.3GB".
"""
import json
import os
import pathlib
import resource
import sys
import time


def io_of(pid):
    """(bytes written, bytes read), by calls: what lies in the page cache counts, too."""
    values = dict(line.split(": ") for line in pathlib.Path(f"/proc/{pid}/io").read_text().splitlines())
    return int(values["wchar"]), int(values["rchar"])


def cpu_of(pid):
    fields = pathlib.Path(f"/proc/{pid}/stat").read_text().rsplit(") ", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def peak_of(pid):
    """GB."""
    lines = pathlib.Path(f"/proc/{pid}/status").read_text().splitlines()
    return next(int(line.split()[1]) for line in lines if line.startswith("VmHWM")) / 1e6


def main(modules, image, iso, workers, slabs, folder, out, memory=None):
    sys.path.insert(0, modules)
    import isowave.distributed
    from distributed import Client, LocalCluster

    with LocalCluster(n_workers=int(workers), threads_per_worker=1, processes=True, dashboard_address=None) as cluster:
        with Client(cluster) as client:
            pids = list(client.run(os.getpid).values())
            taken = lambda: [sum(values) for values in zip(*((cpu_of(pid), *io_of(pid)) for pid in pids))]  # noqa: E731
            before, begin, own = taken(), time.time(), cpu_of(os.getpid())
            isowave.distributed.analyse(image, iso=float(iso), client=client, out=folder, slabs=int(slabs), memory=memory).save(out)
            wall, after = time.time() - begin, taken()
            cpu, written, read = (a - b for a, b in zip(after, before))
            print(json.dumps(dict(wall=wall, cpu=cpu, own=cpu_of(os.getpid()) - own, written=written, read=read,
                                  worker=max(map(peak_of, pids)), peak=resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6)))


if __name__ == "__main__":
    main(*sys.argv[1:])
