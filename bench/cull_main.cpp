// SPDX-License-Identifier: MIT
// Runs the culling benchmarks and ends with the ratios that matter, of times from the same run.
#include <cstdio>

#include "cull_inputs.hpp"
#include "least_times.hpp"

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
    {"plain AABB loop / list of spheres", "aabb_loop/1000000", "flat_cull_spheres/1000000"},
    {"Bullet / tree, 20 % visible", "bullet_cull/20_percent/10000", "tree_cull/exact/10000"},
    {"Bullet / tree, 20 % visible", "bullet_cull/20_percent/1000000", "tree_cull/exact/1000000"},
    {"Bullet / tree, 1 % visible", "bullet_cull/1_percent/1000000", "tree_cull/exact_1_percent/1000000"},
    {"Bullet's moves / moves and query", "bullet_move/1000000", "move_and_cull/scattered/1000000"},
    {"list, one thread / two", "threads/1000000/1/real_time", "threads/1000000/2/real_time"},
    {"build, one thread / two", "build_threads/1000000/1/real_time", "build_threads/1000000/2/real_time"},
    {"tree, one thread / two", "tree_threads/1000000/1/real_time", "tree_threads/1000000/2/real_time"},
};

class Ratios : public crofton::bench::LeastTimes {
  public:
    Ratios() : LeastTimes(crofton::bench::Clock::elapsed, OO_Tabular) {}

  private:
    void print_ratios(const std::map<std::string, double>& seconds) const override {
        std::puts("\nRatios of elapsed times, least of the repetitions of each:");
        const auto print = [&](const char* what, const std::string& of, const std::string& by) {
            const auto other = seconds.find(of), ours = seconds.find(by);
            if (other != seconds.end() && ours != seconds.end())
                std::printf("  %-42s %-32s %8.2f\n", what, by.c_str(), other->second / ours->second);
        };
        for (const Pair& pair : kPairs) print(pair.what, pair.other, pair.ours);
        const std::string each = "one_by_one", together = "one_pass";
        for (const auto& [name, time] : seconds)
            if (const std::size_t at = name.find(each); at != std::string::npos)
                print("one query a view / one pass", name, std::string(name).replace(at, each.size(), together));
        const std::string merged = "merged";
        for (const auto& [name, time] : seconds)
            if (const std::size_t at = name.find(merged); at != std::string::npos)
                print("the same, and masks / one pass", name, std::string(name).replace(at, merged.size(), together));
    }
};

}  // namespace

int main(int argc, char** argv) {
    if (!crofton::bench::take_scene_option(argc, argv)) return 1;
    std::printf("Scene: %s\n", crofton::bench::scene_in_use());
    benchmark::AddCustomContext("scene", crofton::bench::scene_in_use());
    Ratios reporter;
    return crofton::bench::run(argc, argv, reporter);
}
