// SPDX-License-Identifier: MIT
// The C API called in any order with any numbers: arrays are as long as their counts say, handles live, dead or NULL.
#include <crofton/capi/bake.h>
#include <crofton/capi/crofton.h>
#include <fuzzer/FuzzedDataProvider.h>

#include <cstdlib>
#include <limits>
#include <vector>

#include "../c_api/shorthand.hpp"

using namespace crofton::capi_test;

namespace {

// Numbers that matter and numbers of any bits.
class Input {
  public:
    Input(const std::uint8_t* data, std::size_t size) : bytes_(data, size) {}

    [[nodiscard]] bool more() { return bytes_.remaining_bytes() > 0; }
    std::uint32_t below(std::uint32_t count) { return bytes_.ConsumeIntegralInRange<std::uint32_t>(0, count - 1); }
    bool flag() { return bytes_.ConsumeBool(); }
    std::uint32_t word() { return below(4) ? below(40) : bytes_.ConsumeIntegral<std::uint32_t>(); }
    double number() {
        static constexpr double kTelling[] = {0.0,
                                              -0.0,
                                              1.0,
                                              -1.0,
                                              0.5,
                                              1e-30,
                                              1e30,
                                              1e300,
                                              5e-324,
                                              std::numeric_limits<double>::infinity(),
                                              std::numeric_limits<double>::quiet_NaN()};
        switch (below(4)) {
            case 0:
                return kTelling[below(11)];
            case 1:
                return bytes_.ConsumeFloatingPoint<double>();
            default:
                return static_cast<double>(bytes_.ConsumeIntegral<std::int16_t>()) / 256.0;
        }
    }
    float real() {
        return static_cast<float>(below(8) ? static_cast<double>(bytes_.ConsumeIntegral<std::int8_t>()) / 16.0
                                           : number());
    }
    crofton_box box() {
        crofton_box box{{number(), number(), number()}, {1, 0, 0, 0, 1, 0, 0, 0, 1}, {real(), real(), real()}};
        if (!below(8))
            for (float& x : box.axes) x = real();
        return box;
    }
    std::vector<crofton_box> boxes() {
        std::vector<crofton_box> result(below(50));
        for (crofton_box& b : result) b = box();
        return result;
    }
    crofton_transform transform() {
        crofton_transform t{{1, 0, 0, 0, 1, 0, 0, 0, 1}, {number(), number(), number()}};
        if (!below(4))
            for (double& x : t.linear) x = number();
        return t;
    }
    crofton_ray ray() {
        return {{number(), number(), number()},
                {number(), number(), number()},
                flag() ? number() : std::numeric_limits<double>::infinity()};
    }

  private:
    FuzzedDataProvider bytes_;
};

template <class Struct>
Struct sized() {
    Struct result{};
    result.size = sizeof result;
    return result;
}

// Everything that can be alive at once, one of each kind.
struct World {
    crofton_tree* tree = nullptr;
    crofton_scene* scene = nullptr;
    crofton_view_result* visible = nullptr;
    crofton_broadphase* broadphase = nullptr;
    crofton_shape* meshes[2] = {};
    crofton_triangulator* triangulator = nullptr;
    crofton_clustered_mesh* clustered[2] = {};
    crofton_depth_culler* depth_culler = nullptr;

    World() {
        crofton_scene_create(&scene);
        crofton_view_result_create(&visible);
        crofton_broadphase_create(&broadphase);
        crofton_triangulator_create(&triangulator);
        crofton_depth_culler_create(&depth_culler);
    }
    ~World() {
        crofton_tree_destroy(tree);
        crofton_scene_destroy(scene);
        crofton_view_result_destroy(visible);
        crofton_broadphase_destroy(broadphase);
        for (crofton_shape* mesh : meshes) crofton_shape_destroy(mesh);
        crofton_triangulator_destroy(triangulator);
        for (crofton_clustered_mesh* mesh : clustered) crofton_clustered_mesh_destroy(mesh);
        crofton_depth_culler_destroy(depth_culler);
    }
};

void demand(bool holds) {
    if (!holds) std::abort();
}

struct Mesh {
    std::vector<float> positions;
    std::vector<std::uint32_t> indices;
    crofton_mesh view;

    explicit Mesh(Input& in) : positions(3 * in.below(30)), indices(3 * in.below(30)) {
        for (float& x : positions) x = in.real();
        for (std::uint32_t& i : indices) i = in.word();
        view = {sizeof view,    positions.data(), positions.size() / 3,
                indices.data(), indices.size(),   in.flag() ? "mesh" : nullptr};
    }
};

crofton_frustum frustum(Input& in) {
    auto camera = sized<crofton_camera>();
    auto result = sized<crofton_frustum>();
    camera = crofton_default_camera();
    for (double& x : camera.position) x = in.number();
    for (double& x : camera.forward) x = in.number();
    camera.projection = in.below(3);
    camera.fov_y = in.number();
    camera.near_distance = in.number();
    camera.far_distance = in.number();
    if (in.below(4) != 0 && crofton_frustum_from_camera(&camera, &result) == CROFTON_OK) return result;
    double matrix[16], origin[3];
    for (double& x : matrix) x = in.number();
    for (double& x : origin) x = in.number();
    if (in.flag() && crofton_frustum_from_matrix(matrix, in.below(4), origin, &result) == CROFTON_OK) return result;
    result = sized<crofton_frustum>();
    result.plane_count = in.below(14);
    for (crofton_plane& plane : result.planes) plane = {{in.number(), in.number(), in.number()}, in.number()};
    return result;
}

void cull(World& world, Input& in) {
    View view;
    view.layer_mask = in.word();
    view.frustum = frustum(in);
    crofton_view_request options = crofton_default_view_request();
    options.conservative = in.below(2);
    options.tree_order = in.below(2);
    const auto boxes = in.boxes();
    std::size_t count = boxes.size();
    if (in.flag())
        cull_boxes(boxes.data(), nullptr, boxes.size(), &view, &options, nullptr, world.visible);
    else if (cull_tree(world.tree, &view, &options, nullptr, world.visible) != CROFTON_OK)
        return;
    const std::uint32_t* ids = nullptr;
    const std::uint8_t* verdicts = nullptr;
    if (visible_set_items(world.visible, &ids, &verdicts, &count) == CROFTON_OK)
        for (std::size_t i = 1; i < count && !options.tree_order; ++i) demand(ids[i - 1] < ids[i]);
    std::vector<std::uint8_t> classes(boxes.size());
    crofton_classify(&view.frustum, boxes.data(), boxes.size(), classes.data());
}

void change_tree(World& world, Input& in) {
    const auto boxes = in.boxes();
    std::vector<std::uint32_t> items(boxes.size());
    for (std::uint32_t& item : items) item = in.word();
    std::uint32_t id = 0;
    switch (in.below(7)) {
        case 0:
            crofton_tree_destroy(world.tree);
            world.tree = nullptr;
            crofton_tree_create(boxes.data(), in.flag() ? items.data() : nullptr, boxes.size(), nullptr, &world.tree);
            return;
        case 1:
            crofton_tree_move(world.tree, items.data(), boxes.data(), boxes.size());
            break;
        case 2:
            for (const crofton_box& box : boxes) crofton_tree_insert(world.tree, &box, in.word(), &id);
            break;
        case 3:
            for (const std::uint32_t item : items) crofton_tree_remove(world.tree, item);
            break;
        case 4:
            for (const std::uint32_t item : items) crofton_tree_set_layer_mask(world.tree, item, in.word());
            break;
        default:
            break;
    }
    crofton_tree_refit(world.tree, in.flag() ? in.word() : 0);
}

void ask_tree(World& world, Input& in) {
    const crofton_box box = in.box();
    const crofton_ray ray = in.ray();
    crofton_ray_hit hit{};
    std::uint32_t items[8];
    std::size_t found = 0;
    crofton_tree_raycast(world.tree, &ray, 1, in.word(), &hit);
    tree_within_box(world.tree, &box, in.word(), items, in.below(9), &found);
    tree_within_sphere(world.tree, ray.origin, in.number(), in.word(), items, in.below(9), &found);
}

void pairs(World& world, Input& in) {
    const auto boxes = in.boxes();
    std::vector<crofton_filter> filters(boxes.size());
    for (crofton_filter& filter : filters) filter = {in.word(), in.word()};
    crofton_broadphase_update(world.broadphase, boxes.data(), in.flag() ? filters.data() : nullptr, boxes.size(),
                              nullptr);
    const crofton_pair* list = nullptr;
    std::size_t count = 0;
    for (std::uint32_t which = 0; which < 5; ++which)
        if (crofton_broadphase_pairs(world.broadphase, which, &list, &count) == CROFTON_OK)
            for (std::size_t i = 0; i < count; ++i) demand(list[i].first < list[i].second);
}

void two_boxes(Input& in) {
    const crofton_box a = in.box(), b = in.box();
    const crofton_transform transform = in.transform();
    const crofton_ray ray = in.ray();
    auto manifold = sized<crofton_manifold>();
    crofton_box result;
    double distance = 0.0, on_a[3], on_b[3];
    int meet = 0;
    crofton_boxes_meet(&a, &b, &meet);
    crofton_boxes_distance(&a, &b, &distance, on_a, on_b);
    if (crofton_boxes_manifold(&a, &b, &manifold) == CROFTON_OK)
        demand(manifold.point_count <= CROFTON_MAX_MANIFOLD_POINTS);
    crofton_box_transform(&transform, &a, &result);
    crofton_box_raycast(&a, &ray, &distance);
}

void meshes(World& world, Input& in) {
    crofton_shape*& changed = world.meshes[in.below(2)];
    if (in.flag()) {
        const Mesh mesh(in);
        crofton_shape_destroy(changed);
        changed = nullptr;
        shape_mesh(&mesh.view, in.below(2), &changed);
    }
    const crofton_shape *a = world.meshes[0], *b = world.meshes[1];
    const crofton_transform pose = in.transform();
    const crofton_ray ray = in.ray();
    crofton_mesh_contact contacts[4];
    auto relation = sized<crofton_mesh_relation>();
    auto hit = sized<crofton_shape_ray_hit>();
    std::size_t count = 0;
    int any = 0;
    if (crofton_meshes_relate(a, b, &pose, CROFTON_MESHES_MEET, &relation) == CROFTON_OK &&
        crofton_meshes_contacts(a, b, &pose, contacts, in.below(5), &count) == CROFTON_OK)
        demand((count > 0) == (relation.meet != 0));
    crofton_meshes_relate(a, b, &pose, in.below(17), &relation);
    const crofton_transform identity{{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};
    const crofton_placed placed{a, in.flag() ? &pose : &identity};
    if (crofton_shape_raycast(&placed, &ray, &hit) == CROFTON_OK &&
        crofton_shape_raycast_any(&placed, &ray, &any) == CROFTON_OK)
        demand((any != 0) == (hit.t < std::numeric_limits<double>::infinity()));
}

void picture(World& world, Input& in) {
    crofton_clustered_mesh*& changed = world.clustered[in.below(2)];
    if (in.flag()) {
        Mesh mesh(in);
        const std::size_t vertices = mesh.positions.size() / 3;
        for (std::uint32_t& i : mesh.indices)
            if (vertices != 0 && i < 40) i %= static_cast<std::uint32_t>(vertices);
        crofton_clustered_mesh_destroy(changed);
        changed = nullptr;
        crofton_clustered_mesh_create(&mesh.view, in.below(66), &changed);
    }
    std::vector<crofton_depth_object> objects(in.below(6), crofton_default_depth_object());
    for (crofton_depth_object& object : objects) {
        object.mesh = world.clustered[in.below(2)];
        if (!object.mesh && in.below(8)) object.mesh = world.clustered[world.clustered[0] ? 0 : 1];
        for (float& x : object.to_clip)
            if (in.below(4) == 0) x = in.real();
        object.one_sided = in.below(2);
        object.hides = in.below(3);
        object.position_error = in.below(4) ? 0.0f : in.real();
    }
    crofton_picture_view view = crofton_default_picture_view();
    view.width = in.below(8) ? 1 + in.below(70) : in.word();
    view.height = in.below(8) ? 1 + in.below(70) : in.word();
    view.depth = in.below(4);
    const crofton_visible_cluster* found = nullptr;
    std::size_t count = 0;
    if (crofton_depth_culler_find_visible(world.depth_culler, objects.data(), objects.size(), &view, nullptr, &found,
                                          &count, nullptr) != CROFTON_OK)
        return;
    for (std::size_t i = 0; i < count; ++i) {
        demand(found[i].object < objects.size());
        crofton_clusters clusters{};
        demand(crofton_clustered_mesh_get(objects[found[i].object].mesh, &clusters) == CROFTON_OK);
        demand(found[i].cluster < clusters.cluster_count);
        const std::uint32_t triangles = clusters.clusters[found[i].cluster].triangle_count;
        demand(found[i].triangles != 0 && (triangles == 64 || found[i].triangles >> triangles == 0));
    }
    float nearness = 0.0f;
    demand(crofton_depth_culler_nearness(world.depth_culler, view.width - 1, view.height - 1, &nearness) == CROFTON_OK);
    demand(nearness == nearness);
}

void change_scene(World& world, Input& in) {
    const crofton_transform transform = in.transform();
    std::uint32_t id = 0;
    switch (in.below(6)) {
        case 0: {
            const Mesh mesh(in);
            crofton_scene_add_mesh(world.scene, &mesh.view, &id);
            break;
        }
        case 1:
            crofton_scene_add_node(world.scene, in.flag() ? CROFTON_NONE : in.word(), in.flag() ? &transform : nullptr,
                                   in.word(), &id);
            break;
        case 2:
            crofton_scene_add_instance(world.scene, in.word(), in.word(), &id);
            break;
        case 3:
            crofton_scene_set_local(world.scene, in.word(), &transform);
            break;
        case 4:
            crofton_scene_remove_instance(world.scene, in.word());
            break;
        default:
            crofton_scene_set_layer_mask(world.scene, in.word(), in.word());
    }
    crofton_scene_update(world.scene, nullptr, nullptr);
    const crofton_box* boxes = nullptr;
    const std::uint32_t *layers = nullptr, *moved = nullptr;
    std::size_t count = 0, moved_count = 0;
    crofton_scene_boxes(world.scene, &boxes, &layers, &count);
    crofton_scene_moved(world.scene, &moved, &moved_count);
    for (std::size_t i = 0; i < moved_count; ++i) demand(moved[i] < count);
    for (std::size_t i = 0; i < count; ++i)
        if (layers[i] != 0) demand(crofton_boxes_validate(boxes + i, 1) == CROFTON_OK);
}

void fit(Input& in) {
    std::vector<float> floats(3 * in.below(40));
    std::vector<double> doubles(3 * in.below(40));
    for (float& x : floats) x = in.real();
    for (double& x : doubles) x = in.number();
    const auto boxes = in.boxes();
    auto options = sized<crofton_fit_options>();
    options.quality = in.below(4);
    options.criterion = {in.number(), in.number(), in.number()};
    if (in.flag()) options.criterion = {0.0, 1.0, 0.5};
    crofton_box box;
    if (crofton_fit_points(floats.data(), floats.size() / 3, 0, &options, &box) == CROFTON_OK)
        demand(crofton_boxes_validate(&box, 1) == CROFTON_OK);
    if (crofton_fit_points(doubles.data(), doubles.size() / 3, 1, &options, &box) == CROFTON_OK)
        demand(crofton_boxes_validate(&box, 1) == CROFTON_OK);
    if (crofton_fit_boxes(boxes.data(), boxes.size(), &options.criterion, &box) == CROFTON_OK)
        demand(crofton_boxes_validate(&box, 1) == CROFTON_OK);
}

void triangulate(World& world, Input& in) {
    std::vector<double> points(2 * in.below(40));
    for (double& x : points) x = in.below(16) ? in.below(12) : in.number();
    std::vector<std::uint32_t> ends(in.below(4));
    for (std::uint32_t& end : ends) end = in.word();
    if (!ends.empty() && in.below(8)) ends.back() = static_cast<std::uint32_t>(points.size() / 2);
    auto polygon = sized<crofton_polygon>();
    polygon.points = points.data();
    polygon.point_count = points.size() / 2;
    polygon.ring_ends = ends.data();
    polygon.ring_count = ends.size();
    auto result = sized<crofton_triangulation>();
    if (crofton_triangulate(world.triangulator, &polygon, in.below(4), &result) != CROFTON_OK) return;
    for (std::size_t i = 0; i < 3 * result.triangle_count; ++i) demand(result.indices[i] < polygon.point_count);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    Input in(data, size);
    World world;
    for (int call = 0; call < 20 && in.more(); ++call) switch (in.below(10)) {
            case 0:
                change_tree(world, in);
                break;
            case 1:
                cull(world, in);
                break;
            case 2:
                ask_tree(world, in);
                break;
            case 3:
                pairs(world, in);
                break;
            case 4:
                two_boxes(in);
                break;
            case 5:
                meshes(world, in);
                break;
            case 6:
                change_scene(world, in);
                break;
            case 7:
                fit(in);
                break;
            case 8:
                picture(world, in);
                break;
            default:
                triangulate(world, in);
        }
    return 0;
}
