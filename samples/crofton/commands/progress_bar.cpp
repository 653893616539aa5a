// SPDX-License-Identifier: MIT
#include "progress_bar.hpp"

#include <unistd.h>
#include <algorithm>
#include <cstdio>

namespace crofton::cli {
namespace {
constexpr std::size_t kBarWidth = 40;
}

ProgressBar::ProgressBar(std::string label, std::size_t total)
    : label_(std::move(label)), total_(std::max<std::size_t>(1, total)), terminal_(isatty(STDERR_FILENO) != 0) {
    set(0);
}

ProgressBar::~ProgressBar() {
    if (terminal_) std::fputs("\r\033[K", stderr);
}

void ProgressBar::set(std::size_t done) {
    const std::size_t width = std::min(kBarWidth, kBarWidth * done / total_);
    if (!terminal_ || width == shown_) return;
    shown_ = width;
    std::fprintf(stderr, "\r%s [%s%s] %zu/%zu", label_.c_str(), std::string(width, '#').c_str(),
                 std::string(kBarWidth - width, '.').c_str(), std::min(done, total_), total_);
    std::fflush(stderr);
}

}  // namespace crofton::cli
