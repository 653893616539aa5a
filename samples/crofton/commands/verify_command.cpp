// SPDX-License-Identifier: MIT
// crofton verify: is what Crofton is built on true? One row a claim.
#include <cmath>
#include <cstdio>
#include <iterator>
#include <memory>

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
};
constexpr Topic kTopics[] = {{"paper", verify_paper}, {"lines", verify_lines}};

struct VerifyRequest {
    std::string topic;
    VerifyOptions options;
    std::string json_path;
};

int run_verify(const VerifyRequest& request) {
    std::vector<VerifyRow> rows;
    ProgressBar bar("verify", std::size(kTopics));
    std::size_t done = 0;
    for (const Topic& topic : kTopics) {
        if (request.topic.empty() || request.topic == topic.name)
            for (VerifyRow& row : topic.rows(request.options)) rows.push_back(std::move(row));
        bar.set(++done);
    }
    if (request.json_path != "-") std::fputs(table_of(rows).c_str(), stdout);
    if (!request.json_path.empty())
        if (const auto written = write_json(request.json_path, json_of(rows)); !written)
            return report_error("", written.error());
    std::size_t failed = 0;
    for (const VerifyRow& row : rows) failed += row.holds ? 0 : 1;
    if (failed > 0) std::fprintf(stderr, "crofton: %zu of %zu claims do not hold\n", failed, rows.size());
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
                "paper: measures, criteria, bounds and triangulations. lines: which random lines are uniform. Default: "
                "both")
        .one_of(names);
    command.option("--trials", request->options.trials, "Random queries per row; more make every check sharper")
        .whole_between(1000, std::uint64_t{1} << 40)
        .show_default();
    command.option("--seed", request->options.seed, "The same seed gives the same table, bit by bit").show_default();
    command.option("--json", request->json_path, "Also write the rows as JSON; - for stdout, instead of the table")
        .writable_file_or_stdout();
    command.footer(
        "`holds` says whether the measurement confirms the claim. Claims that begin \"wrong, must be rejected\" hold "
        "if the\n"
        "measurement rejects them at |z| > 4. Exit status: 0 all hold, 1 one does not, 2 bad usage.\n"
        "\n"
        "Examples:\n"
        "  crofton verify\n"
        "  crofton verify lines --trials 1000000 --seed 7\n"
        "  crofton verify paper --json - | jq '.[] | select(.holds | not)'");
    command.action([request] { return run_verify(*request); });
}

}  // namespace crofton::cli
