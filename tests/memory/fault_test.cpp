// SPDX-License-Identifier: MIT
// Every allocation of every operation that builds, loads, bakes, fits or triangulates fails once: an Error, no leak,
// nothing changed.
#include <doctest/doctest.h>
#include <cmath>
#include <crofton/bake/baked_scene.hpp>
#include <crofton/boxtree/box_tree.hpp>
#include <crofton/convex/shape.hpp>
#include <crofton/core/executor.hpp>
#include <crofton/fit/fit.hpp>
#include <crofton/geometry/mesh.hpp>
#include <crofton/lines/lines.hpp>
#include <crofton/measure/measure.hpp>
#include <crofton/mesh/mesh_tree.hpp>
#include <crofton/pvs/pvs.hpp>
#include <crofton/radiosity/patches.hpp>
#include <crofton/radiosity/solver.hpp>
#include <crofton/sampling/sampling.hpp>
#include <crofton/scene/scene.hpp>
#include <crofton/triangulate/triangulate.hpp>
#include <filesystem>
#include <fstream>

#include <bake/pvs/bake_geometry.hpp>

#include "failing_memory.hpp"
#include "shapes.hpp"
#include "sweep.hpp"

using namespace crofton;

void* operator new(std::size_t bytes) {
    void* memory = crofton::testing::allocate_or_fail(bytes, alignof(std::max_align_t));
    if (!memory) throw std::bad_alloc();
    return memory;
}
void* operator new(std::size_t bytes, std::align_val_t alignment) {
    void* memory = crofton::testing::allocate_or_fail(bytes, static_cast<std::size_t>(alignment));
    if (!memory) throw std::bad_alloc();
    return memory;
}
// Does not fail: standard algorithms ask here for scratch that they can do without.
void* operator new(std::size_t bytes, const std::nothrow_t&) noexcept {
    const std::int64_t left = crofton::testing::allocations_left.exchange(crofton::testing::kNever);
    void* memory = crofton::testing::allocate_or_fail(bytes, alignof(std::max_align_t));
    crofton::testing::allocations_left = left;
    return memory;
}
void operator delete(void* memory) noexcept {
    crofton::testing::release(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
    crofton::testing::release(memory);
}
void operator delete(void* memory, std::align_val_t) noexcept {
    crofton::testing::release(memory);
}
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept {
    crofton::testing::release(memory);
}

namespace {

using testing::boxes, testing::grid, testing::points, testing::star;
using testing::failures_tried, testing::outcome_of, testing::sweep;

// What is passed by value is copied while memory lasts.
template <class T>
T copy_of(const T& value) {
    const std::int64_t left = testing::allocations_left.exchange(testing::kNever);
    T copy(value);
    testing::allocations_left = left;
    return copy;
}

scene::Scene small_scene() {
    scene::Scene scene;
    const auto mesh = scene.add_mesh(grid(2), "grid with a name that is too long for a small string").value();
    for (int i = 0; i < 40; ++i) {
        Transform place;
        place.translation.x = 5.0 * i;
        const auto node = scene.add_node(scene::kNone, place, ~0u, "node with a name that is too long for one").value();
        static_cast<void>(scene.add_instance(node, mesh).value());
    }
    scene.update();
    return scene;
}

}  // namespace

TEST_SUITE("memory/fault") {
    TEST_CASE("hulls and measures") {
        const testing::FailingMemory memory;
        const auto cloud = points(300);
        const Vector<glm::dvec3> precise(cloud.begin(), cloud.end());
        const Vector<glm::dvec2> flat{{0, 0}, {2, 0}, {2, 1}, {1, 3}, {0, 1}};
        sweep("convex_hull, float", [&] { return outcome_of(convex_hull(std::span<const glm::vec3>(cloud))); });
        sweep("convex_hull, double", [&] { return outcome_of(convex_hull(std::span<const glm::dvec3>(precise))); });
        sweep("intrinsic_volumes_of_hull", [&] { return outcome_of(measure::intrinsic_volumes_of_hull(precise)); });
        sweep("intrinsic_volumes_of_polytope", [&] {
            static const auto hull = convex_hull(std::span<const glm::dvec3>(precise));
            return outcome_of(measure::intrinsic_volumes_of_polytope(precise, hull->triangles));
        });
    }

    TEST_CASE("boxes: fast, exact, many at once on threads, merged") {
        const testing::FailingMemory memory;
        const auto cloud = points(300);
        const std::span<const glm::vec3> span(cloud);
        const Vector<glm::dvec3> precise(cloud.begin(), cloud.end());
        sweep("fit_obb, float", [&] { return outcome_of(fit::fit_obb(span)); });
        sweep("fit_obb, double", [&] { return outcome_of(fit::fit_obb(std::span<const glm::dvec3>(precise))); });
        const auto large = points(9000);  // most of them are forgotten
        sweep("fit_obb, many", [&] { return outcome_of(fit::fit_obb(std::span<const glm::vec3>(large))); });
        sweep("fit_exact", [&] { return outcome_of(fit::fit_exact(span, {.gap = 1e-2})); });
        const auto many = boxes(20);
        sweep("merge", [&] { return outcome_of(fit::merge(many, measure::minimal_perimeter())); });
        const Vector<glm::dvec2> flat{{0, 0}, {2, 0}, {2, 1}, {1, 3}, {0, 1}};
        for (const auto by : {fit::PlanarCriterion::area, fit::PlanarCriterion::perimeter}) {
            sweep("minimal_rectangle", [&] { return outcome_of(fit::minimal_rectangle(flat, by)); });
            sweep("minimal_triangle", [&] { return outcome_of(fit::minimal_triangle(flat, by)); });
        }
        sweep("minimal_disc", [&] { return outcome_of(fit::minimal_disc(flat)); });
        Vector<std::uint32_t> indices(300), ends;
        for (std::uint32_t i = 0; i < 300; ++i) indices[i] = i;
        for (std::uint32_t i = 5; i <= 300; i += 5) ends.push_back(i);
        Vector<Obb> fitted(ends.size());
        ThreadPool pool(3);
        for (Executor* executor : {&serial_executor(), static_cast<Executor*>(&pool)})
            sweep("fit_many", [&] { return outcome_of(fit::fit_many({span, indices, ends}, {}, *executor, fitted)); });
    }

    TEST_CASE("trees: built on one thread and on several, stored and taken back, of triangles") {
        const testing::FailingMemory memory;
        const auto many = boxes(3000);
        ThreadPool pool(3);
        for (Executor* executor : {&serial_executor(), static_cast<Executor*>(&pool)})
            sweep("BoxTree::build", [&] { return outcome_of(boxtree::BoxTree::build(many, {}, *executor)); });
        const auto bytes = boxtree::BoxTree::build(many).value().serialise();
        sweep("BoxTree::deserialise", [&] { return outcome_of(boxtree::BoxTree::deserialise(bytes)); });
        const TriangleMesh mesh = grid(12);
        sweep("MeshTree::build", [&] { return outcome_of(mesh::MeshTree::build(mesh)); });
        sweep("MeshTree::build, refittable",
              [&] { return outcome_of(mesh::MeshTree::build(mesh, {.refittable = true, .rays = true})); });
    }

    TEST_CASE("convex shapes: hulls in full and simplified, height fields, compounds") {
        const testing::FailingMemory memory;
        Vector<glm::vec3> points;
        for (int i = 0; i < 40; ++i)
            points.emplace_back(std::cos(0.7f * static_cast<float>(i)), std::sin(1.3f * static_cast<float>(i)),
                                std::cos(2.1f * static_cast<float>(i)));
        for (const int most : {256, 8})
            sweep("Hull::build", [&] { return outcome_of(convex::Hull::build(points, {.max_vertices = most})); });
        const Vector<float> heights(36, 1.0f);
        sweep("HeightField::build",
              [&] { return outcome_of(convex::HeightField::build({.columns = 6, .rows = 6, .heights = heights})); });
        const Vector<convex::CompoundChild> children(9, {convex::Shape::sphere(1.0f).value(), {}});
        sweep("Compound::build", [&] { return outcome_of(convex::Compound::build(children)); });
    }

    TEST_CASE("triangulations, a Triangulator answers as before after one that failed") {
        const testing::FailingMemory memory;
        const Polygon polygon = star();
        for (const auto method :
             {triangulate::Method::ear, triangulate::Method::delaunay, triangulate::Method::minimum_weight}) {
            sweep("triangulate", [&] { return outcome_of(triangulate::triangulate(polygon, {.method = method})); });
            const auto expected = triangulate::triangulate(polygon, {.method = method}).value();
            for (std::int64_t n = 0;; ++n) {
                triangulate::Triangulator triangulator;
                triangulate::Triangulation result;
                testing::has_failed = false;
                testing::allocations_left = n;
                const bool done = triangulator.triangulate(polygon, {.method = method}, result).has_value();
                testing::allocations_left = testing::kNever;
                REQUIRE(done != testing::has_failed);
                ++failures_tried;
                REQUIRE(triangulator.triangulate(polygon, {.method = method}, result).has_value());
                REQUIRE(result.triangles == expected.triangles);
                if (done) break;
            }
        }
        const TriangleMesh mesh = grid(4);
        sweep("find_planar_patches", [&] { return outcome_of(triangulate::find_planar_patches(mesh)); });
        TriangleMesh changed = mesh;
        sweep(
            "retriangulate_planar_patches",
            [&] { return outcome_of(triangulate::retriangulate_planar_patches(changed)); },
            [&] { return changed.positions.size() == mesh.positions.size() && validate(changed).has_value(); });
    }

    TEST_CASE("scenes: what is added is there as a whole or not at all") {
        const testing::FailingMemory memory;
        const TriangleMesh mesh = grid(3);
        for (const int before : {0, 7, 8, 40}) {
            // Each try begins with a scene of its own, as success would change it.
            for (std::int64_t n = 0;; ++n) {
                scene::Scene scene;
                const auto own = scene.add_mesh(mesh, "m").value();
                const auto root = scene.add_node(scene::kNone, {}).value();
                for (int i = 0; i < before; ++i)
                    static_cast<void>(scene.add_instance(scene.add_node(root, {}).value(), own).value());
                const auto counts = [&] {
                    return std::array{scene.mesh_count(), scene.node_count(), scene.instance_count()};
                };
                const auto old = counts();
                TriangleMesh copy = mesh;
                testing::has_failed = false;
                testing::allocations_left = n;
                const auto added_mesh = scene.add_mesh(std::move(copy), "a name that is too long for a small string");
                const bool mesh_failed = testing::has_failed;
                const auto added_node = scene.add_node(root, {}, ~0u, "a name that is too long for a small string");
                const bool node_failed = testing::has_failed && !mesh_failed;
                const auto added = scene.add_instance(root, own);
                testing::allocations_left = testing::kNever;
                const bool failed = testing::has_failed;
                CHECK(added_mesh.has_value() == !mesh_failed);
                CHECK(added_node.has_value() == !node_failed);
                CHECK(added.has_value() == !(failed && !mesh_failed && !node_failed));
                CHECK(counts() == std::array{old[0] + added_mesh.has_value(), old[1] + added_node.has_value(),
                                             old[2] + added.has_value()});
                // The scene lives on.
                const auto node = scene.add_node(root, {}).value();
                static_cast<void>(scene.add_instance(node, own).value());
                scene.update();
                for (scene::InstanceId i = 0; i < scene.instance_count(); ++i)
                    REQUIRE(validate(scene.world_boxes()[i]));
                failures_tried += failed;
                if (!failed) break;
            }
        }
    }

    TEST_CASE("baking, and opening what was baked, mapped or read") {
        const testing::FailingMemory memory;
        const scene::Scene scene = small_scene();
        ThreadPool pool(2);
        sweep("bake", [&] { return outcome_of(bake::bake(scene)); });
        sweep("bake on threads", [&] { return outcome_of(bake::bake(scene, pool)); });
        const auto bytes = bake::bake(scene).value();
        sweep("BakedScene::from_memory", [&] { return outcome_of(bake::BakedScene::from_memory(bytes)); });
        const auto path = (std::filesystem::temp_directory_path() / "crofton-memory-XXXXXX").string();
        std::ofstream(path, std::ios::binary)
            .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
        for (const auto access : {bake::FileAccess::map, bake::FileAccess::read})
            sweep("BakedScene::open",
                  [&] { return outcome_of(bake::BakedScene::open(path, serial_executor(), {.access = access})); });
        std::filesystem::remove(path);
    }

    TEST_CASE("a scene's mesh is replaced as a whole or stays") {
        const testing::FailingMemory memory;
        scene::Scene scene = small_scene();
        const TriangleMesh other = grid(3);
        sweep(
            "replace_mesh", [&] { return outcome_of(scene.replace_mesh(0, copy_of(other))); },
            [&] { return scene.mesh(0).indices == other.indices; });
    }

    TEST_CASE("visible sets: lines, proofs, files") {
        const testing::FailingMemory memory;
        const pvs::BakeGeometry geometry = testing::random_geometry(1, 6);
        const auto cells = pvs::Cells::grid({{-5.0, 0.0, -5.0}, {5.0, 2.0, 5.0}}, {2, 1, 2}).value();
        sweep("Bake::create", [&] { return outcome_of(pvs::Bake::create(geometry, cells, {.epsilon = 0.05})); });
        auto bake = pvs::Bake::create(geometry, cells, {.epsilon = 0.05}).value();
        sweep("Bake::run", [&] {
            auto fresh = [&] {
                const std::int64_t left = testing::allocations_left.exchange(testing::kNever);
                auto made = pvs::Bake::create(geometry, cells, {.epsilon = 0.05});
                testing::allocations_left = left;
                return made;
            }();
            return outcome_of(fresh->run({.lines = 2000}));
        });
        REQUIRE(bake.run({.lines = 2000}));
        sweep("Bake::state", [&] { return outcome_of(bake.state()); });
        const auto state = bake.state().value();
        sweep("Bake::add_state", [&] { return outcome_of(bake.add_state(state)); });
        sweep("Pvs::finish", [&] { return outcome_of(pvs::Pvs::finish(bake)); });
        const auto sets = pvs::Pvs::finish(bake).value();
        sweep("Pvs::to_file", [&] { return outcome_of(sets.to_file()); });
        const auto file = sets.to_file().value();
        sweep("Pvs::from_memory", [&] { return outcome_of(pvs::Pvs::from_memory(file)); });
    }

    TEST_CASE("light: patches, tracers, solvers") {
        const testing::FailingMemory memory;
        const TriangleMesh mesh = grid(4);
        const Vector<radiosity::Material> materials(mesh.triangle_count(), {glm::vec3(1.0f), glm::vec3(0.5f)});
        sweep("make_patches", [&] { return outcome_of(radiosity::make_patches(copy_of(mesh), materials)); });
        sweep("refine", [&] { return outcome_of(radiosity::refine(mesh, 0.4)); });
        sweep("mend_t_junctions", [&] { return outcome_of(radiosity::mend_t_junctions(mesh, 1e-4)); });
        sweep("BundleTracer::build", [&] { return outcome_of(lines::BundleTracer::build(mesh)); });
        sweep("LineTracer::build", [&] { return outcome_of(lines::LineTracer::build(mesh)); });
        const auto patches = radiosity::make_patches(TriangleMesh(mesh), materials).value();
        sweep("Solver::create", [&] { return outcome_of(radiosity::Solver::create(patches)); });
        const auto tracer = lines::LineTracer::build(mesh).value();
        const lines::LineSource source({{0, 0, -1}, {4, 4, 1}}, lines::LineMethod::walls, 1);
        // On this thread, whose memory for tracing is warm: others keep theirs.
        sweep("factors_by_global_lines",
              [&] { return outcome_of(radiosity::factors_by_global_lines(tracer, patches, source, 3)); });
        sweep("LinesFromHull::make", [&] { return outcome_of(sampling::LinesFromHull::make(mesh)); });
        MESSAGE(failures_tried << " allocations failed in all");
    }
}
