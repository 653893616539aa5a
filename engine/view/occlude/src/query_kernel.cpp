// SPDX-License-Identifier: MIT
#include "query_kernel.hpp"

#include <hwy/cache_control.h>
#include <algorithm>
#include <crofton/geometry/box.hpp>
#include <cstddef>
#include <cstring>

#include "buffer_data.hpp"

// clang-format off
#include <hwy/foreach_target.h>
// clang-format on
#include <hwy/highway.h>

#include "outline-inl.hpp"
#include "projection-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace crofton::occlude::HWY_NAMESPACE {
namespace {

static_assert(sizeof(Obb) == 72 && offsetof(Obb, axes) == 24 && offsetof(Obb, half_extents) == 60);

// Eight boxes in rows of four floats: the centre relative to the view's origin, then axes and half extents.
struct BoxBatch {
    alignas(64) float quads[4][kLanes][4];

    // Stores whole vectors, because narrow stores stall wider loads. The row's last number has no meaning.
    HWY_INLINE void copy(std::size_t to, const unsigned char* box, const double* origin) {
#if HWY_TARGET == HWY_SCALAR
        for (std::size_t j = 0; j < 3; ++j) {
            double center;
            std::memcpy(&center, box + 8 * j, 8);
            quads[0][to][j] = static_cast<float>(center - origin[j]);
        }
#else
        const hn::CappedTag<double, 4> d;
        const hn::Rebind<float, decltype(d)> df;
        for (std::size_t j = 0; j < 4; j += hn::Lanes(d)) {
            const auto center = hn::LoadU(d, reinterpret_cast<const double*>(box) + j);
            hn::StoreU(hn::DemoteTo(df, hn::Sub(center, hn::LoadU(d, origin + j))), df, quads[0][to] + j);
        }
#endif
        for (std::size_t q = 0; q < 3; ++q) std::memcpy(quads[q + 1][to], box + 24 + 16 * q, 16);
    }
};

// Half edges and centre of as many boxes as there are lanes.
struct BoxLanes {
    VF center[3], edge[3][3], l1_radius;

    HWY_INLINE BoxLanes(const BoxBatch& batch, std::size_t at) {
        const DF d;
        VF unused, axis[9], half[3];
        hn::LoadInterleaved4(d, batch.quads[0][at], center[0], center[1], center[2], unused);
        hn::LoadInterleaved4(d, batch.quads[1][at], axis[0], axis[1], axis[2], axis[3]);
        hn::LoadInterleaved4(d, batch.quads[2][at], axis[4], axis[5], axis[6], axis[7]);
        hn::LoadInterleaved4(d, batch.quads[3][at], axis[8], half[0], half[1], half[2]);
        l1_radius = hn::Add(hn::Add(hn::Abs(center[0]), hn::Abs(center[1])), hn::Abs(center[2]));
        for (std::size_t k = 0; k < 3; ++k)
            for (std::size_t j = 0; j < 3; ++j) {
                edge[k][j] = hn::Mul(axis[3 * k + j], half[k]);
                l1_radius = hn::Add(l1_radius, hn::Abs(edge[k][j]));
            }
    }
};

// The pixel in the middle of a box's rectangle.
struct MiddlePixel {
    std::size_t tile, place;

    HWY_INLINE MiddlePixel(const QueryView& view, const PixelRectangle& r) {
        const auto x = static_cast<std::uint32_t>(r.x0 + r.x1) / 2, y = static_cast<std::uint32_t>(r.y0 + r.y1) / 2;
        tile = std::size_t{y / kTile} * view.tile_columns + x / kTile;
        place = y % kTile * kTile + x % kTile;
    }
};

// Tests first whether one body hides the box, then whether its pixels do.
inline bool is_hidden(const QueryView& view, const Projection& boxes, std::size_t box) {
    const PixelRectangle r(boxes, box);
    PixelTest test(view, boxes, box);
    const MiddlePixel middle(view, r);
    const std::uint64_t bit = std::uint64_t{1} << middle.place;
    if (test.is_in_shadow(middle.tile, bit)) return true;
    // A shortcut: the box is visible if a pixel in its middle is farther than its centre.
    const float at = view.pixels[kTilePixels * middle.tile + middle.place], third = boxes.forms[2][0][box];
    const bool farther = view.perspective ? !(at * third > 1.0f) : !(at > third);
    if (farther && !test.hides(middle.tile, bit)) return false;
    return outline_is_hidden(view, boxes, box, r, test);
}

// Projects 64 boxes before testing any, so that the tiles which they test are in the cache by then.
class Batch {
  public:
    explicit HWY_INLINE Batch(const QueryView& view) : view_(view) {}

    HWY_INLINE Projection& projection(std::size_t group) { return boxes_[group]; }

    // Adds a projected group, of which the boxes in `present` are wanted.
    HWY_INLINE void add(std::size_t group, const LaneBits& bits, std::uint32_t present) {
        hidden_ |= std::uint64_t{bits.hidden & present} << (kLanes * group);
        outside_picture_ |= std::uint64_t{bits.outside_picture & present} << (kLanes * group);
        for (std::uint32_t open = bits.open & present; open != 0; open &= open - 1) {
            const auto i = static_cast<std::size_t>(hwy::Num0BitsBelowLS1Bit_Nonzero32(open));
            const MiddlePixel middle(view_, PixelRectangle(boxes_[group], i));
            hwy::Prefetch(view_.covers + middle.tile);
            hwy::Prefetch(view_.pixels + kTilePixels * middle.tile + middle.place);
            open_[open_count_++] = {static_cast<std::uint32_t>(kLanes * group + i),
                                    static_cast<std::uint32_t>(middle.tile)};
        }
    }

    HWY_INLINE QueryBits ask() {
        for (std::size_t i = 0; i < open_count_; ++i) {
            const TileCovers& covers = view_.covers[open_[i].tile];
            if (covers.pixels[0] == 0) continue;
            const BodyShadow& shadow = view_.shadows[covers.bodies[0]];
            for (std::size_t byte = 0; byte < 2 * sizeof(float) * 4 * kShadowLanes; byte += 64)
                hwy::Prefetch(reinterpret_cast<const char*>(shadow.groups) + byte);
        }
        for (std::size_t i = 0; i < open_count_; ++i) {
            const std::uint32_t box = open_[i].box;
            if (is_hidden(view_, boxes_[box / kLanes], box % kLanes)) hidden_ |= std::uint64_t{1} << box;
        }
        return {hidden_, outside_picture_};
    }

  private:
    struct Open {
        std::uint32_t box, tile;
    };

    const QueryView& view_;
    Projection boxes_[64 / kLanes];
    Open open_[64];
    std::size_t open_count_ = 0;
    std::uint64_t hidden_ = 0, outside_picture_ = 0;
};

QueryBits query_boxes(const QueryView& view, const unsigned char* boxes, const std::uint32_t* items,
                      std::size_t count) {
    const DF d;
    BoxBatch batch;
    Batch asked(view);
    const Depths depths(view);
    for (std::size_t first = 0; first < count; first += kLanes) {
        const std::size_t size = std::min(kLanes, count - first), group = first / kLanes;
        for (std::size_t i = 0; i < kLanes; ++i) {
            const std::size_t n = first + std::min(i, size - 1);
            batch.copy(i, boxes + sizeof(Obb) * (items != nullptr ? items[n] : n), view.origin);
        }
        LaneBits bits{0, 0, 0};
        for (std::size_t l = 0; l < kLanes; l += hn::Lanes(d)) {
            const BoxLanes lanes(batch, l);
            bits.add(asked.projection(group).project(view, depths, lanes.center, lanes.edge, lanes.l1_radius, l), l);
        }
        asked.add(group, bits, 0xffu >> (kLanes - size));
    }
    return asked.ask();
}

ChildBits query_children(const QueryView& view, const boxtree::Node& node, const boxtree::Axes& axes) {
    const DF d;
    const Depths depths(view);
    Batch asked(view);
    double origin[3];
    for (std::size_t j = 0; j < 3; ++j) origin[j] = node.origin[j] - view.origin[j];
    for (unsigned first = 0; first < node.count; first += kLanes) {
        alignas(32) float center[3][kLanes], edge[3][3][kLanes];
        for (unsigned i = 0; i < kLanes; ++i) {
            double at[3] = {origin[0], origin[1], origin[2]};
            for (unsigned k = 0; k < 3; ++k) {
                const double middle = static_cast<double>(node.unit) * boxtree::middle_of(node, first + i, k),
                             half = static_cast<double>(node.unit) * boxtree::half_of(node, first + i, k);
                for (unsigned j = 0; j < 3; ++j) {
                    at[j] += axes.rows[k][j] * middle;
                    edge[k][j][i] = static_cast<float>(axes.rows[k][j] * half);
                }
            }
            for (unsigned j = 0; j < 3; ++j) center[j][i] = static_cast<float>(at[j]);
        }
        LaneBits bits{0, 0, 0};
        for (std::size_t l = 0; l < kLanes; l += hn::Lanes(d)) {
            VF c[3], e[3][3], l1_radius = hn::Zero(d);
            for (std::size_t j = 0; j < 3; ++j) {
                c[j] = hn::Load(d, center[j] + l);
                l1_radius = hn::Add(l1_radius, hn::Abs(c[j]));
                for (std::size_t k = 0; k < 3; ++k) {
                    e[k][j] = hn::Load(d, edge[k][j] + l);
                    l1_radius = hn::Add(l1_radius, hn::Abs(e[k][j]));
                }
            }
            bits.add(asked.projection(first / kLanes).project(view, depths, c, e, l1_radius, l), l);
        }
        asked.add(first / kLanes, bits, 0xffu >> (kLanes - std::min<std::size_t>(kLanes, node.count - first)));
    }
    const QueryBits bits = asked.ask();
    return {static_cast<std::uint32_t>(bits.hidden), static_cast<std::uint32_t>(bits.outside_picture)};
}

}  // namespace
}  // namespace crofton::occlude::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace crofton::occlude {

HWY_EXPORT(query_boxes);

QueryBits query_boxes_kernel(const QueryView& view, const unsigned char* boxes, const std::uint32_t* items,
                             std::size_t count) {
    return HWY_DYNAMIC_DISPATCH(query_boxes)(view, boxes, items, count);
}

HWY_EXPORT(query_children);

ChildBits query_children_kernel(const QueryView& view, const boxtree::Node& node, const boxtree::Axes& axes) {
    return HWY_DYNAMIC_DISPATCH(query_children)(view, node, axes);
}

}  // namespace crofton::occlude
#endif
