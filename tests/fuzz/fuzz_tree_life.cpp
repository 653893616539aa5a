// SPDX-License-Identifier: MIT
// Trees that are changed in any order, and what queries of them answer: against a plain list, item by item.
#include <algorithm>
#include <crofton/collide/bound_contacts.hpp>
#include <crofton/collide/broadphase.hpp>
#include <crofton/cull/cull.hpp>
#include <crofton/mesh/mesh_query.hpp>

#include "tree_model.hpp"

namespace {

using namespace crofton;
using fuzz::demand;
using Ids = std::vector<boxtree::ItemId>;

template <class Meets>
Ids which(const fuzz::LivingTree& living, std::uint32_t layers, Meets meets) {
    Ids ids;
    for (const auto& [id, item] : living.items)
        if (!item.detached && (item.layers & layers) != 0 && meets(item.box)) ids.push_back(id);
    return ids;
}
Ids sorted(std::span<const boxtree::ItemId> ids) {
    Ids result(ids.begin(), ids.end());
    std::sort(result.begin(), result.end());
    return result;
}

void check_views(fuzz::Shapes& in, const fuzz::LivingTree& living) {
    const auto mode = static_cast<cull::CullMode>(in.below(2));
    std::vector<cull::View> views(1 + in.below(5));
    cull::VisibleSet visible;
    for (cull::View& view : views) {
        view = {in.frustum(), in.layers()};
        const Ids expected = which(living, view.layer_mask, [&](const Obb& box) {
            return cull::classify(view.frustum, box, mode) != cull::Verdict::outside;
        });
        cull::find_visible(living.tree(), view, visible, {mode, cull::ResultOrder::ascending});
        demand(Ids(visible.ids().begin(), visible.ids().end()) == expected, "what a view sees");
        for (std::size_t i = 0; i < visible.size(); ++i)
            demand(visible.verdicts()[i] == cull::classify(view.frustum, living.items.at(visible.ids()[i]).box, mode),
                   "a verdict from the tree");
        cull::find_visible(living.tree(), view, visible, {mode, cull::ResultOrder::tree});
        demand(sorted(visible.ids()) == expected, "what a view sees in tree order");
    }
    cull::MaskedVisibleSet many;
    (void)cull::find_visible(living.tree(), views, many, mode);
    for (std::uint32_t v = 0; v < views.size(); ++v) {
        Ids seen;
        for (std::size_t i = 0; i < many.size(); ++i)
            if (many.view_mask(i) >> v & 1u) seen.push_back(many.ids()[i]);
        cull::find_visible(living.tree(), views[v], visible, {mode, cull::ResultOrder::ascending});
        demand(sorted(seen) == Ids(visible.ids().begin(), visible.ids().end()), "many views at once");
    }
}

void check_shapes(fuzz::Shapes& in, const fuzz::LivingTree& living) {
    const std::uint32_t layers = in.layers();
    Vector<boxtree::ItemId> found;
    Obb shape = in.box();
    if (!living.items.empty() && in.flag()) shape = in.box_near(living.items.begin()->second.box);
    const auto check = [&](const auto& probe, const char* what) {
        collide::overlapping(living.tree(), probe, found, layers);
        demand(Ids(found.begin(), found.end()) ==
                   which(living, layers, [&](const Obb& box) { return collide::intersects(box, probe); }),
               what);
    };
    check(shape, "boxes that meet a box");
    const Sphere sphere{in.point(), std::fabs(in.coordinate())};
    check(sphere, "boxes that meet a sphere");
    const collide::Capsule capsule{in.point(), in.point(), std::fabs(in.grid())};
    check(capsule, "boxes that meet a capsule");
}

void check_ray(fuzz::Shapes& in, const fuzz::LivingTree& living) {
    const std::uint32_t layers = in.layers();
    const Ray ray = living.items.empty() ? in.ray() : in.ray_through(in.point_of(living.items.rbegin()->second.box));
    std::optional<collide::BoxHit> first;
    const Ids all = which(living, layers, [&](const Obb& box) { return mesh::raycast(ray, box).has_value(); });
    for (const boxtree::ItemId id : all) {
        const double t = *mesh::raycast(ray, living.items.at(id).box);
        if (!first || t < first->t) first = {t, id};
    }
    const auto hit = collide::raycast(ray, living.tree(), layers);
    demand(hit.has_value() == first.has_value(), "whether a ray hits");
    if (hit) demand(hit->t == first->t && hit->item == first->item, "what a ray hits first");
    Ids along;
    collide::visit_along(
        ray, living.tree(), [&](boxtree::ItemId item, double) { return along.push_back(item), ray.max_t; }, layers);
    demand(sorted(along) == all, "what lies along a ray");
}

void check_near(fuzz::Shapes& in, const fuzz::LivingTree& living) {
    const Aabb bounds = aabb_of(in.box());
    const double distance = std::fabs(in.grid());
    Ids visited;
    collide::visit_near(bounds, distance, living.tree(), [&](boxtree::ItemId item) {
        visited.push_back(item);
        return distance;
    });
    const Ids near = sorted(visited);
    demand(std::adjacent_find(near.begin(), near.end()) == near.end(), "an item is visited twice");
    const Obb shape = obb_of(bounds);
    for (const auto& [id, item] : living.items) {
        if (item.detached) continue;
        const double gap = collide::distance(shape, item.box).distance;
        if (gap <= distance * (1.0 - 1e-9)) demand(std::binary_search(near.begin(), near.end(), id), "what is near");
    }
}

}  // namespace

CROFTON_FUZZ(in) {
    fuzz::LivingTree living(in);
    for (int step = 0; step < 60 && in.more(); ++step) {
        switch (in.below(12)) {
            case 0:
                living.settle(in);
                check_views(in, living);
                break;
            case 1:
                living.settle(in);
                living.check();
                check_shapes(in, living);
                break;
            case 2:
                living.settle(in);
                check_ray(in, living);
                break;
            case 3:
                living.settle(in);
                check_near(in, living);
                break;
            case 4: {
                living.settle(in);
                auto again = boxtree::BoxTree::deserialise(living.tree().serialise());
                demand(again.has_value(), "a stored tree is read");
                living.tree() = std::move(*again);
                break;
            }
            default:
                living.change(in);
        }
    }
    living.settle(in);
    living.check();
    check_views(in, living);
}
