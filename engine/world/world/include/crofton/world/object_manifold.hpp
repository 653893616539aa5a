// SPDX-License-Identifier: MIT
// Where a shape touches an object: the result of World::contact_manifolds.
#pragma once
#include <crofton/convex/query.hpp>
#include <crofton/world/inputs.hpp>
#include <cstdint>

namespace crofton {

struct ObjectManifold {
    ObjectHandle object;
    std::uint64_t user = 0;
    convex::Manifold manifold;  // a is the probe, b the object
};

}  // namespace crofton
