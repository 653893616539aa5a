// SPDX-License-Identifier: MIT
#include "trace_file.hpp"

#include <algorithm>
#include <cstdio>

#include "report.hpp"

namespace crofton::cli {

TraceHooks TraceFile::hooks() {
    return {[](void* user, const char* zone) { static_cast<TraceFile*>(user)->begin(zone); },
            [](void* user, const char* zone) { static_cast<TraceFile*>(user)->end(zone); },
            [](void* user, const char* counter, double value) { static_cast<TraceFile*>(user)->count(counter, value); },
            this};
}

void TraceFile::add(char phase, const char* name, double value) {
    const double time = std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start_).count();
    const std::lock_guard lock(mutex_);
    const auto known = std::find(threads_.begin(), threads_.end(), std::this_thread::get_id());
    const auto thread = static_cast<unsigned>(known - threads_.begin());
    if (known == threads_.end()) threads_.push_back(std::this_thread::get_id());
    events_.push_back({time, name, value, thread, phase});
}

Result<void> TraceFile::write(const std::string& path) const {
    const std::lock_guard lock(mutex_);
    std::string text = "{\"displayTimeUnit\": \"ms\", \"traceEvents\": [\n";
    char line[256];
    for (std::size_t i = 0; i < events_.size(); ++i) {
        const Event& e = events_[i];
        char value[64] = "";
        if (e.phase == 'C') std::snprintf(value, sizeof value, ", \"args\": {\"value\": %.17g}", e.value);
        std::snprintf(line, sizeof line,
                      "{\"ph\": \"%c\", \"name\": \"%s\", \"ts\": %.3f, \"pid\": 1, \"tid\": %u%s}%s\n", e.phase,
                      e.name, e.time_us, e.thread, value, i + 1 < events_.size() ? "," : "");
        text += line;
    }
    text += "]}\n";
    return write_file(path, text);
}

}  // namespace crofton::cli
