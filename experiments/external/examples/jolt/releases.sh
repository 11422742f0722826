#!/bin/sh
# Makes a repository with a commit for each release of npm's jolt-physics, and runs its history. Needs node, npm and git.
# Usage: releases.sh FOLDER [OPTION OF taut history ...]
set -eu
here=$(cd "$(dirname "$0")" && pwd)
releases='0.6.0 2023-10-08
0.28.0 2024-10-21
0.29.0 2024-11-03
0.30.0 2024-11-27
0.31.0 2024-12-30
0.33.0 2025-03-16
0.34.0 2025-03-17
0.35.0 2025-03-31
0.36.0 2025-05-06
0.37.0 2025-08-30
0.38.0 2025-10-08
0.39.0 2025-11-04
1.0.0 2025-12-28
1.1.0 2026-07-11'
mkdir -p "$1"
cd "$1"
shift
if [ ! -d jolt ]; then
  git init -q jolt
  cp "$here"/jolt.js "$here"/taut_solver.js jolt
  echo node_modules >jolt/.gitignore
  echo "$releases" | while read -r release day; do
    echo "{\"dependencies\": {\"jolt-physics\": \"$release\"}}" >jolt/package.json
    git -C jolt add -A
    GIT_COMMITTER_DATE=${day}T00:00:00Z git -C jolt -c user.name=releases -c user.email= commit -q -m "jolt-physics $release"
  done
fi
exec taut history "$here/releases.toml" --git jolt --commits "$(git -C jolt rev-list --max-parents=0 HEAD)..HEAD" --out results \
  --build 'npm install --silent --no-audit --no-fund --no-package-lock --ignore-scripts' --solver "jolt:cmd='node jolt.js'" "$@"
