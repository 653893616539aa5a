// SPDX-License-Identifier: MIT
// Scenes that are turned, and some that are not: what a tree's orientation is measured on.
#pragma once
#include <assets/scene_source.hpp>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <random>
#include <string>
#include <vector>

#include "cull_crowd.hpp"

namespace crofton::bench {

class SceneMaker {
  public:
    explicit SceneMaker(std::uint64_t seed) : random_(seed) {}

    // Empty where the name is none of kTurnedScenes.
    std::vector<Obb> make(const std::string& name, std::uint32_t count) {
        if (name == "crowd") return crowd(count);
        if (name == "town") return town(count);
        if (name == "town at 30") return turned(town(count), yaw(std::acos(-1.0) / 6.0));
        if (name == "districts") return districts(count);
        if (name == "roads") return roads(count);
        if (name == "straight beams") return beams(count, 0);
        if (name == "diagonal beams") return beams(count, 1);
        if (name == "beams every way") return beams(count, 2);
        return {};
    }

  private:
    double number(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }

    static glm::dmat3 yaw(double angle) {
        return {std::cos(angle), 0.0, -std::sin(angle), 0.0, 1.0, 0.0, std::sin(angle), 0.0, std::cos(angle)};
    }
    static Obb box_of(const glm::dvec3& center, const glm::dmat3& axes, const glm::dvec3& half) {
        return {center, glm::mat3(axes), glm::vec3(half)};
    }
    static glm::dvec3 middle_of(const std::vector<Obb>& boxes) {
        Aabb all;
        for (const Obb& box : boxes) all.include(box.center);
        return all.center();
    }
    static std::vector<Obb> turned(std::vector<Obb> boxes, const glm::dmat3& turn, const glm::dvec3& by = {}) {
        const glm::dvec3 middle = middle_of(boxes);
        for (Obb& box : boxes) {
            box.center = middle + by + turn * (box.center - middle);
            box.axes = glm::mat3(turn * glm::dmat3(box.axes));
        }
        return boxes;
    }

    static std::vector<Obb> town(std::uint32_t count) {
        assets::LoadOptions options;
        options.instances = count;
        auto source = assets::load_scene("town", options);
        if (!source) return {};
        source->scene.update();
        return {source->scene.world_boxes().begin(), source->scene.world_boxes().end()};
    }

    // Copies of a small town, each turned its own way.
    std::vector<Obb> districts(std::uint32_t count) {
        const std::vector<Obb> one = town(5000);
        if (one.empty()) return {};
        const glm::dvec3 middle = middle_of(one);
        double size = 0.0;
        for (const Obb& box : one) size = (std::max)(size, glm::length(box.center - middle));
        const int side = static_cast<int>(std::ceil(std::sqrt(double(count) / double(one.size()))));
        std::vector<Obb> boxes;
        for (int i = 0; i < side * side; ++i) {
            const glm::dvec3 by = 1.5 * size * glm::dvec3(i % side, 0, i / side);
            for (const Obb& box : turned(one, yaw(number(0.0, 6.28)), by)) boxes.push_back(box);
        }
        return boxes;
    }

    // Winding roads of 150 segments: surface, rails, lines, dashes and lamps.
    std::vector<Obb> roads(std::size_t count) {
        const double side = 10.0 * std::sqrt(static_cast<double>(count));
        std::vector<Obb> boxes;
        while (boxes.size() < count) {
            glm::dvec3 at(number(0.0, side), 0.0, number(0.0, side));
            double heading = number(0.0, 6.28), bend = 0.0;
            for (int segment = 0; segment < 150; ++segment) {
                if (segment % 15 == 0) bend = number(-0.03, 0.03);
                heading += bend;
                const glm::dmat3 axes = yaw(heading);
                at += 8.0 * axes[0] + glm::dvec3(0.0, number(-0.1, 0.1), 0.0);
                boxes.push_back(box_of(at, axes, {4.1, 0.1, 4.0}));
                for (const double to : {-1.0, 1.0}) {
                    boxes.push_back(box_of(at + 4.3 * to * axes[2] + 0.6 * axes[1], axes, {4.0, 0.2, 0.05}));
                    boxes.push_back(box_of(at + 3.6 * to * axes[2] + 0.11 * axes[1], axes, {4.0, 0.01, 0.08}));
                }
                boxes.push_back(box_of(at + 0.11 * axes[1], axes, {1.5, 0.01, 0.06}));
                if (segment % 4 == 0)
                    boxes.push_back(box_of(at + 5.0 * axes[2] + 4.0 * axes[1], axes, {0.1, 4.0, 0.1}));
            }
        }
        boxes.resize(count);
        return boxes;
    }

    // Bundles of 128 parallel beams: along an axis of the world, along one of its four diagonals, or any way.
    std::vector<Obb> beams(std::size_t count, int kind) {
        const double side = 6.0 * std::cbrt(static_cast<double>(count));
        std::normal_distribution<double> normal;
        std::vector<Obb> boxes;
        while (boxes.size() < count) {
            const glm::dvec3 at(number(0.0, side), number(0.0, side), number(0.0, side));
            glm::dvec3 along(0.0);
            if (kind == 0) along[static_cast<int>(number(0.0, 3.0))] = 1.0;
            if (kind == 1) along = {1.0, number(-1.0, 1.0) < 0.0 ? -1.0 : 1.0, number(-1.0, 1.0) < 0.0 ? -1.0 : 1.0};
            for (int j = 0; kind == 2 && j < 3; ++j) along[j] = normal(random_);
            const glm::dvec3 x = glm::normalize(along);
            const glm::dvec3 y =
                glm::normalize(glm::cross(x, std::abs(x.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(0, 0, 1)));
            const glm::dmat3 axes(x, y, glm::cross(x, y));
            for (int i = 0; i < 128; ++i)
                boxes.push_back(box_of(at + axes * glm::dvec3(number(-1.0, 1.0), 1.5 * (i % 8 - 4), 1.5 * (i / 8 - 8)),
                                       axes, {10.0, 0.15, 0.15}));
        }
        boxes.resize(count);
        return boxes;
    }

    std::mt19937_64 random_;
};

inline constexpr const char* kTurnedScenes[] = {"crowd",     "town",  "straight beams", "town at 30",
                                                "districts", "roads", "diagonal beams", "beams every way"};

}  // namespace crofton::bench
