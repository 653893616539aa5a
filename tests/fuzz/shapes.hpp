// SPDX-License-Identifier: MIT
// The fuzzer's bytes as numbers and shapes: most lie on a coarse grid, where shapes touch, or a few roundings beside
// it.
#pragma once
#include <cmath>
#include <crofton/geometry/box.hpp>
#include <crofton/geometry/camera.hpp>
#include <crofton/geometry/mesh.hpp>
#include <crofton/geometry/shapes.hpp>
#include <cstring>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <limits>
#include <vector>

#include "demand.hpp"

namespace crofton::fuzz {

// Reads zeros after the end.
class Shapes {
  public:
    Shapes(const std::uint8_t* data, std::size_t size) : data_(data), size_(size) {}

    [[nodiscard]] bool more() const { return at_ < size_; }
    std::uint8_t byte() { return at_ < size_ ? data_[at_++] : std::uint8_t{0}; }
    bool flag() { return (byte() & 1) != 0; }
    unsigned below(unsigned count) { return byte() % count; }  // count ≤ 256
    std::uint32_t word() {
        std::uint32_t result = 0;
        for (int i = 0; i < 4; ++i) result = result << 8 | byte();
        return result;
    }
    std::uint32_t layers() {
        if (below(4) != 0) return ~0u;
        const unsigned first = below(4);
        return 1u << first | 1u << below(4);
    }

    // Eighths in [−16, 16).
    double grid() { return static_cast<double>(static_cast<std::int8_t>(byte())) / 8.0; }
    // Finite; magnitudes in [2^-100, 2^90] or 0. Most are grid().
    double number() {
        switch (below(8)) {
            case 4:
                return steps(grid());
            case 5: {
                const double coarse = grid(), fine = coarse + grid() / 256.0;
                return std::ldexp(fine, -static_cast<int>(below(16)));
            }
            case 6: {
                const double mantissa = grid();
                return std::ldexp(mantissa, static_cast<int>(below(160)) - 80);
            }
            case 7: {
                const double coarse = grid();
                return static_cast<double>(static_cast<float>(coarse * (1.0 + grid() / 97.0)));
            }
            default:
                return grid();
        }
    }
    // Finite, of a magnitude that scenes have.
    double coordinate() {
        const double x = number();
        return std::fabs(x) < 1e7 && (x == 0.0 || std::fabs(x) > 1e-12) ? x : grid();
    }
    // Any bits at all.
    double any() {
        if (below(4) != 0) return number();
        static constexpr double kTelling[] = {-0.0,
                                              1e30,
                                              -1e30,
                                              1e31,
                                              1e300,
                                              5e-324,
                                              1e-45,
                                              std::numeric_limits<double>::infinity(),
                                              std::numeric_limits<double>::quiet_NaN()};
        if (flag()) return kTelling[below(9)];
        const std::uint64_t high = word(), bits = high << 32 | word();
        double result = 0.0;
        std::memcpy(&result, &bits, sizeof result);
        return result;
    }
    float extent() { return below(8) ? static_cast<float>(1 + byte() % 32) / 8.0f : static_cast<float>(size()); }
    glm::dvec3 point() {
        const double x = coordinate(), y = coordinate(), z = coordinate();
        return {x, y, z};
    }
    glm::dvec3 grid_point() {
        const double x = grid(), y = grid(), z = grid();
        return {x, y, z};
    }
    // Not zero; of any length.
    glm::dvec3 direction() {
        const glm::dvec3 d = grid_point();
        return d == glm::dvec3(0.0) ? glm::dvec3(0.0, 0.0, 1.0) : d;
    }
    // Up to rounding; of the signs, the quarter turns and all others.
    glm::dmat3 rotation() {
        const unsigned kind = below(4);
        if (kind == 0) return glm::dmat3(1.0);
        if (kind == 1) return glm::dmat3(glm::dvec3(0, 1, 0), glm::dvec3(0, 0, 1), glm::dvec3(1, 0, 0));
        const double w = kind == 2 ? 1.0 : grid(), s = kind == 2 ? 0.125 : 1.0;
        const glm::dvec3 v = s * direction();
        return glm::mat3_cast(glm::normalize(glm::dquat(w, v)));
    }
    RigidTransform pose() {
        const glm::dmat3 turn = rotation();
        return {turn, point()};
    }
    // Valid. Axes are as a float rounding leaves them, or off by up to 2^-15 more.
    Obb box() {
        Obb box;
        box.center = point();
        box.axes = glm::mat3(rotation());
        if (below(8) == 1)
            for (int k = 0; k < 3; ++k) {
                const int row = static_cast<int>(below(3));
                box.axes[k][row] += std::ldexp(static_cast<float>(below(3)) - 1.0f, -15);
            }
        for (int k = 0; k < 3; ++k) box.half_extents[k] = extent();
        return valid(box);
    }
    // A point of the surface, or inside: corners, edges and faces most often.
    glm::dvec3 point_of(const Obb& box) {
        glm::dvec3 p = box.center;
        for (int k = 0; k < 3; ++k) {
            const unsigned where = below(4);
            const double t = where == 0 ? -1.0 : where == 1 ? 1.0 : where == 2 ? 0.0 : grid() / 16.0;
            p += t * double(box.half_extents[k]) * glm::dvec3(box.axes[k]);
        }
        return p;
    }
    // A step of a size between 2^-60 and 1, or none, along an axis.
    glm::dvec3 nudge() {
        const unsigned kind = byte();
        glm::dvec3 result(0.0);
        if (kind & 3) result[static_cast<int>(kind >> 2) % 3] = std::ldexp(kind & 128 ? 1.0 : -1.0, -int(below(61)));
        return result;
    }
    // A box one of whose points is one of a's, or nearly.
    Obb box_at(const glm::dvec3& target) {
        Obb b = box();
        const glm::dvec3 own = point_of(b) - b.center;
        b.center = target - own + nudge();
        return valid(b);
    }
    Obb box_near(const Obb& a) { return box_at(point_of(a)); }
    // Some boxes, each alone or beside another.
    std::vector<Obb> boxes(unsigned most) {
        std::vector<Obb> result(below(most + 1));
        for (std::size_t i = 0; i < result.size(); ++i)
            result[i] = i > 0 && flag() ? box_near(result[byte() % i]) : box();
        return result;
    }

    Camera camera() {
        Camera camera;
        camera.position = point();
        camera.forward = glm::normalize(direction());
        camera.up = direction();
        camera.projection = below(3) ? Projection::perspective : Projection::orthographic;
        camera.fov_y = 0.05 + byte() / 100.0;
        camera.height = 0.25 + byte() / 8.0;
        camera.aspect = 0.125 + byte() / 64.0;
        camera.near_distance = scaled(12, -8);
        camera.far_distance = camera.near_distance + scaled(12, -2);
        if (camera.projection == Projection::perspective && below(8) == 1)
            camera.far_distance = std::numeric_limits<double>::infinity();
        return validate(camera) ? camera : Camera{};
    }
    // A camera's, or any half-spaces: bounded, unbounded, empty; some with normals that are not of unit length.
    Frustum frustum() {
        if (below(4) != 0) return *frustum_of(camera());
        Frustum frustum;
        frustum.origin = point();
        frustum.plane_count = below(8);
        for (std::uint32_t i = 0; i < frustum.plane_count; ++i) {
            frustum.planes[i].normal = direction() / 16.0;  // of components that are valid
            if (below(4) != 0) frustum.planes[i].normal = glm::normalize(frustum.planes[i].normal);
            frustum.planes[i].offset = coordinate();
        }
        return frustum;
    }
    // A point on the view's surface, where it has corners; else near its origin.
    glm::dvec3 point_of(const Frustum& frustum) {
        const auto corners = frustum_corners(frustum);
        if (!corners) return frustum.origin + direction();
        const unsigned i = below(8), j = below(8);
        const double t = below(3) ? (grid() + 16.0) / 32.0 : 0.0;
        return frustum.origin + (1.0 - t) * (*corners)[i] + t * (*corners)[j];
    }
    Ray ray() {
        Ray ray;
        ray.origin = point();
        ray.direction = direction();
        if (below(3) == 1) ray.max_t = std::fabs(grid());
        return ray;
    }
    Ray ray_through(const glm::dvec3& target) {
        Ray ray;
        ray.origin = point();
        const glm::dvec3 to = target + nudge() - ray.origin;
        if (to != glm::dvec3(0.0)) ray.direction = to;
        return ray;
    }
    Triangle triangle() {
        Triangle result;
        for (glm::dvec3& p : result) p = point();
        return result;
    }
    // A mesh of few vertices on the grid, so that triangles share points, edges and planes. Never empty.
    TriangleMesh mesh(unsigned most_vertices, unsigned most_triangles) {
        TriangleMesh mesh;
        mesh.positions.resize(3 + below(most_vertices - 2));
        for (glm::vec3& p : mesh.positions)
            for (int k = 0; k < 3; ++k) p[k] = static_cast<float>(below(8) ? grid() : coordinate());
        mesh.indices.resize(3 * (1 + below(most_triangles)));
        for (std::uint32_t& i : mesh.indices) i = byte() % static_cast<std::uint32_t>(mesh.positions.size());
        return mesh;
    }
    // The closed surface of a box or a tetrahedron with corners of its own.
    TriangleMesh solid() {
        TriangleMesh mesh;
        if (flag()) {
            const auto points = corners(box());
            for (const glm::dvec3& p : points) mesh.positions.emplace_back(p);
            mesh.indices = {0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,
                            2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5};
        } else {
            for (int i = 0; i < 4; ++i) mesh.positions.emplace_back(point());
            mesh.indices = {0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3};
        }
        return mesh;
    }

  private:
    // In [2^lowest, 2^(lowest + exponents)).
    double scaled(unsigned exponents, int lowest) {
        const double mantissa = 1.0 + byte() / 256.0;
        return std::ldexp(mantissa, static_cast<int>(below(exponents)) + lowest);
    }
    // A length of 0 or in [2^-40, 2^20].
    double size() {
        const unsigned kind = below(4);
        return kind == 0 ? 0.0 : scaled(61, -40);
    }
    double steps(double x) {
        const auto count = static_cast<std::int8_t>(byte());
        for (int i = 0; i < std::abs(count % 4); ++i) x = std::nextafter(x, count < 0 ? -1e300 : 1e300);
        return std::fabs(x) < 0x1p-100 ? 0.0 : x;
    }
    static Obb valid(const Obb& box) { return validate(box) ? box : Obb{}; }

    const std::uint8_t* data_;
    std::size_t size_, at_ = 0;
};

}  // namespace crofton::fuzz

// CROFTON_FUZZ(in) { … }: the fuzzer that judges what `in` says.
#define CROFTON_FUZZ(in)                                                                \
    static void judge(crofton::fuzz::Shapes& in);                                       \
    extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) { \
        crofton::fuzz::Shapes shapes(data, size);                                       \
        judge(shapes);                                                                  \
        crofton::fuzz::tally.execution();                                               \
        return 0;                                                                       \
    }                                                                                   \
    static void judge(crofton::fuzz::Shapes& in)
