// SPDX-License-Identifier: MIT
// A reporter that keeps the least time of each benchmark, and the run of all benchmarks with it.
#pragma once
#include <benchmark/benchmark.h>

#include <map>
#include <string>

#include "simd_target.hpp"

namespace crofton::bench {

enum class Clock { cpu, elapsed };

// Prints runs as usual; print_ratios() has them all at the end. Names are without "/iterations:…" and "/repeats:…".
class LeastTimes : public benchmark::ConsoleReporter {
  public:
    LeastTimes(Clock clock, OutputOptions options) : ConsoleReporter(options), clock_(clock) {}

    void ReportRuns(const std::vector<Run>& runs) override {
        ConsoleReporter::ReportRuns(runs);
        for (const Run& run : runs) {
            if (run.error_occurred || run.run_type != Run::RT_Iteration) continue;
            std::string name = run.benchmark_name();
            for (const char* suffix : {"/iterations:", "/repeats:"}) name = name.substr(0, name.find(suffix));
            const double time = (clock_ == Clock::cpu ? run.GetAdjustedCPUTime() : run.GetAdjustedRealTime()) /
                                benchmark::GetTimeUnitMultiplier(run.time_unit);
            const auto [place, is_new] = times_.emplace(name, time);
            if (!is_new && time < place->second) place->second = time;
        }
    }
    void Finalize() override { print_ratios(times_); }

  protected:
    virtual void print_ratios(const std::map<std::string, double>& seconds) const = 0;

  private:
    Clock clock_;
    std::map<std::string, double> times_;
};

// The options of Google Benchmark, and --target=NAME.
inline int run(int argc, char** argv, LeastTimes& reporter) {
    if (!take_target_option(argc, argv)) return 1;
    benchmark::AddCustomContext("instruction_set", target_in_use());  // for bench/results.py
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
    benchmark::RunSpecifiedBenchmarks(&reporter);
    benchmark::Shutdown();
    return 0;
}

}  // namespace crofton::bench
