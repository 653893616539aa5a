// SPDX-License-Identifier: MIT
// How far long work is, on stderr: a bar where that is a terminal, else a line after two seconds and every ten.
#pragma once
#include <chrono>
#include <cstddef>
#include <string>

namespace crofton::cli {

// Shows what is being done, as long as it lives. Any thread may set the text.
class ProgressBar {
  public:
    explicit ProgressBar(std::string label, std::size_t total = 0);  // 0: nobody knows how much there is to do
    ~ProgressBar();                                                  // hides it
    ProgressBar(const ProgressBar&) = delete;
    ProgressBar& operator=(const ProgressBar&) = delete;

    void set(std::size_t done);
    void add(std::size_t more);

  private:
    std::size_t total_ = 0;
};

// For the attendant of a command (interrupt.hpp), which does the showing.
void begin_progress(const char* command);
[[nodiscard]] std::chrono::milliseconds until_progress();  // to the next call that would show something
void show_progress();
void hide_progress();

}  // namespace crofton::cli
