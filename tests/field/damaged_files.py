#!/usr/bin/python3
"""What isowave makes of damaged copies of a file.

    damaged_files.py ISOWAVE FILE PREFIXES FLIPS COMMAND WORD...

Runs `isowave COMMAND WORD...`, {} in a word being the damaged file and @ a folder for results: for PREFIXES prefixes, spread evenly,
and FLIPS copies with one byte changed (the same ones in each run). Every run must end with code 0, or with 1 or 3 and one
line on standard error about the file; not by a signal, not with other lines, within 20 s and 1 GB. Prints how many were refused
and what each run that broke a rule did; exit code 1 where there is one.
"""
import os
import pathlib
import random
import resource
import subprocess
import sys
import tempfile
import time

MOST_BYTES = 1 << 30
MOST_SECONDS = 20


def run(words, folder):
    """(code, standard error, seconds, bytes of memory); the memory is that of the largest process"""
    start = time.time()
    with open(folder / "stderr", "wb") as talk:
        child = subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=talk)
    _, status, usage = os.wait4(child.pid, 0)
    child.returncode = os.waitstatus_to_exitcode(status)
    text = (folder / "stderr").read_text(errors="backslashreplace")
    return child.returncode, text, time.time() - start, usage.ru_maxrss * 1024


def complaint(code, text, seconds, memory, name):
    """What rule the run broke; None where it kept all"""
    lines = [line for line in text.splitlines() if line.strip()]
    if code not in (0, 1, 3):
        return f"code {code}"
    if code and len(lines) != 1:
        return f"code {code} and {len(lines)} lines"
    if code and name not in text:
        return "the line does not name the file"
    if seconds > MOST_SECONDS:
        return f"{seconds:.0f} s"
    return f"{memory >> 20} MB" if memory > MOST_BYTES else None


def damaged_copies(whole, prefixes, flips):
    for k in range(prefixes):
        length = len(whole) * k // prefixes
        yield f"the first {length} bytes", whole[:length]
    generator = random.Random(len(whole))
    for _ in range(flips):
        at, value = generator.randrange(len(whole)), generator.randrange(256)
        yield f"byte {at} = {value}", whole[:at] + bytes([value]) + whole[at + 1:]


def main(isowave, file, prefixes, flips, *words):
    whole = pathlib.Path(file).read_bytes()
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    broken, refused, runs, most = 0, 0, 0, 0
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        copy = folder / ("damaged" + "".join(pathlib.Path(file).suffixes))
        command = [isowave] + [w.replace("{}", str(copy)).replace("@", str(folder)) for w in words] + ["--quiet"]
        for what, content in damaged_copies(whole, int(prefixes), int(flips)):
            copy.write_bytes(content)
            result = run(command, folder)
            runs, refused, most = runs + 1, refused + (result[0] != 0), max(most, result[3])
            wrong = complaint(*result, copy.name)
            if wrong:
                broken += 1
                print(f"{what}: {wrong}: {result[1][:300]!r}", flush=True)
    print(f"{file}: {runs} damaged copies, {refused} refused, {broken} broke a rule, at most {most >> 20} MB")
    return 1 if broken else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
