// Runs the culling benchmarks and ends with the ratios that matter, of times from the same run.
#include <benchmark/benchmark.h>

#include <cstdio>
#include <map>
#include <string>

namespace {

struct Pair {
    const char* what;
    const char* other;
    const char* ours;
};

constexpr Pair kPairs[] = {
    {"plain AABB loop / list of boxes", "aabb_loop/10000", "flat_cull/conservative/10000"},
    {"plain AABB loop / list of boxes", "aabb_loop/1000000", "flat_cull/conservative/1000000"},
    {"plain AABB loop / list of boxes, exact", "aabb_loop/10000", "flat_cull/exact/10000"},
    {"plain AABB loop / list of boxes, exact", "aabb_loop/1000000", "flat_cull/exact/1000000"},
    {"plain AABB loop / list of AABBs", "aabb_loop/1000000", "flat_cull_aabbs/1000000"},
    {"plain AABB loop / list of balls", "aabb_loop/1000000", "flat_cull_spheres/1000000"},
    {"Bullet / tree, 20 % visible", "bullet_cull/20_percent/10000", "tree_cull/exact/10000"},
    {"Bullet / tree, 20 % visible", "bullet_cull/20_percent/1000000", "tree_cull/exact/1000000"},
    {"Bullet / tree, 1 % visible", "bullet_cull/1_percent/1000000", "tree_cull/exact_1_percent/1000000"},
    {"Bullet's moves / moves and query", "bullet_move/1000000", "move_and_cull/scattered/1000000"},
    {"four queries of a tree / one pass", "many_views/one_by_one/100000", "many_views/one_pass/100000"},
    {"four queries of a tree / one pass", "many_views/one_by_one/1000000", "many_views/one_pass/1000000"},
    {"four queries of a list / one pass", "flat_views/one_by_one/1000000/4", "flat_views/one_pass/1000000/4"},
    {"32 queries of a list / one pass", "flat_views/one_by_one/1000000/32", "flat_views/one_pass/1000000/32"},
    {"four queries of a list / one pass", "flat_views/one_by_one/10000000/4", "flat_views/one_pass/10000000/4"},
    {"list, one thread / two", "threads/1000000/1/real_time", "threads/1000000/2/real_time"},
    {"tree, one thread / two", "tree_threads/1000000/1/real_time", "tree_threads/1000000/2/real_time"},
};

class Ratios : public benchmark::ConsoleReporter {
  public:
    Ratios() : ConsoleReporter(OO_Tabular) {}

    void ReportRuns(const std::vector<Run>& runs) override {
        ConsoleReporter::ReportRuns(runs);
        for (const Run& run : runs) {
            if (run.error_occurred || run.run_type != Run::RT_Iteration) continue;
            const double scale = benchmark::GetTimeUnitMultiplier(run.time_unit);
            std::string name = run.benchmark_name();
            name = name.substr(0, name.find("/repeats:"));
            const double time = run.GetAdjustedRealTime() / scale;
            const auto [place, is_new] = times_.emplace(name, time);
            if (!is_new && time < place->second) place->second = time;
        }
    }

    void Finalize() override {
        std::puts("\nRatios of elapsed times, least of the repetitions of each:");
        for (const Pair& pair : kPairs) {
            const auto other = times_.find(pair.other), ours = times_.find(pair.ours);
            if (other != times_.end() && ours != times_.end())
                std::printf("  %-42s %-32s %8.2f\n", pair.what, pair.ours, other->second / ours->second);
        }
    }

  private:
    std::map<std::string, double> times_;
};

}  // namespace

int main(int argc, char** argv) {
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
    Ratios reporter;
    benchmark::RunSpecifiedBenchmarks(&reporter);
    benchmark::Shutdown();
    return 0;
}
