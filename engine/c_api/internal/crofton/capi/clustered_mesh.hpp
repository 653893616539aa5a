// SPDX-License-Identifier: MIT
// A mesh cut into clusters, as the functions of several headers see it.
#pragma once
#include <crofton/capi/modules.h>

#include <crofton/depth/clustered_mesh.hpp>

#include <crofton/capi/call.hpp>

struct crofton_clustered_mesh {
    static constexpr std::uint32_t kKind = 0x43724f0d;
    crofton::capi::Header header;
    crofton::depth::ClusteredMesh mesh;
};
