#!/usr/bin/env bash
# The steps of Containerfile and taut.def, run as a script: what they install gives the bits of the build tree, without its
# sources. Usage: container_test.sh BUILD
set -euo pipefail
home=$(cd "$(dirname "$0")/../.." && pwd)
build=$1
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
for recipe in Containerfile taut.def; do
  grep -q '/usr/src/taut/experiments/cluster/container.sh$' "$home/experiments/cluster/$recipe" ||
    { echo "$recipe does not call container.sh"; exit 1; }
done
"$home/experiments/cluster/container.sh" "$scratch/usr" "$build" >"$scratch/said"
"$build/taut" case hang jakobsen:iterations=4 --set time.duration=0.5 --json >"$scratch/here"
"$build/taut" --version >>"$scratch/here"
tail -n "$(wc -l <"$scratch/here")" "$scratch/said" | diff - "$scratch/here" || { echo "other bits than in the build tree"; exit 1; }
[[ $(wc -l <"$scratch/here") -gt 20 ]] || { echo "nothing was compared"; exit 1; }
