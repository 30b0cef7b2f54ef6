#!/usr/bin/python3
"""Runs the commands of docs/quickstart.md and docs/recipes/*.md, and compares what they print with what is shown.

    tests/docs/run_quickstart.py ISOWAVE [PAGE ...]          fails (1) where a command fails or prints something else
    tests/docs/run_quickstart.py ISOWAVE --write [PAGE ...]  puts what they print into the pages
    tests/docs/run_quickstart.py --self-test                 proves that a wrong page is found

A page marks a block by a comment on the line before it:

    <!-- run -->                    ```sh       run by bash -eu, in a temporary folder with `tests`, `scripts` and
                                                `examples` of the sources and `isowave` in the PATH; all blocks of a page in one folder
    <!-- run: needs numpy PIL -->   ```sh       the same, left out (and said so) where python has not these modules
    <!-- output -->                 ```text     standard output of the block before, to the last line
    <!-- output: part -->           ```text     the lines shown come in this order; others may lie between
    <!-- output: columns A, B -->   ```text     of its table, the columns with these heads

Blanks are compared as one blank. Standard library only.
"""
import argparse
import importlib.util
import os
import pathlib
import re
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
BLOCK = re.compile(r"^<!-- (run|output)(?:: ([^\n]*?))? -->\n```(\w*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)


# ---- what is shown beside a command -------------------------------------------------------------------------------

def squeezed(text):
    """The lines, each run of blanks as one blank, without empty lines."""
    return [" ".join(line.split()) for line in text.splitlines() if line.strip()]


def cells(line):
    return re.split(r" {2,}", line.strip())


def columns_of(text, heads):
    """The rows of the first table in `text` that has all `heads`, as [head row, row ...]; cells by their right edge,
    because a table of isowave is aligned to the right and a cell may be empty."""
    lines = text.splitlines()
    for at, line in enumerate(lines):
        if not set(heads) <= set(cells(line)):
            continue
        spans = [(m.start(), m.end(), m.group()) for m in re.finditer(r"\S+(?: \S+)*", line)]
        rows = [list(heads)]
        for row in lines[at + 1:]:
            found = [(m.start(), m.end(), m.group()) for m in re.finditer(r"\S+(?: \S+)*", row)]
            values = {}
            for start, end, value in found:
                for left, right, head in spans:
                    if end == right or start == left:
                        values[head] = value
            if len(found) < 2 or not set(heads) & set(values):
                break
            rows.append([values.get(head, "") for head in heads])
        return rows
    raise ValueError(f"no table with the columns {', '.join(heads)} is printed")


def table(rows):
    widths = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))]
    return "".join("  ".join([row[0].ljust(widths[0])] + [c.rjust(w) for c, w in zip(row[1:], widths[1:])]).rstrip()
                   + "\n" for row in rows)


def heads_in(option):
    return [head.strip() for head in option[len("columns"):].split(",")]


def complaint(option, shown, printed):
    """"" or what is wrong with `shown`, given what the command printed."""
    if option.startswith("columns"):
        expected, found = squeezed(table(columns_of(printed, heads_in(option)))), squeezed(shown)
    else:
        expected, found = squeezed(printed), squeezed(shown)
    if option == "part":
        if not found:
            return "the block is empty"
        rest = iter(expected)
        missing = [line for line in found if line not in rest]
        return f"this line is not printed (or not in this order):\n  {missing[0]}" if missing else ""
    if expected == found:
        return ""
    for a, b in zip(found + ["(nothing)"], expected + ["(nothing)"]):
        if a != b:
            return f"shown:   {a}\nprinted: {b}"
    return f"{len(found)} lines are shown, {len(expected)} are printed"


def rewritten(option, shown, printed):
    if option.startswith("columns"):
        return table(columns_of(printed, heads_in(option)))
    if option == "part":  # only an author knows which lines matter
        return shown
    return "".join(line.rstrip() + "\n" for line in printed.splitlines())


# ---- a page -------------------------------------------------------------------------------------------------------

def python_module(isowave):
    """Where the build that `isowave` is of has the Python module."""
    return pathlib.Path(isowave).resolve().parent.parent / "python"


def missing_modules(option, isowave):
    names = option.split()[1:] if option.startswith("needs") else []
    built = any(python_module(isowave).glob("isowave/_native*.so"))
    return [name for name in names if not (built if name == "isowave" else importlib.util.find_spec(name))]


def run_block(script, folder, isowave):
    (folder / "bin").mkdir(exist_ok=True)
    link = folder / "bin/isowave"
    if not link.exists():
        link.symlink_to(isowave)
        for shared in ("tests", "scripts", "examples"):
            (folder / shared).symlink_to(ROOT / shared)
    environment = dict(os.environ, PATH=f"{folder / 'bin'}:{os.environ['PATH']}", LC_ALL="C.UTF-8",
                       PYTHONPATH=str(python_module(isowave)))
    return subprocess.run(["bash", "-euo", "pipefail", "-c", script], cwd=folder, env=environment, text=True,
                          stdout=subprocess.PIPE, stderr=subprocess.PIPE, check=False)


def check_page(name, text, isowave):
    """(text with what is printed, complaints, how many blocks ran)."""
    complaints, ran, printed = [], 0, None
    with tempfile.TemporaryDirectory(prefix="isowave-docs-") as folder:
        def visit(block):
            nonlocal printed, ran
            kind, option, _, body = block.groups()
            option = option or ""
            place = f"{name}:{text.count(chr(10), 0, block.start()) + 1}"
            if kind == "run":
                lacking = missing_modules(option, isowave)
                if lacking:
                    print(f"{place}: left out, python has no {' '.join(lacking)}")
                    printed = None
                    return block.group()
                done = run_block(body, pathlib.Path(folder), isowave)
                ran += 1
                printed = done.stdout
                if done.returncode != 0:
                    complaints.append(f"{place}: exit code {done.returncode}\n{body}{done.stderr}")
                    printed = None
            elif printed is not None:
                try:
                    what = complaint(option, body, printed)
                    if what:
                        complaints.append(f"{place}: {what}")
                    head = block.group()[:block.start(4) - block.start()]
                    return head + rewritten(option, body, printed) + "```"
                except ValueError as problem:
                    complaints.append(f"{place}: {problem}")
            return block.group()
        new = BLOCK.sub(visit, text)
    return new, complaints, ran


def check_pages(pages, isowave, write):
    failed = False
    for page in pages:
        text = page.read_text()
        new, complaints, ran = check_page(page.relative_to(ROOT), text, isowave)
        if write and new != text:
            page.write_text(new)
        for what in complaints:
            print(what, file=sys.stderr)
        failed = failed or bool(complaints and not write)
        print(f"{page.relative_to(ROOT)}: {ran} blocks")
    return 1 if failed else 0


def self_test():
    """A right page passes, and each kind of wrong page is found."""
    block = "<!-- run -->\n```sh\nprintf 'name  a  b\\n   x  1  2\\nend\\n'\n```\n"

    def found(option, shown):
        page = f"{block}<!-- output{option} -->\n```text\n{shown}```\n"
        return bool(check_page("self-test", page, "/bin/true")[1])
    assert not found("", "name a b\nx 1 2\nend\n")
    assert found("", "name a b\nx 1 3\nend\n")
    assert found("", "name a b\nx 1 2\n")
    assert not found(": part", "name a b\nend\n")
    assert found(": part", "end\nname a b\n")
    assert found(": part", "")
    assert not found(": columns name, b", "name  b\nx     2\n")
    assert found(": columns name, b", "name  b\nx     1\n")
    assert found(": columns name, c", "name  c\nx     1\n")
    assert check_page("self-test", "<!-- run -->\n```sh\nfalse\n```\n", "/bin/true")[1]
    assert check_page("self-test", "<!-- run -->\n```sh\ncat none | sort\n```\n", "/bin/true")[1]
    print("self-test: a wrong page is found")
    return 0


def main():
    parser = argparse.ArgumentParser(description="Runs the commands of the quickstart and the recipes.")
    parser.add_argument("isowave", nargs="?", help="the program")
    parser.add_argument("pages", nargs="*", type=pathlib.Path)
    parser.add_argument("--write", action="store_true", help="put what the commands print into the pages")
    parser.add_argument("--self-test", action="store_true", help="prove that a wrong page is found")
    options = parser.parse_intermixed_args()
    if options.self_test:
        return self_test()
    if not options.isowave:
        parser.error("name the program: build/release/bin/isowave")
    pages = [page.resolve() for page in options.pages] or [ROOT / "docs/quickstart.md",
                                                          *sorted((ROOT / "docs/recipes").glob("*.md"))]
    return check_pages(pages, pathlib.Path(options.isowave).resolve(), options.write)


if __name__ == "__main__":
    sys.exit(main())
