// SPDX-License-Identifier: MIT
// The checksum of stored states, and the fingerprint of what they belong to: FNV-1a, which begins with the caller's
// number.
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>

namespace crofton::radiosity {

inline std::uint64_t fnv1a(std::uint64_t hash, std::span<const std::byte> bytes) {
    for (const std::byte b : bytes) hash = (hash ^ static_cast<std::uint64_t>(b)) * 1099511628211u;
    return hash;
}

}  // namespace crofton::radiosity
