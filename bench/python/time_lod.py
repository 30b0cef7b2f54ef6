#!/usr/bin/python3
"""What Python adds to the command: both make the same files in turn, each in a process of its own.

    bench/python/time_lod.py BUILD SOLID VOXELS [RUNS]      BUILD: build/release;  prints seconds (wall, processor) and peak memory
"""
import os
import subprocess
import sys
import tempfile
import time

CODE = "import sys, isowave; isowave.lod(sys.argv[1], voxels=int(sys.argv[2])).save(sys.argv[3])"


def timed(command, environment):
    start = time.monotonic()
    process = subprocess.Popen(command, env=environment, stdout=subprocess.DEVNULL)
    _, status, usage = os.wait4(process.pid, 0)
    assert status == 0, command
    return time.monotonic() - start, usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024


def main():
    build, solid, voxels = sys.argv[1:4]
    runs = int(sys.argv[4]) if len(sys.argv) > 4 else 3
    environment = dict(os.environ, PYTHONPATH=f"{build}/python")
    with tempfile.TemporaryDirectory() as folder:
        commands = {
            "command": [f"{build}/bin/isowave", "lod", solid, "--voxels", voxels, "--quiet", "-o", f"{folder}/command/x"],
            "Python": ["/usr/bin/python3", "-c", CODE, solid, voxels, f"{folder}/python/x"],
        }
        best = {}
        for _ in range(runs):
            for name, command in commands.items():
                best[name] = [min(pair) for pair in zip(best.get(name, [1e9] * 3), timed(command, environment))]
        for name, (wall, processor, memory) in best.items():
            print(f"{name:8} {wall:7.1f} s   {processor:7.1f} s of processors   {memory:7.0f} MB   (least of {runs})")
        print(f"Python adds {100 * (best['Python'][0] / best['command'][0] - 1):+.1f} % to the time, "
              f"{100 * (best['Python'][1] / best['command'][1] - 1):+.1f} % to the processors', "
              f"{100 * (best['Python'][2] / best['command'][2] - 1):+.1f} % to the memory")
        subprocess.run(["diff", "-rq", "-x", "report.json", f"{folder}/command", f"{folder}/python"], check=True)


if __name__ == "__main__":
    main()
