// SPDX-License-Identifier: MIT
#include "html_report.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "assets/print.hpp"
#include "frames_table.hpp"
#include "pipeline/png.hpp"

namespace crofton::cli {
namespace {

using pipeline::FrameStatistics;

constexpr const char* kStyle = R"(<style>
:root { color-scheme: light dark; --ground: #fbfbfa; --ink: #1c2126; --quiet: #66707a; --rule: #dde1e5; --card: #ffffff;
  --s0: #1f6fd1; --s1: #c8541a; --s2: #2c8a4b; --s3: #8a4fbf; --s4: #a9820a; }
@media (prefers-color-scheme: dark) { :root { --ground: #14171a; --ink: #e6e9ec; --quiet: #98a2ac; --rule: #2d343b;
  --card: #1b2025; --s0: #6aaaf5; --s1: #f08b55; --s2: #62c584; --s3: #bd8ff0; --s4: #dcb945; } }
* { box-sizing: border-box; }
body { margin: 0 auto; padding: 1.2rem; max-width: 80rem; background: var(--ground); color: var(--ink);
  font: 16px/1.5 system-ui, sans-serif; }
h1 { font-size: 1.6rem; line-height: 1.2; margin: 0 0 .3rem; } h2 { font-size: 1.15rem; margin: 2rem 0 .6rem; }
small, .quiet { color: var(--quiet); } figure { margin: 0; }
.tiles, .charts, .pictures { display: grid; gap: .8rem; grid-template-columns: repeat(auto-fit, minmax(min(100%, 8.4rem), 1fr)); }
.charts, .pictures { grid-template-columns: repeat(auto-fit, minmax(min(100%, 24rem), 1fr)); }
.tiles > div, .chart, .pictures figure { background: var(--card); border: 1px solid var(--rule); border-radius: .5rem; padding: .7rem; }
.tiles b { display: block; font-size: 1.35rem; font-variant-numeric: tabular-nums; }
.pictures img { width: 100%; height: auto; display: block; border-radius: .3rem; }
svg { width: 100%; height: auto; display: block; } svg text { fill: var(--quiet); font-size: 17px; }
.grid { stroke: var(--rule); } polyline { fill: none; stroke-width: 2; stroke-linejoin: round; }
polyline.s0 { stroke: var(--s0); } polyline.s1 { stroke: var(--s1); } polyline.s2 { stroke: var(--s2); }
polyline.s3 { stroke: var(--s3); } polyline.s4 { stroke: var(--s4); }
.chart ul { list-style: none; margin: .3rem 0 0; padding: 0; display: flex; flex-wrap: wrap; gap: .2rem 1rem; font-size: .9rem; }
.chart i { display: inline-block; width: .9rem; height: .2rem; vertical-align: middle; margin-right: .35rem; }
li.s0 i { background: var(--s0); } li.s1 i { background: var(--s1); } li.s2 i { background: var(--s2); }
li.s3 i { background: var(--s3); } li.s4 i { background: var(--s4); }
@media (max-width: 34rem) { svg text { font-size: 22px; } .tiles b { font-size: 1.15rem; } body { padding: .8rem; } }
.scroll { overflow-x: auto; } table { border-collapse: collapse; font-variant-numeric: tabular-nums; }
td, th { text-align: right; padding: .2rem .7rem; border-bottom: 1px solid var(--rule); white-space: nowrap; }
td:first-child, th:first-child { text-align: left; } .bad { color: #d22; } .good { color: var(--s2); }
</style>)";

std::string base64(const std::string& bytes) {
    static constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    text.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        std::uint32_t word = 0;
        for (std::size_t k = 0; k < 3; ++k)
            word = word << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
        for (std::size_t k = 0; k < 4; ++k) text += i + k <= bytes.size() ? kDigits[word >> (18 - 6 * k) & 63] : '=';
    }
    return text;
}

template <class Value>
Series series_of(const char* name, std::span<const FrameStatistics> frames, Value value) {
    Series series{name, {}};
    for (const FrameStatistics& frame : frames) series.values.push_back(static_cast<double>(value(frame)));
    return series;
}

std::string one_digit(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.1f", value);
    return text;
}

std::string tile(const char* name, const std::string& value) {
    return std::string("<div><b>") + value + "</b><span class=\"quiet\">" + name + "</span></div>";
}

// A row of the table of both columns; `digits` after the point.
std::string row_of_both(const char* name, double without, double with, const char* pattern) {
    char numbers[3][32];
    std::snprintf(numbers[0], sizeof numbers[0], pattern, without);
    std::snprintf(numbers[1], sizeof numbers[1], pattern, with);
    // Nothing where it is not less.
    numbers[2][0] = '\0';
    if (with > 0.0 && without >= with) std::snprintf(numbers[2], sizeof numbers[2], "%.1f", without / with);
    std::string html = std::string("<tr><td>") + name + "</td>";
    for (const int k : {0, 1})
        html += std::string("<td>") + (pattern[2] == '0' ? readable(k == 0 ? without : with) : numbers[k]) + "</td>";
    return html + "<td>" + numbers[2] + "</td></tr>\n";
}

// The savings by occlusion: each number without and with it.
std::string both_columns(const ReportContents& c) {
    if (!c.frames.front().occlusion) return {};
    const auto without = [&](auto value) { return mean_of(c.frames, value); };
    const auto with = [&](auto value) {
        return mean_of(c.frames, [&](const FrameStatistics& f) { return value(*f.occlusion); });
    };
    const auto submitted = [](const auto& f) { return f.triangles_submitted; };
    std::string html =
        "<h2>What occlusion saves</h2><div class=\"scroll\"><table id=\"occlusion\">\n<tr><th>mean of a "
        "frame</th><th>without</th><th>with</th><th>times less</th></tr>\n";
    html += row_of_both("instances drawn", without([](const auto& f) { return f.visible; }),
                        with([](const auto& f) { return f.visible; }), "%.0f");
    html += row_of_both("triangles submitted", without(submitted), with(submitted), "%.0f");
    html += row_of_both("triangles that meet the frustum", without([](const auto& f) { return f.triangles_passed; }),
                        with([](const auto& f) { return f.triangles_passed; }), "%.0f");
    const auto median = [&](auto value) { return median_of(c.frames, value); };
    html += row_of_both("ms to cull, median", median([](const auto& f) { return 1e-3 * f.cull_us; }),
                        median([](const auto& f) { return 1e-3 * f.occlusion->occlude_us; }), "%.2f");
    if (c.frames.front().gpu)
        html += row_of_both("ms to draw it, median", median([](const auto& f) { return 1e-3 * f.draw_us; }),
                            median([](const auto& f) { return 1e-3 * f.occlusion->draw_us; }), "%.1f");
    html += row_of_both("ms of the frame, median", median(frame_ms), median(frame_ms_with_occlusion), "%.1f");
    html += row_of_both("ms of the frame, 99 % are below", quantile_of(c.frames, 0.99, frame_ms),
                        quantile_of(c.frames, 0.99, frame_ms_with_occlusion), "%.1f");
    html += "</table></div>\n";
    return html;
}

std::string summary(const ReportContents& c) {
    const auto mean = [&](auto value) { return readable(mean_of(c.frames, value)); };
    std::string html = "<div class=\"tiles\">";
    html += tile("instances", readable(static_cast<double>(c.scene.instances)));
    if (c.scene.triangles) html += tile("triangles", readable(static_cast<double>(*c.scene.triangles)));
    html += tile("visible instances, mean", mean([](const auto& f) { return f.visible; }));
    html += tile("triangles submitted, mean", mean([](const auto& f) { return f.triangles_submitted; }));
    html += tile("triangles that meet the frustum, mean", mean([](const auto& f) { return f.triangles_passed; }));
    if (const auto seen = pipeline::mean_seen(c.frames)) {
        html += tile("triangles that own a pixel, mean", readable(seen->triangles));
        html += tile("passed / seen", one_digit(seen->passed_per_seen()));
        if (c.frames.front().occlusion)
            html += tile("passed / seen with occlusion", one_digit(seen->passed_per_seen_with_occlusion()));
    }
    html += tile("improper tests, mean", mean([](const auto& f) { return f.improper; }));
    html += tile("colliding pairs, mean", mean([](const auto& f) { return f.colliding_pairs; }));
    html += tile("&micro;s to cull, mean", mean([](const auto& f) { return f.cull_us; }));
    html += "</div>\n";
    if (c.verification) {
        const bool good = c.verification->mismatches() == 0;
        html += std::string("<p class=\"") + (good ? "good" : "bad") +
                "\" id=\"verification\">Verified by brute force: " +
                readable(static_cast<double>(c.verification->mismatches())) + " mismatches in " +
                readable(static_cast<double>(c.verification->frames)) + " frames" +
                (c.frames.front().occlusion && c.frames.front().gpu
                     ? std::string(": nothing that owns a pixel was hidden, both pictures of each frame are the same")
                     : std::string()) +
                ".</p>\n";
    }
    return html;
}

// Triangles that meet the frustum, those of them that own a pixel, and the ratio.
std::string seen_charts(std::span<const FrameStatistics> frames) {
    if (!pipeline::mean_seen(frames)) return {};
    std::vector<Series> triangles{
        series_of("meet the frustum", frames, [](const auto& f) { return f.triangles_passed; })};
    std::vector<Series> ratios{series_of("without occlusion", frames, [](const auto& f) {
        return pipeline::passed_per_seen(f.triangles_passed, f.seen);
    })};
    if (frames.front().occlusion) {
        triangles.push_back(
            series_of("with occlusion", frames, [](const auto& f) { return f.occlusion->triangles_passed; }));
        ratios.push_back(series_of("with", frames, [](const auto& f) {
            return pipeline::passed_per_seen(f.occlusion->triangles_passed, f.seen);
        }));
    }
    triangles.push_back(series_of("own a pixel", frames, [](const auto& f) { return f.seen ? f.seen->triangles : 0; }));
    return svg_chart("chart-seen", "Triangles passed and seen", "per frame", triangles) +
           svg_chart("chart-passed-per-seen", "Passed for each that is seen", "per frame", ratios);
}

std::string occlusion_charts(std::span<const FrameStatistics> frames) {
    if (!frames.front().occlusion) return {};
    return svg_chart("chart-occlusion-triangles", "Triangles submitted", "per frame",
                     {series_of("without occlusion", frames, [](const auto& f) { return f.triangles_submitted; }),
                      series_of("with", frames, [](const auto& f) { return f.occlusion->triangles_submitted; })}) +
           svg_chart(
               "chart-occlusion-frame", "The frame", "milliseconds",
               {series_of("without occlusion", frames, frame_ms), series_of("with", frames, frame_ms_with_occlusion),
                series_of("of it occlusion culling", frames,
                          [](const auto& f) { return 1e-3 * f.occlusion->occlude_us; })}) +
           svg_chart("chart-occlusion-instances", "Instances drawn", "per frame",
                     {series_of("without occlusion", frames, [](const auto& f) { return f.visible; }),
                      series_of("with", frames, [](const auto& f) { return f.occlusion->visible; })});
}

std::string charts(std::span<const FrameStatistics> frames) {
    std::string html = "<div class=\"charts\">\n" + seen_charts(frames) + occlusion_charts(frames);
    html += svg_chart("chart-instances", "Instances", "per frame",
                      {series_of("visible", frames, [](const auto& f) { return f.visible; }),
                       series_of("inside", frames, [](const auto& f) { return f.inside; }),
                       series_of("straddling", frames, [](const auto& f) { return f.straddling; }),
                       series_of("improper", frames, [](const auto& f) { return f.improper; })});
    std::vector<Series> triangles{
        series_of("submitted", frames, [](const auto& f) { return f.triangles_submitted; }),
        series_of("meet the frustum", frames, [](const auto& f) { return f.triangles_passed; })};
    if (frames.front().gpu) {
        triangles.push_back(series_of("clipped, predicted", frames, [](const auto& f) { return f.triangles_clipped; }));
        triangles.push_back(series_of("clipped, counted by the GPU", frames,
                                      [](const auto& f) { return f.gpu ? f.gpu->clipping_primitives : 0; }));
    }
    html += svg_chart("chart-triangles", "Triangles", "per frame", triangles);
    html += svg_chart("chart-time", "Time on the CPU", "microseconds",
                      {series_of("update", frames, [](const auto& f) { return f.update_us; }),
                       series_of("cull", frames, [](const auto& f) { return f.cull_us; }),
                       series_of("collide", frames, [](const auto& f) { return f.collide_us; })});
    html += svg_chart("chart-pairs", "Colliding pairs", "per frame",
                      {series_of("pairs", frames, [](const auto& f) { return f.colliding_pairs; })});
    html += svg_chart("chart-nodes", "Tree nodes tested", "per frame",
                      {series_of("nodes", frames, [](const auto& f) { return f.nodes_tested; })});
    if (frames.front().gpu)
        html += svg_chart("chart-draw", "Drawing", "milliseconds",
                          {series_of("draw", frames, [](const auto& f) { return f.draw_us * 1e-3; })});
    return html + "</div>\n";
}

// Every number of a frame: its least, middle, mean and most.
std::string numbers(std::span<const FrameStatistics> frames) {
    std::string html =
        "<h2>All numbers</h2><div class=\"scroll\"><table id=\"numbers\">\n<tr><th>per frame</th><th>least</th>"
        "<th>median</th><th>mean</th><th>most</th></tr>\n";
    for (const pipeline::StatisticsColumn& column : pipeline::columns_of(frames)) {
        const std::string name = column.name;
        std::vector<double> values;
        for (const FrameStatistics& frame : frames)
            if (column.has_value(frame)) values.push_back(column.value(frame));
        std::sort(values.begin(), values.end());
        html += "<tr><td>" + name + "</td><td>" + readable(values.front()) + "</td><td>" +
                readable(values[values.size() / 2]) + "</td><td>" + readable(mean_of(frames, column.value)) +
                "</td><td>" + readable(values.back()) + "</td></tr>\n";
    }
    return html + "</table></div>\n";
}

std::string pictures(const std::vector<ReportPicture>& list, std::span<const FrameStatistics> frames) {
    if (list.empty()) return {};
    std::string html = "<h2>Pictures</h2><div class=\"pictures\">\n";
    for (const ReportPicture& picture : list) {
        const std::string name = "frame " + std::to_string(picture.frame);
        const FrameStatistics& frame = frames[picture.frame];
        html += "<figure><img alt=\"" + name + "\" src=\"data:image/png;base64," +
                base64(pipeline::encode_png(picture.image)) + "\"><figcaption class=\"quiet\">" + name + ": ";
        if (frame.occlusion)
            html += readable(static_cast<double>(frame.occlusion->visible)) + " of " +
                    readable(static_cast<double>(frame.visible)) + " instances drawn, " +
                    readable(static_cast<double>(frame.occlusion->triangles_submitted)) + " of " +
                    readable(static_cast<double>(frame.triangles_submitted)) + " triangles";
        else
            html += readable(static_cast<double>(frame.visible)) + " visible, " +
                    readable(static_cast<double>(frame.triangles_passed)) + " triangles in view";
        html += "</figcaption></figure>\n";
    }
    return html + "</div>\n";
}

std::string settings(const ReportContents& c) {
    std::string html = "<h2>Settings</h2><div class=\"scroll\"><table id=\"settings\">\n";
    for (const auto& [name, value] : c.settings)
        if (!value.empty()) html += "<tr><td>" + markup_text(name) + "</td><td>" + markup_text(value) + "</td></tr>\n";
    return html + "</table></div>\n";
}

}  // namespace

std::string html_report(const ReportContents& c) {
    const std::string title = "Crofton: " + markup_text(c.scene.name);
    return "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>" + title +
           "</title>\n<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n" + kStyle +
           "</head><body>\n<h1>" + title + "</h1><p class=\"quiet\">" + readable(static_cast<double>(c.frames.size())) +
           " frames, each culled, collided, drawn and counted.</p>\n" + both_columns(c) + summary(c) +
           "<h2>Frame by frame</h2>\n" + charts(c.frames) + pictures(c.pictures, c.frames) + numbers(c.frames) +
           settings(c) + "</body></html>\n";
}

}  // namespace crofton::cli
