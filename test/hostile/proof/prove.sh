#!/bin/sh
# prove.sh FUNCTIONS FILE [OPTION...]: proves the ACSL contracts of functions with Frama-C and CVC4: every
# access is in bounds, no sum overflows, every loop ends. Exit code 77 = skipped: no such tools.
set -eu
for tool in frama-c why3 cvc4; do
    command -v $tool >/dev/null || { echo "skipped: no $tool; ./dev test installs it"; exit 77; }
done
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
export WHY3CONFIG="$folder/why3.conf"
why3 -C "$WHY3CONFIG" config detect >/dev/null 2>&1

# The limit is in steps, not seconds, so that a busy machine proves as much as an idle one.
frama-c -cpp-extra-args="-I lib/include" -wp -wp-rte -wp-prover cvc4 -wp-steps 20000000 \
    -wp-timeout 300 -wp-par 2 -wp-fct "$@" | tee "$folder/log"
grep -Eq 'Proved goals: +([0-9]+) / \1$' "$folder/log"
