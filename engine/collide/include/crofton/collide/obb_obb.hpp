// Do two oriented boxes meet? Exactly.
#pragma once
#include <crofton/geometry/obb.hpp>

namespace crofton::collide {

// True iff the two exact parallelepipeds share a point; touching counts. Filtered separating-axis test (Gottschalk, Lin,
// Manocha 1996) with a proven error bound, then exact arithmetic.
[[nodiscard]] bool intersects(const Obb& a, const Obb& b);

}  // namespace crofton::collide
