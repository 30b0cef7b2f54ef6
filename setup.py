"""Builds and installs the Python module:  pip install --no-build-isolation .

CMake does the work, in build/pip, which is made and takes as long as a build of the library takes. ISOWAVE_BUILD names another build
folder, which exists and has been configured with -DISOWAVE_PYTHON=ON. CMAKE_ARGS has more options for cmake, as a shell would split them.
"""

import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

ROOT = Path(__file__).resolve().parent


def version() -> str:
    text = (ROOT / "include/isowave/version.h").read_text()
    return re.search(r'ISOWAVE_VERSION "(.+)"', text).group(1)


def stop(why: str) -> None:
    """Ends with one line, which pip shows without --verbose, too."""
    raise SystemExit(f"isowave: {why}")


def run(*words: object) -> None:
    if subprocess.run([str(word) for word in words]).returncode != 0:
        stop(f"{words[0]} failed, see above (pip install --verbose); scripts/setup installs what the build needs")


def configure(build: Path) -> None:
    for tool in "cmake", "ninja":
        if not shutil.which(tool):
            stop(f"{tool} is not there, which builds the library; scripts/setup installs what the build needs")
    run("cmake", "-S", ROOT, "-B", build, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release", "-DISOWAVE_PYTHON=ON",
        "-DISOWAVE_TESTS=OFF", f"-DISOWAVE_PYTHON_EXECUTABLE={sys.executable}",
        *shlex.split(os.environ.get("CMAKE_ARGS", "")))


class CMakeBuild(build_ext):
    def build_extension(self, extension: Extension) -> None:
        given = os.environ.get("ISOWAVE_BUILD")
        build = Path(given).absolute() if given else ROOT / "build/pip"
        if not given:
            configure(build)
        elif not (build / "CMakeCache.txt").is_file():
            stop(f"ISOWAVE_BUILD: {build} is no build folder; leave it out, and build/pip is made")
        jobs = subprocess.run([ROOT / "scripts/jobs"], check=True, capture_output=True, text=True).stdout.strip()
        run("cmake", "--build", build, "--target", "isowave_python", "--parallel", jobs)
        place = Path(self.get_ext_fullpath(extension.name))
        place.parent.mkdir(parents=True, exist_ok=True)
        (made,) = (build / "python/isowave").glob("_native*.so")
        shutil.copy(made, place)


setup(
    version=version(),
    package_dir={"": "python"},
    packages=["isowave"],
    package_data={"isowave": ["py.typed", "*.pyi"]},
    ext_modules=[Extension("isowave._native", sources=[])],
    cmdclass={"build_ext": CMakeBuild},
)
