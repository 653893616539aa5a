// SPDX-License-Identifier: MIT
// The command line's parser: sub-commands, their options, and where the values go. CLI11 does the work, in
// command_line.cpp alone, since its headers take longer to compile than most programs that use them.
#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace crofton::cli {

// Exit statuses, the same for every sub-command.
enum ExitStatus : int { kSuccess = 0, kCheckFailed = 1, kBadInput = 2, kInterrupted = 130 };

// One option or positional argument. Each function adds a demand, checked before the sub-command runs, and returns the
// option itself.
class Option {
  public:
    Option& required();
    Option& show_default();                                        // in the help: the value that the target has now
    Option& whole_between(std::uint64_t low, std::uint64_t high);  // both included
    Option& between(double low, double high);                      // both included
    Option& positive();
    Option& not_negative();
    Option& one_of(const std::vector<std::string>& words);
    // A file to write: refuses a folder, a place where nothing can be written, "-", and the file of another such
    // option or of an input.
    Option& writable_file();
    Option& writable_file_or_stdout();  // the same, but "-" is stdout, for one option at a time
    Option& excludes(const Option& other);
    Option& needs(const Option& other);

    [[nodiscard]] bool given() const;  // once parsed: was it typed?

  private:
    friend class Command;
    explicit Option(CLI::Option* option) : option_(option) {}

    CLI::Option* option_;
};

// A sub-command. Names are "--name", "-n,--name", or "name" for a positional argument. Targets must outlive the
// parsing.
class Command {
  public:
    Option option(const char* name, std::string& target, const std::string& help);
    Option option(const char* name, std::vector<std::string>& target, const std::string& help);
    Option option(const char* name, std::uint32_t& target, const std::string& help);
    Option option(const char* name, std::uint64_t& target, const std::string& help);
    Option option(const char* name, std::optional<std::uint32_t>& target, const std::string& help);
    Option option(const char* name, float& target, const std::string& help);
    Option option(const char* name, double& target, const std::string& help);
    Option flag(const char* name, bool& target, const std::string& help);

    void footer(const std::string& text);      // below the list of options in the help
    void action(std::function<int()> action);  // what it does once its options are read; returns the exit status
    void action_with_window(std::function<int()> action);  // the same, without an Attendant: it shows what it does

  private:
    friend class CommandLine;
    Command(CLI::App* app, int* status) : app_(app), status_(status) {}

    CLI::App* app_;
    int* status_;
};

class CommandLine {
  public:
    CommandLine(const char* description, const std::string& version);
    ~CommandLine();
    CommandLine(const CommandLine&) = delete;
    CommandLine& operator=(const CommandLine&) = delete;

    [[nodiscard]] Command command(const char* name, const char* description);
    // `crofton study NAME`: for those who study the paper, not for those who make a game.
    [[nodiscard]] Command study_command(const char* name, const char* description);

    // Parses, and runs the sub-command that was chosen. Where something was mistyped: a line to stderr that says which
    // argument is wrong and why, a line that says where the right ones are listed, and kBadInput.
    [[nodiscard]] int run(int argc, char** argv);

  private:
    std::unique_ptr<CLI::App> app_;
    CLI::App* study_ = nullptr;
    int status_ = kSuccess;
};

}  // namespace crofton::cli
