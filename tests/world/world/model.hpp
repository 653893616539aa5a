// SPDX-License-Identifier: MIT
// What a World should answer, from a plain list of its objects, each asked in turn.
#pragma once
#include <algorithm>
#include <cmath>
#include <crofton/collide/bound_contacts.hpp>
#include <crofton/collide/narrow_phase.hpp>
#include <crofton/crofton.hpp>
#include <crofton/mesh/mesh_query.hpp>
#include <glm/geometric.hpp>
#include <map>
#include <optional>
#include <utility>
#include <vector>

namespace crofton::oracle {

struct ModelObject {
    ObjectHandle handle;
    Bound bound;
    std::uint64_t user = 0;
    std::uint32_t layers = ~0u, collides_with = ~0u;
    bool hidden = false;
};

inline bool meet(const Bound& a, const Bound& b) {
    const bool sphere_a = a.kind == BoundKind::sphere, sphere_b = b.kind == BoundKind::sphere;
    const Sphere of_a{a.box.center, a.radius}, of_b{b.box.center, b.radius};
    if (sphere_a && sphere_b) return glm::length(of_a.center - of_b.center) <= of_a.radius + of_b.radius;
    if (sphere_a) return collide::intersects(b.box, of_a);
    if (sphere_b) return collide::intersects(a.box, of_b);
    return collide::intersects(a.box, b.box);
}

// Where a line enters a sphere, by the quadratic formula in long double.
inline std::optional<double> enter(const Ray& ray, const Sphere& sphere) {
    long double a = 0, b = 0, c = -static_cast<long double>(sphere.radius) * sphere.radius;
    for (int k = 0; k < 3; ++k) {
        const long double d = ray.direction[k], o = static_cast<long double>(ray.origin[k]) - sphere.center[k];
        a += d * d;
        b += d * o;
        c += o * o;
    }
    if (c <= 0) return 0.0;
    const long double discriminant = b * b - a * c;
    if (discriminant < 0 || b > 0) return std::nullopt;
    const auto t = static_cast<double>((-b - std::sqrt(discriminant)) / a);
    return t <= ray.max_t ? std::optional(t) : std::nullopt;
}

struct Model {
    std::map<std::uint32_t, ModelObject> objects;  // by index

    [[nodiscard]] std::vector<std::uint32_t> visible(const cull::View& view) const {
        std::vector<std::uint32_t> ids;
        for (const auto& [id, object] : objects)
            if (!object.hidden && (object.layers & view.layer_mask) != 0 &&
                cull::classify(view.frustum, object.bound.box) != cull::Verdict::outside)
                ids.push_back(id);
        return ids;
    }
    [[nodiscard]] std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs() const {
        std::vector<std::pair<std::uint32_t, std::uint32_t>> found;
        for (auto a = objects.begin(); a != objects.end(); ++a)
            for (auto b = std::next(a); b != objects.end(); ++b) {
                const ModelObject &first = a->second, &second = b->second;
                if (first.hidden || second.hidden || (first.layers & second.collides_with) == 0 ||
                    (second.layers & first.collides_with) == 0)
                    continue;
                if (meet(first.bound, second.bound)) found.emplace_back(a->first, b->first);
            }
        return found;
    }
    template <class Shape>
    [[nodiscard]] std::vector<std::uint32_t> overlapping(const Shape& shape, std::uint32_t layers) const {
        std::vector<std::uint32_t> ids;
        for (const auto& [id, object] : objects)
            if (!object.hidden && (object.layers & layers) != 0 && meet(Bound(shape), object.bound)) ids.push_back(id);
        return ids;
    }
    // t and id of every object that the ray meets, by t.
    [[nodiscard]] std::vector<std::pair<double, std::uint32_t>> along(const Ray& ray, std::uint32_t layers) const {
        std::vector<std::pair<double, std::uint32_t>> hits;
        for (const auto& [id, object] : objects) {
            if (object.hidden || (object.layers & layers) == 0) continue;
            const auto t = object.bound.kind == BoundKind::sphere
                               ? enter(ray, {object.bound.box.center, object.bound.radius})
                               : mesh::raycast(ray, object.bound.box);
            if (t) hits.emplace_back(*t, id);
        }
        std::sort(hits.begin(), hits.end());
        return hits;
    }
    [[nodiscard]] double distance_to(const Bound& shape, std::uint32_t layers) const {
        // A sphere is a point, and as much nearer.
        const auto core = [](const Bound& bound) {
            return bound.kind == BoundKind::sphere ? Obb{bound.box.center, glm::mat3(1.0f), glm::vec3(0.0f)}
                                                   : bound.box;
        };
        const auto between = [&](const Bound& a, const Bound& b) {
            return std::max(0.0, collide::distance(core(a), core(b)).distance - a.radius - b.radius);
        };
        double least = std::numeric_limits<double>::infinity();
        for (const auto& [id, object] : objects)
            if (!object.hidden && (object.layers & layers) != 0) least = std::min(least, between(shape, object.bound));
        return least;
    }
};

}  // namespace crofton::oracle
