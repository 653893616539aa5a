// SPDX-License-Identifier: MIT
#include "polygon_files.hpp"

#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "assets/file.hpp"
#include "assets/json_syntax.hpp"
#include "assets/sector_polygons.hpp"
#include "assets/wad_file.hpp"
#include "report.hpp"

namespace crofton::cli {
namespace {

using nlohmann::json;

Error damaged(const std::string& path, const std::string& what) {
    return fail(ErrorCode::parse, kNoItem, path + ": " + what);
}

class PolyReader {
  public:
    PolyReader(const std::string& path, const std::string& text, const assets::ReadLimits& limits)
        : path_(path), at_(text.c_str()), end_(at_ + text.size()), limits_(limits) {}

    Result<PolygonFile> read() {
        PolygonFile file;
        for (std::string tag; word(tag);) {
            NamedPolygon named;
            double rings = 0.0;
            if (tag != "P" || !word(named.name) || !whole(rings) || rings < 1.0 || rings > 1e8) {
                return damaged(path_, where("expected 'P name rings'"));
            }
            for (double r = 0.0; r < rings; ++r) {
                double count = 0.0;
                if (!whole(count) || count < 0.0 || count > 1e9)
                    return damaged(path_, where("expected a ring's number of points"));
                for (double i = 0.0; i < count; ++i) {
                    glm::dvec2 p;
                    if (!number(p.x) || !number(p.y))
                        return damaged(path_, where("expected a coordinate of " + named.name));
                    if (++points_ > limits_.triangles)
                        return assets::in_file(path_, "", assets::over_limit("triangles", limits_.triangles));
                    named.polygon.points.push_back(p);
                }
                named.polygon.ring_ends.push_back(static_cast<std::uint32_t>(named.polygon.points.size()));
            }
            file.polygons.push_back(std::move(named));
        }
        if (at_ != end_) return damaged(path_, where("is no text: a byte is 0"));
        return file;
    }

  private:
    [[nodiscard]] std::string where(const std::string& what) const {
        return "line " + std::to_string(line_) + ": " + what;
    }
    void skip_space() {
        for (; *at_ == ' ' || *at_ == '\t' || *at_ == '\r' || *at_ == '\n'; ++at_) line_ += *at_ == '\n';
    }
    bool word(std::string& result) {
        skip_space();
        const char* begin = at_;
        while (*at_ != '\0' && *at_ != ' ' && *at_ != '\t' && *at_ != '\r' && *at_ != '\n') ++at_;
        result.assign(begin, at_);
        return !result.empty();
    }
    bool number(double& result) {
        skip_space();
        char* end = nullptr;
        result = std::strtod(at_, &end);
        const bool found = end != at_;
        at_ = end;
        return found;
    }
    bool whole(double& result) { return number(result) && result == std::floor(result); }

    const std::string& path_;
    const char *at_, *end_;
    assets::ReadLimits limits_;
    std::size_t line_ = 1;
    std::uint64_t points_ = 0;
};

bool append_rings(const json& rings, bool drop_closing_point, Polygon& polygon) {
    if (!rings.is_array()) return false;
    for (const auto& ring : rings) {
        if (!ring.is_array()) return false;
        const std::size_t begin = polygon.points.size();
        for (const auto& p : ring) {
            if (!p.is_array() || p.size() < 2 || !p[0].is_number() || !p[1].is_number()) return false;
            polygon.points.emplace_back(p[0].get<double>(), p[1].get<double>());
        }
        if (drop_closing_point && polygon.points.size() > begin + 1 && polygon.points[begin] == polygon.points.back()) {
            polygon.points.pop_back();
        }
        polygon.ring_ends.push_back(static_cast<std::uint32_t>(polygon.points.size()));
    }
    return true;
}

class GeoJsonReader {
  public:
    GeoJsonReader(const std::string& path, PolygonFile& file) : path_(path), file_(file) {}

    // Without recursion: a collection's members go on the list.
    Result<void> read(const json& document) {
        std::vector<std::pair<const json*, std::string>> open{{&document, ""}};
        for (std::size_t i = 0; i < open.size(); ++i) {
            const auto [object, name] = open[i];
            const std::string type = type_of(*object);
            const char* members = type == "FeatureCollection"    ? "features"
                                  : type == "GeometryCollection" ? "geometries"
                                                                 : nullptr;
            if (members != nullptr) {
                if (!object->contains(members) || !(*object)[members].is_array())
                    return broken(name, type + " without " + members);
                for (const auto& member : (*object)[members]) {
                    if (member.is_object()) open.emplace_back(&member, name);
                }
            } else if (type == "Feature") {
                if (object->contains("geometry") && (*object)["geometry"].is_object())
                    open.emplace_back(&(*object)["geometry"], name_of(*object));
            } else if (auto added = geometry(*object, type, name.empty() ? "geometry" + std::to_string(i) : name);
                       !added) {
                return added;
            }
        }
        return {};
    }

  private:
    [[nodiscard]] Error broken(const std::string& name, const std::string& what) const {
        return damaged(path_, (name.empty() ? "" : name + ": ") + what);
    }

    // Empty where there is none, or something other than text.
    static std::string type_of(const json& object) {
        const auto type = object.find("type");
        return type != object.end() && type->is_string() ? type->get<std::string>() : "";
    }

    static std::string name_of(const json& feature) {
        if (feature.contains("properties") && feature["properties"].is_object()) {
            for (const char* key : {"name", "NAME", "Name", "id"}) {
                const auto found = feature["properties"].find(key);
                if (found != feature["properties"].end() && found->is_string()) return found->get<std::string>();
            }
        }
        return feature.contains("id") ? feature["id"].dump() : "";
    }

    Result<void> geometry(const json& object, const std::string& type, const std::string& name) {
        if (type != "Polygon" && type != "MultiPolygon") {
            file_.warnings.push_back(name + ": " + (type.empty() ? "an object without type" : type) + " is no polygon");
            return {};
        }
        if (!object.contains("coordinates") || !object["coordinates"].is_array())
            return broken(name, type + " without coordinates");
        const json& coordinates = object["coordinates"];
        const std::size_t parts = type == "Polygon" ? 1 : coordinates.size();
        for (std::size_t i = 0; i < parts; ++i) {
            NamedPolygon named{parts == 1 ? name : name + "_" + std::to_string(i), {}};
            if (!append_rings(type == "Polygon" ? coordinates : coordinates[i], true, named.polygon)) {
                return broken(named.name, "coordinates are not rings of [x, y]");
            }
            file_.polygons.push_back(std::move(named));
        }
        return {};
    }

    const std::string& path_;
    PolygonFile& file_;
};

Result<PolygonFile> read_json(const std::string& path, const std::string& text, const assets::ReadLimits& limits) {
    if (auto shape = assets::check_json_shape(text, limits); !shape) return assets::in_file(path, "", shape.error());
    const json document = json::parse(text, nullptr, false);
    if (document.is_discarded()) return damaged(path, "not JSON, or a number that double cannot hold");
    PolygonFile file;
    if (document.is_array()) {
        NamedPolygon named{assets::file_name(path), {}};
        if (!append_rings(document, false, named.polygon)) return damaged(path, "expected rings, [[[x, y], …], …]");
        file.polygons.push_back(std::move(named));
    } else if (document.is_object()) {
        file.one_plane = true;
        if (auto read = GeoJsonReader(path, file).read(document); !read) return read.error();
    } else {
        return damaged(path, "neither rings nor GeoJSON");
    }
    std::uint64_t points = 0;
    for (const NamedPolygon& named : file.polygons) points += named.polygon.points.size();
    if (points > limits.triangles) return assets::in_file(path, "", assets::over_limit("triangles", limits.triangles));
    return file;
}

// Levels may share their lumps, so that a small file has many large ones.
Result<PolygonFile> read_wad(const std::string& path, const std::string& text, const std::string& map,
                             const assets::ReadLimits& limits) {
    const assets::Deadline deadline(limits);
    std::uint64_t points = 0;
    std::vector<std::string> levels{map};
    if (map.empty()) {
        const auto names = assets::list_levels(text);
        if (!names) return assets::in_file(path, "", names.error());
        levels = *names;
    }
    PolygonFile file;
    file.one_plane = levels.size() == 1;
    for (const std::string& name : levels) {
        if (auto in_time = deadline.check(); !in_time) return assets::in_file(path, "", in_time.error());
        const auto level = assets::read_level(text, name);
        if (!level) return assets::in_file(path, "", level.error());
        const auto sectors = assets::sector_polygons(*level);
        for (std::size_t s = 0; s < sectors.size(); ++s) {
            const std::string sector = level->name + "_s" + std::to_string(s);
            if (!sectors[s].problem.empty()) file.warnings.push_back(sector + ": " + sectors[s].problem);
            for (std::size_t i = 0; i < sectors[s].polygons.size(); ++i) {
                file.polygons.push_back({sector + "_" + std::to_string(i), sectors[s].polygons[i]});
                points += sectors[s].polygons[i].points.size();
            }
        }
        if (points > limits.triangles)
            return assets::in_file(path, "", assets::over_limit("triangles", limits.triangles));
    }
    return file;
}

}  // namespace

bool is_polygon_file(const std::string& path) {
    const std::string extension = assets::extension(path);
    return extension == "poly" || extension == "json" || extension == "geojson" || extension == "wad";
}

Result<PolygonFile> read_polygons(const std::string& path, const std::string& map, const assets::ReadLimits& limits) {
    const auto text = read_file(path, limits.bytes);
    if (!text) return text.error();
    const std::string extension = assets::extension(path);
    auto file = extension == "poly"  ? PolyReader(path, *text, limits).read()
                : extension == "wad" ? read_wad(path, *text, map, limits)
                                     : read_json(path, *text, limits);
    if (file && file->polygons.empty()) return fail(ErrorCode::empty, kNoItem, path + ": holds no polygon");
    return file;
}

}  // namespace crofton::cli
