// SPDX-License-Identifier: MIT
// Jolt first: its other headers need it.
#include <Jolt/Jolt.h>

#include <Jolt/Core/Factory.h>
#include <Jolt/Core/JobSystemSingleThreaded.h>
#include <Jolt/Core/TempAllocator.h>
#include <Jolt/Physics/Body/BodyCreationSettings.h>
#include <Jolt/Physics/Collision/Shape/BoxShape.h>
#include <Jolt/Physics/PhysicsSystem.h>
#include <Jolt/RegisterTypes.h>

#include <array>
#include <vector>

#include "cull_crowd.hpp"
#include "world_frames.hpp"

namespace crofton::bench {
namespace {

constexpr std::size_t kOthers = 1'000'000;

// One layer, in which everything is static.
struct Layers final : JPH::BroadPhaseLayerInterface, JPH::ObjectVsBroadPhaseLayerFilter, JPH::ObjectLayerPairFilter {
    JPH::uint GetNumBroadPhaseLayers() const override { return 1; }
    JPH::BroadPhaseLayer GetBroadPhaseLayer(JPH::ObjectLayer) const override { return JPH::BroadPhaseLayer(0); }
    bool ShouldCollide(JPH::ObjectLayer, JPH::BroadPhaseLayer) const override { return true; }
    bool ShouldCollide(JPH::ObjectLayer, JPH::ObjectLayer) const override { return true; }
#if defined(JPH_EXTERNAL_PROFILE) || defined(JPH_PROFILE_ENABLED)
    const char* GetBroadPhaseLayerName(JPH::BroadPhaseLayer) const override {
        return "all";
    }
#endif
};

// Static boxes in a physics system whose updates run on this thread.
struct Bodies {
    using Ids = std::vector<JPH::BodyID>;
    Layers layers;
    JPH::TempAllocatorImpl memory{64 << 20};
    JPH::JobSystemSingleThreaded jobs{JPH::cMaxPhysicsJobs};
    JPH::PhysicsSystem system;

    Bodies() { system.Init(2 * kOthers + 16, 0, 65536, 10240, layers, layers, layers); }
    JPH::BodyInterface& all() { return system.GetBodyInterfaceNoLock(); }
    Ids create(const std::vector<Obb>& boxes, const glm::dvec3& origin) {
        Ids ids;
        for (const Obb& box : boxes) {
            const glm::vec3 at(box.center + origin), h = box.half_extents;
            const glm::quat turn = glm::quat_cast(box.axes);
            ids.push_back(
                all()
                    .CreateBody({new JPH::BoxShape({h.x, h.y, h.z}, 0.0f), JPH::RVec3(at.x, at.y, at.z),
                                 JPH::Quat(turn.x, turn.y, turn.z, turn.w).Normalized(), JPH::EMotionType::Static, 0})
                    ->GetID());
        }
        return ids;
    }
    JPH::BodyInterface::AddState prepare(Ids& ids) { return all().AddBodiesPrepare(ids.data(), int(ids.size())); }
    void finalize(Ids& ids, JPH::BodyInterface::AddState state) {
        all().AddBodiesFinalize(ids.data(), int(ids.size()), state, JPH::EActivation::DontActivate);
    }
    void remove(Ids& ids) { all().RemoveBodies(ids.data(), int(ids.size())); }
    void destroy(const Ids& ids) { all().DestroyBodies(ids.data(), int(ids.size())); }
    void update() { system.Update(1.0f / 60.0f, 1, &memory, &jobs); }
};

void attaching() {
    Bodies bodies;
    Bodies::Ids others = bodies.create(crowd(kOthers), glm::dvec3(0.0));
    bodies.finalize(others, bodies.prepare(others));
    bodies.system.OptimizeBroadPhase();
    std::printf(
        "objects,Jolt: create in µs,prepare in µs,finalize in µs,its update in µs,remove in µs,its update in µs\n");
    for (const std::size_t count : {1'000u, 10'000u, 100'000u, 1'000'000u}) {
        const std::vector<Obb> boxes = crowd(count);
        std::array<double, 6> least;
        least.fill(1e30);
        for (int frame = 0; frame < (count > 100'000 ? 2 : 10); ++frame) {
            Bodies::Ids ids;
            JPH::BodyInterface::AddState state = nullptr;
            const std::array times{
                microseconds([&] {
                    ids = bodies.create(boxes, {frame % 60, 20.0, 20.0});
                }),
                microseconds([&] { state = bodies.prepare(ids); }),
                microseconds([&] { bodies.finalize(ids, state); }),
                microseconds([&] { bodies.update(); }),
                microseconds([&] { bodies.remove(ids); }),
                microseconds([&] { bodies.update(); }),
            };
            bodies.destroy(ids);
            for (std::size_t i = 0; i < times.size(); ++i) least[i] = std::min(least[i], times[i]);
        }
        std::printf("%zu,%.0f,%.0f,%.1f,%.0f,%.1f,%.0f\n", count, least[0], least[1], least[2], least[3], least[4],
                    least[5]);
    }
}

// As flight() of regions: a thousand bodies come and a thousand go every third frame. Preparing is not timed. By the
// clock, of the pass whose slowest frame is the fastest.
void flight() {
    constexpr int kFrames = 600, kPasses = 5;
    Bodies bodies;
    std::vector<Bodies::Ids> regions;
    const std::vector<Obb> boxes = crowd(1000);
    for (int c = 0; c < 1000; ++c) {
        regions.push_back(bodies.create(boxes, 10.0 * glm::dvec3(c % 10, c / 10 % 10, c / 100)));
        bodies.finalize(regions.back(), bodies.prepare(regions.back()));
    }
    bodies.system.OptimizeBroadPhase();
    double best_slowest = 1e30, best_mean = 0.0;
    std::size_t next = 0, gone = regions.size();
    for (int pass = 0; pass < kPasses; ++pass) {
        double sum = 0.0, slowest = 0.0;
        for (int frame = 0; frame < kFrames; ++frame) {
            const bool comes = frame % 3 == 0 && gone < regions.size();
            const JPH::BodyInterface::AddState state = comes ? bodies.prepare(regions[gone]) : nullptr;
            const auto start = std::chrono::steady_clock::now();
            if (comes) bodies.finalize(regions[gone], state);
            if (frame % 3 == 0) {
                bodies.remove(regions[next]);
                gone = next;
                next = (next + 37) % regions.size();
            }
            bodies.update();
            const double time =
                std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start).count();
            sum += time;
            slowest = std::max(slowest, time);
        }
        if (slowest > best_slowest) continue;
        best_slowest = slowest;
        best_mean = sum / kFrames;
    }
    std::printf("Jolt: a flight of %d frames: mean %.1f µs, the slowest %.1f µs\n", kFrames, best_mean, best_slowest);
}

}  // namespace

void jolt_regions() {
    JPH::RegisterDefaultAllocator();
    JPH::Factory::sInstance = new JPH::Factory();
    JPH::RegisterTypes();
    attaching();
    flight();
    JPH::UnregisterTypes();
    delete JPH::Factory::sInstance;
    JPH::Factory::sInstance = nullptr;
}

}  // namespace crofton::bench
