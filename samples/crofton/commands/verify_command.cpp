// SPDX-License-Identifier: MIT
// crofton verify: is what Crofton is built on true? One row a claim.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <memory>

#include "assets/print.hpp"
#include "commands.hpp"
#include "json/json.hpp"
#include "progress_bar.hpp"
#include "report.hpp"
#include "verify/rows.hpp"
#include "verify/topics.hpp"

namespace crofton::cli {
namespace {

struct Topic {
    const char* name;
    std::vector<VerifyRow> (*rows)(const VerifyOptions&);
    bool part = false;  // of another topic: only if named
};
constexpr Topic kTopics[] = {
    {"paper", verify_paper},     {"lines", verify_lines},         {"cull", verify_cull}, {"occlude", verify_occlude},
    {"collide", verify_collide}, {"convex", verify_convex, true}, {"pvs", verify_pvs},
};

struct VerifyRequest {
    std::string topic;
    std::vector<std::string> scenes;
    std::string map;
    std::uint32_t instances = 0;
    VerifyOptions options;
    std::string json_path;
};

int run_verify(const VerifyRequest& request) {
    if (!request.scenes.empty() && request.topic != "occlude" && request.topic != "collide") {
        std::fputs("crofton: --scene goes with the topics occlude and collide\n", stderr);
        return kBadInput;
    }
    std::vector<VerifyRow> rows;
    const auto is_asked = [&](const Topic& topic) {
        return request.scenes.empty() && (request.topic.empty() ? !topic.part : request.topic == topic.name);
    };
    const auto topics = static_cast<std::size_t>(std::count_if(std::begin(kTopics), std::end(kTopics), is_asked));
    ProgressBar bar("verify", topics + request.scenes.size());
    std::size_t done = 0;
    for (const Topic& topic : kTopics) {
        if (!is_asked(topic)) continue;
        for (VerifyRow& row : topic.rows(request.options)) rows.push_back(std::move(row));
        bar.set(++done);
    }
    for (const std::string& scene : request.scenes) {
        const assets::LoadOptions which{.map = request.map, .instances = scene == "town" ? request.instances : 0};
        auto found = request.topic == "collide" ? verify_collided_scene(scene, which, request.options)
                                                : verify_occluded_scene(scene, which, request.options);
        if (!found) return report_error(scene, found.error());
        for (VerifyRow& row : *found) rows.push_back(std::move(row));
        bar.set(++done);
    }
    if (request.json_path != "-") print_text_to(stdout, table_of(rows));
    if (!request.json_path.empty())
        if (const auto written = write_json(request.json_path, json_of(rows)); !written)
            return report_error("", written.error());
    std::size_t failed = 0;
    for (const VerifyRow& row : rows) failed += row.holds ? 0 : 1;
    if (failed > 0) print_to(stderr, "crofton: %zu of %zu claims do not hold\n", failed, rows.size());
    return failed == 0 ? kSuccess : kCheckFailed;
}

}  // namespace

void add_verify_command(CommandLine& line) {
    auto request = std::make_shared<VerifyRequest>();
    Command command = kVerify.add_to(line);
    std::vector<std::string> names;
    for (const Topic& topic : kTopics) names.emplace_back(topic.name);
    command
        .option("topic", request->topic,
                "Only this topic; all by default. convex: the rows of collide about convex shapes")
        .one_of(names);
    command.option("--trials", request->options.trials, "Random queries per row; more make every check sharper")
        .whole_between(1000, std::uint64_t{1} << 40)
        .show_default();
    const Option scene =
        command.option("--scene", request->scenes,
                       "Check these scenes (files, or \"town\") instead: with the topic occlude the hidden objects, by "
                       "witness rays; with collide hulls, meshes and maps of polygons as shapes");
    command.option("--map", request->map, "Level of a .wad file given to --scene").needs(scene);
    command.option("--instances", request->instances, "Approximate number of instances of the town given to --scene")
        .show_default()
        .needs(scene);
    command.option("--seed", request->options.seed, "The same seed gives the same table, bit by bit").show_default();
    command.option("--json", request->json_path, "Also write the rows as JSON; - for stdout, instead of the table")
        .writable_file_or_stdout();
    command.footer(
        "`holds` says whether the measurement confirms the claim. Claims that begin \"wrong, must be rejected\" hold "
        "if the\n"
        "measurement rejects them at |z| > 4. Exit status: 0 all hold, 1 one does not, 2 bad usage.\n"
        "All topics together take minutes.\n"
        "\n"
        "Examples:\n"
        "  crofton verify\n"
        "  crofton verify lines --trials 1000000 --seed 7\n"
        "  crofton verify occlude --scene town --scene forest.glb --trials 1000000\n"
        "  crofton verify occlude --scene doom.wad --map MAP07\n"
        "  crofton verify convex --trials 10000000 --seed 3\n"
        "  crofton verify collide --scene bunny.obj --scene counties.poly\n"
        "  crofton verify paper --json - | jq '.[] | select(.holds | not)'");
    command.action([request] { return run_verify(*request); });
}

}  // namespace crofton::cli
