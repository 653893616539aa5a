// SPDX-License-Identifier: MIT
// The state of a run that is kept and taken up again.
#include <doctest/doctest.h>
#include <algorithm>
#include <crofton/core/executor.hpp>
#include <crofton/radiosity/patches.hpp>
#include <crofton/radiosity/solver.hpp>
#include <cstring>
#include <error_of.hpp>
#include <span>
#include <utility>

#include "lit_box.hpp"

using namespace crofton;
using namespace crofton::lines;
using namespace crofton::radiosity;
using namespace shapes;

namespace {

bool same(std::span<const glm::vec3> a, std::span<const glm::vec3> b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size_bytes()) == 0;
}

}  // namespace

TEST_SUITE("radiosity/checkpoint") {
    TEST_CASE("the same bits for any number of threads, and after a checkpoint") {
        const Box box = lit_box(3);
        const Patches patches = patches_of(box.shape, box.materials);
        ThreadPool pool(4);
        for (const Transport transport : {Transport::global, Transport::local}) {
            SolverOptions options = quick();
            options.transport = transport;
            auto serial = Solver::create(patches, options), parallel = Solver::create(patches, options),
                 resumed = Solver::create(patches, options);
            serial->run();
            const auto saved = serial->checkpoint();
            serial->run();
            parallel->run(pool);
            parallel->run(pool);
            REQUIRE(resumed->resume(saved).has_value());
            resumed->run();
            CHECK(same(serial->radiosity(), parallel->radiosity()));
            CHECK(same(serial->radiosity(), resumed->radiosity()));
            CHECK(resumed->runs() == 2);
        }
    }

    TEST_CASE("a run that is stopped, whenever that is, leaves no trace: the next one is as if it had not begun") {
        const Box box = lit_box(3);
        const Patches patches = patches_of(box.shape, box.materials);
        ThreadPool pool(2);
        for (const bool local : {false, true}) {
            SolverOptions options = quick();
            options.lines = 1 << 18;
            options.transport = local ? Transport::local : Transport::global;
            auto undisturbed = Solver::create(patches, options), stopped = Solver::create(patches, options);
            undisturbed->run();
            stopped->run();
            const auto before = stopped->checkpoint();
            int asked = 0, allowed = 0, dropped = 0;
            for (bool done = false; !done; ++allowed) {
                asked = 0;
                struct Asked {
                    int *times, allowed;
                } state{&asked, allowed};
                const auto should_stop = [](void* user, double) {
                    Asked& it = *static_cast<Asked*>(user);
                    return (*it.times)++ >= it.allowed;
                };
                done =
                    stopped->run(should_stop, &state, allowed % 2 ? static_cast<Executor&>(pool) : serial_executor());
                if (done) break;
                ++dropped;
                CHECK(stopped->checkpoint() == before);
                CHECK(stopped->runs() == 1);
            }
            CHECK(dropped >= 1);
            undisturbed->run();
            CHECK(same(undisturbed->radiosity(), stopped->radiosity()));
            CHECK(undisturbed->checkpoint() == stopped->checkpoint());
        }
    }

    TEST_CASE("damaged checkpoints, and those of other options, are refused") {
        const Box box = lit_box(2);
        const Patches patches = patches_of(box.shape, box.materials);
        auto solver = Solver::create(patches, quick());
        solver->run();
        const auto saved = solver->checkpoint();
        for (std::size_t size : {std::size_t{0}, std::size_t{10}, saved.size() - 1})
            CHECK(error_of(solver->resume(std::span(saved).first(size))).code == ErrorCode::parse);
        auto damaged = saved;
        for (std::size_t i = 0; i < damaged.size(); i += 37) {
            damaged[i] ^= std::byte{16};
            CHECK_FALSE(solver->resume(damaged).has_value());
            damaged[i] ^= std::byte{16};
        }
        SolverOptions other = quick();
        other.seed = 2;
        CHECK(error_of(Solver::create(patches, other)->resume(saved)).code == ErrorCode::invalid_argument);
        CHECK(solver->resume(saved).has_value());
    }

    TEST_CASE("checkpoints of patches that differ in one corner, one triangle, one material are refused") {
        const Box box = lit_box(2);
        const Patches patches = patches_of(box.shape, box.materials);
        auto solver = Solver::create(patches, quick());
        solver->run();
        const auto saved = solver->checkpoint();
        const auto refuses = [&](const Box& other) {
            const Patches others = patches_of(other.shape, other.materials);
            auto resumed = Solver::create(others, quick()).value();
            return error_of(resumed.resume(saved)).code == ErrorCode::invalid_argument;
        };
        Box other = box;
        other.shape.mesh.positions.back() *= 1.5f;
        CHECK(refuses(other));
        // The same triangle from its next corner.
        other = box;
        std::rotate(other.shape.mesh.indices.begin(), other.shape.mesh.indices.begin() + 1,
                    other.shape.mesh.indices.begin() + 3);
        CHECK(refuses(other));
        other = box;
        std::swap(other.shape.patches.front(), other.shape.patches.back());
        CHECK(refuses(other));
        other = box;
        other.materials[0].reflectance.y += 0.125f;
        CHECK(refuses(other));
    }
}
