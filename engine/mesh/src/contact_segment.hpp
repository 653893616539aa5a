// SPDX-License-Identifier: MIT
// The common segment of two triangles of which it is known which edges pass through which.
#pragma once
#include <crofton/mesh/mesh_query.hpp>
#include <cstdint>

namespace crofton::mesh {

// contact_segment(a, b), to the bit, without asking for exact signs: `edges` are those of PairVisitor. 0: not known.
[[nodiscard]] SegmentOfContact contact_segment(const Triangle& a, const Triangle& b, std::uint32_t edges);

}  // namespace crofton::mesh
