/* SPDX-License-Identifier: MIT */
/* World's parts one by one, for engines that keep their own lists and trees. */
#ifndef CROFTON_CAPI_MODULES_H
#define CROFTON_CAPI_MODULES_H
#include <crofton/capi/view.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The triangles of a mesh. Calls copy them. */
typedef struct crofton_mesh {
    size_t size;
    const float* positions; /* x y z per vertex */
    size_t vertex_count;
    const uint32_t* indices; /* three per triangle, counter-clockwise seen from outside */
    size_t index_count;
    const char* name; /* or NULL */
} crofton_mesh;

/* Find the triangles that a picture needs: tests clusters and triangles from front to back against the depth of those
 * before. Guide: docs/depth.md. */

typedef struct crofton_depth_culler crofton_depth_culler; /* finds the triangles of pictures; keeps its buffers */

/* A mesh to be drawn. */
typedef struct crofton_depth_object {
    size_t size;
    const crofton_clustered_mesh* mesh; /* NULL: set it */
    float to_clip[16];    /* the identity; column-major; takes positions (x, y, z, 1) of the mesh to clip space, as the
                             vertex shader does in float. If it is not finite, the whole object is listed and hides nothing
                           */
    uint32_t one_sided;   /* 0; 1: back faces are not drawn; front faces are counter-clockwise seen with y up */
    uint32_t hides;       /* 1; 0: hides nothing, for alpha-tested and transparent objects */
    float position_error; /* 0; by how much drawn vertices may be off, in units of the mesh, besides the rounding of
                             to_clip times vertex. If it is negative or not finite, the whole object is listed and hides
                             nothing */
} crofton_depth_object;

typedef struct crofton_depth_statistics {
    size_t size;
    uint64_t objects_listed;  /* with at least one triangle */
    uint64_t objects_asked;   /* their bounds may cover a sample of the picture */
    uint64_t clusters_asked;  /* those of objects that were not hidden as a whole */
    uint64_t clusters_drawn;  /* not hidden as a whole */
    uint64_t triangles_drawn; /* those of the drawn clusters */
    uint64_t triangles_listed;
} crofton_depth_statistics;

/* Where an object of a camera's picture lies in a light's shadow map. */
typedef struct crofton_depth_receiver {
    const crofton_clustered_mesh* mesh; /* that of the picture; may be NULL if nothing of the object was listed */
    float to_map[16]; /* column-major; takes positions of the mesh to clip space of the map, as the shader does */
    uint32_t solid;   /* 1: anything within the mesh's bound may be seen, and not its triangles only */
} crofton_depth_receiver;

/* What looks a shadow map up: the points of what a camera sees. */
typedef struct crofton_depth_receivers {
    size_t size;
    const crofton_depth_culler* seen;      /* NULL: set it. Its last answer is that of
                                              crofton_depth_culler_find_visible for the camera's picture */
    const crofton_depth_receiver* objects; /* one for each object of that call */
    size_t object_count;
    double radius; /* 1; as in crofton_shadow_receivers */
} crofton_depth_receivers;

CROFTON_API crofton_depth_object crofton_default_depth_object(void);
CROFTON_API crofton_depth_receivers crofton_default_depth_receivers(void);

/* Copies a mesh and cuts it into clusters of up to `max_triangles`, at most CROFTON_MAX_CLUSTER_TRIANGLES. 0 chooses 16
 * for meshes of up to 1,000 triangles, 64 for those of 10,000 or more, and interpolates between. The item of an error
 * is the vertex or the index. */
CROFTON_API crofton_status crofton_clustered_mesh_create(const crofton_mesh* mesh, uint32_t max_triangles,
                                                         crofton_clustered_mesh** clustered);
CROFTON_API crofton_status crofton_clustered_mesh_destroy(crofton_clustered_mesh* clustered);
/* Reads the positions in `mesh` from now on, and releases the copies: the clustered mesh then needs a tenth to a
 * seventh of the arrays' memory. They must outlive it, and stay as they are: a change is not noticed, views are then
 * wrong, and an index that is out of range is followed. `order`: a crofton_index_order. With permuted indices the order
 * of triangles is released, too. Clusters that were returned before are no longer valid. CROFTON_INVALID_ARGUMENT:
 * another mesh than was cut, or original indices after the order was released; CROFTON_OUT_OF_RANGE: an index. The item
 * of an error is the index, and nothing has changed. */
CROFTON_API crofton_status crofton_clustered_mesh_lend(crofton_clustered_mesh* clustered, const crofton_mesh* mesh,
                                                       uint32_t order);
/* Returns the clusters; valid as long as the clustered mesh, until arrays are lent to it. triangle_count is 0 where the
 * order was released. */
CROFTON_API crofton_status crofton_clustered_mesh_get(const crofton_clustered_mesh* clustered,
                                                      crofton_clusters* clusters);
/* CROFTON_OUT_OF_RANGE: there is no such cluster. */
CROFTON_API crofton_status crofton_clustered_mesh_box(const crofton_clustered_mesh* clustered, size_t cluster,
                                                      crofton_cluster_box* box);
/* Writes bytes from which crofton_clustered_mesh_deserialise makes an equal object without cutting again, on machines
 * of the same byte order. Writes none if `capacity` is less than *count, which is set to how many there are. */
CROFTON_API crofton_status crofton_clustered_mesh_serialise(const crofton_clustered_mesh* clustered, uint8_t* bytes,
                                                            size_t capacity, size_t* count);
/* CROFTON_PARSE: the bytes are cut off, or numbers are out of range. Make sure that they belong to the mesh. */
CROFTON_API crofton_status crofton_clustered_mesh_deserialise(const uint8_t* bytes, size_t count,
                                                              crofton_clustered_mesh** clustered);
/* Writes a mesh's `index_count` indices to `permuted` in the order of its clusters, so that each cluster is one range
 * of an index buffer. The arrays must not overlap. */
CROFTON_API crofton_status crofton_permute_triangles(const crofton_clusters* clusters, const uint32_t* indices,
                                                     size_t index_count, uint32_t* permuted);

CROFTON_API crofton_status crofton_depth_culler_create(crofton_depth_culler** culler);
CROFTON_API crofton_status crofton_depth_culler_destroy(crofton_depth_culler* culler);
/* Lists the triangles that the picture needs, by object, then by cluster; valid until the next call. If you draw them,
 * or any set that contains them, in the order in which you would draw all triangles, the picture has the same bits.
 * This holds for opaque triangles with the depth test on and 32-bit float depth, at the picture's samples; the guide
 * says what else the renderer must do. The item of an error is the object; the last answer then stays. Allocates
 * nothing once it has held as many. `statistics` or NULL: a struct whose `size` is set.
 */
CROFTON_API crofton_status crofton_depth_culler_find_visible(crofton_depth_culler* culler,
                                                             const crofton_depth_object* objects, size_t object_count,
                                                             const crofton_picture_view* picture,
                                                             const crofton_jobs* jobs,
                                                             const crofton_visible_cluster** clusters, size_t* count,
                                                             crofton_depth_statistics* statistics);
/* Lists the triangles without which a shadow on what a camera sees would change; otherwise as
 * crofton_depth_culler_find_visible. `objects` are the casters, with matrices to the clip space of the shadow map. Draw
 * the listed triangles into the map: each lookup by a point of what the camera sees then gives the same as with all
 * casters. This holds for comparisons with the point's depth, or one nearer to the light; the guide says what else the
 * renderer must do. CROFTON_INVALID_ARGUMENT, whose item is the object: it was listed in the camera's picture with
 * another mesh than its receiver has. */
CROFTON_API crofton_status crofton_depth_culler_find_casters(
    crofton_depth_culler* culler, const crofton_depth_object* objects, size_t object_count,
    const crofton_picture_view* map, const crofton_depth_receivers* receivers, const crofton_jobs* jobs,
    const crofton_visible_cluster** clusters, size_t* count, crofton_depth_statistics* statistics);
/* Returns a lower bound of the nearness of the listed triangles at a pixel of the last picture: the depth, negated
 * unless reversed, or minus infinity if no triangle is proved to cover the pixel. Row 0 is at the bottom.
 * CROFTON_OUT_OF_RANGE: not a pixel of that picture, or there was none. */
CROFTON_API crofton_status crofton_depth_culler_nearness(const crofton_depth_culler* culler, uint32_t x, uint32_t y,
                                                         float* nearness);

/* Overlap of boxes, exact; touching counts. */

typedef struct crofton_broadphase crofton_broadphase; /* all pairs of many moving boxes */

/* Two items form a pair only if each shares a layer with the other's collides_with. */
typedef struct crofton_filter {
    uint32_t layers, collides_with;
} crofton_filter;

typedef struct crofton_pair {
    uint32_t first, second;
} crofton_pair;

typedef enum crofton_pairs {
    CROFTON_PAIRS_ALL = 0,
    CROFTON_PAIRS_BEGAN = 1, /* not among the pairs of the update before */
    CROFTON_PAIRS_STAYED = 2,
    CROFTON_PAIRS_ENDED = 3
} crofton_pairs;

typedef struct crofton_broadphase_statistics {
    size_t size;
    uint64_t bound_pairs, box_pairs, nodes_tested;
    uint32_t rejected; /* items with an invalid box: they overlap nothing */
} crofton_broadphase_statistics;

/* Sets *meet to 1 if the boxes share a point, else to 0. */
CROFTON_API crofton_status crofton_boxes_meet(const crofton_box* a, const crofton_box* b, int* meet);

CROFTON_API crofton_status crofton_broadphase_create(crofton_broadphase** broadphase);
CROFTON_API crofton_status crofton_broadphase_destroy(crofton_broadphase* broadphase);
/* Finds all pairs of boxes that overlap. boxes[i] is the same item as in the update before. `filters` or NULL: all
 * pass; `jobs` or NULL. */
CROFTON_API crofton_status crofton_broadphase_update(crofton_broadphase* broadphase, const crofton_box* boxes,
                                                     const crofton_filter* filters, size_t count,
                                                     const crofton_jobs* jobs);
/* Returns pairs in order, first < second; valid until the next update. `which` is a crofton_pairs. */
CROFTON_API crofton_status crofton_broadphase_pairs(const crofton_broadphase* broadphase, uint32_t which,
                                                    const crofton_pair** pairs, size_t* count);
CROFTON_API crofton_status crofton_broadphase_get_statistics(const crofton_broadphase* broadphase,
                                                             crofton_broadphase_statistics* statistics);

/* Contact points and distance of two boxes. */

#define CROFTON_MAX_MANIFOLD_POINTS 8u

typedef struct crofton_contact_point {
    double position[3]; /* midway between the surfaces */
    double depth;       /* >= 0 */
} crofton_contact_point;

/* Moving b by depth * normal ends the contact. */
typedef struct crofton_manifold {
    size_t size;
    double normal[3]; /* unit, from a to b */
    double depth;
    uint32_t point_count; /* 0 if the boxes do not overlap */
    crofton_contact_point points[CROFTON_MAX_MANIFOLD_POINTS];
} crofton_manifold;

/* Fills a manifold whose `size` is set. */
CROFTON_API crofton_status crofton_boxes_manifold(const crofton_box* a, const crofton_box* b,
                                                  crofton_manifold* manifold);
/* Computes the distance, 0 if the boxes overlap, and nearest points. `on_a`, `on_b` or NULL. */
CROFTON_API crofton_status crofton_boxes_distance(const crofton_box* a, const crofton_box* b, double* distance,
                                                  double* on_a, double* on_b);

/* Shapes, convex or of convex parts: overlap, distance, depth, contacts, casts. Guide: docs/convex.md. A pose is a
 * rotation and a translation, without reflection. Smaller structs of this part, from an older version, are accepted:
 * members that they lack are 0, the default of every member. */

/* A shape never changes. You may destroy it at any time: a World, compound or rounded shape that uses it keeps what it
 * needs.
 */
typedef struct crofton_shape crofton_shape;
typedef struct crofton_shape_contacts crofton_shape_contacts; /* contacts of one pair, kept from step to step */

typedef enum crofton_shape_kind {
    CROFTON_SHAPE_SPHERE = 0,
    CROFTON_SHAPE_CAPSULE = 1,
    CROFTON_SHAPE_CYLINDER = 2,
    CROFTON_SHAPE_CONE = 3,
    CROFTON_SHAPE_BOX = 4,
    CROFTON_SHAPE_TRIANGLE = 5,
    CROFTON_SHAPE_HULL = 6,
    CROFTON_SHAPE_HALF_SPACE = 7, /* up to here convex */
    CROFTON_SHAPE_MESH = 8,
    CROFTON_SHAPE_HEIGHT_FIELD = 9,
    CROFTON_SHAPE_COMPOUND = 10,
    CROFTON_SHAPE_ROUNDED = 11 /* in descriptions only */
} crofton_shape_kind;

#define CROFTON_HOLE 255u /* as a cell's material: nothing is there */

/* Corner (i, j) is at (i * spacing[0], heights[j * columns + i], j * spacing[1]). Each cell has two triangles. */
typedef struct crofton_height_field {
    size_t size;
    uint32_t columns, rows;   /* corners along x and along z, 2 to 32768 */
    const float* heights;     /* columns * rows */
    const uint8_t* materials; /* of the cells, row by row: (columns - 1) * (rows - 1); or NULL: all 0 */
    double spacing[2];        /* 0: 1 */
} crofton_height_field;

/* Describes a shape by `kind` and the members that are named for that kind. Lengths are in [0, 1e15]. Solids of
 * revolution have y as axis, with the origin half way up. Arrays are copied. */
typedef struct crofton_shape_description {
    size_t size;
    uint32_t kind;         /* a crofton_shape_kind */
    float radius;          /* spheres, capsules, cylinders, cones; rounded shapes: the distance around the core */
    float half_height;     /* capsules, without their caps; cylinders, cones */
    float half_extents[3]; /* boxes */
    float corners[9];      /* triangles: three corners, x y z each, counter-clockwise seen from the front */
    crofton_plane plane;   /* half-spaces: the normal, of any length but 0, points into the solid */
    const float* points;   /* hulls: x y z each */
    size_t point_count;
    uint32_t max_vertices; /* hulls: 4 to 256; 0: 256. A hull with more is replaced by a larger one that contains it */
    float face_tolerance;  /* hulls: triangles within this of a plane, relative to the size, are one face; 0: 1e-5 */
    const crofton_mesh* mesh; /* meshes: the triangles, as a surface; no coordinate beyond 1e12 */
    const crofton_height_field* height_field;
    uint32_t front_only; /* meshes, height fields; 1: contacts push to the front only, for fields up, and casts from
                            behind pass */
    const crofton_shape* core;            /* rounded: a convex shape other than a half-space */
    const crofton_shape* const* children; /* compounds: children[i] is at poses[i] in the compound's frame */
    const crofton_transform* poses;
    size_t child_count;
} crofton_shape_description;

typedef struct crofton_shape_info {
    size_t size;
    uint32_t kind;                     /* a crofton_shape_kind */
    uint32_t vertex_count, face_count; /* for hulls, else 0 */
    uint32_t part_count;               /* for compounds, else 1 */
    double min[3], max[3];             /* in its frame, rounded outward; infinite for half-spaces */
    double max_overshoot;              /* how far a hull extends beyond that of its points at most */
    /* For hulls, to draw them: vertices, x y z each, and triangles; else NULL. Valid as long as the shape. */
    const float* vertices;
    const uint16_t* indices;
    size_t index_count;
} crofton_shape_info;

/* Mass properties for density 1, in the shape's frame. The inertia is about the center of mass, symmetric. */
typedef struct crofton_mass_properties {
    size_t size;
    double volume, center[3], inertia[9];
} crofton_mass_properties;

/* A shape at a pose. */
typedef struct crofton_placed {
    const crofton_shape* shape;
    const crofton_transform* pose;
} crofton_placed;

typedef enum crofton_query_shape_kind {
    CROFTON_QUERY_SHAPE_BOX = 0,
    CROFTON_QUERY_SHAPE_SPHERE = 1,
    CROFTON_QUERY_SHAPE_CAPSULE = 2,
    CROFTON_QUERY_SHAPE_SHAPE = 3
} crofton_query_shape_kind;

/* The shape of a query. */
typedef struct crofton_query_shape {
    uint32_t kind;   /* a crofton_query_shape_kind: says which members below are used */
    crofton_box box; /* for a box */
    double begin[3]; /* for a capsule; for a sphere, its center */
    double end[3];   /* for a capsule */
    double radius;   /* for a sphere or capsule */
    crofton_placed shape;
} crofton_query_shape;

/* Makes calls for one pair, in one order, faster from frame to frame. All 0 for a new pair. It never changes whether
 * shapes overlap. */
typedef struct crofton_pair_cache {
    uint64_t opaque[16];
} crofton_pair_cache;

/* A convex part of a shape: a child of a compound, or a triangle of a mesh or height field. */
typedef struct crofton_part {
    uint32_t child, triangle;
} crofton_part;

typedef struct crofton_shape_distance {
    size_t size;
    double distance, lower, upper;      /* proved: the true distance is in [lower, upper] */
    double on_a[3], on_b[3], normal[3]; /* nearest points; the unit vector from a to b, 0 if the shapes overlap */
    crofton_part part_a, part_b;
} crofton_shape_distance;

/* Moving b by depth * normal ends the overlap. */
typedef struct crofton_shape_penetration {
    size_t size;
    double depth, lower, upper; /* as above; all 0 if the shapes do not overlap */
    double on_a[3], on_b[3], normal[3];
    crofton_part part_a, part_b;
    uint32_t overlapping; /* 1 or 0, as crofton_shapes_meet */
} crofton_shape_penetration;

typedef enum crofton_feature_kind {
    CROFTON_FEATURE_VERTEX = 0,
    CROFTON_FEATURE_EDGE = 1,
    CROFTON_FEATURE_FACE = 2
} crofton_feature_kind;

typedef struct crofton_feature {
    uint8_t kind; /* a crofton_feature_kind */
    uint8_t unused;
    uint16_t index;
} crofton_feature;

/* A contact point for a physics engine. Features and parts are its id, which stays the same while the same features
 * touch. */
typedef struct crofton_tracked_point {
    double position[3]; /* midway between the surfaces, in the world */
    double depth;       /* along the normal; negative: a gap */
    crofton_feature on_a, on_b;
    crofton_part part_a, part_b;
    double normal[3]; /* unit, from a to b */
    uint8_t began;    /* 1: no point of the last step has its id */
    uint8_t unused[3];
    float memory[4]; /* yours, such as impulses for a warm start: 0 when the point begins, kept while it stays */
} crofton_tracked_point;

/* The same as the first members of crofton_tracked_point. */
typedef struct crofton_shape_point {
    double position[3];
    double depth;
    crofton_feature on_a, on_b;
    crofton_part part_a, part_b;
} crofton_shape_point;

typedef struct crofton_shape_manifold {
    size_t size;
    double normal[3];     /* unit, from a to b */
    double depth;         /* of the deepest point */
    uint32_t point_count; /* 0 if the shapes are farther apart than the margin */
    crofton_shape_point points[CROFTON_MAX_MANIFOLD_POINTS];
} crofton_shape_manifold;

typedef struct crofton_manifold_options {
    size_t size;
    double margin;       /* >= 0: also returns points with a gap of up to this */
    uint32_t max_points; /* 1 to 8; 0: 4 */
} crofton_manifold_options;

/* The shape's `pivot`, in its frame, moves by velocity * t, and the shape turns about it by |spin| * t radians around
 * `spin` (world axes). */
typedef struct crofton_motion {
    double velocity[3], spin[3], pivot[3];
} crofton_motion;

typedef struct crofton_cast_options {
    size_t size;
    double duration;                  /* >= 0 */
    double tolerance;                 /* how far apart the shapes may still be at the time of a hit; 0: 1e-6 */
    uint32_t max_steps;               /* 0: 500 */
    uint32_t ignore_initial_overlaps; /* 1: skips what overlaps or is within the tolerance at time 0 */
} crofton_cast_options;

typedef enum crofton_cast_result {
    CROFTON_CAST_MISS = 0, /* proved: the shapes do not touch in that time */
    CROFTON_CAST_HIT = 1,  /* at `time` they are within the tolerance and about to touch; they do not touch earlier */
    CROFTON_CAST_UNRESOLVED = 2 /* max_steps was too small: they do not touch before `time` */
} crofton_cast_result;

typedef struct crofton_impact {
    size_t size;
    double time, distance;              /* gap at that time; negative: how deep they overlap, from the start */
    double on_a[3], on_b[3], normal[3]; /* points on the surfaces; unit normal from a to b; all 0 for a miss */
    crofton_part part_a, part_b;
    uint32_t result; /* a crofton_cast_result */
    uint32_t steps;
} crofton_impact;

/* Returns all 0 but the size: a sphere of radius 0; surfaces have both sides. */
CROFTON_API crofton_shape_description crofton_default_shape_description(void);
CROFTON_API crofton_manifold_options crofton_default_manifold_options(void);
CROFTON_API crofton_cast_options crofton_default_cast_options(void);

/* Creates a shape. For an error, crofton_last_error says which member is wrong, and crofton_last_error_item which
 * point, index or child.
 */
CROFTON_API crofton_status crofton_shape_create(const crofton_shape_description* description, crofton_shape** shape);
/* The same shape to the bit; `jobs`, or NULL, build the tree of a mesh together. */
CROFTON_API crofton_status crofton_shape_create_with_jobs(const crofton_shape_description* description,
                                                          const crofton_jobs* jobs, crofton_shape** shape);
CROFTON_API crofton_status crofton_shape_destroy(crofton_shape* shape);

/* Fill a struct whose `size` is set. CROFTON_UNSUPPORTED: surfaces have no mass. */
CROFTON_API crofton_status crofton_shape_get_info(const crofton_shape* shape, crofton_shape_info* info);
CROFTON_API crofton_status crofton_shape_get_mass(const crofton_shape* shape, crofton_mass_properties* mass);
/* Called with a line in the world and your `user` pointer. It must not throw. It may query shapes, but not the contacts
 * that are being drawn. */
typedef void (*crofton_line_visitor)(void* user, const double from[3], const double to[3]);
/* Draws the edges of a shape and of its parts, for debugging. Round shapes are drawn as circles, in pieces of a 24th.
 */
CROFTON_API crofton_status crofton_shape_outline(const crofton_placed* shape, crofton_line_visitor visit, void* user);
/* Lists the convex parts that may be within `margin` >= 0 of another shape: all that are, and some more. Writes at most
 * `capacity`, and sets *found to how many there are. A convex shape is its own part. */
CROFTON_API crofton_status crofton_shape_parts_near(const crofton_placed* shape, const crofton_placed* other,
                                                    double margin, crofton_part* parts, size_t capacity, size_t* found);

/* Sets *meet to 1 if the shapes share a point, else to 0. `cache` or NULL. */
CROFTON_API crofton_status crofton_shapes_meet(const crofton_placed* a, const crofton_placed* b,
                                               crofton_pair_cache* cache, int* meet);
/* Fill a struct whose `size` is set. `cache` or NULL. */
CROFTON_API crofton_status crofton_shapes_distance(const crofton_placed* a, const crofton_placed* b,
                                                   crofton_pair_cache* cache, crofton_shape_distance* distance);
CROFTON_API crofton_status crofton_shapes_penetration(const crofton_placed* a, const crofton_placed* b,
                                                      crofton_pair_cache* cache,
                                                      crofton_shape_penetration* penetration);
/* The same from a point to a shape; a is the point. */
CROFTON_API crofton_status crofton_shape_closest_point(const crofton_placed* shape, const double point[3],
                                                       crofton_shape_distance* distance);
/* Returns where the shapes touch: the deepest manifold. crofton_shape_contacts_update returns all, and keeps points
 * from step to step. */
CROFTON_API crofton_status crofton_shapes_manifold(const crofton_placed* a, const crofton_placed* b,
                                                   const crofton_manifold_options* options, crofton_pair_cache* cache,
                                                   crofton_shape_manifold* manifold);
/* Finds the first time at which two moving shapes touch. `options` or NULL: the defaults, with a duration of 1. A
 * motion of NULL is rest. Shapes that begin within the tolerance hit if they move into each other, but not if they
 * separate or slide along each other. Shapes that begin overlapping hit at time 0, with the shortest way out. */
CROFTON_API crofton_status crofton_shapes_cast(const crofton_placed* a, const crofton_motion* motion_a,
                                               const crofton_placed* b, const crofton_motion* motion_b,
                                               const crofton_cast_options* options, crofton_impact* impact);

CROFTON_API crofton_status crofton_shape_contacts_create(crofton_shape_contacts** contacts);
CROFTON_API crofton_status crofton_shape_contacts_destroy(crofton_shape_contacts* contacts);
/* Updates the contacts of one pair, in one order. Call it once a step. `options` or NULL.
 *
 * Returns the points, whose `memory` you may write, and how many have ended. Valid until the next update. `points`,
 * `count`, `ended` or NULL. */
CROFTON_API crofton_status crofton_shape_contacts_update(crofton_shape_contacts* contacts, const crofton_placed* a,
                                                         const crofton_placed* b,
                                                         const crofton_manifold_options* options,
                                                         crofton_tracked_point** points, size_t* count, size_t* ended);
/* Draws each point's normal, `length` >= 0 long, with a cross of that size across it, for debugging. */
CROFTON_API crofton_status crofton_shape_contacts_outline(crofton_shape_contacts* contacts, double length,
                                                          crofton_line_visitor visit, void* user);

/* Rays. */

/* The points origin + t direction, 0 <= t <= max_t, which may be infinite. A segment from p to q is {p, q - p, 1}. */
typedef struct crofton_ray {
    double origin[3], direction[3];
    double max_t;
} crofton_ray;

/* The first point of a shape on a ray. */
typedef struct crofton_shape_ray_hit {
    size_t size;
    double t; /* of the ray; infinite: no hit, and all else is 0 */
    double point[3];
    double normal[3]; /* of the surface, unit, towards the ray's origin; 0 if the ray began inside */
    crofton_part part;
    uint32_t started_inside; /* 1: the ray began in a solid shape, and t is 0; else 0 */
} crofton_shape_ray_hit;

/* Sets *t to where the ray enters the box: 0 if it begins inside, infinite if it misses. */
CROFTON_API crofton_status crofton_box_raycast(const crofton_box* box, const crofton_ray* ray, double* t);
/* Finds the first hit. Fills a struct whose `size` is set. A ray that begins inside a solid shape hits it at t = 0,
 * without a normal; triangles, meshes and height fields have no inside. */
CROFTON_API crofton_status crofton_shape_raycast(const crofton_placed* shape, const crofton_ray* ray,
                                                 crofton_shape_ray_hit* hit);
/* Sets *hit to 1 if the ray hits the shape, else to 0. Faster than crofton_shape_raycast for a mesh at the identity. */
CROFTON_API crofton_status crofton_shape_raycast_any(const crofton_placed* shape, const crofton_ray* ray, int* hit);

/* The surfaces of two shapes made of meshes. `b_to_a` is the pose of b in a's frame: a rotation and a translation. */

/* A contact of two triangles, in a's frame: the ends of their common segment, and the unit normal of b's triangle. */
typedef struct crofton_mesh_contact {
    crofton_pair triangles; /* of a and of b */
    double begin[3], end[3], normal[3];
} crofton_mesh_contact;

typedef enum crofton_containment {
    CROFTON_CONTAINS_NOTHING = 0, /* or the surfaces overlap */
    CROFTON_A_INSIDE_B = 1,
    CROFTON_B_INSIDE_A = 2,
    CROFTON_PARTLY_INSIDE = 3 /* some pieces of a mesh are inside, but not all */
} crofton_containment;

/* How two meshes lie to each other. */
typedef struct crofton_mesh_relation {
    size_t size;
    uint32_t meet; /* 1 if the surfaces share a point, else 0 */
    uint32_t
        containment; /* a crofton_containment, for surfaces that do not overlap; only closed meshes contain anything */
    double distance; /* the smallest between the surfaces; 0 if they overlap */
    double on_a[3], on_b[3]; /* nearest points, in a's frame */
    double depth; /* moving b by depth along the unit vector `direction` ends the contact; an upper bound of the
                     penetration depth, 0 if the meshes do not overlap */
    double direction[3];
} crofton_mesh_relation;

/* What crofton_meshes_relate computes; the other members become 0. */
typedef enum crofton_mesh_relations {
    CROFTON_MESHES_MEET = 1,
    CROFTON_MESHES_CONTAINMENT = 2,
    CROFTON_MESHES_DISTANCE = 4,
    CROFTON_MESHES_DEPTH = 8
} crofton_mesh_relations;

/* Fills a struct whose `size` is set. `which` is a sum of crofton_mesh_relations; each takes its own search. */
CROFTON_API crofton_status crofton_meshes_relate(const crofton_shape* a, const crofton_shape* b,
                                                 const crofton_transform* b_to_a, uint32_t which,
                                                 crofton_mesh_relation* relation);
/* Lists the contacts, one for each pair of triangles that overlap, in order. Writes at most `capacity`, and sets *count
 * to how many there are. */
CROFTON_API crofton_status crofton_meshes_contacts(const crofton_shape* a, const crofton_shape* b,
                                                   const crofton_transform* b_to_a, crofton_mesh_contact* contacts,
                                                   size_t capacity, size_t* count);

/* Boxes around points, the best by the criterion that suits the queries. */

/* volume_weight V + area_weight F + mean_curvature_weight M, weights >= 0 and not all 0. */
typedef struct crofton_criterion {
    double volume_weight, area_weight, mean_curvature_weight;
} crofton_criterion;

typedef enum crofton_fit_quality {
    CROFTON_FIT_FAST = 0,  /* one or two passes over the points */
    CROFTON_FIT_TIGHT = 1, /* convex hull and local search */
    CROFTON_FIT_EXACT = 2  /* the global optimum */
} crofton_fit_quality;

typedef struct crofton_fit_options {
    size_t size;
    uint32_t quality; /* a crofton_fit_quality */
    crofton_criterion criterion;
} crofton_fit_options;

/* Returns the tight quality, and the sum of the edges as criterion: it suits frusta that are large compared with the
 * objects. */
CROFTON_API crofton_fit_options crofton_default_fit_options(void);
/* Computes the criterion that minimises the expected number of boxes in the camera's frustum. The far distance must be
 * finite. */
CROFTON_API crofton_status crofton_criterion_for_frustum(const crofton_camera* camera, crofton_criterion* criterion);
/* The same for rays and segments of this length, in [0, 1e30]. */
CROFTON_API crofton_status crofton_criterion_for_rays(double length, crofton_criterion* criterion);

/* Computes a box that contains every point. Points are x y z each, float, or double if `is_double` is 1. `options` or
 * NULL: the defaults. */
CROFTON_API crofton_status crofton_fit_points(const void* points, size_t point_count, uint32_t is_double,
                                              const crofton_fit_options* options, crofton_box* box);
/* Computes a box that contains all boxes. `criterion` or NULL: the sum of the edges. */
CROFTON_API crofton_status crofton_fit_boxes(const crofton_box* boxes, size_t count, const crofton_criterion* criterion,
                                             crofton_box* box);

#ifdef __cplusplus
}
#endif
#endif
