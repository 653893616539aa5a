// SPDX-License-Identifier: MIT
#include "hidden_pairs.hpp"

#include <algorithm>
#include <atomic>
#include <crofton/core/recovery.hpp>
#include <crofton/core/stop_signal.hpp>
#include <glm/geometric.hpp>
#include <optional>

#include "box_groups.hpp"
#include "cell_walk.hpp"
#include "surface.hpp"
#include "surface_cut.hpp"

namespace crofton::pvs {
namespace {

// Relative to the margin: a thousand million times the rounding of what is computed from such coordinates.
constexpr double kMargin = 1e-9;
// Relative to it too: ten times the rounding of single precision, in which triangles are.
constexpr double kGap = 1e-6;
// The surface is asked about groups of so many at most, and triangle by triangle about objects of so many.
constexpr std::uint32_t kFewCells = 8, kFewObjects = 64;
constexpr std::size_t kFewTriangles = 64;

// Part of an object, its box or one of its triangles: halves are proved one by one.
struct Part {
    glm::dvec3 center{0.0};
    std::array<glm::dvec3, 3> half{};  // of a box
    std::optional<std::array<glm::dvec3, 3>> triangle;

    [[nodiscard]] Corners corners() const {
        Corners c;
        for (unsigned i = 0; i < 8; ++i) {
            c[i] = triangle ? (*triangle)[i % 3] : center;
            for (unsigned k = 0; k < 3 && !triangle; ++k) c[i] += (i >> k & 1 ? 1.0 : -1.0) * half[k];
        }
        return c;
    }

    // Returns the longest half axis of a box, or the longest side of a triangle: 0, 1 or 2.
    [[nodiscard]] std::size_t longest() const {
        std::size_t best = 0;
        for (std::size_t i = 1; i < 3; ++i)
            if (length(i) > length(best)) best = i;
        return best;
    }
    // Half of a box's extent or of a triangle's side.
    [[nodiscard]] double length(std::size_t i) const {
        return triangle ? 0.5 * glm::distance((*triangle)[i], (*triangle)[(i + 1) % 3]) : glm::length(half[i]);
    }

    [[nodiscard]] Part halved(std::size_t i, bool upper) const {
        Part part = *this;
        if (triangle) {
            const glm::dvec3 middle = 0.5 * ((*triangle)[i] + (*triangle)[(i + 1) % 3]);
            (*part.triangle)[upper ? i : (i + 1) % 3] = middle;
        } else {
            part.half[i] *= 0.5;
            part.center += (upper ? 1.0 : -1.0) * part.half[i];
        }
        return part;
    }
};

// Where eyes may be: a cell, half of one, or the box around several.
struct Eyes {
    Aabb box;
    Corners corners;
    bool is_box = true;

    explicit Eyes(const Aabb& of) : box(of), corners(corners_of(of)) {}
    Eyes(const Aabb& around, const Corners& hull) : box(around), corners(hull), is_box(false) {}
};

struct Question {
    const Bake::State& bake;
    std::span<const Blocker> bodies;
    const ProofOptions& options;
    const BoxGroups &cells, &objects, &tree;                 // of the cells' boxes, the objects', the bodies'
    Vector<Part> parts;                                      // by object: its box
    const Vector<std::uint32_t>&first_triangle, &triangles;  // by object
    const Surface* surface;                                  // nullptr: bodies alone
    CutOptions cut;
    double margin;
    crofton::detail::StopSignal& stop;
    std::atomic<std::uint64_t>& answered;  // pairs
    double pairs;
};

// One thread's work on some of the cells.
class Prover {
  public:
    Prover(const Question& question, Vector<std::uint64_t>& open) : q_(question), open_(open) {
        if (!q_.surface) return;
        cut_.emplace(*q_.surface, q_.cut);
        failed_.assign(q_.bake.boxes.size(), 0);
    }

    void prove(std::uint32_t cells, std::uint32_t objects) {
        const auto& from = q_.cells[cells];
        const auto& group = q_.objects[objects];
        const bool single = group.count == 1;
        if (is_stopped()) return;
        if (from.count == 1 && single && is_seen(from, group)) return count(from, group);
        const Corners corners = single ? q_.parts[q_.objects.items(group)[0]].corners() : corners_of(group.box);
        const Eyes eyes = from.count == 1 ? eyes_of(q_.cells.items(from)[0], from.box) : Eyes(from.box);
        const bool is_small = from.count <= kFewCells && group.count <= kFewObjects;
        const Answer found =
            eyes.is_box && intersects(eyes.box, group.box) ? Answer::open : ask(eyes, corners, is_small);
        if (found == Answer::blocked) return hide(from, group);
        if (from.count == 1 && single) {
            const std::uint32_t object = q_.objects.items(group)[0];
            if ((found == Answer::partly && prove_halves(eyes, q_.parts[object], q_.options.halvings)) ||
                prove_triangles(eyes, object))
                return hide(from, group);
            return count(from, group);
        }
        const bool halve_cells = !single ? from.count > 1 && size_of(from.box) >= size_of(group.box) : true;
        for (std::uint32_t half = 0; half < 2; ++half)
            halve_cells ? prove(from.child + half, objects) : prove(cells, group.child + half);
    }

  private:
    [[nodiscard]] Eyes eyes_of(std::uint32_t cell, const Aabb& box) const {
        const Cells& cells = q_.bake.cells;
        if (!cells.is_convex()) return Eyes(box);
        Corners corners = cells.corners(cell).corners;
        for (glm::dvec3& p : corners) p -= q_.bake.origin;
        return {box, corners};
    }
    static double size_of(const Aabb& box) { return glm::length(box.max - box.min); }

    [[nodiscard]] bool is_seen(const BoxGroups::Group& cell, const BoxGroups::Group& object) const {
        const Found& found = q_.bake.found;
        const std::uint32_t o = q_.objects.items(object)[0];
        return found.seen[q_.cells.items(cell)[0] * found.words() + o / 64] >> (o % 64) & 1;
    }

    [[nodiscard]] bool is_stopped() {
        const auto answered = static_cast<double>(q_.answered.load(std::memory_order_relaxed));
        return q_.stop.is_raised((std::min)(1.0, answered / q_.pairs));
    }
    void count(const BoxGroups::Group& cells, const BoxGroups::Group& objects) {
        q_.answered.fetch_add(std::uint64_t{cells.count} * objects.count, std::memory_order_relaxed);
    }

    // As hidden: those that no line has seen.
    void hide(const BoxGroups::Group& cells, const BoxGroups::Group& objects) {
        count(cells, objects);
        const Found& found = q_.bake.found;
        for (const std::uint32_t c : q_.cells.items(cells))
            for (const std::uint32_t o : q_.objects.items(objects)) {
                const std::size_t word = c * found.words() + o / 64;
                open_[word] &= ~(std::uint64_t{1} << (o % 64)) | found.seen[word];
            }
    }

    enum class Answer {
        blocked,  // all segments meet one body
        partly,   // the one between the middles meets a body
        open,     // it meets none: no halving can help
    };

    // Bodies are asked first: they cost less.
    [[nodiscard]] Answer ask(const Eyes& eyes, const Corners& object, bool with_surface = true) {
        if (is_stopped()) return Answer::open;
        const Answer answer = ask_bodies(eyes, object);
        if (answer == Answer::blocked || !cut_ || !with_surface) return answer;
        const SurfaceCut::Answer cut = cut_->ask(eyes.corners, object);
        if (cut == SurfaceCut::Answer::cut) return Answer::blocked;
        return cut == SurfaceCut::Answer::partly ? Answer::partly : answer;
    }

    // The last body that blocked is asked first, then all that the segment between the middles meets.
    [[nodiscard]] Answer ask_bodies(const Eyes& eyes, const Corners& object) {
        if (q_.bodies.empty()) return Answer::open;
        const auto blocks_eyes = [&](const Blocker& body) {
            return may_prove_for(body, eyes.box, q_.options.near_radius, q_.margin) &&
                   blocks_all(body, eyes.corners, object, q_.margin);
        };
        if (last_ < q_.bodies.size() && blocks_eyes(q_.bodies[last_])) return Answer::blocked;
        glm::dvec3 middle(0.0);
        for (const glm::dvec3& p : object) middle += 0.125 * p;
        glm::dvec3 start(0.0);
        for (const glm::dvec3& p : eyes.corners) start += 0.125 * p;
        const Line line{start, middle - start};  // of any length: 0 ≤ t ≤ 1 is the segment
        Answer answer = Answer::open;
        stack_.assign(1, BoxGroups::kRoot);
        while (!stack_.empty()) {
            const auto& node = q_.tree[stack_.back()];
            stack_.pop_back();
            double begin = 0.0, end = 0.0;
            if (!clip(line, node.box, begin, end) || begin > 1.0 || end < 0.0) continue;
            if (node.count > 1) {
                stack_.push_back(node.child);
                stack_.push_back(node.child + 1);
                continue;
            }
            const std::uint32_t body = q_.tree.items(node)[0];
            if (!blocks(q_.bodies[body], start, middle, q_.margin)) continue;
            answer = Answer::partly;
            if (body != last_ && blocks_eyes(q_.bodies[body])) {
                last_ = body;
                return Answer::blocked;
            }
        }
        return answer;
    }

    [[nodiscard]] bool prove_halves(const Eyes& eyes, const Part& object, std::uint32_t halvings) {
        if (halvings == 0) return false;
        const glm::dvec3 e = 0.5 * (eyes.box.max - eyes.box.min);
        const int k = e.x >= e.y ? (e.x >= e.z ? 0 : 2) : (e.y >= e.z ? 1 : 2);
        const std::size_t widest = object.longest();
        const bool halve_eyes = eyes.is_box && e[k] >= object.length(widest);
        for (const bool upper : {false, true}) {
            Aabb half_box = eyes.box;
            if (halve_eyes) (upper ? half_box.min : half_box.max)[k] = eyes.box.center()[k];
            const Eyes part_of_eyes = halve_eyes ? Eyes(half_box) : eyes;
            const Part part = halve_eyes ? object : object.halved(widest, upper);
            const Answer answer = ask(part_of_eyes, part.corners());
            if (answer == Answer::open) return false;
            if (answer == Answer::partly && !prove_halves(part_of_eyes, part, halvings - 1)) return false;
        }
        return true;
    }

    // Triangle by triangle, that on which the object failed last before the others.
    [[nodiscard]] bool prove_triangles(const Eyes& eyes, std::uint32_t object) {
        const auto triangles =
            std::span(q_.triangles)
                .subspan(q_.first_triangle[object], q_.first_triangle[object + 1] - q_.first_triangle[object]);
        if (!cut_ || triangles.empty() || triangles.size() > kFewTriangles) return false;
        for (std::size_t i = 0; i < triangles.size(); ++i) {
            const std::size_t at = (failed_[object] + i) % triangles.size();
            Part part;
            part.triangle.emplace();
            for (std::size_t k = 0; k < 3; ++k)
                (*part.triangle)[k] = glm::dvec3(q_.bake.mesh.positions[q_.bake.mesh.indices[3 * triangles[at] + k]]);
            const Answer answer = ask(eyes, part.corners());
            if (answer == Answer::blocked ||
                (answer == Answer::partly && prove_halves(eyes, part, q_.options.halvings)))
                continue;
            failed_[object] = static_cast<std::uint32_t>(at);
            return false;
        }
        return true;
    }

    const Question& q_;
    Vector<std::uint64_t>& open_;
    std::optional<SurfaceCut> cut_;
    Vector<std::uint32_t> failed_;  // by object: the triangle
    Vector<std::uint32_t> stack_;
    std::uint32_t last_ = ~std::uint32_t{0};
};

}  // namespace

void prove_hidden(const Bake::State& bake, std::span<const Blocker> bodies, const ProofOptions& options,
                  Executor& executor, Vector<std::uint64_t>& open) {
    if (bodies.empty() && options.surface_steps == 0) return;
    crofton::detail::StopSignal stop(options.should_stop, options.user);
    if (stop.is_raised(0.0)) return;
    std::atomic<std::uint64_t> answered{0};
    const double margin = kMargin * bake.extent + 1e-13 * glm::length(bake.origin);
    Vector<Aabb> cells, objects, bounds;
    Vector<Part> parts;
    for (std::size_t c = 0; c < bake.cells.size(); ++c)
        cells.push_back({bake.cells.box(c).min - bake.origin - margin, bake.cells.box(c).max - bake.origin + margin});
    for (const Obb& box : bake.boxes) {
        Part part;
        part.center = box.center - bake.origin;
        for (std::size_t k = 0; k < 3; ++k) {
            const auto axis = static_cast<int>(k);
            part.half[k] = glm::dvec3(box.axes[axis]) * static_cast<double>(box.half_extents[axis]);
        }
        parts.push_back(part);
        const Aabb outer = aabb_of(box);
        objects.push_back({outer.min - bake.origin - margin, outer.max - bake.origin + margin});
    }
    for (const Blocker& body : bodies) bounds.push_back(body.bounds);
    const BoxGroups cell_groups(cells), object_groups(objects), tree(bounds);
    Surface surface;
    if (options.surface_steps > 0) surface = surface_of(bake.mesh);
    Vector<std::uint32_t> first_triangle(bake.boxes.size() + 1, 0), triangles(bake.object_of.size());
    for (const std::uint32_t o : bake.object_of) ++first_triangle[o + 1];
    for (std::size_t o = 0; o < bake.boxes.size(); ++o) first_triangle[o + 1] += first_triangle[o];
    Vector<std::uint32_t> next(first_triangle.begin(), first_triangle.end() - 1);
    for (std::uint32_t t = 0; t < triangles.size(); ++t) triangles[next[bake.object_of[t]]++] = t;
    const Question question{
        bake,
        bodies,
        options,
        cell_groups,
        object_groups,
        tree,
        std::move(parts),
        first_triangle,
        triangles,
        options.surface_steps > 0 ? &surface : nullptr,
        {bake.options.sides, options.near_radius, margin + kGap * bake.extent, options.surface_steps},
        margin,
        stop,
        answered,
        (std::max)(1.0, static_cast<double>(bake.cells.size()) * static_cast<double>(bake.boxes.size()))};
    // Groups of few cells are tasks: each writes its cells' bits alone.
    Vector<std::uint32_t> tasks, stack{BoxGroups::kRoot};
    while (!stack.empty()) {
        const std::uint32_t g = stack.back();
        stack.pop_back();
        if (cell_groups[g].count <= 64) {
            tasks.push_back(g);
        } else {
            stack.push_back(cell_groups[g].child);
            stack.push_back(cell_groups[g].child + 1);
        }
    }
    crofton::detail::recoverable_for(executor, tasks.size(), 1, [&](std::size_t begin, std::size_t end, unsigned) {
        Prover prover(question, open);
        for (std::size_t i = begin; i < end; ++i) prover.prove(tasks[i], BoxGroups::kRoot);
    });
}

}  // namespace crofton::pvs
