// SPDX-License-Identifier: MIT
// Rays through Embree, where it is installed.
#pragma once
#include <crofton/geometry/mesh.hpp>
#include <crofton/lines/lines.hpp>
#include <memory>
#include <span>

namespace crofton::bench {

class EmbreeScene {
  public:
    static bool available();
    // `crossings`: all_hits() will be asked.
    explicit EmbreeScene(const TriangleMesh& mesh, bool crossings = false);
    ~EmbreeScene();

    // As LineTracer::first_hits, sixteen rays at a time, one thread; `skip` is replaced by a start 10^-6 of the scene's
    // size away.
    void first_hits(std::span<const lines::FirstHitQuery> rays, std::span<lines::Hit> result) const;

    // As LineTracer::all_hits, for lines that start outside of the scene: sixteen rays at a time, every crossing kept
    // by a filter, then sorted.
    void all_hits(std::span<const Line> lines, lines::LineHits& result) const;

  private:
    struct Data;
    std::unique_ptr<Data> data_;
};

}  // namespace crofton::bench
