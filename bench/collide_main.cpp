// Runs the benchmarks and ends with how many times as long each peer took, measured in the same run.
#include <benchmark/benchmark.h>

#include <cstdio>
#include <map>
#include <string>

namespace {

constexpr const char* kPeers[] = {"/fcl", "/bullet", "/embree", "/ode"};

class Ratios : public benchmark::ConsoleReporter {
  public:
    void ReportRuns(const std::vector<Run>& runs) override {
        ConsoleReporter::ReportRuns(runs);
        for (const Run& run : runs)
            if (!run.error_occurred && run.run_type == Run::RT_Iteration)
                add(run.benchmark_name(), run.GetAdjustedCPUTime());
    }

    void Finalize() override {
        std::puts("\nCPU time of the peer over Crofton's, least of the repetitions of each:");
        for (const auto& [name, time] : times_)
            for (const char* peer : kPeers) {
                const std::size_t at = name.find(peer);
                if (at == std::string::npos) continue;
                std::string ours = name;
                ours.replace(at, std::string(peer).size(), "/crofton");
                if (const auto own = times_.find(ours); own != times_.end())
                    std::printf("  %-50s %8.2f\n", name.c_str(), time / own->second);
            }
    }

  private:
    void add(std::string name, double time) {
        for (const char* suffix : {"/iterations:", "/repeats:"}) name = name.substr(0, name.find(suffix));
        const auto [place, is_new] = times_.emplace(name, time);
        if (!is_new && time < place->second) place->second = time;
    }

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
