// SPDX-License-Identifier: MIT
#include <algorithm>
#include <crofton/core/error.hpp>
#include <crofton/core/executor.hpp>

namespace crofton {
namespace {

class SerialExecutor final : public Executor {
  public:
    [[nodiscard]] unsigned concurrency() const override { return 1; }

    void parallel_for(std::size_t count, std::size_t grain, RangeTask body) override {
        CROFTON_ASSERT(grain >= 1, "parallel_for needs a grain of at least 1");
        for (std::size_t begin = 0; begin < count; begin += grain) body(begin, std::min(count, begin + grain), 0);
    }
};

}  // namespace

Executor& serial_executor() {
    static SerialExecutor executor;
    return executor;
}

}  // namespace crofton
