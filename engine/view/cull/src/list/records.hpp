// SPDX-License-Identifier: MIT
// The record of a bound: its compressed form in a list.
#pragma once
#include <crofton/cull/list_layout.hpp>
#include <crofton/geometry/box.hpp>
#include <crofton/geometry/shapes.hpp>

namespace crofton::cull {

// A sphere that contains the bound, in double: radius rounded up, centre to the nearest (the radius makes up for it).
[[nodiscard]] Sphere sphere_around(const Obb& box);
[[nodiscard]] Sphere sphere_around(const Aabb& box);
[[nodiscard]] Sphere sphere_around(const Sphere& sphere);

// The record of a bound; `offset` is its centre relative to the chunk's origin.
[[nodiscard]] BoxRecord record_of(const Obb& box, const glm::dvec3& offset);
[[nodiscard]] AabbRecord record_of(const Aabb& box, const glm::dvec3& offset);
[[nodiscard]] SphereRecord record_of(const Sphere& sphere, const glm::dvec3& offset);

// A record of which no view's filter decides anything, for bounds that are not valid.
template <class Record>
[[nodiscard]] Record undecidable_record();
template <>
BoxRecord undecidable_record();
template <>
AabbRecord undecidable_record();
template <>
SphereRecord undecidable_record();

}  // namespace crofton::cull
