#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# What bash completes: crofton.bash is sourced and its function called as bash would. Fish is asked itself, where it is installed.
#   tests/samples/cli/completion_test.sh FOLDER SCRIPTS    folders of the program `crofton` and of the completion scripts
set -uo pipefail
cd "$(dirname "$0")/../../.."
if ((BASH_VERSINFO[0] < 4)); then
    echo "skipped: bash is older than 4"
    exit 0
fi
PATH=$1:$PATH LC_ALL=C
scripts=$2
export PATH LC_ALL
bash -n "$scripts/crofton.bash" || exit 1
source "$scripts/crofton.bash"

# completed WORD…: what is offered for the last of these words, in one line and in order.
completed() {
    COMP_WORDS=("$@")
    COMP_CWORD=$(($# - 1))
    COMPREPLY=()
    _crofton
    printf '%s\n' "${COMPREPLY[@]}" | sort | paste -sd' '
}

failed=0
# expect WANTED WORD…
expect() {
    local wanted=$1 found
    shift
    found=$(completed "$@")
    [[ $found == "$wanted" ]] && return
    echo "\`$*\` is completed to '$found', not to '$wanted'"
    failed=1
}

expect frames crofton fr
expect merge crofton me
expect measure crofton study me
expect '--lines' crofton study measure room --li
expect '--help --version' crofton --
expect '' crofton nothing
expect '--trace --tree' crofton frames --tr
expect '--trace' crofton frames town --frames 3 --trac
expect 'exact fast tight' crofton fit --quality ''
expect 'tight' crofton fit --quality ti
expect 'README.md' crofton frames READ
expect 'town' crofton frames to
expect 'collide convex cull lines occlude paper pvs' crofton verify ''
expect 'partner:' crofton fit --criterion part
expect 'delaunay' crofton triangulate --method de
expect 'random' crofton frames --camera ra
expect 'occluders' crofton frames --occlude --occlusion oc
expect '' crofton nothing --tr
# Each command of the help is offered, and each has options.
for command in $(crofton --help | sed -n '/^Subcommands:/,$s/^  \([a-z]*\) .*/\1/p'); do
    expect "$command" crofton "$command"
    [[ " $(completed crofton "$command" --) " == *' --help '* ]] || { echo "$command: no options are offered"; failed=1; }
done
[[ $(complete -p crofton) == *_crofton* ]] || { echo 'the function is not registered'; failed=1; }
if command -v fish >/dev/null; then
    # fish WANTED LINE: the first word of each line that fish offers.
    in_fish() {
        local found
        found=$(fish --no-config -c 'source $argv[1]; complete -C $argv[2]' "$scripts/crofton.fish" "$2" | cut -f1 | sort -u | paste -sd' ')
        [[ $found == "$1" ]] && return
        echo "fish completes \`$2\` to '$found', not to '$1'"
        failed=1
    }
    in_fish frames 'crofton fr'
    in_fish measure 'crofton study me'
    in_fish '--trace --tree' 'crofton frames --tr'
    in_fish 'exact fast tight' 'crofton fit --quality '
    in_fish README.md 'crofton frames READ'
    in_fish 'partner:' 'crofton fit --criterion part'
    in_fish 'collide convex cull lines occlude paper pvs' 'crofton verify '
    in_fish '--quality' 'crofton fit --qual'
fi
exit $failed
