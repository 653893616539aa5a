// SPDX-License-Identifier: MIT
// The command line `crofton`: one sub-command per question.
#include <unistd.h>

#include <cerrno>
#include <crofton/core/version.hpp>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <string_view>

#include "assets/print.hpp"
#include "commands.hpp"

namespace crofton::cli {
namespace {

// Whether `crofton-study` has the sub-command that is asked for, also as `crofton help verify`.
bool is_of_study_program(int argc, char** argv) {
    int word = 1;
    if (argc > 2 && std::string_view(argv[1]) == "help") word = 2;
    if (argc <= word) return false;
    for (const StudyCommand& command : kStudyCommands)
        if (argv[word] == std::string_view(command.in_group ? "study" : command.name)) return true;
    return false;
}

// Becomes the program `crofton-study` in the folder of this one. Returns only where it cannot.
int become_study_program(char** argv) {
    std::error_code error;
    auto self = std::filesystem::read_symlink("/proc/self/exe", error);
    if (error) self = argv[0];
    const std::string program = (self.parent_path() / "crofton-study").string();
    execv(program.c_str(), argv);
    print_to(stderr, "crofton: '%s' is in the program crofton-study: %s: %s\n", argv[1], program.c_str(),
             std::strerror(errno));
    if (errno == ENOENT)
        std::fputs("From a checkout: cmake --build --preset release --target crofton_study_cli\n", stderr);
    return kBadInput;
}

}  // namespace
}  // namespace crofton::cli

int main(int argc, char** argv) {
    using namespace crofton::cli;
    if (is_of_study_program(argc, argv)) return become_study_program(argv);
    CommandLine line(kDescription, crofton::version_string());
    add_frames_command(line);
#if defined(CROFTON_VIEWER)
    add_view_command(line);
#endif
    add_fit_command(line);
    add_collide_command(line);
    add_triangulate_command(line);
    add_bake_command(line);
    add_pvs_command(line);
    // For the list in --help, and for what a mistyped word was meant to be.
    for (const StudyCommand& command : kStudyCommands) command.add_to(line);
    return line.run(argc, argv);
}
