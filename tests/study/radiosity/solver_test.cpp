// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <crofton/core/executor.hpp>
#include <crofton/radiosity/patches.hpp>
#include <crofton/radiosity/solver.hpp>
#include <error_of.hpp>

#include "lit_box.hpp"
#include "shapes.hpp"

using namespace crofton;
using namespace crofton::lines;
using namespace crofton::radiosity;
using namespace shapes;

namespace {

// The full system B = E + R·F·B with factors from local lines, iterated to the end: shares no code with the solver's
// walks.
std::vector<glm::dvec3> full_matrix_solution(const Patches& patches, std::uint64_t lines) {
    const auto tracer = LineTracer::build(patches.mesh);
    const std::size_t n = patches.count();
    std::vector<FactorRow> rows;
    for (std::uint32_t i = 0; i < n; ++i)
        rows.push_back(factors_by_local_lines(*tracer, patches, i, lines, LocalDensity::cosine, 1000 + i));
    std::vector<glm::dvec3> light(n, glm::dvec3(0.0));
    for (int iteration = 0; iteration < 100; ++iteration) {
        std::vector<glm::dvec3> next(n);
        for (std::size_t i = 0; i < n; ++i) {
            glm::dvec3 arrived(0.0);
            for (std::size_t j = 0; j < n; ++j) arrived += rows[i].factors[j] * light[j];
            next[i] =
                glm::dvec3(patches.materials[i].emission) + glm::dvec3(patches.materials[i].reflectance) * arrived;
        }
        light = std::move(next);
    }
    return light;
}

}  // namespace

TEST_SUITE("radiosity/solver") {
    TEST_CASE("a scene without light, and light that is not finite, are refused by name") {
        Shape s;
        s.room({0, 0, 0}, {1, 1, 1}, 0);
        const Patches dark = patches_of(s, std::vector<Material>(6));
        const auto refused = Solver::create(dark);
        REQUIRE_FALSE(refused.has_value());
        CHECK(error_of(refused).message.find("nothing gives light") != std::string::npos);
        SolverOptions options;
        options.outside.sky.y = -1.0f;
        CHECK(error_of(Solver::create(dark, options)).code == ErrorCode::out_of_range);
        options = {};
        options.outside.sun = glm::vec3(1.0f);
        options.outside.to_sun = glm::dvec3(0.0);
        CHECK(error_of(Solver::create(dark, options)).code == ErrorCode::degenerate);
        for (const double far : {1e200, HUGE_VAL, std::nan("")}) {
            options.outside.to_sun = {0.0, far, 0.0};
            CHECK(error_of(Solver::create(dark, options)).code == ErrorCode::out_of_range);
        }
        options = quick();
        options.outside.sky = glm::vec3(1.0f);
        options.cutoff = 0.0;
        CHECK(error_of(Solver::create(dark, options)).code == ErrorCode::out_of_range);
    }

    TEST_CASE("furnace: in a closed box that glows with 1 and reflects rho, the radiosity is 1/(1 - rho) everywhere") {
        for (const float rho : {0.0f, 0.5f, 0.7f}) {
            Shape s;
            s.room({0, 0, 0}, {3, 1, 2}, 0);
            s.sphere({1.5f, 0.5f, 1}, 0.3f, 8, false, 6);
            const Patches patches = patches_of(s, std::vector<Material>(7, {glm::vec3(1.0f), glm::vec3(rho)}));
            for (const Transport transport : {Transport::global, Transport::local}) {
                SolverOptions options = quick();
                options.transport = transport;
                auto solver = Solver::create(patches, options).value();
                for (int run = 0; run < 12; ++run) solver.run();
                // The first shot is the only noise, about √(7/(12·2^14)) per patch: later bounces of a constant are
                // exact.
                for (const glm::vec3& b : solver.radiosity())
                    CHECK(b.x == doctest::Approx(1.0 / (1.0 - rho)).epsilon(0.02));
                CHECK(solver.unseen() == 0.0);
            }
        }
    }

    TEST_CASE("energy: what the lamps of a closed scene give off is absorbed") {
        const Box box = lit_box(3);
        const Patches patches = patches_of(box.shape, box.materials);
        auto solver = Solver::create(patches, quick()).value();
        for (int run = 0; run < 10; ++run) solver.run();
        for (int k = 0; k < 3; ++k) {
            double given = 0.0, absorbed = 0.0;
            for (std::size_t i = 0; i < patches.count(); ++i) {
                const double e = static_cast<double>(patches.materials[i].emission[k]),
                             r = static_cast<double>(patches.materials[i].reflectance[k]);
                given += patches.areas[i] * e;
                absorbed += patches.areas[i] * (1.0 - r) * (static_cast<double>(solver.radiosity()[i][k]) - e) / r;
            }
            CHECK(absorbed == doctest::Approx(given).epsilon(0.01));
        }
    }

    TEST_CASE("a coloured box with a lamp agrees with an independent full-matrix solution") {
        const Box box = lit_box(4);
        const Patches patches = patches_of(box.shape, box.materials);
        const auto truth = full_matrix_solution(patches, 20'000);
        for (const Transport transport : {Transport::global, Transport::local}) {
            SolverOptions options = quick();
            options.transport = transport;
            auto solver = Solver::create(patches, options).value();
            for (int run = 0; run < 20; ++run) solver.run();
            CHECK(solver.relative_error() < 0.02);
            double error = 0.0, size = 0.0;
            for (std::size_t i = 0; i < truth.size(); ++i)
                for (int k = 0; k < 3; ++k) {
                    const double difference = static_cast<double>(solver.radiosity()[i][k]) - truth[i][k];
                    error += patches.areas[i] * difference * difference;
                    size += patches.areas[i] * truth[i][k] * truth[i][k];
                }
            CHECK(std::sqrt(error / size) < 0.02);
        }
    }

    TEST_CASE(
        "under an open sky a lone plate of reflectance rho gives back rho of the sky's radiosity, and the sun's "
        "cosine") {
        Shape s;
        s.parallelogram({0, 0, 0}, {0, 0, 1}, {1, 0, 0}, 0);  // looks up
        s.parallelogram({0, -1, 0}, {0, 0, 0.1f}, {0.1f, 0, 0}, 1);
        const Patches patches = patches_of(s, std::vector<Material>(2, {glm::vec3(0.0f), glm::vec3(0.5f)}));
        SolverOptions options = quick();
        options.outside.sky = {1.0f, 2.0f, 3.0f};
        auto sky = Solver::create(patches, options).value();
        sky.run();
        CHECK(sky.radiosity()[0].z == doctest::Approx(1.5).epsilon(1e-6));
        options.outside = {glm::vec3(0.0f), glm::vec3(2.0f), {1.0, 1.0, 0.0}};
        options.first_shot = 1 << 17;
        auto sun = Solver::create(patches, options).value();
        for (int run = 0; run < 4; ++run) sun.run();
        CHECK(sun.radiosity()[0].x == doctest::Approx(0.5 * 2.0 * std::sqrt(0.5)).epsilon(0.01));
    }

    TEST_CASE(
        "what lies inside a solid counts neither as dark nor as lit: the open half of a floor has the whole sky") {
        Shape s;
        s.parallelogram({0, 0, 0}, {0, 0, 2}, {2, 0, 0}, 0);
        // A closed slab, its faces outward, hides half of the floor and shades nothing of the rest.
        shapes::Shape slab;
        slab.room({1, -1e-3f, 0}, {2, 1e-3f, 2}, 1);
        for (std::size_t t = 0; t < slab.mesh.triangle_count(); ++t) {
            const auto at = [&](std::size_t k) { return slab.mesh.positions[slab.mesh.indices[3 * t + k]]; };
            s.triangle(at(0), at(2), at(1), slab.patches[t]);
        }
        const Patches patches = patches_of(s, std::vector<Material>(7, {glm::vec3(0.0f), glm::vec3(0.5f)}));
        for (const Transport transport : {Transport::global, Transport::local}) {
            SolverOptions options = quick();
            options.transport = transport;
            options.outside.sky = glm::vec3(1.0f);
            options.outside.sun = glm::vec3(2.0f);
            auto solver = Solver::create(patches, options).value();
            for (int run = 0; run < 8; ++run) solver.run();
            CHECK(solver.exposed_share(0) == doctest::Approx(0.5).epsilon(0.05));
            CHECK(solver.irradiance()[0].x == doctest::Approx(3.0).epsilon(0.01));
            CHECK(solver.radiosity()[0].x == doctest::Approx(1.5).epsilon(0.01));
        }
    }

    TEST_CASE("a second run's expectation is the light itself, whatever the first one found: 2,000 of few lines") {
        // A cube's walls, two of them black. From a wall, 0.19982 of what leaves it reaches the one opposite.
        const double reflectance[6] = {0.99, 0.99, 0.0, 0.99, 0.0, 0.99}, opposite = 0.1998249;
        Shape s;
        s.room({0, 0, 0}, {1, 1, 1}, 0);
        std::vector<Material> materials(6);
        for (std::size_t i = 0; i < 6; ++i) materials[i].reflectance = glm::vec3(static_cast<float>(reflectance[i]));
        materials[0].emission = glm::vec3(1.0f);
        std::array<double, 6> light{};
        for (int iteration = 0; iteration < 1000; ++iteration)
            for (std::size_t i = 0; i < 6; ++i) {
                double arrived = 0.0;
                for (std::size_t j = 0; j < 6; ++j)
                    if (j != i) arrived += light[j] * (j == (i ^ 1u) ? opposite : 0.25 * (1.0 - opposite));
                light[i] = (i == 0 ? 1.0 : 0.0) + reflectance[i] * arrived;
            }
        double truth = 0.0;
        for (const double b : light) truth += b;
        const Patches patches = patches_of(s, materials);
        SolverOptions options;
        options.lines = 192;
        options.first_shot = 64;
        options.cutoff = 1e-4;
        options.sequence = sampling::Sequence::pseudo_random;
        constexpr int kSeeds = 2000;
        double sum = 0.0, squares = 0.0;
        for (int seed = 1; seed <= kSeeds; ++seed) {
            options.seed = static_cast<std::uint64_t>(seed);
            auto solver = Solver::create(patches, options).value();
            const auto all = [&] {
                double result = 0.0;
                for (const glm::vec3& b : solver.radiosity()) result += static_cast<double>(b.x);
                return result;
            };
            solver.run();
            const double first = all();
            solver.run();
            const double second = 2.0 * all() - first;
            sum += second;
            squares += second * second;
        }
        const double mean = sum / kSeeds, deviation = std::sqrt((squares / kSeeds - mean * mean) / kSeeds);
        CHECK(std::abs(mean - truth) < 4.0 * deviation);
    }

    TEST_CASE("the estimated error is the true one's size, and four times the runs halve it") {
        const Box box = lit_box(3);
        const Patches patches = patches_of(box.shape, box.materials);
        auto solver = Solver::create(patches, quick()).value();
        CHECK(std::isinf(solver.relative_error()));
        for (int run = 0; run < 16; ++run) solver.run();
        const double early = solver.relative_error();
        for (int run = 16; run < 64; ++run) solver.run();
        CHECK(early / solver.relative_error() == doctest::Approx(2.0).epsilon(0.2));
    }

    TEST_CASE("share_within estimates the share of patches within 10 % from the runs, and tends to be too small") {
        const Box box = lit_box(4);
        const Patches patches = patches_of(box.shape, box.materials);
        SolverOptions options = quick();
        options.lines = 1 << 9;
        options.first_shot = 1 << 10;
        auto truth = Solver::create(patches, quick());
        for (int run = 0; run < 60; ++run) truth->run();
        CHECK(truth->share_within(0.1) == doctest::Approx(1.0).epsilon(0.01));
        CHECK(truth->share_within(0.0) == 0.0);
        double told = 0.0, true_share = 0.0;
        constexpr int kSeeds = 20, kRuns = 5;
        for (int seed = 0; seed < kSeeds; ++seed) {
            options.seed = 100 + static_cast<std::uint64_t>(seed);
            auto solver = Solver::create(patches, options);
            solver->run();
            solver->run();
            CHECK(solver->share_within(0.1) == 0.0);
            while (solver->runs() < kRuns) solver->run();
            CHECK(solver->share_within(0.05) < solver->share_within(0.1));
            told += solver->share_within(0.1) / kSeeds;
            std::size_t within = 0;
            for (std::size_t i = 0; i < patches.count(); ++i) {
                const glm::vec3 off = glm::abs(solver->radiosity()[i] - truth->radiosity()[i]),
                                light = truth->radiosity()[i];
                within += off.x + off.y + off.z <= 0.1f * (light.x + light.y + light.z) ? 1 : 0;
            }
            true_share += static_cast<double>(within) / static_cast<double>(patches.count()) / kSeeds;
        }
        CHECK(told <= true_share + 0.03);
        CHECK(told >= true_share - 0.25);
        CHECK(true_share < 0.98);
    }

    TEST_CASE("light of one colour is known as well as that of any other") {
        const Box box = lit_box(2);
        double share[3], error[3];
        for (int channel = 0; channel < 3; ++channel) {
            Box lit = box;
            for (Material& material : lit.materials) {
                const float emission = material.emission.x, reflectance = material.reflectance.x;
                material = {};
                material.emission[channel] = emission;
                material.reflectance[channel] = reflectance;
            }
            const Patches patches = patches_of(lit.shape, lit.materials);
            auto solver = Solver::create(patches, quick()).value();
            for (int run = 0; run < 5; ++run) solver.run();
            share[channel] = solver.share_within(0.01);
            error[channel] = solver.relative_error();
        }
        CHECK(share[0] > 0.0);
        CHECK(share[0] < 0.99);
        for (const int channel : {1, 2}) {
            CHECK(share[channel] == share[0]);
            CHECK(error[channel] == error[0]);
        }
    }
}
