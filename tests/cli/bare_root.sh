#!/usr/bin/env bash
# Runs the README's two commands on a bare Debian 12: they, and the tests, may use nothing but what they install.
# The bare system (tests/support/bare_debian.sh) contains this tree with BUILD under an overlay, which is configured again
# with the packages of that system and recompiled where a file of theirs differs or is missing.
# Usage: bare_root.sh BUILD [--whole]
#   --whole: runs the whole main job and all tests; otherwise one study with its report, and the tests of programs that nothing else needs.
# Exit code 77: not run, with the reason, since no such system can be made here.
set -euo pipefail
home=$(cd "$(dirname "$0")/../.." && pwd)
build=$(readlink -f "$1")
if [[ ${2:-} == --whole ]]; then study= tests=()
else
  study=regression
  tests=(-R '^(browser|cluster.container|documents|format|launcher_test|layers$|pictures_test|python\.(runs|scores|documents|environments)|VideoTest|Plots)')
fi
. "$home/tests/support/bare_debian.sh"
mkdir -p "$scratch/changed" "$scratch/work" "$root$home"
# Installs the Debian packages in a root of their own: `import taut` may need nothing but what they depend on.
packages=
if command -v dpkg-shlibdeps >/dev/null && grep -q '^TAUT_PYTHON:BOOL=ON' "$build/CMakeCache.txt"; then
  (cd "$build" && cpack -G DEB -B "$scratch/packages") >"$scratch/log" 2>&1 || { tail -n 20 "$scratch/log"; exit 1; }
  packages=$scratch/packaged
  cp -a "$root" "$packages"
  cp "$scratch"/packages/{taut,python3-taut}_*.deb "$packages/tmp"
else echo "bare_root: the Debian packages are not tried: dpkg-shlibdeps is missing, or the Python module is off"
fi
# Keeps compile commands equal, so that BUILD's objects stay valid: its -Werror, and a stand-in for its compiler cache.
export CI=
! grep -q '^TAUT_WERROR:BOOL=ON' "$build/CMakeCache.txt" || CI=1
cache=$(sed -n 's/^CCACHE:FILEPATH=\(\/.*\)/\1/p' "$build/CMakeCache.txt")
[[ -z $cache ]] || install -Dm755 <(printf '#!/bin/sh\nexec "$@"\n') "$root$cache"

# All mounts disappear with the process.
export root home build scratch study packages
unshare --mount --pid --fork --kill-child bash -euc '
  mount -t overlay overlay -o "lowerdir=$home,upperdir=$scratch/changed,workdir=$scratch/work" "$root$home" &&
    mount -t proc proc "$root/proc" && mount --rbind /dev "$root/dev" || exit 77
  if [[ -n $packages ]]; then
    mount -t proc proc "$packages/proc" && mount --rbind /dev "$packages/dev" || exit 77
    packaged() { chroot "$packages" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root DEBIAN_FRONTEND=noninteractive "$@"; }
    packaged apt-get update >"$scratch/log" 2>&1 &&
      packaged sh -c "apt-get install -y --no-install-recommends /tmp/*.deb" >>"$scratch/log" 2>&1 || { tail -n 20 "$scratch/log"; exit 1; }
    packaged python3 -c "import taut; print(\"python3-taut:\", taut.simulate(\"hang\", \"bullet\", duration=0.5).status, len(taut.scenes()), \"scenes\")"
  fi
  rm -f "$root$build/CMakeCache.txt" "$root$build/build.ninja"
  in_root() { chroot "$root" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root TMPDIR=/tmp CI="$CI" "$@"; }
  in_root "$home/taut" run $study --out /tmp/runs
  [[ -z $study ]] || in_root "$home/taut" report $study --out /tmp/runs
  in_root "$home/taut" test "$@"
  # of the tests of external programs, which take 90 s, runs only the one that needs another language
  [[ -z $study ]] ||
    in_root python3 "$home/tests/external/external_test.py" "$build" Everywhere.test_a_solver_written_from_the_document_runs_beside_bullet
' bare_root "${tests[@]}" || { status=$?; [[ $status != 77 ]] || not_here "nothing can be mounted"; exit "$status"; }
