#!/usr/bin/env bash
# The workflow of experiments/external/README.md on a Debian 12 that has nothing but what the workflow installs: taut's package, made
# of BUILD, and python3; then its steps in a repository of a solver's own (workflow_test.py).
# Usage: workflow_root.sh BUILD. Ends with 77, not run, where no such system can be made; says why.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
build=$(readlink -f "$1")
. "$here/../support/bare_debian.sh"
cpack --config "$build/CPackConfig.cmake" -G DEB -B "$scratch/deb" >/dev/null
cp "$scratch"/deb/taut_*.deb "$root/tmp/taut.deb"
mkdir "$root/tmp/workflow"
cp "$here/workflow_test.py" "$here"/../../experiments/external/{README.md,sdk/toy.py,sdk/taut_solver.py} "$root/tmp/workflow"
in_root() {  # with /proc, by which taut finds itself
  unshare --mount --pid --fork --mount-proc="$root/proc" chroot "$root" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root TMPDIR=/tmp "$@"
}
in_root apt-get update >/dev/null
in_root apt-get install -y --no-install-recommends python3 /tmp/taut.deb >"$scratch/log" 2>&1 || { tail -n 5 "$scratch/log"; exit 1; }
in_root python3 /tmp/workflow/workflow_test.py /usr/bin /tmp/workflow/README.md /tmp/workflow
