# SPDX-License-Identifier: MIT
# Completion for fish: commands and options, with what they do, are read from the program's own --help.
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
function __crofton_options
    set -l words (__crofton_words)
    $words --help 2>/dev/null | sed -nE 's/^ +(-[a-z],)?(--[a-z-]+)[^ ]*( [^ ]+)*  +(.*)$/\2\t\4/p; s/^ +(-[a-z],)?(--[a-z-]+) [^ ]+ Needs:.*$/\2/p'
end
# Choices of the option before, as {fast,tight,exact}.
function __crofton_choices
    set -l words (__crofton_words)
    set -l option (commandline -opc)[-1]
    string match -q -- '--*' $option; or return 1
    $words --help 2>/dev/null | grep -E -- "^ +(-[a-z],)?$option " | grep -oE '\{[a-z,_-]+\}' | tr -d '{}' | tr ',' '\n'
end
complete -c crofton -n __crofton_needs_command -f -a '(__crofton_commands)'
complete -c crofton -n 'not __crofton_needs_command; and string match -q -- "-*" (commandline -ct)' -f -a '(__crofton_options)'
complete -c crofton -n 'not __crofton_needs_command; and count (__crofton_choices) >/dev/null' -f -a '(__crofton_choices)'
complete -c crofton -n 'not __crofton_needs_command; and not count (__crofton_choices) >/dev/null' -F
