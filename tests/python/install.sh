#!/usr/bin/env bash
# `pip install` into a folder of its own, from a copy of what git knows; then the module is used from there, without the build's.
#   install.sh PYTHON SOURCE BUILD
set -euo pipefail
python=$1 source=$2 build=$3
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir "$work/source"
cd "$source"
cp -r CMakeLists.txt README.md LICENSE pyproject.toml setup.py include python scripts "$work/source"
ISOWAVE_BUILD=$build "$python" -m pip install --quiet --no-build-isolation --no-deps --no-index --disable-pip-version-check \
    --root-user-action=ignore --target "$work/site" "$work/source"
for file in py.typed _native.pyi solids.py; do
    [[ -e $work/site/isowave/$file ]] || { echo "isowave/$file was not installed"; exit 1; }
done
cd "$work"
PYTHONPATH=$work/site "$python" -c "
import isowave, numpy as np
assert isowave.__file__.startswith('$work/site'), isowave.__file__
ball = np.linalg.norm(np.indices((24, 24, 24)) - 11.5, axis=0) < 8
print(isowave.lod(ball, spacing=(1, 1, 1)))"
