// SPDX-License-Identifier: MIT
#include "exact_gjk.hpp"

#include "exact_vector.hpp"

namespace crofton::convex {
namespace {

struct ExactCorner {
    int a, b;
    ExactVector w;
};

// A face of the simplex with the weights of the point of its plane that is nearest to the origin, up to one positive
// factor, and the direction to that point.
struct Foot {
    int count = 0, index[4] = {};
    Dyadic weight[4];
    ExactVector direction;
};

class ExactSearch {
  public:
    explicit ExactSearch(const Pair& pair)
        : pair_(pair), offset_(exact_vector(pair.pose_a.translation) - exact_vector(pair.pose_b.translation)) {}

    [[nodiscard]] ExactCorner corner(int i, int j) const {
        return {i, j,
                (exact_image(pair_.pose_a.rotation, pair_.a.vertex(i)) -
                 exact_image(pair_.pose_b.rotation, pair_.b.vertex(j))) +
                    offset_};
    }

    // The vertex farthest along d: those that double cannot tell from the farthest are compared exactly.
    [[nodiscard]] static int farthest(const Shape& shape, const glm::dmat3& rotation, const ExactVector& d) {
        const glm::dvec3 rounded = rounded_direction(d), along = Pair::local(rotation, rounded);
        const double most = farthest_vertex(shape, along).along;
        // `rounded` is off by 2^-51, the product by 9u of reach · |d|, twice.
        const double least = most - 0x1p-46 * shape.core_radius() * glm::length(rounded);
        int best = -1;
        Dyadic value;
        for (int i = 0; i < shape.vertex_count(); ++i) {
            if (glm::dot(shape.vertex(i), along) < least) continue;
            if (best < 0) {
                best = i;
                continue;
            }
            if (value.sign() == 0) value = dot(d, exact_image(rotation, shape.vertex(best)));
            const Dyadic other = dot(d, exact_image(rotation, shape.vertex(i)));
            if ((other - value).sign() > 0) best = i, value = other;
        }
        return best;
    }
    [[nodiscard]] ExactCorner support(const ExactVector& d) const {
        return corner(farthest(pair_.a, pair_.pose_a.rotation, d), farthest(pair_.b, pair_.pose_b.rotation, -d));
    }

    void add(const ExactCorner& next) { simplex_[count_++] = next; }

    // Keeps the face whose foot is the nearest point of the whole simplex; false if that is the origin.
    bool reduce() {
        for (int size = 1; size <= count_; ++size)
            for (int set = 1; set < 1 << count_; ++set) {
                Foot foot;
                for (int i = 0; i < count_; ++i)
                    if ((set >> i & 1) != 0) foot.index[foot.count++] = i;
                if (foot.count != size || !find(foot) || !is_nearest(foot, set)) continue;
                foot_ = foot;
                ExactCorner kept[4];
                for (int k = 0; k < foot.count; ++k) kept[k] = simplex_[foot.index[k]];
                std::copy(kept, kept + foot.count, simplex_);
                count_ = foot.count;
                return !is_zero(foot.direction);
            }
        foot_.direction = {};
        return false;  // not reached: some face holds the nearest point
    }

    [[nodiscard]] const ExactVector& direction() const { return foot_.direction; }
    [[nodiscard]] const ExactCorner& first() const { return simplex_[0]; }
    [[nodiscard]] int count() const { return count_; }

    // In double, with weights that are quotients of exact numbers.
    [[nodiscard]] Simplex rounded() const {
        Simplex s;
        int exponent = -1'000'000;
        for (int k = 0; k < count_; ++k) exponent = std::max(exponent, foot_.weight[k].exponent());
        double sum = 0.0;
        for (int k = 0; k < count_; ++k) {
            s.add(pair_.corner(simplex_[k].a, simplex_[k].b));
            s.weight[k] = count_ == 1 ? 1.0 : foot_.weight[k].scaled(exponent);
            sum += s.weight[k];
        }
        for (int k = 0; k < count_; ++k) s.weight[k] /= sum;
        return s;
    }

  private:
    [[nodiscard]] const ExactVector& at(int i) const { return simplex_[i].w; }

    // False where a weight is not positive.
    [[nodiscard]] bool find(Foot& foot) const {
        const ExactVector &p = at(foot.index[0]), &q = at(foot.index[1]), &r = at(foot.index[2]);
        if (foot.count == 1) {
            foot.weight[0] = Dyadic(1.0);
            foot.direction = p;
        } else if (foot.count == 2) {
            const ExactVector u = q - p;
            foot.weight[0] = dot(q, u);
            foot.weight[1] = -dot(p, u);
            if (foot.weight[0].sign() > 0 && foot.weight[1].sign() > 0)
                foot.direction = p * foot.weight[0] + q * foot.weight[1];
        } else if (foot.count == 3) {
            const ExactVector n = cross(q - p, r - p);
            foot.weight[0] = dot(cross(q, r), n);
            foot.weight[1] = dot(cross(r, p), n);
            foot.weight[2] = dot(cross(p, q), n);
            const int side = dot(n, p).sign();
            if (side != 0) foot.direction = side > 0 ? n : -n;
        } else {
            find_inside(foot);
        }
        for (int k = 0; k < foot.count; ++k)
            if (foot.weight[k].sign() <= 0) return false;
        return true;
    }

    void find_inside(Foot& foot) const {
        const ExactVector ab = cross(at(0), at(1)), cd = cross(at(2), at(3));
        foot.weight[0] = dot(at(1), cd);
        foot.weight[1] = -dot(at(0), cd);
        foot.weight[2] = dot(at(3), ab);
        foot.weight[3] = -dot(at(2), ab);
        const Dyadic whole = (foot.weight[0] + foot.weight[1]) + (foot.weight[2] + foot.weight[3]);
        if (whole.sign() < 0)
            for (Dyadic& weight : foot.weight) weight = -weight;
    }

    // Whether no other corner lies before the plane through the foot across its direction.
    [[nodiscard]] bool is_nearest(const Foot& foot, int set) const {
        for (int i = 0; i < count_; ++i)
            if ((set >> i & 1) == 0 && dot(foot.direction, at(i) - at(foot.index[0])).sign() < 0) return false;
        return true;
    }

    const Pair& pair_;
    ExactVector offset_;
    ExactCorner simplex_[4];
    Foot foot_;
    int count_ = 0;
};

}  // namespace

ExactNearest exact_nearest(const Pair& pair, const Simplex& start, bool nearest) {
    ExactSearch search(pair);
    search.add(search.corner(start.corner[0].a, start.corner[0].b));
    ExactNearest result;
    int seed = 1;
    while (search.reduce()) {
        const ExactVector towards = -search.direction();
        const Dyadic level = dot(towards, search.first().w);  // < 0
        ExactCorner next;
        bool closer = false;
        while (seed < start.count && !closer) {
            next = search.corner(start.corner[seed].a, start.corner[seed].b);
            closer = (dot(towards, next.w) - level).sign() > 0;
            ++seed;
        }
        if (!closer) {
            next = search.support(towards);
            const Dyadic reached = dot(towards, next.w);
            if ((!nearest && reached.sign() < 0) || (reached - level).sign() <= 0) {
                result.simplex = search.rounded();
                const glm::dvec3 d = rounded_direction(search.direction());
                result.normal = -d / glm::length(d);
                result.simplex.nearest = d;
                return result;
            }
        }
        search.add(next);
    }
    result.meet = true;
    result.simplex = search.rounded();
    return result;
}

bool meets_half_space(const ShapeAtPose& polytope, const ShapeAtPose& half_space) {
    // y in the image of { n·x + offset ≥ 0 } under R, t: (cof(R) n) · (y − t) + det(R) offset ≥ 0, det(R) > 0.
    const glm::dmat3& r = half_space.pose.rotation;
    const ExactVector c0 = exact_vector(r[0]), c1 = exact_vector(r[1]), c2 = exact_vector(r[2]);
    const Plane& plane = half_space.shape.plane();
    const ExactVector yz = cross(c1, c2);
    const ExactVector normal =
        (yz * Dyadic(plane.normal.x) + cross(c2, c0) * Dyadic(plane.normal.y)) + cross(c0, c1) * Dyadic(plane.normal.z);
    const Dyadic level =
        dot(c0, yz) * Dyadic(plane.offset) +
        dot(normal, exact_vector(polytope.pose.translation) - exact_vector(half_space.pose.translation));
    const int vertex = ExactSearch::farthest(polytope.shape, polytope.pose.rotation, normal);
    return (dot(normal, exact_image(polytope.pose.rotation, polytope.shape.vertex(vertex))) + level).sign() >= 0;
}

glm::dvec3 exact_edge_normal(const Pair& pair, int i, int j, int k, int l) {
    const ExactVector u =
        exact_image(pair.pose_a.rotation, pair.a.vertex(j)) - exact_image(pair.pose_a.rotation, pair.a.vertex(i));
    const ExactVector v =
        exact_image(pair.pose_b.rotation, pair.b.vertex(l)) - exact_image(pair.pose_b.rotation, pair.b.vertex(k));
    const ExactVector n = cross(u, v);
    return is_zero(n) ? glm::dvec3(0.0) : rounded_direction(n);
}

}  // namespace crofton::convex
