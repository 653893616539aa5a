// SPDX-License-Identifier: MIT
// The HTML report: complete in itself, and, where Chromium is installed, what a browser makes of it.
#include <doctest/doctest.h>

#include <cstdlib>
#include <string>
#include <string_view>

#include "../cli/run_cli.hpp"
#include "assets/print.hpp"
#include "commands/html_report.hpp"
#include "pipeline/frame_statistics.hpp"

using namespace crofton::test;

namespace {

std::size_t count_of(const std::string& text, const std::string& part) {
    std::size_t count = 0;
    for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
    return count;
}

// The page's text: pictures in base64 spell any word.
std::string without_pictures(std::string page) {
    const std::string mark = "base64,";
    for (std::size_t at = page.find(mark); at != std::string::npos; at = page.find(mark, at + mark.size()))
        page.erase(at + mark.size(), page.find('"', at) - at - mark.size());
    return page;
}

}  // namespace

TEST_SUITE("cli/html_report") {
    TEST_CASE("text that looks like markup stays text, numbers are grouped, and a chart of nothing is a chart") {
        using namespace crofton::cli;
        CHECK(markup_text("<a href=\"x\">&'</a>") == "&lt;a href=&quot;x&quot;&gt;&amp;&#39;&lt;/a&gt;");
        CHECK(readable(1234567.0) == "1&#8239;234&#8239;567");
        CHECK(readable(0.12345) == "0.123");
        const std::string empty = svg_chart("id", "title", "unit", {});
        CHECK(empty.find("nan") == std::string::npos);
        CHECK(svg_chart("id", "t", "u", {{"a", {0.0, 0.0}}}).find("nan") == std::string::npos);
        CHECK(count_of(svg_chart("id", "t", "u", {{"a", {1.0, 2.0, 3.0}}, {"b", {3.0, 2.0, 1.0}}}), "<polyline") == 2);
    }
    TEST_CASE("with occlusion a report begins with both columns, and charts them") {
        const std::string file = scratch().file("occlusion.html");
        const CliRun run =
            run_cli("frames --instances 300 --frames 4 --camera street --size 160x90 --occlude --verify --report '" +
                    file + "'");
        CHECK(run.status == 0);
        const std::string page = contents_of(file);
        for (const char* id : {"occlusion", "chart-occlusion-triangles", "chart-occlusion-frame", "verification"})
            CHECK_MESSAGE(page.find("id=\"" + std::string(id) + "\"") != std::string::npos, id);
        for (const auto& column : crofton::pipeline::occlusion_columns())
            if (std::string(column.name).find("gpu_") == std::string::npos &&
                !std::string_view(column.name).starts_with("shadow_"))
                CHECK_MESSAGE(page.find("<tr><td>" + std::string(column.name) + "</td>") != std::string::npos,
                              column.name);
        CHECK(without_pictures(page).find("nan") == std::string::npos);
    }
    TEST_CASE("a report holds charts, pictures, settings and the verdict, and loads nothing") {
        const std::string file = scratch().file("report.html");
        const CliRun run = run_cli("frames --instances 300 --frames 5 --size 160x90 --verify --report '" + file + "'");
        CHECK(run.status == 0);
        const std::string page = contents_of(file);
        REQUIRE(page.size() > 1000);
        CHECK(count_of(page, "<svg ") >= 5);
        CHECK(page.find("id=\"verification\"") != std::string::npos);
        CHECK(page.find("0 mismatches") != std::string::npos);
        CHECK(count_of(page, "http://") + count_of(page, "https://") + count_of(page, "<script") == 0);
        CHECK(without_pictures(page).find("nan") == std::string::npos);
        // Every number of the CSV has a row; a scene has no regions.
        for (const auto& column : crofton::pipeline::statistics_columns())
            if (!std::string_view(column.name).starts_with("gpu_") &&
                !std::string_view(column.name).starts_with("regions_"))
                CHECK_MESSAGE(page.find("<tr><td>" + std::string(column.name) + "</td>") != std::string::npos,
                              column.name);
        if (run.err.find("not drawing") == std::string::npos) CHECK(count_of(page, "data:image/png;base64,") >= 1);
        if (std::system("command -v chromium >/dev/null 2>&1") != 0) {
            MESSAGE("skipped in part: chromium is not installed");
            return;
        }
        // The page as the browser has parsed it.
        const std::string dom = scratch().file("dom.html");
        const std::string command = "chromium --headless --no-sandbox --disable-gpu --user-data-dir='" +
                                    scratch().file("chromium") + "' --dump-dom 'file://" + file + "' >'" + dom +
                                    "' 2>/dev/null";
        REQUIRE(std::system(command.c_str()) == 0);
        const std::string parsed = contents_of(dom);
        for (const char* id : {"chart-instances", "chart-triangles", "chart-time", "chart-pairs", "chart-nodes"})
            CHECK(parsed.find("id=\"" + std::string(id) + "\"") != std::string::npos);
        CHECK(count_of(parsed, "<polyline") == count_of(page, "<polyline"));
        // Laid out: nothing is wider than the screen, charts have a size, and the page follows the reader's colours.
        const std::string probe =
            "<script>parent.document.title = JSON.stringify({screen: document.documentElement.clientWidth, "
            "page: document.documentElement.scrollWidth, charts: [...document.querySelectorAll('svg')].map(e => "
            "e.getBoundingClientRect().width), pictures: [...document.images].map(e => e.naturalWidth), "
            "ground: getComputedStyle(document.body).backgroundColor})</script>";
        const std::string probed = scratch().file("probed.html");
        std::string grounds[2];
        for (const int light : {0, 1})
            for (const int width : {390, 1280}) {
                CAPTURE(width);
                // Windows are not as narrow as a phone: the page is shown in a frame of the width.
                write_contents(probed, "<title></title><iframe style=\"border:0\" height=\"4000\" width=\"" +
                                           std::to_string(width) + "\" srcdoc=\"" + crofton::markup_text(page + probe) +
                                           "\"></iframe>");
                const std::string layout =
                    "chromium --headless --no-sandbox --disable-gpu --user-data-dir='" + scratch().file("chromium") +
                    "' --blink-settings=preferredColorScheme=" + std::to_string(light) +
                    " --window-size=1400,900 --dump-dom 'file://" + probed + "' >'" + dom + "' 2>/dev/null";
                REQUIRE(std::system(layout.c_str()) == 0);
                const std::string laid_out = contents_of(dom);
                const std::size_t begin = laid_out.find("<title>") + 7, end = laid_out.find("</title>");
                REQUIRE(end > begin);
                const auto found = nlohmann::json::parse(laid_out.substr(begin, end - begin), nullptr, false);
                REQUIRE(found.is_object());
                CHECK(found["screen"] <= width);
                CHECK(found["page"] <= found["screen"]);
                for (const auto& chart : found["charts"]) CHECK(chart.get<double>() > 200.0);
                for (const auto& picture : found["pictures"]) CHECK(picture == 160);
                grounds[light] = found["ground"];
            }
        CHECK(grounds[0] != grounds[1]);
    }
}
