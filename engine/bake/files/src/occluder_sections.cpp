// SPDX-License-Identifier: MIT
#include <crofton/bake/occluder_sections.hpp>

#include <cmath>
#include <crofton/geometry/mesh.hpp>
#include <glm/geometric.hpp>

namespace crofton::bake {
namespace {

using occlude::FoundOccluder;
using occlude::OccluderKind;

Error bad_occluder(const char* what, std::uint64_t item) {
    return fail(ErrorCode::parse, item, {"occluders: ", what});
}

// Requires first ≤ size.
bool is_range(std::uint64_t first, std::uint64_t count, std::size_t size) {
    return count <= size - first;
}

bool is_box(const Aabb& box) {
    for (int k = 0; k < 3; ++k)
        if (!(box.min[k] <= box.max[k])) return false;
    return true;
}

// Finite, or empty as Aabb is at first.
bool is_bounds_or_none(const Aabb& box) {
    const Aabb none;
    if (box.min == none.min && box.max == none.max) return true;
    return is_box(box) && std::isfinite(glm::dot(box.min, box.min) + glm::dot(box.max, box.max));
}

bool is_measure(double value) {
    return value >= 0.0 && std::isfinite(value);
}

Result<void> check_occluder(const FoundOccluder& occluder, std::uint64_t item) {
    const bool box = occluder.kind == OccluderKind::box || occluder.kind == OccluderKind::walled;
    if (static_cast<unsigned>(occluder.kind) > static_cast<unsigned>(OccluderKind::patch) ||
        static_cast<unsigned>(occluder.sides) > static_cast<unsigned>(occlude::Sides::both))
        return bad_occluder("one is of a kind that is not known", item);
    if (box && !validate(occluder.box, item)) return bad_occluder("one's box is no box", item);
    if (!box && occluder.surface.indices.empty()) return bad_occluder("one has no triangles", item);
    if (occluder.surface.indices.empty() != occluder.surface.positions.empty() ||
        (!occluder.surface.indices.empty() && !validate(occluder.surface)))
        return bad_occluder("one's triangles are no mesh", item);
    if (!is_box(occluder.eyes_within) || !is_bounds_or_none(occluder.piece_bounds))
        return bad_occluder("one's bounds are none", item);
    if (!is_measure(occluder.mean_shadow) || !is_measure(occluder.gain))
        return bad_occluder("one's shadow is no measure", item);
    return {};
}

Result<void> check_nodes(std::span<const OccludingNode> nodes, std::size_t kinds, std::size_t node_count) {
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        if (nodes[i].node >= node_count || nodes[i].kind >= kinds)
            return bad_occluder("a node or its kind is not there", i);
        if (i > 0 && nodes[i - 1].node >= nodes[i].node) return bad_occluder("the nodes do not ascend", i);
    }
    return {};
}

struct OccluderArrays {
    Vector<OccluderRecord> records;
    Vector<glm::vec3> points;
    Vector<std::uint32_t> indices;

    void append(const FoundOccluder& occluder) {
        OccluderRecord record;
        record.box = occluder.box;
        record.piece_bounds = occluder.piece_bounds;
        record.eyes_within = occluder.eyes_within;
        record.mean_shadow = occluder.mean_shadow;
        record.gain = occluder.gain;
        record.first_point = points.size();
        record.first_index = indices.size();
        record.point_count = static_cast<std::uint32_t>(occluder.surface.positions.size());
        record.index_count = static_cast<std::uint32_t>(occluder.surface.indices.size());
        record.edges = occluder.edges;
        record.kind = static_cast<std::uint8_t>(occluder.kind);
        record.sides = static_cast<std::uint8_t>(occluder.sides);
        points.insert(points.end(), occluder.surface.positions.begin(), occluder.surface.positions.end());
        indices.insert(indices.end(), occluder.surface.indices.begin(), occluder.surface.indices.end());
        records.push_back(record);
    }
};

FoundOccluder occluder_of(const OccluderRecord& record, std::span<const glm::vec3> points,
                          std::span<const std::uint32_t> indices) {
    FoundOccluder occluder;
    occluder.kind = static_cast<OccluderKind>(record.kind);
    occluder.sides = static_cast<occlude::Sides>(record.sides);
    occluder.box = record.box;
    occluder.piece_bounds = record.piece_bounds;
    occluder.eyes_within = record.eyes_within;
    occluder.mean_shadow = record.mean_shadow;
    occluder.gain = record.gain;
    occluder.edges = record.edges;
    occluder.surface.positions.assign(points.begin(), points.end());
    occluder.surface.indices.assign(indices.begin(), indices.end());
    return occluder;
}

}  // namespace

Result<void> add_occluders(const BakedOccluders& occluders, std::size_t node_count, Writer& writer) {
    OccluderArrays arrays;
    Vector<OccluderKindRecord> kinds;
    for (const Vector<FoundOccluder>& kind : occluders.kinds) {
        kinds.push_back({static_cast<std::uint32_t>(arrays.records.size()), static_cast<std::uint32_t>(kind.size())});
        for (const FoundOccluder& occluder : kind) {
            if (auto good = check_occluder(occluder, arrays.records.size()); !good) return good;
            arrays.append(occluder);
        }
    }
    if (auto good = check_nodes(occluders.nodes, kinds.size(), node_count); !good) return good;
    writer.add("occluder", std::span<const OccluderRecord>(arrays.records));
    writer.add("occkinds", std::span<const OccluderKindRecord>(kinds));
    writer.add("occnodes", std::span<const OccludingNode>(occluders.nodes));
    writer.add("occpoint", std::span<const glm::vec3>(arrays.points));
    writer.add("occindex", std::span<const std::uint32_t>(arrays.indices));
    return {};
}

Result<std::optional<BakedOccluders>> read_occluders(const Reader& reader, std::size_t node_count) {
    if (!reader.has("occluder")) return std::optional<BakedOccluders>();
    const auto records = reader.section<OccluderRecord>("occluder");
    const auto kinds = reader.section<OccluderKindRecord>("occkinds");
    const auto nodes = reader.section<OccludingNode>("occnodes");
    const auto points = reader.section<glm::vec3>("occpoint");
    const auto indices = reader.section<std::uint32_t>("occindex");
    if (!records) return records.error();
    if (!kinds) return kinds.error();
    if (!nodes) return nodes.error();
    if (!points) return points.error();
    if (!indices) return indices.error();

    BakedOccluders result;
    // Ranges follow one another: else a small file could name one range a million times.
    std::uint64_t next = 0, next_point = 0, next_index = 0;
    for (std::size_t k = 0; k < kinds->size(); ++k) {
        const OccluderKindRecord& kind = (*kinds)[k];
        if (kind.first != next || !is_range(kind.first, kind.count, records->size()))
            return bad_occluder("a kind's do not follow those of the kind before", k);
        next += kind.count;
        Vector<FoundOccluder>& list = result.kinds.emplace_back();
        for (std::size_t i = kind.first; i < next; ++i) {
            const OccluderRecord& record = (*records)[i];
            if (record.first_point != next_point || record.first_index != next_index ||
                !is_range(next_point, record.point_count, points->size()) ||
                !is_range(next_index, record.index_count, indices->size()))
                return bad_occluder("one's triangles are not in their place", i);
            next_point += record.point_count;
            next_index += record.index_count;
            list.push_back(occluder_of(record, points->subspan(record.first_point, record.point_count),
                                       indices->subspan(record.first_index, record.index_count)));
            if (auto good = check_occluder(list.back(), i); !good) return good.error();
        }
    }
    if (auto good = check_nodes(*nodes, kinds->size(), node_count); !good) return good.error();
    result.nodes.assign(nodes->begin(), nodes->end());
    return std::optional<BakedOccluders>(std::move(result));
}

}  // namespace crofton::bake
