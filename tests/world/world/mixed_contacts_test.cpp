// SPDX-License-Identifier: MIT
// Contacts of two objects of which one has a shape: where the shape meets the other's box, sphere or triangles.
#include <doctest/doctest.h>
#include <algorithm>
#include <array>
#include <crofton/convex/query.hpp>
#include <crofton/crofton.hpp>
#include <crofton/mesh/mesh_query.hpp>
#include <crofton/mesh/mesh_tree.hpp>
#include <functional>
#include <glm/geometric.hpp>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <shape/convex/random_shapes.hpp>
#include <shape/mesh/meshes.hpp>
#include <vector>

#include "box_at.hpp"
#include "cubes.hpp"

using namespace crofton;
using namespace crofton::testing;

namespace {

glm::vec3 sized(RandomShapes& random) {
    return glm::vec3(glm::dvec3(random.number(0.2, 1), random.number(0.2, 1), random.number(0.2, 1)));
}

// Shapes of every kind, each with itself at twice the size.
struct ShapeKinds {
    std::vector<convex::Shape> shapes, twice;
    std::vector<std::unique_ptr<convex::Hull>> hulls;
    std::vector<std::unique_ptr<mesh::MeshTree>> trees;
    std::vector<std::unique_ptr<convex::Compound>> compounds;
    std::vector<std::unique_ptr<convex::HeightField>> fields;

    explicit ShapeKinds(RandomShapes& random) {
        const std::vector<glm::vec3> points = random.points(20);
        const std::vector<float> heights{0.1f, 0.3f, -0.2f, 0.2f, 0.0f, 0.4f, -0.1f, 0.2f, 0.3f};
        for (const float scale : {1.0f, 2.0f}) {
            std::vector<convex::Shape>& list = scale == 1.0f ? shapes : twice;
            const double wide = static_cast<double>(scale);
            list.push_back(convex::Shape::sphere(0.7 * wide).value());
            list.push_back(convex::Shape::capsule(0.6f * scale, 0.3f * scale).value());
            list.push_back(convex::Shape::cylinder(0.5f * scale, 0.6f * scale).value());
            list.push_back(convex::Shape::cone(0.8f * scale, 0.6f * scale).value());
            list.push_back(convex::Shape::box(glm::vec3(0.5f, 0.3f, 0.9f) * scale).value());
            list.push_back(convex::Shape::triangle(glm::vec3(0, 0, 0) * scale, glm::vec3(1, 0.5f, 0) * scale,
                                                   glm::vec3(0, 0.5f, 1) * scale)
                               .value());
            list.push_back(convex::Shape::rounded(list[4], 0.25 * wide).value());
            std::vector<glm::vec3> scaled = points;
            for (glm::vec3& p : scaled) p *= scale;
            hulls.push_back(std::make_unique<convex::Hull>(convex::Hull::build(scaled).value()));
            list.push_back(convex::Shape::hull(*hulls.back()));
            TriangleMesh torus = wavy_torus(0.8, 0.3, 0.1, 8, 6);
            for (glm::vec3& p : torus.positions) p *= scale;
            trees.push_back(std::make_unique<mesh::MeshTree>(mesh::MeshTree::build(torus).value()));
            list.push_back(convex::Shape::mesh(*trees.back()).value());
            std::vector<float> raised = heights;
            for (float& height : raised) height *= scale;
            fields.push_back(std::make_unique<convex::HeightField>(
                convex::HeightField::build({3, 3, raised, glm::dvec2(0.7 * wide)}).value()));
            list.push_back(convex::Shape::height_field(*fields.back(), convex::Sides::both));
            const Plane plane{glm::dvec3(0.25, 1.0, -0.5), -0.5 * wide};
            const convex::Shape ground = convex::Shape::half_space(plane).value();
            const std::array children{
                convex::CompoundChild{list[0], {glm::dmat3(1.0), glm::dvec3(1.0, 0.25, 0.0) * wide}},
                convex::CompoundChild{list[4], {glm::dmat3(1.0), glm::dvec3(-0.75, 0.5, 0.25) * wide}},
                convex::CompoundChild{list[8], {glm::dmat3(1.0), glm::dvec3(0.0, -0.5, 0.5) * wide}}};
            compounds.push_back(std::make_unique<convex::Compound>(convex::Compound::build(children).value()));
            list.push_back(convex::Shape::compound(*compounds.back()));
            list.push_back(ground);
        }
    }
};

// One object, as a shape of its own.
struct Thing {
    ObjectHandle object;
    std::optional<convex::Shape> shape;   // that was set
    std::optional<convex::Shape> stands;  // shape, box, sphere or mesh
    RigidTransform pose;
    std::shared_ptr<mesh::MeshTree> tree;  // of a mesh
    bool closed = false;                   // of a mesh: it contains
};

}  // namespace

TEST_SUITE("world/mixed contacts") {
    TEST_CASE("a sphere in the corner of its box does not touch a trigger that has no shape, until it does") {
        World world;
        const convex::Shape ball = convex::Shape::sphere(1.0).value();
        const auto marble = world.add({.bound = box_at(glm::dvec3(0.0), 1.0f), .shape = &ball}).value();
        const auto trigger = world.add({.bound = box_at(glm::dvec3(1.25), 0.5f)}).value();
        Vector<ObjectRef> found;
        for (const double at : {1.25, 1.0, 1.25}) {
            REQUIRE(world.set_bound(trigger, box_at(glm::dvec3(at), 0.5f)).has_value());
            REQUIRE(world.update().has_value());
            CHECK(world.pairs().size() == 1);
            const bool touches = at == 1.0;  // the box's corner is at (0.5, 0.5, 0.5), or (0.75, 0.75, 0.75)
            world.overlap(box_at(glm::dvec3(at), 0.5f), found);
            CHECK(found.size() == (touches ? 2u : 1u));
            const bool ends = !touches && !world.contacts().empty();
            REQUIRE(world.contacts().size() == (touches || ends ? 1u : 0u));
            if (ends) CHECK(world.contacts()[0].phase == ContactPhase::ended);
            if (!touches) continue;
            const Contact& contact = world.contacts()[0];
            CHECK(contact.phase == ContactPhase::began);
            CHECK(contact.first.object == marble);
            CHECK(contact.depth == doctest::Approx(1.0 - std::sqrt(0.75)));
            CHECK(glm::distance(contact.normal, glm::dvec3(std::sqrt(1.0 / 3.0))) < 1e-9);
            REQUIRE(contact.points.size() == 1);
            CHECK(contact.triangles.empty());
            CHECK(contact.shape_points.empty());
        }
    }
    TEST_CASE("contacts of a shape with a box, sphere or mesh are those of the two, for every kind of shape") {
        RandomShapes random(4601);
        const ShapeKinds kinds(random);
        const TriangleMesh torus = wavy_torus(1.0, 0.4, 0.1, 8, 6), cube = box_mesh(glm::vec3(-1.0f), glm::vec3(1.0f));
        std::map<std::pair<int, int>, int> hits;  // by kinds of shape and partner
        int apart = 0, inside = 0;
        Vector<ObjectRef> overlapping;
        for (int round = 0; round < 40; ++round) {
            const bool contains = round % 4 != 0;
            World world({.containment = contains, .updates_to_rest = 2});
            const std::array meshes{world.add_mesh(described(torus)).value(), world.add_mesh(described(cube)).value()};
            std::vector<Thing> things(14);
            std::vector<int> kind_of(things.size());
            const auto placed = [&] {
                return RigidTransform{random.rotation(), 1.8 * glm::dvec3(random.number(-1, 1), random.number(-1, 1),
                                                                          random.number(-1, 1))};
            };
            // Adds it or, if it is there, moves it.
            const auto place = [&](std::size_t i) {
                Thing& thing = things[i];
                const bool is_new = thing.object.is_null();
                thing.pose = placed();
                const double scale = i % 4 == 1 ? 2.0 : 1.0;
                const Transform transform{thing.pose.rotation * scale, thing.pose.translation};
                if (i < 7) {
                    if (is_new) {
                        kind_of[i] = random.index(static_cast<int>(kinds.shapes.size()));
                        const auto kind = static_cast<std::size_t>(kind_of[i]);
                        thing.shape = kinds.shapes[kind];
                        thing.stands = scale == 2.0 ? kinds.twice[kind] : kinds.shapes[kind];
                        thing.object = world.add({.transform = transform, .shape = &*thing.shape}).value();
                    } else {
                        REQUIRE(world.set_transform(thing.object, transform).has_value());
                    }
                    return;
                }
                const int kind = is_new ? (kind_of[i] = 100 + random.index(4)) : kind_of[i];
                Bound bound;
                if (kind == 100 || kind == 101) {
                    Obb box{thing.pose.translation, glm::mat3(thing.pose.rotation), sized(random)};
                    if (kind == 101) box.axes = glm::mat3(1.0f);
                    thing.stands = convex::Shape::box(box.half_extents).value();
                    thing.pose.rotation = glm::dmat3(box.axes);
                    bound = box;
                }
                if (kind == 102) {
                    const double radius = random.number(0.2, 1.0);
                    thing.stands = convex::Shape::sphere(radius).value();
                    bound = Sphere{thing.pose.translation, radius};
                }
                if (kind == 103) {
                    if (is_new) {
                        TriangleMesh mesh = random.index(2) != 0 ? torus : cube;
                        thing.object =
                            world.add({.mesh = meshes[mesh.indices == torus.indices ? 0 : 1], .transform = transform})
                                .value();
                        for (glm::vec3& p : mesh.positions) p *= static_cast<float>(scale);
                        thing.tree = std::make_shared<mesh::MeshTree>(mesh::MeshTree::build(mesh).value());
                        thing.stands = convex::Shape::mesh(*thing.tree).value();
                        thing.closed = true;
                    } else {
                        REQUIRE(world.set_transform(thing.object, transform).has_value());
                    }
                } else if (is_new) {
                    thing.object = world.add({.bound = bound}).value();
                } else {
                    REQUIRE(world.set_bound(thing.object, bound).has_value());
                }
            };
            for (std::size_t i = 0; i < things.size(); ++i) place(i);
            std::set<std::pair<std::uint32_t, std::uint32_t>> touched;
            for (int frame = 0; frame < 6; ++frame) {
                CAPTURE(round);
                CAPTURE(frame);
                if (frame > 0)
                    for (int m = random.index(6); m > 0; --m)
                        place(static_cast<std::size_t>(random.index(static_cast<int>(things.size()))));
                REQUIRE(world.update().has_value());
                std::map<std::pair<std::uint32_t, std::uint32_t>, const Contact*> told;
                for (const Contact& contact : world.contacts())
                    told[{contact.first.object.index, contact.second.object.index}] = &contact;
                std::set<std::pair<std::uint32_t, std::uint32_t>> touch_now;
                for (std::size_t i = 0; i < 7; ++i) {
                    world.overlap(*things[i].stands, things[i].pose, overlapping);
                    for (std::size_t j = 7; j < things.size(); ++j) {
                        CAPTURE(kind_of[i]);
                        CAPTURE(kind_of[j]);
                        const Thing &shape = things[i], &other = things[j];
                        const bool shape_first = shape.object.index < other.object.index;
                        const Thing &a = shape_first ? shape : other, &b = shape_first ? other : shape;
                        const std::pair<std::uint32_t, std::uint32_t> ids{a.object.index, b.object.index};
                        const convex::ShapeAtPose at_a{*a.stands, a.pose}, at_b{*b.stands, b.pose};
                        const convex::Distance gap = convex::distance(at_a, at_b);
                        if (gap.distance > 0.0 && gap.distance < 1e-5) continue;  // either way: boxes are rounded
                        const bool meets = convex::intersects(at_a, at_b);
                        bool within = false;
                        Vector<convex::Part> parts;
                        if (!meets && contains && other.closed) {
                            convex::parts_near({*shape.stands, shape.pose}, {*other.stands, other.pose}, 1e9, parts);
                            for (const convex::Part& part : parts) {
                                if (!part.shape.is_bounded()) continue;
                                const glm::dvec3 point =
                                    transform(part.pose, convex::support_point(part.shape, {0, 1, 0}));
                                within |= mesh::contains(*other.tree, glm::transpose(other.pose.rotation) *
                                                                          (point - other.pose.translation));
                            }
                        }
                        const auto at = told.find(ids);
                        const bool is_told = at != told.end() && at->second->phase != ContactPhase::ended;
                        CHECK(is_told == (meets || within));
                        const bool overlaps = std::any_of(overlapping.begin(), overlapping.end(),
                                                          [&](const auto& ref) { return ref.object == other.object; });
                        if (shape.stands->is_bounded()) CHECK(is_told == overlaps);
                        apart += !is_told;
                        if (!is_told) {
                            CHECK((at != told.end()) == (touched.count(ids) > 0));
                            continue;
                        }
                        touch_now.insert(ids);
                        const Contact& contact = *at->second;
                        CHECK((contact.phase == ContactPhase::stayed) == (touched.count(ids) > 0));
                        CHECK(contact.shape_points.empty());
                        CHECK(contact.triangles.empty());
                        if (within) {
                            ++inside;
                            CHECK(contact.inside ==
                                  (shape_first ? mesh::Containment::a_inside_b : mesh::Containment::b_inside_a));
                            CHECK(contact.points.empty());
                            CHECK(contact.normal == glm::dvec3(0.0));
                            CHECK(contact.depth == 0.0);
                            continue;
                        }
                        ++hits[{kind_of[i], kind_of[j]}];
                        CHECK(contact.inside == mesh::Containment::none);
                        const convex::Manifold manifold = convex::contact_manifold(at_a, at_b);
                        CHECK(contact.depth == doctest::Approx(manifold.depth).epsilon(1e-5));
                        CHECK(glm::dot(contact.normal, manifold.normal) > 1.0 - 1e-5);
                        REQUIRE(!contact.points.empty());
                        double deepest = -1.0;
                        for (const collide::ContactPoint& point : contact.points) {
                            deepest = std::max(deepest, point.depth);
                            for (const auto* const at_pose : {&at_a, &at_b})
                                CHECK(convex::closest_point(*at_pose, point.position).distance <=
                                      0.5 * std::max(point.depth, 0.0) + 1e-5);
                        }
                        CHECK(deepest == contact.depth);
                    }
                }
                touched = touch_now;
            }
        }
        for (int kind = 0; kind < 12; ++kind)
            for (int other = 100; other < 104; ++other) {
                CAPTURE(kind);
                CAPTURE(other);
                CHECK(hits[{kind, other}] > 0);
            }
        CHECK(apart > 3000);
        CHECK(inside > 3);
    }
}
