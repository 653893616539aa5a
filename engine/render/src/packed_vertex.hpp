// SPDX-License-Identifier: MIT
// Vertices as the device reads them: of 20 bytes, not 36.
#pragma once
#include <algorithm>
#include <cmath>
#include <crofton/render/vertex.hpp>
#include <cstdint>

namespace crofton::render {

struct PackedVertex {
    glm::vec3 position;    // bit for bit: counts depend on it
    std::uint32_t normal;  // 10 bits a component, signed, x lowest
    std::uint32_t color;   // 10 bits a component, square roots of linear values from 0 to 1, red lowest
};
static_assert(sizeof(PackedVertex) == 20);

[[nodiscard]] inline PackedVertex packed(const Vertex& vertex) {
    PackedVertex result{vertex.position, 0, 0};
    for (int k = 0; k < 3; ++k) {
        // NaN becomes the lower end.
        const float direction = std::min(std::max(-1.0f, vertex.normal[k]), 1.0f);
        const float shown = std::sqrt(std::min(std::max(0.0f, vertex.color[k]), 1.0f));
        const auto component = static_cast<std::int32_t>(std::lround(511.0f * direction));
        result.normal |= (static_cast<std::uint32_t>(component) & 1023u) << (10 * k);
        result.color |= static_cast<std::uint32_t>(std::lround(1023.0f * shown)) << (10 * k);
    }
    return result;
}

}  // namespace crofton::render
