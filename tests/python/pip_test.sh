#!/bin/sh
# pip installs the module from the checkout into a virtual environment, offline, with the binding of this build.
# usage: tests/python/pip_test.sh ROOT BUILD PYTHON
set -eu
root=$1 build=$2 python=$3
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
"$python" -m venv --system-site-packages --without-pip "$scratch/venv"
# Only what is in the checkout: setuptools leaves its traces beside the sources that it builds.
mkdir "$scratch/source"
cp -R "$root/python" "$root/pyproject.toml" "$root/setup.py" "$root/README.md" "$root/CMakeLists.txt" "$scratch/source"
cd "$scratch/source"
FRESHET_BUILD=$build "$scratch/venv/bin/python" -m pip install --quiet --no-index --no-deps --no-build-isolation \
    --disable-pip-version-check . 2> "$scratch/log" || { cat "$scratch/log"; exit 1; }
cd /
"$scratch/venv/bin/python" - "$scratch/venv" << 'END'
import pathlib, sys
import freshet
assert freshet.__file__.startswith(sys.argv[1]), freshet.__file__
assert (pathlib.Path(freshet.__file__).parent / "py.typed").exists()
assert len(list(freshet.simulate("fire", size=(64, 48), frames=2))) == 2
import importlib.metadata
assert importlib.metadata.version("freshet") == freshet.__version__
END
