// SPDX-License-Identifier: MIT
// One view's questions to many trees: what depends on the view alone is computed once.
#include <cmath>
#include <crofton/core/error.hpp>
#include <crofton/cull/moved_tree.hpp>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "exact/box_constraints.hpp"
#include "tree/query.hpp"

namespace crofton::cull {

struct MovedTreesQuery::State {
    const View* view = nullptr;
    bool usable = false;  // by filters
    KernelView planes;
};

MovedTreesQuery::MovedTreesQuery() : state_(Owner<State>::make()) {}
MovedTreesQuery::~MovedTreesQuery() = default;

void MovedTreesQuery::start(const View& view) {
    state_->view = &view;
    state_->usable = is_usable(view.frustum) && has_unit_normals(view.frustum);
    if (state_->usable) state_->planes = kernel_view_of(view);
}

// In double: some twenty roundings of 2^-53 of sums of the sizes below, with normals of up to 1.001 a component.
std::uint32_t MovedTreesQuery::planes_that_may_cut(const Obb& box) const {
    if (!state_->usable) return kAllPlanes;
    const Frustum& frustum = state_->view->frustum;
    const glm::dvec3 at = box.center - frustum.origin, half(box.half_extents);
    const double size = glm::dot(glm::abs(box.center) + glm::abs(frustum.origin) + 2.0 * half, glm::dvec3(1.0));
    std::uint32_t planes = 0;
    for (std::uint32_t i = 0; i < frustum.plane_count; ++i) {
        const Plane& plane = frustum.planes[i];
        double radius = 0.0;
        for (int k = 0; k < 3; ++k) radius += half[k] * std::abs(glm::dot(glm::dvec3(box.axes[k]), plane.normal));
        const double error_bound = 0x1p-47 * (size + std::abs(plane.offset));
        const bool inside = glm::dot(plane.normal, at) + plane.offset - radius > error_bound;
        planes |= std::uint32_t{!inside} << i;
    }
    return planes;
}

void MovedTreesQuery::find_visible(const boxtree::BoxTree& tree, const Move& move, std::uint32_t planes,
                                   VisibleSet& visible, const CullOptions& options) {
    CROFTON_ASSERT(options.limits == nullptr, "limits are relative to the eye, which is not moved");
    const Moved moved{move, state_->usable ? &state_->planes : nullptr, planes};
    Query(*state_->view, visible, options, nullptr, &moved).run(tree, serial_executor());
}

}  // namespace crofton::cull
