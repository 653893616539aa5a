// SPDX-License-Identifier: MIT
// What World costs beside the parts that it is made of, used by hand: the same frames in turns, the least time of each.
// docs/notes/world.md says what the hand-written side does.
//   bench_world               the table
//   bench_world --churn       what ten million spawns and despawns leave behind, as CSV; --churn=N: N of them
//     --live=N, --part=N      among so many objects, of which an Nth changes in an update; 20,000 and 100
//   bench_world --changes     what an update costs in which one object comes, goes, moves or changes, as CSV
//   bench_world --queries     queries among objects of which some move
//   bench_world --bytes       bytes an object, as CSV
//   bench_world --stacks      what an update of a thousand stacked crates costs, as shapes and as boxes
//   bench_world --regions     a World of a thousand regions compared with one of a million objects; --regions=PART:
//                             occluders, attaching, peers, jolt (if it is found), aging or town
//   bench_world --growth      Worlds of regions against the number of objects, as CSV
//   --frames=N                instead of 200
//   --target=AVX2             with this instruction set
//   --benchmark_filter=REGEX, --benchmark_repetitions=N, --benchmark_out=FILE: as Google Benchmark's, for results.py
#include <fstream>
#include <regex>
#include <string>
#include <string_view>
#include <vector>

#include "simd_target.hpp"
#include "world_frames.hpp"

namespace {

using crofton::bench::FrameTimes;

struct Row {
    const char* name;
    const char* text;
    FrameTimes (*run)(std::size_t count, std::size_t moving, int frames);
    std::size_t count, moving;
};

constexpr Row kRows[] = {
    {"rest/ascending", "100,000 boxes rest, a view, ids ascending", crofton::bench::views_ascending, 100000, 0},
    {"rest/tree", "100,000 boxes rest, a view, tree order", crofton::bench::views_in_tree_order, 100000, 0},
    {"rest/ascending_million", "1,000,000 boxes rest, a view, ids ascending", crofton::bench::views_ascending, 1000000,
     0},
    {"rest/tree_million", "1,000,000 boxes rest, a view, tree order", crofton::bench::views_in_tree_order, 1000000, 0},
    {"near/ascending", "1,000,000 boxes rest, 230 seen, ids ascending", crofton::bench::near_views_ascending, 1000000,
     0},
    {"near/tree", "1,000,000 boxes rest, 230 seen, tree order", crofton::bench::near_views_in_tree_order, 1000000, 0},
    {"all_move", "10,000 boxes all move, a view, ids ascending", crofton::bench::views_ascending, 10000, 10000},
    {"boxes", "100,000 boxes, 5,000 move, a view", crofton::bench::views_in_tree_order, 100000, 5000},
    {"kept", "the same, by hand too boxes kept and compared", crofton::bench::views_of_kept, 100000, 5000},
    {"structs", "the same, boxes in the game's structs", crofton::bench::views_of_structs, 100000, 5000},
    {"meshes", "100,000 meshes, 5,000 nodes move, a view", crofton::bench::views_of_meshes, 100000, 5000},
    {"own_scene", "the same, bounds, nodes in the engine's scene", crofton::bench::views_of_own_scene, 100000, 5000},
    {"contacts", "10,000 boxes all move, pairs and manifolds", crofton::bench::contacts, 10000, 10000},
    {"rays", "100,000 boxes rest, 1,000 rays, nearest box", crofton::bench::rays, 100000, 0},
};

struct Options {
    int frames = 200, repetitions = 1;
    bool churn = false, changes = false, queries = false, stacks = false, bytes = false, regions = false,
         growth = false;
    std::size_t spawns = 10'000'000, live = 20'000, part = 100;
    std::string out, part_of_regions;
    std::regex filter{""};
};

bool parse(int argc, char** argv, Options& options) {
    for (int i = 1; i < argc; ++i) {
        const std::string_view argument = argv[i];
        const std::size_t equals = std::min(argument.find('='), argument.size());
        const std::string_view key = argument.substr(0, equals);
        const std::string value(argument.substr(std::min(equals + 1, argument.size())));
        if (key == "--frames")
            options.frames = std::stoi(value);
        else if (key == "--churn")
            options.churn = true, options.spawns = value.empty() ? options.spawns : std::stoul(value);
        else if (key == "--live")
            options.live = std::stoul(value);
        else if (key == "--part")
            options.part = std::stoul(value);
        else if (key == "--changes")
            options.changes = true;
        else if (key == "--queries")
            options.queries = true;
        else if (key == "--bytes")
            options.bytes = true;
        else if (key == "--regions")
            options.regions = true, options.part_of_regions = value;
        else if (key == "--growth")
            options.growth = true;
        else if (key == "--stacks")
            options.stacks = true;
        else if (key == "--benchmark_filter")
            options.filter = value;
        else if (key == "--benchmark_repetitions")
            options.repetitions = std::stoi(value);
        else if (key == "--benchmark_out")
            options.out = value;
        else if (key != "--benchmark_out_format")
            return false;
    }
    return true;
}

// In the layout of Google Benchmark's JSON.
class Report {
  public:
    void add(const std::string& name, double microseconds) {
        rows_ += (rows_.empty() ? "" : ",\n") + std::string(R"({"run_name": ")") + name + R"(", "real_time": )" +
                 std::to_string(microseconds) + R"(, "time_unit": "us"})";
    }
    bool write(const std::string& path) const {
        if (path.empty()) return true;
        std::ofstream file(path);
        file << R"({"context": {"instruction_set": ")" << crofton::bench::target_in_use() << R"("}, "benchmarks": [)"
             << '\n'
             << rows_ << "]}\n";
        return file.good();
    }

  private:
    std::string rows_;
};

}  // namespace

int main(int argc, char** argv) {
    Options options;
    if (!crofton::bench::take_target_option(argc, argv)) return 1;
    if (!parse(argc, argv, options)) {
        std::fprintf(stderr, "bench_world: an unknown option; the first lines of world_bench.cpp name all\n");
        return 1;
    }
    const char* const target = crofton::bench::target_in_use();
    if (options.churn) {
        std::printf("# command: bench_world --churn=%zu --live=%zu --part=%zu --target=%s\n", options.spawns,
                    options.live, options.part, target);
        crofton::bench::churn(options.live, options.part, options.spawns);
        return 0;
    }
    if (options.bytes) {
        std::printf("# command: bench_world --bytes --target=%s\n", target);
        crofton::bench::bytes();
        return 0;
    }
    if (options.growth) {
        std::printf("# command: bench_world --growth --frames=%d --target=%s\n", options.frames, target);
        crofton::bench::growth(options.frames);
        return 0;
    }
    if (options.regions) {
        std::printf("instruction set: %s\n", target);
        crofton::bench::regions(options.frames, options.part_of_regions);
        return 0;
    }
    if (options.changes) {
        std::printf("# command: bench_world --changes --frames=%d --target=%s\n", options.frames, target);
        crofton::bench::changes(options.frames);
        return 0;
    }
    if (options.queries) {
        std::printf("instruction set: %s\n", target);
        crofton::bench::queries_among_movers();
        return 0;
    }
    if (options.stacks) {
        std::printf("instruction set: %s\n", target);
        crofton::bench::stacks(options.frames);
        return 0;
    }
    std::printf("instruction set: %s\n%-48s %10s %10s %8s\n", target, "microseconds a frame", "by hand", "World",
                "ratio");
    Report report;
    for (const Row& row : kRows) {
        const std::string by_hand = std::string(row.name) + "/by_hand", world = std::string(row.name) + "/world";
        if (!std::regex_search(by_hand, options.filter) && !std::regex_search(world, options.filter)) continue;
        for (int repetition = 0; repetition < options.repetitions; ++repetition) {
            const FrameTimes times = row.run(row.count, row.moving, options.frames);
            std::printf("%-48s %10.1f %10.1f %8.3f\n", row.text, times.by_hand, times.world,
                        times.world / times.by_hand);
            std::fflush(stdout);
            report.add(by_hand, times.by_hand);
            report.add(world, times.world);
        }
    }
    return report.write(options.out) ? 0 : 1;
}
