// SPDX-License-Identifier: MIT
// Lines through Embree, where it is installed.
#pragma once
#include <crofton/geometry/mesh.hpp>
#include <crofton/lines/lines.hpp>
#include <memory>
#include <span>

namespace crofton::bench {

class EmbreeScene {
  public:
    static bool available();
    explicit EmbreeScene(const TriangleMesh& mesh);
    ~EmbreeScene();

    // As LineTracer::all_hits, for lines that start outside of the scene: sixteen rays at a time, every crossing kept
    // by a filter, then sorted.
    void all_hits(std::span<const Line> lines, lines::LineHits& result) const;

  private:
    struct Data;
    std::unique_ptr<Data> data_;
};

}  // namespace crofton::bench
