// SPDX-License-Identifier: MIT
// Furniture of the office. Each piece is at the origin on y = 0 and faces +z.
#pragma once
#include "assets/town_library.hpp"

namespace crofton::assets::office {

[[nodiscard]] scene::MeshId make_desk(town::Library& library);  // 1.6 × 0.8 m, 0.74 m high, with drawers
[[nodiscard]] scene::MeshId make_chair(town::Library& library);
[[nodiscard]] scene::MeshId make_screen(town::Library& library);    // with keyboard and mouse before it
[[nodiscard]] scene::MeshId make_computer(town::Library& library);  // stands under a desk
[[nodiscard]] scene::MeshId make_desk_lamp(town::Library& library);
[[nodiscard]] scene::MeshId make_bookshelf(town::Library& library);  // 1 × 2 m, full of books
[[nodiscard]] scene::MeshId make_cabinet(town::Library& library);
[[nodiscard]] scene::MeshId make_plant(town::Library& library);
[[nodiscard]] scene::MeshId make_sofa(town::Library& library);
[[nodiscard]] scene::MeshId make_meeting_table(town::Library& library);  // 3.2 × 1.2 m
[[nodiscard]] scene::MeshId make_whiteboard(town::Library& library);     // hangs, from 0.9 m up
[[nodiscard]] scene::MeshId make_bin(town::Library& library);
[[nodiscard]] scene::MeshId make_mug(town::Library& library);
[[nodiscard]] scene::MeshId make_printer(town::Library& library);
[[nodiscard]] scene::MeshId make_kitchen(town::Library& library);        // 3 m of counters and cupboards
[[nodiscard]] scene::MeshId make_ceiling_light(town::Library& library);  // hangs down from y = 0
[[nodiscard]] scene::MeshId make_door(town::Library& library);           // a leaf that turns about the origin

}  // namespace crofton::assets::office
