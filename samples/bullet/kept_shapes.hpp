// SPDX-License-Identifier: MIT
// Crofton's shapes of Bullet's.
#pragma once
#include <btBulletDynamicsCommon.h>

#include <crofton/convex/shape.hpp>
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

}  // namespace crofton::bullet
