"""Pages of `isowave view` in a headless Chromium, drawn without a GPU: what the tests and scripts/draw-docs share."""
import os
import pathlib
import shutil
import time


class Missing(Exception):
    """What is needed and is not installed."""


def chromium(width=1280, height=820, dark=False):
    """A driver, or Missing with what to install."""
    try:
        from selenium import webdriver
        from selenium.webdriver.chrome.service import Service
    except ImportError:
        raise Missing("python3-selenium is not installed; scripts/setup --test installs it")
    paths = [shutil.which("chromium"), shutil.which("chromedriver")]
    if None in paths:
        raise Missing("chromium and chromium-driver are not installed; scripts/setup --test installs them")
    options = webdriver.ChromeOptions()
    options.binary_location = paths[0]
    arguments = ["--headless=new", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
                 "--hide-scrollbars", f"--window-size={width},{height}", "--disable-dev-shm-usage",
                 "--allow-file-access-from-files"]
    arguments += ["--no-sandbox"] if os.geteuid() == 0 else []
    arguments += ["--force-dark-mode"] if dark else []
    for argument in arguments:
        options.add_argument(argument)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    driver = webdriver.Chrome(service=Service(paths[1]), options=options)
    size(driver, width, height)
    return driver


def size(driver, width, height, ratio=1):
    """The size of the page itself, whatever the window's borders take."""
    driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride",
                           {"width": width, "height": height, "deviceScaleFactor": ratio, "mobile": False})


def until(true, what, seconds=60):
    end = time.monotonic() + seconds
    while not true():
        if time.monotonic() > end:
            raise AssertionError(f"after {seconds} s still not: {what}")
        time.sleep(0.05)


def data(driver):
    """What the page says of itself: level, triangles, mode, drawn, ready."""
    return driver.execute_script("return Object.assign({}, document.documentElement.dataset)")


def settle(driver):
    """Until the level that is chosen is drawn and nothing is about to change."""
    until(lambda: data(driver).get("ready") == "true", "the page is ready")
    until(lambda: data(driver).get("drawn") == data(driver)["level"] and
          driver.execute_script("return document.getElementById('busy').hidden && !dirty"), "the picture is drawn")
    time.sleep(0.3)


def open_page(driver, path):
    driver.get(pathlib.Path(path).resolve().as_uri())
    settle(driver)


def press(driver, *keys):
    """Keys as the keyboard sends them: 'd', 'ArrowRight'."""
    for key in keys:
        driver.execute_cdp_cmd("Input.dispatchKeyEvent", {"type": "keyDown", "key": key})
        driver.execute_cdp_cmd("Input.dispatchKeyEvent", {"type": "keyUp", "key": key})
        settle(driver)


def complaints(driver):
    """Errors and warnings of the console."""
    return [entry["message"] for entry in driver.get_log("browser") if entry["level"] in ("SEVERE", "WARNING")]
