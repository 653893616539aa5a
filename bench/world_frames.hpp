// SPDX-License-Identifier: MIT
// What bench_world measures: the same frames by hand and in a World, in turns.
#pragma once
#include <time.h>

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <string>

namespace crofton::bench {

// The least microseconds of a frame.
struct FrameTimes {
    double by_hand = std::numeric_limits<double>::infinity(), world = std::numeric_limits<double>::infinity();
};

// Of the process's threads. Its own call takes a fraction of a microsecond.
inline double processor_microseconds() {
    timespec now{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return 1e6 * static_cast<double>(now.tv_sec) + 1e-3 * static_cast<double>(now.tv_nsec);
}

// The lesser of the time that passes and the processor's: other work on the machine lengthens the first, the clock's
// own call the second. Requires work on one thread.
template <class Work>
double microseconds(Work work) {
    using Clock = std::chrono::steady_clock;
    const double processor_start = processor_microseconds();
    const auto start = Clock::now();
    work();
    const double passed = std::chrono::duration<double, std::micro>(Clock::now() - start).count();
    return std::min(passed, processor_microseconds() - processor_start);
}

// In turns, so that both meet the same machine. Each is told which frame it is.
template <class ByHand, class InWorld>
FrameTimes compare(int frames, ByHand by_hand, InWorld in_world) {
    FrameTimes times;
    for (int frame = 0; frame < frames; ++frame) {
        times.by_hand = std::min(times.by_hand, microseconds([&] { by_hand(frame); }));
        times.world = std::min(times.world, microseconds([&] { in_world(frame); }));
    }
    return times;
}

// Ends the program where the two sides differ: then the times say nothing.
inline void require_ok(bool good, const char* what) {
    if (good) return;
    std::fprintf(stderr, "bench_world: %s\n", what);
    std::exit(1);
}

// World's objects are bounds (world_bounds.cpp).
FrameTimes views_ascending(std::size_t count, std::size_t moving, int frames);
FrameTimes views_in_tree_order(std::size_t count, std::size_t moving, int frames);
FrameTimes near_views_ascending(std::size_t count, std::size_t moving, int frames);
FrameTimes near_views_in_tree_order(std::size_t count, std::size_t moving, int frames);
FrameTimes views_of_kept(std::size_t count, std::size_t moving, int frames);
FrameTimes views_of_structs(std::size_t count, std::size_t moving, int frames);
FrameTimes contacts(std::size_t count, std::size_t moving, int frames);
FrameTimes rays(std::size_t count, std::size_t moving, int frames);

// Nodes move (world_nodes.cpp): in the World, and in the engine's own scene graph.
FrameTimes views_of_meshes(std::size_t count, std::size_t moving, int frames);
FrameTimes views_of_own_scene(std::size_t count, std::size_t moving, int frames);

// Spawns and despawns among as many that live, a `part`th in each update: rows of a CSV to stdout (world_churn.cpp).
void churn(std::size_t live_count, std::size_t part, std::size_t spawns);

// Bytes an object: a table to stdout (world_bytes.cpp).
void bytes();

// Updates in which one object changes: rows of a CSV to stdout (world_changes.cpp).
void changes(int frames);

// Queries while some objects move: a table to stdout (world_changes.cpp).
void queries_among_movers();

// Worlds of regions: tables to stdout (world_regions.cpp). `part` is one of those in the source; empty: all.
void regions(int frames, const std::string& part);
void jolt_regions();  // the same bodies in Jolt (world_peer_jolt.cpp)

// Worlds of regions, of 10^3 to 10^8 objects: rows of a CSV to stdout (world_growth.cpp).
void growth(int frames);

// Updates of stacked crates: a table to stdout (world_stacks.cpp).
void stacks(int frames);

}  // namespace crofton::bench
