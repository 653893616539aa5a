// SPDX-License-Identifier: MIT
// Runs the benchmarks of a module without peers' ratios; --target=NAME picks the instruction set.
#include "least_times.hpp"

namespace {

class Plain : public crofton::bench::LeastTimes {
  public:
    Plain() : LeastTimes(crofton::bench::Clock::cpu, OO_Defaults) {}

  private:
    void print_ratios(const std::map<std::string, double>&) const override {}
};

}  // namespace

int main(int argc, char** argv) {
    Plain reporter;
    return crofton::bench::run(argc, argv, reporter);
}
