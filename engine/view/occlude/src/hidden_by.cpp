// SPDX-License-Identifier: MIT
// Finds the occluders that hide a box: draws each of them alone where the box is.
#include <algorithm>
#include <cmath>
#include <crofton/occlude/occlusion.hpp>

#include "buffer_data.hpp"
#include "draw_kernel.hpp"

namespace crofton::occlude {
namespace {

// A mapped box: pixels from the middle, and its nearness.
struct MappedBox {
    double x[8], y[8], nearness[8];
    double most_nearness = -HUGE_VAL;
};

MappedBox map_box(const PixelMap& map, const Obb& box) {
    MappedBox mapped;
    const auto all = corners(box);
    for (std::size_t i = 0; i < 8; ++i) {
        double form[4];
        for (std::size_t r = 0; r < 4; ++r) {
            form[r] = map.form[r][3];
            for (int k = 0; k < 3; ++k)
                form[r] +=
                    map.form[r][static_cast<std::size_t>(k)] * (all[i][k] - map.origin[static_cast<std::size_t>(k)]);
        }
        mapped.x[i] = form[0] / form[2];
        mapped.y[i] = form[1] / form[2];
        mapped.nearness[i] = form[3] / form[2];
        mapped.most_nearness = std::max(mapped.most_nearness, mapped.nearness[i]);
    }
    return mapped;
}

// The pixels of a box's rectangle, the last one included.
struct Window {
    std::uint32_t x0, y0, x1, y1;
};

Window window_of(const PixelMap& map, const MappedBox& box) {
    const auto pixel = [](double v, std::uint32_t size) {
        return static_cast<std::uint32_t>(std::clamp(std::floor(v), 0.0, size - 1.0));
    };
    return {pixel(*std::min_element(box.x, box.x + 8) + map.half_width, map.width),
            pixel(*std::min_element(box.y, box.y + 8) + map.half_height, map.height),
            pixel(*std::max_element(box.x, box.x + 8) + map.half_width, map.width),
            pixel(*std::max_element(box.y, box.y + 8) + map.half_height, map.height)};
}

// Tests the first `count` of the shadow's planes.
bool is_within(const MappedBox& box, const BodyShadow& shadow, std::uint32_t count) {
    for (std::uint32_t p = 0; p < count; ++p) {
        const float* const rows = shadow.groups + p / kShadowLanes * 4 * kShadowLanes + p % kShadowLanes;
        const auto part = [&](std::size_t k) { return static_cast<double>(rows[k * kShadowLanes]); };
        for (std::size_t i = 0; i < 8; ++i)
            if (!(part(0) * box.x[i] + part(1) * box.y[i] + part(2) > part(3) * box.nearness[i])) return false;
    }
    return count != 0;
}

}  // namespace

void OcclusionBuffer::hidden_by(const Obb& box, Vector<OccluderId>& ids) const {
    ids.clear();
    if (!hides(box)) return;
    const Data& data = *data_;
    const MappedBox mapped = map_box(data.map, box);
    for (std::size_t place = 0; place < data.order.size(); ++place)
        if (is_within(mapped, data.shadows[place], data.shadows[place].count))
            return ids.push_back(data.chunks[data.order[place].chunk].bodies[data.order[place].body].occluder);
    const Window window = window_of(data.map, mapped);
    const std::uint32_t first = window.y0 / kTile, end = window.y1 / kTile + 1;
    const std::size_t tiles = std::size_t{end - first} * data.tile_columns;
    const float* const stored = data.pixels.data() + std::size_t{first} * data.tile_columns * kTilePixels;
    Vector<float> alone(tiles * kTilePixels), least(tiles), front(tiles);
    Vector<TileCovers> covers(tiles);
    // Its depth is stored; or the stored depth does not suffice, and the box is behind this one.
    const auto add_if_needed = [&](OccluderId id, bool behind) {
        for (std::uint32_t y = window.y0; y <= window.y1; ++y)
            for (std::uint32_t x = window.x0; x <= window.x1; ++x) {
                const std::size_t tile = std::size_t{y / kTile - first} * data.tile_columns + x / kTile;
                const std::size_t at = tile * kTilePixels + y % kTile * kTile + x % kTile;
                const bool farther = static_cast<double>(stored[at]) <= mapped.most_nearness * (1.0 + 0x1p-16);
                if (alone[at] > kUncovered && (alone[at] == stored[at] || (behind && farther)))
                    return ids.push_back(id);
            }
    };
    const DrawTarget target{alone.data(),    least.data(),      covers.data(), front.data(),
                            data.size.width, data.tile_columns, first,         end};
    for (std::size_t place = 0; place < data.order.size(); ++place) {
        const Data::Order& entry = data.order[place];
        std::fill(alone.begin(), alone.end(), kUncovered);
        std::fill(least.begin(), least.end(), kUncovered);
        const PreparedBodies& bodies = data.chunks[entry.chunk];
        const PreparedBody& body = bodies.bodies[entry.body];
        draw_body_kernel({&body, bodies.sides.data() + body.first_side, bodies.planes.data() + body.first_plane, 0},
                         target);
        add_if_needed(body.occluder, is_within(mapped, data.shadows[place], data.shadows[place].faces));
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
            add_if_needed(patch.occluder, false);
        }
    std::sort(ids.begin(), ids.end());
    ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
}

}  // namespace crofton::occlude
