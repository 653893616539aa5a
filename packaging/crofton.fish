# SPDX-License-Identifier: MIT
# Completion for fish: commands, options and their values, with what they do, are read from the program's own --help.
function __crofton_words
    set -l words (commandline -opc)
    if test (count $words) -ge 2 -a "$words[2]" = study
        printf '%s\n' $words[1..(math min 3, (count $words))]
    else
        printf '%s\n' $words[1..(math min 2, (count $words))]
    end
end
function __crofton_commands
    set -l words (__crofton_words)
    $words --help 2>/dev/null | sed -n '/^Subcommands:/,$s/^  \([a-z]*\)  *\(.*\)/\1\t\2/p'
    printf '%s\t%s\n' --help 'print the help' --version 'print the version'
end
function __crofton_needs_command
    set -l words (commandline -opc)
    test (count $words) -eq 1; or test (count $words) -eq 2 -a "$words[2]" = study
end
# What an option does may stand on the next line, which begins far to the right.
function __crofton_options
    set -l words (__crofton_words)
    $words --help 2>/dev/null | awk '/^                    / { sub(/^ +/, "  "); printf "%s", $0; next } { printf "%s%s", (NR > 1 ? "\n" : ""), $0 } END { print "" }' |
        sed -nE 's/^ +(-[a-z],)?(--[a-z-]+)(.*  )?(.*)$/\2\t\4/p'
end
# Values of the option before, or of the arguments: {fast,tight,exact}, volume | area, or the names of built-in scenes. Fails where it may
# be a file as well.
function __crofton_values
    set -l words (__crofton_words)
    set -l option (commandline -opc)[-1]
    string match -q -- '-*' $option; or set option ''
    $words --help 2>/dev/null | awk -v option="$option" -v files=1 'function said(   part, word, n, i) {
    n = split(line, word, /[ ,]+/)
    if (option == "" ? within == "Positionals:" : word[2] == option || word[3] == option) {
        if (match(line, /\{[a-z,_-]+\}/)) { files = 0; n = split(substr(line, RSTART + 1, RLENGTH - 2), part, ","); for (i = 1; i <= n; ++i) print part[i] }
        else if ((n = split(line, part, " [|] ")) > 1) for (i = 1; i <= n; ++i) { split(part[i], word, " "); sub(/.* /, "", part[1]); if (i == 1) word[1] = part[1]; sub(/:.*/, ":", word[1]); sub(/[,;]$/, "", word[1]); print word[1] }
        else if (option == "" && match(line, /town, [a-z, ]*hall/)) { n = split(substr(line, RSTART, RLENGTH), part, ", "); for (i = 1; i <= n; ++i) print part[i] }
    }
    if (line ~ /^[A-Z]/) within = line
}
/^                    / { sub(/^ +/, " "); line = line $0; next } { said(); line = $0 } END { said(); exit files }'
end
function __crofton_takes_files
    not __crofton_values >/dev/null
end
complete -c crofton -n __crofton_needs_command -f -a '(__crofton_commands)'
complete -c crofton -n 'not __crofton_needs_command; and string match -q -- "-*" (commandline -ct)' -f -a '(__crofton_options)'
complete -c crofton -n 'not __crofton_needs_command; and not __crofton_takes_files' -f -a '(__crofton_values)'
complete -c crofton -n 'not __crofton_needs_command; and __crofton_takes_files' -F -a '(__crofton_values)'
