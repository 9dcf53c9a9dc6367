#!/bin/sh
# prove.sh FUNCTIONS FILE [OPTION...]: proves the ACSL contracts of functions, and the lemmas of their
# file, with Frama-C and CVC4: every access is in bounds, no sum overflows, every loop ends, the result
# is the one stated. Exit code 77 = skipped: no such tools.
set -eu
for tool in frama-c why3 cvc4; do
    command -v $tool >/dev/null || { echo "skipped: no $tool; ./dev test --all installs it"; exit 77; }
done
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
export WHY3CONFIG="$folder/why3.conf"
why3 -C "$WHY3CONFIG" config detect >/dev/null 2>&1

# prove OPTION...: the limit is in steps, not seconds, so that a busy machine proves as much as an idle one
prove()
{
    frama-c -cpp-extra-args="-I lib/include" -wp -wp-rte -wp-prover cvc4 -wp-steps 20000000 \
        -wp-timeout 300 -wp-par 2 "$@" | tee "$folder/log"
    grep -Eq 'Proved goals: +([0-9]+) / \1$' "$folder/log"
}

functions=$1 file=$2
shift 2
prove "$file" -wp-fct "$functions" "$@"
# The proofs above take lemmas as given.
! grep -q lemma "$file" || prove "$file" -wp-prop=@lemma
