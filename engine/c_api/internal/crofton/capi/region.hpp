// SPDX-License-Identifier: MIT
// A region, as the functions of several headers see it.
#pragma once
#include <crofton/capi/crofton.h>

#include <crofton/core/memory.hpp>
#include <crofton/world/region.hpp>
#include <cstdint>
#include <mutex>

#include <crofton/capi/clustered_mesh.hpp>

struct crofton_region {
    static constexpr std::uint32_t kKind = 0x43724f12;
    crofton::capi::Header header;
    crofton::Region region;
    mutable std::mutex mutex{};
    mutable crofton::Vector<crofton::capi::ClusterRanges> cluster_ranges{};  // by mesh; guarded
};
