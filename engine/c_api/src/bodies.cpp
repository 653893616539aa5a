// SPDX-License-Identifier: MIT
// Bodies: made, asked what they are, destroyed.
#include "bodies.hpp"

#include <algorithm>

#include "mesh.hpp"

using namespace crofton;
using namespace crofton::capi;

static_assert(CROFTON_BODY_COMPOUND == static_cast<int>(convex::Kind::compound) &&
              CROFTON_BODY_HULL == static_cast<int>(convex::Kind::hull) && CROFTON_HOLE == convex::kHole);

namespace {

// `make` fills what the body is a view of, and returns the body.
template <class Make>
crofton_status create_body(crofton_body** body, const char* function, Make make) {
    CROFTON_CHECK(check_pointer(body, function));
    return recover(function, [&] {
        const auto data = std::allocate_shared<BodyData>(Allocator<BodyData>());
        const Result<convex::Body> made = make(*data);
        if (!made) return report(made.error(), function);
        data->body = *made;
        return create(body, function, SharedBody(data));
    });
}

// Of a body that views nothing.
template <class Make>
crofton_status create_simple(crofton_body** body, const char* function, Make make) {
    return create_body(body, function, [&](BodyData&) { return make(); });
}

glm::vec3 to_float_vector(const float* v) {
    return {v[0], v[1], v[2]};
}

crofton_status create_compound(crofton_body** body, const char* function, Vector<SharedBody> parts,
                               const crofton_transform* poses) {
    return create_body(body, function, [&](BodyData& data) -> Result<convex::Body> {
        Vector<convex::CompoundChild> children;
        children.reserve(parts.size());
        for (std::size_t i = 0; i < parts.size(); ++i) {
            const Transform pose = to_transform(poses[i]);
            children.push_back({*parts[i]->body, {pose.linear, pose.translation}});
        }
        data.parts = std::move(parts);
        auto built = convex::Compound::build(children);
        if (!built) return tl::unexpected(built.error());
        return convex::Body::compound(data.compound.emplace(std::move(*built)));
    });
}

void give_bounds(const Aabb& bounds, crofton_body_info& info) {
    std::copy_n(&bounds.min.x, 3, info.min);
    std::copy_n(&bounds.max.x, 3, info.max);
}

}  // namespace

crofton_status crofton_body_sphere(float radius, crofton_body** body) {
    return create_simple(body, __func__, [&] { return convex::Body::sphere(radius); });
}

crofton_status crofton_body_capsule(float half_height, float radius, crofton_body** body) {
    return create_simple(body, __func__, [&] { return convex::Body::capsule(half_height, radius); });
}

crofton_status crofton_body_cylinder(float half_height, float radius, crofton_body** body) {
    return create_simple(body, __func__, [&] { return convex::Body::cylinder(half_height, radius); });
}

crofton_status crofton_body_cone(float half_height, float radius, crofton_body** body) {
    return create_simple(body, __func__, [&] { return convex::Body::cone(half_height, radius); });
}

crofton_status crofton_body_box(const float half_extents[3], crofton_body** body) {
    CROFTON_CHECK(check_pointer(half_extents, __func__));
    return create_simple(body, __func__, [&] { return convex::Body::box(to_float_vector(half_extents)); });
}

crofton_status crofton_body_triangle(const float corners[9], crofton_body** body) {
    CROFTON_CHECK(check_pointer(corners, __func__));
    return create_simple(body, __func__, [&] {
        return convex::Body::triangle(to_float_vector(corners), to_float_vector(corners + 3),
                                      to_float_vector(corners + 6));
    });
}

crofton_status crofton_body_half_space(const crofton_plane* plane, crofton_body** body) {
    CROFTON_CHECK(check_pointer(plane, __func__));
    return create_simple(body, __func__, [&] {
        return convex::Body::half_space({to_vector(plane->normal), plane->offset});
    });
}

crofton_status crofton_body_hull(const float* points, size_t count, const crofton_hull_options* options,
                                 crofton_body** body) {
    CROFTON_CHECK(check_array(points, count, __func__, 3));
    crofton_hull_options given{};
    if (options) CROFTON_CHECK(read_growing(options, __func__, given));
    convex::HullOptions wanted;
    if (given.max_vertices != 0) wanted.max_vertices = static_cast<int>((std::min)(given.max_vertices, 1u << 20));
    if (given.face_tolerance != 0.0f) wanted.face_tolerance = given.face_tolerance;
    static_assert(sizeof(glm::vec3) == 3 * sizeof(float));
    return create_body(body, __func__, [&](BodyData& data) -> Result<convex::Body> {
        auto hull = convex::Hull::build({reinterpret_cast<const glm::vec3*>(points), count}, wanted);
        if (!hull) return tl::unexpected(hull.error());
        return convex::Body::hull(data.hull.emplace(std::move(*hull)));
    });
}

crofton_status crofton_body_rounded(const crofton_body* core, float radius, crofton_body** body) {
    const SharedUse use(core, __func__);
    if (use.failed()) return use.status();
    return create_body(body, __func__, [&](BodyData& data) {
        data.parts.push_back(core->data);
        return convex::Body::rounded(*core->data->body, radius);
    });
}

crofton_status crofton_body_mesh(const crofton_mesh* mesh, uint32_t front_only, crofton_body** body) {
    TriangleMesh copy;
    CROFTON_CHECK(to_mesh(mesh, __func__, copy));
    return create_body(body, __func__, [&](BodyData& data) -> Result<convex::Body> {
        auto tree = mesh::MeshTree::build(copy, {.rays = true});
        if (!tree) return tl::unexpected(tree.error());
        return convex::Body::mesh(data.mesh.emplace(std::move(*tree)),
                                  front_only != 0 ? convex::Sides::front : convex::Sides::both);
    });
}

crofton_status crofton_body_height_field(const crofton_height_field* field, uint32_t both_sides, crofton_body** body) {
    crofton_height_field given{};
    CROFTON_CHECK(read_growing(field, __func__, given));
    const std::size_t corners = std::size_t{given.columns} * given.rows;
    CROFTON_CHECK(check_array(given.heights, corners, __func__));
    const bool has_cells = given.materials != nullptr && given.columns > 0 && given.rows > 0;
    const std::size_t cells = has_cells ? std::size_t{given.columns - 1} * (given.rows - 1) : 0;
    convex::HeightFieldDescription description;
    description.columns = given.columns;
    description.rows = given.rows;
    description.heights = {given.heights, corners};
    description.materials = {given.materials, cells};
    for (int k = 0; k < 2; ++k)
        if (given.spacing[k] != 0.0) description.spacing[k] = given.spacing[k];
    return create_body(body, __func__, [&](BodyData& data) -> Result<convex::Body> {
        auto built = convex::HeightField::build(description);
        if (!built) return tl::unexpected(built.error());
        return convex::Body::height_field(data.field.emplace(std::move(*built)),
                                          both_sides != 0 ? convex::Sides::both : convex::Sides::front);
    });
}

crofton_status crofton_body_compound(const crofton_body* const* children, const crofton_transform* poses, size_t count,
                                     crofton_body** body) {
    CROFTON_CHECK(check_array(children, count, __func__));
    CROFTON_CHECK(check_array(poses, count, __func__));
    const char* const function = __func__;
    return recover(function, [&] {
        // Copied while they are held: another thread may destroy a child at any time.
        Vector<SharedBody> parts;
        parts.reserve(count);
        for (std::size_t i = 0; i < count; ++i) {
            const SharedUse use(children[i], function);
            if (use.failed()) return of_item(use.status(), i);
            parts.push_back(children[i]->data);
        }
        return create_compound(body, function, std::move(parts), poses);
    });
}

crofton_status crofton_body_destroy(crofton_body* body) {
    return destroy(body, __func__);
}

crofton_status crofton_body_get_info(const crofton_body* body, crofton_body_info* info) {
    const SharedUse use(body, __func__);
    if (use.failed()) return use.status();
    CROFTON_CHECK(check_growing(info, __func__));
    const convex::Body& asked = *body->data->body;
    crofton_body_info result{};
    result.kind = static_cast<std::uint32_t>(asked.kind());
    result.part_count = asked.compound() ? asked.compound()->part_count() : 1;
    give_bounds(asked.bounds(), result);
    if (const convex::Hull* hull = asked.hull()) {
        result.vertex_count = static_cast<std::uint32_t>(hull->vertices().size());
        result.face_count = static_cast<std::uint32_t>(hull->face_count());
        result.max_overshoot = hull->max_overshoot();
    }
    write_growing(result, info);
    return CROFTON_OK;
}

crofton_status crofton_body_get_mass(const crofton_body* body, crofton_mass_properties* mass) {
    const SharedUse use(body, __func__);
    if (use.failed()) return use.status();
    CROFTON_CHECK(check_growing(mass, __func__));
    const auto found = convex::mass_properties(*body->data->body);
    if (!found) return report(found.error(), __func__);
    crofton_mass_properties result{};
    result.volume = found->volume;
    std::copy_n(&found->center.x, 3, result.center);
    std::copy_n(&found->inertia[0].x, 9, result.inertia);
    write_growing(result, mass);
    return CROFTON_OK;
}

crofton_status crofton_body_hull_surface(const crofton_body* body, const float** vertices, size_t* vertex_count,
                                         const uint16_t** indices, size_t* index_count) {
    const SharedUse use(body, __func__);
    if (use.failed()) return use.status();
    for (const void* result : {static_cast<const void*>(vertices), static_cast<const void*>(vertex_count),
                               static_cast<const void*>(indices), static_cast<const void*>(index_count)})
        CROFTON_CHECK(check_pointer(result, __func__));
    const convex::Hull* hull = body->data->body->hull();
    if (!hull) return report(CROFTON_UNSUPPORTED, __func__, "the body is no hull");
    *vertices = &hull->vertices().front().x;
    *vertex_count = hull->vertices().size();
    *indices = hull->triangles().data();
    *index_count = hull->triangles().size();
    return CROFTON_OK;
}
