// SPDX-License-Identifier: MIT
#include <algorithm>
#include <bit>
#include <cmath>
#include <crofton/core/error.hpp>
#include <crofton/cull/classify.hpp>
#include <crofton/occlude/occlusion.hpp>
#include <string>

#include "buffer_data.hpp"
#include "draw_kernel.hpp"
#include "occluder_storage.hpp"
#include "query_view.hpp"

namespace crofton::occlude {
namespace {

constexpr std::size_t kPrepareGrain = 64;  // occluders
constexpr std::size_t kQueryGrain = 1024;  // boxes; a multiple of 64

DrawBody draw_body_of(const OcclusionBuffer::Data& data, std::size_t place) {
    const OcclusionBuffer::Data::Order& entry = data.order[place];
    const PreparedBodies& bodies = data.chunks[entry.chunk];
    const PreparedBody& body = bodies.bodies[entry.body];
    return {&body, bodies.sides.data() + body.first_side, bodies.planes.data() + body.first_plane,
            static_cast<std::uint32_t>(place)};
}

// Prepares the chosen occluders, or all if none are chosen.
void prepare_range(const PixelMap& map, const OccluderSet& set, const OccluderId* chosen, std::size_t begin,
                   std::size_t end, PreparedBodies& out) {
    out.clear();
    const auto shapes = OccluderStorage::shapes(set);
    const auto& occluders = OccluderStorage::occluders(set);
    for (std::size_t i = begin; i < end; ++i) {
        const auto id = chosen ? chosen[i] : static_cast<OccluderId>(i);
        const Occluder& occluder = occluders[id];
        if (!occluder.enabled) continue;
        if (occluder.shape == kNone)
            prepare_box(map, occluder.box, id, out);
        else if (shapes[occluder.shape].convex)
            prepare_convex(map, shapes[occluder.shape], occluder.transform, occluder.mirrored, id, out);
        else
            prepare_mesh(map, shapes[occluder.shape], occluder.transform, occluder.mirrored, id, out);
    }
}

void sort_front_to_back(OcclusionBuffer::Data& data, std::size_t chunks) {
    data.order.clear();
    for (std::uint32_t c = 0; c < chunks; ++c)
        for (std::uint32_t b = 0; b < data.chunks[c].bodies.size(); ++b)
            data.order.push_back({data.chunks[c].bodies[b].most_nearness, c, b});
    std::sort(data.order.begin(), data.order.end(), [](const auto& a, const auto& b) {
        if (a.most_nearness != b.most_nearness) return a.most_nearness > b.most_nearness;
        return a.chunk != b.chunk ? a.chunk < b.chunk : a.body < b.body;
    });
    data.shadows.clear();
    for (const OcclusionBuffer::Data::Order& entry : data.order) {
        const PreparedBodies& bodies = data.chunks[entry.chunk];
        const PreparedBody& body = bodies.bodies[entry.body];
        data.shadows.push_back(
            {bodies.shadows.data() + 4 * kShadowLanes * body.first_shadow, body.plane_count, body.shadow_count});
    }
}

// Keeps the nearer depth in each tile of the patch in rows [first, end).
void merge_patch(OcclusionBuffer::Data& data, const PreparedBodies& bodies, const PreparedPatch& patch,
                 std::uint32_t first, std::uint32_t end) {
    const std::uint32_t columns = patch.end_column - patch.first_column;
    for (std::uint32_t row = std::max(first, patch.first_row); row < std::min(end, patch.end_row); ++row)
        for (std::uint32_t column = patch.first_column; column < patch.end_column; ++column) {
            const std::size_t from = std::size_t{row - patch.first_row} * columns + column - patch.first_column;
            if (bodies.reached[patch.first_value / kTilePixels + from] == 0) continue;
            const std::size_t to = std::size_t{row} * data.tile_columns + column;
            const float* const values = bodies.values.data() + patch.first_value + from * kTilePixels;
            float* const pixels = data.pixels.data() + to * kTilePixels;
            float least = 3e38f, most = kUncovered;
            for (std::size_t i = 0; i < kTilePixels; ++i) {
                pixels[i] = pixels[i] > values[i] ? pixels[i] : values[i];
                least = least < pixels[i] ? least : pixels[i];
                most = most > values[i] ? most : values[i];
            }
            data.least[to] = least;
            data.front[to] = std::max(data.front[to], most);
        }
}

void draw_band(OcclusionBuffer::Data& data, std::size_t chunks, std::uint32_t first, std::uint32_t end) {
    float* const pixels = data.pixels.data() + std::size_t{first} * data.tile_columns * kTilePixels;
    float* const least = data.least.data() + std::size_t{first} * data.tile_columns;
    for (std::uint32_t row = first; row < end; ++row) {
        const std::size_t at = std::size_t{row - first} * data.tile_columns;
        clear_tile_row(pixels + at * kTilePixels, least + at, data.tile_columns, data.size.width,
                       std::min(kTile, data.size.height - row * kTile));
    }
    TileCovers* const covers = data.covers.data() + std::size_t{first} * data.tile_columns;
    std::fill_n(covers, std::size_t{end - first} * data.tile_columns, TileCovers{});
    float* const front = data.front.data() + std::size_t{first} * data.tile_columns;
    std::fill_n(front, std::size_t{end - first} * data.tile_columns, kUncovered);
    const DrawTarget target{pixels, least, covers, front, data.size.width, data.tile_columns, first, end};
    for (std::size_t place = 0; place < data.order.size(); ++place) draw_body_kernel(draw_body_of(data, place), target);
    for (std::size_t c = 0; c < chunks; ++c)
        for (const PreparedPatch& patch : data.chunks[c].patches) merge_patch(data, data.chunks[c], patch, first, end);
}

// Computes each level from the one below.
void fill_levels(OcclusionBuffer::Data& data) {
    const std::uint32_t stride = data.tile_columns, padded = data.padded_rows;
    std::uint32_t columns = data.tile_columns, rows = data.tile_rows, from = 0;
    for (std::uint32_t level = 1; columns > 1 || rows > 1; ++level) {
        const std::uint32_t to = 2 * padded - (2 * padded >> level);
        for (std::uint32_t y = 0; y < (rows + 1) / 2; ++y)
            for (std::uint32_t x = 0; x < (columns + 1) / 2; ++x) {
                float least = 3e38f;
                for (std::uint32_t k = 0; k < 4; ++k)
                    if (2 * x + k % 2 < columns && 2 * y + k / 2 < rows)
                        least = std::min(least, data.least[std::size_t{from + 2 * y + k / 2} * stride + 2 * x + k % 2]);
                data.least[std::size_t{to + y} * stride + x] = least;
            }
        columns = (columns + 1) / 2;
        rows = (rows + 1) / 2;
        from = to;
    }
}

void count(OcclusionBuffer::Data& data, std::size_t chunks) {
    data.statistics = {};
    if (!cull::kCountStatistics) return;
    for (std::size_t c = 0; c < chunks; ++c) {
        data.statistics.pieces_drawn += data.chunks[c].bodies.size() + data.chunks[c].patches.size();
        data.statistics.triangles_drawn += data.chunks[c].triangles;
    }
}

}  // namespace

OcclusionBuffer::OcclusionBuffer() : data_(Owner<Data>::make()) {}
OcclusionBuffer::~OcclusionBuffer() = default;
OcclusionBuffer::OcclusionBuffer(OcclusionBuffer&&) noexcept = default;
OcclusionBuffer& OcclusionBuffer::operator=(OcclusionBuffer&&) noexcept = default;

Result<void> validate(const BufferSize& size) {
    if (size.width >= 8 && size.height >= 8 && size.width <= 4096 && size.height <= 4096) return {};
    return fail(ErrorCode::out_of_range, kNoItem,
                {"occlusion buffer: width and height must be 8 to 4096, not ", size.width, " and ", size.height});
}

Result<OcclusionBuffer> OcclusionBuffer::create(const BufferSize& size) {
    if (auto good = validate(size); !good) return good.error();
    OcclusionBuffer buffer;
    Data& data = *buffer.data_;
    data.size = size;
    data.tile_columns = (size.width + kTile - 1) / kTile;
    data.tile_rows = (size.height + kTile - 1) / kTile;
    data.padded_rows = std::bit_ceil(std::max(data.tile_rows, data.tile_columns));
    data.pixels.assign(std::size_t{data.tile_columns} * data.tile_rows * kTilePixels, kUncovered);
    data.front.assign(std::size_t{data.tile_columns} * data.tile_rows, kUncovered);
    data.covers.assign(std::size_t{data.tile_columns} * data.tile_rows, TileCovers{});
    data.least.assign(std::size_t{2 * data.padded_rows} * data.tile_columns, kUncovered);
    return buffer;
}

void OcclusionBuffer::draw(const OccluderSet& occluders, const OcclusionView& view, Executor& executor) {
    draw(occluders, nullptr, occluders.size(), view, executor);
}

void OcclusionBuffer::draw(const OccluderSet& occluders, std::span<const OccluderId> chosen, const OcclusionView& view,
                           Executor& executor) {
    for ([[maybe_unused]] const OccluderId id : chosen)
        CROFTON_ASSERT(id < occluders.size(), "the occluder is in the set");
    static constexpr OccluderId kNothing = 0;
    draw(occluders, chosen.empty() ? &kNothing : chosen.data(), chosen.size(), view, executor);
}

void OcclusionBuffer::draw(const OccluderSet& occluders, const OccluderId* chosen, std::size_t count_all,
                           const OcclusionView& view, Executor& executor) {
    Data& data = *data_;
    data.view = view;
    data.map = pixel_map_of(view, data.size.width, data.size.height);
    const std::size_t chunks = (count_all + kPrepareGrain - 1) / kPrepareGrain;
    if (data.chunks.size() < chunks) data.chunks.resize(chunks);
    data.chunk_count = chunks;
    executor.parallel_for(count_all, kPrepareGrain, [&](std::size_t begin, std::size_t end, unsigned) {
        prepare_range(data.map, occluders, chosen, begin, end, data.chunks[begin / kPrepareGrain]);
    });
    sort_front_to_back(data, chunks);
    const std::size_t parts =
        std::min<std::size_t>(executor.concurrency() > 1 ? 4 * executor.concurrency() : 1, data.tile_rows);
    const std::size_t grain = (data.tile_rows + parts - 1) / parts;
    executor.parallel_for(data.tile_rows, grain, [&](std::size_t begin, std::size_t end, unsigned) {
        draw_band(data, chunks, static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end));
    });
    fill_levels(data);
    count(data, chunks);
    data.drawn = true;
}

bool OcclusionBuffer::hides(const Obb& box) const {
    std::uint64_t bit = 0;
    find_hidden({&box, 1}, {&bit, 1});
    return bit != 0;
}

void OcclusionBuffer::find_hidden(std::span<const Obb> boxes, std::span<std::uint64_t> hidden,
                                  Executor& executor) const {
    CROFTON_ASSERT(hidden.size() >= (boxes.size() + 63) / 64, "a bit for each box");
    if (!data_->drawn) return std::fill(hidden.begin(), hidden.end(), std::uint64_t{0});
    const QueryView view = query_view_of(*data_);
    executor.parallel_for(boxes.size(), kQueryGrain, [&](std::size_t begin, std::size_t end, unsigned) {
        for (std::size_t first = begin; first < end; first += 64)
            hidden[first / 64] = query_boxes_kernel(view, reinterpret_cast<const unsigned char*>(&boxes[first]),
                                                    nullptr, std::min<std::size_t>(64, end - first))
                                     .hidden;
    });
}

BufferSize OcclusionBuffer::size() const {
    return data_->size;
}
const OcclusionView& OcclusionBuffer::view() const {
    return data_->view;
}
const DrawStatistics& OcclusionBuffer::statistics() const {
    return data_->statistics;
}
float OcclusionBuffer::nearness(std::uint32_t x, std::uint32_t y) const {
    CROFTON_ASSERT(x < data_->size.width && y < data_->size.height, "the pixel is in the picture");
    const std::size_t tile = std::size_t{y / kTile} * data_->tile_columns + x / kTile;
    return data_->pixels[tile * kTilePixels + y % kTile * kTile + x % kTile];
}
void OcclusionBuffer::read(std::span<float> pixels) const {
    const BufferSize size = data_->size;
    CROFTON_ASSERT(pixels.size() >= std::size_t{size.width} * size.height, "a number for each pixel");
    for (std::uint32_t y = 0; y < size.height; ++y)
        for (std::uint32_t x = 0; x < size.width; ++x) pixels[std::size_t{y} * size.width + x] = nearness(x, y);
}
std::uint64_t OcclusionBuffer::count_covered() const {
    std::uint64_t covered = 0;
    for (std::uint32_t y = 0; y < data_->size.height; ++y)
        for (std::uint32_t x = 0; x < data_->size.width; ++x) covered += nearness(x, y) > kUncovered;
    return covered;
}

}  // namespace crofton::occlude
