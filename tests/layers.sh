#!/usr/bin/env bash
# Fails when an #include runs against the architecture, or a library leaks out of the files that may know it.
# Usage: layers.sh [ROOT]; `layers.sh --self-test` plants a violation of every rule in a copy and expects red.
set -euo pipefail
here=$(cd "$(dirname "$0")/.." && pwd)

# folder | regular expression of the quoted includes that it may have
rules='
core/model          | core/model/
core/solver         | core/(model|solver)/
core/reference      | core/(model|reference)/
bullet_ref          | (core/model|bullet_ref)/
experiments/metrics | (core/model|experiments/(metrics|lab))/
experiments/lab     | (core/(model|reference)|experiments/(metrics|lab))/
experiments/report  | (core/model|experiments/(metrics|lab|report))/
experiments/render  | (core/model|experiments/(metrics|lab|render))/
experiments/bench   | (core/(model|solver)|experiments/(lab|bench))/
experiments/truths  | (core/(model|reference)|experiments/(metrics|lab|truths))/
'
# what is included | files that may include it
owners='
BulletSoftBody|btBullet|BulletDynamics|BulletCollision|LinearMath | ^bullet_ref/.*\.cpp
toml\+\+                | ^(core/model/document|experiments/lab/[a-z_]+)\.cpp
Eigen/(Sparse|SparseCholesky|SparseLU|OrderingMethods|Eigenvalues) | ^core/reference/.*\.cpp
nlohmann/               | ^(experiments|tests)/.*\.cpp
openssl/                | ^experiments/lab/.*\.cpp
'

check() {
  local root=$1 bad=0 folder allowed what who file
  cd "$root"
  while IFS='|' read -r folder allowed; do
    folder=${folder// /} allowed=${allowed// /}
    [[ -n $folder && -d $folder ]] || continue
    while IFS=: read -r file line text; do
      [[ -n $file ]] || continue
      printf '%s:%s: %s may not include %s\n' "$file" "$line" "$folder" "${text#*include }"
      bad=1
    done < <(grep -rnE --include='*.?pp' '^#include "' "$folder" | grep -vE "#include \"($allowed|[a-z_0-9]+\.inc)" || true)
  done < <(sed 's/ | /|/' <<<"$rules" | sed 's/ *|/|/')
  while IFS= read -r rule; do
    [[ -n $rule ]] || continue
    what=${rule%% | *} who=${rule##* | }
    what=${what%"${what##*[! ]}"}
    while IFS=: read -r file line text; do
      [[ -n $file && ! $file =~ $who ]] || continue
      printf '%s:%s: only %s may include %s\n' "$file" "$line" "$who" "${text#*include }"
      bad=1
    done < <(grep -rnE --include='*.?pp' "^#include [<\"]($what)" core bullet_ref experiments tests || true)
  done <<<"$owners"
  return $bad
}

self_test() {
  local failures=0
  copy=$(mktemp -d)
  trap 'rm -rf "$copy"' EXIT
  cp -r "$here"/{core,bullet_ref,experiments,tests} "$copy"
  while IFS='|' read -r file include; do
    mkdir -p "$copy/${file%/*}"
    printf '#include %s\n' "$include" >"$copy/$file"
    if (check "$copy") >/dev/null; then
      echo "not noticed: $file including $include"
      failures=1
    fi
    rm "$copy/$file"
  done <<'PLANTED'
core/model/planted.cpp|"core/solver/pass.hpp"
core/solver/planted.hpp|"experiments/lab/record.hpp"
bullet_ref/planted.cpp|"core/solver/pass.hpp"
experiments/metrics/planted.cpp|"core/solver/pass.hpp"
experiments/lab/planted.cpp|"bullet_ref/read_back.hpp"
experiments/report/planted.cpp|"core/solver/distance.hpp"
core/solver/planted.cpp|<BulletSoftBody/btSoftBody.h>
bullet_ref/planted.hpp|<BulletSoftBody/btSoftBody.h>
core/model/planted.hpp|<toml++/toml.h>
core/solver/planted.cpp|<Eigen/Sparse>
core/model/planted.cpp|<nlohmann/json.hpp>
PLANTED
  return $failures
}

if [[ ${1:-} == --self-test ]]; then self_test; else check "${1:-$here}"; fi
