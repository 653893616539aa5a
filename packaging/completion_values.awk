# Prints the values of an option, or of the arguments where `option` is empty, as --help names them: {fast,tight,exact},
# volume | area, or the names of built-in scenes. The exit status is `files`, or 0 where no file can be meant.
function said(   part, word, value, n, i) {
    split(line, word, /[ ,]+/)
    if (option == "" ? within == "Positionals:" : word[2] == option || word[3] == option) {
        if (match(line, /\{[a-z,_-]+\}/)) {
            files = 0
            n = split(substr(line, RSTART + 1, RLENGTH - 2), part, ",")
            for (i = 1; i <= n; ++i) print part[i]
        } else if ((n = split(line, part, " [|] ")) > 1) {
            for (i = 1; i <= n; ++i) {
                split(part[i], word, " ")
                value = word[1]
                if (i == 1) { value = part[1]; sub(/.* /, "", value) }
                sub(/:.*/, ":", value)
                sub(/[,;]$/, "", value)
                print value
            }
        } else if (option == "" && match(line, /town, [a-z, ]*hall/)) {
            n = split(substr(line, RSTART, RLENGTH), part, ", ")
            for (i = 1; i <= n; ++i) print part[i]
        }
    }
    if (line ~ /^[A-Z]/) within = line
}
/^                    / { sub(/^ +/, " "); line = line $0; next }
{ said(); line = $0 }
END { said(); exit files }
