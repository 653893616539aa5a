// SPDX-License-Identifier: MIT
#include "progress_bar.hpp"

#include <unistd.h>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <mutex>

#include "assets/print.hpp"

namespace crofton::cli {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr std::size_t kBarWidth = 40;
constexpr milliseconds kFirst{2000}, kNextLine{10'000}, kNextBar{200};

struct Shown {
    std::mutex mutex;
    std::string command, label;  // the label is empty where only the command is known
    std::size_t total = 0;
    std::atomic<std::size_t> done{0};
    Clock::time_point begin = Clock::now(), next = begin + kFirst, label_begin = begin;
    const bool terminal = isatty(STDERR_FILENO) != 0;
    bool is_visible = false;  // on a terminal
};

Shown& shown() {
    static Shown state;
    return state;
}

void hide(Shown& s) {
    if (s.is_visible) std::fputs("\r\033[K", stderr);
    s.is_visible = false;
}

// How long the rest takes if it goes on as before; nothing before there is something to judge by.
std::string time_left(const Shown& s, std::size_t done) {
    const std::chrono::duration<double> passed = Clock::now() - s.label_begin;
    if (done == 0 || passed < std::chrono::milliseconds(200)) return {};
    const double left = passed.count() * static_cast<double>(s.total - done) / static_cast<double>(done);
    const bool in_minutes = left >= 100.0;
    char text[48];
    std::snprintf(text, sizeof text, ", about %.0f %s left", std::ceil(in_minutes ? left / 60.0 : left),
                  in_minutes ? "min" : "s");
    return text;
}

void print(const Shown& s) {
    const auto seconds =
        static_cast<long long>(std::chrono::duration_cast<std::chrono::seconds>(Clock::now() - s.begin).count());
    const std::size_t done = std::min(s.done.load(), s.total);
    const std::string what = s.label.empty() ? s.command : s.label;
    if (!s.terminal && s.total > 0)
        std::fprintf(stderr, "crofton: %s: %zu %% after %lld s%s\n", printable(what).c_str(), 100 * done / s.total,
                     seconds, time_left(s, done).c_str());
    else if (!s.terminal)
        std::fprintf(stderr, "crofton: %s: %lld s\n", printable(what).c_str(), seconds);
    else if (s.total > 0)
        std::fprintf(stderr, "\r%s [%s%s] %zu %%, %lld s%s\033[K\r", printable(what).c_str(),
                     std::string(kBarWidth * done / s.total, '#').c_str(),
                     std::string(kBarWidth - kBarWidth * done / s.total, '.').c_str(), 100 * done / s.total, seconds,
                     time_left(s, done).c_str());
    else
        std::fprintf(stderr, "\r%s: %lld s\033[K\r", printable(what).c_str(), seconds);
    std::fflush(stderr);
}

void say(std::string label, std::size_t total) {
    Shown& s = shown();
    const std::lock_guard<std::mutex> lock(s.mutex);
    hide(s);
    s.label = std::move(label);
    s.total = total;
    s.done = 0;
    s.label_begin = Clock::now();
}

}  // namespace

ProgressBar::ProgressBar(std::string label, std::size_t total) : total_(total) {
    say(std::move(label), total);
}

ProgressBar::~ProgressBar() {
    say({}, 0);
}

void ProgressBar::set(std::size_t done) {
    shown().done = done;
}

void ProgressBar::add(std::size_t more) {
    shown().done += more;
}

void begin_progress(const char* command) {
    Shown& s = shown();
    s.command = command;
    s.begin = s.label_begin = Clock::now();
    s.next = s.begin + kFirst;
}

milliseconds until_progress() {
    Shown& s = shown();
    const std::lock_guard<std::mutex> lock(s.mutex);
    return std::max(milliseconds(0), std::chrono::ceil<milliseconds>(s.next - Clock::now()));
}

void show_progress() {
    Shown& s = shown();
    const std::lock_guard<std::mutex> lock(s.mutex);
    if (Clock::now() < s.next) return;
    s.next = Clock::now() + (s.terminal ? kNextBar : kNextLine);
    print(s);
    s.is_visible = s.terminal;
}

void hide_progress() {
    Shown& s = shown();
    const std::lock_guard<std::mutex> lock(s.mutex);
    hide(s);
}

}  // namespace crofton::cli
