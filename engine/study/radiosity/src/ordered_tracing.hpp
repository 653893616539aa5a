// SPDX-License-Identifier: MIT
// Tracing by any thread, adding up by one: what makes sums the same bits whatever the executor.
#pragma once
#include <algorithm>
#include <cmath>
#include <crofton/core/executor.hpp>
#include <crofton/core/stop_signal.hpp>
#include <crofton/lines/lines.hpp>
#include <cstdint>

namespace crofton::radiosity {

constexpr std::size_t kRayBatch = 1024;
constexpr std::size_t kWave = 32;  // batches in flight

inline std::uint64_t mixed(std::uint64_t seed, std::uint64_t stream) {  // SplitMix64's finaliser
    std::uint64_t z = seed + 0x9e3779b97f4a7c15u * (stream + 1);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

// Whether the caller of a run wants it to stop.
inline bool is_raised(crofton::detail::StopSignal* stop) {
    return stop != nullptr && stop->is_raised(0.0);
}

// Traces rays 0 … count−1 that make(i) gives, and hands each with what it met to `take`, in order. Ends early where
// `stop` is raised.
template <class Make, class Take>
void trace_in_order(const lines::LineTracer& tracer, std::uint64_t count, Executor& executor,
                    crofton::detail::StopSignal* stop, Make&& make, Take&& take) {
    Vector<lines::Hit> hits(kWave * kRayBatch);
    for (std::uint64_t first = 0; first < count; first += hits.size()) {
        const std::size_t now = static_cast<std::size_t>(std::min<std::uint64_t>(hits.size(), count - first));
        executor.parallel_for(now, kRayBatch, [&](std::size_t begin, std::size_t end, unsigned) {
            if (is_raised(stop)) return;
            Vector<lines::FirstHitQuery> rays;
            for (std::size_t i = begin; i < end; ++i) rays.push_back(make(first + i));
            tracer.first_hits(rays, std::span(hits).subspan(begin, end - begin));
        });
        if (is_raised(stop)) return;
        for (std::size_t i = 0; i < now; ++i) take(first + i, hits[i]);
    }
}

}  // namespace crofton::radiosity
