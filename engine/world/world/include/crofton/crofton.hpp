// SPDX-License-Identifier: MIT
// All that most engines need: a World, and what goes in and out of it. The modules below have their own headers.
#pragma once
#include <crofton/core/executor.hpp>
#include <crofton/core/version.hpp>
#include <crofton/world/world.hpp>
