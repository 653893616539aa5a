// SPDX-License-Identifier: MIT
// Zones and counters as a file that chrome://tracing, Perfetto and speedscope show.
#pragma once
#include <chrono>
#include <crofton/core/error.hpp>
#include <crofton/world/world.hpp>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace crofton::cli {

// Collects events in the Trace Event Format (a JSON object with "traceEvents"; times in microseconds). From any thread.
class TraceFile {
  public:
    TraceFile() : start_(std::chrono::steady_clock::now()) {}
    TraceFile(const TraceFile&) = delete;  // hooks() lead here
    TraceFile& operator=(const TraceFile&) = delete;

    void begin(const char* zone) { add('B', zone); }
    void end(const char* zone) { add('E', zone); }
    void count(const char* counter, double value) { add('C', counter, value); }
    // To the events of this object, which must outlive what is given the hooks.
    [[nodiscard]] TraceHooks hooks();
    [[nodiscard]] Result<void> write(const std::string& path) const;

  private:
    struct Event {
        double time_us;
        const char* name;
        double value;
        unsigned thread;
        char phase;
    };
    void add(char phase, const char* name, double value = 0.0);

    std::chrono::steady_clock::time_point start_;
    mutable std::mutex mutex_;
    std::vector<Event> events_;
    std::vector<std::thread::id> threads_;
};

// From here to the end of the block is a zone; null: nobody wants to know.
class FileZone {
  public:
    FileZone(TraceFile* file, const char* name) : file_(file), name_(name) {
        if (file_) file_->begin(name_);
    }
    ~FileZone() {
        if (file_) file_->end(name_);
    }
    FileZone(const FileZone&) = delete;
    FileZone& operator=(const FileZone&) = delete;

  private:
    TraceFile* file_;
    const char* name_;
};

}  // namespace crofton::cli
