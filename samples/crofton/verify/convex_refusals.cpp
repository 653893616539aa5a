// SPDX-License-Identifier: MIT
#include "convex_refusals.hpp"

#include <algorithm>
#include <cmath>
#include <crofton/convex/query.hpp>
#include <crofton/geometry/predicates.hpp>
#include <crofton/sampling/sampling.hpp>
#include <crofton/world/world.hpp>
#include <limits>
#include <vector>

namespace crofton::cli {
namespace {

using convex::Hull;
using sampling::Random;
using Points = std::vector<glm::vec3>;

struct ShapeTrial {
    std::uint64_t tried = 0, wrong = 0;

    template <class Value>
    void must_refuse(const Result<Value>& answer, ErrorCode code, std::uint64_t item = kNoItem) {
        ++tried;
        wrong += answer || answer.error().code != code || answer.error().message.empty() ||
                 (item != kNoItem && answer.error().item != item);
    }
    void require(bool good) {
        ++tried;
        wrong += !good;
    }
};

glm::vec3 any_point(Random& random) {
    const double x = random.uniform(-1.0, 1.0), y = random.uniform(-1.0, 1.0), z = random.uniform(-1.0, 1.0);
    return glm::vec3(glm::dvec3(x, y, z));
}

Points any_points(Random& random, std::size_t count) {
    Points points(count);
    for (glm::vec3& p : points) p = any_point(random);
    return points;
}

double not_finite(Random& random) {
    constexpr double kInfinite = std::numeric_limits<double>::infinity();
    const double kinds[] = {std::numeric_limits<double>::quiet_NaN(), kInfinite, -kInfinite};
    return kinds[random.bits() % 3];
}

// By exact orientations.
bool holds_all(const Hull& hull, const Points& points) {
    const auto at = [&](std::size_t i) { return glm::dvec3(hull.vertices()[hull.triangles()[i]]); };
    for (std::size_t t = 0; t < hull.triangles().size(); t += 3)
        for (const glm::vec3& p : points)
            if (orientation(at(t), at(t + 1), at(t + 2), glm::dvec3(p)) < 0) return false;
    return true;
}

void try_few_points(Random& random, ShapeTrial& trial) {
    for (std::size_t count = 0; count < 4; ++count)
        trial.must_refuse(Hull::build(any_points(random, count)), ErrorCode::empty);
    // Four, of which two are one.
    Points points = any_points(random, 3);
    points.push_back(points[random.bits() % 3]);
    trial.must_refuse(Hull::build(points), ErrorCode::degenerate);
}

void try_coplanar(Random& random, ShapeTrial& trial) {
    Points points = any_points(random, 12);
    const int axis = static_cast<int>(random.bits() % 3);
    for (glm::vec3& p : points) p[axis] = points[0][axis];
    trial.must_refuse(Hull::build(points), ErrorCode::degenerate);
    // The least step out of the plane makes a shape.
    points[5][axis] = std::nextafter(points[5][axis], 2.0f);
    const auto thin = Hull::build(points);
    trial.require(thin && holds_all(*thin, points));
    for (glm::vec3& p : points) p = p[0] * glm::vec3(1.0f, 0.5f, -0.25f);  // on a line
    trial.must_refuse(Hull::build(points), ErrorCode::degenerate);
}

void try_duplicates(Random& random, ShapeTrial& trial) {
    Points points = any_points(random, 20);
    const auto once = Hull::build(points);
    const Points all = points;
    for (int i = 0; i < 30; ++i) points.push_back(all[random.bits() % all.size()]);
    const auto twice = Hull::build(points);
    const auto before = [](const glm::vec3& a, const glm::vec3& b) {
        return a.x != b.x ? a.x < b.x : a.y != b.y ? a.y < b.y : a.z < b.z;
    };
    const auto sorted = [&](const Hull& hull) {
        Points corners(hull.vertices().begin(), hull.vertices().end());
        std::sort(corners.begin(), corners.end(), before);
        return corners;
    };
    trial.require(once && twice && sorted(*once) == sorted(*twice));
}

void try_not_numbers(Random& random, ShapeTrial& trial) {
    const int axis = static_cast<int>(random.bits() % 3);
    Points points = any_points(random, 30);
    const std::uint64_t bad = random.bits() % points.size();
    const float value = static_cast<float>(not_finite(random));
    points[bad][axis] = value;
    trial.must_refuse(Hull::build(points), ErrorCode::non_finite, bad);
    glm::vec3 half(1.0f);
    half[axis] = value;
    trial.must_refuse(convex::Shape::box(half), ErrorCode::non_finite, static_cast<std::uint64_t>(axis));
    trial.must_refuse(convex::Shape::sphere(not_finite(random)), ErrorCode::non_finite);
    trial.must_refuse(convex::Shape::capsule(value, 1.0f), ErrorCode::non_finite);
    trial.must_refuse(convex::Shape::triangle(glm::vec3(1.0f), half, glm::vec3(0.0f)), ErrorCode::non_finite, 1);
    std::vector<float> heights(12, 1.0f);
    heights[7] = value;
    trial.must_refuse(convex::HeightField::build({.columns = 4, .rows = 3, .heights = heights}), ErrorCode::non_finite,
                      7);
    RigidTransform pose;
    pose.translation[axis] = not_finite(random);
    trial.must_refuse(convex::validate_pose(pose), ErrorCode::non_finite);
    const convex::Shape box = *convex::Shape::box(glm::vec3(1.0f));
    trial.require(!convex::intersects({box, {}}, {box, pose}));
    convex::Motion motion;
    motion.velocity[axis] = not_finite(random);
    trial.must_refuse(convex::cast({box, {}}, {}, {box, {}}, motion), ErrorCode::non_finite);
}

void try_inside_out(Random& random, ShapeTrial& trial) {
    glm::vec3 half = glm::abs(any_point(random)) + 0.1f;
    const int axis = static_cast<int>(random.bits() % 3);
    half[axis] = -half[axis];
    trial.must_refuse(convex::Shape::box(half), ErrorCode::invalid_argument, static_cast<std::uint64_t>(axis));
    trial.must_refuse(convex::Shape::sphere(static_cast<double>(half[axis])), ErrorCode::invalid_argument);
    trial.must_refuse(convex::Shape::cylinder(1.0f, half[axis]), ErrorCode::invalid_argument);
    RigidTransform mirrored{sampling::rotation(random.point<3>()), glm::dvec3(0.0)};
    mirrored.rotation[axis] = -mirrored.rotation[axis];
    trial.must_refuse(convex::validate_pose(mirrored), ErrorCode::invalid_argument);
    const convex::CompoundChild child{*convex::Shape::sphere(1.0), mirrored};
    trial.must_refuse(convex::Compound::build({&child, 1}), ErrorCode::invalid_argument, 0);
}

// Rarely, as each takes long.
void try_many_points(Random& random, ShapeTrial& trial) {
    Points points = any_points(random, 100'000);
    for (glm::vec3& p : points) p = glm::length(p) > 0.1f ? p / glm::length(p) : glm::vec3(1.0f, 0.0f, 0.0f);
    const auto hull = Hull::build(points);
    trial.require(hull && hull->vertices().size() <= std::size_t{convex::kMaxHullVertices} && holds_all(*hull, points));
    trial.require(hull && hull->max_overshoot() > 0.0 && hull->max_overshoot() < 0.1);
}

void try_casts(Random& random, ShapeTrial& trial) {
    const convex::Shape box = *convex::Shape::box(glm::vec3(0.5f));
    const double gap = random.uniform(0.5, 3.0);
    const RigidTransform near{glm::dmat3(1.0), {1.0 + gap, 0.0, 0.0}}, within{glm::dmat3(1.0), {0.7, 0.1, 0.0}};
    // Casts without duration or motion miss separate shapes, and hit overlapping ones at once.
    const convex::Motion forward{{9.0, 0.0, 0.0}, {}, {}};
    for (const convex::Motion& motion : {forward, convex::Motion{}}) {
        const convex::CastOptions no_time{.duration = motion.velocity.x > 0.0 ? 0.0 : 1.0};
        const auto miss = convex::cast({box, {}}, motion, {box, near}, {}, no_time);
        trial.require(miss && miss->result == convex::CastResult::miss);
        const auto hit = convex::cast({box, {}}, motion, {box, within}, {}, no_time);
        trial.require(hit && hit->result == convex::CastResult::hit && hit->time == 0.0);
    }
    // With many turns, a box that turns about its own axis sweeps the sphere around it.
    const double turns = random.uniform(2.0, 1000.0);
    const convex::Motion spinning{{gap + 2.0, 0.0, 0.0}, {0.0, 0.0, turns * 6.283185307179586}, {}};
    const auto hit = convex::cast({box, {}}, spinning, {box, near}, {}, {.max_steps = 100'000});
    const double early = (gap + 0.5 - std::sqrt(0.5)) / (gap + 2.0) - 1e-6, late = gap / (gap + 2.0) + 1e-6;
    trial.require(hit && hit->result == convex::CastResult::hit && hit->time >= early && hit->time <= late);
    convex::Motion wild;
    wild.spin.y = 1.1e5;
    trial.must_refuse(convex::cast({box, {}}, wild, {box, near}, {}), ErrorCode::out_of_range);
    trial.must_refuse(convex::cast({box, {}}, {}, {box, near}, {}, {.duration = -1.0}), ErrorCode::invalid_argument);
}

void try_height_fields(Random& random, ShapeTrial& trial) {
    const std::uint32_t many = 2 + static_cast<std::uint32_t>(random.bits() % 50);
    const std::vector<float> heights(many, 1.0f);
    using convex::HeightField;
    trial.must_refuse(HeightField::build({.columns = many, .rows = 1, .heights = heights}), ErrorCode::out_of_range);
    trial.must_refuse(HeightField::build({.columns = 1, .rows = many, .heights = heights}), ErrorCode::out_of_range);
    trial.must_refuse(HeightField::build({.columns = many, .rows = 2, .heights = heights}),
                      ErrorCode::invalid_argument);
    const std::vector<float> two(2 * many, 1.0f);
    const std::vector<std::uint8_t> holes(many - 1, convex::kHole);
    trial.must_refuse(HeightField::build({.columns = many, .rows = 2, .heights = two, .materials = holes}),
                      ErrorCode::empty);
    trial.require(HeightField::build({.columns = many, .rows = 2, .heights = two}).has_value());
}

// Compounds within compounds, 1,000 deep: the sixteenth is the last.
void try_deep_compounds(Random& random, ShapeTrial& trial) {
    std::vector<convex::Compound> chain;
    chain.reserve(1000);
    convex::Shape inner = *convex::Shape::sphere(random.uniform(0.1, 1.0));
    for (int depth = 1; depth <= 1000; ++depth) {
        const convex::CompoundChild child{inner, {}};
        auto built = convex::Compound::build({&child, 1});
        if (depth > convex::kMaxCompoundDepth) {
            trial.must_refuse(built, ErrorCode::out_of_range, 0);
            continue;
        }
        trial.require(built && built->depth() == depth);
        if (!built) return;
        chain.push_back(std::move(*built));
        inner = convex::Shape::compound(chain.back());
    }
    trial.require(convex::intersects({inner, {}}, {*convex::Shape::sphere(0.0), {}}));
    trial.must_refuse(convex::Compound::build({}), ErrorCode::empty);
}

// Contacts stay as they are until the next update, whatever is done to the shapes meanwhile.
void try_changes(Random& random, ShapeTrial& trial) {
    World world({.contact_margin = 0.02});
    const convex::Shape crate = *convex::Shape::box(glm::vec3(0.5f)), slab = *convex::Shape::box({9.0f, 1.0f, 9.0f}),
                        sphere = *convex::Shape::sphere(0.5);
    const Obb bounds{{0.0, 1.45, 0.0}, glm::mat3(1.0f), glm::vec3(0.55f)};
    const auto floor = world.add({.bound = Obb{{}, glm::mat3(1.0f), {9.0f, 1.0f, 9.0f}}});
    const auto box = world.add({.bound = bounds});
    trial.require(floor && box && world.set_shape(*floor, &slab) && world.set_shape(*box, &crate) && world.update());
    if (!floor || !box) return;
    const auto points = [&] { return world.contacts().empty() ? 0 : world.contacts()[0].shape_points.size(); };
    const auto read_after = [&](const Result<void>& done, std::size_t expected) {
        trial.require(done && points() == expected);
    };
    trial.require(points() == 4);
    const Contact read = world.contacts()[0];
    read_after(world.set_shape(*box, &sphere), 4);
    trial.require(read.shape_points[0].contact.depth == world.contacts()[0].shape_points[0].contact.depth);
    read_after(world.update(), 1);
    if (random.bits() % 2 == 0) {
        read_after(world.remove(*box), 1);
        trial.must_refuse(world.set_shape(*box, &crate), ErrorCode::stale_handle);
    } else {
        read_after(world.set_shape(*box, nullptr), 1);
    }
    trial.require(world.update().has_value());
    trial.require(std::all_of(world.contacts().begin(), world.contacts().end(),
                              [](const Contact& c) { return c.shape_points.empty(); }));
}

struct BadKind {
    const char* claim;
    void (*attempt)(Random&, ShapeTrial&);
    std::uint64_t share;  // one in so many rounds
};
constexpr BadKind kBadKinds[] = {
    {"hulls of fewer than four points are refused by name", try_few_points, 1},
    {"points on a plane or line are refused by name, and points a bit off it are a shape", try_coplanar, 1},
    {"points given twice do not change a hull", try_duplicates, 1},
    {"NaN and infinite numbers of shapes, poses and motions are refused by name and item", try_not_numbers, 1},
    {"shapes inside out and poses that mirror are refused by name", try_inside_out, 1},
    {"hulls of 100,000 points hold all of them with 256 corners", try_many_points, 100},
    {"casts of no length, of a thousand turns, and beyond the limits", try_casts, 1},
    {"height fields of one row, with too few heights or of holes alone are refused by name", try_height_fields, 1},
    {"compounds of compounds are refused beyond 16 deep, at each depth to 1,000", try_deep_compounds, 10},
    {"shapes changed or removed while their contacts are read: these stay until the next update", try_changes, 10},
};

}  // namespace

std::vector<VerifyRow> verify_bad_shapes(const VerifyOptions& options) {
    std::vector<VerifyRow> rows;
    const std::uint64_t rounds = std::max<std::uint64_t>(4, options.trials / 1000);
    for (const BadKind& kind : kBadKinds) {
        Random random(options.seed + rows.size());
        ShapeTrial trial;
        for (std::uint64_t round = 0; round < std::max<std::uint64_t>(1, rounds / kind.share); ++round)
            kind.attempt(random, trial);
        rows.push_back(none_row(kind.claim, "bad input", trial.tried, trial.wrong));
    }
    return rows;
}

}  // namespace crofton::cli
