// SPDX-License-Identifier: MIT
// Builds a MeshTree: groups triangles into leaves, splits by surface area, and fits a box to each node.
#include <algorithm>
#include <cmath>
#include <crofton/core/recovery.hpp>
#include <crofton/core/select.hpp>
#include <crofton/mesh/box_hierarchy.hpp>
#include <crofton/mesh/mesh_parts.hpp>
#include <crofton/mesh/mesh_tree.hpp>
#include <glm/geometric.hpp>
#include <numeric>
#include <utility>

#include "box_anchors.hpp"
#include "mesh_box.hpp"
#include "mesh_pieces.hpp"
#include "symmetric_eigen.hpp"

namespace crofton::mesh {
namespace {

// A leaf to be: triangles that lie side by side in the order of the splits by surface area.
struct Bunch {
    glm::vec3 centroid;
    std::uint32_t number;
    float key;
};

// Of bunches.
struct Range {
    std::size_t begin, end;
    [[nodiscard]] std::size_t size() const { return end - begin; }
};

// A range that is to become `count` children.
struct Part {
    Range range;
    std::uint32_t count;
};

// The fewest children whose subtrees, one level lower, can all be full. Empty lanes then gather near the root, where
// few nodes are, and not in the many above the leaves.
std::uint32_t child_count(std::size_t leaves) {
    std::size_t below = 1;
    while (below * kMeshNodeWidth < leaves) below *= kMeshNodeWidth;
    return static_cast<std::uint32_t>((leaves + below - 1) / below);
}

// A range that is to become a node, and where what lies below goes: the first of its nodes and of its leaves.
struct Task {
    Range range;
    std::uint32_t node, next_node, next_leaf;
};

// The children of a node.
struct Children {
    Part parts[kMeshNodeWidth];
    std::uint32_t count = 1;
};

// The bunches of a part that go to its lower half.
std::size_t lower_size(std::size_t size, std::uint32_t count) {
    return (size * (count / 2) + count / 2) / count;
}

// The nodes below a node of so many leaves. The form of a tree depends on nothing else.
std::uint32_t nodes_below(std::size_t leaves);
std::uint32_t nodes_of_part(std::size_t size, std::uint32_t count) {
    if (count == 1) return size == 1 ? 0 : 1 + nodes_below(size);
    const std::size_t lower = lower_size(size, count);
    return nodes_of_part(lower, count / 2) + nodes_of_part(size - lower, count - count / 2);
}
std::uint32_t nodes_below(std::size_t leaves) {
    if (leaves <= kMeshNodeWidth) return 0;
    return nodes_of_part(leaves, child_count(leaves));
}

// From this size on a node's children are divided on their own, perhaps at once.
constexpr std::size_t kManyBunches = 512;

}  // namespace

class MeshTreeBuilder {
  public:
    MeshTreeBuilder(const TriangleMesh& mesh, const MeshTreeOptions& options, Executor& executor)
        : mesh_(mesh), options_(options), executor_(executor), workers_(executor.concurrency()) {
        tree_.parts_ = Owner<MeshParts>::make();
    }

    Result<MeshTree> build();

  private:
    [[nodiscard]] MeshParts& made() { return *tree_.parts_; }
    void collect();
    void bunch_triangles();
    // The scratch memory of one thread.
    struct Worker {
        MeshBoxFitter fitter;
        Vector<glm::vec3> points;
        Vector<std::uint32_t> point_vertices;  // indices of points
        Vector<std::uint32_t> last_range;      // by vertex: the last range whose points it was put among
        std::uint32_t range_number = 0;
        Vector<Task> tasks;

        void begin_range(std::size_t vertices) {
            if (last_range.empty()) last_range.resize(vertices, 0);
            ++range_number;
        }
        // Whether the vertex is met for the first time in the present range.
        [[nodiscard]] bool is_new(std::uint32_t index) {
            return std::exchange(last_range[index], range_number) != range_number;
        }
    };

    void divide();
    void fit_whole(Worker& worker);
    Children split_node(const Task& task);
    Task add_child(const Task& task, const Children& children, std::uint32_t lane, Worker& worker);
    void divide_all(const Task& task, Worker& worker);
    Part split(Part& part);
    MeshBox fit(const Range& range, bool whole_mesh, Worker& worker) const;
    void add_leaf(std::uint32_t bunch, std::uint32_t number);
    [[nodiscard]] std::span<const std::uint32_t> triangles_of(std::uint32_t bunch) const {
        const BoxHierarchy::Leaf& leaf = hierarchy_.leaves[bunch];
        return std::span<const std::uint32_t>(hierarchy_.order).subspan(leaf.begin, leaf.end - leaf.begin);
    }
    void set_pieces(std::span<const std::uint32_t> triangles);
    void set_leaf_ranges(std::uint32_t node);
    [[nodiscard]] const glm::vec3& vertex(std::uint32_t triangle, std::size_t v) const {
        return mesh_.positions[mesh_.indices[3 * std::size_t{triangle} + v]];
    }

    const TriangleMesh& mesh_;
    MeshTreeOptions options_;
    Executor& executor_;
    Vector<Worker> workers_;
    MeshTree tree_;
    Vector<std::uint32_t> triangles_;  // the valid ones, ascending
    BoxHierarchy hierarchy_;           // of triangles; its leaves are the bunches
    Vector<Bunch> bunches_;
    Vector<std::uint32_t> leaf_of_;  // by bunch
    Vector<std::uint32_t> lowest_;   // by vertex, for boxes: one at the same place, or itself
    struct Vertex {
        glm::vec3 position;
        std::uint32_t index;
    };
    // The vertices of each bunch, one after the other, each once in its bunch; where those of a bunch begin.
    Vector<Vertex> bunch_vertices_;
    Vector<std::uint32_t> first_vertex_;
    Vector<std::uint32_t> piece_of_;  // by triangle
};

void MeshTreeBuilder::collect() {
    const std::size_t count = mesh_.triangle_count();
    triangles_.reserve(count);
    for (std::size_t t = 0; t < count; ++t) {
        bool usable = true;
        for (std::size_t v = 0; v < 3; ++v) {
            const std::uint32_t index = mesh_.indices[3 * t + v];
            usable = usable && index < mesh_.positions.size() && is_usable(mesh_.positions[index]);
        }
        const auto triangle = static_cast<std::uint32_t>(t);
        if (!usable) {
            tree_.rejected_.push_back(triangle);
            continue;
        }
        triangles_.push_back(triangle);
        for (std::size_t v = 0; v < 3; ++v) {
            const glm::vec3& p = vertex(triangle, v);
            tree_.extent_ = std::max({tree_.extent_, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
        }
    }
}

// Triangles whose aligned boxes together are small make a leaf: rays, and whatever else comes from a direction that
// nobody knows, meet it in proportion to its surface. All leaves are full but one.
void MeshTreeBuilder::bunch_triangles() {
    const auto box_of = [&](std::size_t i) {
        FloatBox box;
        for (std::size_t v = 0; v < 3; ++v) box.include(vertex(triangles_[i], v));
        return box;
    };
    hierarchy_ = build_box_hierarchy(triangles_.size(), box_of, kMeshLeafWidth, kMeshLeafWidth, executor_);
    for (std::uint32_t& item : hierarchy_.order) item = triangles_[item];
    bunches_.reserve(hierarchy_.leaves.size());
    first_vertex_.reserve(hierarchy_.leaves.size() + 1);
    bunch_vertices_.reserve(2 * mesh_.positions.size());
    Worker& worker = workers_.front();
    for (std::uint32_t b = 0; b < hierarchy_.leaves.size(); ++b) {
        glm::vec3 sum(0.0f);
        const std::span<const std::uint32_t> triangles = triangles_of(b);
        for (const std::uint32_t t : triangles) sum += (vertex(t, 0) + vertex(t, 1) + vertex(t, 2)) * (1.0f / 3.0f);
        bunches_.push_back({sum * (1.0f / static_cast<float>(triangles.size())), b, 0.0f});
        first_vertex_.push_back(static_cast<std::uint32_t>(bunch_vertices_.size()));
        worker.begin_range(mesh_.positions.size());
        for (const std::uint32_t t : triangles)
            for (std::size_t v = 0; v < 3; ++v)
                if (const std::uint32_t index = lowest_[mesh_.indices[3 * std::size_t{t} + v]]; worker.is_new(index))
                    bunch_vertices_.push_back({mesh_.positions[index], index});
    }
    first_vertex_.push_back(static_cast<std::uint32_t>(bunch_vertices_.size()));
    leaf_of_.resize(bunches_.size());
}

// Halves a part, in shares of its children, along the direction in which its centroids spread most; returns the upper
// half.
Part MeshTreeBuilder::split(Part& part) {
    const Range range = part.range;
    const auto begin = bunches_.begin() + static_cast<std::ptrdiff_t>(range.begin);
    const auto end = bunches_.begin() + static_cast<std::ptrdiff_t>(range.end);
    const std::size_t step = sample_step(range.size());
    const glm::dmat3 covariance = covariance_of(
        range.size() / step, [&](std::size_t i) { return begin[static_cast<std::ptrdiff_t>(i * step)].centroid; });
    const glm::dmat3 frame = eigenvectors(covariance, 2);
    int longest = 0;
    double spread = -1.0;
    for (int k = 0; k < 3; ++k) {
        const double along = glm::dot(frame[k], covariance * frame[k]);
        if (along > spread) spread = along, longest = k;
    }
    const glm::vec3 direction(frame[longest]);
    for (auto bunch = begin; bunch != end; ++bunch) bunch->key = glm::dot(bunch->centroid, direction);
    const std::uint32_t below = part.count / 2;
    const std::size_t cut = lower_size(range.size(), part.count);
    crofton::detail::select(begin, begin + static_cast<std::ptrdiff_t>(cut), end, [](const Bunch& a, const Bunch& b) {
        return a.key < b.key || (a.key == b.key && a.number < b.number);
    });
    const Part upper{{range.begin + cut, range.end}, part.count - below};
    part = {{range.begin, range.begin + cut}, below};
    return upper;
}

// Leaves the points with the worker. The whole mesh is in the bunches' first order, for its box can be made at any
// time.
MeshBox MeshTreeBuilder::fit(const Range& range, bool whole_mesh, Worker& worker) const {
    worker.begin_range(mesh_.positions.size());
    worker.points.clear();
    worker.point_vertices.clear();
    for (std::size_t b = range.begin; b < range.end; ++b) {
        const std::size_t bunch = whole_mesh ? b : bunches_[b].number;
        for (std::uint32_t i = first_vertex_[bunch]; i < first_vertex_[bunch + 1]; ++i) {
            const Vertex& vertex = bunch_vertices_[i];
            if (range.size() > 1 && !worker.is_new(vertex.index)) continue;  // a bunch has each once
            worker.points.push_back(vertex.position);
            if (options_.refittable) worker.point_vertices.push_back(vertex.index);
        }
    }
    return worker.fitter.fit(worker.points, options_.boxes, whole_mesh);
}

void MeshTreeBuilder::add_leaf(std::uint32_t bunch, std::uint32_t number) {
    MeshLeaf& leaf = made().leaves[number];
    LeafVertices* const vertices = options_.refittable ? &made().refit.leaves[number] : nullptr;
    const std::span<const std::uint32_t> triangles = triangles_of(bunch);
    leaf.count = static_cast<std::uint32_t>(triangles.size());
    for (std::size_t lane = 0; lane < kMeshLeafWidth; ++lane) {
        const std::uint32_t triangle = triangles[std::min(lane, triangles.size() - 1)];
        leaf.triangle[lane] = triangle;
        leaf.piece[lane] = piece_of_[triangle];
        for (std::size_t v = 0; v < 3; ++v) {
            const glm::vec3& p = vertex(triangle, v);
            for (int i = 0; i < 3; ++i) leaf.vertex[v][i][lane] = p[i];
            if (vertices != nullptr) vertices->vertex[v][lane] = mesh_.indices[3 * std::size_t{triangle} + v];
        }
    }
    leaf_of_[bunch] = number;
}

Children MeshTreeBuilder::split_node(const Task& task) {
    Children result;
    result.parts[0] = {task.range, child_count(task.range.size())};
    for (std::uint32_t i = 0; i < result.count; ++i)
        while (result.parts[i].count > 1) result.parts[result.count++] = split(result.parts[i]);
    made().nodes[task.node].count = result.count;
    return result;
}

// Writes a lane of a node that is split, and returns what is to be divided further: nothing below a leaf. Nodes'
// children stand side by side; behind them is what lies below the last of them, then below the one before it.
Task MeshTreeBuilder::add_child(const Task& task, const Children& children, std::uint32_t lane, Worker& worker) {
    const Range& range = children.parts[lane].range;
    MeshNode& node = made().nodes[task.node];
    const MeshBox box = fit(range, false, worker);
    for (int k = 0; k < 3; ++k) {
        node.center[k][lane] = box.center[k];
        node.half[k][lane] = box.half[k];
        for (int i = 0; i < 3; ++i) node.axes[k][i][lane] = box.axes[k][i];
    }
    if (options_.refittable)
        set_anchors(box, worker.points, worker.point_vertices, lane, made().refit.nodes[task.node]);
    Task child{range, task.next_node, task.next_node, task.next_leaf};
    std::uint32_t leaf = task.next_leaf;
    for (std::uint32_t other = 0; other < children.count; ++other) {
        const std::size_t size = children.parts[other].range.size();
        const std::uint32_t before = other < lane ? 1 : 0;
        if (size == 1) {
            leaf += before;
            ++child.next_leaf;
            continue;
        }
        child.node += before;
        ++child.next_node;
        if (other <= lane) continue;
        child.next_node += nodes_below(size);
        child.next_leaf += static_cast<std::uint32_t>(size);
    }
    if (range.size() > 1) {
        node.child[lane] = child.node;
        return child;
    }
    node.child[lane] = kMeshLeaf | leaf;
    add_leaf(bunches_[range.begin].number, leaf);
    return {};
}

// Divides down to leaves.
void MeshTreeBuilder::divide_all(const Task& all, Worker& worker) {
    worker.tasks.assign(1, all);
    while (!worker.tasks.empty()) {
        const Task task = worker.tasks.back();
        worker.tasks.pop_back();
        const Children children = split_node(task);
        for (std::uint32_t lane = 0; lane < children.count; ++lane)
            if (const Task child = add_child(task, children, lane, worker); child.range.size() > 0)
                worker.tasks.push_back(child);
    }
}

// Divides all bunches: a level of large nodes in each round, small ones down to leaves. Whatever is written has its
// place beforehand, so that it does not matter who writes it when.
void MeshTreeBuilder::divide() {
    struct Lane {
        std::size_t task;
        std::uint32_t lane;
        Task child;
    };
    made().leaves.resize(bunches_.size());
    made().nodes.resize(1 + nodes_below(bunches_.size()));
    if (options_.refittable) {
        made().refit.leaves.resize(made().leaves.size());
        made().refit.nodes.resize(made().nodes.size());
    }
    Vector<Task> tasks{{{0, bunches_.size()}, 0, 1, 0}};
    Vector<Children> children;
    Vector<Lane> lanes{{0, kMeshNodeWidth, {}}};  // the whole mesh's box, besides the first round's
    while (!tasks.empty()) {
        children.resize(tasks.size());
        crofton::detail::recoverable_for(executor_, tasks.size(), 1, [&](std::size_t begin, std::size_t end, unsigned) {
            for (std::size_t t = begin; t < end; ++t) children[t] = split_node(tasks[t]);
        });
        for (std::size_t t = 0; t < tasks.size(); ++t)
            for (std::uint32_t lane = 0; lane < children[t].count; ++lane) lanes.push_back({t, lane, {}});
        crofton::detail::recoverable_for(
            executor_, lanes.size(), 1, [&](std::size_t begin, std::size_t end, unsigned number) {
                Worker& worker = workers_[number];
                for (std::size_t i = begin; i < end; ++i) {
                    Lane& at = lanes[i];
                    if (at.lane == kMeshNodeWidth) {
                        fit_whole(worker);
                        continue;
                    }
                    at.child = add_child(tasks[at.task], children[at.task], at.lane, worker);
                    const std::size_t size = at.child.range.size();
                    if (size == 0 || size > kManyBunches) continue;
                    divide_all(at.child, worker);
                    at.child = {};
                }
            });
        tasks.clear();
        for (const Lane& lane : lanes)
            if (lane.child.range.size() > 0) tasks.push_back(lane.child);
        lanes.clear();
    }
}

void MeshTreeBuilder::fit_whole(Worker& worker) {
    made().root_box = fit({0, bunches_.size()}, true, worker);  // depths are along its axes
    if (options_.refittable) set_anchors(made().root_box, worker.points, worker.point_vertices, 0, made().refit.root);
}

void MeshTreeBuilder::set_pieces(std::span<const std::uint32_t> triangles) {
    MeshPieces found = find_pieces(mesh_, triangles);
    piece_of_.resize(mesh_.triangle_count());
    lowest_ = std::move(found.lowest);
    if (options_.refittable) std::iota(lowest_.begin(), lowest_.end(), 0u);  // they may part
    for (std::size_t t = 0; t < triangles.size(); ++t) piece_of_[triangles[t]] = found.piece[t];
    for (std::size_t p = 0; p < found.vertex.size(); ++p)
        tree_.pieces_.push_back({mesh_.positions[found.vertex[p]], found.closed[p] != 0});
    if (!options_.refittable) return;
    for (const WeldedVertex& weld : found.welds) made().refit.welds.push_back({weld.vertex, weld.lowest, weld.piece});
    for (const PartVertex& part : found.part_vertices) made().refit.witnesses.push_back({part.vertex, part.piece});
    made().refit.piece_parted.resize(found.vertex.size());
    made().loose_points.resize(found.part_vertices.size());
    made().refit.piece_vertices = std::move(found.vertex);
    made().refit.piece_closed = std::move(found.closed);
}

// Leaves are numbered subtree by subtree, so that those below a box are a range.
void MeshTreeBuilder::set_leaf_ranges(std::uint32_t index) {
    const MeshNode& node = made().nodes[index];
    BoxAnchors& anchors = made().refit.nodes[index];
    for (std::uint32_t lane = 0; lane < node.count; ++lane) {
        const std::uint32_t child = node.child[lane];
        if (child & kMeshLeaf) {
            anchors.first_leaf[lane] = child & ~kMeshLeaf;
            anchors.end_leaf[lane] = anchors.first_leaf[lane] + 1;
            continue;
        }
        set_leaf_ranges(child);
        const BoxAnchors& below = made().refit.nodes[child];
        const std::uint32_t count = made().nodes[child].count;
        anchors.first_leaf[lane] = *std::min_element(below.first_leaf, below.first_leaf + count);
        anchors.end_leaf[lane] = *std::max_element(below.end_leaf, below.end_leaf + count);
    }
}

Result<MeshTree> MeshTreeBuilder::build() {
    if (mesh_.indices.size() % 3 != 0)
        return fail(ErrorCode::invalid_argument, mesh_.indices.size(),
                    "mesh: the index count is not a multiple of three");
    if (mesh_.triangle_count() >= (std::size_t{1} << 28))
        return fail(ErrorCode::out_of_range, mesh_.triangle_count(), "mesh: 2^28 triangles or more");
    collect();
    if (triangles_.empty()) return fail(ErrorCode::empty, kNoItem, "mesh: no valid triangle");
    tree_.triangle_count_ = triangles_.size();
    set_pieces(triangles_);
    bunch_triangles();
    divide();
    if (options_.refittable) made().refit.vertex_count = mesh_.positions.size();
    if (options_.refittable) {
        set_leaf_ranges(0);
        made().refit.root.end_leaf[0] = static_cast<std::uint32_t>(made().leaves.size());
    }
    if (options_.rays) made().take_ray_nodes(std::move(hierarchy_.nodes), leaf_of_);
    return std::move(tree_);
}

MeshTree::MeshTree() = default;
MeshTree::~MeshTree() = default;

MeshTree::MeshTree(MeshTree&& other) noexcept
    : rejected_(std::move(other.rejected_)),
      pieces_(std::move(other.pieces_)),
      triangle_count_(std::exchange(other.triangle_count_, 0)),
      extent_(std::exchange(other.extent_, 0.0f)),
      parts_(std::move(other.parts_)) {}

MeshTree& MeshTree::operator=(MeshTree&& other) noexcept {
    rejected_ = std::move(other.rejected_);
    pieces_ = std::move(other.pieces_);
    triangle_count_ = std::exchange(other.triangle_count_, 0);
    extent_ = std::exchange(other.extent_, 0.0f);
    parts_ = std::move(other.parts_);
    return *this;
}

MeshTree::MeshTree(const MeshTree& other)
    : rejected_(other.rejected_),
      pieces_(other.pieces_),
      triangle_count_(other.triangle_count_),
      extent_(other.extent_),
      parts_(other.parts_ ? Owner<MeshParts>::make(*other.parts_) : Owner<MeshParts>()) {}

const MeshParts& MeshTree::parts() const {
    static const MeshParts kNone;
    return parts_ ? *parts_ : kNone;
}

MeshTree& MeshTree::operator=(const MeshTree& other) {
    return *this = MeshTree(other);
}

Result<MeshTree> MeshTree::build(const TriangleMesh& mesh, const MeshTreeOptions& options, Executor& executor) {
    return detail::recover([&]() -> Result<MeshTree> { return MeshTreeBuilder(mesh, options, executor).build(); });
}

}  // namespace crofton::mesh
