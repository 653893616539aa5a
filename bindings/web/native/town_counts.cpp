// SPDX-License-Identifier: MIT
// Prints the native library's answers for the page's town. For each camera: the objects in its frustum, the triangles
// that its picture needs, and a digest of their list. Reads doubles, written by bindings/web/test/page.test.js.
#include <crofton/capi/crofton.h>

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
    data.clusters = data.one_sided = 1;
    crofton_world_mesh mesh{};
    require_ok(crofton_world_add_mesh(world, &data, &mesh));
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
    crofton_view_result* seen = nullptr;
    require_ok(crofton_view_result_create(&seen));
    for (std::size_t cameras = in.count(); cameras > 0; --cameras) {
        const crofton_camera camera = read_camera(in);
        crofton_picture_view picture = crofton_default_picture_view();
        picture.width = static_cast<std::uint32_t>(in.count()), picture.height = static_cast<std::uint32_t>(in.count());
        picture.depth = CROFTON_DEPTH_MINUS_ONE_TO_ONE;
        crofton_view_request request = crofton_default_view_request();
        request.camera = &camera;
        require_ok(crofton_world_view(world, &request, 1, nullptr, seen));
        const std::uint32_t* ids = nullptr;
        std::size_t count = 0;
        require_ok(crofton_view_result_ids(seen, &ids, &count, nullptr, nullptr));
        request.picture = &picture;
        require_ok(crofton_world_view(world, &request, 1, nullptr, seen));
        crofton_view_info info{};
        info.size = sizeof info;
        require_ok(crofton_view_result_get_view(seen, 0, &info));
        std::uint32_t digest = 2166136261u;
        const auto mix = [&](std::uint64_t word) { digest = (digest ^ static_cast<std::uint32_t>(word)) * 16777619u; };
        for (std::size_t i = 0; i < info.triangle_cluster_count; ++i) {
            const crofton_visible_cluster& one = info.triangles[i];
            mix(one.object), mix(one.cluster), mix(one.triangles), mix(one.triangles >> 32);
        }
        std::printf("%zu %llu %u\n", count, static_cast<unsigned long long>(info.triangles_listed), digest);
    }
}
