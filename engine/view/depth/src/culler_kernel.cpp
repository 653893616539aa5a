// SPDX-License-Identifier: MIT
#include "culler_data.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "culler_kernel.cpp"
// clang-format off
#include <hwy/foreach_target.h>
// clang-format on
#include <hwy/highway.h>

#include "faces-inl.hpp"
#include "near_faces-inl.hpp"
#include "patch-inl.hpp"
#include "projection-inl.hpp"
#include "raster-inl.hpp"
#include "tiles-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace crofton::depth::HWY_NAMESPACE {
namespace {

// No operation is contracted here: the bits are those of any target.

void project_all(const PictureData& picture, const ObjectData& object, const Cluster* clusters, std::size_t count,
                 Projection* to) {
    for (std::size_t i = 0; i < count; ++i) to[i] = project(picture, object, clusters[i]);
}

bool ask(const Tiles& tiles, const Projection& projection) {
    return hides(tiles, projection);
}

std::uint64_t draw(const PictureData& picture, const ObjectData& object, const PatchData& patch) {
    return PatchDrawer(picture, object, patch).run();
}

}  // namespace
}  // namespace crofton::depth::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace crofton::depth {

HWY_EXPORT(project_all);
HWY_EXPORT(ask);
HWY_EXPORT(draw);

void project_bounds(const PictureData& picture, const ObjectData& object, const Cluster* clusters, std::size_t count,
                    Projection* to) {
    HWY_DYNAMIC_DISPATCH(project_all)(picture, object, clusters, count, to);
}
bool is_hidden(const Tiles& tiles, const Projection& projection) {
    return HWY_DYNAMIC_DISPATCH(ask)(tiles, projection);
}
std::uint64_t draw_patch(const PictureData& picture, const ObjectData& object, const PatchData& patch) {
    return HWY_DYNAMIC_DISPATCH(draw)(picture, object, patch);
}

}  // namespace crofton::depth
#endif
