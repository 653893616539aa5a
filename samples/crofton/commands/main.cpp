// SPDX-License-Identifier: MIT
// The command line `crofton`: one sub-command per question.
#include <cerrno>
#include <crofton/core/version.hpp>
#include <cstdio>
#include <cstring>

#include "commands.hpp"

int main(int argc, char** argv) {
    using namespace crofton::cli;
    CommandLine line("Frustum culling, collision detection and triangle counts, chosen by integral geometry.",
                     crofton::version_string());
    add_frames_command(line);
#if defined(CROFTON_VIEWER)
    add_view_command(line);
#endif
    add_fit_command(line);
    add_collide_command(line);
    add_triangulate_command(line);
    add_bake_command(line);
    add_pvs_command(line);
    add_merge_command(line);
    add_verify_command(line);
    add_measure_command(line);
    add_lines_command(line);
    add_hierarchy_command(line);
    add_radiosity_command(line);
    const int status = line.run(argc, argv);
    // Output may still be in the buffer; a full disk shows only when it is flushed.
    if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return status;
    std::fprintf(stderr, "crofton: standard output: cannot write: %s\n", std::strerror(errno));
    return kBadInput;
}
