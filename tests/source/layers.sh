#!/usr/bin/env bash
# Fails when an #include runs against the architecture, a library leaks out of the files that may know it, or two types
# or inline functions of one namespace share a name: a linker takes those of one of them for both, and nobody warns.
# Usage: layers.sh [ROOT]; `layers.sh --self-test` plants a violation of every rule in a copy and expects red.
set -euo pipefail
here=$(cd "$(dirname "$0")/../.." && pwd)

# folder | regular expression of the quoted includes that it may have; a file obeys the deepest folder that has a rule
rules='
core/model               | core/model/
core/io                  | core/(model|io)/
core/solver              | core/(model|solver)/
core/solver/simd         | core/solver/simd/
core/solver/layout       | core/(model|solver/(simd|layout))/
core/solver/constraints  | core/(model/|solver/((simd|layout|constraints)/|thread_pool))
core/solver/contact      | core/(model/|solver/((simd|layout|contact)/|thread_pool))
core/reference           | core/(model|reference)/|core/solver/(panel_factor|newton/hessian)\.hpp
bullet_ref               | (core/model|bullet_ref)/
experiments/system       | (core/(model|io)|experiments/system)/
experiments/metrics      | core/(model/(bending|membrane|crossings|declared_step|index|scene|deforming_body|text|triangle|triangle_mesh)|reference/step_error)\.hpp|experiments/metrics/
experiments/answer       | (core/(model|io)/|experiments/((system|answer)/|metrics/metric.hpp))
experiments/case         | (core/(model|io)|experiments/(system|metrics|case))/|core/reference/strain_at_rest\.hpp
experiments/external     | ((core/(model|io)|experiments/(answer|system|case|external))/|taut_solver.hpp|core/reference/strain_at_rest\.hpp)
experiments/python       | (core/(model|io)|experiments/(metrics|case|predict|python))/|experiments/system/data.hpp|experiments/truths/suite.hpp
experiments/results      | (core/(model|io)|experiments/(answer|system|metrics|case|results))/
experiments/study        | (core/(model|io|reference)|experiments/(answer|system|metrics|case|results|study))/
experiments/study/cluster | (core/(model|io)|experiments/(answer|system|case|study/cluster))/|experiments/(study|results)/[a-z_]+.hpp
experiments/study/frontier | (core/(model|io|reference)|experiments/(answer|system|case|study/frontier))/|experiments/(study|results)/[a-z_]+.hpp
experiments/timing       | (core/(model|io|reference)|experiments/(answer|system|metrics|case|results|study|timing|beside))/
experiments/beside       | beside\.hpp
experiments/timing/bench | (core/(model|io|solver|reference)|experiments/(answer|system|timing))/
experiments/predict      | (core/(model|reference)|experiments/predict)/
experiments/steps        | (core/(model|io|reference)|experiments/(answer|system|case|steps))/
experiments/baseline     | (core/(model|io)|experiments/(answer|system|case|results|study|truths|baseline))/
experiments/history      | (core/(model|io)|experiments/(answer|system|metrics|case|results|study|timing|baseline|history))/
experiments/require      | (core/(model|io)|experiments/(answer|system|metrics|case|results|study|timing|require))/
experiments/advise       | (core/(model|io)|experiments/(answer|system|case|predict|results|study|timing|require|advise))/
experiments/truths       | (core/(model|reference)|experiments/(answer|system|metrics|case|truths))/
experiments/render/image | (core/model|experiments/(system|render/image))/
experiments/render/opengl | (core/(model|io)|experiments/render/(image|opengl))/
experiments/render/picture | (core/model|experiments/(answer|system|case|render/(image|opengl|picture)))/
experiments/render/film  | (core/(model|io)|experiments/(system|case|results|study|render/(image|picture|film)|report))/
experiments/report       | (core/(model|io)|experiments/(answer|system|metrics|case|results|study|timing|steps|require|baseline|history|truths|report))/
experiments/report/chart | (core/model|experiments/(answer|system|metrics|case|timing|steps|report/chart))/|experiments/report/input
experiments/report/questions | (core/model|experiments/(answer|system|metrics|case|timing|report/(chart|questions)))/|experiments/report/input
experiments/report/plot  | (core/model|experiments/(answer|system|study/frontier|timing|history|report/(chart|plot)))/
experiments/report/model | (core/model|experiments/(answer|system|metrics|case|timing|steps|baseline|history|truths|report/(chart|questions|model)))/|experiments/report/input
'
# what is included | files that may include it
owners='
BulletSoftBody|btBullet|BulletDynamics|BulletCollision|LinearMath | ^bullet_ref/(.*\.cpp|bullet_solver\.hpp)
pybind11/|Python.h      | ^experiments/python/.*
toml\+\+                | ^core/io/document\.cpp
Eigen/(Sparse|SparseCholesky|SparseLU|OrderingMethods|Eigenvalues) | ^core/(reference|solver)/.*\.cpp|^tests/beside/stubs/
nlohmann/               | ^(experiments|tests)/.*\.cpp|^experiments/system/json(_type)?\.hpp
CLI/                    | ^experiments/command_line/parser\.cpp
SQLiteCpp/|sqlite3      | ^experiments/results/database\.[ch]pp
openssl/                | ^experiments/(case|report/chart)/.*\.cpp
core/model/(solver|params)\.hpp | ^(core|bullet_ref|tests|experiments/[^m])
'

# awk: types and inline functions at the margin of a file, outside unnamed namespaces
twice='
FNR == 1 { space = ""; own = 0 }
/^namespace \{/ { own = 1 }
/^}  \/\/ namespace$/ { own = 0 }
/^namespace [a-z:]+ \{/ { space = $2 }
!own && /^(struct|class|enum class) [A-Za-z]+( final)?( :| \{)/ {
  name = space "::" ($1 == "enum" ? $3 : $2)
  if (name in seen && seen[name] != FILENAME) printf "%s:%d: %s is also in %s\n", FILENAME, FNR, name, seen[name]
  seen[name] = FILENAME
}
!own && /^inline [^=;]*[A-Za-z_]+\([^()]*\)/ && !/operator/ {
  match($0, /[ &*][A-Za-z_0-9]+\([^()]*\)/)
  name = substr($0, RSTART + 1, RLENGTH - 1)
  gsub(/ [A-Za-z_0-9]+,/, ",", name)  # names of parameters
  sub(/ [A-Za-z_0-9]+\)$/, ")", name)
  name = space "::" name
  if (name in seen && seen[name] != FILENAME) printf "%s:%d: %s is also in %s\n", FILENAME, FNR, name, seen[name]
  seen[name] = FILENAME
}'

# awk: "file:line:#include ..." of all files, against the rules and the owners, which are in the environment
against='
BEGIN {
  rules = split(ENVIRON["rules"], rule, "\n")
  for (i = 1; i <= rules; ++i) {
    split(rule[i], half, " +[|] +")
    if (half[1] != "") allowed[half[1]] = "^#include \"(" half[2] ")"
  }
  owners = split(ENVIRON["owners"], owner, "\n")
}
{
  file = $0; sub(/:.*/, "", file)
  line = $0; sub(/^[^:]*:/, "", line); sub(/:.*/, "", line)
  text = $0; sub(/^[^:]*:[^:]*:/, "", text)
  what = text; sub(/^#include /, "", what)
  folder = file
  while (sub(/\/[^\/]*$/, "", folder) && !(folder in allowed)) {}
  if (folder in allowed && text ~ /^#include "/ && text !~ allowed[folder])
    printf "%s:%s: %s may not include %s\n", file, line, folder, what
  for (i = 1; i <= owners; ++i) {
    if (owner[i] == "") continue
    split(owner[i], half, " +[|] +")
    if (text ~ "^#include [<\"](" half[1] ")" && file !~ half[2])
      printf "%s:%s: only %s may include %s\n", file, line, half[2], what
  }
}'

check() {
  cd "$1"
  local found
  found=$({
    grep -rnE --include='*.?pp' '^#include' core bullet_ref experiments tests | rules=$rules owners=$owners awk "$against"
    find core bullet_ref experiments tests -name '*.[ch]pp' -print0 | sort -z | xargs -0 awk "$twice"
  })
  [[ -z $found ]] || { printf '%s\n' "$found"; return 1; }
}

self_test() {
  local failures=0
  copy=$(mktemp -d)
  trap 'rm -rf "$copy"' EXIT
  cp -r "$here"/{core,bullet_ref,experiments,tests} "$copy"
  "$0" "$copy" || { echo "red without a planted violation" && failures=1; }
  while IFS='|' read -r file text; do
    mkdir -p "$copy/${file%/*}"
    [[ $text == namespace* ]] || text="#include $text"
    printf '%s\n' "$text" | tr ';' '\n' >"$copy/$file"
    if "$0" "$copy" >/dev/null; then
      echo "not noticed: $file with $text"
      failures=1
    fi
    rm "$copy/$file"
  done <<'PLANTED'
core/model/planted.cpp|"core/solver/layout/particles.hpp"
core/solver/planted.hpp|"experiments/case/record.hpp"
bullet_ref/planted.cpp|"core/solver/layout/particles.hpp"
experiments/answer/planted.cpp|"experiments/case/record.hpp"
experiments/metrics/planted.cpp|"core/model/solver.hpp"
experiments/metrics/planted.cpp|"core/solver/layout/particles.hpp"
experiments/case/planted.cpp|"bullet_ref/read_back.hpp"
experiments/external/planted.cpp|"core/solver/layout/particles.hpp"
experiments/python/planted.cpp|"core/solver/layout/particles.hpp"
experiments/python/planted.cpp|"experiments/results/store.hpp"
experiments/case/planted.cpp|<pybind11/numpy.h>
core/solver/simd/planted.hpp|"core/solver/layout/particles.hpp"
core/solver/layout/planted.hpp|"core/solver/constraints/relaxation.hpp"
core/solver/constraints/planted.cpp|"core/solver/contact/projector.hpp"
core/solver/contact/planted.cpp|"core/solver/constraints/relaxation.hpp"
experiments/metrics/planted.cpp|"core/model/solver.hpp"
experiments/results/planted.cpp|"experiments/study/study.hpp"
experiments/study/planted.cpp|"experiments/timing/study_bench.hpp"
experiments/study/cluster/planted.cpp|"experiments/study/frontier/parameter_frontier.hpp"
experiments/study/frontier/planted.cpp|"experiments/study/cluster/cluster.hpp"
experiments/history/planted.cpp|"experiments/report/input.hpp"
experiments/timing/planted.cpp|"core/solver/simd/kernels.hpp"
experiments/predict/planted.cpp|"experiments/timing/judge.hpp"
experiments/steps/planted.cpp|"experiments/timing/study_bench.hpp"
experiments/timing/bench/planted.cpp|"experiments/results/store.hpp"
experiments/render/picture/planted.cpp|"experiments/render/film/film.hpp"
experiments/require/planted.cpp|"experiments/report/chart/format.hpp"
experiments/report/planted.cpp|"core/solver/simd/distance.hpp"
experiments/report/chart/planted.hpp|"experiments/report/questions/questions.hpp"
experiments/report/questions/planted.cpp|"experiments/report/model/parts.hpp"
experiments/report/plot/planted.cpp|"experiments/report/questions/questions.hpp"
experiments/report/model/planted.cpp|"experiments/report/plot/plot.hpp"
experiments/render/image/planted.cpp|"experiments/render/opengl/camera.hpp"
experiments/render/opengl/planted.cpp|"experiments/render/picture/figure.hpp"
core/solver/planted.cpp|<BulletSoftBody/btSoftBody.h>
bullet_ref/planted.hpp|<BulletSoftBody/btSoftBody.h>
core/model/planted.hpp|<toml++/toml.h>
core/solver/planted.hpp|<Eigen/Sparse>
core/model/planted.cpp|<nlohmann/json.hpp>
experiments/cli/cost/planted.cpp|<CLI/CLI.hpp>
experiments/case/planted.hpp|namespace taut {;struct Scene {
experiments/report/planted.cpp|namespace taut {;enum class TruthVerdict {
tests/planted.hpp|namespace taut {;inline int body_of_a_box(const Vec3& size) {
PLANTED
  return $failures
}

if [[ ${1:-} == --self-test ]]; then self_test; else check "${1:-$here}"; fi
