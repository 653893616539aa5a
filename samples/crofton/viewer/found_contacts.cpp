// SPDX-License-Identifier: MIT
#include "found_contacts.hpp"

#include <algorithm>

namespace crofton::viewer {

template <class Contacts>
bool FoundContacts::Found<Contacts>::is_old(bool wanted, std::uint32_t frame, std::span<const InstancePair> now) {
    if (!wanted) {
        *this = {};
        return false;
    }
    if (frame == scene_frame && std::equal(now.begin(), now.end(), pairs.begin(), pairs.end())) return false;
    scene_frame = frame;
    pairs.assign(now.begin(), now.end());
    return true;
}

void FoundContacts::update(InstanceShapes& shapes, std::uint32_t scene_frame, std::span<const InstancePair> pairs,
                           bool triangles, bool hulls) {
    if (triangles_.is_old(triangles, scene_frame, pairs)) triangles_.found = shapes.triangle_contacts(pairs);
    if (hulls_.is_old(hulls, scene_frame, pairs)) hulls_.found = shapes.hull_contacts(pairs);
}

}  // namespace crofton::viewer
