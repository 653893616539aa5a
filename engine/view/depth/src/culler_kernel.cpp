// SPDX-License-Identifier: MIT
#include "culler_data.hpp"

// clang-format off
#include <hwy/foreach_target.h>
// clang-format on
#include <hwy/cache_control.h>
#include <hwy/highway.h>
#include <algorithm>

#include "faces-inl.hpp"
#include "map_rows-inl.hpp"
#include "near_faces-inl.hpp"
#include "patch-inl.hpp"
#include "projection-inl.hpp"
#include "raster-inl.hpp"
#include "tiles-inl.hpp"
#include "unpack-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace crofton::depth::HWY_NAMESPACE {
namespace {

// No operation is contracted here: the bits are those of any target.

void project_each(const PictureData& picture, const DepthObject* objects, std::size_t count, Projection* to) {
    const std::size_t lanes = hn::Lanes(DF());
    for (std::size_t i = 0; i < count; i += lanes) project_some_objects(picture, objects + i, count - i, to + i);
}

template <class Box>
void project_parts(const PictureData& picture, const ObjectData& object, const Projection& within, const Box* boxes,
                   std::size_t count, Projection* to) {
    const DF d;
    BoxLanes box;
    for (std::size_t i = 0; i < 4; ++i) {
        for (std::size_t c = 0; c < 4; ++c) box.columns[c][i] = hn::Set(d, object.columns[c][i]);
        box.moved[i] = hn::Set(d, object.moved[i]);
    }
    for (std::size_t i = 0; i < count; i += hn::Lanes(d))
        project_some_boxes(picture, box, within, boxes + i, count - i, to + i);
}

void project_packed(const PictureData& picture, const ObjectData& object, const Projection& within,
                    const ClusteredMesh::PackedBox* boxes, std::size_t count, Projection* to) {
    project_parts(picture, object, within, boxes, count, to);
}
void project_unpacked(const PictureData& picture, const ObjectData& object, const Projection& within,
                      const ClusterBox* boxes, std::size_t count, Projection* to) {
    project_parts(picture, object, within, boxes, count, to);
}

bool ask(const Tiles& tiles, const Projection& projection) {
    return hides(tiles, projection);
}

std::size_t ask_each(const Tiles& tiles, const Projection* projections, const std::uint32_t* objects, std::size_t begin,
                     std::size_t end) {
    constexpr std::size_t kAhead = 8;
    for (std::size_t i = begin; i < end; ++i) {
        hwy::Prefetch(&projections[objects[std::min(i + kAhead, end - 1)]]);
        if (!hides(tiles, projections[objects[i]])) return i;
    }
    return end;
}

std::uint64_t draw(const PictureData& picture, const ObjectData& object, const PatchData& patch) {
    return PatchDrawer(picture, object, patch).run();
}

std::uint64_t ask_drawn(const PictureData& picture, const ObjectData& object, const PatchData& patch) {
    return PatchDrawer(picture, object, patch).ask();
}

bool mark(const MapTriangle& triangle, std::uint32_t first_row, std::uint32_t last_row, std::uint32_t width,
          float* floors) {
    return mark_triangle(triangle, first_row, last_row, width, floors);
}

}  // namespace
}  // namespace crofton::depth::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace crofton::depth {

HWY_EXPORT(project_each);
HWY_EXPORT(project_packed);
HWY_EXPORT(project_unpacked);
HWY_EXPORT(ask);
HWY_EXPORT(ask_each);
HWY_EXPORT(draw);
HWY_EXPORT(ask_drawn);
HWY_EXPORT(mark);

void project_objects(const PictureData& picture, const DepthObject* objects, std::size_t count, Projection* to) {
    HWY_DYNAMIC_DISPATCH(project_each)(picture, objects, count, to);
}
void project_clusters(const PictureData& picture, const ObjectData& object, const Projection& within,
                      const ClusteredMesh::PackedBox* boxes, std::size_t count, Projection* to) {
    HWY_DYNAMIC_DISPATCH(project_packed)(picture, object, within, boxes, count, to);
}
void project_boxes(const PictureData& picture, const ObjectData& object, const Projection& within,
                   const ClusterBox* boxes, std::size_t count, Projection* to) {
    HWY_DYNAMIC_DISPATCH(project_unpacked)(picture, object, within, boxes, count, to);
}
bool is_hidden(const Tiles& tiles, const Projection& projection) {
    return HWY_DYNAMIC_DISPATCH(ask)(tiles, projection);
}
std::size_t first_shown(const Tiles& tiles, const Projection* projections, const std::uint32_t* objects,
                        std::size_t begin, std::size_t end) {
    return HWY_DYNAMIC_DISPATCH(ask_each)(tiles, projections, objects, begin, end);
}
std::uint64_t draw_patch(const PictureData& picture, const ObjectData& object, const PatchData& patch) {
    return HWY_DYNAMIC_DISPATCH(draw)(picture, object, patch);
}
std::uint64_t ask_patch(const PictureData& picture, const ObjectData& object, const PatchData& patch) {
    return HWY_DYNAMIC_DISPATCH(ask_drawn)(picture, object, patch);
}
bool mark_rows(const MapTriangle& triangle, std::uint32_t first_row, std::uint32_t last_row, std::uint32_t width,
               float* floors) {
    return HWY_DYNAMIC_DISPATCH(mark)(triangle, first_row, last_row, width, floors);
}

}  // namespace crofton::depth
#endif
