#!/usr/bin/env python3
"""Records what the program does, so that a change of its sources can be shown to change nothing.

    snapshot.py record BINARY OUT.json [--jobs 2] [--keep DIR] [--data FOLDER] [--threads N] [--only TEXT]
    snapshot.py compare BEFORE.json AFTER.json

The cases stand in cases.txt, the inputs that are not in tests/data are made by inputs.py; README.md says the rest.
"""
import argparse
import concurrent.futures
import difflib
import gzip
import hashlib
import json
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import time

sys.dont_write_bytecode = True  # no __pycache__ in the sources
import inputs  # noqa: E402

HERE = pathlib.Path(__file__).resolve().parent
MOST_TEXT = 200_000  # bytes; longer texts are recorded by their hash alone
MOST_SECONDS = 1200  # for one case; then it is killed and "timeout" is its exit code
MOST_LINES = 12      # of a difference that are shown
TAKES_THREADS = "lod analyse mesh field info check compare curves".split()
PLACES = ("in/", "from/", "data/", "half/", "flip/", "bent/")


# ---- the table ----

class Case:
    """One row of cases.txt: a name and a command line."""

    def __init__(self, name, command):
        self.name, self.command = name, command
        self.arguments = shlex.split(command)
        self.sources = [a for a in self.arguments if a.startswith(PLACES)]
        # Earlier cases whose outputs this one reads.
        self.needs = {s.split("from/", 1)[1].split("/")[0] for s in self.sources if "from/" in s}
        self.needs_data = any("data/" in s for s in self.sources)


def read_cases(path):
    cases = {}
    for line in path.read_text().splitlines():
        if not line.strip() or line.startswith("#"):
            continue
        name, _, command = line.partition(" ")
        case = Case(name, command.strip())
        assert name not in cases, f"{path}: two cases are called {name}"
        assert case.needs <= cases.keys(), f"{path}: {name} reads {case.needs - cases.keys()}, which stands below it"
        cases[name] = case
    return cases


# ---- inputs of a case ----

class Missing(Exception):
    """An optional input that is not there."""


def half(content):
    return content[: len(content) // 2]


def flip(content):
    middle = len(content) // 2
    return content[:middle] + bytes([content[middle] ^ 0x10]) + content[middle + 1:]


def bent(content):
    """An OBJ whose vertices are moved: z grows by x / 4."""
    def move(line):
        word = line.split()
        if word[:1] != ["v"]:
            return line
        x, y, z = map(float, word[1:4])
        return f"v {x!r} {y!r} {z + x / 4!r}"
    return "\n".join(map(move, content.decode().split("\n"))).encode()


class Store:
    """Puts the inputs of a case into its folder, under the relative paths that its command line names."""

    def __init__(self, made, outputs, data):
        self.made, self.outputs, self.data = made, outputs, data

    def original(self, source):
        place, rest = source.split("/", 1)
        if place == "data":
            if not self.data:
                raise Missing(source)
            return self.data / rest
        return (self.made if place == "in" else self.outputs) / rest

    def put(self, source, folder):
        target = folder / source
        place, rest = source.split("/", 1)
        if target.exists():
            return
        if place in ("half", "flip", "bent"):
            target.parent.mkdir(parents=True, exist_ok=True)
            change = {"half": half, "flip": flip, "bent": bent}[place]
            target.write_bytes(change(self.original(rest).read_bytes()))
            return
        original = self.original(source)
        if original.parent.is_file():  # the case is about a file where a folder should be
            return self.put(source.rsplit("/", 1)[0], folder)
        packed = original.with_name(original.name + ".gz")
        if original.suffix in (".nhdr", ".mhd"):  # the voxels are in another file
            shutil.copytree(original.parent, target.parent, dirs_exist_ok=True)
        elif original.is_dir():
            shutil.copytree(original, target)
        elif original.exists():
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(original, target)
        elif packed.exists():
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_bytes(gzip.decompress(packed.read_bytes()))
        elif place == "data":
            raise Missing(source)
        # else: the case is about a file that is not there


# ---- normalization: what may differ between two runs of one binary ----

NUMBER = r"-?[0-9][0-9.eE+-]*"
VARYING = re.compile(rf'("(?:seconds|peak_memory_bytes|threads)": ){NUMBER}')
STAGES = re.compile(r'("seconds": \{)([^}]*)\}')


def normal_text(text, folder):
    text = text.replace(str(folder), "CASE")
    text = VARYING.sub(r"\1*", text)
    return STAGES.sub(lambda m: m[1] + re.sub(rf"(: ){NUMBER}", r"\1*", m[2]) + "}", text)


def as_text(content):
    """None for binary content."""
    if b"\0" in content:
        return None
    try:
        return content.decode()
    except UnicodeDecodeError:
        return None


def entry(content, folder):
    """What is recorded of a file or a stream."""
    text = as_text(content)
    if text is not None:
        text = normal_text(text, folder)
        content = text.encode()
    result = {"size": len(content), "sha256": hashlib.sha256(content).hexdigest()}
    if text is not None and len(content) < MOST_TEXT:
        result["text"] = text
    return result


# ---- recording ----

def listing(folder):
    """Files and empty folders below `folder`, with relative names."""
    result = []
    for place, folders, files in os.walk(folder):
        where = pathlib.Path(place).relative_to(folder)
        result += [str(where / name) for name in files]
        if not folders and not files and place != str(folder):
            result.append(str(where) + "/")
    return sorted(result)


def hashes(folder):
    return {name: hashlib.sha256((folder / name).read_bytes()).hexdigest()
            for name in listing(folder) if not name.endswith("/")}


def run_case(binary, case, store, threads):
    folder = store.outputs / case.name
    folder.mkdir(parents=True)
    for source in case.sources:
        store.put(source, folder)
    given = hashes(folder)
    arguments = list(case.arguments)
    if threads and arguments and arguments[0] in TAKES_THREADS and "--threads" not in arguments \
            and not case.name.startswith("bad-"):
        arguments += ["--threads", str(threads)]
    environment = {"PATH": "/usr/bin:/bin", "LC_ALL": "C.UTF-8", "HOME": str(folder)}
    start = time.monotonic()
    try:
        done = subprocess.run([binary, *arguments], cwd=folder, env=environment, stdin=subprocess.DEVNULL,
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=MOST_SECONDS)
        code, out, err = done.returncode, done.stdout, done.stderr
    except subprocess.TimeoutExpired as stopped:
        code, out, err = "timeout", stopped.stdout or b"", stopped.stderr or b""
    seconds = time.monotonic() - start
    files, left = {}, listing(folder)
    for name in left:
        if name.endswith("/"):
            files[name] = {}
            continue
        content = (folder / name).read_bytes()
        if given.get(name) != hashlib.sha256(content).hexdigest():
            files[name] = entry(content, folder)
    record = {"command": case.command, "exit": code, "stdout": entry(out, folder), "stderr": entry(err, folder),
              "files": files}
    gone = sorted(set(given) - set(left))
    if gone:
        record["inputs_gone"] = gone
    return record, seconds


def wanted_cases(cases, store, only):
    """Those asked for with --only and what they need, without those whose data are missing."""
    chosen, skipped = {}, []
    for case in reversed(cases.values()):
        if only and only not in case.name and not any(case.name in c.needs for c in chosen.values()):
            continue
        if case.needs_data:
            path = [store.original(s) for s in case.sources if s.startswith("data/")] if store.data else []
            if not path or not all(p.exists() or p.with_name(p.name + ".gz").exists() for p in path):
                skipped.append(case.name)
                continue
        chosen[case.name] = case
    chosen = dict(reversed(chosen.items()))
    for case in list(chosen.values()):  # what reads the outputs of a skipped case is skipped too
        if not case.needs <= chosen.keys():
            skipped.append(case.name)
            del chosen[case.name]
    return chosen, skipped


def record(options):
    binary = str(pathlib.Path(options.binary).resolve())
    cases = read_cases(HERE / "cases.txt")
    work = pathlib.Path(tempfile.mkdtemp(prefix="snapshot-")).resolve()
    if options.keep:
        work = pathlib.Path(options.keep).resolve()
        if work.exists() and any(work.iterdir()):
            sys.exit(f"{work}: is not empty; --keep wants a new folder")
    results, seconds, running = {}, {}, {}
    start = time.monotonic()
    try:
        inputs.make(work / "inputs", HERE.parent / "data")
        store = Store(work / "inputs", work / "cases", options.data and pathlib.Path(options.data).resolve())
        chosen, skipped = wanted_cases(cases, store, options.only)
        waiting = list(chosen.values())
        with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
            while waiting or running:
                for case in [c for c in waiting if c.needs <= results.keys()]:
                    waiting.remove(case)
                    running[pool.submit(run_case, binary, case, store, options.threads)] = case.name
                done, _ = concurrent.futures.wait(running, return_when=concurrent.futures.FIRST_COMPLETED)
                for future in done:
                    name = running.pop(future)
                    results[name], seconds[name] = future.result()
    finally:
        if not options.keep:
            shutil.rmtree(work, ignore_errors=True)
    content = {"format": 1, "cases": {name: results[name] for name in chosen}}
    pathlib.Path(options.out).write_text(json.dumps(content, indent=1, ensure_ascii=False) + "\n")
    slowest = sorted(seconds, key=seconds.get, reverse=True)[:5]
    print(f"{len(results)} cases in {time.monotonic() - start:.0f} s, {len(skipped)} skipped; the slowest: "
          + ", ".join(f"{name} {seconds[name]:.1f} s" for name in slowest))
    stuck = [name for name in chosen if results[name]["exit"] == "timeout"]
    if stuck:
        print("did not end:", ", ".join(stuck))
    return 0


# ---- comparing ----

def shown(before, after):
    """The first lines that differ."""
    lines = [line for line in difflib.unified_diff(before.splitlines(), after.splitlines(), "before", "after",
                                                   n=0, lineterm="")][2:]
    for line in lines[:MOST_LINES]:
        print("      " + line[:200])
    if len(lines) > MOST_LINES:
        print(f"      ... and {len(lines) - MOST_LINES} lines more")


def compare_entries(what, before, after):
    if before == after:
        return
    print(f"    {what}: {before.get('size')} bytes before, {after.get('size')} bytes after")
    if "text" in before and "text" in after:
        shown(before["text"], after["text"])


def compare_cases(name, before, after):
    """Prints what differs; says whether anything does."""
    if before == after:
        return False
    print(f"  {name}: isowave {before['command']}")
    if before["command"] != after["command"]:
        print(f"    command after: isowave {after['command']}")
    if before["exit"] != after["exit"]:
        print(f"    exit code: {before['exit']} before, {after['exit']} after")
    for stream in "stdout", "stderr":
        compare_entries(stream, before[stream], after[stream])
    for file in sorted({*before["files"], *after["files"]}):
        if file not in after["files"]:
            print(f"    {file}: is not written any more")
        elif file not in before["files"]:
            print(f"    {file}: is new")
        else:
            compare_entries(file, before["files"][file], after["files"][file])
    if before.get("inputs_gone") != after.get("inputs_gone"):
        print(f"    inputs that are gone: {before.get('inputs_gone')} before, {after.get('inputs_gone')} after")
    return True


def compare(options):
    before, after = (json.loads(pathlib.Path(p).read_text())["cases"] for p in (options.before, options.after))
    lone = [f"  {name}: only in {options.before}" for name in before if name not in after]
    lone += [f"  {name}: only in {options.after}" for name in after if name not in before]
    both = [name for name in before if name in after]
    different = sum(compare_cases(name, before[name], after[name]) for name in both)
    if lone:
        print("\n".join(lone))
    print(f"{len(both)} cases in both, {different} differ, {len(lone)} in one only")
    return 1 if different or lone else 0


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(required=True)
    one = commands.add_parser("record")
    one.add_argument("binary")
    one.add_argument("out")
    one.add_argument("--jobs", type=int, default=2, help="cases at a time")
    one.add_argument("--keep", metavar="DIR", help="leave inputs and outputs in this new folder")
    one.add_argument("--data", metavar="FOLDER", help="run the cases with larger inputs too (shared/data)")
    one.add_argument("--threads", type=int, metavar="N", help="given to every subcommand that takes --threads")
    one.add_argument("--only", metavar="TEXT", help="only cases with this in their name, and what they read")
    one.set_defaults(run=record)
    two = commands.add_parser("compare")
    two.add_argument("before")
    two.add_argument("after")
    two.set_defaults(run=compare)
    options = parser.parse_args()
    return options.run(options)


if __name__ == "__main__":
    sys.exit(main())
