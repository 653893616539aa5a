// SPDX-License-Identifier: MIT
// Data that all threads read while they find a picture's triangles.
#pragma once
#include <array>
#include <crofton/core/executor.hpp>
#include <crofton/core/memory.hpp>
#include <crofton/depth/depth_culler.hpp>
#include <cstdint>
#include <span>

#include "culler_data.hpp"

namespace crofton::depth {

// The objects of a frame, by distance: bins of a sixteenth of an octave. Those of one bin are in the order in which
// they were given, so that the order is the same everywhere.
class DepthFrame {
  public:
    static constexpr std::uint32_t kBins = 1024;

    // Of one of the picture's samples. `floors`: none, or for each tile a nearness that only what is nearer changes.
    void set(std::span<const DepthObject> objects, const PictureView& view, std::uint32_t sample,
             std::span<const float> floors, Executor& executor);
    // They are the caller's, and may be gone after the call.
    void forget_objects() { objects_ = {}; }

    [[nodiscard]] const PictureData& picture() const { return picture_; }    // without tiles
    [[nodiscard]] std::span<const float> floors() const { return floors_; }  // row by row, or none
    [[nodiscard]] std::span<const DepthObject> objects() const { return objects_; }
    [[nodiscard]] std::span<const Projection> projections() const { return projections_; }
    [[nodiscard]] ObjectData data_of(std::uint32_t object) const;
    // Those that may cover a sample of the picture.
    [[nodiscard]] std::span<const std::uint32_t> in_bin(std::uint32_t bin) const {
        return std::span(order_).subspan(starts_[bin], starts_[bin + 1] - starts_[bin]);
    }
    [[nodiscard]] std::size_t count() const { return order_.size(); }
    // Those that cannot be placed, ascending.
    [[nodiscard]] std::span<const std::uint32_t> unplaced() const { return unplaced_; }

    [[nodiscard]] std::uint32_t bin_of(const Projection& projection) const;

  private:
    void set_picture(const PictureView& view, std::uint32_t sample);
    void sort();

    PictureData picture_{};
    bool perspective_ = true;
    std::span<const DepthObject> objects_;
    std::span<const float> floors_;
    Vector<Projection> projections_;
    Vector<std::uint32_t> order_, unplaced_;
    std::array<std::uint32_t, kBins + 1> starts_{};
};

}  // namespace crofton::depth
