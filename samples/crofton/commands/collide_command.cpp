// SPDX-License-Identifier: MIT
// crofton collide: do two meshes meet, where, how deep, or how far apart are they?
#include <charconv>
#include <chrono>
#include <cmath>
#include <crofton/mesh/mesh_distance.hpp>
#include <crofton/mesh/mesh_query.hpp>
#include <crofton/mesh/mesh_tree.hpp>
#include <filesystem>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

#include "assets/print.hpp"
#include "collide_shapes.hpp"
#include "commands.hpp"
#include "json/json.hpp"
#include "mesh_file.hpp"
#include "report.hpp"

namespace crofton::cli {
namespace {

using Clock = std::chrono::steady_clock;

struct CollideRequest {
    ReadOptions read;
    std::string a, b, pose, mode = "any", json_path, velocity, spin;
    bool hulls = false;
    std::uint32_t max_vertices = convex::kMaxHullVertices;
    double duration = 1.0;
};

double milliseconds_since(Clock::time_point start) {
    return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

Json array_of(const glm::dvec3& v) {
    return Json::array({v.x, v.y, v.z});
}

const char* name_of(mesh::Containment containment) {
    switch (containment) {
        case mesh::Containment::a_inside_b:
            return "a_inside_b";
        case mesh::Containment::b_inside_a:
            return "b_inside_a";
        case mesh::Containment::partly:
            return "partly";
        default:
            return "none";
    }
}

const char* sentence_of(mesh::Containment containment) {
    switch (containment) {
        case mesh::Containment::a_inside_b:
            return "A lies inside B";
        case mesh::Containment::b_inside_a:
            return "B lies inside A";
        case mesh::Containment::partly:
            return "some pieces of one lie inside the other";
        default:
            return "neither lies inside the other";
    }
}

// Seven numbers, apart by commas or blanks, given as such or in a file: tx ty tz qw qx qy qz.
Result<RigidTransform> pose_of(const std::string& argument) {
    RigidTransform pose;
    if (argument.empty()) return pose;
    std::string text = argument;
    if (std::error_code error; std::filesystem::is_regular_file(argument, error)) {
        auto contents = read_file(argument);
        if (!contents) return contents.error();
        text = *contents;
    }
    const auto bad = [&](std::uint64_t item, const char* why) {
        return fail(ErrorCode::parse, item,
                    "--pose " + argument + ": " + why + "; give tx,ty,tz,qw,qx,qy,qz or a file with them");
    };
    double value[7];
    std::size_t count = 0;
    const char* const end = text.data() + text.size();
    for (const char* at = text.data(); at != end;) {
        if (*at == ',' || *at == ' ' || *at == '\n' || *at == '\t' || *at == '\r') {
            ++at;
            continue;
        }
        if (count == 7) return bad(7, "more than seven numbers");
        const auto [next, error] = std::from_chars(at, end, value[count]);
        if (error != std::errc()) return bad(count, "neither a number nor a file that can be read");
        at = next;
        ++count;
    }
    if (count != 7) return bad(count, "fewer than seven numbers");
    const glm::dquat q(value[3], value[4], value[5], value[6]);
    const double length = glm::length(q);
    if (!(length > 1e-100 && std::isfinite(length))) return bad(3, "the quaternion has no direction");
    pose = {glm::mat3_cast(q / length), {value[0], value[1], value[2]}};
    if (auto valid = validate(pose); !valid) return bad(valid.error().item, valid.error().message.c_str());
    return pose;
}

// The pose of B in A's frame, for vertices that are relative to an origin each.
RigidTransform between_origins(const glm::dvec3& of_a, const RigidTransform& pose, const glm::dvec3& of_b) {
    return {pose.rotation, pose.rotation * of_b - of_a + pose.translation};
}

struct PlacedTree {
    mesh::MeshTree tree;
    glm::dvec3 origin;
};

Result<PlacedTree> tree_of(const std::string& path, const ReadOptions& options, double& milliseconds) {
    const auto loaded = load_mesh(path, options);
    if (!loaded) return loaded.error();
    const auto start = Clock::now();
    auto tree = mesh::MeshTree::build(loaded->mesh);
    milliseconds += milliseconds_since(start);
    if (!tree) return fail(tree.error().code, tree.error().item, path + ": " + tree.error().message);
    if (!tree->rejected().empty())
        print_to(stderr, "crofton: %s: %zu bad triangles left out, the first is %u\n", printable(path).c_str(),
                 tree->rejected().size(), tree->rejected()[0]);
    return PlacedTree{std::move(*tree), loaded->origin};
}

struct Answer {
    bool hit = false;
    Vector<mesh::MeshContact> contacts;
    double depth = 0.0, distance = -1.0;  // −1: not asked for
    mesh::MeshDistance nearest;
    mesh::Containment contained = mesh::Containment::none;
    mesh::MeshStatistics statistics;
};

Answer ask(const std::string& mode, const mesh::MeshTree& a, const mesh::MeshTree& b, const RigidTransform& pose) {
    Answer answer;
    if (mode == "all") {
        mesh::contacts(a, b, pose, answer.contacts, &answer.statistics);
        answer.hit = !answer.contacts.empty();
    } else if (mode == "distance") {
        answer.nearest = mesh::distance(a, b, pose, std::numeric_limits<double>::infinity(), &answer.statistics);
        answer.distance = answer.nearest.distance;
        answer.hit = answer.distance == 0.0;
    } else {
        answer.hit = mesh::intersects(a, b, pose, &answer.statistics);
    }
    if (!answer.hit) answer.contained = mesh::containment_of_disjoint(a, b, pose);
    answer.hit = answer.hit || answer.contained != mesh::Containment::none;
    return answer;
}

// Points are relative to `origin`.
Json document_of(const Answer& answer, const glm::dvec3& origin) {
    Json document{{"hit", answer.hit}, {"pairs", Json::array()}, {"contacts", Json::array()}, {"depth", answer.depth}};
    for (const mesh::MeshContact& c : answer.contacts) {
        document["pairs"].push_back({c.triangles.first, c.triangles.second});
        document["contacts"].push_back({{"triangles", {c.triangles.first, c.triangles.second}},
                                        {"position", array_of(origin + 0.5 * (c.segment.begin + c.segment.end))},
                                        {"begin", array_of(origin + c.segment.begin)},
                                        {"end", array_of(origin + c.segment.end)},
                                        {"normal", array_of(c.normal)}});
    }
    document["distance"] = answer.distance >= 0.0 ? Json(answer.distance) : Json(nullptr);
    if (answer.distance >= 0.0) {
        document["nearest"] = {{"on_a", array_of(origin + answer.nearest.on_a)},
                               {"on_b", array_of(origin + answer.nearest.on_b)},
                               {"triangles", {answer.nearest.triangles.first, answer.nearest.triangles.second}}};
    }
    document["contained"] = name_of(answer.contained);
    document["bv_tests"] = answer.statistics.box_tests;
    document["triangle_tests"] = answer.statistics.triangle_tests;
    document["exact_tests"] = answer.statistics.exact_tests;
    return document;
}

// Runs queries of hulls, and casts of hulls or meshes.
int run_shapes(const CollideRequest& request, const RigidTransform& pose) {
    if (request.mode == "contain") {
        std::fputs("crofton: --mode contain tests meshes; leave out --hulls\n", stderr);
        return kBadInput;
    }
    const auto velocity = vector_of("--velocity", request.velocity), spin = vector_of("--spin", request.spin);
    if (!velocity) return report_error("", velocity.error());
    if (!spin) return report_error("", spin.error());
    const auto a = load_shape(request.a, request.hulls, static_cast<int>(request.max_vertices), request.read);
    if (!a) return report_error("", a.error());
    const auto b = load_shape(request.b, request.hulls, static_cast<int>(request.max_vertices), request.read);
    if (!b) return report_error("", b.error());
    if (const auto valid = convex::validate_pose(pose); !valid) return report_error("--pose", valid.error());
    const convex::Shape shape_a = a->shape(), shape_b = b->shape();
    const RigidTransform rest, between = between_origins(a->origin, pose, b->origin);
    ShapeAnswer answer;
    if (request.mode == "cast") {
        auto cast = ask_cast({shape_a, rest}, {shape_b, between}, {*velocity, *spin, shape_b.bounds().center()},
                             request.duration, a->origin);
        if (!cast) return report_error("", cast.error());
        answer = std::move(*cast);
    } else {
        answer = ask_hulls(request.mode, {shape_a, rest}, {shape_b, between}, a->origin);
    }
    if (request.hulls) {
        answer.document["hulls"] = Json::array();
        for (const FileShape* file : {&*a, &*b})
            answer.document["hulls"].push_back({{"vertices", file->hull->vertices().size()},
                                                {"faces", file->hull->face_count()},
                                                {"max_overshoot", file->hull->max_overshoot()},
                                                {"volume", file->hull->mass().volume}});
    }
    if (request.json_path != "-") print_to(stdout, "%s\n", printable(answer.sentence).c_str());
    if (request.json_path.empty()) return kSuccess;
    if (const auto written = write_json(request.json_path, answer.document); !written)
        return report_error("", written.error());
    return kSuccess;
}

int run_collide(const CollideRequest& request) {
    const auto pose = pose_of(request.pose);
    if (!pose) return report_error("", pose.error());
    if (request.hulls || request.mode == "cast") return run_shapes(request, *pose);
    double build = 0.0;
    const auto a = tree_of(request.a, request.read, build);
    if (!a) return report_error("", a.error());
    const auto b = tree_of(request.b, request.read, build);
    if (!b) return report_error("", b.error());
    const auto start = Clock::now();
    const RigidTransform between = between_origins(a->origin, *pose, b->origin);
    Answer answer = ask(request.mode, a->tree, b->tree, between);
    const double query = milliseconds_since(start);
    if (answer.hit && request.mode == "all")
        answer.depth = mesh::separating_motion(a->tree, b->tree, between, answer.contacts).depth;
    if (request.json_path != "-") {
        print_to(stdout, "%s", answer.hit ? "hit" : "no hit");
        if (answer.contained != mesh::Containment::none || request.mode == "contain")
            print_to(stdout, ", %s", sentence_of(answer.contained));
        if (request.mode == "all")
            print_to(stdout, ", %zu pairs of triangles, depth %.6g", answer.contacts.size(), answer.depth);
        if (request.mode == "distance") print_to(stdout, ", distance %.9g", answer.distance);
        print_to(stdout, "  (build %.3f ms, query %.3f ms)\n", build, query);
    }
    if (request.json_path.empty()) return kSuccess;
    Json document = document_of(answer, a->origin);
    document["milliseconds"] = {{"build", build}, {"query", query}};
    if (const auto written = write_json(request.json_path, document); !written)
        return report_error("", written.error());
    return kSuccess;
}

}  // namespace

void add_collide_command(CommandLine& line) {
    auto request = std::make_shared<CollideRequest>();
    Command command =
        line.command("collide", "Test two meshes for overlap; print contacts, depth, distance or time of impact");
    command.option("A", request->a, "Mesh file (.obj, or any scene format; of a .wad the first level)").required();
    command.option("B", request->b, "Mesh file, moved by the pose").required();
    command.option("--pose", request->pose,
                   "Pose of B in A's frame: tx,ty,tz,qw,qx,qy,qz, or a file with these numbers");
    command
        .option("--mode", request->mode,
                "any: whether they overlap; all: which triangles, where and how deep; distance: between the surfaces; "
                "contain: whether one is inside the other; cast: when the moving B first touches A")
        .one_of({"any", "all", "distance", "contain", "cast"})
        .show_default();
    const Option hulls =
        command.flag("--hulls", request->hulls, "Test the convex hulls of the vertices instead of the triangles");
    command
        .option("--max-vertices", request->max_vertices,
                "Largest number of vertices of a hull; one with more is replaced by a larger hull, whose excess is "
                "reported")
        .whole_between(4, convex::kMaxHullVertices)
        .show_default()
        .needs(hulls);
    const Option velocity =
        command.option("--velocity", request->velocity, "With --mode cast: x,y,z, B's translation in a time of 1");
    const Option spin = command.option("--spin", request->spin,
                                       "With --mode cast: x,y,z, B's rotation in a time of 1, as axis times radians");
    const Option duration =
        command.option("--duration", request->duration, "With --mode cast: how long B moves").positive().show_default();
    command.option("--json", request->json_path, "Write the answer as JSON; - for stdout").writable_file_or_stdout();
    command.footer(
        "A mesh inside the other, which must be closed, counts as overlapping and is reported in `contained`. Each "
        "connected piece is\n"
        "tested; triangles are connected if they share vertices, by index or by position. `partly` means that some "
        "pieces\n"
        "are inside, but not all. If the surfaces meet, `contained` is `none`.\n"
        "Depth is an upper bound: the shortest way out along the axes of both frames and boxes, the mean contact\n"
        "normal and the line of centres. Distance is between the surfaces, also for a mesh inside the other.\n"
        "Exit status: 0 answered, 2 bad usage or input.\n"
        "\n"
        "Examples:\n"
        "  crofton collide bunny.obj cow.obj\n"
        "  crofton collide bunny.obj bunny.obj --pose 0.05,0,0,1,0,0,0 --mode all --json -\n"
        "  crofton collide a.obj b.obj --pose pose.txt --mode distance\n"
        "  crofton collide bunny.obj cow.obj --hulls --mode all\n"
        "  crofton collide bunny.obj cow.obj --pose 5,0,0,1,0,0,0 --mode cast --velocity -10,0,0 --spin 0,9,0");
    add_read_options(command, request->read);
    command.action([=] {
        if (request->mode != "cast" && (velocity.given() || spin.given() || duration.given())) {
            std::fputs("crofton: --velocity, --spin and --duration go with --mode cast\n", stderr);
            return static_cast<int>(kBadInput);
        }
        if (request->mode == "cast" && !velocity.given() && !spin.given()) {
            std::fputs("crofton: --mode cast needs --velocity, or --spin: how B moves\n", stderr);
            return static_cast<int>(kBadInput);
        }
        return run_collide(*request);
    });
}

}  // namespace crofton::cli
