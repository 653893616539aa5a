// SPDX-License-Identifier: MIT
// A World of boxes and spheres, changed in any order: views, rays, overlaps and pairs against a plain list.
#include <algorithm>
#include <crofton/crofton.hpp>
#include <world/world/model.hpp>

#include "../view_request.hpp"
#include "shapes.hpp"

namespace {

using namespace crofton;
using fuzz::demand;
using Ids = std::vector<std::uint32_t>;

// Spheres touch within rounding, so they stand on coarse grids of their own, where sums and squares are exact.
Bound bound(fuzz::Shapes& in, const oracle::Model& model) {
    if (in.below(4) == 0) {
        return Sphere{in.grid_point(), std::fabs(in.grid())};
    }
    if (!model.objects.empty() && in.flag()) return in.box_near(model.objects.begin()->second.bound.box);
    return in.box();
}

Ids ids_of(const Vector<ObjectRef>& found) {
    Ids ids;
    for (const ObjectRef& object : found) ids.push_back(object.object.index);
    return ids;
}

void check_views(fuzz::Shapes& in, const World& world, const oracle::Model& model) {
    std::vector<cull::View> views(1 + in.below(3));
    ViewResult visible;
    for (cull::View& view : views) {
        view = {in.frustum(), in.layers()};
        demand(world.view(request_of(view), visible).has_value(), "a view is answered");
        // A sphere is seen by the box around it.
        demand(Ids(visible.ids().begin(), visible.ids().end()) == model.visible(view), "what a world's view sees");
        for (std::size_t i = 0; i < visible.size(); ++i) {
            const oracle::ModelObject& object = model.objects.at(visible.ids()[i]);
            demand(visible[i].object == object.handle && visible[i].user == object.user, "whom a view sees");
        }
    }
    MultiViewResult in_views;
    demand(world.view(requests_of(views), in_views).has_value(), "three views fit one pass");
    for (std::size_t v = 0; v < views.size(); ++v) {
        Ids seen;
        for (std::size_t i = 0; i < in_views.size(); ++i)
            if (in_views.view_mask(i) >> v & 1) seen.push_back(in_views[i].object.index);
        std::sort(seen.begin(), seen.end());
        demand(seen == model.visible(views[v]), "what many views of a world see");
    }
}

// Nothing is asked about what lies within rounding of a sphere's surface.
bool is_plain(const oracle::Model& model) {
    return std::none_of(model.objects.begin(), model.objects.end(),
                        [](const auto& entry) { return entry.second.bound.kind == BoundKind::sphere; });
}

void check_queries(fuzz::Shapes& in, const World& world, const oracle::Model& model) {
    const std::uint32_t layers = in.layers();
    const Obb box = in.box();
    Vector<ObjectRef> found;
    world.overlap(box, found, {layers});
    demand(ids_of(found) == model.overlapping(box, layers), "what a box overlaps");
    if (!is_plain(model)) return;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
    for (const ObjectPair& pair : world.pairs()) pairs.emplace_back(pair.first.object.index, pair.second.object.index);
    demand(pairs == model.pairs(), "pairs of a world");
    const Ray ray = in.ray();
    const auto expected = model.along(ray, layers);
    Vector<ObjectHit> hits;
    world.raycast_all(ray, hits, {layers});
    demand(hits.size() == expected.size(), "what a ray meets");
    for (std::size_t i = 0; i < hits.size(); ++i)
        demand(hits[i].t == expected[i].first && hits[i].object.index == expected[i].second, "the order along a ray");
    const auto first = world.raycast(ray, {layers});
    demand(first.has_value() == !expected.empty() && world.raycast_any(ray, {layers}) == !expected.empty(), "a ray");
    if (first) demand(first->t == expected[0].first && first->object.index == expected[0].second, "the first on a ray");
    const double limit = std::fabs(in.grid()), least = model.distance_to(box, layers);
    const auto closest = world.closest(box, limit, {layers});
    const double size = 1e-7 * (40.0 + least + glm::length(box.center));
    if (least < limit - size) demand(closest.has_value(), "what is close");
    if (least > limit + size) demand(!closest, "what is not close");
    if (closest) demand(std::fabs(closest->distance - least) <= size, "how close it is");
}

void change(fuzz::Shapes& in, World& world, oracle::Model& model) {
    const unsigned kind = in.below(10);
    if (kind < 3 || model.objects.empty()) {
        oracle::ModelObject object;
        object.bound = bound(in, model);
        object.user = in.word();
        object.layers = in.layers();
        object.collides_with = in.layers();
        ObjectDescription description;
        description.bound = object.bound;
        description.user = object.user;
        description.layers = object.layers;
        description.collides_with = object.collides_with;
        const auto handle = world.add(description);
        demand(handle.has_value() && !model.objects.contains(handle->index), "add");
        object.handle = *handle;
        model.objects[handle->index] = object;
        return;
    }
    const auto known = std::next(model.objects.begin(), in.byte() % static_cast<std::ptrdiff_t>(model.objects.size()));
    oracle::ModelObject& object = known->second;
    switch (kind) {
        case 3: {
            const ObjectHandle handle = object.handle;
            demand(world.remove(handle).has_value() && !world.contains(handle), "remove");
            const auto again = world.remove(handle);
            demand(!again && again.error().code == ErrorCode::stale_handle, "a stale handle");
            model.objects.erase(known);
            break;
        }
        case 4:
            object.hidden = in.flag();
            demand(world.set_hidden(object.handle, object.hidden).has_value(), "set_hidden");
            break;
        case 5:
            object.layers = in.layers();
            demand(world.set_layers(object.handle, object.layers).has_value(), "set_layers");
            break;
        case 6:
            object.collides_with = in.layers();
            demand(world.set_collides_with(object.handle, object.collides_with).has_value(), "set_collides_with");
            break;
        default:
            object.bound = bound(in, model);
            demand(world.set_bound(object.handle, object.bound).has_value(), "set_bound");
    }
}

}  // namespace

CROFTON_FUZZ(in) {
    WorldOptions options;
    options.updates_to_rest = 1 + in.below(4);
    options.rebuild_budget = in.below(64);
    options.tree = static_cast<boxtree::Orientation>(in.below(3));
    World world(options);
    oracle::Model model;
    for (int frame = 0; frame < 16 && in.more(); ++frame) {
        for (unsigned changes = in.below(12); changes > 0; --changes) change(in, world, model);
        demand(world.update().has_value() && world.object_count() == model.objects.size(), "an update");
        if (in.flag()) check_views(in, world, model);
        if (in.flag()) check_queries(in, world, model);
    }
}
