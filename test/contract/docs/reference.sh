#!/bin/sh
# reference.sh COMMAND...: fails if COMMAND, which runs Doxygen, does, or if a public header lacks the
# @file without which Doxygen passes over all of it in silence. Exit code 77 = skipped.
set -eu
command -v doxygen >/dev/null || { echo "skipped: no doxygen; ./dev test --all installs it"; exit 77; }
"$@"
for header in lib/include/vdna/*.h; do
    grep -q "^/\*\* @file vdna/${header##*/}\$" "$header" || {
        echo "$header: expected it to begin with /** @file vdna/${header##*/}" >&2
        exit 1
    }
done
