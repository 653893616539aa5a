// SPDX-License-Identifier: MIT
// Contacts of two shapes after a life, beside those of a new World with the same objects.
#include <doctest/doctest.h>
#include <algorithm>
#include <box_mesh.hpp>
#include <cmath>
#include <crofton/convex/query.hpp>
#include <crofton/crofton.hpp>
#include <crofton/mesh/mesh_tree.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <map>
#include <memory>
#include <optional>
#include <random>
#include <vector>

using namespace crofton;

namespace {

// A shape whose farthest point along a direction can be told by hand: the hull of points, and all within a radius of
// it.
struct Body {
    std::optional<convex::Hull> hull;
    std::optional<convex::Compound> compound;
    std::unique_ptr<mesh::MeshTree> tree;
    std::optional<convex::Shape> shape;
    std::vector<glm::dvec3> points;
    double radius = 0.0;

    [[nodiscard]] double farthest(const glm::dvec3& along, const Transform& pose) const {
        double most = -HUGE_VAL;
        for (const glm::dvec3& p : points) most = std::max(most, glm::dot(along, pose * p));
        return most + radius * glm::length(pose.linear[0]);
    }
    // From the surface of a cube that is not turned; negative inside.
    [[nodiscard]] double distance_of_cube(const glm::dvec3& point, const Transform& pose) const {
        glm::dvec3 half(0.0);
        for (const glm::dvec3& p : points) half = (glm::max)(half, p);
        const glm::dvec3 beyond = glm::abs(point - pose.translation) - half;
        const double inside = std::min(std::max({beyond.x, beyond.y, beyond.z}), 0.0);
        return glm::length((glm::max)(beyond, glm::dvec3(0.0))) + inside - radius;
    }
};

struct Thing {
    std::shared_ptr<Body> body;
    Transform pose;
    bool hidden = false;
    ObjectHandle in_life{};
};

using Pair = std::pair<std::uint64_t, std::uint64_t>;

struct Setting {
    std::uint64_t seed = 0;
    double offset = 0.0, spread = 1.0, margin = 0.0;
    bool even = false;   // boxes of a few sizes on a grid, but for 1e-5, so that several ways out are about as short
    bool mixed = false;  // even ones are also hulls, rounded, of two cubes, and meshes
};

class Life {
  public:
    explicit Life(const Setting& setting)
        : random_(setting.seed),
          offset_(setting.offset),
          spread_(setting.spread),
          even_(setting.even),
          mixed_(setting.mixed),
          options_{.contact_margin = setting.margin},
          world_(options_) {
        for (int i = 0; i < 10; ++i) add();
    }

    void step() {
        for (Thing& thing : things_) {
            const int what = index(40);
            if (what == 0) thing.pose = place_of(*thing.body), move(thing);
            if (what == 1) REQUIRE(world_.set_hidden(thing.in_life, thing.hidden = !thing.hidden).has_value());
            if (what == 2) {
                const std::shared_ptr<Body> other = body();
                if ((other->radius > 0.0) == (thing.body->radius > 0.0)) {
                    REQUIRE(world_.set_shape(thing.in_life, &*other->shape).has_value());
                    thing.body = other;
                    kept_.push_back(other);
                }
            }
            // Mostly by little, as things that rest and slide do, so that what is kept is asked for.
            if (even_ && what > 10) thing.pose.translation += 3e-5 * unit() * direction(), move(thing);
            if (!even_ && what > 10) {
                const double by = std::pow(10.0, -1.0 - 5.0 * unit()) * glm::length(thing.pose.linear[0]);
                thing.pose.translation += by * direction();
                if (what > 25) turn(thing.pose, std::pow(10.0, -1.0 - 5.0 * unit()));
                move(thing);
            }
        }
        if (index(10) == 0) {
            const auto which = things_.begin() + index(static_cast<int>(things_.size()));
            REQUIRE(world_.remove(which->in_life).has_value());
            things_.erase(which);
            add();
        }
        REQUIRE(world_.update().has_value());
    }

    std::size_t kept_faces = 0;      // of contacts that a new World gives another depth
    std::size_t neighbors_ways = 0;  // of contacts that are pushed as a flush neighbor's, by less than they overlap
    std::size_t kept_points = 0;     // that neighbors cover

    // How many contacts there were.
    std::size_t compare() {
        World fresh(options_);
        std::sort(things_.begin(), things_.end(),
                  [](const Thing& a, const Thing& b) { return a.in_life.index < b.in_life.index; });
        for (std::size_t i = 0; i < things_.size(); ++i) {
            REQUIRE(world_.set_user(things_[i].in_life, i).has_value());
            const ObjectDescription description{.transform = things_[i].pose,
                                                .shape = &*things_[i].body->shape,
                                                .user = i,
                                                .hidden = things_[i].hidden};
            REQUIRE(fresh.add(description).has_value());
        }
        REQUIRE(fresh.update().has_value());
        REQUIRE(world_.update().has_value());  // the users
        std::map<Pair, const Contact*> others;
        for (const Contact& contact : fresh.contacts()) others[{contact.first.user, contact.second.user}] = &contact;
        std::size_t count = 0;
        for (const Contact& contact : world_.contacts()) {
            if (contact.phase == ContactPhase::ended) continue;
            const Pair pair{contact.first.user, contact.second.user};
            CAPTURE(pair.first);
            CAPTURE(pair.second);
            REQUIRE(others.count(pair) == 1);
            check(contact, *others[pair], things_[pair.first], things_[pair.second]);
            others.erase(pair);
            ++count;
        }
        CHECK(others.empty());
        return count;
    }

  private:
    static double size_of(const Thing& a, const Thing& b) {
        double size = glm::distance(a.pose.translation, b.pose.translation);
        for (const Thing* const thing : {&a, &b}) {
            double core = 0.0;
            for (const glm::dvec3& p : thing->body->points) core = std::max(core, glm::length(thing->pose.linear * p));
            size += core + thing->body->radius * glm::length(thing->pose.linear[0]);
        }
        return size;
    }

    // Nothing is kept of shapes with parts.
    static void check_same(const Contact& life, const Contact& fresh) {
        CHECK(life.depth == fresh.depth);
        CHECK(life.normal == fresh.normal);
        REQUIRE(life.shape_points.size() == fresh.shape_points.size());
        for (std::size_t i = 0; i < life.shape_points.size(); ++i) {
            CHECK(life.shape_points[i].contact.position == fresh.shape_points[i].contact.position);
            CHECK(life.shape_points[i].contact.depth == fresh.shape_points[i].contact.depth);
            CHECK(life.shape_points[i].normal == fresh.shape_points[i].normal);
        }
    }

    void check(const Contact& life, const Contact& fresh, const Thing& a, const Thing& b) {
        // What is kept is as good within 1e-4; coordinates are rounded where they stand.
        if (!a.body->shape->is_convex() || !b.body->shape->is_convex()) return check_same(life, fresh);
        const double size = size_of(a, b), rounding = 1e-15 * glm::length(a.pose.translation);
        const double within = 1e-4 * size + 8.0 * rounding;
        CHECK(std::abs(life.depth - fresh.depth) <= within);
        kept_faces += std::abs(life.depth - fresh.depth) > 1e-9 * size + 8.0 * rounding;
        for (const Contact* const contact : {&life, &fresh}) {
            const glm::dvec3 n = contact->normal;
            CHECK(std::abs(glm::length(n) - 1.0) <= 1e-9);
            const double overlap = a.body->farthest(n, a.pose) + b.body->farthest(-n, b.pose);
            const double rough = (contact == &life ? within : 1e-6 * size + 8.0 * rounding);
            // A way out that a flush neighbor has set is no shorter than the pair's own, and ends that neighbor's
            // contact as well; the points that neighbors cover are left out.
            const bool is_neighbors = even_ && std::abs(overlap - contact->depth) > rough;
            if (is_neighbors) {
                CHECK(contact->depth <= overlap + rough);
                CHECK((has_contact_beside(a, b, n, overlap, within) || has_contact_beside(b, a, -n, overlap, within)));
                ++neighbors_ways;
            } else {
                CHECK(std::abs(overlap - contact->depth) <= rough);
            }
            // No other way is shorter: nowhere, and nowhere near.
            for (int i = 0; i < 20 && !even_; ++i) {
                const glm::dvec3 other = glm::normalize(i % 2 == 0 ? direction() : n + 0.1 * unit() * direction());
                CHECK(a.body->farthest(other, a.pose) + b.body->farthest(-other, b.pose) >= contact->depth - within);
            }
            CHECK(contact->shape_points.size() >= 1);
            CHECK(contact->shape_points.size() <= 4);
            double deepest = -HUGE_VAL;
            for (const convex::TrackedPoint& point : contact->shape_points) {
                deepest = std::max(deepest, point.contact.depth);
                if (even_) check_on_surfaces(*contact, point, a, b, within);
                if (is_neighbors) continue;
                const double high = glm::dot(n, point.contact.position) + 0.5 * point.contact.depth;
                CHECK(std::abs(high - a.body->farthest(n, a.pose)) +
                          std::abs(high - point.contact.depth + b.body->farthest(-n, b.pose)) <=
                      2.0 * (contact->depth - point.contact.depth) + 2.0 * rough);
            }
            CHECK(deepest == contact->depth);
        }
    }

    // Both ends of a point are on the surfaces. If neighbors cover all points, one is kept, with one end at the height
    // of its surface.
    void check_on_surfaces(const Contact& contact, const convex::TrackedPoint& point, const Thing& a, const Thing& b,
                           double within) {
        const glm::dvec3 n = contact.normal, half = 0.5 * point.contact.depth * n, on_a = point.contact.position + half,
                         on_b = point.contact.position - half;
        if (std::abs(a.body->distance_of_cube(on_a, a.pose)) <= within &&
            std::abs(b.body->distance_of_cube(on_b, b.pose)) <= within)
            return;
        CHECK((std::abs(glm::dot(n, on_a) - a.body->farthest(n, a.pose)) <= within ||
               std::abs(glm::dot(-n, on_b) - b.body->farthest(-n, b.pose)) <= within));
        CHECK(contact.shape_points.size() == 1);
        ++kept_points;
    }

    // Whether a thing that lies flush beside `a` touches `b` along the normal, at least as deep.
    bool has_contact_beside(const Thing& a, const Thing& b, const glm::dvec3& normal, double depth, double within) {
        const auto placed = [](const Thing& thing) {
            return RigidTransform{thing.pose.linear, thing.pose.translation};
        };
        const RigidTransform pose_a = placed(a), pose_b = placed(b);
        const double rounding = 1e-15 * glm::length(a.pose.translation), flush = 1e-5 + 8.0 * rounding;
        const convex::ShapeAtPose of_a{*a.body->shape, pose_a}, of_b{*b.body->shape, pose_b};
        for (const Thing& thing : things_) {
            if (thing.hidden || &thing == &a || &thing == &b || has_surface(thing)) continue;
            const RigidTransform pose = placed(thing);
            const convex::ShapeAtPose beside{*thing.body->shape, pose};
            if (convex::distance(of_a, beside).distance > flush || convex::penetration(of_a, beside).depth > flush)
                continue;
            convex::contact_manifolds(beside, of_b, {.margin = options_.contact_margin}, found_);
            for (const convex::Manifold& m : found_.all())
                if (glm::distance(m.normal, normal) <= 1e-6 + 8.0 * rounding && m.depth >= depth - within) return true;
        }
        return false;
    }
    static bool has_surface(const Thing& thing) { return thing.body->tree != nullptr; }

    double unit() { return std::uniform_real_distribution<double>(0.0, 1.0)(random_); }
    int index(int count) { return std::uniform_int_distribution<int>(0, count - 1)(random_); }
    glm::dvec3 direction() {
        std::normal_distribution<double> normal;
        // Compilers evaluate arguments in different orders.
        const double z = normal(random_), y = normal(random_), x = normal(random_);
        return glm::normalize(glm::dvec3(x, y, z));
    }
    void turn(Transform& pose, double radians) {
        pose.linear = glm::mat3_cast(glm::angleAxis(radians, direction())) * pose.linear;
    }
    Transform place() {
        Transform pose;
        if (even_) {
            const glm::dvec3 way = direction();
            pose.translation = glm::dvec3(offset_) + 1e-5 * unit() * way;
            for (int k = 0; k < 3; ++k) pose.translation[k] += 0.5 * index(4);
            return pose;
        }
        turn(pose, 6.0 * unit());
        pose.linear = glm::dmat3(glm::mat3_cast(glm::normalize(glm::quat_cast(pose.linear)))) *
                      std::pow(10.0, spread_ * (unit() - 0.5));
        pose.translation = glm::dvec3(offset_) + unit() * direction() * std::pow(10.0, 0.5 * spread_ * unit());
        return pose;
    }
    Transform place_of(const Body& body) {
        Transform pose = place();
        if (!even_ && body.radius == 0.0) deform(pose);
        return pose;
    }
    // Mirrored, stretched, sheared or nearly flat: for polytopes only.
    void deform(Transform& pose) {
        glm::dmat3 map(1.0);
        const int what = index(5);
        if (what == 0) map[index(3)] *= -1.0;
        if (what == 1) map = glm::dmat3(0.1 + unit(), 0, 0, 0, 1.0 + 3.0 * unit(), 0, 0, 0, unit() + 0.1);
        if (what == 2) map[index(3)][index(3)] += 2.0 * unit();
        if (what == 3) map[index(3)] *= std::pow(10.0, -1.0 - 3.0 * unit());
        pose.linear = pose.linear * map;
    }
    std::shared_ptr<Body> body() {
        auto made = std::make_shared<Body>();
        const int kind = mixed_ ? 4 + index(6) : even_ ? 2 : index(4);
        if (kind >= 4) {
            make_cube(*made, kind);
        } else if (kind == 0) {
            made->radius = 0.5 + unit();
            made->radius = static_cast<float>(made->radius);
            made->points = {glm::dvec3(0.0)};
            made->shape = convex::Shape::sphere(made->radius).value();
        } else if (kind == 1) {
            const auto half = static_cast<float>(0.2 + unit());
            made->radius = static_cast<float>(0.1 + unit());
            made->points = {{0.0, half, 0.0}, {0.0, -half, 0.0}};
            made->shape = convex::Shape::capsule(half, static_cast<float>(made->radius)).value();
        } else if (kind == 2) {
            glm::vec3 half(0.1 + unit(), 0.1 + unit(), 0.1 + unit());
            if (even_) half = glm::vec3(index(2) == 0 ? 0.5f : 1.0f);
            for (int i = 0; i < 8; ++i)
                made->points.push_back(glm::dvec3(half) * glm::dvec3(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1));
            made->shape = convex::Shape::box(half).value();
        } else {
            std::vector<glm::vec3> points;
            for (int i = 0; i < 12; ++i) points.push_back(glm::vec3((0.5 + unit()) * direction()));
            made->hull = convex::Hull::build(points).value();
            for (const glm::vec3& p : made->hull->vertices()) made->points.push_back(p);
            made->shape = convex::Shape::hull(*made->hull);
        }
        return made;
    }
    // A cube, or two as one.
    void make_cube(Body& body, int kind) {
        const float half = index(2) == 0 ? 0.5f : 1.0f;
        const TriangleMesh cube = testing::cube_mesh(half);
        const convex::Shape box = convex::Shape::box(glm::vec3(half)).value();
        for (const glm::vec3& p : cube.positions) body.points.push_back(p);
        if (kind == 4) {
            body.hull = convex::Hull::build(cube.positions).value();
            body.shape = convex::Shape::hull(*body.hull);
        } else if (kind == 5) {
            body.radius = 0.25;
            for (glm::dvec3& p : body.points) p -= 0.25 * glm::sign(p);
            body.shape = convex::Shape::rounded(convex::Shape::box(glm::vec3(half - 0.25f)).value(), 0.25).value();
        } else if (kind == 6) {
            const convex::CompoundChild children[] = {{box, {}}, {box, {glm::dmat3(1.0), {2.0 * half, 0.0, 0.0}}}};
            body.compound = convex::Compound::build(children).value();
            body.shape = convex::Shape::compound(*body.compound);
        } else if (kind == 7) {
            body.tree = std::make_unique<mesh::MeshTree>(mesh::MeshTree::build(cube).value());
            body.shape = convex::Shape::mesh(*body.tree).value();
        } else {
            body.shape = box;
        }
    }
    void add() {
        Thing& thing = things_.emplace_back();
        thing.body = body();
        thing.pose = place_of(*thing.body);
        thing.in_life = world_.add({.transform = thing.pose, .shape = &*thing.body->shape}).value();
        kept_.push_back(thing.body);
    }
    void move(Thing& thing) {
        kept_.push_back(thing.body);
        REQUIRE(world_.set_transform(thing.in_life, thing.pose).has_value());
    }

    std::mt19937_64 random_;
    double offset_, spread_;
    bool even_, mixed_;
    WorldOptions options_;
    World world_;
    std::vector<Thing> things_;
    std::vector<std::shared_ptr<Body>> kept_;
    convex::Manifolds found_;
};

}  // namespace

TEST_SUITE("world/contacts of a life") {
    TEST_CASE("two shapes touch as in a new World, with depths that differ by a ten-thousandth of the pair at most") {
        std::size_t contacts = 0, kept_faces = 0;
        for (std::uint64_t seed = 1; seed <= 40; ++seed) {
            CAPTURE(seed);
            Life life({.seed = seed,
                       .offset = seed % 4 == 0 ? 1e6 : 0.0,
                       .spread = seed % 3 == 0 ? 4.0 : 1.0,
                       .margin = seed % 7 == 0 ? 0.1 : 0.0,
                       .even = seed % 5 < 2,
                       .mixed = seed % 5 == 1});
            for (int frame = 0; frame < 60; ++frame) {
                life.step();
                contacts += life.compare();
            }
            kept_faces += life.kept_faces;
        }
        CHECK(contacts >= 20'000);
        CHECK(kept_faces >= 10);
    }

    TEST_CASE("far out, neighbors do not close the way out of a face that was kept") {
        for (std::uint64_t seed = 1; seed <= 24; ++seed) {
            CAPTURE(seed);
            Life life({.seed = seed, .offset = 1e10, .even = true, .mixed = seed % 2 == 0});
            for (int frame = 0; frame < 30; ++frame) {
                life.step();
                (void)life.compare();
            }
        }
    }

    TEST_CASE("rounded cubes among flush ones, within a margin, touch at surfaces or as a neighbor does") {
        std::size_t neighbors_ways = 0, kept_points = 0;
        // Lives depend on the compiler, which chooses the order of arguments: some are without such a neighbor.
        for (std::uint64_t seed = 3017; seed < 3025 || (neighbors_ways == 0 && seed < 3117); ++seed) {
            CAPTURE(seed);
            Life life({.seed = seed, .margin = 0.1, .even = true, .mixed = true});
            for (int frame = 0; frame < 60; ++frame) {
                life.step();
                (void)life.compare();
            }
            neighbors_ways += life.neighbors_ways;
            kept_points += life.kept_points;
        }
        CHECK(neighbors_ways >= 1);
        CHECK(kept_points >= 2);
    }
}
