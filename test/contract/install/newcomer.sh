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

[ $# -ge 1 ] || die "no folder is given; $usage"
source=$(git -C "$(dirname "$0")" rev-parse --show-toplevel)
bare_debian=$(dirname "$0")/bare_debian.sh
root=$1
shift
[ $# -gt 0 ] || set -- demo

echo "making a bare Debian 12 in $root ..."
"$bare_debian" make "$root" git
git clone --quiet "$source" "$root/root/vdna"

before=$(du -sxm "$root" | cut -f1)
start=$(date +%s)
status=0
"$bare_debian" run "$root" sh -c 'cd vdna && exec ./dev "$@"' sh "$@" || status=$?
echo "newcomer.sh: ./dev $* took $(($(date +%s) - start)) s and" \
    "$(($(du -sxm "$root" | cut -f1) - before)) MB, and ended with status $status"
exit $status
