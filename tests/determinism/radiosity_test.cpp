// SPDX-License-Identifier: MIT
// Lines and light in the same bits everywhere.
#include <crofton/lines/lines.hpp>
#include <crofton/radiosity/patches.hpp>
#include <crofton/radiosity/solver.hpp>

#include "crowd.hpp"
#include "digest.hpp"
#include "everywhere.hpp"

using namespace crofton;
using namespace crofton::test;

namespace {

// A torus that shines on another around it, seen from inside.
radiosity::Patches patches() {
    TriangleMesh mesh = torus(24, 12, 0.2);
    const TriangleMesh outer = torus(16, 8, 0.0);
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    const std::size_t lamps = mesh.triangle_count();
    for (const glm::vec3& p : outer.positions) mesh.positions.push_back(3.0f * p);
    for (std::size_t i = 0; i < outer.indices.size(); i += 3)
        for (const std::size_t k : {0u, 2u, 1u}) mesh.indices.push_back(first + outer.indices[i + k]);
    std::vector<radiosity::Material> materials(mesh.triangle_count());
    for (std::size_t i = 0; i < lamps; ++i) materials[i].emission = glm::vec3(1.0f, 0.75f, 0.5f);
    return *radiosity::make_patches(std::move(mesh), materials);
}

radiosity::SolverOptions options(std::uint64_t lines, std::optional<lines::LineMethod> method,
                                 radiosity::Transport transport) {
    radiosity::SolverOptions result;
    result.lines = lines;
    result.method = method;
    result.transport = transport;
    return result;
}

std::uint64_t light(Executor& executor) {
    Digest digest;
    const radiosity::Patches scene = patches();
    for (const auto method : {lines::LineMethod::bundles, lines::LineMethod::walls, lines::LineMethod::disc}) {
        auto solver = *radiosity::Solver::create(scene, options(4000, method, radiosity::Transport::global));
        for (int run = 0; run < 2; ++run) solver.run(executor);
        digest.add(solver.radiosity()).add(solver.relative_error());
    }
    auto local = *radiosity::Solver::create(scene, options(2000, {}, radiosity::Transport::local));
    local.run(executor);
    return digest.add(local.radiosity()).value();
}

std::uint64_t crossings() {
    Digest digest;
    const radiosity::Patches scene = patches();
    const auto tracer = *lines::LineTracer::build(scene.mesh);
    const auto bundles = *lines::BundleTracer::build(scene.mesh);
    Vector<Line> lines;
    lines::LineHits hits;
    const auto add = [&] {
        for (const lines::Hit& hit : hits.hits)
            digest.add(hit.t).add(hit.triangle).add(static_cast<std::uint8_t>(hit.front));
        digest.add(hits.ends);
    };
    lines::LineSource(tracer.bounds(), lines::LineMethod::sphere_points, 71).draw(0, lines);
    tracer.all_hits(lines, hits);
    add();
    lines::BundleTracer::Scratch scratch;
    bundles.all_hits(lines::make_bundle(bundles.bounds(), 0.01, {0.3, 0.6}, 72), scratch, hits);
    add();
    return digest.value();
}

}  // namespace

TEST_SUITE("determinism/radiosity") {
    TEST_CASE("crossings of lines and of bundles are the same bits everywhere") {
        check_everywhere(0x2b0e127e27e5df15, [](Executor&) { return crossings(); });
    }

    TEST_CASE("light by every kind of line is the same bits everywhere") {
        check_everywhere(0x3d975bc645d4da28, [](Executor& e) { return light(e); });
    }
}
