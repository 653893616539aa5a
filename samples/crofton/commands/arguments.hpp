// What a person types, checked before any work starts, and what is said when it was mistyped.
#pragma once
#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace crofton::cli {

// Of `known`, the word that `typed` was most likely meant to be: at most two letters added, left out, replaced or
// swapped, and fewer than half of them. Empty where there is none.
[[nodiscard]] std::string nearest_word(const std::string& typed, const std::vector<std::string>& known);

// For options that name a file to write: refuses a folder, and a place where nothing can be written; "-" is stdout.
[[nodiscard]] CLI::Validator writable_file();

// After all sub-commands are added: options that take a number without sign refuse one with a minus, and one that has
// too many digits. (CLI11 2.1 reads -1 as 2⁶⁴ − 1, and 10²⁰ as well.)
void demand_whole_numbers(CLI::App& app);

// `crofton help` and `crofton help fit` are `crofton --help` and `crofton fit --help`.
[[nodiscard]] std::vector<std::string> with_help_as_option(int argc, char** argv);

// One line that says which argument is wrong and why, and one that says where the right ones are listed.
[[nodiscard]] std::string usage_error(const CLI::App& app, const CLI::ParseError& error,
                                      const std::vector<std::string>& arguments);

}  // namespace crofton::cli
