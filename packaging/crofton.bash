# SPDX-License-Identifier: MIT
# Completion for bash: commands and options are read from the program's own --help.
_crofton() {
    local word=${COMP_WORDS[COMP_CWORD]} first=1
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
        # Choices of the option before, as {fast,tight,exact}; else files.
        local choices
        choices=$("${COMP_WORDS[0]}" "${command[@]}" --help 2>/dev/null | grep -E -- "^ +(-[a-z],)?${COMP_WORDS[COMP_CWORD - 1]} " |
            grep -oE '\{[a-z,_-]+\}' | tr -d '{}' | tr ',' ' ')
        if [[ ${COMP_WORDS[COMP_CWORD - 1]} == --* && -n $choices ]]; then
            mapfile -t COMPREPLY < <(compgen -W "$choices" -- "$word")
        else
            mapfile -t COMPREPLY < <(compgen -f -- "$word")
        fi
    fi
}
complete -o filenames -F _crofton crofton
