"""Runs a test that needs Python packages; where one is missing, says which, and that counts as skipped (exit code 77).

    run.py pytest,numpy -- COMMAND...
"""

import importlib.util
import subprocess
import sys

DEBIAN = {"numpy": "python3-numpy", "pytest": "python3-pytest", "nibabel": "python3-nibabel", "mypy": "mypy",
          "setuptools": "python3-setuptools", "pip": "python3-pip", "wheel": "python3-wheel",
          "dask": "python3-dask", "distributed": "python3-distributed", "zarr": "python3-zarr"}


def main() -> int:
    modules, dashes, *command = sys.argv[1:]
    assert dashes == "--"
    missing = [name for name in modules.split(",") if importlib.util.find_spec(name) is None]
    if missing:
        packages = " ".join(DEBIAN.get(name, name) for name in missing)
        print(f"SKIPPED: {sys.executable} has no {', '.join(missing)}; apt-get install {packages} (scripts/setup does)")
        return 77
    return subprocess.run(command).returncode


if __name__ == "__main__":
    sys.exit(main())
