#!/usr/bin/python3
"""Opens pages of `isowave view` in a headless Chromium and uses them: keys, slider, hands, both themes, phone width.

    tests/view/pages_in_browser.py ISOWAVE           exits 0, 1 (a claim does not hold) or 77 (there is no browser)

Every function `claim_...` gets the open page of a ladder and its report, and is a test of its own.
"""
import base64
import importlib.machinery
import importlib.util
import io
import json
import pathlib
import subprocess
import sys
import tempfile
import traceback

import browser
from browser import data, press

ROOT = pathlib.Path(__file__).resolve().parents[2]
SKIPPED = 77


def program(path):
    """A Python program without an extension, as a module."""
    loader = importlib.machinery.SourceFileLoader(path.name, str(path))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader(path.name, loader))
    loader.exec_module(module)
    return module


sys.dont_write_bytecode = True  # none beside the program
first_picture = program(ROOT / "bench/first_picture")


# ---- pictures ---------------------------------------------------------------------------------------------------

def picture(driver):
    """The canvas alone, without what lies over it, as an array of rows of RGB."""
    import numpy
    from PIL import Image
    script(driver, "document.body.classList.add('bare')")
    box = driver.execute_script("const b = document.getElementById('canvas').getBoundingClientRect();"
                                "return [b.left, b.top, b.right, b.bottom].map(Math.round)")
    image = Image.open(io.BytesIO(driver.get_screenshot_as_png())).convert("RGB")
    script(driver, "document.body.classList.remove('bare')")
    ratio = script(driver, "return devicePixelRatio")
    box = [round(ratio * side) for side in box]
    return numpy.asarray(image)[box[1]:box[3], box[0]:box[2]].astype(int)


def is_blank(pixels):
    """Whether hardly anything differs from the corner."""
    return (abs(pixels - pixels[-1, -1]).max(axis=2) > 12).mean() < 0.02


def difference(a, b):
    """The share of pixels that differ visibly."""
    return 1.0 if a.shape != b.shape else (abs(a - b).max(axis=2) > 12).mean()


def check(condition, *what):
    if not condition:
        raise AssertionError(" ".join(str(w) for w in what))


def changes(driver, act, least=0.005):
    before = picture(driver)
    act()
    browser.settle(driver)
    seen = difference(before, picture(driver))
    check(seen >= least, f"only {100 * seen:.2f} % of the picture changed")


def script(driver, text, *arguments):
    return driver.execute_script(text, *arguments)


def drag(driver, *points):
    for kind, (x, y) in zip(["mousePressed"] + ["mouseMoved"] * (len(points) - 2) + ["mouseReleased"], points):
        driver.execute_cdp_cmd("Input.dispatchMouseEvent", {"type": kind, "x": x, "y": y, "button": "left", "buttons": 1,
                                                            "clickCount": 1})


def touch(driver, kind, *points):
    driver.execute_cdp_cmd("Input.dispatchTouchEvent", {
        "type": kind, "touchPoints": [{"x": x, "y": y, "id": i} for i, (x, y) in enumerate(points)]})


# ---- claims about the page of a ladder --------------------------------------------------------------------------

def claim_the_first_picture_is_not_blank(driver, report):
    check(not is_blank(picture(driver)), "the picture is blank")
    check(data(driver)["level"] == "L0")
    first, chosen = marks(driver)
    check(0 < first <= chosen, first, chosen)


def claim_the_slider_changes_triangles_and_picture(driver, report):
    for index, level in enumerate(report["levels"]):
        def move():
            script(driver, "const s = document.querySelector('#levels-a input'); s.value = arguments[0];"
                           "s.dispatchEvent(new Event('input'))", index)
        if index == 0:
            move()
        else:
            changes(driver, move)
        browser.settle(driver)
        check(int(data(driver)["triangles"]) == level["triangles"], data(driver), level["triangles"])


def claim_keys_choose_levels(driver, report):
    press(driver, "Home", "ArrowRight", "ArrowRight")
    check(data(driver)["level"] == "L2", data(driver))
    press(driver, "ArrowLeft")
    check(data(driver)["level"] == "L1", data(driver))
    press(driver, "End", "ArrowRight")
    check(data(driver)["level"] == f"L{len(report['levels']) - 1}", data(driver))
    check(script(driver, "return document.querySelector('tr.a th').textContent") == data(driver)["level"])


def claim_the_histogram_has_the_reports_numbers(driver, report):
    for index in range(1, len(report["levels"])):
        press(driver, "Home", *["ArrowRight"] * index)
        shown = script(driver, "return Object.assign({}, document.querySelector('.histogram').dataset)")
        level = report["levels"][index]
        check(float(shown["rms"]) == level["rms_to_level0"], shown, level["rms_to_level0"])
        check(float(shown["max"]) == level["max_to_level0"], shown, level["max_to_level0"])
        own = script(driver, f"return page.levels[{index}].distance")
        check(abs(own["rms"] / level["rms_to_level0"] - 1) < 0.25, own["rms"], level["rms_to_level0"])
        check(0.9 < own["max"] / level["max_to_level0"] < 1 + 1e-5, own["max"], level["max_to_level0"])
        bars = script(driver, "return document.querySelectorAll('.histogram rect').length")
        check(bars == len(own["histogram"]), bars)


def claim_distances_are_coloured_and_have_a_scale(driver, report):
    press(driver, "Home", "ArrowRight", "ArrowRight")
    changes(driver, lambda: press(driver, "d"))
    check(script(driver, "return !document.getElementById('legend').hidden"))
    changes(driver, lambda: script(driver, "const r = document.querySelector('#legend input'); r.value = 0.2;"
                                           "r.dispatchEvent(new Event('input'))"))
    press(driver, "d")


def claim_two_levels_stand_side_by_side_or_one_over_the_other(driver, report):
    press(driver, "End")
    changes(driver, lambda: press(driver, "s"), 0.05)
    labels = script(driver, "return [...document.querySelectorAll('#labels span')].map((s) => s.textContent)")
    check(len(labels) == 2 and labels[0] != labels[1], labels)
    changes(driver, lambda: press(driver, "o"), 0.05)
    changes(driver, lambda: press(driver, "]"))
    press(driver, "o")
    check(data(driver)["mode"] == "single")


def claim_wireframe_cut_and_facets_are_seen(driver, report):
    press(driver, "Home", "ArrowRight")
    for key in ("w", "c", "z", "v", "g", "p"):
        changes(driver, lambda: press(driver, key), 0.001)
    for key in ("w", "c", "g", "p"):
        press(driver, key)


def claim_hands_turn_and_zoom(driver, report):
    changes(driver, lambda: drag(driver, (400, 300), (430, 310), (520, 340), (520, 340)), 0.02)
    wide = script(driver, "return orbit.height")
    driver.execute_cdp_cmd("Input.dispatchMouseEvent", {"type": "mouseWheel", "x": 400, "y": 300, "deltaX": 0, "deltaY": -300})
    browser.until(lambda: script(driver, "return orbit.height") < 0.8 * wide, "the wheel zooms")
    near = script(driver, "return orbit.height")
    touch(driver, "touchStart", (350, 300), (450, 300))
    touch(driver, "touchMove", (300, 300), (500, 300))
    touch(driver, "touchEnd")
    browser.until(lambda: script(driver, "return orbit.height") < 0.7 * near, "two fingers zoom")
    press(driver, "f")
    check(abs(script(driver, "return orbit.height") / wide - 1) < 0.5)


def claim_the_cube_turns_the_solid(driver, report):
    script(driver, "document.querySelector('#cube g').dispatchEvent(new Event('click'))")
    browser.until(lambda: script(driver, "return orbit.goal === null"), "the turn ends")
    letters = script(driver, "return [...document.querySelectorAll('#cube text')].map((t) => t.textContent)")
    browser.until(lambda: len(script(driver, "return [...document.querySelectorAll('#cube text')]")) == 1,
                  f"one face is seen, not {letters}")


def claim_the_theme_changes(driver, report):
    ground = picture(driver)[-1, -1].sum()
    press(driver, "t")
    dark = picture(driver)[-1, -1].sum()
    press(driver, "t")
    check(abs(ground - dark) > 300, ground, dark)


def claim_the_saved_stl_is_the_level(driver, report):
    press(driver, "Home", "ArrowRight")
    driver.set_script_timeout(60)
    text = driver.execute_async_script("""
        const done = arguments[0], reader = new FileReader();
        reader.onload = () => done(reader.result.split(",")[1]);
        reader.readAsDataURL(stage.stl(state.a, "test"));""")
    with tempfile.NamedTemporaryFile(suffix=".stl") as file:
        file.write(base64.b64decode(text))
        file.flush()
        saved = json.loads(run("check", file.name, "--json", "-"))
    level = report["levels"][1]
    check(saved["closed"] and saved["manifold"], saved)
    check(saved["triangles"] == level["triangles"] and saved["genus"] == level["genus"], saved)
    check(abs(saved["volume"] / level["volume"] - 1) < 1e-4, saved["volume"], level["volume"])


def claim_a_phone_shows_everything(driver, report):
    browser.size(driver, 390, 844, 2)
    browser.settle(driver)
    try:
        check(script(driver, "return document.documentElement.scrollWidth") <= 390, "wider than the phone")
        box = script(driver, "const b = document.getElementById('canvas').getBoundingClientRect(); return [b.width, b.height]")
        check(box[0] >= 380 and box[1] >= 250, box)
        check(not is_blank(picture(driver)[:400]), "the picture is blank")
        bottom = script(driver, "return document.getElementById('dock').getBoundingClientRect().bottom")
        check(bottom <= 844, bottom)
    finally:
        browser.size(driver, 1280, 820)
        browser.settle(driver)


def claim_nothing_is_fetched(driver, report):
    check(script(driver, "return performance.getEntriesByType('resource').filter((e) => !/^(data|blob):/.test(e.name)).length") == 0)


# ---- other pages ------------------------------------------------------------------------------------------------

def curves_are_drawn(driver, folder):
    run("curves", ROOT / "tests/data/curves2d/africa.geojson", "--pixels", "256", "--format", "geojson", "-o", folder / "africa",
        "--json", folder / "africa/report.json")
    report = json.load(open(folder / "africa/report.json"))
    show(driver, folder, "africa")
    check(not is_blank(picture(driver)), "the picture is blank")
    changes(driver, lambda: press(driver, "ArrowRight", "ArrowRight", "ArrowRight"))
    shown = script(driver, "return document.querySelector('.histogram').dataset.rms")
    wanted = [step["rms_to_level0"] for step in report["steps"] if step["file"]][3]
    check(float(shown) == wanted, shown, wanted)
    own = script(driver, "return page.levels[3].distance.rms")
    check(abs(own / wanted - 1) < 0.05, own, wanted)
    changes(driver, lambda: press(driver, "d"), 0.001)
    changes(driver, lambda: press(driver, "s"))
    changes(driver, lambda: press(driver, "t"), 0.3)


def subdivision_levels_are_drawn(driver, folder):
    run("reverse", ROOT / "tests/data/meshes/anchor_semiregular_tri.off", "--scheme", "loop", "-o", folder / "base.obj",
        "--details", folder / "anchor.details")
    show(driver, folder, "anchor.details")
    check(not is_blank(picture(driver)), "the picture is blank")
    changes(driver, lambda: press(driver, "End"))
    check(data(driver)["level"] == "base", data(driver))


def a_mesh_alone_is_drawn(driver, folder):
    show(driver, folder, ROOT / "tests/data/meshes/gearwheel.bin.stl")
    check(not is_blank(picture(driver)), "the picture is blank")
    check(script(driver, "return document.getElementById('levels-a').hidden"), "a slider over one level")


def a_large_mesh_is_seen_as_a_draft_before_it_is_whole(driver, folder):
    first_picture.torus(folder / "torus.ply", 500_000)
    show(driver, folder, "torus.ply")
    check(not is_blank(picture(driver)), "the picture is blank")
    check(script(driver, "const s = stage.loaded.get(0); return s.draft !== null && s.surface !== null"), "no draft was made")
    first, whole = marks(driver)
    check(0 < first < whole, first, whole)


def marks(driver):
    """When the first picture was there, and the first of the chosen level."""
    found = [script(driver, "return performance.getEntriesByName(arguments[0]).map((e) => e.startTime)", name)
             for name in first_picture.MARKS]
    check([len(times) for times in found] == [1, 1], found)
    return [times[0] for times in found]


# ---- running ----------------------------------------------------------------------------------------------------

def run(*arguments):
    done = subprocess.run([ISOWAVE, *map(str, arguments)], capture_output=True, text=True)
    check(done.returncode in (0, 4), done.stderr)
    return done.stdout


def show(driver, folder, what):
    run("view", folder / what, "-o", folder / "shown.html")
    browser.open_page(driver, folder / "shown.html")


def attempt(name, act, driver, failures):
    try:
        act()
        complaints = browser.complaints(driver)
        check(not complaints, complaints)
        print(f"ok      {name}")
    except Exception:
        failures.append(name)
        print(f"FAILED  {name}\n{traceback.format_exc()}")


def main():
    try:
        import numpy  # noqa: F401
        import PIL  # noqa: F401
        driver = browser.chromium()
    except (browser.Missing, ImportError) as missing:
        print(f"SKIPPED: pages of isowave view were not opened in a browser: {missing}")
        return SKIPPED
    failures = []
    try:
        driver.get("data:text/html,<body style='margin:0'><canvas id='canvas' style='width:100vw;height:100vh'></canvas>")
        check(is_blank(picture(driver)), "a blank page must be found blank")
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            run("lod", ROOT / "tests/data/meshes/couplingdown.off", "--voxels", "48", "--levels", "0..4", "--view", "-o", folder / "part")
            report = json.load(open(folder / "part/report.json"))
            browser.open_page(driver, folder / "part" / report["view"])
            for claim, act in list(globals().items()):
                if claim.startswith("claim_"):
                    attempt(claim[6:].replace("_", " "), lambda: act(driver, report), driver, failures)
            for act in (curves_are_drawn, subdivision_levels_are_drawn, a_mesh_alone_is_drawn,
                        a_large_mesh_is_seen_as_a_draft_before_it_is_whole):
                attempt(act.__name__.replace("_", " "), lambda: act(driver, folder), driver, failures)
    finally:
        driver.quit()
    print(f"{len(failures)} failed" if failures else "all hold")
    return 1 if failures else 0


if __name__ == "__main__":
    ISOWAVE = sys.argv[1]
    sys.exit(main())
