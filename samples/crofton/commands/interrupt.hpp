// SPDX-License-Identifier: MIT
// Ctrl-C during long work: what there is by then is written, and the exit status is kInterrupted.
#pragma once

namespace crofton::cli {

// From now on the first SIGINT or SIGTERM is remembered. The second one ends the program at once.
void catch_interrupts();
[[nodiscard]] bool interrupted();

// For triangulate's and fit's progress callbacks: false ends their search.
[[nodiscard]] bool go_on(void* user, double fraction);

}  // namespace crofton::cli
