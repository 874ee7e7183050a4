#!/bin/sh
# Installs what is needed, builds, and runs every test. Works from nothing but a checkout on Debian 12.
set -eu
cd "$(dirname "$0")"
cmake/prepare.sh release
exec ctest --preset release --parallel "$(nproc)" "$@"
