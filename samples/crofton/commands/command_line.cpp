// SPDX-License-Identifier: MIT
#include "command_line.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <map>
#include <sstream>
#include <system_error>

#include "assets/file.hpp"
#include "assets/print.hpp"
#include "interrupt.hpp"

namespace crofton::cli {
namespace {

constexpr const char* kNotWhole = " is not a whole number from 0 in digits, or too large";

// Optimal string alignment distance: letters added, left out, replaced, or swapped with their neighbour.
std::size_t distance(const std::string& a, const std::string& b) {
    std::vector<std::vector<std::size_t>> d(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
    for (std::size_t i = 0; i <= a.size(); ++i) d[i][0] = i;
    for (std::size_t j = 0; j <= b.size(); ++j) d[0][j] = j;
    for (std::size_t i = 1; i <= a.size(); ++i)
        for (std::size_t j = 1; j <= b.size(); ++j) {
            const std::size_t replaced = d[i - 1][j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
            d[i][j] = std::min({d[i - 1][j] + 1, d[i][j - 1] + 1, replaced});
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
                d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
        }
    return d[a.size()][b.size()];
}

// Returns the word of `known` that `typed` was most likely meant to be: at most two letters added, left out, replaced
// or swapped, and fewer than half of them. Empty if there is none.
std::string nearest_word(const std::string& typed, const std::vector<std::string>& known) {
    std::string best;
    std::size_t least = 3;
    for (const std::string& word : known) {
        const std::size_t d = distance(typed, word);
        if (d < least && 2 * d < word.size()) {
            least = d;
            best = word;
        }
    }
    return best;
}

std::string did_you_mean(const std::string& word) {
    return word.empty() ? std::string{} : "; did you mean '" + word + "'?";
}

// The sub-command typed, or the program itself, and the words that lead to it.
struct Chosen {
    const CLI::App* command;
    std::size_t depth = 0;
    std::string name = "crofton";
};
Chosen chosen(const CLI::App& app) {
    Chosen result{&app};
    for (auto parsed = app.get_subcommands(); !parsed.empty(); parsed = result.command->get_subcommands()) {
        result.command = parsed.front();
        ++result.depth;
        result.name += " " + result.command->get_name();
    }
    return result;
}
bool is_group(const CLI::App& command) {
    return !command.get_subcommands({}).empty();
}

std::vector<std::string> option_names(const CLI::App& command) {
    std::vector<std::string> names;
    for (const CLI::Option* option : command.get_options()) {
        for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
        for (const std::string& name : option->get_snames()) names.push_back("-" + name);
    }
    return names;
}

std::vector<std::string> command_names(const CLI::App& app) {
    std::vector<std::string> names;
    for (const CLI::App* command : app.get_subcommands({})) names.push_back(command->get_name());
    return names;
}

// The first word that belongs to nothing: an option where there is one, since what follows it is left over as well.
std::string unexpected(const CLI::App& command, const std::vector<std::string>& arguments) {
    const auto left_over = command.remaining();
    std::string word;
    for (const std::string& argument : arguments) {
        if (std::find(left_over.begin(), left_over.end(), argument) == left_over.end()) continue;
        if (argument.size() > 1 && argument[0] == '-') {
            const std::string name = argument.substr(0, argument.find('='));
            return "there is no option '" + name + "'" + did_you_mean(nearest_word(name, option_names(command)));
        }
        if (word.empty()) word = argument;
    }
    return "'" + word + "' is one argument too many";
}

std::string of_conversion(const CLI::App& command, const std::string& what) {
    const std::string marker = "Could not convert: ";
    const std::size_t equals = what.find(" = ");
    if (what.compare(0, marker.size(), marker) != 0 || equals == std::string::npos) return what;
    const std::string name = what.substr(marker.size(), equals - marker.size());
    const CLI::Option* option = command.get_option_no_throw(name);
    const std::string type = option == nullptr ? "" : option->get_type_name();
    const char* wanted = type.compare(0, 4, "UINT") == 0  ? kNotWhole
                         : type.compare(0, 3, "INT") == 0 ? " is not a whole number, in digits"
                                                          : " is not a number";
    return name + ": '" + what.substr(equals + 3) + "'" + wanted;
}

// Where another group has a sub-command of this name, how to call it.
std::string elsewhere(const CLI::App& app, const std::string& word) {
    for (const CLI::App* group : app.get_subcommands({}))
        for (const CLI::App* command : group->get_subcommands({}))
            if (command->get_name() == word) return ": it is 'crofton " + group->get_name() + " " + word + "'";
    return {};
}

std::string reason(const CLI::App& app, const CLI::ParseError& error, const std::vector<std::string>& arguments) {
    const Chosen typed = chosen(app);
    const CLI::App& command = *typed.command;
    if (is_group(command) && arguments.size() > typed.depth) {
        const std::string& first = arguments[typed.depth];
        if (first[0] == '-')
            return "there is no option '" + first + "'" + did_you_mean(nearest_word(first, option_names(command)));
        const std::string place = elsewhere(app, first);
        return "there is no sub-command '" + first + "'" +
               (place.empty() ? did_you_mean(nearest_word(first, command_names(command))) : place);
    }
    if (dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr) return unexpected(command, arguments);
    if (dynamic_cast<const CLI::ConversionError*>(&error) != nullptr) return of_conversion(command, error.what());
    if (is_group(command)) return "a sub-command is missing";
    const std::string what = error.what();
    // "--json: 1 required FILE missing"
    if (what.find(" required ") != std::string::npos && what.size() > 8 && what.substr(what.size() - 8) == " missing")
        return what.substr(0, what.find(':')) + ": its value is missing";
    const std::size_t required = what.find(" is required");
    return what[0] == '-' || required == std::string::npos ? what
                                                           : "an argument is missing: " + what.substr(0, required);
}

std::string usage_error(const CLI::App& app, const CLI::ParseError& error, const std::vector<std::string>& arguments) {
    const Chosen typed = chosen(app);
    return "crofton: " + reason(app, error, arguments) + "\n'" + typed.name + " --help' lists " +
           (is_group(*typed.command) ? "the sub-commands.\n" : "its options, with examples.\n");
}

// After all sub-commands are added: options that take a number without sign refuse one with a minus, and one that has
// too many digits. (CLI11 2.1 reads -1 as 2⁶⁴ − 1, and 10²⁰ as well.)
void demand_whole_numbers(CLI::App& app) {
    const CLI::Validator whole(
        [](std::string& text) {
            std::uint64_t value = 0;
            const char* end = text.data() + text.size();
            const auto read = std::from_chars(text.data(), end, value);
            return read.ec == std::errc{} && read.ptr == end ? std::string{} : "'" + text + "'" + kNotWhole;
        },
        "");
    for (CLI::App* command : app.get_subcommands({})) {
        for (CLI::Option* option : command->get_options())
            if (option->get_type_name().compare(0, 4, "UINT") == 0) option->check(whole);
        demand_whole_numbers(*command);
    }
}

constexpr const char* kWritableFile = "FILE";  // the type of options that name a file to write

// Returns the file that a path leads to, so that two names of one file compare equal.
std::string place_of(const std::string& path) {
    std::error_code error;
    const auto absolute = std::filesystem::absolute(path, error);
    if (error || path == "-") return path;
    // For a link to a file that does not exist yet, this is where the file will be.
    std::filesystem::path end = absolute;
    for (int links = 0; links < 40 && !std::filesystem::exists(end, error) && std::filesystem::is_symlink(end, error);
         ++links)
        end = end.parent_path() / std::filesystem::read_symlink(end, error);
    const auto place = std::filesystem::weakly_canonical(end, error);
    return error ? absolute.lexically_normal().string() : place.string();
}

// Whether an option was given that names a file to write.
bool is_output(const CLI::Option* option) {
    return option->get_type_name() == kWritableFile && option->count() > 0;
}

// Two options that would write to one place, or nothing.
std::string shared_output(const CLI::App& command) {
    std::map<std::string, const CLI::Option*> places;
    for (const CLI::Option* option : command.get_options()) {
        if (!is_output(option)) continue;
        const auto path = option->as<std::string>();
        std::error_code error;
        if (std::filesystem::is_character_file(path, error)) continue;  // /dev/null takes any number
        const auto [other, is_new] = places.emplace(place_of(path), option);
        if (is_new) continue;
        const std::string both = other->second->get_name() + " and " + option->get_name();
        return path == "-" ? both + " cannot both go to stdout"
                           : both + " name one file, '" + path + "': one output would be lost";
    }
    return {};
}

// An output that would replace a file that is read, or nothing. Words without a dot or a slash, as town, name no file.
std::string replaced_input(const CLI::App& command) {
    std::map<std::string, std::string> inputs;  // by place
    for (const CLI::Option* option : command.get_options())
        if (option->get_type_name() != kWritableFile)
            for (const std::string& word : option->results()) {
                std::error_code error;
                if (word.find_first_of("./") != std::string::npos && std::filesystem::is_regular_file(word, error))
                    inputs.emplace(place_of(word), word);
            }
    for (const CLI::Option* option : command.get_options()) {
        if (!is_output(option)) continue;
        const auto input = inputs.find(place_of(option->as<std::string>()));
        if (input != inputs.end())
            return option->get_name() + " would replace '" + input->second + "', which is read: name another file";
    }
    return {};
}

// Numbers that `allowed` takes; neither NaN nor infinity. `name` stands in the help.
template <class Allowed>
CLI::Validator finite_number(const std::string& wanted, const std::string& name, Allowed allowed) {
    return {[wanted, allowed](std::string& text) {
                double value = 0.0;
                const bool fits = CLI::detail::lexical_cast(text, value) && std::isfinite(value) && allowed(value);
                return fits ? std::string{} : "'" + text + "' is not a number " + wanted;
            },
            name};
}

// `crofton help` and `crofton help fit` are `crofton --help` and `crofton fit --help`.
std::vector<std::string> with_help_as_option(int argc, char** argv) {
    std::vector<std::string> arguments(argv + 1, argv + argc);
    if (!arguments.empty() && arguments.front() == "help") {
        arguments.erase(arguments.begin());
        arguments.push_back("--help");
    }
    return arguments;
}

}  // namespace

Option& Option::required() {
    option_->required();
    return *this;
}

Option& Option::show_default() {
    option_->capture_default_str();
    return *this;
}

Option& Option::whole_between(std::uint64_t low, std::uint64_t high) {
    option_->check(CLI::Range(low, high));
    return *this;
}

Option& Option::between(double low, double high) {
    std::ostringstream range;
    range << "in [" << low << " - " << high << "]";
    option_->check(
        finite_number(range.str(), range.str(), [=](double value) { return low <= value && value <= high; }));
    return *this;
}

Option& Option::positive() {
    option_->check(finite_number("above 0", "POSITIVE", [](double value) { return value > 0.0; }));
    return *this;
}

Option& Option::not_negative() {
    option_->check(finite_number("from 0", "NONNEGATIVE", [](double value) { return value >= 0.0; }));
    return *this;
}

Option& Option::one_of(const std::vector<std::string>& words) {
    option_->check(CLI::IsMember(words));
    return *this;
}

Option& Option::writable_file() {
    option_->check(CLI::Validator(
        [](std::string& path) {
            return path == "-" ? std::string("'-': this output needs a file, it cannot go to stdout") : std::string{};
        },
        ""));
    return writable_file_or_stdout();
}

Option& Option::writable_file_or_stdout() {
    option_->type_name(kWritableFile)
        ->check(CLI::Validator(
            [](std::string& path) {
                const auto checked = assets::check_writable(path);
                return checked ? std::string{} : checked.error().message;
            },
            ""));
    return *this;
}

Option& Option::excludes(const Option& other) {
    option_->excludes(other.option_);
    return *this;
}

Option& Option::needs(const Option& other) {
    option_->needs(other.option_);
    return *this;
}

bool Option::given() const {
    return option_->count() > 0;
}

Option Command::option(const char* name, std::string& target, const std::string& help) {
    return Option(app_->add_option(name, target, help));
}
Option Command::option(const char* name, std::vector<std::string>& target, const std::string& help) {
    return Option(app_->add_option(name, target, help));
}
Option Command::option(const char* name, std::uint32_t& target, const std::string& help) {
    return Option(app_->add_option(name, target, help));
}
Option Command::option(const char* name, std::uint64_t& target, const std::string& help) {
    return Option(app_->add_option(name, target, help));
}
Option Command::option(const char* name, std::optional<std::uint32_t>& target, const std::string& help) {
    return Option(app_->add_option(name, target, help));
}
Option Command::option(const char* name, float& target, const std::string& help) {
    return Option(app_->add_option(name, target, help));
}
Option Command::option(const char* name, double& target, const std::string& help) {
    return Option(app_->add_option(name, target, help));
}
Option Command::flag(const char* name, bool& target, const std::string& help) {
    return Option(app_->add_flag(name, target, help));
}

void Command::footer(const std::string& text) {
    app_->footer(text);
}

void Command::action(std::function<int()> action) {
    action_with_window([action = std::move(action), app = app_] {
        const Attendant attendant(app->get_name().c_str());
        return action();
    });
}

void Command::action_with_window(std::function<int()> action) {
    app_->callback([action = std::move(action), app = app_, status = status_] {
        if (const std::string shared = shared_output(*app); !shared.empty()) throw CLI::ValidationError(shared);
        if (const std::string replaced = replaced_input(*app); !replaced.empty()) throw CLI::ValidationError(replaced);
        *status = action();
    });
}

CommandLine::CommandLine(const char* description, const std::string& version)
    : app_(std::make_unique<CLI::App>(description, "crofton")) {
    app_->set_version_flag("--version", "crofton " + version);
    app_->require_subcommand(1);
    app_->fallthrough(false);
}

CommandLine::~CommandLine() = default;

Command CommandLine::command(const char* name, const char* description) {
    return {app_->add_subcommand(name, description), &status_};
}

Command CommandLine::study_command(const char* name, const char* description) {
    if (study_ == nullptr) {
        study_ = app_->add_subcommand("study", "What the paper claims, on your data: measures, lines, light");
        study_->require_subcommand(1);
    }
    return {study_->add_subcommand(name, description), &status_};
}

int CommandLine::run(int argc, char** argv) {
    demand_whole_numbers(*app_);
    const std::vector<std::string> arguments = with_help_as_option(argc, argv);
    try {
        app_->parse(std::vector<std::string>(arguments.rbegin(), arguments.rend()));
    } catch (const CLI::ParseError& error) {
        if (error.get_exit_code() != 0) {
            print_text_to(stderr, usage_error(*app_, error, arguments));
            return kBadInput;
        }
        status_ = app_->exit(error);  // --help
    }
    // Output may still be in the buffer; a full disk shows only when it is flushed.
    if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return status_;
    print_to(stderr, "crofton: standard output: cannot write: %s\n", std::strerror(errno));
    return kBadInput;
}

}  // namespace crofton::cli
