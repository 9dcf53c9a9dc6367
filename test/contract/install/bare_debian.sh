#!/bin/sh
# A bare Debian 12 in a folder: make one, and run commands in it. It needs root, debootstrap and, to
# be made, the network.
set -eu

usage="usage: test/contract/install/bare_debian.sh make DIR [PACKAGE]
       test/contract/install/bare_debian.sh run DIR COMMAND [ARG...]
       test/contract/install/bare_debian.sh boot DIR
  make a bare Debian 12 (with PACKAGE) in the new folder DIR, its log in DIR.log; run a command in it;
  boot it: run its systemd as process 1, with a network of its own, until a signal ends it"

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

# The cgroup hierarchies in which systemd keeps its units: the one of version 2, or one by its name.
hierarchies()
{
    for folder in /sys/fs/cgroup /sys/fs/cgroup/unified /sys/fs/cgroup/systemd; do
        [ ! -e "$folder/cgroup.procs" ] || echo "$folder"
    done
}

boot()
{
    group=vdna-boot-$$
    # shellcheck disable=SC2016,SC2046 # expanded by the inner shells; words
    sh -euc '
        group=$1 root=$2
        shift 2
        for hierarchy; do
            mkdir "$hierarchy/$group"
            echo $$ >"$hierarchy/$group/cgroup.procs"
        done
        exec unshare --mount --pid --uts --ipc --net --cgroup --fork --kill-child sh -euc "$inner" sh "$root"
    ' sh "$group" "$root" $(hierarchies) &
    child=$!
    trap 'kill -KILL "$child" 2>/dev/null || :' TERM INT # unshare heeds no other
    status=0
    wait "$child" || status=$?
    wait "$child" || :
    # The kernel ends the last processes in its own time.
    for hierarchy in $(hierarchies); do
        until find "$hierarchy/$group" -depth -type d -exec rmdir {} + 2>/dev/null; do
            sleep 0.1
        done
    done
    return "$status"
}
# shellcheck disable=SC2016,SC2089 # expanded by the inner shell
inner='
    root=$1
    ip link set lo up
    ip route add 224.0.0.0/4 dev lo
    mount --bind "$root" "$root"
    mount -t proc proc "$root/proc"
    # Settings of the kernel and devices are this machine too: systemd may change none.
    mount --bind "$root/proc/sys" "$root/proc/sys"
    mount -o remount,bind,ro "$root/proc/sys"
    mount -t sysfs -o ro sysfs "$root/sys"
    mount -t tmpfs tmpfs "$root/run"
    mount -t tmpfs tmpfs "$root/tmp"
    mount -t tmpfs tmpfs "$root/dev"
    mkdir "$root/dev/shm" "$root/dev/pts"
    mount -t devpts -o newinstance,ptmxmode=666 devpts "$root/dev/pts"
    ln -s pts/ptmx "$root/dev/ptmx"
    while read -r device major minor; do
        mknod -m 666 "$root/dev/$device" c "$major" "$minor"
    done <<END
null 1 3
zero 1 5
full 1 7
random 1 8
urandom 1 9
tty 5 0
console 1 3
END
    if [ -e /sys/fs/cgroup/cgroup.procs ]; then
        mount -t cgroup2 cgroup2 "$root/sys/fs/cgroup"
    else
        mount -t tmpfs tmpfs "$root/sys/fs/cgroup"
        mkdir "$root/sys/fs/cgroup/systemd"
        mount -t cgroup -o none,name=systemd cgroup "$root/sys/fs/cgroup/systemd"
    fi
    cd "$root"
    pivot_root . mnt
    umount --lazy /mnt
    exec env -i container=vdna PATH=/usr/sbin:/usr/bin:/sbin:/bin /lib/systemd/systemd --system
'
# shellcheck disable=SC2090
export inner

[ $# -ge 2 ] || die "a command and a folder are expected; $usage"
[ "$(id -u)" -eq 0 ] || die "only root can make and enter a new root; run it with sudo"
command -v debootstrap >/dev/null || die "debootstrap is missing; apt-get install debootstrap"
command=$1
root=$(realpath -m "$2")
shift 2
case $command in
make) make "$@" ;;
run) run "$@" ;;
boot) boot ;;
*) die "there is no command $command; $usage" ;;
esac
