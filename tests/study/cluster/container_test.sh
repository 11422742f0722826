#!/usr/bin/env bash
# Runs the steps of Containerfile and taut.def as a script: the archive of the sources must contain all that a build needs, and
# the program installed from it must give the same bits as the build tree, without its sources. Only the build itself is BUILD's,
# since another one takes minutes.
# Usage: container_test.sh BUILD
set -euo pipefail
home=$(cd "$(dirname "$0")/../../.." && pwd)
build=$1
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
for recipe in Containerfile taut.def; do
  grep -q '/usr/src/taut/experiments/study/cluster/container.sh$' "$home/experiments/study/cluster/$recipe" ||
    { echo "$recipe does not call container.sh"; exit 1; }
done
mkdir "$scratch/src"
archive() {  # tar ends with 1 if a file changed meanwhile: tests beside this one write into the tree
  git -C "$home" archive HEAD 2>/dev/null || tar -C "$home" --exclude=./build --exclude=./results/runs -c . || [[ $? == 1 ]]
}
archive | tar -x -C "$scratch/src"
(cd "$scratch/src" && cmake --preset default >/dev/null)
"$scratch/src/experiments/study/cluster/container.sh" "$scratch/usr" "$build" >"$scratch/said"
"$build/taut" case hang jakobsen:iterations=4 --set time.duration=0.5 --json >"$scratch/here"
"$build/taut" --version >>"$scratch/here"
tail -n "$(wc -l <"$scratch/here")" "$scratch/said" | diff - "$scratch/here" || { echo "other bits than in the build tree"; exit 1; }
[[ $(wc -l <"$scratch/here") -gt 20 ]] || { echo "nothing was compared"; exit 1; }
