// SPDX-License-Identifier: MIT
// Fits a box to each of many sets of points, on several threads.
#include <algorithm>
#include <crofton/core/error.hpp>
#include <crofton/core/memory.hpp>
#include <crofton/core/recovery.hpp>
#include <crofton/fit/fit.hpp>
#include <memory>
#include <string>

#include "fitter.hpp"

namespace crofton::fit {
namespace {

struct Worker {
    Fitter fitter;
    Vector<glm::vec3> points;
    std::size_t first_bad = ~std::size_t{0};
    Error error;
};

Result<Obb> fit_cluster(const Clusters& clusters, std::size_t i, const FitOptions& options, Worker& worker) {
    const std::size_t begin = i == 0 ? 0 : clusters.ends[i - 1], end = clusters.ends[i];
    worker.points.clear();
    for (std::size_t j = begin; j < end; ++j) {
        const std::uint32_t index = clusters.indices[j];
        if (index >= clusters.positions.size())
            return fail(ErrorCode::out_of_range, i, {"index ", index, " is out of range"});
        worker.points.push_back(clusters.positions[index]);
    }
    return worker.fitter.fit(std::span<const glm::vec3>(worker.points), options);
}

}  // namespace

Result<void> fit_many(const Clusters& clusters, const FitOptions& options, Executor& executor, std::span<Obb> boxes) {
    return detail::recover([&]() -> Result<void> {
        CROFTON_ASSERT(boxes.size() == clusters.ends.size(), "fit_many: one box per cluster");
        if (auto valid = measure::validate(options.criterion); !valid) return valid;
        if (clusters.ends.empty()) return {};
        const unsigned count = executor.concurrency();
        // Workers are neither copied nor moved, hence not a Vector.
        const std::unique_ptr<Worker[]> workers(new Worker[count]);
        const auto body = [&](std::size_t begin, std::size_t end, unsigned w) {
            Worker& worker = workers[w];
            for (std::size_t i = begin; i < end; ++i) {
                Result<Obb> box = fit_cluster(clusters, i, options, worker);
                boxes[i] = box ? *box : Obb();
                if (!box && i < worker.first_bad) {
                    worker.first_bad = i;
                    worker.error = std::move(box.error());
                }
            }
        };
        detail::recoverable_for(executor, clusters.ends.size(), 32, body);
        const Worker* first =
            std::min_element(workers.get(), workers.get() + count,
                             [](const Worker& a, const Worker& b) { return a.first_bad < b.first_bad; });
        if (first->first_bad == ~std::size_t{0}) return {};
        return fail(first->error.code, first->first_bad, {"cluster ", first->first_bad, ": ", first->error.message});
    });
}

}  // namespace crofton::fit
