// SPDX-License-Identifier: MIT
// Shapes that touch parts which lie flush: the contacts are those of the union.
#include <doctest/doctest.h>
#include <algorithm>
#include <cmath>
#include <memory>
#include <set>
#include <tuple>

#include "flat_floors.hpp"

using namespace crofton;
using namespace crofton::convex;
using namespace crofton::testing;

namespace {

// A shape that is `depth` deep in the floor's plane at its lowest point, in the floor's frame.
RigidTransform sunk(RandomShapes& random, const Shape& shape, const Floor& floor, double depth, bool upright) {
    glm::dmat3 rotation = around_y(random.number(0, 6.2));
    if (!upright) rotation = random.rotation();
    const double edge = 0.7;
    return {rotation,
            {random.number(floor.least + edge, floor.most - edge), below(shape, rotation) - depth,
             random.number(floor.least + edge, floor.most - edge)}};
}

struct Asked {
    const Compound& floor;
    RigidTransform frame;  // of the floor
    const Shape& shape;
    RigidTransform pose;  // in the frame
    double depth;         // of the lowest point
    bool swapped;
};

// Every field of every point: on the plane and on the shape, along its normal, of a part that is there.
void check_against_plane(const Asked& asked, std::span<const Manifold> found, double tolerance) {
    const glm::dvec3 up = asked.frame.rotation[1];
    const RigidTransform pose = placed_in(asked.frame, asked.pose);
    CHECK(found.size() == 1);
    if (found.size() != 1) return;
    const Manifold& m = found[0];
    const glm::dvec3 normal = asked.swapped ? -m.normal : m.normal;
    CHECK(glm::distance(normal, up) <= 2e-3);
    CHECK(std::abs(glm::length(normal) - 1.0) <= 1e-12);
    CHECK(m.depth == doctest::Approx(asked.depth).epsilon(1e-9).scale(tolerance / 1e-9));
    REQUIRE(m.count >= 1);
    CHECK(m.count <= 4);
    double deepest = -HUGE_VAL;
    std::set<std::tuple<PartId, PartId, Feature, Feature>> ids;
    for (int i = 0; i < m.count; ++i) {
        const ContactPoint& p = m.points[i];
        const glm::dvec3 half = 0.5 * p.depth * normal, on_floor = p.position + half, on_shape = p.position - half;
        CHECK(std::abs(glm::dot(on_floor - asked.frame.translation, up)) <= tolerance + 2e-3 * std::abs(p.depth));
        CHECK(closest_point({asked.shape, pose}, on_shape).distance <= tolerance + 2e-3 * std::abs(p.depth));
        const PartId id = asked.swapped ? p.part_b : p.part_a;
        REQUIRE(id.child < asked.floor.part_count());
        const CompoundChild& part = asked.floor.part(id.child);
        const RigidTransform there = placed_in(asked.frame, part.pose);
        CHECK(closest_point({part.shape, there}, on_floor).distance <= tolerance + 2e-3 * std::abs(p.depth));
        CHECK((asked.swapped ? p.part_a : p.part_b) == PartId{});
        ids.insert({p.part_a, p.part_b, p.on_a, p.on_b});
        deepest = std::max(deepest, p.depth);
    }
    CHECK(ids.size() == static_cast<std::size_t>(m.count));
    CHECK(deepest == m.depth);
}

int check_floor(RandomShapes& random, const Floor& floor, const Sliders& sliders, int rounds) {
    const Compound compound = Compound::build(floor.parts).value();
    Manifolds found;
    int checked = 0;
    for (int i = 0; i < rounds; ++i) {
        const std::size_t which = static_cast<std::size_t>(i) % sliders.shapes.size();
        CAPTURE(which);
        CAPTURE(i);
        const Shape& shape = sliders.shapes[which];
        const bool upright = i % 3 != 0;
        const double depth = i % 4 == 0 ? -random.number(1e-4, 0.01) : std::pow(10.0, -random.number(1.7, 6.0));
        RigidTransform frame = at({});
        if (i % 5 != 0) frame.rotation = random.rotation();
        if (i % 5 > 2) frame.translation = std::pow(10.0, random.number(0.0, 4.0)) * random.direction();
        const Asked asked{compound, frame, shape, sunk(random, shape, floor, depth, upright), depth, i % 7 == 0};
        const RigidTransform pose = placed_in(frame, asked.pose);
        const ManifoldOptions options{.margin = depth < 0.0 ? 0.02 : 0.0};
        if (asked.swapped)
            contact_manifolds({shape, pose}, {Shape::compound(compound), frame}, options, found);
        else
            contact_manifolds({Shape::compound(compound), frame}, {shape, pose}, options, found);
        // Depths of cylinders and cones are known to 1e-5.
        check_against_plane(asked, found.all(), 3e-5);
        ++checked;
    }
    return checked;
}

}  // namespace

TEST_SUITE("convex/union_normals") {
    // Walls that overlap on a block, and movers deep in them, each with another mover near.
    TEST_CASE("a neighbour that stands near, with a gap, changes no contact") {
        RandomShapes random(91);
        const Sliders sliders(random);
        const auto block = [](const glm::dvec3& half, const glm::dvec3& middle) {
            return CompoundChild{Shape::box(glm::vec3(half)).value(), at(middle)};
        };
        std::size_t checked = 0;
        for (int round = 0; round < 200; ++round) {
            std::vector<CompoundChild> parts{block({60, 25, 60}, {0, -25, 0})};
            for (int i = round % 3; i >= 0; --i) {
                const double height = random.number(0.4, 1.5);
                const glm::dvec3 half(random.number(0.4, 1.5), height, random.number(0.4, 1.5));
                parts.push_back(
                    block(half, {random.number(-1, 1), (round + i) % 2 ? height : -height, random.number(-1, 1)}));
            }
            const Compound compound = Compound::build(parts).value();
            const Shape walls = Shape::compound(compound);
            const RigidTransform frame{round % 2 ? random.rotation() : glm::dmat3(1.0),
                                       round % 3 == 1 ? 1e3 * random.direction() : glm::dvec3(0.0)};
            std::vector<RigidTransform> poses;
            for (const Shape& shape : sliders.shapes) {
                const glm::dmat3 turn = random.index(3) == 0 ? random.rotation() : around_y(random.number(0, 6.2));
                const double y = below(shape, turn) - std::pow(10.0, -random.number(1.7, 4.0));
                const double x = random.number(-2, 2), z = random.number(-2, 2);
                poses.push_back(placed_in(frame, {turn, {x, y, z}}));
            }
            std::vector<ShapeAtPose> movers;
            for (std::size_t i = 0; i < poses.size(); ++i) movers.push_back({sliders.shapes[i], poses[i]});
            for (std::size_t i = 0; i < movers.size(); ++i)
                for (std::size_t j = 0; j < movers.size(); ++j) {
                    if (i == j || !(distance(movers[i], movers[j]).distance > 1e-4)) continue;
                    const ShapeAtPose a{walls, frame};
                    const std::span near(&movers[j], 1);
                    Manifolds alone, beside;
                    contact_manifolds(a, movers[i], {}, alone);
                    contact_manifolds(a, movers[i], Beside{{}, near}, {}, beside);
                    CHECK(alone.all().size() == beside.all().size());
                    for (const Manifold& m : alone.all()) {
                        const auto found =
                            std::find_if(beside.all().begin(), beside.all().end(), [&](const Manifold& n) {
                                return glm::distance(m.normal, n.normal) < 1e-6 && std::abs(m.depth - n.depth) < 1e-7;
                            });
                        CHECK(found != beside.all().end());
                        ++checked;
                    }
                }
        }
        CHECK(checked > 10000);
    }
    TEST_CASE("over strips of boxes that lie flush, also with T-junctions, every contact is that of one plane") {
        RandomShapes random(61);
        const Sliders sliders(random);
        for (int round = 0; round < 24; ++round) {
            CAPTURE(round);
            const Tiles tiles = round % 2 == 0 ? Tiles::boxes : Tiles::turned_boxes;
            check_floor(random, strips(random, tiles, round % 3 != 0, 1.0f), sliders, 400);
        }
    }

    TEST_CASE("over hulls, prisms, triangles and any of them that lie flush, every contact is that of one plane") {
        RandomShapes random(62);
        const Sliders sliders(random);
        for (const Tiles tiles : {Tiles::hulls, Tiles::prisms, Tiles::triangles, Tiles::mixed})
            for (int round = 0; round < 4; ++round) {
                CAPTURE(static_cast<int>(tiles));
                CAPTURE(round);
                check_floor(random, strips(random, tiles, round % 2 == 0, 0.5f), sliders, 300);
            }
        for (const bool flat : {true, false}) {
            CAPTURE(flat);
            check_floor(random, triangulated(random, 0.5f, flat), sliders, 600);
        }
    }
}

namespace {

// The manifold along a direction, if there is one.
const Manifold* along(std::span<const Manifold> found, const glm::dvec3& direction) {
    for (const Manifold& m : found)
        if (glm::distance(m.normal, direction) <= 1e-6) return &m;
    return nullptr;
}

Shape box_of(const glm::dvec3& size) {
    return Shape::box(glm::vec3(0.5 * size)).value();
}

// Parts, some of which are views of hulls.
struct Union {
    std::vector<CompoundChild> parts;
    std::vector<std::unique_ptr<Hull>> hulls;
    // As a hull of its corners.
    void add_box(const glm::vec3& half, const RigidTransform& pose) {
        std::vector<glm::vec3> corners;
        for (int c = 0; c < 8; ++c) corners.push_back(half * glm::vec3(c & 1 ? 1 : -1, c & 2 ? 1 : -1, c & 4 ? 1 : -1));
        hulls.push_back(std::make_unique<Hull>(Hull::build(corners).value()));
        parts.push_back({Shape::hull(*hulls.back()), pose});
    }
};

// How a union is built and asked: sizes of quarters or any, its frame, its scale, which comes first.
struct Setting {
    bool grid, swapped;
    double scale = 1.0;
    RigidTransform frame = at({});

    Setting(RandomShapes& random, int round) : grid(round % 2 == 0), swapped(round % 3 == 0) {
        if (round % 7 > 3) scale = round % 7 > 5 ? 1e3 : 1e-3;
        if (round % 4 > 1) frame.rotation = random.rotation();
        if (round % 5 > 2) frame.translation = scale * (round % 5 == 3 ? 1e3 : 1e6) * random.direction();
    }
    [[nodiscard]] glm::dvec3 numbers(RandomShapes& random, double low, double high) const {
        glm::dvec3 result;
        for (int k = 0; k < 3; ++k) {
            const double any = random.number(low, high), quarter = std::round(4.0 * any) / 4.0;
            result[k] = grid ? (low > 0.0 ? std::max(0.25, quarter) : quarter) : any;
        }
        return result;
    }
    [[nodiscard]] RigidTransform pose(RandomShapes& random, double reach) const {
        glm::dvec3 place = numbers(random, -reach, reach);
        if (grid) place += 1e-3 * random.direction();
        const bool straight = random.index(3) == 0;
        return placed_in(frame, {straight ? glm::dmat3(1.0) : random.rotation(), scale * place});
    }
    void ask(const Compound& parts, const Shape& mover, const RigidTransform& pose, Manifolds& found) const {
        if (swapped)
            contact_manifolds({mover, pose}, {Shape::compound(parts), frame}, {}, found);
        else
            contact_manifolds({Shape::compound(parts), frame}, {mover, pose}, {}, found);
    }
};

// A cylinder's depth is known to 1e-5, and its normal is any of those that are as deep.
void check_same(std::span<const Manifold> found, std::span<const Manifold> expected, double scale, bool sharp) {
    CHECK(found.size() == expected.size());
    const double tolerance = sharp ? 1e-6 : 1e-5;
    for (const Manifold& m : expected)
        CHECK(std::any_of(found.begin(), found.end(), [&](const Manifold& other) {
            const bool along = !sharp || glm::distance(m.normal, other.normal) < 1e-6;
            return along && std::abs(m.depth - other.depth) < tolerance * scale;
        }));
}

// The box from `low` to `high`.
CompoundChild block(const glm::dvec3& low, const glm::dvec3& high) {
    return {box_of(high - low), at(0.5 * (low + high))};
}

}  // namespace

TEST_SUITE("convex/union_normals_of_edges") {
    TEST_CASE("a wall on the floor pushes sideways, next to the floor that pushes up, in any frame") {
        RandomShapes random(63);
        Manifolds found;
        for (int i = 0; i < 2000; ++i) {
            CAPTURE(i);
            // The wall stands on the floor, goes down beside it, or is cut into blocks.
            std::vector<CompoundChild> parts{block({-4, -1, -4}, {0, 0, 0.25}), block({-4, -1, 0.25}, {0, 0, 4})};
            if (i % 3 == 0) parts.push_back(block({-1, 0, -4}, {0, 2, 4}));
            if (i % 3 == 1) parts.push_back(block({0, -1, -4}, {1, 2, 4}));
            if (i % 3 == 2)
                for (double z = -4.0; z < 4.0; z += 0.5) parts.push_back(block({0, 0, z}, {1, 2, z + 0.5}));
            const double face = i % 3 == 0 ? -1.0 : 0.0;
            const Compound compound = Compound::build(parts).value();
            const double down = random.number(1e-5, 0.02), in = random.number(1e-5, 0.02);
            const RigidTransform frame{i % 4 == 0 ? glm::dmat3(1.0) : random.rotation(),
                                       (i % 2 == 0 ? 0.0 : 100.0) * random.direction()};
            const Shape shape = i % 5 == 0 ? Shape::sphere(0.25).value() : Shape::box({0.25f, 0.25f, 0.25f}).value();
            const RigidTransform pose = placed_in(frame, at({face - 0.25 + in, 0.25 - down, random.number(-3.0, 3.0)}));
            contact_manifolds({Shape::compound(compound), frame}, {shape, pose}, {}, found);
            CHECK(found.all().size() == 2);
            const Manifold *up = along(found.all(), frame.rotation[1]), *back = along(found.all(), -frame.rotation[0]);
            REQUIRE(up != nullptr);
            REQUIRE(back != nullptr);
            CHECK(up->depth == doctest::Approx(down).epsilon(1e-5));
            CHECK(back->depth == doctest::Approx(in).epsilon(1e-5));
        }
    }

    TEST_CASE("a step of a centimetre and a gap wider than rounding push sideways, a step within rounding does not") {
        RandomShapes random(64);
        Manifolds found;
        for (int i = 0; i < 1000; ++i) {
            CAPTURE(i);
            const double down = random.number(1e-4, 0.009), in = random.number(1e-5, 0.9) * down;
            const RigidTransform frame{random.rotation(), 10.0 * random.direction()};
            const RigidTransform pose = placed_in(frame, at({-0.25 + in, 0.25 - down, random.number(-3.0, 3.0)}));
            const Shape shape = Shape::box({0.25f, 0.25f, 0.25f}).value();
            const auto ask = [&](double step, double gap) {
                const CompoundChild parts[] = {block({-4, -1, -4}, {-gap, 0, 4}), block({0, -1, -4}, {4, step, 4})};
                const Compound compound = Compound::build(parts).value();
                contact_manifolds({Shape::compound(compound), frame}, {shape, pose}, {}, found);
                const Manifold *up = along(found.all(), frame.rotation[1]),
                               *back = along(found.all(), -frame.rotation[0]);
                REQUIRE(up != nullptr);
                CHECK(up->depth == doctest::Approx(down).epsilon(1e-3));
                if (back != nullptr) CHECK(back->depth == doctest::Approx(in).epsilon(1e-3));
                return back != nullptr;
            };
            CHECK(ask(0.01, 0.0));
            CHECK(ask(1e-3, 0.0));
            CHECK(ask(0.0, 1e-3));
            CHECK_FALSE(ask(0.0, 0.0));
            CHECK_FALSE(ask(0.0, 1e-7));
            CHECK_FALSE(ask(1e-7, 0.0));
        }
    }

    TEST_CASE("in a corner of two walls, between floor and ceiling, and over a narrow beam: normals of the union") {
        Manifolds found;
        const Shape shape = Shape::box({0.25f, 0.25f, 0.25f}).value();
        const double s = 0.004, t = 0.007;
        const CompoundChild corner[] = {block({0, -1, -4}, {1, 1, 4}), block({-4, -1, 0}, {0, 1, 1})};
        const Compound walls = Compound::build(corner).value();
        contact_manifolds({Shape::compound(walls), at({})}, {shape, at({-0.25 + s, 0, -0.25 + t})}, {}, found);
        CHECK(found.all().size() == 2);
        REQUIRE(along(found.all(), {-1, 0, 0}) != nullptr);
        REQUIRE(along(found.all(), {0, 0, -1}) != nullptr);
        CHECK(along(found.all(), {-1, 0, 0})->depth == doctest::Approx(s).epsilon(1e-6));
        CHECK(along(found.all(), {0, 0, -1})->depth == doctest::Approx(t).epsilon(1e-6));
        // The wall between floor and ceiling is covered at both ends of the contact.
        const CompoundChild room[] = {block({-4, -1, -4}, {0, 0, 4}), block({-4, 0.49, -4}, {0, 1, 4}),
                                      block({0, -1, -4}, {1, 1, 4})};
        const Compound passage = Compound::build(room).value();
        contact_manifolds({Shape::compound(passage), at({})}, {shape, at({-0.25 + s, 0.245, 0})}, {}, found);
        CHECK(found.all().size() == 3);
        REQUIRE(along(found.all(), {-1, 0, 0}) != nullptr);
        CHECK(along(found.all(), {-1, 0, 0})->depth == doctest::Approx(s).epsilon(1e-6));
        // A beam that is narrower than the shape leads to a platform.
        const CompoundChild beam[] = {block({-4, -1, -0.1}, {0, 0, 0.1}), block({0, -1, -4}, {4, 0, 4})};
        const Compound bridge = Compound::build(beam).value();
        contact_manifolds({Shape::compound(bridge), at({})}, {shape, at({-0.25 + s, 0.25 - t, 0})}, {}, found);
        CHECK(found.all().size() == 1);
        CHECK(found.all()[0].depth == doctest::Approx(t).epsilon(1e-6));
        CHECK(found.all()[0].normal.y == doctest::Approx(1.0));
        // A hole that is narrower than the shape.
        const CompoundChild holed[] = {block({-4, -1, -4}, {0, 0, -0.1}), block({-4, -1, 0.1}, {0, 0, 4}),
                                       block({0, -1, -4}, {4, 0, 4})};
        const Compound floor = Compound::build(holed).value();
        contact_manifolds({Shape::compound(floor), at({})}, {shape, at({-0.25 + s, 0.25 - t, 0})}, {}, found);
        CHECK(found.all().size() == 1);
        CHECK(found.all()[0].normal.y == doctest::Approx(1.0));
        // Plates thinner than the shape has sunk in.
        const CompoundChild plates[] = {block({-4, -0.002, -4}, {0, 0, 4}), block({0, -1, -4}, {4, 0, 4})};
        const Compound thin = Compound::build(plates).value();
        contact_manifolds({Shape::compound(thin), at({})}, {shape, at({-0.25 + s, 0.25 - t, 0})}, {}, found);
        for (const Manifold& m : found.all()) CHECK(std::abs(m.normal.y) == doctest::Approx(1.0));
    }

    TEST_CASE(
        "a union of hulls pushes as the same union of boxes does, where parts overlap and where they stand apart") {
        RandomShapes random(68);
        int touching = 0, several = 0;
        for (int round = 0; round < 2400; ++round) {
            CAPTURE(round);
            Setting setting(random, round);
            Union boxes, hulls;
            const int count = 3 + round % 4;
            for (int i = 0; i < count; ++i) {
                const glm::vec3 half(setting.scale * setting.numbers(random, 0.2, 1.5));
                const RigidTransform pose{setting.grid || round % 3 == 0 ? glm::dmat3(1.0) : random.rotation(),
                                          setting.scale * setting.numbers(random, -1.0, 1.0)};
                boxes.parts.push_back({Shape::box(half).value(), pose});
                hulls.add_box(half, pose);
            }
            const glm::vec3 mover(setting.scale * glm::dvec3(0.3, 0.2, 0.25));
            hulls.add_box(mover, at({}));  // kept there, and taken out again
            const Shape hull_mover = hulls.parts.back().shape;
            hulls.parts.pop_back();
            const Shape round_mover = round % 5 == 0 ? Shape::sphere(0.25 * setting.scale).value()
                                                     : Shape::cylinder(mover.x, mover.z).value();
            const Shape box_mover = round % 5 < 2 ? round_mover : Shape::box(mover).value();
            const Shape& other_mover = round % 5 < 4 ? box_mover : hull_mover;
            const Compound of_boxes = Compound::build(boxes.parts).value(),
                           of_hulls = Compound::build(hulls.parts).value();
            for (int i = 0; i < 20; ++i) {
                CAPTURE(i);
                const RigidTransform pose = setting.pose(random, 2.5);
                Manifolds expected, found;
                setting.ask(of_boxes, box_mover, pose, expected);
                setting.ask(of_hulls, other_mover, pose, found);
                check_same(found.all(), expected.all(), setting.scale, round % 5 != 1);
                touching += expected.all().empty() ? 0 : 1;
                several += expected.all().size() > 1 ? 1 : 0;
            }
        }
        CHECK(touching > 12'000);
        CHECK(several > 2'000);
    }

    // A plate beside the rod covers its contact, and along the plate's normal the rod has no point of its own.
    TEST_CASE("a ball deep in a rod beside a plate is pushed at a point of its surface") {
        RandomShapes random(72);
        int turned = 0;
        for (int i = 0; i < 4000; ++i) {
            CAPTURE(i);
            const double length = random.number(1.0, 4.0), thick = i % 2 == 0 ? 0.0 : random.number(0.0, 0.1);
            const double side = random.number(0.5, 3.0), radius = random.number(0.2, 2.0);
            const CompoundChild rod = block({-thick, -thick, -length}, {thick, thick, length}),
                                plate = block({-side, -2.0 - thick, -side}, {side, -thick, side});
            const RigidTransform frame{random.rotation(), 10.0 * random.direction()};
            const ShapeAtPose a{rod.shape, placed_in(frame, rod.pose)},
                beside{plate.shape, placed_in(frame, plate.pose)};
            const Shape ball = Shape::sphere(radius).value();
            const glm::dvec3 off(random.number(-1, 1), random.number(-1, 1), random.number(-1, 1));
            const RigidTransform pose =
                placed_in(frame, at(glm::dvec3(0, 0, random.number(-length, length)) + (i % 3 == 0 ? 0.0 : 0.1) * off));
            const std::span<const ShapeAtPose> near(&beside, 1);
            Manifolds found;
            const bool swapped = i % 5 == 0;
            if (swapped)
                contact_manifolds({ball, pose}, a, Beside{{}, near}, {}, found);
            else
                contact_manifolds(a, {ball, pose}, Beside{near, {}}, {}, found);
            for (const Manifold& m : found.all())
                for (int k = 0; k < m.count; ++k) {
                    const ContactPoint& p = m.points[k];
                    const glm::dvec3 on_ball = p.position + (swapped ? 0.5 : -0.5) * p.depth * m.normal;
                    const glm::dvec3 outward = (on_ball - pose.translation) / radius;
                    if (glm::distance(swapped ? m.normal : -m.normal, frame.rotation[1]) > 1.99) ++turned;
                    CHECK(glm::length(outward) == doctest::Approx(1.0).epsilon(1e-6));
                }
        }
        CHECK(turned > 1000);
    }

    TEST_CASE("a half-space among walls, buried blocks and tiles pushes as a thick block does, in any frame") {
        RandomShapes random(69);
        const Shape ground = Shape::half_space({{0, -1, 0}, 0}).value();
        int touching = 0, several = 0;
        for (int round = 0; round < 1500; ++round) {
            CAPTURE(round);
            Setting setting(random, round);
            setting.scale = 1.0;
            Union blocks;
            const int count = 1 + round % 4;
            for (int i = 0; i < count; ++i) {
                const glm::dvec3 half = setting.numbers(random, 0.2, 1.5);
                // On the ground, flush with it, or in it.
                const double level = round % 3 == 0 ? half.y : round % 3 == 1 ? -half.y : random.number(-1.0, 1.0);
                const glm::dvec3 place = setting.numbers(random, -1.0, 1.0);
                const RigidTransform pose = at({place.x, level, place.z});
                if (i % 2 == 0)
                    blocks.parts.push_back({Shape::box(glm::vec3(half)).value(), pose});
                else
                    blocks.add_box(glm::vec3(half), pose);
            }
            std::vector<CompoundChild> thick = blocks.parts, endless = blocks.parts;
            const auto where = round % 2 == 0 ? 0 : count;  // first or last of the parts
            endless.insert(endless.begin() + where, {ground, at({})});
            thick.insert(thick.begin() + where, block({-50, -40, -50}, {50, 0, 50}));
            const Compound expected_in = Compound::build(thick).value(), asked = Compound::build(endless).value();
            const Shape mover = round % 5 == 0 ? Shape::sphere(0.25).value() : Shape::box({0.3f, 0.2f, 0.25f}).value();
            for (int i = 0; i < 10; ++i) {
                CAPTURE(i);
                const glm::dmat3 turn = i % 2 == 0 ? around_y(random.number(0.0, 6.2)) : random.rotation();
                const double x = random.number(-2.5, 2.5), z = random.number(-2.5, 2.5);
                const double up = below(mover, turn) - std::pow(10.0, -random.number(1.0, 6.0));
                const RigidTransform pose = placed_in(setting.frame, {turn, {x, up, z}});
                Manifolds expected, found;
                setting.ask(expected_in, mover, pose, expected);
                setting.ask(asked, mover, pose, found);
                // Where the shape is deeper in the blocks than it is large, no way out is plain.
                if (std::any_of(expected.all().begin(), expected.all().end(),
                                [](const Manifold& m) { return m.depth > 0.9; }))
                    continue;
                check_same(found.all(), expected.all(), 1.0, true);
                touching += expected.all().empty() ? 0 : 1;
                several += expected.all().size() > 1 ? 1 : 0;
            }
        }
        CHECK(touching > 12'000);
        CHECK(several > 2'000);
    }

    TEST_CASE("two compounds of flush boxes slide over each other as two boxes do, whichever comes first") {
        RandomShapes random(65);
        Manifolds found;
        for (int i = 0; i < 1000; ++i) {
            CAPTURE(i);
            const Floor floor = strips(random, i % 2 == 0 ? Tiles::boxes : Tiles::hulls, true, 0.5f);
            const CompoundChild pieces[] = {block({-0.3, -0.2, -0.3}, {0.05, 0.2, 0.1}),
                                            block({0.05, -0.2, -0.3}, {0.3, 0.2, 0.1}),
                                            block({-0.3, -0.2, 0.1}, {0.3, 0.2, 0.3})};
            const Compound below = Compound::build(floor.parts).value(), above = Compound::build(pieces).value();
            const RigidTransform frame{random.rotation(), 10.0 * random.direction()};
            const double depth = random.number(1e-5, 0.02);
            const RigidTransform pose = placed_in(
                frame, {around_y(random.number(0, 6.2)), {random.number(-2, 2), 0.2 - depth, random.number(-2, 2)}});
            if (i % 3 == 0)
                contact_manifolds({Shape::compound(above), pose}, {Shape::compound(below), frame}, {}, found);
            else
                contact_manifolds({Shape::compound(below), frame}, {Shape::compound(above), pose}, {}, found);
            REQUIRE(found.all().size() == 1);
            const Manifold& m = found.all()[0];
            CHECK(glm::distance(i % 3 == 0 ? -m.normal : m.normal, frame.rotation[1]) <= 1e-6);
            CHECK(m.depth == doctest::Approx(depth).epsilon(1e-4));
            CHECK(m.count == 4);
        }
    }
}
