// SPDX-License-Identifier: MIT
// `crofton merge`: parts of a bake, of visible sets or of light, as one.
#include <crofton/bake/baked_scene.hpp>
#include <crofton/pvs/pvs.hpp>
#include <crofton/radiosity/solver.hpp>
#include <cstdio>

#include "assets/print.hpp"
#include "commands.hpp"
#include "region_state.hpp"
#include "report.hpp"

namespace crofton::cli {
namespace {

struct MergeRequest {
    std::vector<std::string> parts;
    std::string out;
    std::uint32_t shards = 0;
};

// Says on stderr which shards to run again.
void print_missing(const MergeRequest& options, const char* what, std::span<const std::uint32_t> missing,
                   std::uint32_t shards) {
    print_to(stderr, "crofton: %s: %s are missing; run again:", printable(options.out).c_str(), what);
    for (const std::uint32_t i : missing) print_to(stderr, " --shard %u/%u", i, shards);
    std::fputs("\n", stderr);
}

Result<int> run_merge(const MergeRequest& options) {
    std::vector<bake::MappedFile> files;
    std::vector<std::span<const std::byte>> states;
    for (const std::string& path : options.parts) {
        auto file = bake::MappedFile::open(path, {.access = bake::FileAccess::read});
        if (!file) return file.error();
        files.push_back(std::move(*file));
        states.push_back(files.back().bytes());
    }
    const std::uint32_t shards = options.shards ? options.shards : static_cast<std::uint32_t>(options.parts.size());
    if (is_region_state(states.front())) {
        const auto missing = merge_region_states(options.parts, states, options.out, shards, serial_executor());
        if (!missing) return missing.error();
        if (missing->empty()) return kSuccess;
        print_missing(options, "regions", *missing, shards);
        return kCheckFailed;
    }
    const bool of_light = radiosity::is_bake_state(states.front());
    for (std::size_t i = 1; i < states.size(); ++i)
        if (!of_light && radiosity::is_bake_state(states[i]))
            return fail(ErrorCode::invalid_argument, kNoItem,
                        options.parts[i] + ": is of a bake of light, and " + options.parts.front() + " is not");
    const auto sum = of_light ? radiosity::merge_states(states) : pvs::merge_states(states);
    if (!sum) {
        const bool names_part = sum.error().item < options.parts.size();
        return fail(sum.error().code, kNoItem,
                    (names_part ? options.parts[sum.error().item] + ": " : std::string()) + sum.error().message);
    }
    if (auto written = write_file(options.out, {reinterpret_cast<const char*>(sum->data()), sum->size()}); !written)
        return written.error();
    const auto missing = of_light ? radiosity::missing_shards(*sum, shards) : pvs::missing_shards(*sum, shards);
    if (!missing) return missing.error();
    if (missing->empty()) return kSuccess;
    print_missing(options, of_light ? "runs" : "lines", *missing, shards);
    return kCheckFailed;
}

}  // namespace

void add_merge_command(CommandLine& line) {
    auto options = std::make_shared<MergeRequest>();
    Command command = kMerge.add_to(line);
    command
        .option(
            "parts", options->parts,
            "Files that `crofton pvs`, `crofton study radiosity` or `crofton bake --regions` wrote with --shard i/n "
            "--state FILE")
        .required();
    command
        .option("--out", options->out,
                "File for the sum; it has the bytes that one run would have saved. Of regions: index.crofton in "
                "their folder")
        .writable_file()
        .required();
    command.option("--shards", options->shards, "Number of parts of the work; by default the number given");
    command.footer(
        "A part that is given twice counts once. Exit status: 0 nothing is missing, 1 parts are missing (the shards to "
        "run again are named; the sum is written, but no index of regions), 2 a part, or a region's file, is damaged "
        "or "
        "of another bake.\n"
        "\n"
        "Example:\n"
        "  crofton merge part0 part1 part2 part3 --out whole.state\n"
        "  crofton merge part0 part1 --out regions/index.crofton");
    command.action([options] {
        const auto done = run_merge(*options);
        return done ? *done : report_error("", done.error());
    });
}

}  // namespace crofton::cli
