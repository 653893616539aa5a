// The command line `crofton`: one sub-command per question.
#include <CLI/CLI.hpp>
#include <crofton/core/version.hpp>
#include <iostream>

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
    add_radiosity_command(app, outcome);
    add_triangulate_command(app, outcome);
    add_verify_command(app, outcome);
#if defined(CROFTON_VIEWER)
    add_view_command(app, outcome);
#endif
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? kSuccess : kBadInput;
    }
    return outcome.status;
}
