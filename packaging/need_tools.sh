# SPDX-License-Identifier: MIT
# For other scripts: need_tools NAME OPTION TOOL... says so and ends the script, without an error, where a tool is missing.
need_tools() {
    local name=$1 option=$2 tool
    shift 2
    for tool in "$@"; do
        if ! command -v "$tool" >/dev/null; then
            echo "$name: skipped, no $tool here; third_party/install.sh $option installs it"
            exit 0
        fi
    done
}
