#!/usr/bin/env bash
# Builds and installs taut from its sources, as Containerfile and taut.def do in a bare Debian 12.
# Usage: container.sh [PREFIX [BUILD]]    PREFIX: /usr/local; BUILD: a finished build to install, instead of making one
set -euo pipefail
home=$(cd "$(dirname "$0")/../../.." && pwd)
prefix=${1:-/usr/local} build=${2:-}
if [[ -z $build ]]; then
  "$home/taut" --version  # installs the packages with apt and builds
  build=$home/build/default
fi
cmake --install "$build" --prefix "$prefix"
cd /  # the program works without its sources
"$prefix/bin/taut" case hang jakobsen:iterations=4 --set time.duration=0.5 --json
"$prefix/bin/taut" --version
