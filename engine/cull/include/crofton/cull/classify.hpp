// The one question a renderer asks of a bound: is this worth drawing?
#pragma once
#include <crofton/core/executor.hpp>
#include <crofton/geometry/frustum.hpp>
#include <crofton/geometry/obb.hpp>
#include <cstdint>
#include <span>

namespace crofton::cull {

enum class Verdict : std::uint8_t { outside, straddling, inside };

// Exact for the boxes' and planes' stored numbers: `outside` iff box and frustum are disjoint, `inside` iff the frustum
// contains the box; touching from outside is straddling.
[[nodiscard]] Verdict classify(const Frustum& frustum, const Obb& box);

// As above for many boxes: writes verdicts[i] for boxes[i]. Allocates nothing; may run on any thread.
// Requires verdicts.size() == boxes.size(). A box that is not finite is `straddling`: reported, never lost.
void classify(const Frustum& frustum, std::span<const Obb> boxes, std::span<Verdict> verdicts);

}  // namespace crofton::cull
