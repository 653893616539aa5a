// SPDX-License-Identifier: MIT
// Numbers out of a glTF file's buffers, with every bound checked first.
#pragma once
#include <crofton/core/error.hpp>
#include <cstdint>
#include <vector>

namespace tinygltf {
class Model;
}

namespace crofton::assets {

// `components` floats per element; integers are normalised to [0, 1] or [−1, 1] where the accessor asks for it.
// Elements of more components are cut, of fewer (RGB for RGBA) filled with 1. Errors: no such accessor, view or buffer;
// an element beyond its view or a view beyond its buffer; unknown types; sparse accessors (unsupported).
[[nodiscard]] Result<std::vector<float>> read_floats(const tinygltf::Model& model, int accessor, int components);

// Unsigned scalars.
[[nodiscard]] Result<std::vector<std::uint32_t>> read_indices(const tinygltf::Model& model, int accessor);

}  // namespace crofton::assets
