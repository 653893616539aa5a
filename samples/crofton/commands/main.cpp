// The command line `crofton`: one sub-command per question.
#include <CLI/CLI.hpp>
#include <cerrno>
#include <crofton/core/version.hpp>
#include <cstdio>
#include <cstring>
#include <iostream>

#include "arguments.hpp"
#include "commands.hpp"

int main(int argc, char** argv) {
    using namespace crofton::cli;
    CLI::App app{"Frustum culling, collision detection and triangle counts, chosen by integral geometry.", "crofton"};
    app.set_version_flag("--version", std::string("crofton ") + crofton::version_string());
    app.require_subcommand(1);
    app.fallthrough(false);
    Outcome outcome;
    add_fit_command(app, outcome);
    add_bake_command(app, outcome);
    add_collide_command(app, outcome);
    add_frames_command(app, outcome);
    add_lines_command(app, outcome);
    add_measure_command(app, outcome);
    add_radiosity_command(app, outcome);
    add_triangulate_command(app, outcome);
    add_verify_command(app, outcome);
#if defined(CROFTON_VIEWER)
    add_view_command(app, outcome);
#endif
    demand_whole_numbers(app);
    const std::vector<std::string> arguments = with_help_as_option(argc, argv);
    try {
        app.parse(std::vector<std::string>(arguments.rbegin(), arguments.rend()));
    } catch (const CLI::ParseError& error) {
        if (error.get_exit_code() == 0) return app.exit(error);
        std::cerr << usage_error(app, error, arguments);
        return kBadInput;
    }
    // What was printed may still be in the buffer, and a full disk is told only when it goes out.
    if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return outcome.status;
    std::fprintf(stderr, "crofton: standard output: cannot write: %s\n", std::strerror(errno));
    return kBadInput;
}
