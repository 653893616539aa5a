// SPDX-License-Identifier: MIT
// Runs the benchmarks and ends with how many times as long each peer took, measured in the same run.
#include <cstdio>

#include "least_times.hpp"

namespace {

constexpr const char* kPeers[] = {"/fcl", "/bullet", "/embree 8", "/embree 16", "/embree", "/ode"};

class Ratios : public crofton::bench::LeastTimes {
  public:
    Ratios() : LeastTimes(crofton::bench::Clock::cpu, OO_Defaults) {}

  private:
    void print_ratios(const std::map<std::string, double>& seconds) const override {
        std::puts("\nCPU time of the peer over Crofton's, least of the repetitions of each:");
        for (const auto& [name, time] : seconds)
            for (const char* peer : kPeers) {
                const std::size_t at = name.find(peer);
                if (at == std::string::npos) continue;
                std::string ours = name;
                ours.replace(at, std::string(peer).size(), "/crofton");
                if (const auto own = seconds.find(ours); own != seconds.end())
                    std::printf("  %-50s %8.2f\n", name.c_str(), time / own->second);
            }
    }
};

}  // namespace

int main(int argc, char** argv) {
    Ratios reporter;
    return crofton::bench::run(argc, argv, reporter);
}
