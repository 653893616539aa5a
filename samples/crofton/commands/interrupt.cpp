// SPDX-License-Identifier: MIT
#include "interrupt.hpp"

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>
#include <algorithm>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <ctime>
#include <initializer_list>
#include <mutex>
#include <optional>

#include "assets/file.hpp"
#include "command_line.hpp"
#include "progress_bar.hpp"

namespace crofton::cli {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

// After the first signal: to end the long work; at most, where others keep the processor busy; to write a file, and to
// put results together. A second signal that comes sooner than `kOneSignal` is the same one, sent to the process and to
// its group.
constexpr milliseconds kToEndWork{1600}, kAtMostToEndWork{8000}, kToFinish{120'000}, kOneSignal{300};

std::atomic<int> signals{0};
std::atomic<bool> ends_by_itself{false}, is_finishing{false};
int bell[2] = {-1, -1};  // a pipe: wakes the attendant
constexpr char kSignal = 's', kGoodbye = 'g';

static_assert(std::atomic<int>::is_always_lock_free);

void ring(char why) {
    [[maybe_unused]] const auto written = ::write(bell[1], &why, 1);
}

void on_signal(int) {
    const int kept = errno;
    signals.fetch_add(1);
    ring(kSignal);
    errno = kept;
}

[[noreturn]] void end_program() {
    hide_progress();
    std::fputs(assets::files_written() == 0 ? "crofton: interrupted: no result is written\n"
                                            : "crofton: interrupted: no more is written\n",
               stderr);
    _exit(kInterrupted);
}

// The thread that waits for signals.
class Watch {
  public:
    void run() {
        for (;;) {
            pollfd asked{bell[0], POLLIN, 0};
            ::poll(&asked, 1, static_cast<int>(next_look().count()));
            char why = 0;
            while (::read(bell[0], &why, 1) == 1) {
                if (why == kGoodbye) return;
                hear_signal();
            }
            if (first_ && Clock::now() >= deadline() && has_had_its_time()) end_if_nothing_is_written();
            show_progress();
        }
    }

  private:
    [[nodiscard]] milliseconds next_look() const {
        const milliseconds to_show = until_progress();
        if (!first_) return to_show;
        const auto left = std::chrono::ceil<milliseconds>(deadline() - Clock::now());
        return std::clamp(left, milliseconds(20), std::max(to_show, milliseconds(20)));
    }

    [[nodiscard]] Clock::time_point deadline() const {
        if (!ends_by_itself) return *first_;
        return *first_ + (is_finishing ? kToFinish : kToEndWork);
    }

    // Long work gets its time on the processor: else a busy machine would lose what there is.
    [[nodiscard]] bool has_had_its_time() const {
        if (!ends_by_itself || is_finishing || Clock::now() >= *first_ + kAtMostToEndWork) return true;
        return std::chrono::duration<double>(kToEndWork).count() * CLOCKS_PER_SEC <=
               static_cast<double>(std::clock() - used_at_first_);
    }

    void hear_signal() {
        if (first_ && Clock::now() >= *first_ + kOneSignal) end_program();
        if (!first_) first_ = Clock::now(), used_at_first_ = std::clock();
    }

    void end_if_nothing_is_written() const {
        std::unique_lock<std::mutex> quiet(assets::writing(), std::try_to_lock);
        if (quiet.owns_lock() || Clock::now() >= *first_ + kToFinish) end_program();
    }

    std::optional<Clock::time_point> first_;
    std::clock_t used_at_first_ = 0;
};

}  // namespace

Attendant::Attendant(const char* command) {
    begin_progress(command);
    if (::pipe(bell) != 0) return;  // signals end the program, as they do any other
    for (const int end : bell) {
        ::fcntl(end, F_SETFL, O_NONBLOCK);
        ::fcntl(end, F_SETFD, FD_CLOEXEC);
    }
    struct sigaction action {};
    action.sa_handler = on_signal;
    action.sa_flags = SA_RESTART;
    for (const int signal : {SIGINT, SIGTERM}) {
        struct sigaction before {};
        // A program in the background of a shell is told to ignore Ctrl-C.
        if (sigaction(signal, nullptr, &before) == 0 && before.sa_handler == SIG_IGN) continue;
        sigaction(signal, &action, nullptr);
    }
    thread_ = std::thread([] { Watch().run(); });
}

Attendant::~Attendant() {
    if (!thread_.joinable()) return;
    ring(kGoodbye);
    thread_.join();
    hide_progress();
}

void catch_interrupts() {
    ends_by_itself = true;
}

bool interrupted() {
    return signals != 0;
}

void finish_what_there_is() {
    is_finishing = true;
}

bool should_stop(void*, double) {
    return interrupted();
}

}  // namespace crofton::cli
