// SPDX-License-Identifier: MIT
// Fits a box around boxes.
#include <algorithm>
#include <cmath>
#include <crofton/core/memory.hpp>
#include <crofton/core/recovery.hpp>
#include <crofton/fit/fit.hpp>
#include <limits>

namespace crofton::fit {

Result<Obb> merge(std::span<const Obb> boxes, const measure::Criterion& criterion) {
    return detail::recover([&]() -> Result<Obb> {
        if (boxes.empty()) return fail(ErrorCode::empty, kNoItem, "merge: no boxes");
        if (boxes.size() == 1) {
            if (auto valid = validate(boxes[0], 0); !valid) return valid.error();
            return boxes[0];
        }
        Vector<glm::dvec3> points;
        points.reserve(8 * boxes.size());
        double largest = 0.0;
        for (std::size_t i = 0; i < boxes.size(); ++i) {
            if (auto valid = validate(boxes[i], i); !valid) return valid.error();
            for (const glm::dvec3& corner : corners(boxes[i])) {
                if (!(std::max({std::abs(corner.x), std::abs(corner.y), std::abs(corner.z)}) <= kMaxCoordinate))
                    return fail(ErrorCode::out_of_range, i, {"merge: box ", i, " reaches beyond 1e30"});
                points.push_back(corner);
                largest = std::max({largest, std::abs(corner.x), std::abs(corner.y), std::abs(corner.z)});
            }
            for (int j = 0; j < 3; ++j) largest = std::max(largest, std::abs(boxes[i].center[j]));
        }
        Result<Obb> merged = fit_obb(std::span<const glm::dvec3>(points), {criterion, Quality::tight});
        if (!merged) return merged;
        // A corner is a sum of four exact terms, none larger than 2 · `largest`, rounded three times: it is off by less
        // than 3 · 2^-52 · largest in each coordinate, less than twice that along an axis of the merged box.
        const double error_bound = 12.0 * 0x1p-52 * largest;
        for (int k = 0; k < 3; ++k) {
            const double half = static_cast<double>(merged->half_extents[k]) + error_bound;
            float grown = static_cast<float>(half);
            if (static_cast<double>(grown) < half)
                grown = std::nextafter(grown, std::numeric_limits<float>::infinity());
            merged->half_extents[k] = grown;
        }
        return merged;
    });
}

}  // namespace crofton::fit
