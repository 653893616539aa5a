// SPDX-License-Identifier: MIT
// Runs the command line as a user would, and hands back what it said.
#pragma once
#include <sys/wait.h>
#include <unistd.h>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>

namespace crofton::test {

// A folder of its own for each test program, removed at its end.
class ScratchFolder {
  public:
    ScratchFolder()
        : path_(std::filesystem::temp_directory_path() /
                ("crofton_test_" + std::to_string(static_cast<long>(getpid())))) {
        std::filesystem::create_directories(path_);
    }
    ~ScratchFolder() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    ScratchFolder(const ScratchFolder&) = delete;
    ScratchFolder& operator=(const ScratchFolder&) = delete;
    [[nodiscard]] std::string file(const std::string& name) const { return (path_ / name).string(); }

  private:
    std::filesystem::path path_;
};

inline ScratchFolder& scratch() {
    static ScratchFolder folder;
    return folder;
}

inline std::string contents_of(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

inline void write_contents(const std::string& path, const std::string& contents) {
    std::ofstream(path, std::ios::binary) << contents;
}

struct CliRun {
    int status = -1;  // exit status; −1 where the program was killed
    std::string out, err;

    [[nodiscard]] nlohmann::json json() const { return nlohmann::json::parse(out, nullptr, false); }
};

// `arguments` as one would type them after `crofton`; `environment` as "NAME=value …".
inline CliRun run_cli(const std::string& arguments, const std::string& environment = {}) {
    const std::string out = scratch().file("stdout"), err = scratch().file("stderr");
    const std::string command =
        "env " + environment + " '" CROFTON_CLI "' " + arguments + " >'" + out + "' 2>'" + err + "' </dev/null";
    const int wait_status = std::system(command.c_str());
    CliRun run;
    if (WIFEXITED(wait_status)) run.status = WEXITSTATUS(wait_status);
    run.out = contents_of(out);
    run.err = contents_of(err);
    return run;
}

}  // namespace crofton::test
