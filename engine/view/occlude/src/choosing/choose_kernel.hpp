// SPDX-License-Identifier: MIT
// Estimates how much of a view candidates cover, many at a time.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

namespace crofton::occlude {

struct ChooseView {
    std::array<float, 3> eye{};                    // relative to the candidates' origin
    std::array<float, 3> forward{};                // of unit length
    std::array<std::array<float, 4>, 6> planes{};  // inward normals; of the eye's frame
    std::size_t plane_count = 0;
    bool perspective = true;
    float scale = 1.0f;         // of what is covered: 1 / 4π, or one over the picture's area
    float least = 0.0f;         // to be covered
    float large_square = 0.0f;  // parallel views: what looks large has a radius whose square is above this
    bool bounded = false;
    std::array<float, 3> low{}, high{};  // of the objects, relative to the candidates' origin
};

// Writes the ids of those in view that cover at least `least` to `seen`. `values` gets what they cover, times the way
// behind them where that is bounded. If one ray does not decide, of those that look large or have nothing behind their
// centers, it gets what they cover with a minus sign. Both have room for all. Returns their number. Same bits for any
// instruction set.
std::size_t measure_cover(const float* const* columns, std::size_t count, const ChooseView& view, std::uint32_t* seen,
                          float* values);

}  // namespace crofton::occlude
