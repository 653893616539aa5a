// SPDX-License-Identifier: MIT
// Oracle: a proof in rationals that a triangle owns no sample of a picture, whichever renderer draws it.
//
// A renderer may put each vertex up to `move` pixels beside its place along each axis, the same for all triangles of a
// mesh that have a vertex there; it may take a triangle's depth from the vertices as they are or as they were moved,
// and move it back by the depth bias. Take the triangles of one mesh that face one way for certain and that are surely
// nearer at a sample than the triangle in question, if they cover it. Their signed sum of edges is a closed chain. If
// no edge of it can pass over the sample, and the chain winds round it, then one of these triangles covers the sample,
// however the vertices are moved.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <oracle/owner_picture.hpp>
#include <oracle/tracked.hpp>
#include <span>
#include <tuple>
#include <unordered_map>
#include <vector>

namespace crofton::oracle {

class DepthCertificate {
  public:
    struct Body {
        DrawnMesh mesh;
        bool hides = true;
    };
    enum class Proof : std::uint8_t { outside, faces_away, no_sample, hidden, none };

    // Reversed-Z matrices.
    DepthCertificate(std::span<const Body> bodies, std::uint32_t width, std::uint32_t height)
        : bodies_(bodies),
          size_{Rational(width), Rational(height)},
          columns_((width + kTile - 1) / kTile),
          pixels_{double(width), double(height)} {
        tiles_.resize(std::size_t{columns_} * ((height + kTile - 1) / kTile));
        vertices_.resize(bodies.size());
        for (std::uint32_t b = 0; b < bodies.size(); ++b) {
            number_vertices(b);
            if (!bodies[b].hides) continue;
            for (std::uint32_t t = 0; 3 * t + 2 < bodies[b].mesh.indices.size(); ++t) file(b, t);
        }
    }

    // Proves it at no more than `most` of the samples that the triangle may cover, evenly chosen.
    [[nodiscard]] Proof prove(std::uint32_t body, std::uint32_t triangle, std::size_t most) const {
        const std::array<Vertex, 3> corners = corners_of(body, triangle);
        if (is_outside(corners)) return Proof::outside;
        if (corners[0].key == corners[1].key || corners[1].key == corners[2].key || corners[2].key == corners[0].key)
            return Proof::no_sample;
        const std::vector<Piece>& pieces = pieces_of(body, triangle);
        if (pieces.empty()) return Proof::none;
        bool faces_away = bodies_[body].mesh.one_sided;
        std::vector<std::pair<std::uint32_t, std::uint32_t>> samples;
        for (const Piece& piece : pieces) {
            faces_away = faces_away && piece.facing < 0;
            list_samples(piece, samples);
        }
        if (faces_away) return Proof::faces_away;
        if (samples.empty()) return Proof::no_sample;
        const std::size_t step = (samples.size() + most - 1) / most;
        for (std::size_t s = 0; s < samples.size(); s += step) {
            const Point2 p = center_of(samples[s]);
            bool first = true;
            Rational nearest;
            for (const Piece& piece : pieces) {
                const Rational upper = upper_bound(piece, p);
                if (first || upper > nearest) nearest = upper;
                first = false;
            }
            if (!is_covered(samples[s], p, nearest)) return Proof::none;
        }
        return Proof::hidden;
    }

    // Proves that the picture is at least so near at a sample. Row 0 is at the bottom.
    [[nodiscard]] bool is_at_least(std::uint32_t x, std::uint32_t y, double nearness) const {
        // What is proved is strict.
        return is_covered({x, y}, center_of({x, y}), Rational(nearness) - power(-200));
    }

  private:
    static constexpr std::uint32_t kTile = 8;
    static constexpr std::array<double, 3> kCuts = {1.0, 0x1p-4, 0x1p-7};  // nearness; 1 on the near plane
    using Key = std::pair<std::uint32_t, std::uint32_t>;  // a vertex twice, or the ends of the edge that was cut
    using Point2 = std::array<Rational, 2>;

    struct Vertex {
        std::array<Rational, 4> clip, error;
        Key key;
    };
    struct Place {
        Rational x, y, z;
        Rational move, z_error;
        Key key;
        std::array<double, 2> about;  // x and y
    };
    // A triangle in front of the near plane.
    struct Piece {
        std::array<Place, 3> at;
        Rational area;        // twice; positive: counter-clockwise
        int facing = 0;       // 0: not certain
        Rational least_area;  // of its magnitude, however the vertices are moved
        Rational across, up;  // slopes of the nearness
        Rational bias;        // what it may be moved back by, and no more
        Rational move, z_error, nearest, farthest;
    };

    // What may hide something: the rectangle and the nearest point in front of the near plane, about.
    struct Filed {
        std::uint32_t body, triangle;
        std::array<double, 2> low, high;
        double nearest;  // ∞ close to the near plane
    };

    void number_vertices(std::uint32_t body) {
        const DrawnMesh& mesh = bodies_[body].mesh;
        std::map<std::tuple<float, float, float>, std::uint32_t> known;
        for (std::uint32_t v = 0; v < mesh.positions.size(); ++v) {
            const glm::vec3& p = mesh.positions[v];
            vertices_[body].push_back(known.try_emplace({p.x, p.y, p.z}, v).first->second);
        }
    }

    [[nodiscard]] Vertex vertex(std::uint32_t body, std::uint32_t index) const {
        const DrawnMesh& mesh = bodies_[body].mesh;
        const std::uint32_t own = vertices_[body][index];
        Vertex v{{}, {}, {own, own}};
        for (int i = 0; i < 4; ++i) {
            auto k = static_cast<std::size_t>(i);
            v.clip[k] = Rational(double(mesh.to_clip[3][i]));
            v.error[k] = abs(v.clip[k]);
            for (int c = 0; c < 3; ++c) {
                const Rational term = Rational(double(mesh.to_clip[c][i])) * Rational(double(mesh.positions[own][c]));
                v.clip[k] += term;
                v.error[k] += abs(term);
            }
            v.error[k] *= power(-22);  // four roundings
        }
        return v;
    }
    [[nodiscard]] std::array<Vertex, 3> corners_of(std::uint32_t body, std::uint32_t triangle) const {
        const auto index = [&](std::uint32_t k) { return bodies_[body].mesh.indices[3 * triangle + k]; };
        return {vertex(body, index(0)), vertex(body, index(1)), vertex(body, index(2))};
    }
    static Rational power(int exponent) { return Rational(std::ldexp(1.0, exponent)); }

    // Beyond one side of the frustum, by more than a pixel's share and what rounds.
    [[nodiscard]] bool is_outside(const std::array<Vertex, 3>& corners) const {
        for (std::size_t side = 0; side < 5; ++side) {
            bool beyond = true;
            for (const Vertex& v : corners) {
                Rational value, error = v.error[3];
                if (side == 4) {
                    value = v.clip[3] - v.clip[2];
                    error += v.error[2];
                } else {
                    const std::size_t axis = side / 2;
                    value = v.clip[3] * (1 + power(-6) / size_[axis]) +
                            (side % 2 == 0 ? v.clip[axis] : Rational(-v.clip[axis]));
                    error += v.error[axis];
                }
                beyond = beyond && value < -error;
            }
            if (beyond) return true;
        }
        return false;
    }

    // Cut when they are first asked for; none where a vertex has no place, or where nothing is in front of the near
    // plane.
    [[nodiscard]] const std::vector<Piece>& pieces_of(std::uint32_t body, std::uint32_t triangle) const {
        return pieces_of(body, triangle, 0);
    }
    [[nodiscard]] const std::vector<Piece>& pieces_of(std::uint32_t body, std::uint32_t triangle,
                                                      std::size_t cut_at) const {
        const auto [at, is_new] = pieces_[cut_at].try_emplace(std::uint64_t{body} << 32 | triangle);
        if (is_new && !cut(corners_of(body, triangle), kCuts[cut_at], at->second)) at->second.clear();
        return at->second;
    }

    // Cuts a triangle that crosses the near plane to the part no nearer than `nearest`, as a fan. Returns false
    // where a vertex has no place.
    [[nodiscard]] bool cut(const std::array<Vertex, 3>& corners, double nearest, std::vector<Piece>& pieces) const {
        const bool crosses =
            std::any_of(corners.begin(), corners.end(), [](const Vertex& v) { return v.clip[3] < v.clip[2]; });
        const Rational share = crosses ? nearest : 1.0;
        std::vector<Vertex> polygon;
        for (std::size_t k = 0; k < 3; ++k) {
            const Vertex &a = corners[k], &b = corners[(k + 1) % 3];
            const Rational da = share * a.clip[3] - a.clip[2], db = share * b.clip[3] - b.clip[2];
            if (da >= 0) polygon.push_back(a);
            if ((da >= 0) == (db >= 0)) continue;
            Vertex v{{}, {}, {std::min(a.key.first, b.key.first), std::max(a.key.first, b.key.first)}};
            for (std::size_t i = 0; i < 4; ++i) {
                v.clip[i] = (a.clip[i] * db - b.clip[i] * da) / (db - da);
                v.error[i] = 4 * (a.error[i] + b.error[i]);
            }
            polygon.push_back(v);
        }
        std::vector<Place> places;
        for (const Vertex& v : polygon) {
            Place place;
            if (!find_place(v, place)) return false;
            places.push_back(place);
        }
        for (std::size_t k = 2; k < places.size(); ++k)
            pieces.push_back(piece_of({places[0], places[k - 1], places[k]}));
        return true;
    }

    [[nodiscard]] bool find_place(const Vertex& v, Place& place) const {
        const Rational &w = v.clip[3], least_w = w - v.error[3];
        if (least_w <= 0) return false;
        Rational ratios[3], errors[3];
        for (std::size_t i = 0; i < 3; ++i) {
            ratios[i] = v.clip[i] / w;
            errors[i] = (v.error[i] + abs(ratios[i]) * v.error[3]) / least_w;
        }
        place.x = (ratios[0] + 1) * size_[0] / 2;
        place.y = (ratios[1] + 1) * size_[1] / 2;
        place.z = ratios[2];
        // Half a step of the grid; division, scaling and sum.
        const Rational reach = std::max(Rational(abs(place.x)), Rational(abs(place.y))) + std::max(size_[0], size_[1]);
        place.move = power(-9) + power(-22) * reach +
                     std::max(Rational(errors[0] * size_[0]), Rational(errors[1] * size_[1])) / 2;
        place.z_error = errors[2] + abs(place.z) * power(-22);
        place.key = v.key;
        place.about = {place.x.get_d(), place.y.get_d()};
        return true;
    }

    [[nodiscard]] static Piece piece_of(const std::array<Place, 3>& at) {
        Piece t{at, {}, 0, {}, {}, {}, {}, {}, {}, {}, {}};
        const Rational x1 = at[1].x - at[0].x, y1 = at[1].y - at[0].y, z1 = at[1].z - at[0].z;
        const Rational x2 = at[2].x - at[0].x, y2 = at[2].y - at[0].y, z2 = at[2].z - at[0].z;
        t.area = x1 * y2 - x2 * y1;
        for (const Place& p : at) {
            if (p.move > t.move) t.move = p.move;
            if (p.z_error > t.z_error) t.z_error = p.z_error;
        }
        t.nearest = std::max({at[0].z, at[1].z, at[2].z}) + t.z_error;
        t.farthest = std::min({at[0].z, at[1].z, at[2].z}) - t.z_error;
        const auto length_of = [&](std::size_t i, std::size_t j) -> Rational {
            return abs(at[i].x - at[j].x) + abs(at[i].y - at[j].y);
        };
        const Rational &m0 = at[0].move, &m1 = at[1].move, &m2 = at[2].move;
        const Rational change =
            m0 * length_of(1, 2) + m1 * length_of(2, 0) + m2 * length_of(0, 1) + 2 * (m0 * m1 + m1 * m2 + m2 * m0);
        t.least_area = abs(t.area) - change;
        if (t.least_area <= 0) return t;
        t.facing = t.area > 0 ? 1 : -1;
        const Rational across = z1 * y2 - z2 * y1, up = z2 * x1 - z1 * x2;
        t.across = across / t.area, t.up = up / t.area;
        const Rational steeper = abs(z1) * (m2 + m0) + abs(z2) * (m1 + m0);
        t.bias = (std::max(Rational(abs(across)), Rational(abs(up))) + steeper) / t.least_area / 256;
        return t;
    }

    [[nodiscard]] static Rational plane_at(const Piece& t, const Point2& p) {
        return t.at[0].z + t.across * (p[0] - t.at[0].x) + t.up * (p[1] - t.at[0].y);
    }
    [[nodiscard]] static Rational step_of(const Piece& t) { return t.move * (abs(t.across) + abs(t.up)); }
    // Where it covers p, it is nowhere nearer, …
    [[nodiscard]] static Rational upper_bound(const Piece& t, const Point2& p) {
        if (t.facing == 0) return t.nearest;
        return std::min(t.nearest, Rational(plane_at(t, p) + step_of(t) + t.z_error));
    }
    // … nor farther.
    [[nodiscard]] static Rational lower_bound(const Piece& t, const Point2& p) {
        const Rational plane = plane_at(t, p) - t.z_error;
        const Rational moved = std::max(Rational(plane - step_of(t)), t.farthest);
        const Rational bound = std::min({plane, moved, Rational(t.nearest - 2 * t.z_error)});
        return std::max(bound, Rational(plane_at(t, p) - mean_error(t, p) - t.bias * 5 / 4)) - t.bias;
    }
    // Where the triangle covers p, p is a mean of the vertices as they were moved, and the depth is this mean of
    // theirs. So what vertices are off counts by their share, which is small for those far nearer than p: those on the
    // near plane. Where the depth is by places before they are snapped, this adds half a step times the slope: the
    // bias.
    [[nodiscard]] static Rational mean_error(const Piece& t, const Point2& p) {
        std::array<const Place*, 3> by_depth = {&t.at[0], &t.at[1], &t.at[2]};
        std::sort(by_depth.begin(), by_depth.end(), [](const Place* a, const Place* b) { return a->z < b->z; });
        const auto error_of = [&](const Place& v) -> Rational {
            return v.move * (abs(t.across) + abs(t.up)) + v.z_error;
        };
        const Place& farthest = *by_depth[0];
        const Rational nearest = plane_at(t, p) + step_of(t) + t.z_error, low = farthest.z - farthest.z_error;
        Rational error = error_of(farthest);
        for (std::size_t k = 1; k < 3; ++k) {
            const Place& v = *by_depth[k];
            const Rational range = v.z - v.z_error - low;
            // Of this vertex and of those nearer.
            const Rational share = range > 0 ? std::min(Rational(1), Rational((nearest - low) / range)) : Rational(1);
            error += share * error_of(v);
        }
        return error;
    }

    [[nodiscard]] static Point2 center_of(const std::pair<std::uint32_t, std::uint32_t>& sample) {
        return {Rational(2 * sample.first + 1) / 2, Rational(2 * sample.second + 1) / 2};
    }
    // False only if no displacement covers p: the triangle and the square around p are apart. In double: 2^-40 of all
    // terms is more than what rounds.
    [[nodiscard]] static bool may_cover(const Piece& t, const Point2& p) {
        constexpr double kRounding = 0x1p-40;
        const double at[2] = {p[0].get_d(), p[1].get_d()}, move = t.move.get_d() * (1.0 + kRounding);
        for (std::size_t axis = 0; axis < 2; ++axis) {
            const auto [low, high] = std::minmax({t.at[0].about[axis], t.at[1].about[axis], t.at[2].about[axis]});
            const double reach = move + kRounding * (std::abs(low) + std::abs(high) + at[axis]);
            if (low > at[axis] + reach || high < at[axis] - reach) return false;
        }
        for (std::size_t k = 0; k < 3; ++k) {
            const auto &a = t.at[k].about, &b = t.at[(k + 1) % 3].about, &c = t.at[(k + 2) % 3].about;
            const double nx = a[1] - b[1], ny = b[0] - a[0];
            const double other_x = nx * (c[0] - a[0]), other_y = ny * (c[1] - a[1]);
            const double mine_x = nx * (at[0] - a[0]), mine_y = ny * (at[1] - a[1]);
            const double far = std::max({std::abs(a[0]), std::abs(b[0]), std::abs(c[0]), std::abs(a[1]), std::abs(b[1]),
                                         std::abs(c[1]), at[0], at[1]});
            const double reach = move * (std::abs(nx) + std::abs(ny)) + kRounding * far * (far + move);
            const double other = other_x + other_y, mine = mine_x + mine_y;
            if (mine > std::max(other, 0.0) + reach || mine < std::min(other, 0.0) - reach) return false;
        }
        return true;
    }
    void list_samples(const Piece& t, std::vector<std::pair<std::uint32_t, std::uint32_t>>& samples) const {
        double low[2], high[2];
        for (std::size_t axis = 0; axis < 2; ++axis) {
            low[axis] = HUGE_VAL, high[axis] = -HUGE_VAL;
            for (const Place& p : t.at) {
                const double at = (axis == 0 ? p.x : p.y).get_d();
                low[axis] = std::min(low[axis], at), high[axis] = std::max(high[axis], at);
            }
            const double reach = t.move.get_d() + 1.0, last = pixels_[axis] - 1.0;
            low[axis] = std::floor(std::clamp(low[axis] - reach, 0.0, last + 1.0));
            high[axis] = std::ceil(std::clamp(high[axis] + reach, -1.0, last));
        }
        for (double y = low[1]; y <= high[1]; y += 1.0)
            for (double x = low[0]; x <= high[0]; x += 1.0) {
                const std::pair sample{static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y)};
                if (may_cover(t, center_of(sample))) samples.push_back(sample);
            }
    }

    // Into the tiles that it may touch, in double with a pixel to spare.
    void file(std::uint32_t body, std::uint32_t triangle) {
        const DrawnMesh& mesh = bodies_[body].mesh;
        std::array<glm::dvec4, 3> clip;
        for (std::size_t k = 0; k < 3; ++k)
            clip[k] = glm::dmat4(mesh.to_clip) * glm::dvec4(mesh.positions[mesh.indices[3 * triangle + k]], 1.0);
        Filed filed{body, triangle, {HUGE_VAL, HUGE_VAL}, {-HUGE_VAL, -HUGE_VAL}, -HUGE_VAL};
        const auto include = [&](const glm::dvec4& p) {
            for (std::size_t axis = 0; axis < 2; ++axis) {
                const double ratio = p.w > 1e-9 ? p[static_cast<glm::length_t>(axis)] / p.w : 0.0;
                const double at = (ratio + 1.0) * 0.5 * pixels_[axis];
                filed.low[axis] = std::min(filed.low[axis], at), filed.high[axis] = std::max(filed.high[axis], at);
            }
        };
        for (std::size_t k = 0; k < 3; ++k) {
            const glm::dvec4 &a = clip[k], &b = clip[(k + 1) % 3];
            const double da = a.w - a.z, db = b.w - b.z;
            if (da >= 0.0) include(a);
            if ((da >= 0.0) != (db >= 0.0)) include(a + (b - a) * (da / (da - db)));
            filed.nearest = da < 1e-3 * a.w ? HUGE_VAL : std::max(filed.nearest, a.z / a.w);
        }
        const auto tile = [&](double at, std::size_t axis) {
            return static_cast<std::uint32_t>(std::clamp(at, 0.0, pixels_[axis] - 1.0)) / kTile;
        };
        if (!(filed.low[0] - 2.0 < pixels_[0] && filed.high[0] > -2.0 && filed.low[1] - 2.0 < pixels_[1] &&
              filed.high[1] > -2.0))
            return;
        for (std::uint32_t y = tile(filed.low[1] - 2.0, 1); y <= tile(filed.high[1] + 2.0, 1); ++y)
            for (std::uint32_t x = tile(filed.low[0] - 2.0, 0); x <= tile(filed.high[0] + 2.0, 0); ++x)
                tiles_[std::size_t{y} * columns_ + x].push_back(static_cast<std::uint32_t>(filed_.size()));
        filed_.push_back(filed);
    }

    // Triangles of one body cover the sample for certain, nearer than `nearness`. On the near plane places are known to
    // many pixels, so that walls through it may do so only by their farther parts.
    [[nodiscard]] bool is_covered(const std::pair<std::uint32_t, std::uint32_t>& sample, const Point2& p,
                                  const Rational& nearness) const {
        for (std::size_t cut_at = 0; cut_at < kCuts.size(); ++cut_at)
            if (is_covered(sample, p, nearness, cut_at)) return true;
        return false;
    }
    [[nodiscard]] bool is_covered(const std::pair<std::uint32_t, std::uint32_t>& sample, const Point2& p,
                                  const Rational& nearness, std::size_t cut_at) const {
        const auto& tile = tiles_[std::size_t{sample.second / kTile} * columns_ + sample.first / kTile];
        for (std::size_t begin = 0, end = 0; begin < tile.size(); begin = end) {
            const std::uint32_t body = filed_[tile[begin]].body;
            while (end < tile.size() && filed_[tile[end]].body == body) ++end;
            std::vector<const Piece*> front, back;
            for (std::size_t i = begin; i < end; ++i) {
                const Filed& filed = filed_[tile[i]];
                if (!is_close(filed, p, nearness)) continue;
                for (const Piece& piece : pieces_of(body, filed.triangle, cut_at))
                    if (piece.facing != 0 && may_cover(piece, p) && lower_bound(piece, p) > nearness)
                        (piece.facing > 0 ? front : back).push_back(&piece);
            }
            if (surely_cover(front, p)) return true;
            if (!bodies_[body].mesh.one_sided && surely_cover(back, p)) return true;
        }
        return false;
    }

    // In double, with room to spare: whether a look in rationals is worth it.
    [[nodiscard]] static bool is_close(const Filed& filed, const Point2& p, const Rational& nearness) {
        for (std::size_t axis = 0; axis < 2; ++axis)
            if (p[axis].get_d() < filed.low[axis] - 1.0 || p[axis].get_d() > filed.high[axis] + 1.0) return false;
        return filed.nearest > nearness.get_d() - 1e-9;
    }

    // By those that are left when each triangle with an end over p is taken away.
    [[nodiscard]] static bool surely_cover(std::vector<const Piece*> pieces, const Point2& p) {
        for (;;) {
            std::map<std::pair<Key, Key>, int> chain;
            const auto for_edges = [](const Piece& t, auto&& use) {
                for (std::size_t k = 0; k < 3; ++k) {
                    const Place &a = t.at[k], &b = t.at[(k + 1) % 3];
                    const bool forward = a.key < b.key;
                    use(a, b, forward ? std::pair{a.key, b.key} : std::pair{b.key, a.key}, forward ? 1 : -1);
                }
            };
            for (const Piece* const t : pieces)
                for_edges(*t, [&](const Place&, const Place&, const auto& edge, int sign) { chain[edge] += sign; });
            const auto ends_over = [&](const Piece* t) {
                bool ends = false;
                for_edges(*t, [&](const Place& a, const Place& b, const auto& edge, int) {
                    ends = ends || (chain[edge] != 0 && may_pass(a, b, p));
                });
                return ends;
            };
            if (std::erase_if(pieces, ends_over) == 0) break;
        }
        return std::any_of(pieces.begin(), pieces.end(), [&](const Piece* t) { return is_inside(*t, p); });
    }
    // Of two triangles that share an edge one has the points on it.
    [[nodiscard]] static bool is_inside(const Piece& t, const Point2& p) {
        bool inside = true;
        for (std::size_t k = 0; k < 3; ++k) {
            const Place &a = t.at[k], &b = t.at[(k + 1) % 3];
            Rational side = (b.x - a.x) * (p[1] - a.y) - (b.y - a.y) * (p[0] - a.x);
            if (t.facing < 0) side = -side;
            const bool up = b.y > a.y || (b.y == a.y && b.x > a.x);
            inside = inside && (side > 0 || (side == 0 && (up == (t.facing > 0))));
        }
        return inside;
    }

    // Whether the edge between two moved vertices may pass over p.
    [[nodiscard]] static bool may_pass(const Place& a, const Place& b, const Point2& p) {
        Rational low = 0, high = 1;
        // c + s · slope ≤ 0 for a place s of the edge.
        const auto keep = [&](const Rational& c, const Rational& slope) {
            if (slope > 0)
                high = std::min(high, Rational(-c / slope));
            else if (slope < 0)
                low = std::max(low, Rational(-c / slope));
            else if (c > 0)
                high = -1;
        };
        const Rational turn = b.move - a.move;
        for (std::size_t axis = 0; axis < 2; ++axis) {
            const Rational from = (axis == 0 ? a.x : a.y) - p[axis], along = axis == 0 ? b.x - a.x : b.y - a.y;
            keep(from - a.move, along - turn);
            keep(-from - a.move, -along - turn);
        }
        return low <= high;
    }

    std::span<const Body> bodies_;
    std::array<Rational, 2> size_;
    std::uint32_t columns_;
    std::array<double, 2> pixels_;  // the size again
    std::vector<Filed> filed_;
    std::vector<std::vector<std::uint32_t>> tiles_;                                        // of filed_
    mutable std::array<std::unordered_map<std::uint64_t, std::vector<Piece>>, 3> pieces_;  // by the cut
    std::vector<std::vector<std::uint32_t>> vertices_;  // by body: the first at the same place
};

}  // namespace crofton::oracle
