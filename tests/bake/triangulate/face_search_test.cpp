// SPDX-License-Identifier: MIT
// Choices among triangulations whose rounded weights come in the wrong order.
#include <doctest/doctest.h>
#include <gmpxx.h>
#include <crofton/geometry/mesh.hpp>
#include <vector>

#include "minimum_weight/face_search.hpp"

using namespace crofton;
using namespace crofton::triangulate;

namespace {

// The diagonals of a ring with one point inside, by the search alone: no edge is certain but the ring's.
std::vector<Segment> diagonals_of(const Polygon& polygon) {
    Domain domain;
    REQUIRE(domain.build(polygon).has_value());
    const TriangulateOptions options;
    Watch watch(options);
    CandidateGraph graph;
    CandidateFinder finder;
    REQUIRE(finder.find(domain, 1000, watch, graph));
    Faces faces;
    find_faces(graph, CandidateGraph::kConstraint, faces);
    Index name = 0;
    while (faces.component[name] != name || faces.component_size[name] != 2) ++name;
    FaceSearch search;
    Vector<std::array<Index, 3>> triangles;
    Vector<Segment> found;
    REQUIRE(search.solve(domain.mesh().points, graph, faces, name, watch, triangles, found) ==
            FaceSearch::Outcome::solved);
    std::vector<Segment> result;
    for (const Segment& s : found) result.push_back({domain.input_of(s.from), domain.input_of(s.to)});
    return result;
}

// By lengths of 256 bits.
mpf_class weight_of(const Polygon& polygon, const std::vector<Segment>& diagonals) {
    mpf_class sum(0, 256);
    for (const Segment& s : diagonals) {
        const glm::dvec2 a = polygon.points[s.from], b = polygon.points[s.to];
        const mpf_class x = mpf_class(a.x, 256) - mpf_class(b.x, 256), y = mpf_class(a.y, 256) - mpf_class(b.y, 256);
        sum += sqrt(mpf_class(x * x + y * y, 256));
    }
    return sum;
}

}  // namespace

TEST_SUITE("triangulate/face search") {
    TEST_CASE("two triangulations mirror each other except for one last bit, and the lighter one is found") {
        // Found by search: the sums of doubles differ the wrong way, by over a sixteenth of the bound of their errors.
        std::vector<glm::dvec2> ring = {
            {0x1.06fc7d741cff5p-1, -0x1.e4c75a23462f7p+0}, {0x1.0fc73c775f566p+0, -0x1.a442a6042c8abp+0},
            {0x1.d57723ee8e62p+0, -0x1.3e95302f1db13p-1},  {0x1.d2c681decd68p+0, 0x1.4e80eda23f377p-1},
            {0x1.189ac319c705dp+0, 0x1.9e3ae53ee3241p+0},  {0x1.6c88664533ff6p-1, 0x1.d3832182995f8p+0}};
        for (std::size_t i = 6; i-- > 0;) ring.emplace_back(-ring[i].x, ring[i].y);
        ring[9].x = -0x1.d57723ee8e621p+0;
        Polygon p;
        p.points.assign(ring.begin(), ring.end());
        p.points.emplace_back(0.0, -0x1.813de1ec8ecc4p-4);
        p.ring_ends = {12, 13};
        const std::vector<Segment> found = diagonals_of(p);
        CHECK(found.size() == 12);
        // Its mirror image is a triangulation too.
        std::vector<Segment> image = found;
        for (Segment& s : image)
            for (std::uint32_t* end : {&s.from, &s.to}) *end = *end == 12 ? 12 : 11 - *end;
        const mpf_class heavier = weight_of(p, image) - weight_of(p, found);
        CHECK(heavier > 1e-17);
        CHECK(heavier < 1e-15);
    }
}
