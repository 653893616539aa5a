#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Writes the manual pages of the command line and of each of its commands: manual_pages.sh PROGRAM FOLDER
set -euo pipefail
program=$(realpath "$1") folder=$2
mkdir -p "$folder"
date=$(date --utc --date="@${SOURCE_DATE_EPOCH:-$(date +%s)}" +%F)
page() { # NAME ONE-LINE-TEXT ARGUMENT…
    local name=$1 text=$2
    shift 2
    # Examples stay as they are, line by line: help2man takes some for headings and runs the others together.
    printf '#!/bin/sh\n"%s" %s "$@" | sed "/^Examples:/,/^$/d"\n' "$program" "$*" >"$folder/run"
    chmod +x "$folder/run"
    { printf '[EXAMPLES]\n.nf\n' && "$program" "$@" --help | sed -n '/^Examples:/,/^$/{s/\\/\\\\/g;s/-/\\-/g;s/^  *//p}' && echo .fi; } >"$folder/examples"
    local include=(--include="$folder/examples")
    [[ $(wc -l <"$folder/examples") -gt 3 ]] || include=()
    help2man --no-info --no-discard-stderr --section=1 --name="$text" --version-string="$("$program" --version)" \
        --source=Crofton --manual="Crofton's commands" "${include[@]}" "$folder/run" |
        sed -e "s/^\.TH [^ ]* \(\S*\) \"[^\"]*\"/.TH ${name^^} \1 \"$date\"/" -e "/^\.SH NAME/{n;s/^[^ ]*  */$name /}" >"$folder/$name.1"
    rm "$folder/run" "$folder/examples"
}
page crofton "frustum culling, collision detection and triangle counts by integral geometry"
commands_of() { # ARGUMENT…: a name and a text on each line
    "$program" "$@" --help | sed -n '/^Subcommands:/,$s/^  \([a-z]*\)  *\(.*\)/\1 \2/p'
}
commands_of | while read -r command text; do
    page "crofton-$command" "$text" "$command"
done
commands_of study | while read -r command text; do
    page "crofton-study-$command" "$text" study "$command"
done
