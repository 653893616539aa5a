// SPDX-License-Identifier: MIT
// The numbers that a glTF accessor means: where they lie, with every bound checked first, and what they are.
#pragma once
#include <crofton/core/error.hpp>
#include <cstdint>
#include <span>
#include <vector>

namespace crofton::assets {

// Constants of the glTF 2.0 specification.
enum GltfComponent : int {
    kGltfByte = 5120,
    kGltfUnsignedByte = 5121,
    kGltfShort = 5122,
    kGltfUnsignedShort = 5123,
    kGltfInt = 5124,
    kGltfUnsignedInt = 5125,
    kGltfFloat = 5126,
    kGltfDouble = 5130
};
enum GltfMode : int { kGltfTriangles = 4, kGltfTriangleStrip = 5, kGltfTriangleFan = 6 };

// As the file tells it: nothing of it need be true.
struct ElementLayout {
    std::span<const unsigned char> buffer;
    std::size_t view_offset = 0, view_length = 0, view_stride = 0;  // 0: elements follow one another
    std::size_t offset = 0, count = 0;
    int component_type = 0, components = 0;
    bool normalized = false;
};

// Elements that are there.
struct Elements {
    const unsigned char* data = nullptr;
    std::size_t count = 0, stride = 0;
    int component_type = 0, components = 0;
    bool normalized = false;
};

// Bytes of one component; 0 for what is no type.
[[nodiscard]] std::size_t component_size(int component_type);

// Errors: an element beyond its view, a view beyond its buffer, elements that overlap, none at all, unknown types.
[[nodiscard]] Result<Elements> place(const ElementLayout& layout);

// `components` floats per element; integers are normalised to [0, 1] or [−1, 1] where the accessor asks for it.
// Elements of more components are cut, of fewer (RGB for RGBA) filled with 1.
[[nodiscard]] std::vector<float> to_floats(const Elements& elements, int components);

// Errors: not unsigned scalars.
[[nodiscard]] Result<std::vector<std::uint32_t>> to_indices(const Elements& elements);

// Strips and fans as plain triangles; what is no triangles is nothing.
[[nodiscard]] std::vector<std::uint32_t> triangle_list(int mode, std::vector<std::uint32_t> indices);

}  // namespace crofton::assets
