// SPDX-License-Identifier: MIT
#include "part_manifold.hpp"

#include <algorithm>
#include <crofton/convex/push_out_of_union.hpp>

#include "box_pair.hpp"
#include "core_query.hpp"
#include "surface_manifold.hpp"
#include "union_normals.hpp"

namespace crofton::convex {

glm::dvec3 middle_of(const ShapeAtPose& placed, const glm::dvec3& origin) {
    const Hull* const hull = placed.shape.hull();
    const glm::dvec3 middle = hull != nullptr ? hull->mass().center : placed.shape.bounds().center();
    return placed.pose.rotation * middle + (placed.pose.translation - origin);
}

bool is_in_front(const PlacedTriangle& t, const Shape& shape, const glm::dvec3& middle) {
    return shape.kind() == Kind::half_space || glm::dot(t.normal, middle - t.corner[0]) >= 0.0;
}

struct Manifolds::Scratch {
    Vector<NearSurface> surfaces;
    Vector<NearTriangle> triangles;
    EdgeRule rule;
    ManifoldList list;
    SurfaceContacts::Contact contact;
    UnionNormals flush;
    Vector<std::uint32_t> shape_of_part[2];  // of `flush`, beside the pair's own: shapes beside, by number
    Vector<std::pair<std::uint32_t, std::uint32_t>> numbers;  // of second parts: child, number in `flush`
};

Manifolds::Manifolds() = default;
Manifolds::~Manifolds() = default;
Manifolds::Manifolds(Manifolds&&) noexcept = default;
Manifolds& Manifolds::operator=(Manifolds&&) noexcept = default;

namespace {

// A box around unit vectors.
class DirectionBox {
  public:
    void add(const glm::dvec3& d) {
        low_ = (glm::min)(low_, d);
        high_ = (glm::max)(high_, d);
    }
    // Whether two vectors of the box may be more than a right angle apart.
    [[nodiscard]] bool may_oppose() const {
        double least = 0.0;  // of their product
        for (int k = 0; k < 3; ++k)
            least += low_[k] > 0.0 ? low_[k] * low_[k] : high_[k] < 0.0 ? high_[k] * high_[k] : low_[k] * high_[k];
        return least < 0.0 && low_.x <= high_.x;
    }

  private:
    glm::dvec3 low_{2.0}, high_{-2.0};
};

}  // namespace

class ManifoldFinder {
  public:
    ManifoldFinder(const ManifoldOptions& options, Manifolds& found)
        : options_(options), found_(found), scratch_(scratch_of(found)) {}

    void run(const ShapeAtPose& a, const ShapeAtPose& b, PairCache* cache) {
        found_.all_.clear();
        if (a.shape.is_convex() && b.shape.is_convex()) {
            const Manifold m = contact_manifold(a, b, options_, cache);
            if (m.count > 0) found_.all_.push_back(m);
            return;
        }
        scratch_.list.clear();
        if (b.shape.is_convex()) {
            find(a, b, {}, false);
        } else if (a.shape.is_convex()) {
            find(b, a, {}, true);
        } else if (has_surfaces(a.shape) || has_surfaces(b.shape)) {
            find_parts(a, b);
        } else {
            find_convex_parts(a, b);
        }
        scratch_.list.finish(std::clamp(options_.max_points, 1, 8), found_.all_);
    }

    // Shapes without surfaces.
    void run_beside(const ShapeAtPose& a, const ShapeAtPose& b, const Beside& beside, PairCache* cache) {
        if (a.shape.is_convex() && b.shape.is_convex()) {
            PairCache forgotten;
            run(a, b, cache != nullptr ? cache : &forgotten);
            return run_convex_beside(a, b, beside, cache != nullptr ? *cache : forgotten);
        }
        (void)find_beside(a, b, beside, false, [&](const Count& own) {
            for (std::uint32_t i = 0; i < own.parts[0]; ++i)
                for (std::uint32_t j = 0; j < own.parts[1]; ++j) add_flush_contact(i, j);
        });
    }

    // Of two convex shapes that have been asked alone.
    void run_beside(const ShapeAtPose& a, const ShapeAtPose& b, const NumberedBeside& beside, PairMemory& memory,
                    PairCache& cache) {
        numbered_ = &beside;
        memory_ = &memory;
        run_convex_beside(a, b, beside.shapes, cache);
    }

  private:
    struct Count {
        std::uint32_t parts[2] = {0, 0};  // of the lists of `flush`
    };
    // Of ways out that are as deep within kKeptDepth, neighbors may close one and leave another. So where they close
    // the face that was kept, the pair is asked without it; and where they make the way longer by more, its other faces
    // are tried. A face that was kept thus makes no way longer or shorter by more.
    void run_convex_beside(const ShapeAtPose& a, const ShapeAtPose& b, const Beside& beside, PairCache& cache) {
        if (found_.all_.empty()) return;
        Manifold alone = found_.all_[0];
        const auto find = [&](bool stops) {
            const auto add_contact = [&](const Count&) { scratch_.flush.add_contact(0, 0, alone); };
            return find_beside(a, b, beside, stops, add_contact);
        };
        if (find(true)) return;
        cache = {};
        const Manifold least = alone = contact_manifold(a, b, options_, &cache);
        (void)find(false);
        const Pair pair(a, b);
        const double most = least.depth + kKeptDepth * pair.size;
        if (least.count == 0 || found_.all_.empty() || !(found_.all_[0].depth > most)) return;
        for (std::uint16_t list = 0; list < 2; ++list) {
            const ShapeAtPose& shape = list == 0 ? a : b;
            for (int face = 0; face < face_count(shape.shape); ++face) {
                const glm::dvec3 normal = face_normal(shape, face) * (list == 0 ? 1.0 : -1.0);
                if (pair.extent(normal) + a.shape.radius() + b.shape.radius() > most + 1e-5 * pair.size) continue;
                PairCache kept;
                kept.reference = static_cast<std::uint16_t>(list + 1);
                kept.face = static_cast<std::uint16_t>(face);
                alone = contact_manifold(a, b, options_, &kept);
                if (alone.count == 0 || !find(true)) continue;
                cache = kept;
                return;
            }
        }
        alone = least;
        (void)find(false);
    }
    // False if it stops, as neighbors have a say.
    [[nodiscard]] bool find_beside(const ShapeAtPose& a, const ShapeAtPose& b, const Beside& beside, bool stops,
                                   FunctionRef<void(const Count&)> add_contacts) {
        found_.all_.clear();
        scratch_.list.clear();
        UnionNormals& flush = scratch_.flush;
        flush.start(options_.margin);
        Count own;
        add_parts(0, a, b, own.parts[0]);
        add_parts(1, b, a, own.parts[1]);
        add_contacts(own);
        const std::size_t wanted = flush.contacts().size();
        if (wanted == 0) return true;
        const bool deep = std::any_of(flush.contacts().begin(), flush.contacts().end(), [&](const auto& contact) {
            return std::abs(contact.depth) > flush_tolerance(a, b);  // what rests flush itself has no way to go
        });
        if (deep && have_neighbors_say(a, b, beside, own)) {
            if (stops) return false;
            push_out_of_union(a, b, beside, own);
        }
        add_flush(wanted, false);
        scratch_.list.finish(std::clamp(options_.max_points, 1, 8), found_.all_);
        return true;
    }
    [[nodiscard]] bool have_neighbors_say(const ShapeAtPose& a, const ShapeAtPose& b, const Beside& beside,
                                          const Count& own) {
        UnionNormals& flush = scratch_.flush;
        Count all = own;
        add_beside(0, beside.a, b, all.parts[0]);
        add_beside(1, beside.b, a, all.parts[1]);
        const bool two_parts = own.parts[0] == 1 && own.parts[1] == 1;
        const auto counts = [&](int list, std::uint32_t part) {
            return is_flush_beside(a, b, beside, list, shape_of_part(list, part));
        };
        const auto touch = [&](std::uint32_t first, std::uint32_t second) { return contact_of_parts(first, second); };
        return two_parts ? !flush.is_first_left(counts, touch) : flush.is_any_covered();
    }
    void push_out_of_union(const ShapeAtPose& a, const ShapeAtPose& b, const Beside& beside, const Count& own) {
        UnionNormals& flush = scratch_.flush;
        const std::size_t wanted = flush.contacts().size();
        const auto is_flush = [&](int list, std::uint32_t shape) { return is_flush_beside(a, b, beside, list, shape); };
        // Of those beside only what lies flush: shapes that are deep in each other are no floor.
        flush.keep_parts(0, own.parts[0]);
        flush.keep_parts(1, own.parts[1]);
        Count all = own;
        for (std::uint32_t i = 0; i < beside.a.size(); ++i)
            if (is_flush(0, i)) add_parts(0, beside.a[i], b, all.parts[0]);
        for (std::uint32_t i = 0; i < beside.b.size(); ++i)
            if (is_flush(1, i)) add_parts(1, beside.b[i], a, all.parts[1]);
        for (std::uint32_t i = own.parts[0]; i < all.parts[0]; ++i)
            for (std::uint32_t j = 0; j < own.parts[1]; ++j) add_flush_contact(i, j);
        for (std::uint32_t i = 0; i < own.parts[0]; ++i)
            for (std::uint32_t j = own.parts[1]; j < all.parts[1]; ++j) add_flush_contact(i, j);
        flush.apply(wanted);
    }
    // Whether they are apart, or overlap, by no more than rounding to float. Shapes that only stand near have a gap,
    // into which other shapes may be pushed.
    [[nodiscard]] static bool are_flush(const ShapeAtPose& a, const ShapeAtPose& b) {
        if (has_surfaces(b.shape) || is_half_space(b)) return false;
        const glm::dvec3 offset = b.pose.translation - a.pose.translation;
        const double reach = (a.shape.core_radius() + a.shape.radius()) + (b.shape.core_radius() + b.shape.radius());
        const double flush = flush_tolerance(a, b);
        if (glm::length(offset) > (reach + flush) * (1.0 + 1e-12)) return false;
        const bool boxes = is_solid_box(a.shape) && is_solid_box(b.shape) && a.shape.radius() + b.shape.radius() == 0.0;
        const std::optional<bool> more = boxes ? boxes_overlap_by_more(Pair(a, b), flush) : std::nullopt;
        if (more ? *more : are_deep(a, b, flush)) return false;
        if (!intersects(a, b)) return distance(a, b).distance <= flush;
        return more || !(penetration(a, b).depth > flush);
    }
    // Whether convex shapes are proved to overlap by more than `flush`, which takes a part of the time of their depth.
    [[nodiscard]] static bool are_deep(const ShapeAtPose& a, const ShapeAtPose& b, double flush) {
        if (!a.shape.is_convex() || !b.shape.is_convex()) return false;
        const Pair pair(a, b);
        const Nearest core = nearest_points(pair, nullptr, 0.0, 0.0);
        const double rounding = (a.shape.radius() + b.shape.radius()) * (1.0 - 0x1p-50);
        return core.relation == Relation::overlapping && is_deeper(pair, core.simplex, flush - rounding);
    }
    void add_parts(int list, const ShapeAtPose& shape, const ShapeAtPose& near, std::uint32_t& count) {
        if (has_surfaces(shape.shape) || is_half_space(shape)) return;
        if (shape.shape.is_convex()) {
            count = scratch_.flush.add_part(list, {shape.shape, shape.pose, {}, Sides::both}) + 1;
            return;
        }
        visit_parts_near(shape, near, near_margin(near), [&](const Part& part) {
            count = scratch_.flush.add_part(list, part) + 1;
            return false;
        });
    }
    // Whether a shape beside a or b lies flush with it.
    [[nodiscard]] bool is_flush_beside(const ShapeAtPose& a, const ShapeAtPose& b, const Beside& beside, int list,
                                       std::uint32_t shape) {
        const auto ask = [&] { return list == 0 ? are_flush(a, beside.a[shape]) : are_flush(b, beside.b[shape]); };
        if (memory_ == nullptr) return ask();
        const std::uint32_t own = list == 0 ? numbered_->number_a : numbered_->number_b;
        return memory_->is_flush.get(own, (list == 0 ? numbered_->numbers_a : numbered_->numbers_b)[shape], ask);
    }
    // The shape beside whose part this is.
    [[nodiscard]] std::uint32_t shape_of_part(int list, std::uint32_t part) const {
        return scratch_.shape_of_part[list][part - 1];
    }
    // Of two convex shapes' parts, one of which is of a shape beside.
    [[nodiscard]] PairContact contact_of_parts(std::uint32_t first, std::uint32_t second) {
        const auto ask = [&] {
            const Manifold m = manifold_of_parts(first, second);
            return PairContact{m.count > 0, m.normal, m.points[0].position, m.depth};
        };
        if (memory_ == nullptr) return ask();
        const Beside& beside = numbered_->shapes;
        const bool of_a = second == 0;
        const std::uint32_t shape = of_a ? shape_of_part(0, first) : shape_of_part(1, second);
        if (!(of_a ? beside.a : beside.b)[shape].shape.is_convex()) return ask();
        const std::uint32_t number = (of_a ? numbered_->numbers_a : numbered_->numbers_b)[shape];
        return memory_->contact.get(of_a ? number : numbered_->number_a, of_a ? numbered_->number_b : number, ask);
    }
    void add_beside(int list, std::span<const ShapeAtPose> shapes, const ShapeAtPose& near, std::uint32_t& count) {
        scratch_.shape_of_part[list].clear();
        for (std::uint32_t i = 0; i < shapes.size(); ++i) {
            const std::uint32_t before = count;
            add_parts(list, shapes[i], near, count);
            scratch_.shape_of_part[list].insert(scratch_.shape_of_part[list].end(), count - before, i);
        }
    }
    [[nodiscard]] Manifold manifold_of_parts(std::uint32_t first, std::uint32_t second) const {
        const Part &a = scratch_.flush.part(0, first), &b = scratch_.flush.part(1, second);
        return manifold_of({a.shape, a.pose}, {b.shape, b.pose});
    }
    void add_flush_contact(std::uint32_t first, std::uint32_t second) {
        scratch_.flush.add_contact(first, second, manifold_of_parts(first, second));
    }

    static Manifolds::Scratch& scratch_of(Manifolds& found) {
        if (!found.scratch_) found.scratch_ = std::make_unique<Manifolds::Scratch>();
        return *found.scratch_;
    }

    // Both have convex parts alone.
    void find_convex_parts(const ShapeAtPose& a, const ShapeAtPose& b) {
        UnionNormals& flush = scratch_.flush;
        flush.start(options_.margin);
        scratch_.numbers.clear();
        visit_parts_near(b, a, near_margin(a), [&](const Part& part) {
            scratch_.numbers.emplace_back(part.id.child, flush.add_part(1, part));
            return false;
        });
        std::sort(scratch_.numbers.begin(), scratch_.numbers.end());
        visit_parts_near(a, b, near_margin(b), [&](const Part& first) {
            const std::uint32_t number = flush.add_part(0, first);
            const ShapeAtPose placed{first.shape, first.pose};
            visit_parts_near(b, placed, options_.margin, [&](const Part& second) {
                const auto at = std::lower_bound(scratch_.numbers.begin(), scratch_.numbers.end(),
                                                 std::pair(second.id.child, std::uint32_t{0}));
                if (at == scratch_.numbers.end() || at->first != second.id.child) return false;
                flush.add_contact(number, at->second, manifold_of(placed, {second.shape, second.pose}));
                return false;
            });
            return false;
        });
        flush.apply();
        add_flush(flush.contacts().size(), false);
    }

    [[nodiscard]] Manifold manifold_of(const ShapeAtPose& a, const ShapeAtPose& b) const {
        ManifoldOptions all_points = options_;
        all_points.max_points = 8;
        return contact_manifold(a, b, all_points);
    }
    // Parts that lie flush with those within the margin of a shape are wanted as well.
    [[nodiscard]] double near_margin(const ShapeAtPose& shape) const {
        return options_.margin +
               (is_half_space(shape) ? 0.0 : 1e-5 * (shape.shape.core_radius() + shape.shape.radius()));
    }
    // The first contacts.
    void add_flush(std::size_t count, bool flip) {
        UnionNormals& flush = scratch_.flush;
        for (const UnionNormals::Contact& contact : flush.contacts().first(count)) {
            scratch_.contact.normal = contact.normal;
            scratch_.contact.points.count = contact.count;
            std::copy_n(contact.points, contact.count, scratch_.contact.points.point);
            add(scratch_.contact, flush.part(0, contact.part[0]).id, flush.part(1, contact.part[1]).id, flip);
        }
    }

    // Both have parts. A surface's rules hold where it is asked as a whole: a's for b's convex parts, if a has any
    // surface, and b's for all others of a.
    void find_parts(const ShapeAtPose& a, const ShapeAtPose& b) {
        if (has_surfaces(a.shape)) {
            const auto convex = [&](const Part& part) {
                find(a, {part.shape, part.pose}, part.id, false);
                return false;
            };
            const auto leave_out = [](const PartSearch&, const Triangle&, std::uint32_t) { return false; };
            (void)visit_parts_near(b, a, options_.margin, convex, leave_out);
            if (!has_surfaces(b.shape)) return;
            only_surfaces_ = true;
        }
        visit_parts_near(a, b, options_.margin, [&](const Part& part) {
            set_front(part);
            find(b, {part.shape, part.pose}, part.id, true);
            return false;
        });
    }

    // A one-sided triangle that stands for a convex shape pushes to its front as well.
    void set_front(const Part& part) {
        front_ = glm::dvec3(0.0);
        if (part.sides != Sides::front) return;
        const Triangle corners{part.shape.vertex(0), part.shape.vertex(1), part.shape.vertex(2)};
        front_ = placed_triangle(corners, part.pose, part.pose.translation).normal;
    }

    // The contacts of a, which has parts, and b, which is convex; `of_b`: b's part. Across a ridge or a tip each
    // triangle's normal may point into the others, and the rule leaves no point: then all push along their faces. Where
    // triangles of two sides push to opposite sides, neighbors decide the side; if that leaves no point, they do not.
    void find(const ShapeAtPose& a, const ShapeAtPose& b, const PartId& of_b, bool flip) {
        list_near(a, b, of_b, flip);
        const ManifoldList::Mark before = scratch_.list.mark();
        scratch_.rule.start(scratch_.triangles, b);
        const auto has_points = [&] { return scratch_.list.mark().points > before.points; };
        // Which of the triangles without points the shape meets matters only if none has any.
        passes_over_ = b.shape.kind() == Kind::sphere && scratch_.triangles.size() >= kManyTriangles;
        Answer answer = ask_triangles(b, Push::by_rule, of_b, flip);
        if (passes_over_ && !has_points()) {
            passes_over_ = false;
            answer = ask_triangles(b, Push::by_rule, of_b, flip);
        }
        if (answer.opposite) {
            scratch_.list.rewind(before);
            (void)ask_triangles(b, Push::to_one_side, of_b, flip);
            if (!has_points()) answer = ask_triangles(b, Push::by_rule, of_b, flip);
        }
        passes_over_ = false;
        if (answer.left_out && !has_points()) (void)ask_triangles(b, Push::always, of_b, flip);
    }

    [[nodiscard]] std::uint32_t end_of_surface(std::uint32_t begin) const {
        const auto& triangles = scratch_.triangles;
        std::uint32_t end = begin;
        while (end < triangles.size() && triangles[end].surface == triangles[begin].surface) ++end;
        return end;
    }
    struct Answer {
        bool left_out = false;  // the rule left out a triangle that the shape meets
        bool opposite = false;  // triangles of two sides may push to opposite sides
    };
    Answer ask_triangles(const ShapeAtPose& b, Push push, const PartId& of_b, bool flip) {
        Answer answer;
        DirectionBox pushed;
        std::uint32_t i = 0;
        const auto count = static_cast<std::uint32_t>(scratch_.triangles.size());
        while (i < count) {
            const std::uint32_t at = scratch_.triangles[i].surface;
            const NearSurface& surface = scratch_.surfaces[at];
            const SurfaceContacts contacts(surface, b, options_.margin);
            if (push == Push::to_one_side && surface.shape->sides() == Sides::both)
                scratch_.rule.find_sides(i, end_of_surface(i), contacts.middle());
            const EdgeRule::Ball ball{contacts.middle(), b.shape.radius(), contacts.doubt()};
            for (; i < count && scratch_.triangles[i].surface == at; ++i) {
                if (passes_over_ && scratch_.rule.surely_leaves_out(i, ball)) continue;
                contacts.ask(scratch_.triangles[i], i, scratch_.rule, push, scratch_.contact);
                answer.left_out = answer.left_out || scratch_.contact.left_out;
                if (scratch_.contact.points.count > 0 && surface.shape->sides() == Sides::both)
                    pushed.add(scratch_.contact.normal);
                add(scratch_.contact, {surface.child, scratch_.triangles[i].triangle}, of_b, flip);
            }
        }
        answer.opposite = pushed.may_oppose();
        return answer;
    }

    // Lists the triangles that may touch; convex parts are asked at once.
    void list_near(const ShapeAtPose& a, const ShapeAtPose& b, const PartId& of_b, bool flip) {
        Vector<NearSurface>& surfaces = scratch_.surfaces;
        surfaces.clear();
        scratch_.triangles.clear();
        UnionNormals& flush = scratch_.flush;
        flush.start(options_.margin);
        const std::uint32_t whole = flush.add_part(1, {b.shape, b.pose, of_b});
        const auto convex = [&](const Part& part) {
            if (only_surfaces_) return false;
            flush.add_contact(flush.add_part(0, part), whole, manifold_of({part.shape, part.pose}, b));
            return false;
        };
        const auto triangle = [&](const PartSearch& of, const Triangle& corners, std::uint32_t index) {
            if (surfaces.empty() || surfaces.back().child != of.child)
                surfaces.push_back({of.pose, of.shape, of.child});
            scratch_.triangles.push_back({corners, index, static_cast<std::uint32_t>(surfaces.size() - 1)});
            return false;
        };
        (void)visit_parts_near(a, b, near_margin(b), convex, triangle);
        flush.apply();
        add_flush(flush.contacts().size(), flip);
    }

    void add(SurfaceContacts::Contact& contact, const PartId& of_a, const PartId& of_b, bool flip) {
        if (flip && front_ != glm::dvec3(0.0) && glm::dot(front_, contact.normal) >= 0.0) contact.points.count = 0;
        for (int k = 0; k < contact.points.count; ++k) {
            ContactPoint& p = contact.points.point[k];
            p.part_a = flip ? of_b : of_a;
            p.part_b = flip ? of_a : of_b;
            if (flip) std::swap(p.on_a, p.on_b);
        }
        scratch_.list.add(flip ? -contact.normal : contact.normal,
                          {contact.points.point, static_cast<std::size_t>(contact.points.count)});
    }

    const ManifoldOptions& options_;
    bool only_surfaces_ = false;  // convex parts have been asked already
    bool passes_over_ = false;    // a ball passes over the triangles that the rule for inner edges surely leaves out
    static constexpr std::size_t kManyTriangles = 6;
    glm::dvec3 front_{0.0};  // of the triangle that stands for a convex shape; 0 where it has two sides
    const NumberedBeside* numbered_ = nullptr;  // with the memory
    PairMemory* memory_ = nullptr;
    Manifolds& found_;
    Manifolds::Scratch& scratch_;
};

void contact_manifolds(const ShapeAtPose& a, const ShapeAtPose& b, const ManifoldOptions& options, Manifolds& found,
                       PairCache* cache) {
    ManifoldFinder(options, found).run(a, b, cache);
}

void contact_manifolds(const ShapeAtPose& a, const ShapeAtPose& b, const Beside& beside, const ManifoldOptions& options,
                       Manifolds& found, PairCache* cache) {
    const bool alone = beside.a.empty() && beside.b.empty();
    if (alone || has_surfaces(a.shape) || has_surfaces(b.shape) || is_half_space(a) || is_half_space(b))
        return contact_manifolds(a, b, options, found, cache);
    ManifoldFinder(options, found).run_beside(a, b, beside, cache);
}

void push_out_of_union(const ShapeAtPose& a, const ShapeAtPose& b, const NumberedBeside& beside,
                       const ManifoldOptions& options, Manifolds& found, PairMemory& memory, PairCache& cache) {
    const bool alone = beside.shapes.a.empty() && beside.shapes.b.empty();
    if (!alone && !is_half_space(a) && !is_half_space(b))
        ManifoldFinder(options, found).run_beside(a, b, beside, memory, cache);
}

Manifold deepest_manifold(const ShapeAtPose& a, const ShapeAtPose& b, const ManifoldOptions& options) {
    Manifolds found;
    contact_manifolds(a, b, options, found);
    Manifold deepest;
    for (const Manifold& m : found.all())
        if (deepest.count == 0 || m.depth > deepest.depth) deepest = m;
    return deepest;
}

}  // namespace crofton::convex
