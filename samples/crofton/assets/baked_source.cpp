// SPDX-License-Identifier: MIT
#include "assets/baked_source.hpp"

#include <algorithm>
#include <cmath>
#include <crofton/bake/container.hpp>

namespace crofton::assets {
namespace {

constexpr const char* kHead = "vi_head";       // one VisitHead
constexpr const char* kWalk = "vi_walk";       // three doubles a place
constexpr const char* kRooms = "vi_rooms";     // a RoomRecord each
constexpr const char* kGlow = "vi_glow";       // a colour for each triangle of the meshes that give off light
constexpr const char* kGlowEnds = "vi_glend";  // where the colours of each mesh end

struct VisitHead {
    std::uint32_t knows_unit = 0;
    float unit = 0.0f;  // metres; older files have 0 for 1
};
struct RoomRecord {
    double corners[8] = {};  // x, z each
    double floor = 0.0, ceiling = 0.0;
    std::uint8_t is_wall[4] = {};
    std::uint8_t has_floor = 0, has_ceiling = 0;
    std::uint8_t reserved[2] = {};
};
static_assert(sizeof(RoomRecord) == 88);

Error damaged(const char* section, const char* what, std::uint64_t item = kNoItem) {
    return fail(ErrorCode::parse, item, std::string("section '") + section + "': " + what);
}

bool is_finite(const glm::dvec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

RoomRecord record_of(const Room& room) {
    RoomRecord record;
    for (std::size_t k = 0; k < 4; ++k) {
        record.corners[2 * k] = room.corners[k].x;
        record.corners[2 * k + 1] = room.corners[k].y;
        record.is_wall[k] = room.is_wall[k];
    }
    record.floor = room.floor;
    record.ceiling = room.ceiling;
    record.has_floor = room.has_floor;
    record.has_ceiling = room.has_ceiling;
    return record;
}

Room room_of(const RoomRecord& record) {
    Room room;
    for (std::size_t k = 0; k < 4; ++k) {
        room.corners[k] = {record.corners[2 * k], record.corners[2 * k + 1]};
        room.is_wall[k] = record.is_wall[k] != 0;
    }
    room.floor = record.floor;
    room.ceiling = record.ceiling;
    room.has_floor = record.has_floor != 0;
    room.has_ceiling = record.has_ceiling != 0;
    return room;
}

bool is_room(const RoomRecord& record) {
    return std::all_of(record.corners, record.corners + 8, [](double x) { return std::isfinite(x); }) &&
           std::isfinite(record.floor) && std::isfinite(record.ceiling);
}

void add_visit(const SceneSource& source, bake::Writer& writer) {
    const VisitHead head{source.unit > 0.0 ? 1u : 0u, static_cast<float>(source.unit)};
    writer.add(kHead, std::span<const VisitHead>(&head, 1));
    if (!source.walk.empty()) writer.add(kWalk, std::span<const glm::dvec3>(source.walk));
    std::vector<RoomRecord> rooms;
    for (const Room& room : source.rooms) rooms.push_back(record_of(room));
    if (!rooms.empty()) writer.add(kRooms, std::span<const RoomRecord>(rooms));
    std::vector<glm::vec3> glow;
    std::vector<std::uint64_t> ends;
    for (const std::vector<glm::vec3>& colors : source.emission) {
        glow.insert(glow.end(), colors.begin(), colors.end());
        ends.push_back(glow.size());
    }
    if (glow.empty()) return;
    writer.add(kGlow, std::span<const glm::vec3>(glow));
    writer.add(kGlowEnds, std::span<const std::uint64_t>(ends));
}

Result<void> read_glow(const bake::Reader& reader, SceneSource& source) {
    if (!reader.has(kGlow)) return {};
    const auto glow = reader.section<glm::vec3>(kGlow);
    if (!glow) return glow.error();
    const auto ends = reader.section<std::uint64_t>(kGlowEnds);
    if (!ends) return ends.error();
    if (ends->size() > source.scene.mesh_count() || ends->empty() || ends->back() != glow->size())
        return damaged(kGlowEnds, "not the scene's meshes");
    std::uint64_t begin = 0;
    source.emission.resize(ends->size());
    for (std::size_t m = 0; m < ends->size(); ++m) {
        const std::uint64_t end = (*ends)[m];
        const std::size_t triangles = source.scene.mesh(static_cast<scene::MeshId>(m)).triangle_count();
        if (end < begin || end > glow->size() || (end > begin && end - begin != triangles))
            return damaged(kGlowEnds, "not one colour for each triangle of the mesh", m);
        const auto colors = glow->subspan(begin, end - begin);
        for (const glm::vec3& color : colors)
            if (!is_finite(glm::dvec3(color)) || std::min({color.x, color.y, color.z}) < 0.0f)
                return damaged(kGlow, "a colour is no light", m);
        source.emission[m].assign(colors.begin(), colors.end());
        begin = end;
    }
    return {};
}

}  // namespace

std::vector<bake::MeshLook> looks_of(const SceneSource& source) {
    const auto flag = [](const std::vector<std::uint8_t>& flags, std::size_t mesh) {
        return mesh < flags.size() && flags[mesh] != 0;
    };
    std::vector<bake::MeshLook> looks(source.scene.mesh_count());
    for (std::size_t m = 0; m < looks.size(); ++m)
        looks[m] = {
            .one_sided = flag(source.one_sided, m), .flat = flag(source.flat, m), .unlit = flag(source.unlit, m)};
    return looks;
}

Result<Vector<std::byte>> bake_source(const SceneSource& source, Executor& executor, bake::BakeOptions options) {
    const std::vector<bake::MeshLook> looks = looks_of(source);
    options.looks = looks;
    const auto file = bake::bake(source.scene, executor, options);
    if (!file) return file;
    const auto reader = bake::Reader::open(*file, executor);
    if (!reader) return reader.error();
    bake::Writer writer;
    for (const bake::Section& section : reader->sections()) writer.copy(section, *file);
    add_visit(source, writer);
    return writer.finish();
}

Result<void> read_visit(std::span<const std::byte> file, SceneSource& source) {
    const auto reader = bake::Reader::open(file);
    if (!reader) return reader.error();
    source.unit = 0.0;  // older files do not say it
    if (reader->has(kHead)) {
        const auto head = reader->section<VisitHead>(kHead);
        if (!head) return head.error();
        if (head->size() != 1) return damaged(kHead, "not one header");
        const float unit = head->front().unit;
        if (!std::isfinite(unit) || unit < 0.0f) return damaged(kHead, "a unit of length is no length");
        if (head->front().knows_unit != 0) source.unit = unit > 0.0f ? static_cast<double>(unit) : 1.0;
    }
    if (reader->has(kWalk)) {
        const auto walk = reader->section<glm::dvec3>(kWalk);
        if (!walk) return walk.error();
        for (std::size_t i = 0; i < walk->size(); ++i)
            if (!is_finite((*walk)[i])) return damaged(kWalk, "a place is no number", i);
        source.walk.assign(walk->begin(), walk->end());
    }
    if (reader->has(kRooms)) {
        const auto rooms = reader->section<RoomRecord>(kRooms);
        if (!rooms) return rooms.error();
        for (std::size_t i = 0; i < rooms->size(); ++i) {
            if (!is_room((*rooms)[i])) return damaged(kRooms, "a room's corner or height is no number", i);
            source.rooms.push_back(room_of((*rooms)[i]));
        }
    }
    return read_glow(*reader, source);
}

}  // namespace crofton::assets
