// SPDX-License-Identifier: MIT
#include "triangulate_inputs.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>

namespace crofton::bench {
namespace {

constexpr std::uint32_t kNone = ~std::uint32_t{0};

// In [−1, 1], from a lattice point's coordinates (the finaliser of MurmurHash3).
double lattice(std::uint32_t x, std::uint32_t y) {
    std::uint64_t h = (std::uint64_t{x} << 32 | y) + 0x9E3779B97F4A7C15ull;
    h = (h ^ h >> 33) * 0xFF51AFD7ED558CCDull;
    h = (h ^ h >> 33) * 0xC4CEB9FE1A85EC53ull;
    return static_cast<double>((h ^ h >> 33) >> 11) * 0x1p-52 - 1.0;
}

double noise(double x, double y) {
    const double fx = std::floor(x), fy = std::floor(y);
    const auto smooth = [](double t) { return t * t * t * (t * (t * 6.0 - 15.0) + 10.0); };
    const double u = smooth(x - fx), v = smooth(y - fy);
    const auto i = static_cast<std::uint32_t>(fx), j = static_cast<std::uint32_t>(fy);
    const double low = lattice(i, j) * (1.0 - u) + lattice(i + 1, j) * u;
    const double high = lattice(i, j + 1) * (1.0 - u) + lattice(i + 1, j + 1) * u;
    return low * (1.0 - v) + high * v;
}

class MarchingSquares {
  public:
    explicit MarchingSquares(const Contours& c) : side_(c.side), values_(std::size_t{side_} * side_) {
        for (std::uint32_t y = 0; y < side_; ++y) {
            for (std::uint32_t x = 0; x < side_; ++x) {
                const bool border = x == 0 || y == 0 || x + 1 == side_ || y + 1 == side_;
                const double value = noise(x / c.wavelength, y / c.wavelength) +
                                     0.3 * noise(500.0 + 2.3 * x / c.wavelength, 2.3 * y / c.wavelength);
                values_[at(x, y)] = border ? -1.0 : value - c.level;
            }
        }
        label_regions();
        trace();
    }

    Polygon region(bool holes) const {
        std::vector<std::vector<glm::dvec2>> rings;
        std::vector<std::uint8_t> done(next_.size(), 0);
        std::size_t outer = 0;
        double largest = 0.0;
        for (std::uint32_t start = 0; start < next_.size(); ++start) {
            if (next_[start] == kNone || done[start] || region_[inside_node(start)] != largest_region_) continue;
            std::vector<glm::dvec2> ring;
            double area = 0.0;
            for (std::uint32_t e = start; !done[e]; e = next_[e]) {
                done[e] = 1;
                ring.push_back(crossing(e));
            }
            for (std::size_t i = 0; i < ring.size(); ++i) {
                const auto &p = ring[i], &q = ring[(i + 1) % ring.size()];
                area += p.x * q.y - p.y * q.x;
            }
            if (area > largest) largest = area, outer = rings.size();
            rings.push_back(std::move(ring));
        }
        Polygon result;
        if (rings.empty()) return result;
        std::swap(rings[0], rings[outer]);
        if (!holes) rings.resize(1);
        for (const auto& ring : rings) {
            result.points.insert(result.points.end(), ring.begin(), ring.end());
            result.ring_ends.push_back(static_cast<std::uint32_t>(result.points.size()));
        }
        return result;
    }

  private:
    [[nodiscard]] std::uint32_t at(std::uint32_t x, std::uint32_t y) const { return y * side_ + x; }
    [[nodiscard]] bool in(std::uint32_t node) const { return values_[node] > 0.0; }
    // Grid edges: 2·node runs to the right of a node, 2·node + 1 upwards.
    [[nodiscard]] std::uint32_t other(std::uint32_t edge) const { return edge / 2 + (edge % 2 ? side_ : 1); }
    [[nodiscard]] std::uint32_t inside_node(std::uint32_t edge) const { return in(edge / 2) ? edge / 2 : other(edge); }
    [[nodiscard]] glm::dvec2 crossing(std::uint32_t edge) const {
        const std::uint32_t a = edge / 2, b = other(edge);
        const double t = std::clamp(values_[a] / (values_[a] - values_[b]), 0.01, 0.99);
        const glm::dvec2 p(a % side_, a / side_);
        return p + (edge % 2 ? glm::dvec2(0.0, t) : glm::dvec2(t, 0.0));
    }

    void label_regions() {
        region_.assign(values_.size(), kNone);
        std::size_t largest = 0;
        std::vector<std::uint32_t> stack;
        for (std::uint32_t seed = 0; seed < values_.size(); ++seed) {
            if (!in(seed) || region_[seed] != kNone) continue;
            std::size_t size = 0;
            region_[seed] = seed;
            stack.push_back(seed);
            while (!stack.empty()) {
                const std::uint32_t n = stack.back();
                stack.pop_back();
                ++size;
                for (const std::uint32_t m : {n - 1, n + 1, n - side_, n + side_}) {
                    if (in(m) && region_[m] == kNone) {
                        region_[m] = seed;
                        stack.push_back(m);
                    }
                }
            }
            if (size > largest) largest = size, largest_region_ = seed;
        }
    }

    // Within each cell, from one crossed side to the next with the inside on the left; saddles separate the inside
    // corners, as label_regions does.
    void trace() {
        next_.assign(2 * values_.size(), kNone);
        for (std::uint32_t y = 0; y + 1 < side_; ++y) {
            for (std::uint32_t x = 0; x + 1 < side_; ++x) {
                const std::uint32_t corners[] = {at(x, y), at(x + 1, y), at(x + 1, y + 1), at(x, y + 1)};
                const std::uint32_t sides[] = {2 * at(x, y), 2 * at(x + 1, y) + 1, 2 * at(x, y + 1), 2 * at(x, y) + 1};
                // Side k joins corners k and k + 1. A run of inside corners starts after side k − 1 and ends at side j.
                for (int k = 0; k < 4; ++k) {
                    if (!in(corners[k]) || in(corners[(k + 3) % 4])) continue;
                    int j = k;
                    while (in(corners[(j + 1) % 4])) j = (j + 1) % 4;
                    next_[sides[j]] = sides[(k + 3) % 4];
                }
            }
        }
    }

    std::uint32_t side_;
    std::vector<double> values_;
    std::vector<std::uint32_t> region_, next_;
    std::uint32_t largest_region_ = 0;
};

}  // namespace

std::vector<Polygon> read_poly_file(const std::string& path, std::size_t most) {
    std::vector<Polygon> result;
    std::ifstream file(path);
    std::string tag, name;
    for (std::size_t rings = 0; file >> tag >> name >> rings;) {
        Polygon polygon;
        for (std::size_t r = 0, count = 0; r < rings && file >> count; ++r) {
            for (std::size_t i = 0; i < count; ++i) {
                glm::dvec2 p;
                file >> p.x >> p.y;
                polygon.points.push_back(p);
            }
            polygon.ring_ends.push_back(static_cast<std::uint32_t>(polygon.points.size()));
        }
        if (polygon.points.size() <= most) result.push_back(std::move(polygon));
    }
    return result;
}

Polygon noise_contours(const Contours& contours) {
    return MarchingSquares(contours).region(contours.holes);
}

}  // namespace crofton::bench
