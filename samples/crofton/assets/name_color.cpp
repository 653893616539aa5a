// SPDX-License-Identifier: MIT
#include "assets/name_color.hpp"

#include <array>
#include <cstdint>
#include <string_view>

namespace crofton::assets {
namespace {

struct Known {
    std::string_view word;
    glm::vec3 color;
};

// The more telling word first: an autumn tree is not green, a stone bridge is not wood.
constexpr std::array<Known, 44> kKnown = {{
    {"autumnbirch", {0.62f, 0.45f, 0.08f}}, {"autumn", {0.55f, 0.20f, 0.04f}},  {"willow", {0.30f, 0.34f, 0.06f}},
    {"pine", {0.035f, 0.11f, 0.045f}},      {"fir", {0.04f, 0.13f, 0.05f}},     {"trunk", {0.12f, 0.07f, 0.035f}},
    {"bark", {0.12f, 0.07f, 0.035f}},       {"tree", {0.07f, 0.19f, 0.05f}},    {"corn", {0.42f, 0.38f, 0.07f}},
    {"flower", {0.50f, 0.06f, 0.10f}},      {"fern", {0.08f, 0.24f, 0.05f}},    {"grass", {0.10f, 0.25f, 0.05f}},
    {"bush", {0.09f, 0.20f, 0.05f}},        {"plant", {0.10f, 0.26f, 0.06f}},   {"leaf", {0.09f, 0.24f, 0.05f}},
    {"cattail", {0.22f, 0.22f, 0.06f}},     {"lily", {0.10f, 0.28f, 0.10f}},    {"moss", {0.12f, 0.20f, 0.05f}},
    {"hay", {0.55f, 0.40f, 0.11f}},         {"nukage", {0.10f, 0.40f, 0.06f}},  {"lava", {0.75f, 0.16f, 0.02f}},
    {"blood", {0.32f, 0.02f, 0.02f}},       {"water", {0.04f, 0.16f, 0.28f}},   {"lamp", {0.80f, 0.66f, 0.30f}},
    {"lantern", {0.80f, 0.60f, 0.24f}},     {"light", {0.80f, 0.74f, 0.52f}},   {"torch", {0.70f, 0.40f, 0.12f}},
    {"glow", {0.90f, 0.76f, 0.40f}},        {"rock", {0.25f, 0.24f, 0.22f}},    {"stone", {0.30f, 0.29f, 0.26f}},
    {"brick", {0.34f, 0.13f, 0.08f}},       {"metal", {0.28f, 0.30f, 0.33f}},   {"rail", {0.20f, 0.20f, 0.22f}},
    {"roof", {0.26f, 0.10f, 0.07f}},        {"house", {0.42f, 0.34f, 0.25f}},   {"stump", {0.18f, 0.11f, 0.06f}},
    {"log", {0.22f, 0.13f, 0.06f}},         {"wood", {0.26f, 0.15f, 0.07f}},    {"door", {0.20f, 0.11f, 0.05f}},
    {"bench", {0.24f, 0.14f, 0.07f}},       {"barrier", {0.30f, 0.19f, 0.10f}}, {"mushroom", {0.48f, 0.15f, 0.09f}},
    {"road", {0.13f, 0.12f, 0.12f}},        {"track", {0.20f, 0.19f, 0.11f}},
}};

std::string lower(const std::string& text) {
    std::string result = text;
    for (char& c : result)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    return result;
}

}  // namespace

glm::vec3 color_for_name(const std::string& name) {
    const std::string text = lower(name);
    for (const Known& known : kKnown)
        if (text.find(known.word) != std::string::npos) return known.color;
    std::uint32_t hash = 2166136261u;  // FNV-1a
    for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 16777619u;
    const auto part = [&](unsigned shift) { return static_cast<float>((hash >> shift) & 255u) / 255.0f; };
    // Greys and browns, never a shout: one brightness, a little warmth.
    const float bright = 0.18f + 0.30f * part(0);
    const float warm = 0.04f + 0.20f * part(8);
    return {bright * (1.0f + warm), bright * (1.0f + 0.1f * (part(16) - 0.5f)), bright * (1.0f - warm)};
}

}  // namespace crofton::assets
