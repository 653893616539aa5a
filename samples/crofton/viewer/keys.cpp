// SPDX-License-Identifier: MIT
#include "keys.hpp"

#include <array>

namespace crofton::viewer {
namespace {

constexpr KeyHelp kMoving[] = {
    {"W A S D", "W A S D", "fly; in an orbit: move its centre"},
    {"Q E", "Q E", "down, up"},
    {"Shift", "Shift", "four times as fast"},
    {"right drag", "", "look around; in an orbit: turn"},
    {"wheel", "", "speed; in an orbit: distance"},
    {"Tab", "Tab", "fly or orbit"},
    {"Home", "Home", "frame the whole scene"},
    {"1 to 9", "1 2 3 4 5 6 7 8 9", "go to a bookmark"},
    {"Ctrl+1 to 9", "Ctrl+1 Ctrl+2 Ctrl+3 Ctrl+4 Ctrl+5 Ctrl+6 Ctrl+7 Ctrl+8 Ctrl+9", "set a bookmark"},
};
constexpr KeyHelp kSeeing[] = {
    {"left click", "", "pick an instance; the sky: none"},
    {"C", "C", "next colouring; the legend is next to the statistics"},
    {"B", "B", "bounds of visible objects, as boxes"},
    {"O", "O", "culled, as boxes: red outside, violet hidden"},
    {"U", "U", "convex hulls of visible objects; for movers also contact points, normals, manifolds"},
    {"T", "T", "bounds of the tree's nodes, level by level"},
    {"J", "J", "the occluders' depth buffer, as a picture"},
    {"X", "X", "triangles as wires"},
    {"I", "I", "a second picture, from outside"},
    {"H", "H", "hide or show the panels"},
    {"F1", "F1", "this help"},
};
constexpr KeyHelp kCulling[] = {
    {"F", "F", "freeze: culling keeps its camera while you fly on"},
    {"N", "N", "next kind of bounds"},
    {"M", "M", "next culling mode: none, flat, tree"},
    {"F4", "F4", "next axes of the tree's bounds: aligned, oriented, automatic"},
    {"Z", "Z", "occlusion culling: objects hidden behind others are left out"},
    {"L", "L", "exact, or by planes only (conservative)"},
    {"V", "V", "number of views the depth range is split into"},
    {"Y", "Y", "next triangulation of polygons and flat patches"},
    {"K", "K", "collisions on or off"},
    {"G", "G", "compare two methods, A and B, on the same frame"},
};
constexpr KeyHelp kTime[] = {
    {"P, Space", "P Space", "pause"},
    {".", ".", "one step"},
    {"+ -", "+ -", "twice, half the speed of time"},
};
constexpr KeyHelp kFiles[] = {
    {"R", "R", "record the camera's path; again: save camera_path.json"},
    {"F6", "F6", "replay the path last recorded or loaded"},
    {"F2", "F2", "save the picture as PNG"},
    {"F5", "F5", "save statistics as JSON, CSV and Chrome trace"},
    {"drop a file", "", "open it as the scene"},
    {"Escape, Ctrl+Q", "Escape Ctrl+Q", "quit"},
};
constexpr std::array<KeyGroup, 5> kGroups{
    {{"Move", kMoving}, {"See", kSeeing}, {"Cull and collide", kCulling}, {"Time", kTime}, {"Files", kFiles}}};

const KeyHelp* find(const std::string& name) {
    if (name.empty() || name.find(' ') != std::string::npos) return nullptr;
    for (const KeyGroup& group : kGroups)
        for (const KeyHelp& key : group.keys)
            if ((" " + std::string(key.names) + " ").find(" " + name + " ") != std::string::npos) return &key;
    return nullptr;
}

}  // namespace

std::span<const KeyGroup> key_groups() {
    return kGroups;
}

bool is_key(const std::string& name) {
    return find(name) != nullptr;
}

const char* what_key_does(const std::string& name) {
    return find(name)->does;
}

std::string key_help() {
    std::string text;
    for (const KeyGroup& group : kGroups) {
        text += std::string(group.title) + ":\n";
        for (const KeyHelp& key : group.keys) {
            std::string line = "  " + std::string(key.shown);
            line.resize(std::max<std::size_t>(line.size() + 1, 18), ' ');
            text += line + key.does + "\n";
        }
    }
    return text;
}

}  // namespace crofton::viewer
