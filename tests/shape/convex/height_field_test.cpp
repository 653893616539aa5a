// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <algorithm>
#include <error_of.hpp>
#include <limits>

#include "surfaces.hpp"

using namespace crofton;
using namespace crofton::convex;
using namespace crofton::testing;

namespace {

struct Heights {
    std::uint32_t columns, rows;
    std::vector<float> heights;
    std::vector<std::uint8_t> materials;
    glm::dvec2 spacing{1.0};
    [[nodiscard]] HeightFieldDescription describe() const { return {columns, rows, heights, spacing, materials}; }
};

// Every sixth cell is a hole, or every sixth alone is none.
Heights rough(RandomShapes& random, std::uint32_t columns, std::uint32_t rows, double height,
              bool mostly_holes = false) {
    Heights h{columns, rows, {}, {}, {random.number(0.3, 2), random.number(0.3, 2)}};
    for (std::uint32_t i = 0; i < columns * rows; ++i)
        h.heights.push_back(static_cast<float>(random.number(0, height)));
    for (std::uint32_t i = 0; i < (columns - 1) * (rows - 1); ++i)
        h.materials.push_back((random.index(6) == 0) != mostly_holes ? kHole
                                                                     : static_cast<std::uint8_t>(random.index(5)));
    h.materials[0] = 0;
    return h;
}

// The field's triangles as shapes: corners in double are those of floats where the spacing is a power of two.
template <class Visit>
void for_triangles(const HeightField& field, const Visit& visit) {
    for (std::uint32_t t = 0; t < 2 * field.cell_count(); ++t) {
        if (field.material(t / 2) == kHole) continue;
        const Triangle c = field.triangle(t);
        visit(t, Shape::triangle(glm::vec3(c[0]), glm::vec3(c[1]), glm::vec3(c[2])).value());
    }
}

}  // namespace

TEST_SUITE("convex/height_field") {
    TEST_CASE("bad descriptions are named errors: one row, sizes that do not fit, NaN, holes alone, spacings") {
        const std::vector<float> four(4, 0.0f);
        const auto code = [](const HeightFieldDescription& d) {
            const auto field = HeightField::build(d);
            REQUIRE_FALSE(field.has_value());
            return field.error().code;
        };
        CHECK(code({4, 1, four}) == ErrorCode::out_of_range);
        CHECK(code({40000, 2, four}) == ErrorCode::out_of_range);
        CHECK(code({2, 3, four}) == ErrorCode::invalid_argument);
        CHECK(code({2, 2, four, {0.0, 1.0}}) == ErrorCode::out_of_range);
        CHECK(code({2, 2, four, {NAN, 1.0}}) == ErrorCode::out_of_range);
        const std::vector<std::uint8_t> two(2, 0), hole(1, kHole);
        CHECK(code({2, 2, four, {1, 1}, two}) == ErrorCode::invalid_argument);
        CHECK(code({2, 2, four, {1, 1}, hole}) == ErrorCode::empty);
        std::vector<float> bad = four;
        bad[3] = std::numeric_limits<float>::quiet_NaN();
        CHECK(code({2, 2, bad}) == ErrorCode::non_finite);
        CHECK(error_of(HeightField::build({2, 2, bad})).item == 3);
        bad[3] = 2e15f;
        CHECK(code({2, 2, bad}) == ErrorCode::out_of_range);
    }

    TEST_CASE("corners, materials and triangles are where they are said to be, fronts up") {
        RandomShapes random(1);
        Heights h = rough(random, 5, 4, 1.0);
        const HeightField field = HeightField::build(h.describe()).value();
        CHECK(field.cell_count() == 12);
        CHECK(field.corner(3, 2) == glm::dvec3(3 * h.spacing.x, double(h.heights[13]), 2 * h.spacing.y));
        CHECK(field.material(7) == h.materials[7]);
        CHECK(field.triangle(2 * 5)[0] == field.corner(1, 1));
        CHECK(field.triangle(2 * 5 + 1)[0] == field.corner(2, 2));
        for (std::uint32_t t = 0; t < 24; ++t) {
            const Triangle c = field.triangle(t);
            CHECK(glm::cross(c[1] - c[0], c[2] - c[0]).y > 0.0);
        }
    }

    TEST_CASE("yes or no, distance and the first touch are those of the triangles one by one, holes left out") {
        RandomShapes random(2);
        int meeting = 0, apart = 0, hits = 0;
        for (int round = 0; round < 30; ++round) {
            Heights h =
                rough(random, static_cast<std::uint32_t>(2 + random.index(30)),
                      static_cast<std::uint32_t>(2 + random.index(30)), round % 3 == 0 ? 4.0 : 0.3, round % 5 == 4);
            h.spacing = {0.5, 0.25};
            const HeightField field = HeightField::build(h.describe()).value();
            const Shape shape = Shape::height_field(field, Sides::both);
            const RigidTransform pose{random.rotation(), (round % 2 == 0 ? 1e7 : 1.0) * random.direction()};
            for (int i = 0; i < 12; ++i) {
                const Shape b = any_shape(random, 0.4);
                const glm::dvec3 local(random.number(-1, 0.5 * h.columns), random.number(-1, 2),
                                       random.number(-1, 0.25 * h.rows));
                const RigidTransform pose_b{random.rotation(), pose.rotation * local + pose.translation};
                const Motion fall{
                    pose.rotation * glm::dvec3(1, -5, 0.5), random.index(2) * 5.0 * random.direction(), {}};
                double least = HUGE_VAL, first = 1.0;
                bool meets = false;
                for_triangles(field, [&](std::uint32_t, const Shape& t) {
                    meets = meets || intersects({t, pose}, {b, pose_b});
                    least = std::min(least, distance({t, pose}, {b, pose_b}).distance);
                    first = std::min(first, cast({t, pose}, {}, {b, pose_b}, fall, {.max_steps = 5000}).value().time);
                });
                CHECK(intersects({shape, pose}, {b, pose_b}) == meets);
                const Distance d = distance({shape, pose}, {b, pose_b});
                CHECK(d.distance == doctest::Approx(least).epsilon(1e-6));
                const Impact impact = cast({shape, pose}, {}, {b, pose_b}, fall, {.max_steps = 5000}).value();
                CHECK(std::abs(impact.time - first) <= 1e-6);
                (meets ? meeting : apart) += 1;
                hits += impact.result == CastResult::hit ? 1 : 0;
            }
        }
        CHECK(meeting > 20);
        CHECK(apart > 100);
        CHECK(hits > 50);
    }

    TEST_CASE(
        "on a field of 1025 x 1025 a small shape tests few triangles, and slides over level ground without a bump") {
        RandomShapes random(3);
        Heights h{1025, 1025, {}, {}, {0.5, 0.5}};
        for (int j = 0; j < 1025; ++j)
            for (int i = 0; i < 1025; ++i)
                h.heights.push_back(i < 512 ? 2.0f : static_cast<float>(2.0 + std::sin(0.1 * i) * std::cos(0.07 * j)));
        const HeightField field = HeightField::build(h.describe()).value();
        const Shape ground = Shape::height_field(field), box = Shape::box({0.4f, 0.4f, 0.4f}).value();
        Vector<Part> parts;
        Manifolds found;
        const RigidTransform still = at({});
        for (int i = 0; i < 500; ++i) {
            const double depth = random.number(1e-4, 1e-2);
            RigidTransform pose = at({random.number(5, 250), 2.4 - depth, random.number(5, 500)});
            const double angle = random.number(0, 6);
            pose.rotation =
                glm::dmat3(std::cos(angle), 0, std::sin(angle), 0, 1, 0, -std::sin(angle), 0, std::cos(angle));
            parts_near({ground, still}, {box, pose}, 0.0, parts);
            CHECK(parts.size() <= 40);
            contact_manifolds({ground, still}, {box, pose}, {.margin = 0.01}, found);
            REQUIRE(found.all().size() == 1);
            CHECK(found.all()[0].normal.y >= 1.0 - 1e-9);
            CHECK(found.all()[0].depth == doctest::Approx(depth).epsilon(1e-6));
            CHECK(found.all()[0].count == 4);
        }
        const Impact impact =
            cast({box, at({300, 90, 300})}, {{0, -1e4, 0}, {0, 20, 0}, {}}, {ground, still}, {}, {.duration = 0.1})
                .value();
        CHECK(impact.result == CastResult::hit);
        CHECK(impact.part_b.triangle / 2 % 1024 / 2 == doctest::Approx(300).epsilon(0.01));
    }

    TEST_CASE("a triangle far from its own origin meets the field iff it meets one of its triangles") {
        RandomShapes random(11);
        const std::vector<float> heights(9, 0.0f);
        const HeightField field = HeightField::build({3, 3, heights, {1, 1}, {}}).value();
        int meeting = 0;
        for (int round = 0; round < 2000; ++round) {
            const glm::vec3 far(1e6 * random.direction());
            const Shape shape = Shape::triangle(far, far + glm::vec3(1, 0.5f, 0), far + glm::vec3(0, 1, 1)).value();
            RigidTransform pose{random.rotation(), {}};
            pose.translation =
                glm::dvec3(random.number(0.5, 1.5), 0.0, random.number(0.5, 1.5)) - pose.rotation * glm::dvec3(far);
            double lowest = HUGE_VAL;
            for (int k = 0; k < 3; ++k)
                lowest = std::min(lowest, (pose.rotation * shape.vertex(k) + pose.translation).y);
            pose.translation.y -= lowest;
            bool meet = false;
            for_triangles(field, [&](std::uint32_t, const Shape& t) {
                meet = meet || intersects({t, at({})}, {shape, pose});
            });
            CHECK(intersects({Shape::height_field(field), at({})}, {shape, pose}) == meet);
            meeting += meet;
        }
        CHECK(meeting > 200);
    }
}
