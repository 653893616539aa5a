// SPDX-License-Identifier: MIT
// A screenshot's pixels, judged by hue.
#pragma once
#include <algorithm>
#include <cstdlib>
#include <string>
#include <vector>

namespace crofton::test {

struct Pixels {
    int width = 0, height = 0;
    std::vector<unsigned char> rgba;

    // Fails the test where the file is no picture.
    explicit Pixels(const std::string& file);
    template <class Predicate>
    [[nodiscard]] int count(Predicate is) const {
        int n = 0;
        for (std::size_t i = 0; i < rgba.size(); i += 4)
            n += is(int{rgba[i]}, int{rgba[i + 1]}, int{rgba[i + 2]}) ? 1 : 0;
        return n;
    }
    // The hues of the palette, whatever the light on them (docs/viewer.md).
    [[nodiscard]] int green() const {
        return count([](int r, int g, int b) { return g > 60 && g > 2 * r && g > 2 * b; });
    }
    [[nodiscard]] int amber() const {
        return count([](int r, int g, int b) { return r > 80 && g > r / 2 && g < r && b < g / 2; });
    }
    [[nodiscard]] int red() const {
        return count([](int r, int g, int b) { return r > 80 && g < r / 3 && b < r / 3; });
    }
    [[nodiscard]] int magenta() const {
        return count([](int r, int g, int b) { return r > 80 && b > r / 2 && g < r / 3; });
    }
    // Pixels of one colour, give or take what blending with what is behind leaves.
    [[nodiscard]] int near(int red, int green, int blue, int tolerance = 12) const {
        return count([&](int r, int g, int b) {
            return std::abs(r - red) <= tolerance && std::abs(g - green) <= tolerance &&
                   std::abs(b - blue) <= tolerance;
        });
    }
    [[nodiscard]] int different(const Pixels& other) const {
        int n = 0;
        for (std::size_t i = 0; i < std::min(rgba.size(), other.rgba.size()); i += 4)
            n += std::equal(rgba.begin() + static_cast<std::ptrdiff_t>(i),
                            rgba.begin() + static_cast<std::ptrdiff_t>(i) + 3,
                            other.rgba.begin() + static_cast<std::ptrdiff_t>(i))
                     ? 0
                     : 1;
        return n;
    }
};

}  // namespace crofton::test
