// SPDX-License-Identifier: MIT
// Ctrl-C (SIGINT) and SIGTERM during long work: it ends within two seconds, and the exit status is kInterrupted.
#pragma once
#include <thread>

namespace crofton::cli {

// Watches over a sub-command while it lives, by a thread of its own: shows how far long work is (progress_bar.hpp), and
// ends the program where the user wants that. Files that are being written are finished first.
class Attendant {
  public:
    explicit Attendant(const char* command);
    ~Attendant();
    Attendant(const Attendant&) = delete;
    Attendant& operator=(const Attendant&) = delete;

  private:
    std::thread thread_;
};

// From now on the first SIGINT or SIGTERM is remembered, so that the command can end by itself and write what there is.
// It has less than two seconds to call finish_what_there_is(), or it is ended with nothing more written. Before this is
// called the first signal ends the program at once. A second one always does.
void catch_interrupts();
[[nodiscard]] bool interrupted();

// To be called when the long work is over, before its results are put together and written: that may take its time.
void finish_what_there_is();

// A crofton::StopCallback: stops the engine's work once the command is interrupted.
[[nodiscard]] bool should_stop(void* user, double share_done);

}  // namespace crofton::cli
