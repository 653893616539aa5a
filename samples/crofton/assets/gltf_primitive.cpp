// SPDX-License-Identifier: MIT
#include "assets/gltf_primitive.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <limits>
#include <numeric>

#include "assets/gltf_compression.hpp"

namespace crofton::assets {
namespace {

using Json = nlohmann::ordered_json;

// Extensions of primitives that say nothing about which triangles there are.
constexpr std::array<std::string_view, 3> kHarmless = {"KHR_materials_variants", "EXT_mesh_features",
                                                       "EXT_structural_metadata"};

bool begins(std::string_view text, std::string_view with) {
    return text.substr(0, with.size()) == with;
}

// Half a step of what integers can say; what they number (of unknown meaning) must not be mixed up.
double rounding_of(std::string_view name, const Elements& elements) {
    const std::size_t bits = 8 * component_size(elements.component_type);
    if (elements.component_type == kGltfFloat || elements.component_type == kGltfDouble) return 0.0;
    if (!elements.normalized) return begins(name, "_") ? 0.0 : 0.5;
    const bool is_signed = elements.component_type == kGltfByte || elements.component_type == kGltfShort;
    return 0.5 / (std::exp2(static_cast<double>(bits - is_signed)) - 1.0);
}

class PrimitiveReader {
  public:
    PrimitiveReader(const GltfDocument& document, const Json& primitive, const ValueTolerances& tolerances)
        : document_(document), primitive_(primitive), tolerances_(tolerances) {}

    Result<PrimitiveGeometry> read() {
        if (auto done = read_positions(); !done) return done.error();
        if (auto done = read_indices(); !done) return done.error();
        if (auto valid = validate(result_.mesh); !valid) return valid.error();
        result_.position_tolerance = patch_tolerance(result_.mesh, tolerances_.position);
        if (std::isinf(tolerances_.attribute)) return std::move(result_);
        for (const auto& item : primitive_.at("attributes").items()) {
            if (item.key() == "POSITION") continue;
            if (auto done = read_values(item.key(), item.value(), tolerances_.attribute); !done) return done.error();
        }
        const Json* targets = member(primitive_, "targets");
        for (std::size_t i = 0; targets && targets->is_array() && i < targets->size(); ++i) {
            if (!targets->at(i).is_object()) continue;
            for (const auto& item : targets->at(i).items()) {
                const bool moves = item.key() == "POSITION";
                const double tolerance = moves ? result_.position_tolerance : tolerances_.attribute;
                if (auto done = read_values(item.key(), item.value(), tolerance); !done)
                    return in(("target " + std::to_string(i)).c_str(), done.error());
            }
        }
        return std::move(result_);
    }

  private:
    static Error in(const std::string& what, Error error) {
        error.message = what + ": " + error.message;
        return error;
    }

    Result<Elements> elements(const Json& accessor, std::optional<std::size_t> count, std::string& storage) const {
        const auto number = as_whole_number(accessor);
        if (!number) return fail(ErrorCode::parse, kNoItem, "names no accessor");
        return accessor_elements(document_, *number, count, storage);
    }

    Result<void> read_positions() {
        std::string storage;
        const auto placed = elements(primitive_.at("attributes").at("POSITION"), std::nullopt, storage);
        if (!placed) return in("POSITION", placed.error());
        if (placed->components != 3) return fail(ErrorCode::parse, kNoItem, "POSITION: not of three components");
        const std::vector<float> xyz = to_floats(*placed, 3);
        result_.mesh.positions.reserve(placed->count);
        for (std::size_t i = 0; i < xyz.size(); i += 3)
            result_.mesh.positions.emplace_back(xyz[i], xyz[i + 1], xyz[i + 2]);
        return {};
    }

    Result<void> read_indices() {
        std::vector<std::uint32_t> indices;
        if (const Json* accessor = member(primitive_, "indices")) {
            std::string storage;
            const auto placed = elements(*accessor, std::nullopt, storage);
            if (!placed) return in("indices", placed.error());
            auto read = to_indices(*placed);
            if (!read) return in("indices", read.error());
            indices = std::move(*read);
            result_.index_accessor = accessor->get<std::size_t>();
        } else {
            indices.resize(result_.mesh.positions.size());
            std::iota(indices.begin(), indices.end(), 0u);
        }
        const auto mode = whole_number(primitive_, "mode", kGltfTriangles);
        if (!mode) return mode.error();
        if (*mode > kGltfTriangleFan)
            return fail(ErrorCode::parse, kNoItem, "mode " + std::to_string(*mode) + " is unknown");
        result_.mode = static_cast<int>(*mode);
        indices = triangle_list(result_.mode, std::move(indices));
        result_.triangles_in_file = indices.size() / 3;
        for (std::size_t t = 0; t < indices.size(); t += 3) {
            const std::size_t end = std::min(t + 3, indices.size());
            if (result_.mode != kGltfTriangles &&
                (indices[t] == indices[t + 1] || indices[t + 1] == indices[t + 2] || indices[t] == indices[t + 2]))
                continue;
            result_.mesh.indices.insert(result_.mesh.indices.end(), indices.begin() + static_cast<std::ptrdiff_t>(t),
                                        indices.begin() + static_cast<std::ptrdiff_t>(end));
        }
        return {};
    }

    Result<void> read_values(const std::string& name, const Json& accessor, double tolerance) {
        std::string storage;
        const auto placed = elements(accessor, result_.mesh.positions.size(), storage);
        if (!placed) return in(name, placed.error());
        const bool joints = begins(name, "JOINTS"), weights = begins(name, "WEIGHTS");
        const double rounding = rounding_of(name, *placed);
        result_.storage.push_back(to_floats(*placed, placed->components));
        result_.values.push_back({result_.storage.back(), static_cast<std::size_t>(placed->components),
                                  joints ? 0.0 : std::max(tolerance, rounding), joints || weights});
        return {};
    }

    const GltfDocument& document_;
    const Json& primitive_;
    ValueTolerances tolerances_;
    PrimitiveGeometry result_;
};

}  // namespace

std::string reason_to_draw_nothing(const Json& primitive) {
    const auto mode = whole_number(primitive, "mode", kGltfTriangles);
    if (mode && *mode < kGltfTriangles) return *mode == 0 ? "is made of points" : "is made of lines";
    const Json* attributes = member(primitive, "attributes");
    return attributes && member(*attributes, "POSITION") ? "" : "has no positions";
}

std::string reason_to_leave(const Json& primitive) {
    if (std::string reason = reason_to_draw_nothing(primitive); !reason.empty()) return reason;
    if (const Json* extensions = member(primitive, "extensions"); extensions && extensions->is_object())
        for (const auto& item : extensions->items())
            if (item.key().find("compression") == std::string::npos &&
                std::find(kHarmless.begin(), kHarmless.end(), item.key()) == kHarmless.end())
                return "has the extension " + item.key() + ", which may count on its triangles";
    return {};
}

Result<PrimitiveGeometry> read_primitive(const GltfDocument& document, const Json& primitive,
                                         const ValueTolerances& tolerances) {
    if (const Json* extensions = member(primitive, "extensions"); extensions && extensions->is_object())
        for (const auto& item : extensions->items())
            if (item.key().find("compression") != std::string::npos)
                return fail(ErrorCode::unsupported, kNoItem, why_compressed(item.key()));
    return PrimitiveReader(document, primitive, tolerances).read();
}

double patch_tolerance(const TriangleMesh& mesh, double tolerance) {
    if (tolerance >= 0.0 || mesh.positions.empty()) return std::max(tolerance, 0.0);
    glm::vec3 low = mesh.positions[0], high = low;
    for (const auto& p : mesh.positions) {
        low = glm::min(low, p);
        high = glm::max(high, p);
    }
    const glm::vec3 size = high - low;
    return 1e-6 * static_cast<double>(std::max({size.x, size.y, size.z}));
}

}  // namespace crofton::assets
