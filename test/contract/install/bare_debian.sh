#!/bin/sh
# A bare Debian 12 in a folder: make one, and run commands in it. It needs root, debootstrap and, to
# be made, the network.
set -eu

usage="usage: test/contract/install/bare_debian.sh make DIR [PACKAGE]
       test/contract/install/bare_debian.sh run DIR COMMAND [ARG...]
  make a bare Debian 12 (with PACKAGE) in the new folder DIR, its log in DIR.log; run a command in it"

die()
{
    echo "bare_debian.sh: $*" >&2
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

# make [PACKAGE]
make()
{
    [ ! -e "$root" ] || die "$root exists; give a new folder or remove it"
    mkdir -p "$root"
    debootstrap --variant=minbase ${1:+"--include=$1"} bookworm "$root" >"$root.log" 2>&1 ||
        die "debootstrap failed; see $root.log"
    carry_network_settings
}

# Run a command in the root, in its /root, with a network environment like ours. The mounts and
# processes end with the namespaces. A real root and not a chroot, for in that the kernel refuses the
# user namespaces that the system tests use.
run()
{
    for name in $(env | sed -n 's/^\(PIP_[A-Z_]*\|[A-Za-z]*_proxy\|[A-Z]*_PROXY\)=.*/\1/p'); do
        eval "set -- \"$name=\$$name\" \"\$@\""
    done
    # shellcheck disable=SC2016 # expanded by the inner shell
    exec unshare --mount --pid --fork --kill-child sh -euc '
        root=$1
        shift
        mount --bind "$root" "$root"
        mount -t proc proc "$root/proc"
        mount --rbind /sys "$root/sys"
        mount --rbind /dev "$root/dev"
        cd "$root"
        pivot_root . mnt
        umount --lazy /mnt
        cd /root
        exec env -i "$@"
    ' sh "$root" HOME=/root LANG=C.UTF-8 TERM="${TERM:-dumb}" \
        PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin "$@"
}

[ $# -ge 2 ] || die "a command and a folder are expected; $usage"
[ "$(id -u)" -eq 0 ] || die "only root can make and enter a new root; run it with sudo"
command -v debootstrap >/dev/null || die "debootstrap is missing; apt-get install debootstrap"
command=$1
root=$(realpath -m "$2")
shift 2
case $command in
make) make "$@" ;;
run) run "$@" ;;
*) die "there is no command $command; $usage" ;;
esac
