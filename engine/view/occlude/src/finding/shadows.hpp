// SPDX-License-Identifier: MIT
// Shadows along fixed directions as bits, to estimate the mean shadow of a union.
#pragma once
#include <array>
#include <crofton/core/memory.hpp>
#include <crofton/geometry/box.hpp>
#include <crofton/geometry/shapes.hpp>
#include <cstddef>
#include <cstdint>
#include <glm/vec2.hpp>

namespace crofton::occlude {

// The fifteen two-fold axes of an icosahedron, each seen from both ends: of a flat patch the mean over them is within
// 2 % of A/2.
inline constexpr std::size_t kShadowAxes = 15;
inline constexpr std::size_t kShadowRows = 64;

// Bit x of row y: the cell's centre is in the shadow. For each axis as seen from its positive, then its negative end.
struct ShadowBits {
    std::array<std::uint64_t, 2 * kShadowAxes * kShadowRows> rows{};
};

// Casts shadows of triangles: of those whose front is seen, or of all.
class ShadowCaster {
  public:
    explicit ShadowCaster(const Aabb& bounds);  // of all that is drawn; not empty

    void draw(const Triangle& triangle, bool front_only, ShadowBits& bits) const;
    [[nodiscard]] double mean_area(const ShadowBits& bits) const;
    // Returns the mean area that `bits` has beyond `covered`.
    [[nodiscard]] double mean_area_beyond(const ShadowBits& bits, const ShadowBits& covered) const;

  private:
    struct View {
        glm::dvec3 right{0.0}, up{0.0};  // scaled to cells
        glm::dvec2 low{0.0};
        double cell_area = 0.0;
    };
    glm::dvec3 origin_;
    std::array<View, kShadowAxes> views_;
};

}  // namespace crofton::occlude
