// SPDX-License-Identifier: MIT
// Finds bodies in closed pieces: the piece itself, or boxes.
#include <algorithm>
#include <cmath>
#include <crofton/fit/fit.hpp>
#include <crofton/geometry/predicates.hpp>
#include <crofton/measure/measure.hpp>
#include <glm/geometric.hpp>
#include <optional>

#include "finding/candidates.hpp"
#include "finding/inscribed_box.hpp"
#include "finding/solid_grid.hpp"

namespace crofton::occlude {
namespace {

constexpr std::size_t kMostConvexTriangles = 256;  // the check is quadratic, and larger ones cost much to draw
constexpr std::uint32_t kCoarseCells = 12;         // to choose a frame

Vector<std::uint32_t> vertices_of(const PieceMesh& mesh, const Piece& piece) {
    Vector<std::uint32_t> vertices;
    for (const std::uint32_t t : mesh.of(piece))
        vertices.insert(vertices.end(), mesh.triangles[t].begin(), mesh.triangles[t].end());
    std::sort(vertices.begin(), vertices.end());
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    return vertices;
}

// Whether no vertex lies in front of a face (sign > 0) or behind one (sign < 0), decided exactly.
bool is_on_one_side(const PieceMesh& mesh, const Piece& piece, std::span<const std::uint32_t> vertices, int sign) {
    for (const std::uint32_t index : mesh.of(piece)) {
        const Triangle t = mesh.corners(index);
        for (const std::uint32_t v : vertices)
            if (orientation(t[0], t[1], t[2], glm::dvec3(mesh.positions[v])) * sign < 0) return false;
    }
    return true;
}

// Sides between triangles that are not in one plane.
std::uint32_t count_creases(const PieceMesh& mesh, const Piece& piece) {
    std::uint32_t creases = 0;
    for (const std::uint32_t index : mesh.of(piece)) {
        const Triangle t = mesh.corners(index);
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t other = mesh.neighbors[index][k];
            if (other == kNoNeighbor || other < index) continue;
            const Triangle u = mesh.corners(other);
            creases += std::any_of(u.begin(), u.end(),
                                   [&](const glm::dvec3& p) { return orientation(t[0], t[1], t[2], p) != 0; })
                           ? 1
                           : 0;
        }
    }
    return creases;
}

glm::dvec3 normal_of(const Triangle& t) {  // of twice the area's length
    return glm::cross(t[1] - t[0], t[2] - t[0]);
}

double area_of(std::span<const Triangle> triangles) {
    double area = 0.0;
    for (const Triangle& t : triangles) area += 0.5 * glm::length(normal_of(t));
    return area;
}

Vector<Triangle> triangles_of(const PieceMesh& mesh, const Piece& piece) {
    Vector<Triangle> triangles;
    for (const std::uint32_t t : mesh.of(piece)) triangles.push_back(mesh.corners(t));
    return triangles;
}

// The direction that most area faces, of those nearly across `across`: areas of directions within 8° are added to the
// largest triangle's.
glm::dvec3 dominant_normal(std::span<const Triangle> triangles, const glm::dvec3& across) {
    std::array<glm::dvec3, 8> sums{};
    std::size_t count = 0;
    for (const Triangle& t : triangles) {
        const glm::dvec3 n = normal_of(t);
        const double length = glm::length(n);
        if (!(length > 0.0) || std::abs(glm::dot(n, across)) > 0.1 * length) continue;
        std::size_t k = 0;
        for (; k < count; ++k) {
            const double along = glm::dot(sums[k], n);
            if (std::abs(along) < 0.99 * glm::length(sums[k]) * length) continue;
            sums[k] += along > 0.0 ? n : -n;
            break;
        }
        if (k == count && count < sums.size()) sums[count++] = n;
    }
    glm::dvec3 best(0.0);
    for (std::size_t k = 0; k < count; ++k)
        if (glm::dot(sums[k], sums[k]) > glm::dot(best, best)) best = sums[k];
    const double length = glm::length(best);
    return length > 0.0 ? best / length : glm::dvec3(0.0);
}

glm::dvec3 any_across(const glm::dvec3& u) {
    const glm::dvec3 size = glm::abs(u);
    glm::dvec3 axis(0.0);
    axis[size.x <= size.y && size.x <= size.z ? 0 : (size.y <= size.z ? 1 : 2)] = 1.0;
    return glm::normalize(glm::cross(u, axis));
}

// Whether axes of both lie along each other, in any order, to a thousandth.
bool same_frame(const glm::mat3& a, const glm::mat3& b) {
    for (int i = 0; i < 3; ++i) {
        float most = 0.0f;
        for (int j = 0; j < 3; ++j) most = std::max(most, std::abs(glm::dot(a[i], b[j])));
        if (most < 1.0f - 1e-6f) return false;
    }
    return true;
}

// The mesh's own axes, those of the directions that most area faces, those of the least box.
Vector<glm::mat3> frames_of(const PieceMesh& mesh, std::span<const Triangle> triangles,
                            std::span<const std::uint32_t> vertices) {
    Vector<glm::mat3> frames{glm::mat3(1.0f)};
    const auto add = [&](const glm::mat3& frame) {
        if (std::none_of(frames.begin(), frames.end(), [&](const glm::mat3& f) { return same_frame(f, frame); }))
            frames.push_back(frame);
    };
    const glm::dvec3 first = dominant_normal(triangles, glm::dvec3(0.0));
    if (glm::dot(first, first) > 0.0) {
        glm::dvec3 second = dominant_normal(triangles, first);
        second -= glm::dot(first, second) * first;
        second = glm::dot(second, second) > 0.0 ? glm::normalize(second) : any_across(first);
        add(glm::mat3(glm::dmat3(first, second, glm::cross(first, second))));
    }
    Vector<glm::vec3> points;
    for (const std::uint32_t v : vertices) points.push_back(mesh.positions[v]);
    if (const auto box = fit::fit_obb(points, {.criterion = measure::minimal_area(), .quality = fit::Quality::fast}))
        add(box->axes);
    return frames;
}

// The best box of the grid's free cells, pushed to the surface.
std::optional<FrameBox> grow_box(const FramedPiece& framed, const SolidGrid& grid, double least) {
    FrameBox box = grid.best_box(least);
    if (!(box.mean_shadow() > 0.0)) return std::nullopt;
    push_faces(framed, box);
    return box;
}

}  // namespace

TriangleMesh surface_of(const StoredBox& box) {
    TriangleMesh mesh;
    mesh.positions.assign(box.corners.begin(), box.corners.end());
    // Corner numbers: bit k is the + side of axis k. The axes are right-handed up to rounding.
    const bool turned = glm::dot(glm::cross(box.box.axes[0], box.box.axes[1]), box.box.axes[2]) < 0.0f;
    constexpr std::uint32_t kFaces[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                            {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
    for (const auto& f : kFaces)
        for (const std::size_t i : {0u, 1u, 2u, 0u, 2u, 3u}) mesh.indices.push_back(f[turned ? 3 - i : i]);
    return mesh;
}

bool is_closed(const Piece& piece, Sides sides) {
    return sides == Sides::front ? piece.balanced : piece.even;
}

bool is_inside(const Search& search, const Piece& piece, const glm::dvec3& point) {
    const Winding winding = winding_around(search.mesh, piece, point);
    return search.options.sides == Sides::front ? winding.number > 0 : winding.odd;
}

Aabb bounds_of(const PieceMesh& mesh, const Piece& piece) {
    Aabb bounds;
    for (const std::uint32_t t : mesh.of(piece))
        for (const glm::dvec3& p : mesh.corners(t)) bounds.include(p);
    return bounds;
}

TriangleMesh part_of(const PieceMesh& mesh, std::span<const std::uint32_t> triangles) {
    TriangleMesh part;
    Vector<std::uint32_t> vertices;
    for (const std::uint32_t t : triangles)
        vertices.insert(vertices.end(), mesh.triangles[t].begin(), mesh.triangles[t].end());
    std::sort(vertices.begin(), vertices.end());
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    for (const std::uint32_t v : vertices) part.positions.push_back(mesh.positions[v]);
    for (const std::uint32_t t : triangles)
        for (const std::uint32_t v : mesh.triangles[t])
            part.indices.push_back(
                static_cast<std::uint32_t>(std::lower_bound(vertices.begin(), vertices.end(), v) - vertices.begin()));
    return part;
}

// Take a connected closed surface whose every triangle lies in a supporting plane of all vertices. If it winds round an
// inner point once, it is the boundary of the hull.
bool add_convex_piece(const Search& search, const Piece& piece, Vector<FoundOccluder>& found) {
    const PieceMesh& mesh = search.mesh;
    if (!piece.manifold || piece.end - piece.begin > kMostConvexTriangles) return false;
    const Vector<std::uint32_t> vertices = vertices_of(mesh, piece);
    const bool outward = is_on_one_side(mesh, piece, vertices, 1);
    if (!outward && (search.options.sides == Sides::front || !is_on_one_side(mesh, piece, vertices, -1))) return false;
    glm::dvec3 middle(0.0);
    for (const std::uint32_t v : vertices)
        middle += glm::dvec3(mesh.positions[v]) / static_cast<double>(vertices.size());
    const Vector<Triangle> triangles = triangles_of(mesh, piece);
    // Rounding may put the middle of a thin piece onto its surface; such a body is not worth having.
    for (const Triangle& t : triangles)
        if (glm::dot(normal_of(t), normal_of(t)) > 0.0 && orientation(t[0], t[1], t[2], middle) == 0) return false;
    if (winding_around(mesh, piece, middle).number != (outward ? 1 : -1)) return false;
    FoundOccluder occluder;
    occluder.kind = OccluderKind::convex;
    occluder.surface = part_of(mesh, mesh.of(piece));
    if (!outward)
        for (std::size_t i = 0; i < occluder.surface.indices.size(); i += 3)
            std::swap(occluder.surface.indices[i], occluder.surface.indices[i + 1]);
    occluder.piece_bounds = bounds_of(mesh, piece);
    occluder.mean_shadow = 0.25 * area_of(triangles);
    occluder.edges = count_creases(mesh, piece);
    if (occluder.mean_shadow >= search.least_shadow) found.push_back(std::move(occluder));
    return true;
}

void add_boxes(const Search& search, const Piece& piece, Vector<FoundOccluder>& found) {
    const Vector<Triangle> triangles = triangles_of(search.mesh, piece);
    FramedPiece best;
    double best_shadow = 0.0;
    for (const glm::mat3& axes : frames_of(search.mesh, triangles, vertices_of(search.mesh, piece))) {
        FramedPiece framed = frame_piece(triangles, axes);
        SolidGrid grid(framed, search.options.sides, std::min(kCoarseCells, search.options.grid));
        const auto box = grow_box(framed, grid, 0.0);
        if (!box || box->mean_shadow() <= 1.001 * best_shadow) continue;
        best_shadow = box->mean_shadow();
        best = std::move(framed);
    }
    if (best.triangles.empty()) best = frame_piece(triangles, glm::mat3(1.0f));
    SolidGrid grid(best, search.options.sides, search.options.grid);
    for (std::uint32_t k = 0; k < search.options.max_boxes_a_piece; ++k) {
        const auto box = grow_box(best, grid, k == 0 ? 0.0 : 0.5 * search.least_shadow);
        if (!box || box->mean_shadow() < search.least_shadow) return;
        grid.cover(*box);
        const auto stored = certify(best, *box);
        if (!stored || !is_inside(search, piece, stored->box.center)) continue;
        FoundOccluder occluder;
        occluder.box = stored->box;
        occluder.surface = surface_of(*stored);
        occluder.piece_bounds = bounds_of(search.mesh, piece);
        occluder.mean_shadow = 0.25 * surface_area(stored->box);
        occluder.edges = 12;
        found.push_back(std::move(occluder));
    }
}

}  // namespace crofton::occlude
