// SPDX-License-Identifier: MIT
// Bullet's contacts of boxes, hulls and spheres, found by Crofton: exact, and with ids that stay.
#pragma once
#include <btBulletDynamicsCommon.h>
#include <crofton/convex/shape.hpp>
#include <cstdint>
#include <memory>
#include <optional>
#include <unordered_map>

namespace crofton::bullet {

// A shape with what it is a view of.
struct KeptShape {
    std::optional<convex::Hull> hull;
    std::optional<convex::Shape> shape;
    std::size_t fingerprint = 0;  // of the shape's numbers when it was made
};

// Whether `get` has a shape for shapes of this type: boxes, hulls, spheres.
[[nodiscard]] bool has_shape(int shape_type);

// Each is made once, and again where its numbers have changed.
class KeptShapes {
  public:
    // Nothing where Crofton refuses the shape, as points in one plane.
    [[nodiscard]] std::shared_ptr<const KeptShape> get(const btCollisionShape& shape);

  private:
    std::unordered_map<const btCollisionShape*, std::shared_ptr<const KeptShape>> shapes_;
};

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
