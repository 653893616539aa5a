# SPDX-License-Identifier: MIT
# Wraps glslangValidator's array of words into a header of ours: constants in crofton::render::shaders.
file(READ "${INPUT}" words)
string(REPLACE "const uint32_t" "inline constexpr std::uint32_t" words "${words}")
file(WRITE "${OUTPUT}" "#pragma once\n#include <cstdint>\nnamespace crofton::render::shaders {\n${words}\n}\n")
