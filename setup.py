"""Builds and installs the Python module:  pip install --no-build-isolation .

CMake does the work. ISOWAVE_BUILD names a build folder that exists already; without it build/pip is made, which takes as long as
a build of the library takes.
"""

import os
import re
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


def configure(build: Path) -> None:
    subprocess.run(
        ["cmake", "-S", ROOT, "-B", build, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release", "-DISOWAVE_PYTHON=ON",
         "-DISOWAVE_TESTS=OFF", f"-DISOWAVE_PYTHON_EXECUTABLE={sys.executable}"],
        check=True,
    )


class CMakeBuild(build_ext):
    def build_extension(self, extension: Extension) -> None:
        given = os.environ.get("ISOWAVE_BUILD")
        build = Path(given) if given else ROOT / "build/pip"
        if not given:
            configure(build)
        jobs = subprocess.run([ROOT / "scripts/jobs"], check=True, capture_output=True, text=True).stdout.strip()
        subprocess.run(["cmake", "--build", build, "--target", "isowave_python", "--parallel", jobs], check=True)
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
