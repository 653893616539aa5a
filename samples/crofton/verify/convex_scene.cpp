// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>
#include <crofton/convex/shape.hpp>
#include <crofton/core/error.hpp>
#include <crofton/geometry/mesh.hpp>
#include <crofton/geometry/predicates.hpp>
#include <crofton/mesh/mesh_tree.hpp>
#include <cstdio>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "assets/scene_source.hpp"
#include "commands/polygon_files.hpp"
#include "convex_pairs.hpp"
#include "exact_shapes.hpp"
#include "topics.hpp"

namespace crofton::cli {
namespace {

using Points = std::vector<glm::vec3>;
using convex::ShapeAtPose;

struct ShapeData {
    std::vector<convex::Hull> hulls;
    std::vector<std::vector<glm::vec3>> hull_points;  // that each was built of
    std::size_t flat = 0;                             // meshes and pieces without a hull
    // One of the two.
    mesh::MeshTree tree;
    std::optional<convex::HeightField> field;
    std::vector<Triangle> triangles;  // of the surface, each as a part of it; coordinates are floats
    double size = 0.0;                // the diagonal of the box around it

    [[nodiscard]] convex::Shape surface() const {
        return field ? convex::Shape::height_field(*field, convex::Sides::both) : *convex::Shape::mesh(tree);
    }
};

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

// Hulls are of the whole scene, of each mesh and of its pieces. A mesh of more than 64 triangles is cut at the median
// of its triangles three times, across its longest side: at most eight pieces. A map's polygons are steps of several
// heights on a grid of 257².
Result<ShapeData> read_shape_data(const std::string& source, const assets::LoadOptions& which) {
    const bool is_level = source.size() > 4 && source.substr(source.size() - 4) == ".wad";
    return is_polygon_file(source) && !is_level ? data_of_map(source) : data_of_scene(source, which);
}

constexpr double kSceneOffsets[] = {0.0, 1e3, 1e7};  // in sizes

struct Tally {
    std::uint64_t cases = 0, wrong = 0, meeting = 0;
};

VerifyRow row_of(const std::string& claim, const char* source, const Tally& tally) {
    return none_row(claim, source, tally.cases, tally.wrong);
}

std::string at_offset(double offset) {
    char text[40];
    std::snprintf(text, sizeof text, " at %g sizes: ", offset);
    return text;
}

// No point of what a hull was built of lies outside.
VerifyRow hulls_hold_points(const ShapeData& data) {
    Tally tally;
    std::size_t larger = 0;
    for (std::size_t h = 0; h < data.hulls.size(); ++h) {
        const convex::Hull& hull = data.hulls[h];
        larger += hull.max_overshoot() > 0.0;
        const auto at = [&](std::size_t i) { return glm::dvec3(hull.vertices()[hull.triangles()[i]]); };
        for (std::size_t t = 0; t < hull.triangles().size(); t += 3)
            for (const glm::vec3& p : data.hull_points[h])
                tally.wrong += orientation(at(t), at(t + 1), at(t + 2), glm::dvec3(p)) < 0;
        tally.cases += data.hull_points[h].size();
    }
    return row_of(std::to_string(data.hulls.size()) + " hulls of meshes and pieces (" + std::to_string(larger) +
                      " of them cut to 256 corners, " + std::to_string(data.flat) + " flat): each holds all its points",
                  "exact orientations", tally);
}

VerifyRow hulls_that_touch(const ShapeData& data, double offset, const VerifyOptions& options) {
    const std::uint64_t pairs = std::max<std::uint64_t>(20, options.trials / 2000);
    ConvexPairs random(options.seed + 80 + static_cast<std::uint64_t>(std::log10(offset + 1.0)));
    Tally tally;
    for (; tally.cases < pairs; ++tally.cases) {
        const convex::Shape a = convex::Shape::hull(data.hulls[random.bits() % data.hulls.size()]);
        const convex::Shape b = convex::Shape::hull(data.hulls[random.bits() % data.hulls.size()]);
        const double size = a.core_radius() + b.core_radius();
        const double gap = size * std::pow(10.0, random.number(-12.0, -1.0)) * (tally.cases % 2 == 0 ? 1.0 : -1.0);
        const ConvexPairs::Pair pair = random.touching(a, b, gap, offset * data.size);
        const bool truth = meet_exactly(pair.placed_a(), pair.placed_b(), pair.normal);
        const bool apart = convex::distance(pair.placed_a(), pair.placed_b()).distance > 0.0;
        const bool deep = convex::penetration(pair.placed_a(), pair.placed_b()).overlapping;
        const bool has_points = convex::contact_manifold(pair.placed_a(), pair.placed_b()).count > 0;
        tally.wrong += (convex::intersects(pair.placed_a(), pair.placed_b()) != truth) + (apart == truth) +
                       (deep != truth) + (has_points != truth);
        tally.meeting += truth;
    }
    return row_of("these hulls," + at_offset(offset) + std::to_string(pairs) + " pairs with gaps of 1e-1 to 1e-12, " +
                      std::to_string(tally.meeting) + " meet; none wrong",
                  "planes, common points and separating axes in exact numbers", tally);
}

// Triangles of a surface that may be within `far` of a shape.
class TriangleTruth {
  public:
    TriangleTruth(const ShapeData& data, const ShapeAtPose& surface) : data_(data), surface_(surface) {}

    template <class Visit>
    void visit_near(const ShapeAtPose& shape, double far, Visit visit) const {
        const glm::dvec3 middle =
            glm::transpose(surface_.pose.rotation) * (shape.pose.translation - surface_.pose.translation);
        const double reach =
            (shape.shape.core_radius() + far) * (1.0 + 1e-5) + 1e-9 * (data_.size + glm::length(middle));
        for (const Triangle& t : data_.triangles) {
            const glm::dvec3 low = glm::min(glm::min(t[0], t[1]), t[2]), high = glm::max(glm::max(t[0], t[1]), t[2]);
            const glm::dvec3 gap = glm::max(glm::max(low - middle, middle - high), glm::dvec3(0.0));
            if (glm::dot(gap, gap) > reach * reach) continue;
            const convex::Shape part = *convex::Shape::triangle(glm::vec3(t[0]), glm::vec3(t[1]), glm::vec3(t[2]));
            if (!visit(ShapeAtPose{part, surface_.pose})) return;
        }
    }
    [[nodiscard]] bool meets(const ShapeAtPose& shape) const {
        bool met = false;
        visit_near(shape, 0.0, [&](const ShapeAtPose& part) {
            const convex::Distance d = convex::distance(part, shape);
            // Nearly all are apart, by the plane that their distance gives.
            met = !(d.distance > 0.0 && is_parted_by(part, shape, d.normal)) && meet_exactly(part, shape, d.normal);
            return !met;
        });
        return met;
    }
    // Lower and upper bounds of the distance, by all triangles that may be nearest.
    [[nodiscard]] std::array<double, 2> distance(const ShapeAtPose& shape, double far) const {
        std::array<double, 2> least{HUGE_VAL, HUGE_VAL};
        visit_near(shape, far, [&](const ShapeAtPose& part) {
            const convex::Distance d = convex::distance(part, shape);
            least = {std::min(least[0], d.lower), std::min(least[1], d.upper)};
            return true;
        });
        return least;
    }

  private:
    const ShapeData& data_;
    const ShapeAtPose& surface_;
};

// A box of 0.1 to 6 % of the surface's size, or one of the hulls if they are small.
convex::Shape probe_of(const ShapeData& data, ConvexPairs& random) {
    if (!data.hulls.empty() && random.bits() % 2 == 0) {
        const convex::Shape hull = convex::Shape::hull(data.hulls[random.bits() % data.hulls.size()]);
        if (hull.core_radius() < 0.1 * data.size) return hull;
    }
    const double scale = 0.5 * data.size * std::pow(10.0, random.number(-2.0, -1.0));
    const double x = random.number(0.1, 0.6), y = random.number(0.1, 0.6), z = random.number(0.1, 0.6);
    return *convex::Shape::box(glm::vec3(scale * glm::dvec3(x, y, z)));
}

// A probe that touches one triangle of the surface, but for a gap; and if `nearest`, none nearer than that.
ConvexPairs::Pair place_probe(const ShapeData& data, double gap, double offset, bool nearest, ConvexPairs& random) {
    const Triangle& t = data.triangles[random.bits() % data.triangles.size()];
    const convex::Shape part = *convex::Shape::triangle(glm::vec3(t[0]), glm::vec3(t[1]), glm::vec3(t[2]));
    const convex::Shape probe = probe_of(data, random);
    if (!nearest) return random.touching(part, probe, gap, offset);
    ConvexPairs::Pair pair = random.touching(part, probe, random.number(0.0, 0.3) * data.size, offset);
    const convex::Distance d = convex::distance({data.surface(), pair.pose_a}, pair.placed_b());
    pair.pose_b.translation -= (d.distance - gap) * d.normal;
    return pair;
}

VerifyRow surface_touched(const ShapeData& data, double offset, const VerifyOptions& options) {
    const std::uint64_t pairs = std::max<std::uint64_t>(20, options.trials / 4000);
    ConvexPairs random(options.seed + 90 + static_cast<std::uint64_t>(std::log10(offset + 1.0)));
    const convex::Shape whole = data.surface();
    Tally tally;
    for (; tally.cases < pairs; ++tally.cases) {
        const double gap = 0.1 * data.size * std::pow(10.0, random.number(-12.0, -1.0));
        const ConvexPairs::Pair pair =
            place_probe(data, tally.cases % 2 == 0 ? gap : -gap, offset * data.size, tally.cases % 4 < 2, random);
        const ShapeAtPose surface{whole, pair.pose_a}, probe = pair.placed_b();
        const TriangleTruth triangles(data, surface);
        const bool truth = triangles.meets(probe);
        const convex::Distance d = convex::distance(surface, probe);
        const bool has_points = convex::contact_manifold(surface, probe).count > 0;
        tally.wrong += (convex::intersects(surface, probe) != truth) + ((d.distance == 0.0) != truth);
        tally.wrong += has_points != truth;
        tally.meeting += truth;
        if (truth) continue;
        const std::array<double, 2> least = triangles.distance(probe, d.distance);
        const double error_bound = 1e-9 * (data.size + glm::length(pair.pose_b.translation - pair.pose_a.translation));
        tally.wrong += !(d.distance <= least[1] + error_bound && d.distance >= least[0] - error_bound);
    }
    return row_of(std::to_string(data.triangles.size()) + " triangles as one " +
                      (data.field ? "height field," : "mesh,") + at_offset(offset) + std::to_string(pairs) +
                      " shapes with gaps of 1e-2 to 1e-13, " + std::to_string(tally.meeting) +
                      " meet; none wrong, distances as of the nearest triangle",
                  "each triangle near it in exact numbers", tally);
}

// Shapes that fly at the surface: at no moment before the impact do they meet a triangle.
VerifyRow surface_hit(const ShapeData& data, const VerifyOptions& options) {
    constexpr int kMoments = 50;
    const std::uint64_t casts = std::max<std::uint64_t>(4, options.trials / 20'000);
    ConvexPairs random(options.seed + 95);
    const convex::Shape whole = data.surface();
    Tally tally;
    std::uint64_t hits = 0;
    for (std::uint64_t i = 0; i < casts; ++i) {
        const ConvexPairs::Pair pair = place_probe(data, 0.1 * data.size, 0.0, i % 2 == 0, random);
        const ShapeAtPose surface{whole, pair.pose_a}, probe = pair.placed_b();
        const double rate = random.number(0.0, 6.0);
        const convex::Motion motion{-0.3 * data.size * pair.normal, rate * random.direction(), {}};
        const double tolerance = 1e-6 * data.size;
        const auto impact = convex::cast(surface, {}, probe, motion, {.tolerance = tolerance});
        tally.wrong += !impact || impact->result == convex::CastResult::unresolved;
        if (!impact || impact->result == convex::CastResult::unresolved) continue;
        const TriangleTruth triangles(data, surface);
        const auto at = [&](double time) { return convex::moved(pair.pose_b, motion, time); };
        const bool hit = impact->result == convex::CastResult::hit;
        hits += hit;
        const double end = hit ? impact->time : 1.0;
        for (int k = 0; k < kMoments && end > 0.0; ++k, ++tally.cases) {
            const RigidTransform pose = at(end * (k + 0.5) / kMoments);
            tally.wrong += triangles.meets({pair.b, pose});
        }
        const RigidTransform last = at(end);
        tally.wrong += hit && triangles.distance({pair.b, last}, 2.0 * tolerance)[0] > tolerance;
    }
    return row_of(std::to_string(casts) + " casts of turning shapes at it, " + std::to_string(hits) +
                      " hits: none meets a triangle at " + std::to_string(kMoments) +
                      " moments before, and then one is within the tolerance",
                  "each triangle near it in exact numbers", tally);
}

}  // namespace

Result<std::vector<VerifyRow>> verify_collided_scene(const std::string& source, const assets::LoadOptions& which,
                                                     const VerifyOptions& options) {
    const auto data = read_shape_data(source, which);
    if (!data) return data.error();
    std::vector<VerifyRow> rows;
    if (!data->hulls.empty()) {
        rows.push_back(hulls_hold_points(*data));
        for (const double offset : kSceneOffsets) rows.push_back(hulls_that_touch(*data, offset, options));
    }
    for (const double offset : kSceneOffsets) rows.push_back(surface_touched(*data, offset, options));
    rows.push_back(surface_hit(*data, options));
    const std::string name = source.substr(source.find_last_of("/\\") + 1) + (which.map.empty() ? "" : " " + which.map);
    for (VerifyRow& row : rows) row.claim = name + ": " + row.claim;
    return rows;
}

}  // namespace crofton::cli
