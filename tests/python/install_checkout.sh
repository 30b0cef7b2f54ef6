#!/usr/bin/env bash
# `pip install` in a clean checkout, without a build folder: pip configures and builds with CMake, then the module is used. What takes
# long, compiling, is left out where BUILD has compiled the same source: objects_of.sh is the compiler's launcher.
#   install_checkout.sh PYTHON SOURCE BUILD
set -euo pipefail
python=$1 source=$2 build=$3
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir "$work/checkout"
tar -C "$source" --exclude=./build --exclude=./dist --exclude=./.git -cf - . | tar -x -C "$work/checkout"
pip=("$python" -m pip install --quiet --no-build-isolation --no-deps --no-index --disable-pip-version-check
     --root-user-action=ignore --target "$work/site" "$work/checkout")

# Without cmake it says what is missing.
mkdir "$work/bin"
for tool in bash sh env uname; do ln -s "$(command -v $tool)" "$work/bin/$tool"; done
if PATH=$work/bin "${pip[@]}" > "$work/log" 2>&1; then echo "built without cmake"; exit 1; fi
grep -q "isowave: cmake is not there.*scripts/setup" "$work/log" || { cat "$work/log"; exit 1; }
if ISOWAVE_BUILD=$work/none "${pip[@]}" > "$work/log" 2>&1; then echo "built from nothing"; exit 1; fi
grep -q "ISOWAVE_BUILD: $work/none is no build folder" "$work/log" || { cat "$work/log"; exit 1; }

export ISOWAVE_OBJECTS=$build ISOWAVE_OBJECTS_SOURCE=$source
CMAKE_ARGS="-DCMAKE_CXX_COMPILER_LAUNCHER=$source/tests/python/objects_of.sh" "${pip[@]}"
cd "$work"
PYTHONPATH=$work/site "$python" -c "
import isowave, numpy as np
assert isowave.__file__.startswith('$work/site'), isowave.__file__
ball = np.linalg.norm(np.indices((24, 24, 24)) - 11.5, axis=0) < 8
print(isowave.lod(ball, spacing=(1, 1, 1)))"
