// SPDX-License-Identifier: MIT
#include "assets/gltf_pose.hpp"

#include <algorithm>
#include <cmath>

#include "assets/gltf_node.hpp"

namespace crofton::assets {
namespace {

using Json = nlohmann::ordered_json;

Error in(const std::string& what, Error error) {
    error.message = what + ": " + error.message;
    return error;
}

// More joints than 64 a vertex is no skin, but a file that asks for much.
constexpr std::size_t kMostSets = 16;

Result<std::vector<float>> vertex_values(const GltfDocument& document, const Json& accessor, int components,
                                         std::size_t count, bool joints = false) {
    const auto number = as_whole_number(accessor);
    if (!number) return fail(ErrorCode::parse, kNoItem, "names no accessor");
    std::string storage;
    const auto elements = accessor_elements(document, *number, count, storage);
    if (!elements) return elements.error();
    if (elements->components != components)
        return fail(ErrorCode::parse, kNoItem, "not of " + std::to_string(components) + " components");
    const int type = elements->component_type;
    if (joints && (elements->normalized || (type != kGltfUnsignedByte && type != kGltfUnsignedShort)))
        return fail(ErrorCode::parse, kNoItem, "joints must be unsigned bytes or shorts");
    return to_floats(*elements, components);
}

// A skin's inverse bind matrices; identities where it has none.
Result<std::vector<Transform>> bind_matrices(const GltfDocument& document, const Json& skin, std::size_t count) {
    std::vector<Transform> result(count);
    const Json* accessor = member(skin, "inverseBindMatrices");
    if (!accessor) return result;
    const auto number = as_whole_number(*accessor);
    std::string storage;
    const auto elements = accessor_elements(document, number.value_or(kNoNumber), std::nullopt, storage);
    if (!elements) return in("inverseBindMatrices", elements.error());
    if (elements->components != 16 || elements->count < count)
        return fail(ErrorCode::parse, kNoItem,
                    "inverseBindMatrices: " + std::to_string(elements->count) + " matrices for " +
                        std::to_string(count) + " joints");
    const std::vector<float> values = to_floats(*elements, 16);
    for (std::size_t j = 0; j < count; ++j) {
        glm::dmat4 m;
        for (std::size_t i = 0; i < 16; ++i)
            m[static_cast<int>(i / 4)][static_cast<int>(i % 4)] = static_cast<double>(values[16 * j + i]);
        // Some exporters round the last row.
        for (int k = 0; k < 4; ++k)
            if (const double exact = k == 3 ? 1.0 : 0.0; std::abs(m[k][3] - exact) < 1e-4) m[k][3] = exact;
        auto made = from_matrix(m);
        if (!made) return in("inverse bind matrix " + std::to_string(j), made.error());
        result[j] = *made;
    }
    return result;
}

struct Influences {
    std::vector<float> joints, weights;  // four a vertex
};

// All sets JOINTS_n, WEIGHTS_n.
Result<std::vector<Influences>> influences_of(const GltfDocument& document, const Json& primitive, std::size_t count) {
    std::vector<Influences> sets;
    const Json& attributes = primitive.at("attributes");
    for (std::size_t n = 0;; ++n) {
        const std::string joints_name = "JOINTS_" + std::to_string(n), weights_name = "WEIGHTS_" + std::to_string(n);
        const Json *joints = member(attributes, joints_name.c_str()),
                   *weights = member(attributes, weights_name.c_str());
        if (!joints && !weights && n > 0) return sets;
        if (!joints || !weights)
            return fail(ErrorCode::parse, kNoItem, "has no " + (joints ? weights_name : joints_name));
        if (n == kMostSets) return fail(ErrorCode::unsupported, kNoItem, "has more than 16 sets of joints");
        auto numbers = vertex_values(document, *joints, 4, count, true),
             shares = vertex_values(document, *weights, 4, count);
        if (!numbers) return in(joints_name, numbers.error());
        if (!shares) return in(weights_name, shares.error());
        for (std::size_t i = 0; i < shares->size(); ++i)
            if (!((*shares)[i] >= 0.0f) || !std::isfinite((*shares)[i]))
                return fail(ErrorCode::non_finite, i / 4,
                            weights_name + ": vertex " + std::to_string(i / 4) + " has a weight of " +
                                std::to_string((*shares)[i]));
        sets.push_back({std::move(*numbers), std::move(*shares)});
    }
}

}  // namespace

Result<std::vector<double>> morph_weights(const Json& node, const Json& mesh) {
    const Json* own = member(node, "weights");
    const Json* list = own ? own : member(mesh, "weights");
    std::vector<double> result;
    if (!list) return result;
    if (!list->is_array()) return fail(ErrorCode::parse, kNoItem, "its weights are no list");
    for (const Json& weight : *list) {
        if (!weight.is_number() || !std::isfinite(weight.get<double>()))
            return fail(ErrorCode::non_finite, result.size(),
                        "weight " + std::to_string(result.size()) + " is no finite number");
        result.push_back(weight.get<double>());
    }
    if (std::all_of(result.begin(), result.end(), [](double w) { return w == 0.0; })) result.clear();
    return result;
}

Result<void> apply_morph(const GltfDocument& document, const Json& primitive, std::span<const double> weights,
                         const Deadline& deadline, std::span<glm::dvec3> positions) {
    if (weights.empty()) return {};
    const std::size_t targets = entry_count(primitive, "targets");
    if (targets != weights.size())
        return fail(ErrorCode::out_of_range, kNoItem,
                    std::to_string(weights.size()) + " weights for " + std::to_string(targets) + " morph targets");
    for (std::size_t t = 0; t < targets; ++t) {
        const Json* moves = member(*entry(primitive, "targets", t), "POSITION");
        if (!moves || weights[t] == 0.0) continue;
        if (auto in_time = deadline.check(); !in_time) return in_time;
        const auto values = vertex_values(document, *moves, 3, positions.size());
        if (!values) return in("target " + std::to_string(t) + ": POSITION", values.error());
        for (std::size_t v = 0; v < positions.size(); ++v)
            positions[v] += weights[t] * glm::dvec3((*values)[3 * v], (*values)[3 * v + 1], (*values)[3 * v + 2]);
    }
    return {};
}

Result<std::span<const Transform>> SkinPoses::joints(std::size_t skin) {
    auto known = joints_.find(skin);
    if (known == joints_.end()) {
        auto made = compute(skin);
        if (!made) made = in("skin " + std::to_string(skin), made.error());
        known = joints_.emplace(skin, std::move(made)).first;
    }
    if (!known->second) return known->second.error();
    return std::span<const Transform>(*known->second);
}

Result<std::vector<Transform>> SkinPoses::compute(std::size_t skin) {
    const Json* description = entry(document_.root, "skins", skin);
    if (!description) return fail(ErrorCode::out_of_range, skin, "does not exist");
    const std::size_t count = entry_count(*description, "joints");
    if (count == 0) return fail(ErrorCode::parse, skin, "has no joints");
    auto result = bind_matrices(document_, *description, count);
    if (!result) return result;
    for (std::size_t j = 0; j < count; ++j) {
        const auto node = as_whole_number(*entry(*description, "joints", j));
        const auto place = world(node.value_or(kNoNumber));
        if (!place) return in("joint " + std::to_string(j), place.error());
        (*result)[j] = *place * (*result)[j];
    }
    return result;
}

// From the root down; what was computed before is remembered.
Result<Transform> SkinPoses::world(std::size_t node) {
    const std::size_t count = entry_count(document_.root, "nodes");
    if (worlds_.empty()) {
        worlds_.resize(count);
        parents_.assign(count, kNoNumber);
        for (std::size_t n = 0; n < count; ++n)
            for (std::size_t i = 0; const Json* child = entry(*entry(document_.root, "nodes", n), "children", i); ++i)
                if (const auto number = as_whole_number(*child); number && *number < count) parents_[*number] = n;
    }
    if (node >= count) return fail(ErrorCode::out_of_range, kNoItem, "its node does not exist");
    std::vector<std::size_t> chain;
    for (std::size_t n = node; n != kNoNumber && !worlds_[n]; n = parents_[n]) {
        if (chain.size() == count) {
            const auto why = fail(ErrorCode::parse, n, "node " + std::to_string(n) + " is its own ancestor");
            for (const std::size_t cyclic : chain) worlds_[cyclic] = why;
            return why;
        }
        chain.push_back(n);
    }
    for (; !chain.empty(); chain.pop_back()) worlds_[chain.back()] = below_parent(chain.back());
    return *worlds_[node];
}

// The parent's world transform, where there is a parent, has been computed.
Result<Transform> SkinPoses::below_parent(std::size_t node) const {
    const std::size_t parent = parents_[node];
    if (parent != kNoNumber && !*worlds_[parent]) return *worlds_[parent];
    const auto local = transform_of(*entry(document_.root, "nodes", node));
    if (!local) return in("node " + std::to_string(node), local.error());
    return parent == kNoNumber ? *local : **worlds_[parent] * *local;
}

Result<void> apply_skin(const GltfDocument& document, const Json& primitive, std::span<const Transform> joints,
                        std::span<glm::dvec3> positions) {
    const auto sets = influences_of(document, primitive, positions.size());
    if (!sets) return sets.error();
    for (std::size_t v = 0; v < positions.size(); ++v) {
        glm::dvec3 sum(0.0);
        double total = 0.0;
        for (const Influences& set : *sets)
            for (std::size_t i = 4 * v; i < 4 * v + 4; ++i) {
                const auto weight = static_cast<double>(set.weights[i]);
                if (weight == 0.0) continue;
                if (!(set.joints[i] < static_cast<float>(joints.size())))
                    return fail(ErrorCode::out_of_range, v,
                                "vertex " + std::to_string(v) + ": joint " + std::to_string(set.joints[i]) + " of " +
                                    std::to_string(joints.size()));
                sum += weight * (joints[static_cast<std::size_t>(set.joints[i])] * positions[v]);
                total += weight;
            }
        if (total > 0.0) {
            positions[v] = sum / total;
            continue;
        }
        const auto first = static_cast<std::size_t>((*sets)[0].joints[4 * v]);
        positions[v] = joints[std::min(first, joints.size() - 1)] * positions[v];
    }
    return {};
}

}  // namespace crofton::assets
