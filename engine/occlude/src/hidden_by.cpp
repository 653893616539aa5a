// SPDX-License-Identifier: MIT
// Which occluders hide a box: each is drawn again, alone, where the box is.
#include <algorithm>
#include <cmath>
#include <crofton/occlude/occlusion.hpp>

#include "buffer_data.hpp"
#include "draw_kernel.hpp"

namespace crofton::occlude {
namespace {

// The pixels of a box's rectangle, the last one included.
struct Window {
    std::uint32_t x0, y0, x1, y1;
};

Window window_of(const PixelMap& map, const Obb& box) {
    double low[2] = {HUGE_VAL, HUGE_VAL}, high[2] = {-HUGE_VAL, -HUGE_VAL};
    for (const glm::dvec3& corner : corners(box)) {
        double form[3];
        for (std::size_t r = 0; r < 3; ++r) {
            form[r] = map.form[r][3];
            for (int k = 0; k < 3; ++k)
                form[r] +=
                    map.form[r][static_cast<std::size_t>(k)] * (corner[k] - map.origin[static_cast<std::size_t>(k)]);
        }
        for (std::size_t r = 0; r < 2; ++r) {
            const double at = form[r] / form[2] + (r == 0 ? map.half_width : map.half_height);
            low[r] = std::min(low[r], at);
            high[r] = std::max(high[r], at);
        }
    }
    const auto pixel = [](double v, std::uint32_t size) {
        return static_cast<std::uint32_t>(std::clamp(std::floor(v), 0.0, size - 1.0));
    };
    return {pixel(low[0], map.width), pixel(low[1], map.height), pixel(high[0], map.width), pixel(high[1], map.height)};
}

}  // namespace

void OcclusionBuffer::hidden_by(const Obb& box, Vector<OccluderId>& ids) const {
    ids.clear();
    if (!hides(box)) return;
    const Data& data = *data_;
    const Window window = window_of(data.map, box);
    const std::uint32_t first = window.y0 / kTile, end = window.y1 / kTile + 1;
    const std::size_t tiles = std::size_t{end - first} * data.tile_columns;
    const float* const stored = data.pixels.data() + std::size_t{first} * data.tile_columns * kTilePixels;
    Vector<float> alone(tiles * kTilePixels), least(tiles);
    const auto add_if_stored = [&](OccluderId id) {
        for (std::uint32_t y = window.y0; y <= window.y1; ++y)
            for (std::uint32_t x = window.x0; x <= window.x1; ++x) {
                const std::size_t tile = std::size_t{y / kTile - first} * data.tile_columns + x / kTile;
                const std::size_t at = tile * kTilePixels + y % kTile * kTile + x % kTile;
                if (alone[at] > kUncovered && alone[at] == stored[at]) return ids.push_back(id);
            }
    };
    const DrawTarget target{alone.data(), least.data(), data.size.width, data.tile_columns, first, end};
    for (const Data::Order& entry : data.order) {
        std::fill(alone.begin(), alone.end(), kUncovered);
        std::fill(least.begin(), least.end(), kUncovered);
        const PreparedBodies& bodies = data.chunks[entry.chunk];
        const PreparedBody& body = bodies.bodies[entry.body];
        draw_body_kernel({&body, bodies.sides.data() + body.first_side, bodies.planes.data() + body.first_plane},
                         target);
        add_if_stored(body.occluder);
    }
    for (std::size_t c = 0; c < data.chunk_count; ++c)
        for (const PreparedPatch& patch : data.chunks[c].patches) {
            std::fill(alone.begin(), alone.end(), kUncovered);
            const std::uint32_t columns = patch.end_column - patch.first_column;
            for (std::uint32_t row = std::max(first, patch.first_row); row < std::min(end, patch.end_row); ++row)
                std::copy_n(
                    data.chunks[c].values.data() + patch.first_value +
                        std::size_t{row - patch.first_row} * columns * kTilePixels,
                    columns * kTilePixels,
                    alone.data() + (std::size_t{row - first} * data.tile_columns + patch.first_column) * kTilePixels);
            add_if_stored(patch.occluder);
        }
    std::sort(ids.begin(), ids.end());
    ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
}

}  // namespace crofton::occlude
