// Which Crofton is linked, as opposed to which headers were compiled against.
#pragma once

namespace crofton {

struct Version {
    int major, minor, patch;
};

[[nodiscard]] Version version();
[[nodiscard]] const char* version_string();  // "major.minor.patch"

}  // namespace crofton
