// SPDX-License-Identifier: MIT
// Intel's MaskedOcclusionCulling, asked by rectangles: present where its sources are.
#pragma once
#include <crofton/geometry/box.hpp>
#include <crofton/geometry/camera.hpp>
#include <cstdint>
#include <span>

#if defined(CROFTON_HAVE_MOC)
namespace crofton::bench {

class MaskedPeer {
  public:
    MaskedPeer(unsigned width, unsigned height);
    ~MaskedPeer();
    void draw(std::span<const Obb> boxes, const Camera& camera);
    void find_hidden(std::span<const Obb> boxes, std::span<std::uint64_t> hidden);

  private:
    void* culling_;
    float to_clip_[16];
    double origin_[3];
};

}  // namespace crofton::bench
#endif
