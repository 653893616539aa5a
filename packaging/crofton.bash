# SPDX-License-Identifier: MIT
# Completion for bash: commands, options and their values are read from the program's own --help.
# Values of an option, or of the arguments for an empty one: {fast,tight,exact}, volume | area, or the names of built-in scenes. Fails where it may
# be a file as well.
_crofton_values() {
    awk -v option="$1" -v files=1 'function said(   part, word, n, i) {
    n = split(line, word, /[ ,]+/)
    if (option == "" ? within == "Positionals:" : word[2] == option || word[3] == option) {
        if (match(line, /\{[a-z,_-]+\}/)) { files = 0; n = split(substr(line, RSTART + 1, RLENGTH - 2), part, ","); for (i = 1; i <= n; ++i) print part[i] }
        else if ((n = split(line, part, " [|] ")) > 1) for (i = 1; i <= n; ++i) { split(part[i], word, " "); sub(/.* /, "", part[1]); if (i == 1) word[1] = part[1]; sub(/:.*/, ":", word[1]); sub(/[,;]$/, "", word[1]); print word[1] }
        else if (option == "" && match(line, /town, [a-z, ]*hall/)) { n = split(substr(line, RSTART, RLENGTH), part, ", "); for (i = 1; i <= n; ++i) print part[i] }
    }
    if (line ~ /^[A-Z]/) within = line
}
/^                    / { sub(/^ +/, " "); line = line $0; next } { said(); line = $0 } END { said(); exit files }'
}
_crofton() {
    local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]} first=1
    local command=("${COMP_WORDS[1]}")
    if [[ ${COMP_WORDS[1]} == study ]]; then first=2 command=(study "${COMP_WORDS[2]-}"); fi
    if ((COMP_CWORD <= first)); then
        local commands
        commands=$("${COMP_WORDS[0]}" "${command[@]:0:COMP_CWORD - 1}" --help 2>/dev/null | sed -n '/^Subcommands:/,$s/^  \([a-z]*\) .*/\1/p')
        mapfile -t COMPREPLY < <(compgen -W "$commands --help --version" -- "$word")
    elif [[ $word == -* ]]; then
        local options
        options=$("${COMP_WORDS[0]}" "${command[@]}" --help 2>/dev/null | grep -oE '^ +(-[a-z],)?--[a-z-]+' | grep -oE '\-\-[a-z-]+')
        mapfile -t COMPREPLY < <(compgen -W "$options" -- "$word")
    else
        local values
        [[ $before == -* ]] || before=
        values=$("${COMP_WORDS[0]}" "${command[@]}" --help 2>/dev/null | _crofton_values "$before")
        local -i files=$?
        mapfile -t COMPREPLY < <(compgen -W "$values" -- "$word")
        [[ ${#COMPREPLY[@]} != 1 || ${COMPREPLY[0]} != *: ]] || compopt -o nospace 2>/dev/null  # rays: goes on
        ((files == 0)) || mapfile -t -O "${#COMPREPLY[@]}" COMPREPLY < <(compgen -f -- "$word")
    fi
}
complete -o filenames -F _crofton crofton
