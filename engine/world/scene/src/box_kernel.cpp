// SPDX-License-Identifier: MIT
#include "box_kernel.hpp"

#include <hwy/foreach_target.h>
// After foreach_target.h:
#include <hwy/highway.h>
#include <limits>
#include <numbers>

#include "box_image.hpp"

HWY_BEFORE_NAMESPACE();
namespace crofton::scene {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// A vector's width of instances, in double and in float.
using D = hn::ScalableTag<double>;
using F = hn::Rebind<float, D>;
using V = hn::Vec<D>;

struct V3 {
    V x, y, z;
};

HWY_ATTR inline V3 operator*(const V3& a, V s) {
    return {hn::Mul(a.x, s), hn::Mul(a.y, s), hn::Mul(a.z, s)};
}
HWY_ATTR inline V3 operator-(const V3& a, const V3& b) {
    return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}
HWY_ATTR inline V add(V a, V b, V c) {
    return hn::Add(hn::Add(a, b), c);
}
HWY_ATTR inline V dot(const V3& a, const V3& b) {
    return add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y), hn::Mul(a.z, b.z));
}
HWY_ATTR inline V size(const V3& a) {
    return add(hn::Abs(a.x), hn::Abs(a.y), hn::Abs(a.z));
}
HWY_ATTR inline V3 cross(const V3& a, const V3& b) {
    return {hn::Sub(hn::Mul(a.y, b.z), hn::Mul(b.y, a.z)), hn::Sub(hn::Mul(a.z, b.x), hn::Mul(b.z, a.x)),
            hn::Sub(hn::Mul(a.x, b.y), hn::Mul(b.x, a.y))};
}
HWY_ATTR inline V3 normalised(const V3& a, V squared) {
    return a * hn::Div(hn::Set(D(), 1.0), hn::Sqrt(squared));
}

struct Matrix {
    V3 columns[3];
};
HWY_ATTR inline V3 operator*(const Matrix& m, const V3& v) {
    return {add(hn::Mul(m.columns[0].x, v.x), hn::Mul(m.columns[1].x, v.y), hn::Mul(m.columns[2].x, v.z)),
            add(hn::Mul(m.columns[0].y, v.x), hn::Mul(m.columns[1].y, v.y), hn::Mul(m.columns[2].y, v.z)),
            add(hn::Mul(m.columns[0].z, v.x), hn::Mul(m.columns[1].z, v.y), hn::Mul(m.columns[2].z, v.z))};
}

HWY_ATTR inline hn::Vec<F> to_float(V v) {
    return hn::DemoteTo(F(), v);
}
HWY_ATTR inline V to_double(hn::Vec<F> v) {
    return hn::PromoteTo(D(), v);
}
// The axis as a box stores it.
HWY_ATTR inline V3 rounded(const V3& v) {
    return {to_double(to_float(v.x)), to_double(to_float(v.y)), to_double(to_float(v.z))};
}

// The least float that is not below v ≥ 0.
HWY_ATTR inline V float_at_least(V v) {
    const hn::RebindToUnsigned<F> bits;
    const hn::Vec<F> nearest = to_float(v);
    const hn::Vec<F> next = hn::BitCast(F(), hn::Add(hn::BitCast(bits, nearest), hn::Set(bits, 1u)));
    return hn::IfThenElse(hn::Lt(to_double(nearest), v), to_double(next), to_double(nearest));
}

struct Instances {
    Matrix linear;
    V3 translation;
    V3 center;
    V3 axes[3];
    V half_extents[3];
};

HWY_ATTR inline void load_shape(const float* from, V& a, V& b, V& c, V& d) {
    hn::Vec<F> fa, fb, fc, fd;
    hn::LoadInterleaved4(F(), from, fa, fb, fc, fd);
    a = to_double(fa);
    b = to_double(fb);
    c = to_double(fc);
    d = to_double(fd);
}

HWY_ATTR inline Instances load(const BoxBlock& block, std::size_t first) {
    const D d;
    Instances in;
    V3* const c = in.linear.columns;
    V unused;
    hn::LoadInterleaved4(d, block.world[0][first], c[0].x, c[0].y, c[0].z, c[1].x);
    hn::LoadInterleaved4(d, block.world[1][first], c[1].y, c[1].z, c[2].x, c[2].y);
    hn::LoadInterleaved4(d, block.world[2][first], c[2].z, in.translation.x, in.translation.y, in.translation.z);
    hn::LoadInterleaved4(d, block.center[first], in.center.x, in.center.y, in.center.z, unused);
    load_shape(block.shape[0][first], in.axes[0].x, in.axes[0].y, in.axes[0].z, in.axes[1].x);
    load_shape(block.shape[1][first], in.axes[1].y, in.axes[1].z, in.axes[2].x, in.axes[2].y);
    load_shape(block.shape[2][first], in.axes[2].z, in.half_extents[0], in.half_extents[1], in.half_extents[2]);
    return in;
}

HWY_ATTR inline V error_bound(const Instances& in) {
    const D d;
    const V linear = add(size(in.linear.columns[0]), size(in.linear.columns[1]), size(in.linear.columns[2]));
    const V edges = hn::Mul(linear, add(in.half_extents[0], in.half_extents[1], in.half_extents[2]));
    const V center = hn::Add(hn::Mul(linear, size(in.center)), size(in.translation));
    return add(hn::Mul(hn::Set(d, kEdgeError), edges), hn::Mul(hn::Set(d, kCenterError), center),
               hn::Set(d, kUnderflow));
}

HWY_ATTR inline void store_shape(float* to, V a, V b, V c, V d) {
    hn::StoreInterleaved4(to_float(a), to_float(b), to_float(c), to_float(d), F(), to);
}

// The steps of transformed_box.cpp, under its names.
struct Image {
    V3 center;
    V3 half_edges[3];
    V3 edges[3];  // unit
    V error_bound;
    hn::Mask<D> in_range;       // far from underflow and overflow, and no edge next to nothing beside the longest
    hn::Mask<D> perpendicular;  // all edges
};

HWY_ATTR inline Image image_of(const Instances& in) {
    const D d;
    Image image;
    const V3 moved = in.linear * in.center;
    image.center = {hn::Add(moved.x, in.translation.x), hn::Add(moved.y, in.translation.y),
                    hn::Add(moved.z, in.translation.z)};
    image.error_bound = error_bound(in);
    V squared[3];
    for (int k = 0; k < 3; ++k) {
        const V3 edge = in.linear * in.axes[k];
        image.half_edges[k] = edge * in.half_extents[k];
        squared[k] = dot(edge, edge);
        image.edges[k] = normalised(edge, squared[k]);
    }
    const V least = hn::Min(hn::Min(squared[0], squared[1]), squared[2]);
    const V most = hn::Max(hn::Max(squared[0], squared[1]), squared[2]);
    image.in_range = hn::And(hn::And(hn::Gt(least, hn::Set(d, 1e-160)), hn::Lt(most, hn::Set(d, 1e160))),
                             hn::Gt(least, hn::Mul(hn::Set(d, 2.0 * kNothing * kNothing), most)));
    const auto small_cosine = [&](int i, int j) HWY_ATTR {
        return hn::Lt(hn::Abs(dot(image.edges[i], image.edges[j])), hn::Set(d, kPerpendicular));
    };
    image.perpendicular = hn::And(hn::And(small_cosine(0, 1), small_cosine(1, 2)), small_cosine(0, 2));
    return image;
}

struct Box {
    V3 axes[3];
    V half_extents[3];
};

HWY_ATTR inline Box box_with_axes(const Image& image, const V3& x, const V3& y) {
    const D d;
    Box box{{rounded(x), rounded(y), rounded(cross(x, y))}, {}};
    const V3* const axes = box.axes;
    const V3 normals[3] = {cross(axes[1], axes[2]), cross(axes[2], axes[0]), cross(axes[0], axes[1])};
    const V determinant = dot(axes[0], normals[0]);
    for (int k = 0; k < 3; ++k) {
        const V along =
            add(hn::Abs(dot(normals[k], image.half_edges[0])), hn::Abs(dot(normals[k], image.half_edges[1])),
                hn::Abs(dot(normals[k], image.half_edges[2])));
        const V half_extent = hn::Add(hn::Div(along, determinant), image.error_bound);
        box.half_extents[k] = float_at_least(hn::Mul(half_extent, hn::Set(d, kRoundUp)));
    }
    return box;
}

HWY_ATTR inline V3 perpendicular_part(const V3& v, const V3& unit) {
    return v - unit * dot(v, unit);
}
HWY_ATTR inline V3 normalised(const V3& v) {
    return normalised(v, dot(v, v));
}

HWY_ATTR inline void store(const Image& image, const Box& box, hn::Mask<D> done, BoxBlock& block, std::size_t first) {
    const D d;
    const V limit = hn::Set(d, 1e29);  // well below kMaxCoordinate
    done = hn::And(done, hn::Lt(size(image.center), limit));
    for (int k = 0; k < 3; ++k) done = hn::And(done, hn::Lt(box.half_extents[k], limit));
    const V3* const axes = box.axes;
    hn::StoreInterleaved4(image.center.x, image.center.y, image.center.z, image.center.z, d, block.image_center[first]);
    store_shape(block.image_shape[0][first], axes[0].x, axes[0].y, axes[0].z, axes[1].x);
    store_shape(block.image_shape[1][first], axes[1].y, axes[1].z, axes[2].x, axes[2].y);
    store_shape(block.image_shape[2][first], axes[2].z, box.half_extents[0], box.half_extents[1], box.half_extents[2]);
    hn::StoreU(hn::IfThenElseZero(done, hn::Set(d, 1.0)), d, block.done + first);
}

// A box is one long chain of operations that wait for each other. So the kernels go over all lanes in several passes.
// Each is short enough for the processor to overlap what it does for one vector and the next.
constexpr std::size_t kLanes = hn::MaxLanes(D()), kVectors = kBoxesAtOnce / kLanes;
static_assert(kBoxesAtOnce % kLanes == 0);

HWY_ATTR void run_boxes(BoxBlock& block, std::size_t count) {
    Image images[kVectors];
    V3 y[kVectors];
    const std::size_t vectors = (count + kLanes - 1) / kLanes;
    for (std::size_t i = 0; i < vectors; ++i) images[i] = image_of(load(block, i * kLanes));
    for (std::size_t i = 0; i < vectors; ++i)
        y[i] = normalised(perpendicular_part(images[i].edges[1], images[i].edges[0]));
    for (std::size_t i = 0; i < vectors; ++i)
        store(images[i], box_with_axes(images[i], images[i].edges[0], y[i]),
              hn::And(images[i].in_range, images[i].perpendicular), block, i * kLanes);
}

HWY_ATTR inline V cost_of(const Box& box, const double (&weights)[3]) {
    const D d;
    const V a = box.half_extents[0], b = box.half_extents[1], c = box.half_extents[2];
    const V eight = hn::Set(d, 8.0);
    const V volume = hn::Mul(hn::Mul(hn::Mul(eight, a), b), c);
    const V area = hn::Mul(eight, add(hn::Mul(a, b), hn::Mul(b, c), hn::Mul(c, a)));
    const V curvature = hn::Mul(hn::Set(d, std::numbers::pi), hn::Mul(hn::Set(d, 2.0), add(a, b, c)));
    return add(hn::Mul(hn::Set(d, weights[0]), volume), hn::Mul(hn::Set(d, weights[1]), area),
               hn::Mul(hn::Set(d, weights[2]), curvature));
}

// In each lane the box if it costs less than what was found before.
HWY_ATTR inline void keep_better(const Box& box, V cost, Box& best, V& least) {
    const auto better = hn::Lt(cost, least);
    const auto keep = [&](V& old, V fresh) HWY_ATTR { old = hn::IfThenElse(better, fresh, old); };
    keep(least, cost);
    for (int k = 0; k < 3; ++k) {
        keep(best.axes[k].x, box.axes[k].x);
        keep(best.axes[k].y, box.axes[k].y);
        keep(best.axes[k].z, box.axes[k].z);
        keep(best.half_extents[k], box.half_extents[k]);
    }
}

HWY_ATTR void run_sheared_boxes(BoxBlock& block, std::size_t count, const double (&weights)[3]) {
    const D d;
    const V infinity = hn::Set(d, std::numeric_limits<double>::infinity());
    Image images[kVectors];
    Box best[kVectors];
    V least[kVectors];
    hn::Mask<D> done[kVectors];
    V3 x[kVectors], y[kVectors];
    const std::size_t vectors = (count + kLanes - 1) / kLanes;
    for (std::size_t i = 0; i < vectors; ++i) {
        const Image& image = images[i] = image_of(load(block, i * kLanes));
        done[i] = hn::AndNot(image.perpendicular, image.in_range);
        best[i] = {{image.edges[0], image.edges[1], image.edges[2]}, {infinity, infinity, infinity}};
        least[i] = infinity;
    }
    for (int k = 0; k < 3; ++k) {
        for (std::size_t i = 0; i < vectors; ++i) {
            const Image& image = images[i];
            const V3 normal = cross(image.edges[(k + 1) % 3], image.edges[(k + 2) % 3]);
            const V squared = dot(normal, normal);
            done[i] = hn::And(done[i], hn::Gt(squared, hn::Set(d, 2.0 * kNothing * kNothing)));
            x[i] = normalised(normal, squared);
        }
        for (int e = 1; e <= 2; ++e) {
            for (std::size_t i = 0; i < vectors; ++i)
                y[i] = normalised(perpendicular_part(images[i].edges[(k + e) % 3], x[i]));
            for (std::size_t i = 0; i < vectors; ++i) {
                const Box box = box_with_axes(images[i], x[i], y[i]);
                keep_better(box, cost_of(box, weights), best[i], least[i]);
            }
        }
    }
    for (std::size_t i = 0; i < vectors; ++i) store(images[i], best[i], done[i], block, i * kLanes);
}

}  // namespace HWY_NAMESPACE
}  // namespace crofton::scene
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace crofton::scene {

HWY_EXPORT(run_boxes);
HWY_EXPORT(run_sheared_boxes);

void transform_boxes(BoxBlock& block, std::size_t count) {
    HWY_DYNAMIC_DISPATCH(run_boxes)(block, count);
}
void transform_sheared_boxes(BoxBlock& block, std::size_t count, const double (&weights)[3]) {
    HWY_DYNAMIC_DISPATCH(run_sheared_boxes)(block, count, weights);
}

}  // namespace crofton::scene
#endif
