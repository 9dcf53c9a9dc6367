#!/bin/sh
# What a newcomer does: on a bare Debian 12 that has git and nothing else of ours, clone the project
# and run ./dev. Not part of ./dev test: it needs root, debootstrap, the network and about 2 GB.
set -eu

usage="usage: test/contract/install/newcomer.sh DIR [COMMAND [ARG...]]
  makes a bare Debian 12 in the new folder DIR, clones this repository's HEAD into it and runs
  ./dev COMMAND there (demo if none is given). DIR is kept, to be looked at and removed."

die()
{
    echo "newcomer.sh: $*" >&2
    exit 1
}

# The settings by which this machine reaches the network, for a root that has none of its own.
carry_network_settings()
{
    cp -L /etc/resolv.conf /etc/hosts "$root/etc/"
    [ ! -f /etc/pip.conf ] || cp -L /etc/pip.conf "$root/etc/"
    apt-config dump | grep -E '^Acquire::(https?|Check|Retries)' \
        >"$root/etc/apt/apt.conf.d/99host" || :

    # As local certificates, so that the package ca-certificates keeps them when it is installed.
    mkdir -p "$root/usr/local/share/ca-certificates"
    csplit --quiet --elide-empty-files --suffix-format=%03d.crt \
        --prefix="$root/usr/local/share/ca-certificates/host-" \
        /etc/ssl/certs/ca-certificates.crt '/BEGIN CERTIFICATE/' '{*}'
}

# Run a command in the new root with a network environment like ours. The mounts and processes end
# with the namespaces. A real root and not a chroot, for in that the kernel refuses the user
# namespaces that the system tests use.
in_root()
{
    for name in $(env | sed -n 's/^\(PIP_[A-Z_]*\|[A-Za-z]*_proxy\|[A-Z]*_PROXY\)=.*/\1/p'); do
        eval "set -- \"$name=\$$name\" \"\$@\""
    done
    # shellcheck disable=SC2016 # expanded by the inner shell
    unshare --mount --pid --fork --kill-child sh -euc '
        root=$1
        shift
        mount --bind "$root" "$root"
        mount -t proc proc "$root/proc"
        mount --rbind /sys "$root/sys"
        mount --rbind /dev "$root/dev"
        cd "$root"
        pivot_root . mnt
        umount --lazy /mnt
        cd /root/vdna
        exec env -i "$@"
    ' sh "$root" HOME=/root LANG=C.UTF-8 TERM="${TERM:-dumb}" \
        PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin "$@"
}

[ $# -ge 1 ] || die "no folder is given; $usage"
[ "$(id -u)" -eq 0 ] || die "only root can make and enter a new root; run it with sudo"
command -v debootstrap >/dev/null || die "debootstrap is missing; apt-get install debootstrap"
[ ! -e "$1" ] || die "$1 exists; give a new folder or remove it"
source=$(git -C "$(dirname "$0")" rev-parse --show-toplevel)
mkdir -p "$1"
root=$(cd "$1" && pwd)
shift
[ $# -gt 0 ] || set -- demo

echo "making a bare Debian 12 in $root ..."
debootstrap --variant=minbase --include=git bookworm "$root" >"$root.log" 2>&1 ||
    die "debootstrap failed; see $root.log"
carry_network_settings
git clone --quiet "$source" "$root/root/vdna"

before=$(du -sxm "$root" | cut -f1)
start=$(date +%s)
status=0
in_root ./dev "$@" || status=$?
echo "newcomer.sh: ./dev $* took $(($(date +%s) - start)) s and" \
    "$(($(du -sxm "$root" | cut -f1) - before)) MB, and ended with status $status"
exit $status
