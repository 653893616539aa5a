// SPDX-License-Identifier: MIT
// Bodies: made, asked what they are, destroyed.
#include <crofton/capi/bodies.hpp>

#include <algorithm>

#include <crofton/capi/mesh.hpp>

using namespace crofton;
using namespace crofton::capi;

static_assert(CROFTON_BODY_COMPOUND == static_cast<int>(convex::Kind::compound) &&
              CROFTON_BODY_HULL == static_cast<int>(convex::Kind::hull) && CROFTON_HOLE == convex::kHole);

namespace {

using Description = crofton_body_description;

// `make` fills what the body is a view of, and returns the body.
template <class Make>
crofton_status create_body(crofton_body** body, const char* function, Make make) {
    return recover(function, [&] {
        const auto data = std::allocate_shared<BodyData>(Allocator<BodyData>());
        const Result<convex::Body> made = make(*data);
        if (!made) return report(made.error(), function);
        data->body = *made;
        return create(body, function, SharedBody(data));
    });
}

glm::vec3 to_float_vector(const float* v) {
    return {v[0], v[1], v[2]};
}

// Of a body that views nothing.
Result<convex::Body> make_simple(const Description& given) {
    switch (given.kind) {
        case CROFTON_BODY_SPHERE:
            return convex::Body::sphere(given.radius);
        case CROFTON_BODY_CAPSULE:
            return convex::Body::capsule(given.half_height, given.radius);
        case CROFTON_BODY_CYLINDER:
            return convex::Body::cylinder(given.half_height, given.radius);
        case CROFTON_BODY_CONE:
            return convex::Body::cone(given.half_height, given.radius);
        case CROFTON_BODY_BOX:
            return convex::Body::box(to_float_vector(given.half_extents));
        case CROFTON_BODY_TRIANGLE:
            return convex::Body::triangle(to_float_vector(given.corners), to_float_vector(given.corners + 3),
                                          to_float_vector(given.corners + 6));
        default:
            return convex::Body::half_space({to_vector(given.plane.normal), given.plane.offset});
    }
}

crofton_status create_hull(const Description& given, crofton_body** body, const char* function) {
    CROFTON_CHECK(check_array(given.points, given.point_count, function, 3));
    convex::HullOptions wanted;
    if (given.max_vertices != 0) wanted.max_vertices = static_cast<int>((std::min)(given.max_vertices, 1u << 20));
    if (given.face_tolerance != 0.0f) wanted.face_tolerance = given.face_tolerance;
    static_assert(sizeof(glm::vec3) == 3 * sizeof(float));
    return create_body(body, function, [&](BodyData& data) -> Result<convex::Body> {
        auto hull = convex::Hull::build({reinterpret_cast<const glm::vec3*>(given.points), given.point_count}, wanted);
        if (!hull) return tl::unexpected(hull.error());
        return convex::Body::hull(data.hull.emplace(std::move(*hull)));
    });
}

crofton_status create_rounded(const Description& given, crofton_body** body, const char* function) {
    const SharedUse use(given.core, function);
    if (use.failed()) return use.status();
    return create_body(body, function, [&](BodyData& data) {
        data.parts.push_back(given.core->data);
        return convex::Body::rounded(*given.core->data->body, given.radius);
    });
}

convex::Sides sides_of(const Description& given) {
    return given.front_only != 0 ? convex::Sides::front : convex::Sides::both;
}

crofton_status create_mesh(const Description& given, crofton_body** body, const char* function) {
    TriangleMesh copy;
    CROFTON_CHECK(to_mesh(given.mesh, function, copy));
    return create_body(body, function, [&](BodyData& data) -> Result<convex::Body> {
        auto tree = mesh::MeshTree::build(copy, {.rays = true});
        if (!tree) return tl::unexpected(tree.error());
        return convex::Body::mesh(data.mesh.emplace(std::move(*tree)), sides_of(given));
    });
}

crofton_status create_height_field(const Description& given, crofton_body** body, const char* function) {
    crofton_height_field field{};
    CROFTON_CHECK(read_growing(given.height_field, function, field));
    const std::size_t corners = std::size_t{field.columns} * field.rows;
    CROFTON_CHECK(check_array(field.heights, corners, function));
    const bool has_cells = field.materials != nullptr && field.columns > 0 && field.rows > 0;
    const std::size_t cells = has_cells ? std::size_t{field.columns - 1} * (field.rows - 1) : 0;
    convex::HeightFieldDescription description;
    description.columns = field.columns;
    description.rows = field.rows;
    description.heights = {field.heights, corners};
    description.materials = {field.materials, cells};
    for (int k = 0; k < 2; ++k)
        if (field.spacing[k] != 0.0) description.spacing[k] = field.spacing[k];
    return create_body(body, function, [&](BodyData& data) -> Result<convex::Body> {
        auto built = convex::HeightField::build(description);
        if (!built) return tl::unexpected(built.error());
        return convex::Body::height_field(data.field.emplace(std::move(*built)), sides_of(given));
    });
}

crofton_status create_compound(const Description& given, crofton_body** body, const char* function) {
    CROFTON_CHECK(check_array(given.children, given.child_count, function));
    CROFTON_CHECK(check_array(given.poses, given.child_count, function));
    return recover(function, [&] {
        // Copied while they are held: another thread may destroy a child at any time.
        Vector<SharedBody> parts;
        parts.reserve(given.child_count);
        for (std::size_t i = 0; i < given.child_count; ++i) {
            const SharedUse use(given.children[i], function);
            if (use.failed()) return of_item(use.status(), i);
            parts.push_back(given.children[i]->data);
        }
        return create_body(body, function, [&](BodyData& data) -> Result<convex::Body> {
            Vector<convex::CompoundChild> children;
            children.reserve(parts.size());
            for (std::size_t i = 0; i < parts.size(); ++i) {
                const Transform pose = to_transform(given.poses[i]);
                children.push_back({*parts[i]->body, {pose.linear, pose.translation}});
            }
            data.parts = std::move(parts);
            auto built = convex::Compound::build(children);
            if (!built) return tl::unexpected(built.error());
            return convex::Body::compound(data.compound.emplace(std::move(*built)));
        });
    });
}

void give_bounds(const Aabb& bounds, crofton_body_info& info) {
    std::copy_n(&bounds.min.x, 3, info.min);
    std::copy_n(&bounds.max.x, 3, info.max);
}

}  // namespace

crofton_status crofton_body_create(const crofton_body_description* description, crofton_body** body) {
    CROFTON_CHECK(check_pointer(body, __func__));
    Description given;
    CROFTON_CHECK(read_growing(description, __func__, given));
    switch (given.kind) {
        case CROFTON_BODY_HULL:
            return create_hull(given, body, __func__);
        case CROFTON_BODY_MESH:
            return create_mesh(given, body, __func__);
        case CROFTON_BODY_HEIGHT_FIELD:
            return create_height_field(given, body, __func__);
        case CROFTON_BODY_COMPOUND:
            return create_compound(given, body, __func__);
        case CROFTON_BODY_ROUNDED:
            return create_rounded(given, body, __func__);
        default:
            if (given.kind > CROFTON_BODY_ROUNDED)
                return report(CROFTON_INVALID_ARGUMENT, __func__, "unknown kind of body");
            return create_body(body, __func__, [&](BodyData&) { return make_simple(given); });
    }
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
        result.vertices = &hull->vertices().front().x;
        result.indices = hull->triangles().data();
        result.index_count = hull->triangles().size();
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
