// SPDX-License-Identifier: MIT
#include "assets/gltf_node.hpp"

#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <optional>

namespace crofton::assets {
namespace {

using Json = nlohmann::ordered_json;

// `count` numbers, or nothing where the member is not there. Errors: of another length, not numbers.
Result<std::optional<std::vector<double>>> numbers(const Json& object, const char* key, std::size_t count) {
    const Json* list = member(object, key);
    if (!list) return std::nullopt;
    std::vector<double> result;
    for (std::size_t i = 0; list->is_array() && i < list->size() && list->at(i).is_number(); ++i)
        result.push_back(list->at(i).get<double>());
    if (result.size() == count && list->size() == count) return result;
    return fail(ErrorCode::parse, kNoItem,
                std::string("its ") + key + " has not " + std::to_string(count) + " numbers");
}

Result<Transform> from_parts(const glm::dvec3& translation, const glm::dquat& rotation, const glm::dvec3& scale) {
    const double length = glm::length(rotation);
    if (!(length > 1e-6) || !std::isfinite(length))
        return fail(ErrorCode::degenerate, kNoItem, "its rotation is no quaternion of length one");
    return from_trs(translation, rotation / length, scale);
}

// An attribute's floats, `components` each; empty where there is none. `count` is that of the attributes read before.
Result<std::vector<float>> attribute(const GltfDocument& document, const Json& attributes, const char* name,
                                     int components, std::optional<std::size_t>& count) {
    const Json* accessor = member(attributes, name);
    if (!accessor) return std::vector<float>{};
    const auto bad = [&](ErrorCode code, const std::string& why) {
        return fail(code, kNoItem, std::string(name) + ": " + why);
    };
    const auto number = as_whole_number(*accessor);
    if (!number) return bad(ErrorCode::parse, "names no accessor");
    std::string storage;
    const auto elements = accessor_elements(document, *number, std::nullopt, storage);
    if (!elements) return bad(elements.error().code, elements.error().message);
    if (elements->components != components)
        return bad(ErrorCode::parse, "not of " + std::to_string(components) + " components");
    if (count && *count != elements->count)
        return bad(ErrorCode::out_of_range, std::to_string(elements->count) +
                                                " instances, where another attribute has " + std::to_string(*count));
    count = elements->count;
    if (*count > document.limits.nodes) return over_limit("nodes", document.limits.nodes);
    return to_floats(*elements, components);
}

}  // namespace

Result<Transform> transform_of(const Json& node) {
    const auto matrix = numbers(node, "matrix", 16), translation = numbers(node, "translation", 3),
               turn = numbers(node, "rotation", 4), scale = numbers(node, "scale", 3);
    for (const auto* part : {&matrix, &translation, &turn, &scale})
        if (!*part) return part->error();
    if (*matrix) {
        glm::dmat4 m;
        for (int i = 0; i < 16; ++i) m[i / 4][i % 4] = (**matrix)[static_cast<std::size_t>(i)];
        return from_matrix(m);
    }
    const auto vector = [](const std::optional<std::vector<double>>& v, double otherwise) {
        return v ? glm::dvec3((*v)[0], (*v)[1], (*v)[2]) : glm::dvec3(otherwise);
    };
    glm::dquat rotation(1.0, 0.0, 0.0, 0.0);
    if (*turn) rotation = glm::dquat((**turn)[3], (**turn)[0], (**turn)[1], (**turn)[2]);
    return from_parts(vector(*translation, 0.0), rotation, vector(*scale, 1.0));
}

Result<bool> is_visible(const Json& node) {
    const Json* extensions = member(node, "extensions");
    const Json* visibility = extensions ? member(*extensions, "KHR_node_visibility") : nullptr;
    const Json* visible = visibility ? member(*visibility, "visible") : nullptr;
    if (!visible) return true;
    if (visible->is_boolean()) return visible->get<bool>();
    return fail(ErrorCode::parse, kNoItem, "KHR_node_visibility: visible is neither true nor false");
}

const Json* instancing_of(const Json& node) {
    const Json* extensions = member(node, "extensions");
    return extensions ? member(*extensions, "EXT_mesh_gpu_instancing") : nullptr;
}

Result<Placements> placements(const GltfDocument& document, const Json& instancing) {
    const Json* attributes = member(instancing, "attributes");
    if (!attributes || !attributes->is_object() || attributes->empty())
        return fail(ErrorCode::parse, kNoItem, "has no attributes");
    std::optional<std::size_t> count;
    const auto translation = attribute(document, *attributes, "TRANSLATION", 3, count);
    if (!translation) return translation.error();
    const auto turn = attribute(document, *attributes, "ROTATION", 4, count);
    if (!turn) return turn.error();
    const auto scale = attribute(document, *attributes, "SCALE", 3, count);
    if (!scale) return scale.error();
    // Attributes of one's own count the instances, too.
    for (const auto& item : attributes->items())
        if (const auto own = whole_number(*attributes, item.key().c_str(), kNoNumber); !count && own)
            if (const Json* accessor = entry(document.root, "accessors", *own))
                if (const auto given = whole_number(*accessor, "count", 0); given && *given <= document.limits.nodes)
                    count = *given;
    if (!count) return fail(ErrorCode::parse, kNoItem, "none of its attributes can be read");
    Placements result;
    for (std::size_t i = 0; i < *count; ++i) {
        const auto vector = [&](const std::vector<float>& v, double otherwise) {
            return v.empty() ? glm::dvec3(otherwise) : glm::dvec3(v[3 * i], v[3 * i + 1], v[3 * i + 2]);
        };
        glm::dquat rotation(1.0, 0.0, 0.0, 0.0);
        if (!turn->empty())
            rotation = glm::dquat((*turn)[4 * i + 3], (*turn)[4 * i], (*turn)[4 * i + 1], (*turn)[4 * i + 2]);
        const auto made = from_parts(vector(*translation, 0.0), rotation, vector(*scale, 1.0));
        if (made)
            result.transforms.push_back(*made);
        else if (result.left_out++ == 0)
            result.why = "instance " + std::to_string(i) + ": " + made.error().message;
    }
    return result;
}

}  // namespace crofton::assets
