// What a solver knows after some runs: means, errors, checkpoints.
#include <cmath>
#include <crofton/radiosity/solver.hpp>
#include <cstring>
#include <limits>

namespace crofton::radiosity {
namespace {

constexpr std::uint64_t kMagic = 0x31796469'6f736964u;  // names this format and its byte order

struct Header {
    std::uint64_t magic = kMagic, fingerprint = 0, patches = 0, runs = 0, lines = 0, unseen = 0, seen = 0;
};

std::uint64_t hash(std::uint64_t seed, const void* data, std::size_t bytes) {  // FNV-1a
    const auto* p = static_cast<const unsigned char*>(data);
    for (std::size_t i = 0; i < bytes; ++i) seed = (seed ^ p[i]) * 1099511628211u;
    return seed;
}

}  // namespace

void Solver::add_run(const Light& total) {
    ++runs_;
    for (std::size_t i = 0; i < total.size(); ++i) {
        sum_[i] += total[i];
        squares_[i] += total[i] * total[i];
        mean_[i] = glm::vec3(sum_[i] / static_cast<double>(runs_));
    }
}

double Solver::relative_error() const {
    if (runs_ < 2) return std::numeric_limits<double>::infinity();
    const double n = static_cast<double>(runs_);
    double error = 0.0, size = 0.0;
    for (std::size_t i = 0; i < sum_.size(); ++i)
        for (int k = 0; k < 3; ++k) {
            const double mean = sum_[i][k] / n;
            const double variance = std::max(0.0, (squares_[i][k] / n - mean * mean) * n / (n - 1.0));
            error += patches_->areas[i] * variance / n;
            size += patches_->areas[i] * mean * mean;
        }
    return size > 0.0 ? std::sqrt(error / size) : 0.0;
}

double Solver::unseen() const {
    return seen_ == 0 ? 0.0 : static_cast<double>(unseen_) / static_cast<double>(seen_);
}

std::uint64_t Solver::fingerprint() const {
    std::uint64_t h = 14695981039346656037u;
    const auto add = [&](const auto& value) { h = hash(h, &value, sizeof value); };
    add(options_.lines);
    add(options_.first_shot);
    add(source_.method());
    add(options_.transport);
    add(options_.seed);
    add(options_.cutoff);
    add(options_.most_bounces);
    add(options_.outside.sky);
    add(options_.outside.sun);
    add(options_.outside.to_sun);
    h = hash(h, patches_->mesh.positions.data(), patches_->mesh.positions.size() * sizeof(glm::vec3));
    h = hash(h, patches_->mesh.indices.data(), patches_->mesh.indices.size() * sizeof(std::uint32_t));
    h = hash(h, patches_->patch_of_triangle.data(), patches_->patch_of_triangle.size() * sizeof(std::uint32_t));
    return hash(h, patches_->materials.data(), patches_->materials.size() * sizeof(Material));
}

Vector<std::byte> Solver::checkpoint() const {
    const Header header{kMagic, fingerprint(), sum_.size(), runs_, lines_traced_, unseen_, seen_};
    const std::size_t size = sum_.size() * sizeof(glm::dvec3);
    Vector<std::byte> bytes(sizeof header + 2 * size + sizeof(std::uint64_t));
    std::memcpy(bytes.data(), &header, sizeof header);
    std::memcpy(bytes.data() + sizeof header, sum_.data(), size);
    std::memcpy(bytes.data() + sizeof header + size, squares_.data(), size);
    const std::uint64_t check = hash(kMagic, bytes.data(), bytes.size() - sizeof(std::uint64_t));
    std::memcpy(bytes.data() + bytes.size() - sizeof check, &check, sizeof check);
    return bytes;
}

Result<void> Solver::resume(std::span<const std::byte> bytes) {
    Header header;
    const std::size_t size = sum_.size() * sizeof(glm::dvec3);
    std::uint64_t check = 0;
    if (bytes.size() < sizeof header + sizeof check) return fail(ErrorCode::parse, kNoItem, "checkpoint: too short");
    std::memcpy(&header, bytes.data(), sizeof header);
    std::memcpy(&check, bytes.data() + bytes.size() - sizeof check, sizeof check);
    if (header.magic != kMagic || check != hash(kMagic, bytes.data(), bytes.size() - sizeof check))
        return fail(ErrorCode::parse, kNoItem, "checkpoint: damaged, or not one of ours");
    if (header.patches != sum_.size() || header.fingerprint != fingerprint() ||
        bytes.size() != sizeof header + 2 * size + sizeof check)
        return fail(ErrorCode::invalid_argument, kNoItem, "checkpoint: of another scene or other options");
    std::memcpy(sum_.data(), bytes.data() + sizeof header, size);
    std::memcpy(squares_.data(), bytes.data() + sizeof header + size, size);
    runs_ = header.runs;
    lines_traced_ = header.lines;
    unseen_ = header.unseen;
    seen_ = header.seen;
    for (std::size_t i = 0; i < sum_.size(); ++i)
        mean_[i] = runs_ == 0 ? glm::vec3(0.0f) : glm::vec3(sum_[i] / static_cast<double>(runs_));
    return {};
}

}  // namespace crofton::radiosity
