// SPDX-License-Identifier: MIT
// What native Crofton says of the page's town. For each camera: how many objects are outside, straddling, inside and
// occluded, and a digest of all verdicts. Reads doubles, written by bindings/web/test/page.test.js.
#include <crofton/capi/scene.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <vector>

namespace {

void require_ok(crofton_status status) {
    if (status == CROFTON_OK) return;
    std::printf("%s\n", crofton_last_error());
    std::exit(1);
}

struct Reader {
    std::vector<double> numbers;
    std::size_t at = 0;
    double next() {
        return at < numbers.size() ? numbers[at++] : (std::puts("the file ends early"), std::exit(1), 0.0);
    }
    std::size_t count() { return static_cast<std::size_t>(next()); }
    template <class T>
    std::vector<T> list(std::size_t n) {
        std::vector<T> values;
        for (std::size_t i = 0; i < n; ++i) values.push_back(static_cast<T>(next()));
        return values;
    }
};

crofton_world_mesh read_mesh(Reader& in, crofton_world* world) {
    const std::vector<float> positions = in.list<float>(in.count());
    const std::vector<std::uint32_t> indices = in.list<std::uint32_t>(in.count());
    crofton_mesh_data data = crofton_default_mesh_data();
    data.positions = positions.data(), data.position_count = positions.size() / 3;
    data.indices = indices.data(), data.index_count = indices.size();
    crofton_world_mesh mesh{};
    require_ok(crofton_world_add_mesh(world, &data, &mesh));
    if (in.next() != 0.0) {
        crofton_occluder occluder{};
        occluder.size = sizeof occluder;
        occluder.kind = 2;
        occluder.positions = positions.data(), occluder.position_count = positions.size() / 3;
        require_ok(crofton_world_set_occluders(world, mesh, &occluder, 1));
    }
    return mesh;
}

void add_object(Reader& in, crofton_world* world, const std::vector<crofton_world_mesh>& meshes) {
    const std::size_t mesh = in.count();
    const std::vector<double> columns = in.list<double>(12);
    crofton_transform transform{};
    static_assert(sizeof transform == 12 * sizeof(double));
    for (std::size_t i = 0; i < 12; ++i) reinterpret_cast<double*>(&transform)[i] = columns[i];
    crofton_object_description description = crofton_default_object_description();
    description.transform = &transform, description.has_mesh = 1, description.mesh = meshes.at(mesh);
    crofton_object object{};
    require_ok(crofton_world_add(world, &description, &object));
}

crofton_box read_box(Reader& in) {
    crofton_box box{};
    for (double& c : box.center) c = in.next();
    float* numbers = reinterpret_cast<float*>(&box.center + 1);
    for (int i = 0; i < 12; ++i) numbers[i] = static_cast<float>(in.next());
    return box;
}

crofton_camera read_camera(Reader& in) {
    crofton_camera camera = crofton_default_camera();
    for (double* vector : {camera.position, camera.forward, camera.up})
        for (int k = 0; k < 3; ++k) vector[k] = in.next();
    camera.fov_y = in.next(), camera.aspect = in.next();
    camera.near_distance = in.next(), camera.far_distance = in.next();
    return camera;
}

}  // namespace

int main(int, char** arguments) {
    Reader in;
    std::FILE* file = std::fopen(arguments[1], "rb");
    double value = 0.0;
    while (file && std::fread(&value, sizeof value, 1, file) == 1) in.numbers.push_back(value);
    crofton_world* world = nullptr;
    require_ok(crofton_world_create(nullptr, &world));
    std::vector<crofton_world_mesh> meshes(in.count());
    for (crofton_world_mesh& mesh : meshes) mesh = read_mesh(in, world);
    const std::size_t objects = in.count();
    for (std::size_t i = 0; i < objects; ++i) add_object(in, world, meshes);
    require_ok(crofton_world_update(world, nullptr));
    std::vector<crofton_box> boxes;
    for (std::size_t i = 0; i < objects; ++i) boxes.push_back(read_box(in));
    crofton_tree* tree = nullptr;
    require_ok(crofton_tree_create(boxes.data(), nullptr, objects, nullptr, &tree));
    crofton_view_result* seen = nullptr;
    require_ok(crofton_view_result_create(&seen));
    for (std::size_t cameras = in.count(); cameras > 0; --cameras) {
        const bool occlusion = in.next() != 0.0;
        const crofton_camera camera = read_camera(in);
        crofton_view_request request = crofton_default_view_request();
        request.camera = &camera;
        require_ok(crofton_tree_view(tree, &request, nullptr, seen));
        const std::uint32_t* ids = nullptr;
        const std::uint8_t* found = nullptr;
        std::size_t count = 0;
        require_ok(crofton_view_result_ids(seen, &ids, &count, &found, nullptr));
        std::vector<std::uint8_t> verdicts(objects);
        for (std::size_t i = 0; i < count; ++i) verdicts[ids[i]] = found[i];
        crofton_occlusion_options options = crofton_default_occlusion_options();
        options.list_occluded = 1;
        if (occlusion) request.occlusion = &options;
        require_ok(crofton_world_view(world, &request, 1, nullptr, seen));
        if (occlusion) {
            crofton_view_info info{};
            info.size = sizeof info;
            require_ok(crofton_view_result_get_view(seen, 0, &info));
            for (std::size_t i = 0; i < info.occluded_count; ++i)
                if (verdicts[info.occluded_ids[i]] != 0) verdicts[info.occluded_ids[i]] = 3;
        }
        std::size_t counts[4] = {};
        std::uint32_t digest = 2166136261u;
        for (const std::uint8_t verdict : verdicts) ++counts[verdict], digest = (digest ^ verdict) * 16777619u;
        std::printf("%zu %zu %zu %zu %u\n", counts[0], counts[1], counts[2], counts[3], digest);
    }
}
