// SPDX-License-Identifier: MIT
// Bullet's contacts of boxes, hulls and spheres, found by Crofton: exact, and with ids that stay.
#pragma once
#include <btBulletDynamicsCommon.h>

#include <cstdint>

#include "kept_shapes.hpp"

namespace crofton::bullet {

// Points of all pairs since the last reset: in how many of the steps before a point's id had been there.
struct PointCounts {
    std::uint64_t kept = 0, begun = 0;
};

// Bullet's own configuration but for pairs of shapes that Crofton has as well. Outlives the dispatcher, and shapes
// their objects, as in Bullet.
class Configuration final : public btDefaultCollisionConfiguration {
  public:
    Configuration();
    ~Configuration() override;
    btCollisionAlgorithmCreateFunc* getCollisionAlgorithmCreateFunc(int type_a, int type_b) override;
    [[nodiscard]] PointCounts& counts() { return counts_; }

  private:
    struct Create;
    KeptShapes shapes_;
    PointCounts counts_;
    std::unique_ptr<Create> create_;
};

// For btCollisionDispatcher::setNearCallback: pairs whose boxes are apart now are left out, but for their last contact.
void skip_pairs_apart(btBroadphasePair& pair, btCollisionDispatcher& dispatcher, const btDispatcherInfo& info);

}  // namespace crofton::bullet
