// SPDX-License-Identifier: MIT
// How often operator new has been called in this program: what goes past the memory hook.
#pragma once
#include <cstddef>

namespace crofton::testing {

[[nodiscard]] std::size_t operator_news();

}  // namespace crofton::testing
