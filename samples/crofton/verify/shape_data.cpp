// SPDX-License-Identifier: MIT
#include "shape_data.hpp"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <span>

#include "commands/polygon_files.hpp"

namespace crofton::cli {
namespace {

using Points = std::vector<glm::vec3>;

Triangle triangle_of(const TriangleMesh& mesh, std::size_t t) {
    const auto at = [&](std::size_t k) { return glm::dvec3(mesh.positions[mesh.indices[3 * t + k]]); };
    return {at(0), at(1), at(2)};
}

void add_hull(const Points& points, ShapeData& data) {
    auto hull = convex::Hull::build(points);
    if (!hull) {
        ++data.flat;
        return;
    }
    data.hulls.push_back(std::move(*hull));
    data.hull_points.push_back(points);
}

// Adds the hulls of pieces of the triangles begin … end of `order`.
void add_pieces(const TriangleMesh& mesh, std::uint32_t* begin, std::uint32_t* end, int cuts, ShapeData& data) {
    Points points;
    Aabb middles;
    const auto middle = [&](std::uint32_t t) {
        const Triangle corners = triangle_of(mesh, t);
        return (corners[0] + corners[1] + corners[2]) / 3.0;
    };
    for (const std::uint32_t* t = begin; t != end; ++t) {
        for (std::size_t k = 0; k < 3; ++k) points.push_back(mesh.positions[mesh.indices[3 * std::size_t{*t} + k]]);
        middles.include(middle(*t));
    }
    add_hull(points, data);
    if (cuts == 0 || end - begin <= 64) return;
    const glm::dvec3 half = middles.half_extents();
    const int axis = half.x >= half.y && half.x >= half.z ? 0 : half.y >= half.z ? 1 : 2;
    std::uint32_t* const cut = begin + (end - begin) / 2;
    std::sort(begin, end, [&](std::uint32_t a, std::uint32_t b) {
        const double of_a = middle(a)[axis], of_b = middle(b)[axis];
        return of_a != of_b ? of_a < of_b : a < b;
    });
    add_pieces(mesh, begin, cut, cuts - 1, data);
    add_pieces(mesh, cut, end, cuts - 1, data);
}

void add_mesh(const TriangleMesh& mesh, ShapeData& data) {
    std::vector<std::uint32_t> order(mesh.indices.size() / 3);
    for (std::uint32_t t = 0; t < order.size(); ++t) order[t] = t;
    add_pieces(mesh, order.data(), order.data() + order.size(), 3, data);
}

Result<ShapeData> data_of_scene(const std::string& source, const assets::LoadOptions& which) {
    auto loaded = assets::load_scene(source, which);
    if (!loaded) return loaded.error();
    scene::Scene& scene = loaded->scene;
    scene.update();
    ShapeData data;
    TriangleMesh all;
    std::vector<bool> has_hulls;
    for (scene::InstanceId i = 0; i < scene.instance_count(); ++i) {
        if (scene.is_removed(i)) continue;
        const scene::MeshId id = scene.mesh_of(i);
        TriangleMesh mesh = scene.mesh(id);
        if (has_hulls.size() <= id) has_hulls.resize(id + std::size_t{1});
        if (!has_hulls[id]) add_mesh(mesh, data);
        has_hulls[id] = true;
        const Transform& world = scene.world(scene.node_of(i));
        for (glm::vec3& p : mesh.positions) p = glm::vec3(world.linear * glm::dvec3(p) + world.translation);
        append(all, mesh);
    }
    add_mesh(all, data);
    auto tree = mesh::MeshTree::build(all);
    if (!tree) return tree.error();
    data.tree = std::move(*tree);
    Aabb bounds;
    for (std::size_t t = 0; t < all.indices.size() / 3; ++t) {
        if (std::binary_search(data.tree.rejected().begin(), data.tree.rejected().end(), t)) continue;
        data.triangles.push_back(triangle_of(all, t));
        for (const glm::dvec3& p : data.triangles.back()) bounds.include(p);
    }
    data.size = 2.0 * glm::length(bounds.half_extents());
    return data;
}

// Where the row at y is within the polygon, by the even-odd rule: places along x, two a stretch.
std::vector<double> crossings(const Polygon& polygon, double y) {
    std::vector<double> places;
    for (std::size_t r = 0; r < polygon.ring_count(); ++r) {
        const std::span<const glm::dvec2> ring = polygon.ring(r);
        for (std::size_t i = 0; i < ring.size(); ++i) {
            const glm::dvec2 &p = ring[i], &q = ring[i + 1 < ring.size() ? i + 1 : 0];
            if ((p.y <= y) != (q.y <= y)) places.push_back(p.x + (y - p.y) / (q.y - p.y) * (q.x - p.x));
        }
    }
    std::sort(places.begin(), places.end());
    return places;
}

constexpr std::uint32_t kMapSide = 257;

// Returns the polygon over each corner of the grid, counted from 1; 0: none.
std::vector<std::uint32_t> raster(const PolygonFile& file) {
    glm::dvec2 low(HUGE_VAL), high(-HUGE_VAL);
    for (const NamedPolygon& named : file.polygons)
        for (const glm::dvec2& p : named.polygon.points) low = glm::min(low, p), high = glm::max(high, p);
    const glm::dvec2 cell = (high - low) / double{kMapSide - 1};
    std::vector<std::uint32_t> over(std::size_t{kMapSide} * kMapSide);
    for (std::uint32_t k = 0; k < file.polygons.size(); ++k)
        for (std::uint32_t j = 0; j < kMapSide; ++j) {
            const std::vector<double> places = crossings(file.polygons[k].polygon, low.y + j * cell.y);
            for (std::size_t s = 0; s + 1 < places.size(); s += 2)
                for (double i = std::ceil((places[s] - low.x) / cell.x); i <= (places[s + 1] - low.x) / cell.x; ++i)
                    if (i >= 0.0 && i < kMapSide) over[std::size_t{j} * kMapSide + static_cast<std::size_t>(i)] = k + 1;
        }
    return over;
}

Result<ShapeData> data_of_map(const std::string& source) {
    const auto file = read_polygons(source, "");
    if (!file) return file.error();
    const std::vector<std::uint32_t> over = raster(*file);
    std::vector<float> heights(over.size());
    for (std::size_t i = 0; i < over.size(); ++i) heights[i] = 0.5f * static_cast<float>(over[i] * 7 % 16);
    std::vector<std::uint8_t> materials(std::size_t{kMapSide - 1} * (kMapSide - 1));
    for (std::size_t j = 0; j + 1 < kMapSide; ++j)
        for (std::size_t i = 0; i + 1 < kMapSide; ++i) {
            const std::size_t at = j * kMapSide + i;
            const bool none = (over[at] | over[at + 1] | over[at + kMapSide] | over[at + kMapSide + 1]) == 0;
            materials[j * (kMapSide - 1) + i] = none ? convex::kHole : static_cast<std::uint8_t>(over[at] % 200);
        }
    ShapeData data;
    auto field =
        convex::HeightField::build({.columns = kMapSide, .rows = kMapSide, .heights = heights, .materials = materials});
    if (!field) return field.error();
    data.field = std::move(*field);
    for (std::uint32_t t = 0; t < 2 * data.field->cell_count(); ++t)
        if (data.field->material(t / 2) != convex::kHole) data.triangles.push_back(data.field->triangle(t));
    data.size = 2.0 * glm::length(data.field->bounds().half_extents());
    return data;
}

}  // namespace

Result<ShapeData> read_shape_data(const std::string& source, const assets::LoadOptions& which) {
    const bool is_level = source.size() > 4 && source.substr(source.size() - 4) == ".wad";
    return is_polygon_file(source) && !is_level ? data_of_map(source) : data_of_scene(source, which);
}

}  // namespace crofton::cli
