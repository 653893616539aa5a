// SPDX-License-Identifier: MIT
// A progress bar on stderr, where that is a terminal; silent otherwise.
#pragma once
#include <cstddef>
#include <string>

namespace crofton::cli {

class ProgressBar {
  public:
    ProgressBar(std::string label, std::size_t total);
    ~ProgressBar();  // clears the line
    ProgressBar(const ProgressBar&) = delete;
    ProgressBar& operator=(const ProgressBar&) = delete;

    void set(std::size_t done);

  private:
    std::string label_;
    std::size_t total_;
    std::size_t shown_ = ~std::size_t{0};  // width last drawn
    bool terminal_;
};

}  // namespace crofton::cli
