// SPDX-License-Identifier: MIT
#include "occluders.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <crofton/core/error.hpp>
#include <glm/matrix.hpp>
#include <iterator>
#include <optional>
#include <string>
#include <utility>

#include "box_triangles.hpp"
#include "require_ok.hpp"

namespace crofton::world {
namespace {

using occlude::FoundOccluder;
using occlude::OccluderId;
using occlude::OccluderKind;
using occlude::ShapeId;

// Eight corners in float whose hull lies in the box. Rounding moves a corner by no more than e = 2^-24 max|coordinate|
// along each axis. Along the box's axis k that is e Σ|row k of the inverse of the axes|, which is taken off beforehand.
// None where nothing is left.
std::optional<std::array<glm::vec3, 8>> inner_corners(const Obb& box) {
    const glm::dmat3 inverse = glm::inverse(glm::dmat3(box.axes));
    double size = 0.0;
    for (const glm::dvec3& corner : corners(box))
        for (int k = 0; k < 3; ++k) size = std::max(size, std::abs(corner[k]));
    glm::dvec3 half(box.half_extents);
    for (int k = 0; k < 3; ++k) {
        const double row = std::abs(inverse[0][k]) + std::abs(inverse[1][k]) + std::abs(inverse[2][k]);
        half[k] -= 0x1.01p-24 * size * row;
        if (!(half[k] > 0.0)) return std::nullopt;
    }
    std::array<glm::vec3, 8> result;
    for (unsigned i = 0; i < 8; ++i) {
        glm::dvec3 corner = box.center;
        for (int k = 0; k < 3; ++k) corner += ((i >> k & 1u) ? half[k] : -half[k]) * glm::dvec3(box.axes[k]);
        result[i] = glm::vec3(corner);
    }
    return result;
}

// A box may come without its surface, a convex hull without triangles, and all without their number of edges.
Result<void> complete_surface(FoundOccluder& occluder, std::uint64_t place) {
    if (occluder.kind == OccluderKind::convex && occluder.surface.indices.empty()) {
        auto hull = convex_hull(occluder.surface.positions);
        if (!hull) return hull.error();
        occluder.surface.indices = std::move(hull->triangles);
    }
    const bool is_box = occluder.kind == OccluderKind::box || occluder.kind == OccluderKind::walled;
    if (!is_box || !occluder.surface.positions.empty()) return {};
    if (auto valid = validate(occluder.box, place); !valid) return valid;
    const auto inner = inner_corners(occluder.box);
    if (!inner) return fail(ErrorCode::degenerate, place, "world: the occluder's box is flat; give a patch");
    occluder.surface.positions.assign(inner->begin(), inner->end());
    occluder.surface.indices.insert(occluder.surface.indices.end(), std::begin(kBoxTriangles), std::end(kBoxTriangles));
    if (occluder.piece_bounds.is_empty()) occluder.piece_bounds = aabb_of(occluder.box);
    return {};
}

Result<void> complete(FoundOccluder& occluder, std::uint64_t place) {
    for (const Aabb& limits : {occluder.piece_bounds, occluder.eyes_within})
        for (int k = 0; k < 3; ++k)
            if (std::isnan(limits.min[k]) || std::isnan(limits.max[k]))
                return fail(ErrorCode::non_finite, place, "world: the occluder's range of eyes is NaN");
    auto done = complete_surface(occluder, place);
    if (done && occluder.edges == 0)
        occluder.edges = static_cast<std::uint32_t>(occluder.surface.triangle_count()) * 3 / 2;
    return done;
}

}  // namespace

Result<ShapeId> Occluders::add_shape(const FoundOccluder& occluder) {
    return occluder.kind == OccluderKind::patch ? set_.add_surface(occluder.surface, occluder.sides)
                                                : set_.add_convex(occluder.surface.positions);
}

void Occluders::remove_shapes(Vector<ShapeId>& shapes) {
    for (const ShapeId shape : shapes) require_ok(set_.remove_shape(shape));
    shapes.clear();
}

Result<void> Occluders::set(scene::MeshId mesh, std::span<const FoundOccluder> occluders) {
    Vector<FoundOccluder> completed(occluders.begin(), occluders.end());
    Vector<ShapeId> shapes;
    for (std::size_t i = 0; i < completed.size(); ++i) {
        Result<void> done = complete(completed[i], i);
        if (done) {
            const auto shape = add_shape(completed[i]);
            if (shape)
                shapes.push_back(*shape);
            else
                done = shape.error();
        }
        if (done) continue;
        remove_shapes(shapes);
        done.error().item = i;
        return done;
    }
    if (mesh >= meshes_.size()) meshes_.resize(mesh + std::size_t{1});
    Mesh& m = meshes_[mesh];
    if (m.changed)
        remove_shapes(m.shapes);
    else if (m.placed.empty() && completed.empty())
        return {};
    else
        changed_meshes_.push_back(mesh);
    m.changed = true;
    m.occluders = std::move(completed);
    m.shapes = std::move(shapes);
    any_ = true;
    return {};
}

void Occluders::clear(scene::MeshId mesh) {
    if (mesh < meshes_.size()) require_ok(set(mesh, {}));
}

void Occluders::take_away(std::uint32_t object) {
    if (object >= holders_.size()) return;
    take_away_chain(holders_[object].first);
    holders_[object] = {};
}

void Occluders::take_away_chain(OccluderId first) {
    for (OccluderId id = first; id != kNoIndex; id = placed_[id].next) {
        require_ok(set_.remove(id));
        require_ok(candidates_.set(id, {}));  // without an area: worth nothing
        placed_[id].object = kNoIndex;
    }
}

bool Occluders::set_candidate(OccluderId id, const FoundOccluder& occluder, const Transform& transform,
                              std::uint32_t layers) {
    occlude::OccluderCandidate candidate = candidate_of(occluder, transform);
    candidate.layers = layers;
    if (id < candidates_.size()) return candidates_.set(id, candidate).has_value();
    return candidates_.add(candidate).has_value();
}

// What cannot be placed, as under a transform that flattens, hides nothing.
void Occluders::place_one(ShapeId shape, const FoundOccluder& occluder, const Transform& transform,
                          std::uint32_t layers, Placed placed, OccluderId& first) {
    const auto id = set_.place(shape, transform);
    if (!id) return;
    if (!set_candidate(*id, occluder, transform, layers)) {
        require_ok(set_.remove(*id));
        if (*id < candidates_.size()) require_ok(candidates_.set(*id, {}));
        return;
    }
    while (*id >= placed_.size()) placed_.push_back({});
    placed_[*id] = placed;
    placed_[*id].next = std::exchange(first, *id);
}

void Occluders::place(std::uint32_t object, const Transform& transform, std::uint32_t layers) {
    Holder& holder = holders_[object];
    const Mesh& mesh = meshes_[holder.mesh];
    for (std::size_t i = mesh.placed.size(); i-- > 0;)
        place_one(mesh.placed[i], mesh.occluders[i], transform, layers, {object, static_cast<std::uint32_t>(i)},
                  holder.first);
}

bool Occluders::move(std::uint32_t object, const Transform& transform, std::uint32_t layers) {
    const Holder& holder = holders_[object];
    const Mesh& mesh = meshes_[holder.mesh];
    std::size_t moved = 0;
    for (OccluderId id = holder.first; id != kNoIndex; id = placed_[id].next, ++moved)
        if (!set_.move(id, transform) || !set_candidate(id, mesh.occluders[placed_[id].place], transform, layers))
            return false;
    return moved == mesh.placed.size();
}

// In one pass over all objects, however many meshes have changed.
void Occluders::change_meshes(const ObjectTable& table) {
    const auto has_changed = [&](scene::MeshId mesh) { return mesh < meshes_.size() && meshes_[mesh].changed; };
    for (std::uint32_t object = 0; object < holders_.size(); ++object)
        if (has_changed(holders_[object].mesh)) take_away(object);
    for (std::uint32_t object = 0; object < table.objects.size(); ++object)
        if (table.objects[object].alive && has_changed(table.objects[object].mesh)) note(object);
    for (const scene::MeshId id : changed_meshes_) {
        Mesh& mesh = meshes_[id];
        remove_shapes(mesh.placed);
        std::swap(mesh.placed, mesh.shapes);
        mesh.changed = false;
    }
    changed_meshes_.clear();
}

void Occluders::change_object(std::uint32_t id, const ObjectTable& table, const scene::Scene& scene) {
    const Object& object = table.objects[id];
    const bool has_occluders = object.alive && object.instance != kNoIndex && object.mesh < meshes_.size() &&
                               !meshes_[object.mesh].placed.empty();
    const std::uint32_t layers =
        has_occluders && object.shown && object.occludes ? scene.layer_masks()[object.instance] : 0;
    if (layers == 0) return take_away(id);
    if (id >= holders_.size()) resize(holders_, id + std::size_t{1});
    const Transform& transform = scene.world(scene.node_of(object.instance));
    if (holders_[id].mesh == object.mesh && move(id, transform, layers)) return;
    take_away(id);
    holders_[id].mesh = object.mesh;
    place(id, transform, layers);
}

bool Occluders::update(const ObjectTable& table, const scene::Scene& scene) {
    const bool changed = !changed_meshes_.empty() || !changed_objects_.empty();
    if (!changed_meshes_.empty()) change_meshes(table);
    for (const std::uint32_t object : changed_objects_) change_object(object, table, scene);
    changed_objects_.clear();
    return changed;
}

}  // namespace crofton::world
