// SPDX-License-Identifier: MIT
#include "quake3_level.hpp"

#include <algorithm>
#include <cstring>
#include <glm/geometric.hpp>
#include <utility>

namespace crofton::bench {
namespace {

// Version 46 of the format, as its compiler writes it (q3map, qfiles.h): 17 tables of records.
enum Table : std::size_t {
    kShaders = 1,
    kPlanes,
    kNodes,
    kLeaves,
    kModels = 7,
    kVertices = 10,
    kIndices,
    kSurfaces = 13,
    kVisibility = 16,
    kTables
};
constexpr std::uint32_t kTranslucent = 0x20000000;   // of a shader's contents
constexpr std::int32_t kPlanar = 1, kTriangles = 3;  // types of surfaces

struct ShaderRecord {
    char name[64];
    std::uint32_t flags, contents;
};
struct PlaneRecord {
    float normal[3], distance;
};
struct NodeRecord {
    std::int32_t plane, children[2], low[3], high[3];
};
struct LeafRecord {
    std::int32_t cluster, area, low[3], high[3], rest[4];
};
struct ModelRecord {
    float low[3], high[3];
    std::int32_t first_surface, surfaces, first_brush, brushes;
};
struct VertexRecord {
    float position[3], rest[7];
    std::uint8_t color[4];
};
struct SurfaceRecord {
    std::int32_t shader, fog, type, first_vertex, vertices, first_index, indices, rest[19];
};
static_assert(sizeof(ShaderRecord) == 72 && sizeof(LeafRecord) == 48 && sizeof(SurfaceRecord) == 104);

tl::unexpected<Error> damaged(const char* what) {
    return fail(ErrorCode::parse, kNoItem, {"level: ", what});
}

class Reader {
  public:
    explicit Reader(std::span<const std::byte> file) : file_(file) {}

    Result<Quake3Level> read() {
        if (file_.size() < 8 + 8 * kTables || std::memcmp(file_.data(), "IBSP\x2e\0\0\0", 8) != 0)
            return damaged("not of version 46 of Quake III's format");
        if (!read_tree()) return damaged("its tree is damaged");
        if (!read_mesh()) return damaged("its surfaces are damaged");
        const auto sizes = table<std::int32_t>(kVisibility);
        if (sizes.size() < 2 || sizes[0] <= 0) return fail(ErrorCode::empty, kNoItem, "level: it has no visible sets");
        level_.clusters = static_cast<std::size_t>(sizes[0]);
        level_.row_bytes = static_cast<std::size_t>(sizes[1]);
        level_.visible = table<std::uint8_t>(kVisibility, 8);
        if (level_.row_bytes * 8 < level_.clusters || level_.visible.size() < level_.row_bytes * level_.clusters)
            return damaged("its visible sets are damaged");
        for (const std::int32_t cluster : level_.leaf_clusters)
            if (cluster >= sizes[0]) return damaged("a leaf of no cluster");
        return std::move(level_);
    }

  private:
    template <class T>
    std::vector<T> table(std::size_t which, std::size_t skip = 0) const {
        std::int32_t place[2];
        std::memcpy(place, file_.data() + 8 + 8 * which, sizeof place);
        const auto begin = static_cast<std::size_t>(place[0]), size = static_cast<std::size_t>(place[1]);
        if (place[0] < 0 || place[1] < 0 || begin > file_.size() || size > file_.size() - begin || size < skip)
            return {};
        std::vector<T> records((size - skip) / sizeof(T));
        if (!records.empty()) std::memcpy(records.data(), file_.data() + begin + skip, records.size() * sizeof(T));
        return records;
    }

    // Children come after their parents, as compilers write them: so that walks end.
    bool read_tree() {
        const auto planes = table<PlaneRecord>(kPlanes);
        const auto leaves = table<LeafRecord>(kLeaves);
        for (const LeafRecord& leaf : leaves) level_.leaf_clusters.push_back(leaf.cluster);
        for (const NodeRecord& node : table<NodeRecord>(kNodes)) {
            if (node.plane < 0 || static_cast<std::size_t>(node.plane) >= planes.size()) return false;
            const PlaneRecord& plane = planes[static_cast<std::size_t>(node.plane)];
            for (const std::int32_t child : node.children) {
                if (child >= 0 && static_cast<std::size_t>(child) <= level_.nodes.size()) return false;
                if (child < 0 && static_cast<std::size_t>(-1 - child) >= leaves.size()) return false;
            }
            level_.nodes.push_back({{plane.normal[0], plane.normal[1], plane.normal[2]},
                                    plane.distance,
                                    {node.children[0], node.children[1]}});
        }
        for (const Quake3Level::Node& node : level_.nodes)
            for (const std::int32_t child : node.children)
                if (child >= 0 && static_cast<std::size_t>(child) >= level_.nodes.size()) return false;
        return !level_.nodes.empty();
    }

    bool read_mesh() {
        const auto shaders = table<ShaderRecord>(kShaders);
        const auto models = table<ModelRecord>(kModels);
        const auto vertices = table<VertexRecord>(kVertices);
        const auto indices = table<std::int32_t>(kIndices);
        const auto surfaces = table<SurfaceRecord>(kSurfaces);
        if (models.empty()) return false;
        for (const VertexRecord& v : vertices)
            level_.mesh.positions.push_back({v.position[0], v.position[1], v.position[2]});
        const std::int64_t first = models[0].first_surface, last = first + models[0].surfaces;  // others move: doors
        for (std::int64_t s = first; s < last; ++s) {
            if (s < 0 || static_cast<std::size_t>(s) >= surfaces.size()) return false;
            const SurfaceRecord& surface = surfaces[static_cast<std::size_t>(s)];
            if (surface.shader < 0 || static_cast<std::size_t>(surface.shader) >= shaders.size()) return false;
            if (surface.type != kPlanar && surface.type != kTriangles) continue;
            if (shaders[static_cast<std::size_t>(surface.shader)].contents & kTranslucent) continue;
            for (std::int64_t i = surface.first_index; i < std::int64_t{surface.first_index} + surface.indices; ++i) {
                if (i < 0 || static_cast<std::size_t>(i) >= indices.size()) return false;
                const std::int64_t v = std::int64_t{surface.first_vertex} + indices[static_cast<std::size_t>(i)];
                if (v < 0 || static_cast<std::size_t>(v) >= vertices.size()) return false;
                level_.mesh.indices.push_back(static_cast<std::uint32_t>(v));
            }
            level_.mesh.indices.resize(level_.mesh.indices.size() / 3 * 3);
        }
        return !level_.mesh.indices.empty();
    }

    std::span<const std::byte> file_;
    Quake3Level level_;
};

}  // namespace

void Quake3Level::walk(const glm::dvec3& origin, const glm::dvec3& direction, double begin, double end,
                       std::vector<Stretch>& passed) const {
    struct Task {
        std::int32_t place;
        double begin, end;
    };
    std::vector<Task> open{{0, begin, end}};
    while (!open.empty()) {
        Task task = open.back();
        open.pop_back();
        while (task.place >= 0) {
            const Node& node = nodes[static_cast<std::size_t>(task.place)];
            const double at = glm::dot(node.normal, origin) - node.distance, rate = glm::dot(node.normal, direction);
            const double a = at + rate * task.begin, b = at + rate * task.end;
            const int near = a + b > 0.0 ? 0 : 1;
            if ((a >= 0.0) == (b >= 0.0) || rate == 0.0) {
                task.place = node.children[near];
                continue;
            }
            const double middle = std::clamp(-at / rate, task.begin, task.end);
            const int first = a >= 0.0 ? 0 : 1;
            open.push_back({node.children[1 - first], middle, task.end});
            task = {node.children[first], task.begin, middle};
        }
        if (task.end > task.begin)
            passed.push_back({leaf_clusters[static_cast<std::size_t>(-1 - task.place)], task.begin, task.end});
    }
}

Result<Quake3Level> read_quake3_level(std::span<const std::byte> file) {
    return Reader(file).read();
}

}  // namespace crofton::bench
