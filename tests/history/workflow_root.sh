#!/usr/bin/env bash
# Tests the workflow of experiments/external/README.md on a bare Debian 12: installs only what the workflow installs, python3 and
# taut's package made from BUILD, and runs the workflow's steps in a repository of a solver (workflow_test.py).
# Usage: workflow_root.sh BUILD. Exit code 77: not run, with the reason, since no such system can be made here.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
build=$(readlink -f "$1")
. "$here/../support/bare_debian.sh"
cpack --config "$build/CPackConfig.cmake" -G DEB -B "$scratch/deb" >/dev/null
cp "$scratch"/deb/taut_*.deb "$root/tmp/taut.deb"
mkdir "$root/tmp/workflow"
cp "$here/workflow_test.py" "$here"/../../experiments/external/{README.md,sdk/toy.py,sdk/taut_solver.py} "$root/tmp/workflow"
in_root() {  # with /proc, where taut finds its own path
  unshare --mount --pid --fork --mount-proc="$root/proc" chroot "$root" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root TMPDIR=/tmp "$@"
}
in_root apt-get update >/dev/null
in_root apt-get install -y --no-install-recommends python3 /tmp/taut.deb >"$scratch/log" 2>&1 || { tail -n 5 "$scratch/log"; exit 1; }
in_root python3 /tmp/workflow/workflow_test.py /usr/bin /tmp/workflow/README.md /tmp/workflow
