// SPDX-License-Identifier: MIT
// Shapes that the town is made of, added one by one to a mesh of flat-coloured faces.
#pragma once
#include <crofton/geometry/mesh.hpp>
#include <crofton/geometry/transform.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

namespace crofton::assets {

// sRGB bytes, as one reads colours off a palette, to linear.
[[nodiscard]] glm::vec3 srgb(int red, int green, int blue);
[[nodiscard]] glm::vec3 scaled(const glm::vec3& color, double factor);

// Faces share no vertices, so that each keeps its colour and its edge. Coordinates go through `frame`, double to float.
class MeshBuilder {
  public:
    Transform frame;

    // Counter-clockwise seen from outside.
    void triangle(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, const glm::vec3& color);
    void quad(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, const glm::dvec3& d,
              const glm::vec3& color);
    // Axis-aligned in the frame, without its bottom face where `open_bottom`.
    void box(const glm::dvec3& min, const glm::dvec3& max, const glm::vec3& color, bool open_bottom = false);
    // A square bar of the given thickness from a to b, with ends.
    void bar(const glm::dvec3& a, const glm::dvec3& b, double thickness, const glm::vec3& color);
    // A round bar from radius ra at a to rb at b, without ends where the radius is zero or `open`.
    void tube(const glm::dvec3& a, const glm::dvec3& b, double ra, double rb, int sides, const glm::vec3& color,
              bool open = false);
    // An ellipsoid of 80 faces, darker below as under its own shade; `ragged` moves its points in and out by that
    // share.
    void blob(const glm::dvec3& center, const glm::dvec3& radii, const glm::vec3& color, double ragged);
    // A convex profile (x, y), counter-clockwise, swept from z = −depth/2 to +depth/2; sides and caps in two colours.
    void sweep(std::span<const glm::dvec2> profile, double depth, const glm::vec3& sides, const glm::vec3& caps);

    // Closed solids whose faces share their vertices.
    // A profile (radius, height) turned about y. It begins and ends at radius 0, or is a ring that closes by itself;
    // the solid lies to its left.
    void lathe(std::span<const glm::dvec2> profile, int sides, const glm::vec3& color, bool ring = false);
    // A wheel about y from height 0 to `thickness`, with a hole; `depth` is how far its teeth stand out.
    void gear(int teeth, double radius, double depth, double hole, double thickness, const glm::vec3& color);
    // A round bar along a line of points, with ends.
    void pipe(std::span<const glm::dvec3> line, double radius, int sides, const glm::vec3& color);

    // The radiosity that faces added from now on give off by themselves; none at first.
    void glow(const glm::vec3& emission);

    [[nodiscard]] TriangleMesh take() { return std::move(mesh_); }
    // By triangle; empty where nothing glows. Call it before take().
    [[nodiscard]] std::vector<glm::vec3> take_emission();
    [[nodiscard]] std::size_t triangle_count() const { return mesh_.triangle_count(); }

  private:
    std::uint32_t vertex(const glm::dvec3& point, const glm::vec3& color);
    void face(std::uint32_t a, std::uint32_t b, std::uint32_t c);
    void face(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d);

    struct Change {
        std::size_t first;  // triangle
        glm::vec3 emission;
    };
    TriangleMesh mesh_;
    std::vector<Change> changes_;
};

}  // namespace crofton::assets
