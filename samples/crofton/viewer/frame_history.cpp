// SPDX-License-Identifier: MIT
#include "frame_history.hpp"

#include <algorithm>

#include "json/json.hpp"

namespace crofton::viewer {

void FrameHistory::add(HistoryEntry entry) {
    entry.frame.visible_ids = {};
    entry.frame.colliding_ids = {};
    entries_.push_back(std::move(entry));
}

std::vector<float> FrameHistory::history(double (*value)(const HistoryEntry&)) const {
    std::vector<float> result;
    for (std::size_t i = entries_.size() - std::min(entries_.size(), kHistory); i < entries_.size(); ++i)
        result.push_back(static_cast<float>(value(entries_[i])));
    return result;
}

namespace {

template <class Value>
double mean_of_last(const std::vector<HistoryEntry>& entries, std::size_t last, Value value) {
    const std::size_t count = std::min(entries.size(), last);
    double sum = 0.0;
    for (std::size_t i = entries.size() - count; i < entries.size(); ++i) sum += value(entries[i]);
    return count > 0 ? sum / static_cast<double>(count) : 0.0;
}

}  // namespace

double FrameHistory::mean(double (*value)(const HistoryEntry&), std::size_t last) const {
    return mean_of_last(entries_, last, value);
}

double FrameHistory::mean_of_frames(double (*value)(const pipeline::FrameStatistics&), std::size_t last) const {
    return mean_of_last(entries_, last, [value](const HistoryEntry& entry) { return value(entry.frame); });
}

double FrameHistory::mean_of_occlusion(double (*value)(const OcclusionCounts&), std::size_t last) const {
    return mean_of_last(entries_, last, [value](const HistoryEntry& entry) { return value(entry.occlusion); });
}

std::array<float, 20> FrameHistory::frame_time_histogram() const {
    std::array<float, 20> bins{};
    for (const float ms : history([](const HistoryEntry& e) { return e.frame_us * 1e-3; }))
        ++bins[std::min(static_cast<std::size_t>(std::max(ms, 0.0f) / 5.0f), bins.size() - 1)];
    return bins;
}

Json FrameHistory::json() const {
    Json frames = Json::array();
    std::vector<pipeline::FrameStatistics> plain;
    for (const HistoryEntry& entry : entries_) {
        Json row = pipeline::to_json(entry.frame, false);
        row["frame_us"] = entry.frame_us;
        row["ui_us"] = entry.ui_us;
        row["scene_frame"] = entry.scene_frame;
        frames.push_back(std::move(row));
        plain.push_back(entry.frame);
    }
    return {{"frames", std::move(frames)}, {"summary", pipeline::summary_json(plain, std::nullopt)}};
}

std::string FrameHistory::csv() const {
    std::vector<pipeline::FrameStatistics> plain;
    for (const HistoryEntry& entry : entries_) plain.push_back(entry.frame);
    return pipeline::to_csv(plain);
}

std::string FrameHistory::chrome_trace() const {
    Json events = Json::array();
    double start = 0.0;
    for (const HistoryEntry& entry : entries_) {
        const auto span = [&](const char* name, double begin, double length) {
            events.push_back({{"name", name}, {"ph", "X"}, {"pid", 1}, {"tid", 1}, {"ts", begin}, {"dur", length}});
        };
        const pipeline::FrameStatistics& frame = entry.frame;
        span("frame", start, entry.frame_us);
        double at = start;
        for (const auto& [name, length] : {std::pair<const char*, double>{"update", frame.update_us},
                                           {"cull", frame.cull_us},
                                           {"collide", frame.collide_us},
                                           {"draw", frame.draw_us},
                                           {"user interface", entry.ui_us}}) {
            span(name, at, length);
            at += length;
        }
        events.push_back({{"name", "counts"},
                          {"ph", "C"},
                          {"pid", 1},
                          {"ts", start},
                          {"args", {{"visible", frame.visible}, {"triangles passed", frame.triangles_passed}}}});
        start += std::max(entry.frame_us, at - start);
    }
    return Json{{"traceEvents", std::move(events)}, {"displayTimeUnit", "ms"}}.dump();
}

}  // namespace crofton::viewer
