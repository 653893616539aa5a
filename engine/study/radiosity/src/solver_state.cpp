// SPDX-License-Identifier: MIT
// The state of a solver after some runs: means, errors, checkpoints.
#include <algorithm>
#include <cmath>
#include <crofton/radiosity/solver.hpp>
#include <cstring>
#include <limits>

#include "fnv1a.hpp"

namespace crofton::radiosity {
namespace {

constexpr std::uint64_t kMagic = 0x32796469'6f736964u;  // names this format and its byte order

struct Header {
    std::uint64_t magic = kMagic, fingerprint = 0, patches = 0, runs = 0, lines = 0, unseen = 0, seen = 0;
};

// Light and its squares, then the counts of rays, by patch.
std::size_t state_bytes(std::size_t patches) {
    return patches * (2 * sizeof(glm::dvec3) + 2 * sizeof(std::uint64_t));
}

// The chance that Student's t of `freedom` degrees, an even number, is within ±√square. A finite sum then, without
// trigonometry (Abramowitz and Stegun, 26.7.4): the same bits everywhere.
double student_within(double square, std::uint64_t freedom) {
    const double cos2 = 1.0 / (1.0 + square / static_cast<double>(freedom));
    double sum = 1.0, term = 1.0;
    for (std::uint64_t k = 2; k < freedom; k += 2) {
        term *= static_cast<double>(k - 1) / static_cast<double>(k) * cos2;
        sum += term;
    }
    return std::min(1.0, std::sqrt(1.0 - cos2) * sum);
}

}  // namespace

void Solver::add_run(const Light& arrived) {
    ++runs_;
    for (std::size_t i = 0; i < arrived.size(); ++i) {
        sum_[i] += arrived[i];
        squares_[i] += arrived[i] * arrived[i];
    }
    update_mean();
}

void Solver::update_mean() {
    const double n = static_cast<double>(std::max<std::uint64_t>(1, runs_));
    for (std::size_t i = 0; i < mean_.size(); ++i) {
        const Material& m = patches_->materials[i];
        mean_[i] = glm::vec3(glm::dvec3(m.emission) + glm::dvec3(m.reflectance) * sum_[i] / n);
    }
}

Vector<glm::vec3> Solver::irradiance() const {
    Vector<glm::vec3> result(sum_.size());
    const double n = static_cast<double>(std::max<std::uint64_t>(1, runs_));
    for (std::size_t i = 0; i < result.size(); ++i) result[i] = glm::vec3(sum_[i] / n);
    return result;
}

double Solver::relative_error() const {
    if (runs_ < 2) return std::numeric_limits<double>::infinity();
    const double n = static_cast<double>(runs_);
    double error = 0.0, size = 0.0;
    for (std::size_t i = 0; i < sum_.size(); ++i)
        for (int k = 0; k < 3; ++k) {
            const double mean = sum_[i][k] / n,
                         reflectance = static_cast<double>(patches_->materials[i].reflectance[k]);
            const double variance = std::max(0.0, (squares_[i][k] / n - mean * mean) * n / (n - 1.0));
            const double light = static_cast<double>(patches_->materials[i].emission[k]) + reflectance * mean;
            error += patches_->areas[i] * reflectance * reflectance * variance / n;
            size += patches_->areas[i] * light * light;
        }
    return size > 0.0 ? std::sqrt(error / size) : 0.0;
}

double Solver::share_within(double tolerance) const {
    constexpr std::uint64_t kMostFreedom = 64;  // beyond it is a normal distribution
    if (runs_ < 3 || !(tolerance > 0.0)) return 0.0;
    const std::uint64_t freedom = std::min(kMostFreedom, (runs_ - 1) / 2 * 2);
    const double n = static_cast<double>(runs_);
    double within = 0.0, patches = 0.0;
    for (std::size_t i = 0; i < sum_.size(); ++i) {
        const glm::dvec3 mean = sum_[i] / n, reflectance(patches_->materials[i].reflectance),
                         emission(patches_->materials[i].emission);
        double light = 0.0, error = 0.0;  // channels err together, as light has nearly one colour
        for (int k = 0; k < 3; ++k) {
            light += emission[k] + reflectance[k] * mean[k];
            error += reflectance[k] * std::sqrt(std::max(0.0, (squares_[i][k] / n - mean[k] * mean[k]) / (n - 1.0)));
        }
        if (!(light > 0.0)) continue;
        patches += 1.0;
        const double ratio = tolerance * light / std::max(error, 1e-9 * tolerance * light);
        within += student_within(ratio * ratio, freedom);
    }
    return patches > 0.0 ? within / patches : 1.0;
}

std::size_t Solver::bytes() const {
    const auto of = [](const auto& v) { return v.capacity() * sizeof(v[0]); };
    return of(sum_) + of(squares_) + of(drawn_) + of(buried_) + of(mean_) + of(rays_) + of(triangles_) +
           of(first_triangle_) + of(triangle_sums_) + tracer_.bytes() + bundles_.bytes();
}

double Solver::unseen() const {
    return seen_ == 0 ? 0.0 : static_cast<double>(unseen_) / static_cast<double>(seen_);
}

std::uint64_t Solver::fingerprint() const {
    std::uint64_t h = 14695981039346656037u;
    const auto add_all = [&](const auto& values) { h = fnv1a(h, std::as_bytes(std::span(values))); };
    const auto add = [&](const auto& value) { h = fnv1a(h, std::as_bytes(std::span(&value, 1))); };
    add(options_.lines);
    add(options_.first_shot);
    add(method_);
    add(options_.sequence);
    add(options_.transport);
    add(options_.seed);
    add(options_.cutoff);
    add(options_.most_bounces);
    add(options_.outside.sky);
    add(options_.outside.sun);
    add(options_.outside.to_sun);
    add_all(patches_->mesh.positions);
    add_all(patches_->mesh.indices);
    add_all(patches_->patch_of_triangle);
    add_all(patches_->materials);
    return h;
}

void Solver::forget() {
    runs_ = lines_traced_ = unseen_ = seen_ = 0;
    bounces_ = 0;
    sum_.assign(sum_.size(), glm::dvec3(0.0));
    squares_ = sum_;
    drawn_.assign(drawn_.size(), 0);
    buried_ = drawn_;
    update_mean();
}

Vector<std::byte> Solver::checkpoint() const {
    const Header header{kMagic, fingerprint(), sum_.size(), runs_, lines_traced_, unseen_, seen_};
    Vector<std::byte> bytes(sizeof header + state_bytes(sum_.size()) + sizeof(std::uint64_t));
    std::byte* to = bytes.data();
    const auto put = [&](const void* data, std::size_t size) {
        std::memcpy(to, data, size);
        to += size;
    };
    put(&header, sizeof header);
    put(sum_.data(), sum_.size() * sizeof(glm::dvec3));
    put(squares_.data(), squares_.size() * sizeof(glm::dvec3));
    put(drawn_.data(), drawn_.size() * sizeof(std::uint64_t));
    put(buried_.data(), buried_.size() * sizeof(std::uint64_t));
    const std::uint64_t check = fnv1a(kMagic, std::span(bytes).first(bytes.size() - sizeof(std::uint64_t)));
    put(&check, sizeof check);
    return bytes;
}

Result<void> Solver::resume(std::span<const std::byte> bytes) {
    Header header;
    std::uint64_t check = 0;
    if (bytes.size() < sizeof header + sizeof check) return fail(ErrorCode::parse, kNoItem, "checkpoint: too short");
    std::memcpy(&header, bytes.data(), sizeof header);
    std::memcpy(&check, bytes.data() + bytes.size() - sizeof check, sizeof check);
    if (header.magic != kMagic || check != fnv1a(kMagic, bytes.first(bytes.size() - sizeof check)))
        return fail(ErrorCode::parse, kNoItem, "checkpoint: damaged, or not one of ours");
    if (header.patches != sum_.size() || header.fingerprint != fingerprint() ||
        bytes.size() != sizeof header + state_bytes(sum_.size()) + sizeof check)
        return fail(ErrorCode::invalid_argument, kNoItem, "checkpoint: of another scene or other options");
    const std::byte* from = bytes.data() + sizeof header;
    const auto get = [&](auto& values) {
        std::memcpy(values.data(), from, values.size() * sizeof(values[0]));
        from += values.size() * sizeof(values[0]);
    };
    get(sum_);
    get(squares_);
    get(drawn_);
    get(buried_);
    runs_ = header.runs;
    lines_traced_ = header.lines;
    unseen_ = header.unseen;
    seen_ = header.seen;
    update_mean();
    return {};
}

}  // namespace crofton::radiosity
