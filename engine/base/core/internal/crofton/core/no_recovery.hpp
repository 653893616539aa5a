// SPDX-License-Identifier: MIT
// Marks the time in which a thread runs the host's code.
#pragma once

namespace crofton::detail {

// While one lives, this thread runs a host's code, which may run anything else meanwhile. A failed allocation there
// belongs to none of the operations that are under way here. Nothing is thrown through the host's frames.
class NoRecovery {
  public:
    NoRecovery();
    ~NoRecovery();
    NoRecovery(const NoRecovery&) = delete;
    NoRecovery& operator=(const NoRecovery&) = delete;

  private:
    int recoveries_;
};

}  // namespace crofton::detail
