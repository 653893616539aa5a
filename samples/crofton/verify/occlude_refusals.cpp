// SPDX-License-Identifier: MIT
#include "occlude_refusals.hpp"

#include <cmath>
#include <crofton/core/error.hpp>
#include <crofton/geometry/mesh.hpp>
#include <crofton/occlude/occlusion.hpp>
#include <limits>
#include <utility>

namespace crofton::cli {
namespace {

using sampling::Random;
using Mesh = TriangleMesh;

constexpr occlude::BufferSize kRefusalSize{64, 36};
constexpr std::uint64_t kAnyItem = kNoItem;

// A turned box of six to twelve metres, straight ahead of the default camera: it would cover most of the picture.
Mesh random_closed_mesh(Random& random) {
    Mesh mesh;
    const glm::dmat3 turn = sampling::rotation(random.point<3>());
    const double x = random.uniform(3.0, 6.0), y = random.uniform(3.0, 6.0), z = random.uniform(3.0, 6.0);
    for (unsigned i = 0; i < 8; ++i) {
        const glm::dvec3 corner(i & 1u ? x : -x, i & 2u ? y : -y, i & 4u ? z : -z);
        mesh.positions.push_back(glm::vec3(turn * corner + glm::dvec3(0.0, 0.0, -20.0)));
    }
    mesh.indices = {0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5, 0, 1, 5, 0, 5, 4,
                    2, 6, 7, 2, 7, 3, 0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6};
    return mesh;
}

Obb random_box(Random& random) {
    Obb box;
    box.center = {0.0, 0.0, -20.0};
    box.axes = glm::mat3(sampling::rotation(random.point<3>()));
    for (int k = 0; k < 3; ++k) box.half_extents[k] = static_cast<float>(random.uniform(3.0, 6.0));
    return box;
}

double not_a_number(Random& random) {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    const double kinds[] = {std::numeric_limits<double>::quiet_NaN(), kInfinity, -kInfinity};
    return kinds[random.bits() % 3];
}

// A set with one small box, and what that box hides.
class RefusalTrial {
  public:
    RefusalTrial() : buffer_(*occlude::OcclusionBuffer::create(kRefusalSize)) {
        Obb box;
        box.center = {0.0, 0.0, -10.0};
        box.half_extents = {1.0f, 1.0f, 1.0f};
        box_ = set_.place(box).value();
        Random random(1);
        shape_ = set_.add_mesh(random_closed_mesh(random)).value();
        before_ = depth();
    }

    void must_take(const Result<occlude::ShapeId>& shape) {
        ++result.tried;
        if (!shape || !set_.remove_shape(*shape)) ++result.wrong;
    }
    void must_refuse(const Result<occlude::ShapeId>& shape, ErrorCode code, std::uint64_t item) {
        judge(shape, code, item);
        if (shape) (void)set_.place(*shape, {});
    }
    template <class Value>
    void judge(const Result<Value>& answer, ErrorCode code, std::uint64_t item) {
        ++result.tried;
        const bool named = !answer && answer.error().code == code && !answer.error().message.empty();
        if (!named || (item != kAnyItem && answer.error().item != item)) ++result.wrong;
    }
    // Placed anew, and moved there.
    void must_refuse(const Obb& box, ErrorCode code) {
        judge(set_.place(box), code, 1);
        judge(set_.move(box_, box), code, box_);
    }
    void must_refuse(const Transform& transform, ErrorCode code) {
        judge(set_.place(shape_, transform), code, kAnyItem);
    }
    void must_hide_as_before() {
        ++result.tried;
        if (depth() != before_) ++result.wrong;
    }

    [[nodiscard]] occlude::OccluderSet& set() { return set_; }
    Refusals result{};

  private:
    std::vector<float> depth() {
        std::vector<float> nearness(std::size_t{kRefusalSize.width} * kRefusalSize.height);
        buffer_.draw(set_, *occlude::occlusion_view_of(Camera{}));
        buffer_.read(nearness);
        return nearness;
    }

    occlude::OccluderSet set_;
    occlude::OcclusionBuffer buffer_;
    occlude::OccluderId box_ = 0;
    occlude::ShapeId shape_ = 0;
    std::vector<float> before_;
};

void try_open(Random& random, RefusalTrial& trial) {
    Mesh mesh = random_closed_mesh(random);
    trial.must_take(trial.set().add_mesh(mesh));
    const auto hole = static_cast<std::ptrdiff_t>(3 * (random.bits() % 12));
    mesh.indices.erase(mesh.indices.begin() + hole, mesh.indices.begin() + hole + 3);
    trial.must_refuse(trial.set().add_mesh(mesh), ErrorCode::invalid_argument, kAnyItem);
    // Two triangles turned over: each edge around them is gone along twice.
    mesh = random_closed_mesh(random);
    const std::size_t face = 6 * (random.bits() % 6);
    std::swap(mesh.indices[face], mesh.indices[face + 1]);
    std::swap(mesh.indices[face + 3], mesh.indices[face + 4]);
    trial.must_refuse(trial.set().add_mesh(mesh), ErrorCode::invalid_argument, kAnyItem);
}

void try_inside_out(Random& random, RefusalTrial& trial) {
    Mesh mesh = random_closed_mesh(random);
    trial.must_take(trial.set().add_mesh(mesh));
    for (std::size_t t = 0; t < mesh.indices.size(); t += 3) std::swap(mesh.indices[t], mesh.indices[t + 1]);
    trial.must_refuse(trial.set().add_mesh(mesh), ErrorCode::invalid_argument, kAnyItem);
}

void try_flat(Random& random, RefusalTrial& trial) {
    Mesh mesh = random_closed_mesh(random);
    trial.must_take(trial.set().add_convex(mesh.positions));
    for (int k = 0; k < 3; ++k) {
        Obb box = random_box(random);
        box.half_extents[k] = 0.0f;
        trial.must_refuse(box, ErrorCode::degenerate);
        glm::dmat3 flat = sampling::rotation(random.point<3>());
        flat[k] = glm::dvec3(0.0);
        trial.must_refuse({flat, {}}, ErrorCode::degenerate);
        Mesh pressed = mesh;
        for (glm::vec3& p : pressed.positions) p[k] = -20.0f;
        trial.must_refuse(trial.set().add_mesh(pressed), ErrorCode::degenerate, kAnyItem);
        trial.must_refuse(trial.set().add_convex(pressed.positions), ErrorCode::degenerate, kAnyItem);
    }
    // All in one line: no triangle has an area.
    for (glm::vec3& p : mesh.positions) p = {p.x, -2.0f, -20.0f};
    trial.must_refuse(trial.set().add_surface(mesh, occlude::Sides::both), ErrorCode::degenerate, kAnyItem);
}

void try_not_a_number(Random& random, RefusalTrial& trial) {
    const Mesh mesh = random_closed_mesh(random);
    trial.must_take(trial.set().add_surface(mesh, occlude::Sides::both));
    for (int k = 0; k < 3; ++k) {
        Mesh damaged = mesh;
        const std::uint64_t vertex = random.bits() % 8;
        damaged.positions[vertex][k] = static_cast<float>(not_a_number(random));
        trial.must_refuse(trial.set().add_mesh(damaged), ErrorCode::non_finite, vertex);
        trial.must_refuse(trial.set().add_surface(damaged, occlude::Sides::front), ErrorCode::non_finite, vertex);
        trial.must_refuse(trial.set().add_convex(damaged.positions), ErrorCode::non_finite, vertex);
        Obb boxes[3] = {random_box(random), random_box(random), random_box(random)};
        boxes[0].center[k] = not_a_number(random);
        boxes[1].axes[k][static_cast<int>(random.bits() % 3)] = static_cast<float>(not_a_number(random));
        boxes[2].half_extents[k] = static_cast<float>(not_a_number(random));
        for (const Obb& box : boxes) trial.must_refuse(box, ErrorCode::non_finite);
        glm::dvec3 place(0.0);
        place[k] = not_a_number(random);
        trial.must_refuse({glm::dmat3(1.0), place}, ErrorCode::non_finite);
        glm::dmat3 linear(1.0);
        linear[k][static_cast<int>(random.bits() % 3)] = not_a_number(random);
        trial.must_refuse({linear, {}}, ErrorCode::non_finite);
    }
}

}  // namespace

std::vector<Refusals> try_bad_occluders(Random& random, std::uint64_t rounds) {
    constexpr std::pair<const char*, void (*)(Random&, RefusalTrial&)> kKinds[] = {
        {"open", try_open}, {"inside out", try_inside_out}, {"flat", try_flat}, {"not finite", try_not_a_number}};
    std::vector<Refusals> results;
    for (const auto& [name, attempt] : kKinds) {
        RefusalTrial trial;
        trial.result.kind = name;
        for (std::uint64_t round = 0; round < rounds; ++round) {
            attempt(random, trial);
            trial.must_hide_as_before();
        }
        results.push_back(trial.result);
    }
    return results;
}

}  // namespace crofton::cli
