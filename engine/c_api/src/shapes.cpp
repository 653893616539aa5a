// SPDX-License-Identifier: MIT
// Shapes: made, asked what they are, destroyed.
#include <crofton/capi/shapes.hpp>

#include <algorithm>

#include <crofton/capi/mesh.hpp>

using namespace crofton;
using namespace crofton::capi;

static_assert(CROFTON_SHAPE_COMPOUND == static_cast<int>(convex::Kind::compound) &&
              CROFTON_SHAPE_HULL == static_cast<int>(convex::Kind::hull) && CROFTON_HOLE == convex::kHole);

namespace {

using Description = crofton_shape_description;

// `make` fills what the shape is a view of, and returns the shape.
template <class Make>
crofton_status create_shape(crofton_shape** shape, const char* function, Make make) {
    return recover(function, [&] {
        const auto data = std::allocate_shared<ShapeData>(Allocator<ShapeData>());
        const Result<convex::Shape> made = make(*data);
        if (!made) return report(made.error(), function);
        data->shape = *made;
        return create(shape, function, SharedShape(data));
    });
}

glm::vec3 to_float_vector(const float* v) {
    return {v[0], v[1], v[2]};
}

// Of a shape that views nothing.
Result<convex::Shape> make_simple(const Description& given) {
    switch (given.kind) {
        case CROFTON_SHAPE_SPHERE:
            return convex::Shape::sphere(given.radius);
        case CROFTON_SHAPE_CAPSULE:
            return convex::Shape::capsule(given.half_height, given.radius);
        case CROFTON_SHAPE_CYLINDER:
            return convex::Shape::cylinder(given.half_height, given.radius);
        case CROFTON_SHAPE_CONE:
            return convex::Shape::cone(given.half_height, given.radius);
        case CROFTON_SHAPE_BOX:
            return convex::Shape::box(to_float_vector(given.half_extents));
        case CROFTON_SHAPE_TRIANGLE:
            return convex::Shape::triangle(to_float_vector(given.corners), to_float_vector(given.corners + 3),
                                           to_float_vector(given.corners + 6));
        default:
            return convex::Shape::half_space({to_vector(given.plane.normal), given.plane.offset});
    }
}

crofton_status create_hull(const Description& given, crofton_shape** shape, const char* function) {
    CROFTON_CHECK(check_array(given.points, given.point_count, function, 3));
    convex::HullOptions wanted;
    if (given.max_vertices != 0) wanted.max_vertices = static_cast<int>((std::min)(given.max_vertices, 1u << 20));
    if (given.face_tolerance != 0.0f) wanted.face_tolerance = given.face_tolerance;
    static_assert(sizeof(glm::vec3) == 3 * sizeof(float));
    return create_shape(shape, function, [&](ShapeData& data) -> Result<convex::Shape> {
        auto hull = convex::Hull::build({reinterpret_cast<const glm::vec3*>(given.points), given.point_count}, wanted);
        if (!hull) return hull.error();
        return convex::Shape::hull(data.hull.emplace(std::move(*hull)));
    });
}

crofton_status create_rounded(const Description& given, crofton_shape** shape, const char* function) {
    const SharedUse use(given.core, function);
    if (use.failed()) return use.status();
    return create_shape(shape, function, [&](ShapeData& data) {
        data.parts.push_back(given.core->data);
        return convex::Shape::rounded(*given.core->data->shape, given.radius);
    });
}

convex::Sides sides_of(const Description& given) {
    return given.front_only != 0 ? convex::Sides::front : convex::Sides::both;
}

crofton_status create_mesh(const Description& given, const crofton_jobs* jobs, crofton_shape** shape,
                           const char* function) {
    TriangleMesh copy;
    CROFTON_CHECK(to_mesh(given.mesh, function, copy));
    return create_shape(shape, function, [&](ShapeData& data) -> Result<convex::Shape> {
        if (const auto valid = validate(copy); !valid) return valid.error();
        HostJobs executor(jobs);
        auto tree = mesh::MeshTree::build(copy, {.rays = true}, executor);
        if (!tree) return tree.error();
        if (!tree->rejected().empty())
            return fail(ErrorCode::out_of_range, tree->rejected().front(), "mesh: a vertex is beyond 1e12");
        return convex::Shape::mesh(data.mesh.emplace(std::move(*tree)), sides_of(given));
    });
}

crofton_status create_height_field(const Description& given, crofton_shape** shape, const char* function) {
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
    return create_shape(shape, function, [&](ShapeData& data) -> Result<convex::Shape> {
        auto built = convex::HeightField::build(description);
        if (!built) return built.error();
        return convex::Shape::height_field(data.field.emplace(std::move(*built)), sides_of(given));
    });
}

crofton_status create_compound(const Description& given, crofton_shape** shape, const char* function) {
    CROFTON_CHECK(check_array(given.children, given.child_count, function));
    CROFTON_CHECK(check_array(given.poses, given.child_count, function));
    if (given.child_count > CROFTON_NONE)
        return report(CROFTON_OUT_OF_RANGE, function, "32 bits number a compound's children");
    return recover(function, [&] {
        // Copied while they are held: another thread may destroy a child at any time.
        Vector<SharedShape> parts;
        parts.reserve(given.child_count);
        for (std::size_t i = 0; i < given.child_count; ++i) {
            const SharedUse use(given.children[i], function);
            if (use.failed()) return of_item(use.status(), i);
            parts.push_back(given.children[i]->data);
        }
        return create_shape(shape, function, [&](ShapeData& data) -> Result<convex::Shape> {
            Vector<convex::CompoundChild> children;
            children.reserve(parts.size());
            for (std::size_t i = 0; i < parts.size(); ++i) {
                const Transform pose = to_transform(given.poses[i]);
                children.push_back({*parts[i]->shape, {pose.linear, pose.translation}});
            }
            data.parts = std::move(parts);
            auto built = convex::Compound::build(children);
            if (!built) return built.error();
            return convex::Shape::compound(data.compound.emplace(std::move(*built)));
        });
    });
}

crofton_status create(const Description* description, const crofton_jobs* jobs, crofton_shape** shape,
                      const char* function) {
    CROFTON_CHECK(check_pointer(shape, function));
    CROFTON_CHECK(check_jobs(jobs, function));
    Description given;
    CROFTON_CHECK(read_growing(description, function, given));
    switch (given.kind) {
        case CROFTON_SHAPE_HULL:
            return create_hull(given, shape, function);
        case CROFTON_SHAPE_MESH:
            return create_mesh(given, jobs, shape, function);
        case CROFTON_SHAPE_HEIGHT_FIELD:
            return create_height_field(given, shape, function);
        case CROFTON_SHAPE_COMPOUND:
            return create_compound(given, shape, function);
        case CROFTON_SHAPE_ROUNDED:
            return create_rounded(given, shape, function);
        default:
            if (given.kind > CROFTON_SHAPE_ROUNDED)
                return report(CROFTON_INVALID_ARGUMENT, function, "unknown kind of shape");
            return create_shape(shape, function, [&](ShapeData&) { return make_simple(given); });
    }
}

void give_bounds(const Aabb& bounds, crofton_shape_info& info) {
    std::copy_n(&bounds.min.x, 3, info.min);
    std::copy_n(&bounds.max.x, 3, info.max);
}

}  // namespace

crofton_status crofton_shape_create(const crofton_shape_description* description, crofton_shape** shape) {
    return create(description, nullptr, shape, __func__);
}

crofton_status crofton_shape_create_with_jobs(const crofton_shape_description* description, const crofton_jobs* jobs,
                                              crofton_shape** shape) {
    return create(description, jobs, shape, __func__);
}

crofton_status crofton_shape_destroy(crofton_shape* shape) {
    return destroy(shape, __func__);
}

crofton_status crofton_shape_get_info(const crofton_shape* shape, crofton_shape_info* info) {
    CROFTON_READ(shape);
    CROFTON_CHECK(check_growing(info, __func__));
    const convex::Shape& asked = *shape->data->shape;
    crofton_shape_info result{};
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

crofton_status crofton_shape_get_mass(const crofton_shape* shape, crofton_mass_properties* mass) {
    CROFTON_READ(shape);
    CROFTON_CHECK(check_growing(mass, __func__));
    const auto found = convex::mass_properties(*shape->data->shape);
    if (!found) return report(found.error(), __func__);
    crofton_mass_properties result{};
    result.volume = found->volume;
    std::copy_n(&found->center.x, 3, result.center);
    std::copy_n(&found->inertia[0].x, 9, result.inertia);
    write_growing(result, mass);
    return CROFTON_OK;
}
