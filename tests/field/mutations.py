#!/usr/bin/python3
"""Edits of one line, each of which a test must catch: in the interval algebra, the table of cells, the solver of constraints and
what keeps levels whole.

    mutations.py BUILD [WORD]

BUILD is a configured build folder. Each edit (those whose file or text holds WORD) is made in the sources, the test program that
is named beside it is built and run, and the source is put back, also after Ctrl-C. Prints `caught` (a test failed, or it does not
compile) or `SURVIVED`; ends with 1 where one survived. An edit that no input can tell from the original has no place here.
"""
import pathlib
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
MOST_SECONDS = 600
INTERVAL = ("wavelets_interval_tests", "*")
TABLE = ("polygonize_tests", "CellTable*:Guarantee*:Polygonize*:RandomSigns*")
ASCENT = ("volume_tests", "RowAscent*")
HOLD = ("hold_tests", "LevelHold*:Hold*")

# (tests, file, from, to)
EDITS = [
    (INTERVAL, "wavelets/interval/interval.cpp", "y[kFirstFineRow - 1] = left;", "y[kFirstFineRow - 1] = 2 * left;"),
    (INTERVAL, "wavelets/interval/interval.cpp", "y[kLeftRow] = left;", "y[kLeftRow] = 0 * left;"),
    (INTERVAL, "wavelets/interval/interval.cpp", "detail[k] = y[kFirstDetailRow + 2 * k];",
     "detail[k] = y[kFirstDetailRow + 2 * (n - 1 - k)];"),
    (INTERVAL, "wavelets/interval/runs.cpp", "run.first : run.first - 1", "run.first : run.first + 1"),
    (INTERVAL, "wavelets/interval/runs.cpp", "run.last : run.last + 1", "run.last : run.last - 1"),
    (INTERVAL, "wavelets/interval/runs.cpp", "<= kJoin", "< kJoin"),
    (INTERVAL, "wavelets/interval/tables.cpp", "(m(i, j) + m(i, last - j)) / 2", "(m(i, j) + m(i, last - j))"),
    (INTERVAL, "wavelets/interval/tables.cpp", "(m(i, j) - m(i, last - j)) / 2", "(m(i, j) + m(i, last - j)) / 2"),
    (INTERVAL, "wavelets/interval/tables.cpp", "j == n + 2 ? m(i, j)", "j == n + 1 ? m(i, j)"),
    (INTERVAL, "wavelets/interval/tables.cpp", "return i > n ? 0", "return i > n - 1 ? 0"),
    (INTERVAL, "wavelets/interval/tables.cpp", "t(i, j) -= multiplier * t(k, j)", "t(i, j) += multiplier * t(k, j)"),
    (INTERVAL, "wavelets/interval/tables.cpp", "t(i, i - s) * t(i - s, i - s) / pivot", "t(i, i - s) / pivot"),
    (INTERVAL, "wavelets/interval/tables.cpp", "t(i, i + s) / pivot", "t(i, i + s)"),
    (INTERVAL, "wavelets/interval/tables.cpp", "static_cast<double>(1 / pivot)", "static_cast<double>(pivot)"),
    (INTERVAL, "wavelets/interval/tables.cpp", "synthesisMap(n).cwiseAbs()", "synthesisMap(n)"),
    (INTERVAL, "wavelets/interval/matrices.cpp", "{129, 1188, 933, 60}", "{129, 1188, 932, 60}"),
    (INTERVAL, "wavelets/interval/matrices.cpp", "{1, -124, 1677,", "{1, -124, 1678,"),
    (INTERVAL, "wavelets/interval/matrices.cpp", "{1, 4, 6, 4, 1}", "{1, 4, 7, 4, 1}"),
    (INTERVAL, "wavelets/interval/matrices.cpp", "return {2, 10};", "return {1, 11};"),
    (INTERVAL, "wavelets/interval/matrices.cpp", "line.head(kAccessory).sum()", "line.head(kAccessory - 1).sum()"),
    (INTERVAL, "wavelets/interval/matrices.cpp", "- inner * knownOutside", "+ inner * knownOutside"),
    (INTERVAL, "wavelets/interval/batch.cpp", "used[lane < lanes ? lane : 0]", "used[lane < lanes ? (lane ^ 1) % lanes : 0]"),
    (INTERVAL, "wavelets/interval/batch.cpp", "batch.left[lane", "batch.right[lane"),
    (INTERVAL, "wavelets/interval/batch.cpp", "rows[i] = std::abs(rows[i])", "rows[i] = rows[i]"),
    (INTERVAL, "wavelets/interval/batch.cpp", "if (n > kShort) std::fill_n", "if (n < 0) std::fill_n"),

    (TABLE, "polygonize/cell_table.cpp", "2 * (low >> v & 1)", "1 * (low >> v & 1)"),
    (TABLE, "polygonize/cell_table.cpp", "&& inside(c[0]) != inside(c[1])", ""),
    (TABLE, "polygonize/cell_table.cpp", "if (joined) last = k + 3;", "if (joined) last = k + 1;"),
    (TABLE, "polygonize/cell_table.cpp", "signs.isJoined(face) ? 0 : 1;", "signs.isJoined(face) ? 1 : 0;"),
    (TABLE, "polygonize/cell_table.cpp", "signs.inside(low) == inside ? low", "signs.inside(low) != inside ? low"),
    (TABLE, "polygonize/cell_table.cpp", "(isSide ? 0 : squaredDistance", "(isSide ? 0 : -squaredDistance"),
    (TABLE, "polygonize/cell_table.cpp", "if (!isSide && (facesOfEdge", "if (isSide && (facesOfEdge"),
    (TABLE, "polygonize/cell_table.cpp", "loop.size() > 9", "loop.size() > 12"),
    (TABLE, "polygonize/cell_table.cpp", "isLong) > 1", "isLong) > 2"),
    (TABLE, "polygonize/cell_table.cpp", "(length - 1) / 2", "0"),
    (TABLE, "polygonize/cell_table.cpp", "if (!middleInside) std::swap", "if (middleInside) std::swap"),
    (TABLE, "polygonize/cell_table.cpp", "return loops.size() > 1 ||", "return loops.size() > 2 ||"),
    (TABLE, "polygonize/cell_table.cpp", "loopsAt[region] == 1 ?", "loopsAt[region] >= 1 ?"),
    (TABLE, "polygonize/cell_table.cpp", "index >> from++ & 1", "index >> bit & 1"),
    (TABLE, "polygonize/cell_table.cpp", "!= 0) << to++", "!= 0) << to"),

    (ASCENT, "volume/row_ascent.cpp", "r - row.rho * row.lambda", "r - 0 * row.lambda"),
    (ASCENT, "volume/row_ascent.cpp", "(double(row.squares) + row.rho)", "(double(row.squares))"),
    (ASCENT, "volume/row_ascent.cpp", "if (!row.equal) lambda =", "if (row.equal) lambda ="),
    (ASCENT, "volume/row_ascent.cpp", "add(-row.sign * step", "add(row.sign * step"),
    (ASCENT, "volume/row_ascent.cpp", "* w.z[k] * known[lineOf(i, j) + k]", "* w.z[k] * (known ? 1 : 0)"),
    (ASCENT, "volume/row_ascent.cpp", "here * here * known", "here * here"),
    (ASCENT, "volume/row_ascent.cpp", "+ row.bound;", "- row.bound;"),
    (ASCENT, "volume/row_ascent.cpp", "if (moved_[colour[i]] > 0) close", "if (moved_[colour[i]] > 1) close"),
    (ASCENT, "volume/row_ascent.cpp", "(rows_[i].equal ? std::abs(r) : r)", "std::abs(r)"),
    (ASCENT, "volume/row_ascent.cpp", "changed[i] += value != *known", "changed[i] += 1"),
    (ASCENT, "volume/row_ascent.cpp", "leaf ? 0 : tree.getValue(origin)", "leaf ? 0 : 0 * tree.getValue(origin)"),
    (ASCENT, "volume/row_ascent.cpp", "given.at[a] - (first[a] + 1)", "given.at[a] - first[a]"),

    (HOLD, "hold/hold.cpp", "half(s) - s.thickness / 2)", "half(s) - s.thickness)"),
    (HOLD, "hold/hold.cpp", "s.length <= kLongestRun * H &&", ""),
    (HOLD, "hold/hold.cpp", "row(x - step, 1, 0", "row(x + step, 1, 0"),
    (HOLD, "hold/hold.cpp", "/ (2 * refine_)", "/ refine_"),
    (HOLD, "hold/hold.cpp", "row(inner, 1, 0", "row(inner, -1, 0"),
    (HOLD, "hold/hold.cpp", "if (2 * thin <= kFewThin * area_) return 1;", ""),
]


def caught(build, tests):
    program, names = tests
    made = subprocess.run(["ninja", "-C", build, "-j2", program], capture_output=True, text=True)
    if made.returncode:
        return "caught: does not compile"
    try:
        run = subprocess.run([pathlib.Path(build) / "bin" / program, f"--gtest_filter={names}"], capture_output=True, text=True,
                             timeout=MOST_SECONDS)
    except subprocess.TimeoutExpired:
        return "caught: without end"
    failed = [line[12:].split(",")[0].split(" (")[0].strip() for line in run.stdout.splitlines() if line.startswith("[  FAILED  ]")]
    if not run.returncode:
        return None
    return f"caught by {failed[0]}" if failed else f"caught: code {run.returncode}"


def main(build, word=""):
    survived = tried = 0
    for tests, name, old, new in EDITS:
        if word not in name and word not in old:
            continue
        file = ROOT / name
        text = file.read_text()
        if text.count(old) != 1:
            sys.exit(f"{name}: '{old}' stands there {text.count(old)} times, expected once; this list is older than the source")
        try:
            file.write_text(text.replace(old, new))
            result = caught(build, tests)
        finally:
            file.write_text(text)
        tried, survived = tried + 1, survived + (result is None)
        print(f"{result or 'SURVIVED'}: {name}: {old} -> {new}", flush=True)
    print(f"{tried} edits, {survived} survived")
    return 1 if survived else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
