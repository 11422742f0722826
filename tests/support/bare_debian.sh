# To be sourced: makes a bare Debian 12 in the folder $root (by debootstrap, from the mirror of this machine), and a folder $scratch
# that is removed when the script ends. Exits with 77, not run, with the reason, where no such system can be made.
not_here() { echo "$(basename "$0" .sh): not run: $1"; exit 77; }

[[ $(id -u) == 0 ]] || not_here "needs root"
unshare --mount --pid --fork true 2>/dev/null || not_here "no namespaces here"
command -v debootstrap >/dev/null || not_here "debootstrap is not installed"
mirror=$(apt-get indextargets --format '$(RELEASE) $(COMPONENT) $(REPO_URI)' 2>/dev/null | awk '/^bookworm main /{ print $3; exit }')
[[ -n $mirror ]] || not_here "this machine has no mirror of Debian 12"
scratch=$(mktemp -d)
trap 'rm -rf --one-file-system "$scratch"' EXIT
root=$scratch/root
debootstrap --variant=minbase bookworm "$root" "$mirror" >"$scratch/log" 2>&1 || { tail -n 3 "$scratch/log"; not_here "debootstrap failed"; }
cp /etc/resolv.conf /etc/hosts "$root/etc"
