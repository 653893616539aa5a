// SPDX-License-Identifier: MIT
#include "scaled_shape.hpp"

#include <algorithm>
#include <cmath>
#include <crofton/convex/query.hpp>
#include <crofton/geometry/orthonormal_frame.hpp>
#include <crofton/mesh/mesh_parts.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <utility>

namespace crofton::world {
namespace {

constexpr double kOrthogonal = 1e-6, kUniform = 1e-5;

// Orthonormal and without reflection, near three orthogonal vectors of which some may be 0.
glm::dmat3 frame_of(const glm::dmat3& axes, const glm::dvec3& lengths) {
    int longest = 0;
    for (int k = 1; k < 3; ++k)
        if (lengths[k] > lengths[longest]) longest = k;
    if (!(lengths[longest] > 0.0)) return glm::dmat3(1.0);
    const int next = (longest + 1) % 3, last = (longest + 2) % 3;
    glm::dmat3 frame;
    frame[longest] = axes[longest] / lengths[longest];
    glm::dvec3 second(0.0);
    if (lengths[next] > 0.0)
        second = axes[next] / lengths[next];
    else if (lengths[last] > 0.0)
        second = glm::cross(axes[last] / lengths[last], frame[longest]);
    else
        second = unit_across(frame[longest]);
    frame[next] = glm::normalize(second - glm::dot(second, frame[longest]) * frame[longest]);
    frame[last] = glm::cross(frame[longest], frame[next]);
    return frame;
}

Result<void> refuse(const char* what) {
    return fail(ErrorCode::unsupported, kNoItem,
                {"world: the object's shape is ", what,
                 ", which its transform would turn into another kind of shape; scale it uniformly, or use a hull or a "
                 "mesh"});
}

const char* name_of(const convex::Shape& shape) {
    switch (shape.kind()) {
        case convex::Kind::sphere:
            return "a sphere";
        case convex::Kind::capsule:
            return "a capsule";
        case convex::Kind::cylinder:
            return "a cylinder";
        case convex::Kind::cone:
            return "a cone";
        case convex::Kind::height_field:
            return "a height field";
        default:
            return "rounded";
    }
}

float to_float(double value) {
    return static_cast<float>(value);
}
glm::vec3 image(const glm::dmat3& map, const glm::dvec3& point) {
    return glm::vec3(map * point);
}

}  // namespace

SplitMap split(const glm::dmat3& linear) {
    SplitMap map;
    glm::dvec3 lengths(0.0);
    for (int k = 0; k < 3; ++k) lengths[k] = glm::length(linear[k]);
    for (int k = 0; k < 3; ++k) {
        const int next = (k + 1) % 3;
        if (!(std::abs(glm::dot(linear[k], linear[next])) <= kOrthogonal * lengths[k] * lengths[next]))
            map.orthogonal = false;
    }
    if (!map.orthogonal) {
        map.rest = linear;
        map.uniform = false;
        return map;
    }
    map.sides = lengths;
    glm::dmat3 axes = linear;
    if (glm::determinant(linear) < 0.0) {
        axes[0] = -axes[0];
        map.sides.x = -map.sides.x;
    }
    map.rotation = frame_of(axes, lengths);
    map.rest = glm::transpose(map.rotation) * linear;
    const double most = std::max(lengths.x, std::max(lengths.y, lengths.z)),
                 least = std::min(lengths.x, std::min(lengths.y, lengths.z));
    map.uniform = most - least <= kUniform * most;
    return map;
}

bool is_similarity(const glm::dmat3& linear) {
    const glm::dmat3 gram = glm::transpose(linear) * linear;
    const double squared = (gram[0][0] + gram[1][1] + gram[2][2]) / 3.0;
    if (!(squared > 0.0 && std::isfinite(squared))) return false;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            if (!(std::abs(gram[i][j] - (i == j ? squared : 0.0)) <= kOrthogonal * squared)) return false;
    return true;
}

Result<std::unique_ptr<ScaledShape>> ScaledShape::make(const convex::Shape& shape, const SplitMap& map,
                                                       std::uint64_t item) {
    auto scaled = std::make_unique<ScaledShape>();
    if (auto made = scaled->make(shape, map); !made) {
        made.error().item = item;
        return made.error();
    }
    return scaled;
}

Result<void> ScaledShape::take(Result<convex::Shape> made) {
    if (!made) return made.error();
    shape_ = *made;
    return {};
}

Result<void> ScaledShape::make(const convex::Shape& shape, const SplitMap& map) {
    switch (shape.kind()) {
        case convex::Kind::mesh:
            return make_mesh(shape, map);
        case convex::Kind::height_field:
            return make_field(shape, map);
        case convex::Kind::compound:
            return make_compound(shape, map);
        case convex::Kind::half_space: {
            const glm::dmat3 turn = glm::transpose(glm::inverse(map.rest));
            const glm::dvec3 normal = turn * shape.plane().normal;
            const double length = glm::length(normal);
            if (!(length > 0.0 && std::isfinite(length)))
                return fail(ErrorCode::degenerate, kNoItem,
                            "world: the object's shape is a half-space, which its transform flattens");
            return take(convex::Shape::half_space({normal / length, shape.plane().offset / length}));
        }
        case convex::Kind::box:
        case convex::Kind::triangle:
        case convex::Kind::hull:
            if (!map.uniform && shape.radius() > 0.0) return refuse(name_of(shape));
            return make_points(shape, map);
        default:
            return make_round(shape, map);
    }
}

Result<void> ScaledShape::make_points(const convex::Shape& shape, const SplitMap& map) {
    const double rounding = shape.radius() * std::abs(map.sides.y);
    const auto take_rounded = [&](Result<convex::Shape> made) {
        if (made && rounding > 0.0) made = convex::Shape::rounded(*made, rounding);
        return take(std::move(made));
    };
    if (shape.kind() == convex::Kind::box && map.orthogonal)
        return take_rounded(convex::Shape::box(glm::vec3(shape.half_extents() * glm::abs(map.sides))));
    Vector<glm::vec3> points;
    for (int i = 0; i < shape.vertex_count(); ++i) points.push_back(image(map.rest, shape.vertex(i)));
    if (shape.kind() == convex::Kind::triangle) {
        if (glm::determinant(map.rest) < 0.0) std::swap(points[1], points[2]);
        return take_rounded(convex::Shape::triangle(points[0], points[1], points[2]));
    }
    auto hull = convex::Hull::build(points);
    if (!hull) return hull.error();
    hull_ = std::make_unique<convex::Hull>(std::move(*hull));
    return take_rounded(convex::Shape::hull(*hull_));
}

Result<void> ScaledShape::make_round(const convex::Shape& shape, const SplitMap& map) {
    const glm::dvec3 sides = glm::abs(map.sides);
    const double scale = sides.y;
    const bool turns = shape.kind() == convex::Kind::cylinder || shape.kind() == convex::Kind::cone;
    const bool stays =
        turns && shape.radius() == 0.0 && map.orthogonal && std::abs(sides.x - sides.z) <= kUniform * sides.x;
    if (!map.uniform && !stays) return refuse(name_of(shape));
    if (shape.kind() == convex::Kind::sphere) return take(convex::Shape::sphere(scale * shape.radius()));
    Result<convex::Shape> core = turns ? (shape.kind() == convex::Kind::cylinder
                                              ? convex::Shape::cylinder(to_float(scale * shape.half_extents().y),
                                                                        to_float(sides.x * shape.half_extents().x))
                                              : convex::Shape::cone(to_float(scale * shape.half_extents().y),
                                                                    to_float(sides.x * shape.half_extents().x)))
                                       : convex::Shape::capsule(to_float(scale * shape.vertex(1).y), 0.0f);
    if (core && shape.radius() > 0.0) core = convex::Shape::rounded(*core, scale * shape.radius());
    return take(std::move(core));
}

// Vertices of equal position are one, so that what was closed stays closed.
Result<void> ScaledShape::make_mesh(const convex::Shape& shape, const SplitMap& map) {
    struct Corner {
        glm::vec3 position;
        std::uint32_t place;
    };
    const mesh::MeshTree& tree = *shape.mesh();
    const std::size_t count = tree.triangle_count() + tree.rejected().size();
    Vector<Corner> corners;
    for (const mesh::MeshLeaf& leaf : tree.parts().leaves)
        for (std::uint32_t lane = 0; lane < leaf.count; ++lane)
            for (std::uint32_t v = 0; v < 3; ++v)
                corners.push_back({{leaf.vertex[v][0][lane], leaf.vertex[v][1][lane], leaf.vertex[v][2][lane]},
                                   3 * leaf.triangle[lane] + v});
    std::sort(corners.begin(), corners.end(), [](const Corner& a, const Corner& b) {
        for (int k = 0; k < 3; ++k)
            if (a.position[k] != b.position[k]) return a.position[k] < b.position[k];
        return a.place < b.place;
    });
    TriangleMesh scaled;
    scaled.indices.assign(3 * count, ~0u);  // rejected triangles stay rejected
    for (std::size_t i = 0; i < corners.size(); ++i) {
        if (i == 0 || corners[i].position != corners[i - 1].position)
            scaled.positions.push_back(image(map.rest, glm::dvec3(corners[i].position)));
        scaled.indices[corners[i].place] = static_cast<std::uint32_t>(scaled.positions.size() - 1);
    }
    if (glm::determinant(map.rest) < 0.0)
        for (std::size_t i = 0; i + 2 < scaled.indices.size(); i += 3)
            std::swap(scaled.indices[i + 1], scaled.indices[i + 2]);
    auto made = mesh::MeshTree::build(scaled);
    if (!made) return made.error();
    if (made->triangle_count() != tree.triangle_count())
        return fail(ErrorCode::out_of_range, kNoItem,
                    "world: the object's shape is a mesh that its transform puts beyond 1e12");
    mesh_ = std::make_unique<mesh::MeshTree>(std::move(*made));
    return take(convex::Shape::mesh(*mesh_, shape.sides()));
}

Result<void> ScaledShape::make_field(const convex::Shape& shape, const SplitMap& map) {
    const convex::HeightField& field = *shape.height_field();
    if (!map.orthogonal || !(map.sides.x > 0.0)) return refuse(name_of(shape));
    Vector<float> heights;
    for (std::uint32_t j = 0; j < field.rows(); ++j)
        for (std::uint32_t i = 0; i < field.columns(); ++i)
            heights.push_back(to_float(map.sides.y * field.corner(i, j).y));
    Vector<std::uint8_t> materials;
    for (std::uint32_t cell = 0; cell < field.cell_count(); ++cell) materials.push_back(field.material(cell));
    const glm::dvec2 spacing(field.corner(1, 0).x * map.sides.x, field.corner(0, 1).z * map.sides.z);
    auto made = convex::HeightField::build({.columns = field.columns(),
                                            .rows = field.rows(),
                                            .heights = {heights.data(), heights.size()},
                                            .spacing = spacing,
                                            .materials = {materials.data(), materials.size()}});
    if (!made) return made.error();
    field_ = std::make_unique<convex::HeightField>(std::move(*made));
    return take(convex::Shape::height_field(*field_, shape.sides()));
}

// Each child stands where the map puts its frame, and takes what is left of the map.
Result<void> ScaledShape::make_compound(const convex::Shape& shape, const SplitMap& map) {
    Vector<convex::CompoundChild> children;
    for (const convex::CompoundChild& child : shape.compound()->children()) {
        const SplitMap of_child = split(map.rest * child.pose.rotation);
        auto scaled = ScaledShape::make(child.shape, of_child, kNoItem);
        if (!scaled) return scaled.error();
        children.push_back({(*scaled)->shape(), {of_child.rotation, map.rest * child.pose.translation}});
        children_.push_back(std::move(*scaled));
    }
    auto made = convex::Compound::build({children.data(), children.size()});
    if (!made) return made.error();
    compound_ = std::make_unique<convex::Compound>(std::move(*made));
    return take(convex::Shape::compound(*compound_));
}

}  // namespace crofton::world
