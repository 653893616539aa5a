// SPDX-License-Identifier: MIT
#include "assets/retriangulate.hpp"

#include <crofton/triangulate/triangulate.hpp>
#include <glm/geometric.hpp>
#include <optional>

namespace crofton::assets {
namespace {

using Triangle = std::array<std::uint32_t, 3>;

// Large polygons have a proven answer within this, some 0.5 s, or a good one: the same in every run.
constexpr std::uint64_t kWorkPerPolygon = 50'000'000;

glm::dvec3 normal_of(const TriangleMesh& mesh, const Triangle& t) {
    const glm::dvec3 a(mesh.positions[t[0]]), b(mesh.positions[t[1]]), c(mesh.positions[t[2]]);
    return glm::cross(b - a, c - a);
}
Triangle triangle_of(const TriangleMesh& mesh, std::uint32_t t) {
    return {mesh.indices[3 * t], mesh.indices[3 * t + 1], mesh.indices[3 * t + 2]};
}

class Retriangulation {
  public:
    Retriangulation(const scene::Scene& from, triangulate::Method method) : from_(from) {
        options_.method = method;
        options_.work = kWorkPerPolygon;
    }

    // From a scene as loaded: nothing was removed from it, and parents have lower ids than their children.
    Result<scene::Scene> run(const LoadOptions& load) {
        scene::Scene made({load.criterion});
        for (scene::NodeId n = 0; n < from_.node_count(); ++n)
            if (auto added = made.add_node(from_.parent_of(n), from_.local(n), ~0u, from_.node_name(n)); !added)
                return added.error();
        for (scene::MeshId m = 0; m < from_.mesh_count(); ++m) {
            const auto triangles = of_polygon(m);
            auto added = triangles ? made.add_polygon(*from_.polygon(m), *triangles, from_.mesh_name(m))
                                   : made.add_mesh(of_patches(m), from_.mesh_name(m));
            if (!added) return added.error();
        }
        for (scene::InstanceId i = 0; i < from_.instance_count(); ++i) {
            const auto added = made.add_instance(from_.node_of(i), from_.mesh_of(i));
            if (!added) return added.error();
        }
        return made;
    }

  private:
    // Seen from the side that the mesh is seen from. Absent where the mesh is no polygon or its rings have no answer.
    std::optional<Vector<Triangle>> of_polygon(scene::MeshId m) {
        const scene::PlanarPolygon* flat = from_.polygon(m);
        if (flat == nullptr || !triangulator_.triangulate(flat->polygon, options_, result_)) return std::nullopt;
        const TriangleMesh& mesh = from_.mesh(m);
        glm::dvec3 facing(0.0);
        for (std::uint32_t t = 0; t < mesh.triangle_count(); ++t) facing += normal_of(mesh, triangle_of(mesh, t));
        if (glm::dot(facing, glm::cross(flat->u, flat->v)) < 0.0)
            for (Triangle& t : result_.triangles) std::swap(t[1], t[2]);
        return result_.triangles;
    }

    TriangleMesh of_patches(scene::MeshId m) {
        TriangleMesh mesh = from_.mesh(m);
        const auto patches = triangulate::find_planar_patches(mesh);
        if (!patches) return mesh;
        for (const triangulate::PlanarPatch& patch : *patches) {
            if (!triangulator_.triangulate(patch.polygon, options_, result_)) continue;
            if (result_.triangles.size() != patch.triangles.size()) continue;
            const glm::dvec3 facing = normal_of(mesh, triangle_of(mesh, patch.triangles[0]));
            bool faces = true;
            for (Triangle& t : result_.triangles) {
                for (std::uint32_t& corner : t) corner = patch.vertices[corner];
                faces = faces && glm::dot(normal_of(mesh, t), facing) > 0.0;
            }
            if (!faces) continue;
            for (std::size_t t = 0; t < patch.triangles.size(); ++t)
                std::copy(result_.triangles[t].begin(), result_.triangles[t].end(),
                          mesh.indices.begin() + 3 * static_cast<std::ptrdiff_t>(patch.triangles[t]));
        }
        return mesh;
    }

    const scene::Scene& from_;
    triangulate::TriangulateOptions options_;
    triangulate::Triangulator triangulator_;
    triangulate::Triangulation result_;
};

}  // namespace

Result<void> retriangulate(SceneSource& source, const LoadOptions& options, triangulate::Method method) {
    auto made = Retriangulation(source.scene, method).run(options);
    if (!made) return std::move(made.error());
    source.scene = std::move(*made);
    source.emission.clear();
    source.clusters.clear();
    return {};
}

}  // namespace crofton::assets
