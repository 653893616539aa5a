// SPDX-License-Identifier: MIT
// What a tree's criterion is worth: tests per query for trees built by every strategy, on real and random scenes. The
// time is that of the build. docs/notes/boxtree.md quotes: bench_measure --benchmark_filter=hierarchy
#include <benchmark/benchmark.h>

#include <assets/scene_source.hpp>
#include <cmath>
#include <crofton/cull/classify.hpp>
#include <crofton/fit/fit.hpp>
#include <crofton/measure/measure.hpp>
#include <crofton/sampling/sampling.hpp>
#include <crofton/study/binary_tree.hpp>
#include <crofton/study/bound_given_ancestors.hpp>
#include <crofton/study/query_sample.hpp>
#include <filesystem>
#include <glm/geometric.hpp>
#include <map>
#include <memory>
#include <numbers>
#include <pipeline/camera_path.hpp>
#include <string>
#include <utility>
#include <vector>

namespace {

using namespace crofton;
using measure::Criterion;
using study::BinaryTree;
using study::Split;
using study::Visit;

struct World {
    std::vector<Obb> boxes;
    std::vector<Camera> views;
    Sphere region;
};

void enclose(World& world) {
    Aabb all;
    for (const Obb& box : world.boxes) all.include(aabb_of(box));
    world.region = {all.center(), glm::length(all.half_extents())};
}

World random_world(const glm::dvec3& least, const glm::dvec3& most) {
    World world;
    sampling::Random random(1);
    const auto between = [&](double a, double b) { return a * std::pow(b / a, random.uniform()); };
    for (int i = 0; i < 20'000; ++i) {
        Obb box;
        box.center = 100.0 * glm::dvec3(random.uniform(), random.uniform(), random.uniform());
        box.axes = glm::mat3(sampling::rotation(random.point<3>()));
        box.half_extents =
            glm::vec3(0.5 * glm::dvec3(between(least.x, most.x), between(least.y, most.y), between(least.z, most.z)));
        world.boxes.push_back(box);
    }
    enclose(world);
    Camera camera;
    camera.far_distance = 50.0;
    const Aabb inside{glm::dvec3(0.0), glm::dvec3(100.0)};
    for (int i = 0; i < 100; ++i) world.views.push_back(sampling::random_camera(camera, inside, random.point<6>()));
    return world;
}

// Instances of a scene, seen along a street path or, without a walk, an orbit.
World scene_world(const std::string& source, std::uint32_t instances, const std::string& path) {
    World world;
    assets::LoadOptions options;
    options.instances = instances;
    auto loaded = assets::load_scene(source, options);
    if (!loaded) return world;
    loaded->scene.update();
    for (std::size_t i = 0; i < loaded->scene.instance_count(); ++i)
        if (!loaded->scene.is_removed(static_cast<scene::InstanceId>(i)))
            world.boxes.push_back(loaded->scene.world_boxes()[i]);
    enclose(world);
    const auto cameras =
        pipeline::make_camera_path({.kind = path, .frames = 100}, pipeline::focus_of(loaded->scene), loaded->walk);
    if (cameras) world.views = cameras->cameras;
    return world;
}

const World& world_named(const std::string& name) {
    static std::map<std::string, World> worlds;
    const auto found = worlds.find(name);
    if (found != worlds.end()) return found->second;
    const std::string shared = CROFTON_SHARED_DATA "/scenes/";
    World& world = worlds[name];
    if (name == "boxes") world = random_world(glm::dvec3(0.1), glm::dvec3(3.0));
    if (name == "needles") world = random_world({5.0, 0.02, 0.02}, {20.0, 0.1, 0.1});
    if (name == "town_street") world = scene_world("town", 0, "street");
    if (name == "town_orbit") world = scene_world("town", 0, "orbit");
    if (name == "large_town_street") world = scene_world("town", 30'000, "street");
    if (name == "forest_street") world = scene_world(shared + "stk_black_forest.glb", 0, "street");
    if (name == "forest_orbit") world = scene_world(shared + "stk_black_forest.glb", 0, "orbit");
    return world;
}

// The frustum in use, its far plane at the end of the world where it has none nearer.
Camera finite(Camera camera, const World& world) {
    camera.far_distance = std::min(camera.far_distance, 2.0 * world.region.radius);
    return camera;
}

enum class Build { median, nested, sampled, inserted };

struct Strategy {
    const char* name;
    Build build;
    Criterion (*criterion)(const World&);
    bool oriented;
};

Criterion by_area(const World&) {
    return measure::minimal_area();
}
Criterion by_edges(const World&) {
    return measure::minimal_perimeter();
}
Criterion by_frustum(const World& world) {
    return *measure::for_frustum(finite(world.views[0], world));
}
// How often a bound straddles: μ(hits) − μ(is contained) = 2V + 2·F_B·M/4π to first order; F drops out.
Criterion by_straddling(const World& world) {
    const auto b = *measure::intrinsic_volumes_of_frustum(finite(world.views[0], world));
    return {1.0, 0.0, b.area / (4.0 * std::numbers::pi)};
}

constexpr Strategy kStrategies[] = {
    {"median", Build::median, by_edges, false},
    {"nested_F", Build::nested, by_area, false},
    {"nested_M", Build::nested, by_edges, false},
    {"kinematic", Build::nested, by_frustum, false},
    {"straddling", Build::nested, by_straddling, false},
    {"sampled", Build::sampled, by_frustum, false},
    {"oriented_F", Build::nested, by_area, true},
    {"oriented_M", Build::nested, by_edges, true},
    {"oriented_kinematic", Build::nested, by_frustum, true},
    {"oriented_n_level", Build::sampled, by_frustum, true},
    {"inserted_F", Build::inserted, by_area, false},
    {"inserted_M", Build::inserted, by_edges, false},
    {"inserted_kinematic", Build::inserted, by_frustum, false},
};

BinaryTree build(const World& world, const Strategy& strategy) {
    const Criterion criterion = strategy.criterion(world);
    study::BinaryTreeOptions options{
        .split_criterion = criterion, .criterion = criterion, .oriented = strategy.oriented};
    if (strategy.build == Build::inserted) {
        BinaryTree tree = *BinaryTree::build({}, options);
        for (const Obb& box : world.boxes) (void)*tree.insert(box);
        return tree;
    }
    options.split = strategy.build == Build::median
                        ? Split::median
                        : (strategy.build == Build::sampled ? Split::sampled : Split::nested);
    study::QuerySample queries;
    if (options.split == Split::sampled) {
        queries = *study::QuerySample::frusta(finite(world.views[0], world), world.region, 4096, 1);
        options.queries = &queries;
    }
    return *BinaryTree::build(world.boxes, options);
}

struct Tally {
    double tests = 0.0, tests_without_taking = 0.0, improper_outside = 0.0, improper_inside = 0.0;
};

// Per node how many items below meet the view, and how many are inside.
struct Below {
    std::uint32_t met = 0, inside = 0, all = 0;
};

Tally tally(const World& world, const BinaryTree& tree) {
    Tally sum;
    std::vector<Below> below(2 * world.boxes.size());
    for (const Camera& view : world.views) {
        const Frustum frustum = *frustum_of(view);
        std::fill(below.begin(), below.end(), Below{});
        for (boxtree::ItemId i = 0; i < world.boxes.size(); ++i) {
            const cull::Verdict verdict = cull::classify(frustum, world.boxes[i]);
            for (std::uint32_t n = tree.leaf(i); n != study::kNone; n = tree.node(n).parent) {
                below[n].met += verdict != cull::Verdict::outside;
                below[n].inside += verdict == cull::Verdict::inside;
                ++below[n].all;
            }
        }
        const auto node_of = [&](const Obb& bound) {
            const auto* node = reinterpret_cast<const BinaryTree::Node*>(&bound);  // `bound` is a node's first member
            return static_cast<std::size_t>(node - &tree.node(0));
        };
        sum.tests += static_cast<double>(tree.visit(
            [&](const Obb& bound) {
                const cull::Verdict verdict = cull::classify(frustum, bound);
                const Below& b = below[node_of(bound)];
                sum.improper_outside += verdict != cull::Verdict::outside && b.met == 0;
                sum.improper_inside += verdict == cull::Verdict::straddling && b.inside == b.all;
                return verdict == cull::Verdict::outside
                           ? Visit::skip
                           : (verdict == cull::Verdict::inside ? Visit::take : Visit::descend);
            },
            [](boxtree::ItemId) {}));
        sum.tests_without_taking += static_cast<double>(tree.visit(
            [&](const Obb& bound) {
                return cull::classify(frustum, bound) == cull::Verdict::outside ? Visit::skip : Visit::descend;
            },
            [](boxtree::ItemId) {}));
    }
    const double n = static_cast<double>(world.views.size());
    return {sum.tests / n, sum.tests_without_taking / n, sum.improper_outside / n, sum.improper_inside / n};
}

double tests_per_line(const World& world, const BinaryTree& tree) {
    const auto lines = *study::QuerySample::lines(world.region, 1024, 2);
    std::size_t tests = 0;
    for (std::uint32_t i = 0; i < lines.size(); ++i)
        tests += tree.visit([&](const Obb& bound) { return lines.hits(i, bound) ? Visit::descend : Visit::skip; },
                            [](boxtree::ItemId) {});
    return static_cast<double>(tests) / lines.size();
}

void hierarchy(benchmark::State& state, const std::string& world_name, const Strategy& strategy) {
    const World& world = world_named(world_name);
    if (world.boxes.empty() || world.views.empty()) return state.SkipWithError("scene not found");
    for (auto _ : state) benchmark::DoNotOptimize(build(world, strategy));
    const BinaryTree tree = build(world, strategy);
    const Tally result = tally(world, tree);
    state.counters["boxes"] = static_cast<double>(world.boxes.size());
    state.counters["tests"] = result.tests;
    state.counters["tests_no_take"] = result.tests_without_taking;
    state.counters["improper_out"] = result.improper_outside;
    state.counters["improper_in"] = result.improper_inside;
    state.counters["tests_per_line"] = tests_per_line(world, tree);
}

// Boxes fitted given one or three ancestors of other orientations, against the plain fit by M: queries that reach the
// box's children, per query that passes all ancestors.
void bound_given_ancestors(benchmark::State& state, const study::QuerySample& queries) {
    const auto levels = static_cast<std::size_t>(state.range(0));
    double plain = 0.0, given = 0.0, reaching = 0.0;
    for (auto _ : state) {
        sampling::Random random(9);
        plain = given = reaching = 0.0;
        for (int object = 0; object < 20; ++object) {
            std::vector<glm::dvec3> points;
            for (int i = 0; i < 40; ++i)
                points.push_back(glm::dvec3(1.0, 0.5, 0.25) * sampling::ball_point(random.point<3>()));
            std::vector<Obb> ancestors;
            for (std::size_t k = 0; k < levels; ++k)
                ancestors.push_back(*fit::fit_oriented(points, glm::mat3(sampling::rotation(random.point<3>()))));
            const auto found = *study::bound_given_ancestors(points, ancestors, queries, measure::minimal_perimeter(),
                                                             {.max_cells = 0});
            plain += found.plain_hits, given += found.hits, reaching += found.ancestor_hits;
        }
    }
    state.counters["plain"] = plain / reaching;
    state.counters["given_ancestors"] = given / reaching;
}

const bool kRegistered = [] {
    const Sphere region{glm::dvec3(0.0), 2.5};
    Camera camera;
    camera.far_distance = 20.0;
    const std::pair<const char*, study::QuerySample> samples[] = {
        {"planes", *study::QuerySample::planes(region, 4096, 1)},
        {"lines", *study::QuerySample::lines(region, 4096, 1)},
        {"frusta", *study::QuerySample::frusta(camera, region, 4096, 1)}};
    for (const auto& [name, sample] : samples)
        benchmark::RegisterBenchmark(
            (std::string("bound_given_ancestors/") + name).c_str(),
            [queries = sample](benchmark::State& state) { bound_given_ancestors(state, queries); })
            ->Arg(1)
            ->Arg(3)
            ->Unit(benchmark::kMillisecond)
            ->Iterations(1);
    for (const char* world :
         {"boxes", "needles", "town_street", "town_orbit", "large_town_street", "forest_street", "forest_orbit"})
        for (const Strategy& strategy : kStrategies)
            benchmark::RegisterBenchmark(
                (std::string("hierarchy/") + world + "/" + strategy.name).c_str(),
                [world = std::string(world), &strategy](benchmark::State& state) { hierarchy(state, world, strategy); })
                ->Unit(benchmark::kMillisecond)
                ->Iterations(strategy.build == Build::sampled ? 1 : 3);
    return true;
}();

}  // namespace
