#!/usr/bin/env bash
# Builds the Python package of packaging/python as a wheel in build/python.
#
# usage: scripts/python.sh [--test]
# With --test it builds a light one by way of a source distribution, of images of at most 4 channels, installs it into a fresh
# virtual environment and runs its tests there; where build/release/bin/hmesh is, the module's files are compared with the command's.
# shellcheck source=scripts/common.sh
. "$(dirname "${BASH_SOURCE[0]}")/common.sh"

case ${1-} in
    --test) is_test=true ;;
    "") is_test=false ;;
    *) fail "usage: scripts/python.sh [--test]" ;;
esac
need compiler python-package
python=$(python_with pybind11 numpy setuptools wheel)
export HMESH_JOBS=${HMESH_JOBS:-$jobs}
folder=$PWD/build/python
if ! $is_test; then
    step "Building a wheel ..." "$python" -m pip wheel --quiet --no-build-isolation --no-deps --wheel-dir "$folder" packaging/python
    ls "$folder"/*.whl
    exit
fi

export HMESH_PYTHON_CHANNELS=4 HMESH_PYTHON_FLAGS=-O1
rm -rf "$folder/test"
mkdir -p "$folder/test"
# Built from what others would download, in a folder of its own.
step "Making a source distribution ..." sh -c 'cd packaging/python && "$0" setup.py -q egg_info --egg-base "$1" sdist --dist-dir "$1"' \
    "$python" "$folder/test"
step "Building a wheel of it ..." "$python" -m pip wheel --quiet --no-build-isolation --no-deps --no-cache-dir \
    --wheel-dir "$folder/test" "$folder"/test/hmesh-*.tar.gz
step "Making a virtual environment ..." "$python" -m venv --system-site-packages "$folder/test/venv"
step "Installing the wheel ..." "$folder/test/venv/bin/pip" install --quiet --no-index --no-deps "$folder"/test/hmesh-*.whl
command=$PWD/build/release/bin/hmesh
[ -x "$command" ] || command=
cd "$folder/test"
HMESH_COMMAND=$command venv/bin/python -m pytest -q -p no:cacheprovider --rootdir="$folder/test" \
    "$folder/../../packaging/python/tests"
venv/bin/python "$folder/../../packaging/python/examples/levels.py" levels.png
