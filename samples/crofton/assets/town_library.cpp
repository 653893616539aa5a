// SPDX-License-Identifier: MIT
#include "assets/town_library.hpp"

#include <crofton/triangulate/triangulate.hpp>

namespace crofton::assets::town {

scene::MeshId Library::add(MeshBuilder& builder, std::string name) {
    if (!status_) return scene::kNone;
    auto glow = builder.take_emission();
    auto id = scene_.add_mesh(builder.take(), std::move(name));
    if (id && !glow.empty()) {
        if (emission.size() <= *id) emission.resize(*id + 1);
        emission[*id] = std::move(glow);
    }
    if (id) return *id;
    status_ = id.error();
    return scene::kNone;
}

scene::MeshId Library::add_polygon(const std::vector<std::vector<glm::dvec2>>& rings, const glm::dvec3& origin,
                                   const glm::dvec3& u, const glm::dvec3& v, const glm::vec3& color, std::string name) {
    if (!status_) return scene::kNone;
    scene::PlanarPolygon polygon;
    for (const auto& ring : rings) {
        polygon.polygon.points.insert(polygon.polygon.points.end(), ring.begin(), ring.end());
        polygon.polygon.ring_ends.push_back(static_cast<std::uint32_t>(polygon.polygon.points.size()));
    }
    polygon.origin = origin;
    polygon.u = u;
    polygon.v = v;
    polygon.color = color;
    const auto triangulation = triangulate::triangulate(polygon.polygon);
    if (!triangulation) {
        status_ =
            fail(triangulation.error().code, triangulation.error().item, name + ": " + triangulation.error().message);
        return scene::kNone;
    }
    auto id = scene_.add_polygon(std::move(polygon), triangulation->triangles, std::move(name));
    if (id) return *id;
    status_ = id.error();
    return scene::kNone;
}

std::vector<std::vector<glm::dvec2>> facade_rings(std::vector<glm::dvec2> outline,
                                                  const std::vector<Opening>& openings) {
    std::vector<std::vector<glm::dvec2>> rings{std::move(outline)};
    for (const Opening& o : openings)
        rings.push_back({{o.x, o.y}, {o.x, o.y + o.height}, {o.x + o.width, o.y + o.height}, {o.x + o.width, o.y}});
    return rings;
}

}  // namespace crofton::assets::town
