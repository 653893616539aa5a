// SPDX-License-Identifier: MIT
#include "read_options.hpp"

#include <cstdio>

#include "assets/print.hpp"

namespace crofton::cli {

void add_read_options(Command& command, ReadOptions& options) {
    assets::ReadLimits& limits = options.limits;
    const auto whole = [&](const char* name, std::uint64_t& limit, const char* help) {
        command.option(name, limit, help).whole_between(1, std::uint64_t{1} << 48).show_default();
    };
    whole("--max-bytes", limits.bytes, "Refuse files that are larger than this, with all files they refer to");
    whole("--max-triangles", limits.triangles, "Refuse files of more triangles, or points of polygons");
    whole("--max-pixels", limits.pixels, "Leave out images of more pixels");
    whole("--max-nodes", limits.nodes, "Refuse files of more nodes or instances");
    command.option("--max-seconds", limits.seconds, "Stop reading after this time").positive().show_default();
    command.flag("--strict", options.strict, "Refuse files of which anything would be left out");
}

void add_unit_option(Command& command, ReadOptions& options) {
    command
        .option("--unit", options.unit,
                "Metres that a length of 1 is (0.01: centimetres): how high eyes are on a street. Default: as the "
                "file says; of .obj, which does not say it, what fits the scene")
        .positive();
}

void print_warnings(const std::vector<std::string>& warnings) {
    constexpr std::size_t kMost = 20;
    for (std::size_t i = 0; i < warnings.size() && i < kMost; ++i)
        print_to(stderr, "crofton: warning: %s\n", printable(warnings[i]).c_str());
    if (warnings.size() > kMost) print_to(stderr, "crofton: warning: and %zu more\n", warnings.size() - kMost);
}

Result<void> refuse_if_strict(const std::string& path, const std::vector<std::string>& warnings,
                              const ReadOptions& read) {
    if (!read.strict || warnings.empty()) return {};
    return fail(ErrorCode::parse, kNoItem, path + ": " + warnings.front() + " (refused: --strict)");
}

Result<assets::SceneSource> load_updated_scene(const std::string& scene, const ReadOptions& read,
                                               assets::LoadOptions load, Executor& executor) {
    load.limits = read.limits;
    load.strict = read.strict;
    load.unit = read.unit;
    auto source = assets::load_scene(scene, load);
    if (!source) return source;
    print_warnings(source->warnings);
    source->scene.update(executor);
    return source;
}

}  // namespace crofton::cli
