#!/bin/sh
# From release to release of npm's jolt-physics: a repository with a commit for each, and its history. Needs node, npm and git.
# Usage: releases.sh FOLDER [OPTION OF taut history ...]
set -eu
here=$(cd "$(dirname "$0")" && pwd)
releases='0.28.0 0.29.0 0.30.0 0.31.0 0.33.0 0.34.0 0.35.0 0.36.0 0.37.0 0.38.0 0.39.0 1.0.0 1.1.0'
mkdir -p "$1"
cd "$1"
shift
if [ ! -d jolt ]; then
  git init -q jolt
  cp "$here"/jolt.js "$here"/taut_solver.js jolt
  echo node_modules >jolt/.gitignore
  day=1
  for release in $releases; do
    echo "{\"dependencies\": {\"jolt-physics\": \"$release\"}}" >jolt/package.json
    git -C jolt add -A
    # one after another, not when they were published
    GIT_COMMITTER_DATE=$(printf '2000-01-%02dT00:00:00Z' $day) git -C jolt -c user.name=releases -c user.email= commit -q -m "jolt-physics $release"
    day=$((day + 1))
  done
fi
exec taut history "$here/releases.toml" --git jolt --commits "$(git -C jolt rev-list --max-parents=0 HEAD)..HEAD" --out results \
  --build 'npm install --silent --no-audit --no-fund --no-package-lock --ignore-scripts' --solver "jolt:cmd='node jolt.js'" "$@"
