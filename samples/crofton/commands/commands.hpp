// The sub-commands of `crofton`: each adds itself to the parser and, when chosen, returns the process's exit status.
#pragma once

namespace CLI {
class App;
}

namespace crofton::cli {

// Exit statuses, the same for every sub-command.
enum ExitStatus : int { kSuccess = 0, kCheckFailed = 1, kBadInput = 2 };

// What the chosen sub-command returned; set by its callback.
struct Outcome {
    int status = kSuccess;
};

void add_fit_command(CLI::App& app, Outcome& outcome);
void add_bake_command(CLI::App& app, Outcome& outcome);
void add_collide_command(CLI::App& app, Outcome& outcome);
void add_frames_command(CLI::App& app, Outcome& outcome);
void add_lines_command(CLI::App& app, Outcome& outcome);
void add_measure_command(CLI::App& app, Outcome& outcome);
void add_radiosity_command(CLI::App& app, Outcome& outcome);
void add_triangulate_command(CLI::App& app, Outcome& outcome);
void add_verify_command(CLI::App& app, Outcome& outcome);
void add_view_command(CLI::App& app, Outcome& outcome);  // where GLFW and Dear ImGui are installed

}  // namespace crofton::cli
