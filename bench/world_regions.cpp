// SPDX-License-Identifier: MIT
// Compares Worlds of regions with a World that has each object singly: views, rays, attaching, and a flight.
#include <array>
#include <crofton/crofton.hpp>
#include <glm/common.hpp>
#include <random>
#include <vector>

#include "cull_crowd.hpp"
#include "world_frames.hpp"

#ifdef CROFTON_HAVE_BULLET
#include <BulletCollision/BroadphaseCollision/btDbvt.h>
#endif

namespace crofton::bench {
namespace {

constexpr int kCells = 10;  // along each axis

// A crowd of a million objects, and the same by a thousand regions.
struct Town {
    std::vector<Obb> boxes = crowd(1'000'000);
    World single{{.pairs = false}}, with{{.pairs = false}};
    std::vector<Region> regions;
    std::vector<glm::dvec3> origins;
    std::vector<RegionHandle> handles;

    Town() {
        std::vector<std::vector<RegionObject>> cells(kCells * kCells * kCells);
        const double side = 100.0 / kCells;
        for (const Obb& box : boxes) {
            const glm::dvec3 cell = glm::clamp(glm::floor(box.center / side), 0.0, kCells - 1.0);
            const std::size_t which = static_cast<std::size_t>((cell.z * kCells + cell.y) * kCells + cell.x);
            RegionObject object{.bound = box};
            object.bound.box.center -= side * cell;
            cells[which].push_back(object);
        }
        for (std::size_t c = 0; c < cells.size(); ++c) {
            const glm::dvec3 cell(c % kCells, c / kCells % kCells, c / (kCells * kCells));
            regions.push_back(Region::prepare(cells[c]).value());
            origins.push_back(side * cell);
        }
        for (std::size_t c = 0; c < cells.size(); ++c) {
            handles.push_back(with.attach(regions[c], origins[c]).value());
            for (RegionObject& object : cells[c]) {
                object.bound.box.center += origins[c];
                require_ok(single.add({.bound = object.bound}).has_value(), "a single");
            }
        }
        for (World* world : {&single, &with})
            for (int update = 0; update < 40; ++update) require_ok(world->update().has_value(), "loading");
    }
};

void views(const Town& town, int frames) {
    std::printf("view,objects seen,one tree in µs,regions in µs,ratio\n");
    for (const double share : {0.001, 0.01, 0.05, 0.2}) {
        const cull::View view = view_of_share(town.boxes, share);
        for (const auto order : {cull::ResultOrder::tree, cull::ResultOrder::ascending}) {
            const ViewRequest request{.volume = view.frustum, .order = order};
            ViewResult seen, seen_single;
            const FrameTimes times = compare(
                frames, [&](int) { (void)town.single.view(request, seen_single); },
                [&](int) { (void)town.with.view(request, seen); });
            require_ok(seen.size() == seen_single.size(), "the views differ");
            std::printf("%s %g,%zu,%.1f,%.1f,%.3f\n", order == cull::ResultOrder::tree ? "tree order" : "ascending",
                        share, seen.size(), times.by_hand, times.world, times.world / times.by_hand);
        }
    }
}

void rays(const Town& town, int frames) {
    std::mt19937_64 random(5);
    std::uniform_real_distribution<double> place(0.0, 100.0);
    std::vector<Ray> rays(1000);
    for (Ray& ray : rays) {
        for (int k = 0; k < 3; ++k) ray.origin[k] = place(random);
        for (int k = 0; k < 3; ++k) ray.direction[k] = place(random) - ray.origin[k];
    }
    double found = 0.0, found_single = 0.0;
    const FrameTimes times = compare(
        frames,
        [&](int) {
            found_single = 0.0;
            for (const Ray& ray : rays)
                if (const auto hit = town.single.raycast(ray)) found_single += hit->t;
        },
        [&](int) {
            found = 0.0;
            for (const Ray& ray : rays)
                if (const auto hit = town.with.raycast(ray)) found += hit->t;
        });
    require_ok(found == found_single, "the rays differ");
    std::printf("nearest hit of a ray: one tree %.3f µs, regions %.3f µs, ratio %.3f\n", times.by_hand / 1000.0,
                times.world / 1000.0, times.world / times.by_hand);
}

// A region comes and one goes every third frame: 20 a second of 60 frames. By the clock, of the pass whose slowest
// frame is the fastest: in others the machine did something else.
void flight(Town& town, int frames) {
    constexpr int kPasses = 7;
    const cull::View view = view_of_share(town.boxes, 0.01);
    ViewResult seen;
    std::vector<double> times(static_cast<std::size_t>(frames) * 10), best;
    for (int pass = 0; pass < kPasses; ++pass) {
        std::size_t next = 0;
        for (std::size_t frame = 0; frame < times.size(); ++frame) {
            const auto start = std::chrono::steady_clock::now();
            if (frame % 3 == 0) {
                RegionHandle& handle = town.handles[next];
                require_ok(town.with.detach(handle).has_value(), "detaching");
                handle = town.with.attach(town.regions[next], town.origins[next]).value();
                next = (next + 37) % town.handles.size();
            }
            require_ok(town.with.update().has_value(), "an update");
            (void)town.with.view({.volume = view.frustum}, seen);
            times[frame] = std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start).count();
        }
        if (best.empty() || std::ranges::max(times) < std::ranges::max(best)) best = times;
    }
    double calm = 0.0, streaming = 0.0;
    for (std::size_t frame = 0; frame < best.size(); ++frame) (frame % 3 == 0 ? streaming : calm) += best[frame];
    const double mean = (calm + streaming) / static_cast<double>(best.size());
    std::sort(best.begin(), best.end());
    std::printf(
        "a flight of %zu frames: mean %.1f µs, in every third, in which a region comes and one goes, %.1f µs; the "
        "slowest hundredth %.1f µs, the slowest %.1f µs: %.1f µs above the mean\n",
        best.size(), mean, 3.0 * streaming / static_cast<double>(best.size()), best[best.size() * 99 / 100],
        best.back(), best.back() - mean);
}

// Compares a World after 100,000 attachments with a fresh World that holds the same regions.
void aging(int frames) {
    constexpr std::size_t kRegions = 1000;
    std::vector<RegionObject> objects;
    for (const Obb& box : crowd(100)) objects.push_back({.bound = box});
    const Region region = Region::prepare(objects).value();
    std::mt19937_64 random(6);
    std::uniform_real_distribution<double> place(0.0, 1000.0);
    World old({.pairs = false}), fresh({.pairs = false});
    std::vector<RegionHandle> handles;
    std::vector<glm::dvec3> origins;
    for (std::size_t i = 0; i < 100'000; ++i) {
        glm::dvec3 origin;
        for (int k = 0; k < 3; ++k) origin[k] = place(random);
        const std::size_t which = i % kRegions;
        const RegionHandle handle = old.attach(region, origin).value();
        if (i < kRegions) {
            handles.push_back(handle);
            origins.push_back(origin);
        } else {
            require_ok(old.detach(handles[which]).has_value(), "detaching");
            handles[which] = handle;
            origins[which] = origin;
        }
        if (i % 4 == 3) require_ok(old.update().has_value(), "an update");
    }
    for (const glm::dvec3& origin : origins) require_ok(fresh.attach(region, origin).has_value(), "attaching");
    for (World* world : {&old, &fresh})
        for (int update = 0; update < 40; ++update) require_ok(world->update().has_value(), "an update");
    Camera camera;
    camera.position = {-100.0, 500.0, 500.0};
    camera.forward = {1.0, 0.0, 0.0};
    camera.far_distance = 2000.0;
    ViewResult seen;
    const FrameTimes views = compare(
        frames, [&](int) { (void)fresh.view({.camera = camera}, seen); },
        [&](int) { (void)old.view({.camera = camera}, seen); });
    std::vector<Ray> rays(1000);
    for (Ray& ray : rays) {
        for (int k = 0; k < 3; ++k) ray.origin[k] = place(random);
        for (int k = 0; k < 3; ++k) ray.direction[k] = place(random) - ray.origin[k];
    }
    const auto cast = [&](const World& world) {
        for (const Ray& ray : rays) (void)world.raycast(ray);
    };
    const FrameTimes casts = compare(
        frames, [&](int) { cast(fresh); }, [&](int) { cast(old); });
    std::printf("after 100,000 attachments, beside a fresh World: a view %.3f, a ray %.3f times as long\n",
                views.world / views.by_hand, casts.world / casts.by_hand);
}

// How long Region::prepare goes on before a callback that wants it to stop is heard, at most: microseconds of the
// clock, the least of some runs.
double longest_until_asked(const std::vector<RegionObject>& objects) {
    using Clock = std::chrono::steady_clock;
    struct Asked {
        Clock::time_point last = Clock::now();
        double longest = 0.0;
        void note() {
            const Clock::time_point now = Clock::now();
            longest = std::max(longest, std::chrono::duration<double, std::micro>(now - last).count());
            last = now;
        }
    };
    double least = 1e30;
    for (int run = 0; run < 3; ++run) {
        Asked asked;
        RegionOptions options;
        options.stop_user = &asked;
        options.should_stop = [](void* user, double) {
            static_cast<Asked*>(user)->note();
            return false;
        };
        require_ok(Region::prepare(objects, options).has_value(), "preparing");
        asked.note();
        least = std::min(least, asked.longest);
    }
    return least;
}

void attaching(int frames) {
    std::printf(
        "objects,prepare in ms,the longest until it asks whether to stop in ms,attach and update in µs,detach and "
        "update in µs,bytes an object\n");
    for (const std::size_t count : {1'000u, 10'000u, 100'000u, 1'000'000u}) {
        std::vector<RegionObject> objects;
        for (const Obb& box : crowd(count)) objects.push_back({.bound = box});
        Region region;
        const double prepare = microseconds([&] { region = Region::prepare(objects).value(); });
        const double unasked = longest_until_asked(objects);
        World world({.pairs = false});
        double attach = 1e30, detach = 1e30;
        for (int frame = 0; frame < frames; ++frame) {
            RegionHandle handle;
            attach = std::min(attach, microseconds([&] {
                                  handle = world.attach(region, glm::dvec3(frame)).value();
                                  require_ok(world.update().has_value(), "an update");
                              }));
            detach = std::min(detach, microseconds([&] {
                                  require_ok(world.detach(handle).has_value(), "detaching");
                                  require_ok(world.update().has_value(), "an update");
                              }));
        }
        std::printf("%zu,%.2f,%.1f,%.2f,%.2f,%.0f\n", count, prepare / 1000.0, unasked / 1000.0, attach, detach,
                    static_cast<double>(region.bytes()) / static_cast<double>(count));
    }
}

// Attaches a region to a world of a million other objects and detaches it. Bullet's dynamic tree inserts and removes
// each object, and one tree of all is rebuilt.
void peers(int frames) {
    constexpr std::size_t kOthers = 1'000'000;
    const std::vector<Obb> others = crowd(kOthers);
    std::vector<RegionObject> objects;
    for (const Obb& box : others) objects.push_back({.bound = box});
    World world({.pairs = false});
    require_ok(world.attach(Region::prepare(objects).value(), glm::dvec3(0.0)).has_value(), "attaching");
    require_ok(world.update().has_value(), "an update");
#ifdef CROFTON_HAVE_BULLET
    const auto volume_of = [](const Obb& box, const glm::dvec3& moved) {
        const Aabb bounds = aabb_of(box);
        const glm::dvec3 low = bounds.min + moved, high = bounds.max + moved;
        return btDbvtVolume::FromMM(btVector3(btScalar(low.x), btScalar(low.y), btScalar(low.z)),
                                    btVector3(btScalar(high.x), btScalar(high.y), btScalar(high.z)));
    };
    btDbvt tree;
    for (const Obb& box : others) tree.insert(volume_of(box, glm::dvec3(0.0)), nullptr);
#endif
    std::printf(
        "objects,attach and update in µs,detach and update in µs,Bullet: insert in µs,remove in µs,build in ms\n");
    for (const std::size_t count : {1'000u, 10'000u, 100'000u, 1'000'000u}) {
        const std::vector<Obb> boxes = crowd(count);
        objects.clear();
        for (const Obb& box : boxes) objects.push_back({.bound = box});
        const Region region = Region::prepare(objects).value();
        double attach = 1e30, detach = 1e30, insert = 1e30, remove = 1e30;
        for (int frame = 0; frame < frames; ++frame) {
            const glm::dvec3 origin(frame % 60, 20.0, 20.0);
            RegionHandle handle;
            attach = std::min(attach, microseconds([&] {
                                  handle = world.attach(region, origin).value();
                                  require_ok(world.update().has_value(), "an update");
                              }));
            detach = std::min(detach, microseconds([&] {
                                  require_ok(world.detach(handle).has_value(), "detaching");
                                  require_ok(world.update().has_value(), "an update");
                              }));
#ifdef CROFTON_HAVE_BULLET
            if (frame >= (count > 10'000 ? 1 : 5)) continue;
            std::vector<btDbvtNode*> nodes(count);
            insert = std::min(insert, microseconds([&] {
                                  for (std::size_t i = 0; i < count; ++i)
                                      nodes[i] = tree.insert(volume_of(boxes[i], origin), nullptr);
                              }));
            remove = std::min(remove, microseconds([&] {
                                  for (btDbvtNode* const node : nodes) tree.remove(node);
                              }));
#endif
        }
        std::vector<Obb> all = others;
        all.insert(all.end(), boxes.begin(), boxes.end());
        const double build = microseconds([&] { require_ok(boxtree::BoxTree::build(all).has_value(), "a tree"); });
        std::printf("%zu,%.1f,%.1f,%.0f,%.0f,%.0f\n", count, attach, detach, insert, remove, build / 1000.0);
    }
}

// Meshes with an occluder each, which updates place until all hide something: by the clock, for each update once.
void occluders() {
    constexpr std::size_t kRegions = 64, kObjects = 4096;
    TriangleMesh cube;
    for (unsigned i = 0; i < 8; ++i) cube.positions.emplace_back(i & 1u, i >> 1 & 1u, i >> 2);
    for (const auto& [a, b, c, d] : {std::array{0u, 4u, 6u, 2u},
                                     {1u, 3u, 7u, 5u},
                                     {0u, 1u, 5u, 4u},
                                     {2u, 6u, 7u, 3u},
                                     {0u, 2u, 3u, 1u},
                                     {4u, 5u, 7u, 6u}})
        cube.indices.insert(cube.indices.end(), {a, b, c, a, c, d});
    const RegionMesh mesh{.mesh = {.positions = cube.positions, .indices = cube.indices, .occluders = true}};
    std::vector<RegionObject> objects(kObjects);
    for (std::size_t i = 0; i < kObjects; ++i) {
        objects[i].mesh = 0;
        objects[i].transform.translation = {3.0 * static_cast<double>(i % 64), 0.0, 3.0 * static_cast<double>(i / 64)};
    }
    const Region region = Region::prepare(objects, {.meshes = std::span(&mesh, 1)}).value();
    World world({.pairs = false});
    std::vector<double> times;
    const auto update_all = [&](const char* what) {
        times.clear();
        do {
            const auto start = std::chrono::steady_clock::now();
            require_ok(world.update().has_value(), "an update");
            times.push_back(
                std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start).count());
        } while (world.statistics().occluders_waiting > 0 || times.size() < kRegions * kObjects / 200);
        double mean = 0.0;
        for (const double time : times) mean += time / static_cast<double>(times.size());
        std::sort(times.begin(), times.end());
        std::printf("%zu occluders %s in %zu updates: mean %.1f µs, the slowest %.1f, %.1f, %.1f µs\n",
                    kRegions * kObjects, what, times.size(), mean, times[times.size() - 3], times[times.size() - 2],
                    times.back());
    };
    std::vector<RegionHandle> handles;
    for (std::size_t i = 0; i < kRegions; ++i)
        handles.push_back(world.attach(region, {200.0 * static_cast<double>(i), 0.0, 0.0}).value());
    update_all("come");
    for (const RegionHandle handle : handles) require_ok(world.detach(handle).has_value(), "detaching");
    update_all("go");
}

}  // namespace

void regions(int frames, const std::string& part) {
    const auto wants = [&](const char* name) { return part.empty() || part == name; };
    if (wants("occluders")) occluders();
    if (wants("attaching")) attaching(frames);
    if (wants("peers")) peers(frames);
#ifdef CROFTON_HAVE_JOLT
    if (wants("jolt")) jolt_regions();
#endif
    if (wants("aging")) aging(frames);
    if (!wants("town")) return;
    Town town;
    views(town, frames);
    rays(town, frames);
    flight(town, frames);
}

}  // namespace crofton::bench
