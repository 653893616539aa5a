// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <algorithm>
#include <cmath>
#include <crofton/lines/lines.hpp>
#include <crofton/radiosity/patches.hpp>
#include <error_of.hpp>
#include <glm/geometric.hpp>
#include <limits>

#include "../../study/radiosity/shapes.hpp"

using namespace crofton;
using namespace crofton::lines;

namespace {

struct Difference {
    std::size_t crossings = 0, wrong = 0;
};

// Crossing by crossing against the hierarchy's answer for the same lines.
Difference compare(const TriangleMesh& mesh, double cell_area, const std::array<double, 2>& u, std::uint64_t seed) {
    const auto by_bundle = BundleTracer::build(mesh);
    const auto by_line = LineTracer::build(mesh);
    REQUIRE(by_bundle.has_value());
    const Bundle bundle = make_bundle(by_bundle->bounds(), cell_area, u, seed);
    std::vector<Line> lines;
    for (std::size_t i = 0; i < bundle.cells(); ++i) lines.push_back(bundle.line(i));
    BundleTracer::Scratch scratch;
    LineHits ours, theirs;
    by_bundle->all_hits(bundle, scratch, ours);
    by_line->all_hits(lines, theirs);
    REQUIRE(ours.ends.size() == theirs.ends.size());
    Difference result;
    std::uint32_t a = 0, b = 0;
    for (std::size_t l = 0; l < lines.size(); ++l) {
        const std::span<const Hit> x(ours.hits.data() + a, ours.ends[l] - a),
            y(theirs.hits.data() + b, theirs.ends[l] - b);
        result.crossings += y.size();
        if (x.size() != y.size()) {
            ++result.wrong;
        } else {
            for (std::size_t h = 0; h < x.size(); ++h)
                if (x[h].triangle != y[h].triangle || x[h].front != y[h].front || std::abs(x[h].t - y[h].t) > 1e-3f)
                    ++result.wrong;
        }
        a = ours.ends[l];
        b = theirs.ends[l];
    }
    return result;
}

}  // namespace

TEST_SUITE("lines/bundle_tracer") {
    TEST_CASE("invalid and empty meshes are refused") {
        CHECK(error_of(BundleTracer::build({})).code == ErrorCode::empty);
        TriangleMesh mesh = shapes::soup(3, 1.0f, 1);
        mesh.indices[4] = 99;
        CHECK(error_of(BundleTracer::build(mesh)).code == ErrorCode::out_of_range);
    }

    TEST_CASE("a bundle's crossings are those of its lines one by one, for triangles below and far above a cell") {
        std::uint64_t seed = 1;
        std::size_t crossings = 0;
        for (const float size : {0.01f, 0.1f, 1.5f})
            for (const double cell_area : {0.0004, 0.01, 0.5})
                for (const std::array<double, 2> u :
                     {std::array{0.3, 0.7}, std::array{0.0, 0.0}, std::array{0.5, 0.25}, std::array{0.9, 0.1}}) {
                    const Difference d = compare(shapes::soup(1500, size, 7), cell_area, u, ++seed);
                    crossings += d.crossings;
                    CHECK(d.wrong <= 2 + d.crossings / 20'000);
                }
        CHECK(crossings > 100'000);
    }

    TEST_CASE("crossings are counted from where the lines start, also where the bundle is of another box") {
        const TriangleMesh mesh = shapes::soup(200, 0.5f, 3);
        const auto by_bundle = BundleTracer::build(mesh);
        const auto by_line = LineTracer::build(mesh);
        const Bundle bundle = make_bundle({{-3, -2, -1}, {9, 5, 4}}, 0.01, {0.3, 0.2}, 7);
        std::vector<Line> lines;
        for (std::size_t i = 0; i < bundle.cells(); ++i) lines.push_back(bundle.line(i));
        BundleTracer::Scratch scratch;
        LineHits ours, theirs;
        by_bundle->all_hits(bundle, scratch, ours);
        by_line->all_hits(lines, theirs);
        REQUIRE(ours.hits.size() == theirs.hits.size());
        CHECK(ours.hits.size() > 1000);
        std::size_t wrong = 0;
        for (std::size_t h = 0; h < ours.hits.size(); ++h) wrong += std::abs(ours.hits[h].t - theirs.hits[h].t) > 1e-3f;
        CHECK(wrong <= 2);
    }

    TEST_CASE("a bundle through a long thin box has no more than some ten cells a line, and covers its shadow") {
        const sampling::UnitPoints points(6, sampling::Sequence::quasi_random);
        for (const glm::dvec3 size :
             {glm::dvec3(1e5, 1.0, 0.0), glm::dvec3(1.0, 1e5, 2.0), glm::dvec3(3e3, 3e3, 0.1)}) {
            const Aabb box{-0.25 * size, 0.75 * size};
            const double shadow = 0.5 * (size.x * size.y + size.y * size.z + size.z * size.x);
            for (std::uint64_t k = 0; k < 1000; ++k) {
                const Bundle bundle = make_bundle(box, shadow / 1e5, points.at<2>(k), k);
                CHECK(bundle.cells() <= (1u << 21));
                CHECK(glm::dot(glm::cross(bundle.right, bundle.up), bundle.direction) ==
                      doctest::Approx(1.0).epsilon(1e-12));
                for (int c = 0; c < 8; ++c) {
                    const glm::dvec3 corner(c & 1 ? box.min.x : box.max.x, c & 2 ? box.min.y : box.max.y,
                                            c & 4 ? box.min.z : box.max.z);
                    const glm::dvec3 d = (corner - bundle.corner) / bundle.cell;
                    CHECK(glm::dot(d, bundle.right) >= 0.0);
                    CHECK(glm::dot(d, bundle.right) <= bundle.columns);
                    CHECK(glm::dot(d, bundle.up) >= 0.0);
                    CHECK(glm::dot(d, bundle.up) <= bundle.rows);
                }
            }
        }
    }

    TEST_CASE("every line of a closed room enters and leaves it") {
        shapes::Shape room;
        room.room({0, 0, 0}, {3, 2, 1}, 0);
        const auto tracer = BundleTracer::build(room.mesh);
        BundleTracer::Scratch scratch;
        LineHits hits;
        std::size_t odd = 0, lines = 0;
        for (int k = 0; k < 20; ++k) {
            const Bundle bundle =
                make_bundle(tracer->bounds(), 0.001, {0.05 * k + 0.01, 0.618 * k - std::floor(0.618 * k)},
                            static_cast<std::uint64_t>(k));
            tracer->all_hits(bundle, scratch, hits);
            std::uint32_t begin = 0;
            for (const std::uint32_t end : hits.ends) {
                if (end > begin) ++lines;
                if (end != begin && end != begin + 2) ++odd;
                begin = end;
            }
        }
        CHECK(lines > 20'000);
        CHECK(odd <= 2);
    }

    TEST_CASE("a surface expects S/(2 cell) crossings per bundle, and its box the lines promised") {
        shapes::Shape flat;
        flat.parallelogram({0, 0, 0}, {10, 0, 0}, {0, 10, 0}, 0);
        flat.parallelogram({3, 3, 0.5f}, {0, 2, 0}, {2, 0, 0}, 1);
        const auto tracer = BundleTracer::build(flat.mesh);
        BundleTracer::Scratch scratch;
        LineHits hits;
        const sampling::UnitPoints points(5, sampling::Sequence::quasi_random);
        double crossings = 0.0, lines = 0.0;
        constexpr int kBundles = 1024;
        for (std::uint64_t k = 0; k < kBundles; ++k) {
            const Bundle bundle = make_bundle(tracer->bounds(), 0.25, points.at<2>(k), k);
            tracer->all_hits(bundle, scratch, hits);
            crossings += static_cast<double>(hits.hits.size());
            lines += bundle.lines;
        }
        CHECK(crossings / kBundles == doctest::Approx(104.0 / (2.0 * 0.25)).epsilon(0.01));
        CHECK(lines / kBundles == doctest::Approx(0.25 * (200.0 + 4 * 10 * 0.5) / 0.25).epsilon(0.01));
    }
}
