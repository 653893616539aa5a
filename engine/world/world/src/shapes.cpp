// SPDX-License-Identifier: MIT
#include "shapes.hpp"

#include <algorithm>
#include <cmath>
#include <crofton/convex/shape_maker.hpp>
#include <crofton/core/error.hpp>
#include <crofton/core/recovery.hpp>
#include <crofton/mesh/mesh_parts.hpp>
#include <crofton/mesh/mesh_tree.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <iterator>
#include <utility>

#include "box_triangles.hpp"

namespace crofton::world {
namespace {

// So that triangles whose vertices a mirroring map has moved look outward as before.
void turn_round(TriangleMesh& mesh) {
    for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) std::swap(mesh.indices[i + 1], mesh.indices[i + 2]);
}

// How large the nodes' boxes are beside the root: what queries cost grows with it.
double spread_of(const mesh::MeshTree& tree) {
    double sum = 0.0;
    for (const mesh::MeshNode& node : tree.parts().nodes)
        for (std::uint32_t lane = 0; lane < node.count; ++lane)
            sum += double{node.half[0][lane]} + double{node.half[1][lane]} + double{node.half[2][lane]};
    const mesh::MeshBox& root = tree.parts().root_box;
    const double whole = double{root.half[0]} + double{root.half[1]} + double{root.half[2]};
    return whole > 0.0 ? sum / whole : 0.0;
}

Vector<std::uint32_t> places_in(const mesh::MeshTree& tree) {
    Vector<std::uint32_t> places;
    if (tree.triangle_count() == 0) return places;
    places.assign(tree.triangle_count() + tree.rejected().size(), 0);
    const Vector<mesh::MeshLeaf>& leaves = tree.parts().leaves;
    for (std::uint32_t leaf = 0; leaf < leaves.size(); ++leaf)
        for (std::uint32_t lane = 0; lane < leaves[leaf].count; ++lane)
            places[leaves[leaf].triangle[lane]] = leaf * mesh::kMeshLeafWidth + lane;
    return places;
}

constexpr std::size_t kManyTriangles = 4096;
constexpr double kWornOut = 1.5;  // times the spread at the build: then a tree is built anew

}  // namespace

// As validate(Pose) asks it of a rotation, with room for rounding.
bool is_rotation(const glm::dmat3& m) {
    const glm::dmat3 gram = glm::transpose(m) * m;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            if (!(std::abs(gram[i][j] - (i == j ? 1.0 : 0.0)) <= 5e-7)) return false;
    return true;
}

void MeshShape::build(const TriangleMesh& triangles, bool refittable, Executor& executor) {
    auto built = mesh::MeshTree::build(triangles, {.refittable = refittable, .rays = true}, executor);
    detail::give_up_without_memory(built);
    is_usable = built.has_value();
    tree = built ? std::move(*built) : mesh::MeshTree();
    places = places_in(tree);
    bounds = is_usable ? tree.parts().bounds() : Aabb{};
}

convex::Shape MeshShape::shape(const glm::dmat3* map) const {
    return convex::ShapeMaker::mesh(tree, bounds, map);
}

Triangle MeshShape::triangle(std::uint32_t index) const {
    const std::uint32_t place = places[index], lane = place % mesh::kMeshLeafWidth;
    const mesh::MeshLeaf& leaf = tree.parts().leaves[place / mesh::kMeshLeafWidth];
    Triangle corners;
    for (std::size_t v = 0; v < 3; ++v)
        corners[v] = {glm::vec3(leaf.vertex[v][0][lane], leaf.vertex[v][1][lane], leaf.vertex[v][2][lane])};
    return corners;
}

TriangleMesh box_mesh(const glm::vec3& half) {
    TriangleMesh mesh;
    for (int corner = 0; corner < 8; ++corner) {
        mesh.positions.push_back(
            {(corner & 1 ? half.x : -half.x), (corner & 2 ? half.y : -half.y), (corner & 4 ? half.z : -half.z)});
    }
    mesh.indices.assign(std::begin(kBoxTriangles), std::end(kBoxTriangles));
    return mesh;
}

bool build_under(const glm::dmat3& linear, TriangleMesh triangles, mesh::MeshTree& tree) {
    for (glm::vec3& p : triangles.positions) p = glm::vec3(linear * glm::dvec3(p));
    if (glm::determinant(linear) < 0.0) turn_round(triangles);
    auto built = mesh::MeshTree::build(triangles);
    detail::give_up_without_memory(built);
    if (built) tree = std::move(*built);
    return built.has_value();
}

Shapes::Shapes() {
    TriangleMesh point;
    point.positions.resize(1);
    point.indices.assign(3, 0);
    auto built = mesh::MeshTree::build(point);
    detail::give_up_without_memory(built);
    CROFTON_ASSERT(built.has_value(), "a point is a mesh");
    if (built) point_ = std::move(*built);
}

void Shapes::set_mesh(scene::MeshId mesh, bool wants_triangles) {
    if (meshes_.size() <= mesh) meshes_.resize(mesh + std::size_t{1});
    meshes_[mesh].wants_triangles = wants_triangles;
    meshes_[mesh].deforms = meshes_[mesh].can_refit = false;
}

void Shapes::update_tree(const TriangleMesh& triangles, Mesh& mesh, Executor& executor) {
    mesh::MeshTree& tree = mesh.shape.tree;
    if (mesh.can_refit && tree.refit(triangles.positions) && spread_of(tree) <= kWornOut * mesh.spread) {
        mesh.shape.bounds = tree.parts().bounds();
        return;
    }
    mesh.shape.build(triangles, mesh.deforms, executor);
    mesh.can_refit = mesh.shape.is_usable && mesh.deforms;
    if (mesh.can_refit) mesh.spread = spread_of(tree);
}

void Shapes::update(const scene::Scene& scene, Executor& executor) {
    to_build_.clear();
    std::sort(noted_.begin(), noted_.end());
    for (const scene::MeshId mesh : noted_) {
        const std::uint64_t revision = scene.is_mesh_removed(mesh) ? 0 : scene.mesh_revision(mesh);
        if (meshes_[mesh].revision == revision) continue;
        meshes_[mesh].revision = revision;
        if (revision != 0 && meshes_[mesh].wants_triangles)
            to_build_.push_back(mesh);
        else
            meshes_[mesh].shape = {}, meshes_[mesh].can_refit = false;
    }
    noted_.clear();
    // A mesh that would keep one thread longer than the others is built by all.
    std::size_t all = 0;
    for (const std::uint32_t mesh : to_build_) all += scene.mesh(mesh).indices.size();
    const std::size_t many = std::max(all / executor.concurrency(), 3 * kManyTriangles);
    const auto small = std::partition(to_build_.begin(), to_build_.end(),
                                      [&](std::uint32_t mesh) { return scene.mesh(mesh).indices.size() >= many; });
    const auto large_count = static_cast<std::size_t>(small - to_build_.begin());
    for (std::size_t i = 0; i < large_count; ++i)
        update_tree(scene.mesh(to_build_[i]), meshes_[to_build_[i]], executor);
    executor.parallel_for(to_build_.size() - large_count, 1, [&](std::size_t begin, std::size_t end, unsigned) {
        for (std::size_t i = large_count + begin; i < large_count + end; ++i)
            update_tree(scene.mesh(to_build_[i]), meshes_[to_build_[i]], serial_executor());
    });
}

void Shapes::begin() {
    to_build_.clear();
}

void Shapes::prepare(const ObjectTable& table, const SpatialIndex& index, const scene::Scene& scene, std::uint32_t id) {
    const Object& object = table.objects[id];
    Own wanted;
    if (object.kind == BoundKind::sphere) return;
    if (mesh_tree_of(object)) {
        wanted.linear = scene.world(scene.node_of(object.instance)).linear;
        if (is_rotation(wanted.linear)) return;
        wanted.mesh = object.mesh;
        wanted.revision = meshes_[object.mesh].revision;
    } else {
        const Obb& box = index.box(id);
        if (const glm::dmat3 axes(box.axes); !is_rotation(axes)) wanted.linear = axes;
        wanted.half_extents = box.half_extents;
    }
    if (own_of_object_.size() <= id) own_of_object_.resize(id + std::size_t{1}, kNoIndex);
    std::uint32_t& place = own_of_object_[id];
    if (place == kNoIndex) {
        if (free_.empty()) {
            free_.push_back(static_cast<std::uint32_t>(own_.size()));
            own_.emplace_back();
        }
        place = free_.back();
        free_.pop_back();
    } else {
        const Own& own = own_[place];
        if (own.linear == wanted.linear && own.half_extents == wanted.half_extents && own.mesh == wanted.mesh &&
            own.revision == wanted.revision)
            return;
    }
    own_[place] = std::move(wanted);
    to_build_.push_back(place);
}

void Shapes::build_own(const scene::Scene& scene, Own& own) const {
    own.is_usable =
        build_under(own.linear, own.mesh == kNoIndex ? box_mesh(own.half_extents) : scene.mesh(own.mesh), own.tree);
}

void Shapes::build(const scene::Scene& scene, Executor& executor) {
    executor.parallel_for(to_build_.size(), 1, [&](std::size_t begin, std::size_t end, unsigned) {
        for (std::size_t i = begin; i < end; ++i) build_own(scene, own_[to_build_[i]]);
    });
}

PosedTree Shapes::posed_tree(const ObjectTable& table, const SpatialIndex& index, const scene::Scene& scene,
                             std::uint32_t id) const {
    const Object& object = table.objects[id];
    if (object.kind == BoundKind::sphere) return {&point_, {glm::dmat3(1.0), index.box(id).center}};
    const auto own = [&]() -> const mesh::MeshTree* {
        const Own& kept = own_[own_of_object_[id]];
        return kept.is_usable ? &kept.tree : nullptr;
    };
    const mesh::MeshTree* tree = mesh_tree_of(object);
    if (!tree) {
        const Obb& box = index.box(id);
        const glm::dmat3 axes(box.axes);
        return {own(), {is_rotation(axes) ? axes : glm::dmat3(1.0), box.center}, true};
    }
    const Transform& world = scene.world(scene.node_of(object.instance));
    if (is_rotation(world.linear)) return {tree, {world.linear, world.translation}};
    return {own(), {glm::dmat3(1.0), world.translation}};
}

void Shapes::forget(std::uint32_t object) {
    if (object >= own_of_object_.size() || own_of_object_[object] == kNoIndex) return;
    own_[own_of_object_[object]] = {};
    free_.push_back(own_of_object_[object]);
    own_of_object_[object] = kNoIndex;
}

}  // namespace crofton::world
