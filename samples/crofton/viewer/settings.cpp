// SPDX-License-Identifier: MIT
#include "settings.hpp"

#include <array>
#include <utility>

#include "json/json.hpp"

namespace crofton::viewer {
namespace {

constexpr std::array<std::pair<const char*, bool Settings::*>, 16> kFlags{{{"compare", &Settings::compare},
                                                                           {"exact", &Settings::exact},
                                                                           {"collisions", &Settings::collisions},
                                                                           {"freeze", &Settings::freeze},
                                                                           {"inset", &Settings::inset},
                                                                           {"outside", &Settings::outside},
                                                                           {"bounds", &Settings::bounds},
                                                                           {"hulls", &Settings::hulls},
                                                                           {"depth_buffer", &Settings::depth_buffer},
                                                                           {"wireframe", &Settings::wireframe},
                                                                           {"seen", &Settings::seen},
                                                                           {"panels", &Settings::panels},
                                                                           {"help", &Settings::help},
                                                                           {"more", &Settings::more},
                                                                           {"history", &Settings::history},
                                                                           {"paused", &Settings::paused}}};

Error bad_value(const std::string& name, const char* wanted) {
    return fail(ErrorCode::invalid_argument, kNoItem, "switch '" + name + "' takes " + wanted);
}

// `parse` makes a value of its name, or an Error.
template <class T>
Result<void> set_parsed(T& target, const std::string& name, Result<T> (*parse)(const std::string&), const Json& value) {
    if (!value.is_string()) return bad_value(name, "a name");
    const auto parsed = parse(value.text());
    if (!parsed) return parsed.error();
    target = *parsed;
    return {};
}

// One of `names` by its place.
template <class Enum, std::size_t N>
Result<void> set_named(Enum& target, const std::string& name, const char* const (&names)[N], const Json& value) {
    std::string known;
    for (std::size_t i = 0; i < N; ++i) {
        known += (i > 0 ? ", " : "one of ") + std::string(names[i]);
        if (!value.is_string() || value.text() != names[i]) continue;
        target = static_cast<Enum>(i);
        return {};
    }
    return bad_value(name, known.c_str());
}

Result<void> set_whole(int& target, const std::string& name, const Json& value, int low, int high) {
    if (!value.is_number_integer() || value.integer() < low || value.integer() > high)
        return fail(
            ErrorCode::out_of_range, kNoItem,
            "switch '" + name + "' takes a whole number from " + std::to_string(low) + " to " + std::to_string(high));
    target = static_cast<int>(value.integer());
    return {};
}

}  // namespace

Result<void> set_switch(Settings& settings, const std::string& name, const Json& value) {
    for (const auto& [known, flag] : kFlags) {
        if (name != known) continue;
        if (!value.is_boolean()) return bad_value(name, "true or false");
        settings.*flag = value.boolean();
        return {};
    }
    const bool other = name.rfind("other_", 0) == 0;
    Method& method = other ? settings.other : settings.method;
    const std::string part = other ? name.substr(6) : name;
    if (part == "bounds_kind") return set_parsed(method.bounds, name, pipeline::bounds_kind_from, value);
    if (part == "cull") return set_parsed(method.cull, name, pipeline::cull_mode_from, value);
    if (part == "tree") return set_parsed(method.tree, name, pipeline::orientation_from, value);
    if (part == "triangulation") return set_named(method.triangulation, name, kTriangulationNames, value);
    if (part == "occlude") {
        if (!value.is_boolean()) return bad_value(name, "true or false");
        method.occlude = value.boolean();
        return {};
    }
    if (name == "tree_level") return set_whole(settings.tree_level, name, value, -1, 64);
    if (name == "cascades") return set_whole(settings.cascades, name, value, 1, 8);
    if (name == "time_scale") {
        if (!value.is_number() || !(value.number() >= 0.0 && value.number() <= 100.0))
            return bad_value(name, "a number from 0 to 100");
        settings.time_scale = value.number();
        return {};
    }
    if (name == "resolution") {
        if (!value.is_number() || !(value.number() >= kMinResolution && value.number() <= 1.0))
            return bad_value(name, "a number from 0.25 to 1");
        settings.resolution = value.number();
        return {};
    }
    if (name == "coloring") return set_named(settings.coloring, name, kColoringNames, value);
    return fail(ErrorCode::invalid_argument, kNoItem, "there is no switch '" + name + "'");
}

Json to_json(const Settings& settings) {
    Json result{{"coloring", to_string(settings.coloring)},
                {"bounds_kind", pipeline::to_string(settings.method.bounds)},
                {"cull", pipeline::to_string(settings.method.cull)},
                {"other_bounds_kind", pipeline::to_string(settings.other.bounds)},
                {"other_cull", pipeline::to_string(settings.other.cull)},
                {"tree", pipeline::to_string(settings.method.tree)},
                {"other_tree", pipeline::to_string(settings.other.tree)},
                {"triangulation", to_string(settings.method.triangulation)},
                {"other_triangulation", to_string(settings.other.triangulation)},
                {"occlude", settings.method.occlude},
                {"other_occlude", settings.other.occlude},
                {"tree_level", settings.tree_level},
                {"cascades", settings.cascades},
                {"time_scale", settings.time_scale},
                {"resolution", settings.resolution}};
    for (const auto& [name, flag] : kFlags) result[name] = settings.*flag;
    return result;
}

}  // namespace crofton::viewer
