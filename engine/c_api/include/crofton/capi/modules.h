/* SPDX-License-Identifier: MIT */
/* The modules one by one, for engines that keep their own lists and trees. */
#ifndef CROFTON_CAPI_MODULES_H
#define CROFTON_CAPI_MODULES_H
#include <crofton/capi/view.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Triangles of one mesh; copied by the calls that take it. */
typedef struct crofton_mesh {
    size_t size;
    const float* positions; /* x y z per vertex */
    size_t vertex_count;
    const uint32_t* indices; /* three per triangle, counter-clockwise seen from outside */
    size_t index_count;
    const char* name; /* or NULL */
} crofton_mesh;

/* Which triangles does a picture need? Each is asked against the depth of those before, front to back. docs/depth.md is
 * the guide. */

typedef struct crofton_clustered_mesh crofton_clustered_mesh; /* a mesh cut into clusters; it never changes */
typedef struct crofton_depth_culler crofton_depth_culler;     /* the answer for one picture, in buffers that are kept */

/* One mesh that is drawn. */
typedef struct crofton_depth_object {
    size_t size;
    const crofton_clustered_mesh* mesh; /* NULL: set it */
    float to_clip[16];    /* the identity; column-major, takes columns (x, y, z, 1) of the mesh's to clip space, as the
                             vertex shader does in float. Not finite: all of the object is listed and it hides nothing */
    uint32_t one_sided;   /* 0; 1: back faces are not drawn; front faces are counter-clockwise seen with y up */
    uint32_t hides;       /* 1; 0: hides nothing, as alpha-tested and transparent things */
    float position_error; /* 0; how far drawn vertices may lie from the mesh's, in its units, besides the rounding of
                             to_clip times vertex. Negative or not finite: as of to_clip */
} crofton_depth_object;

typedef struct crofton_depth_statistics {
    size_t size;
    uint64_t objects_listed;  /* with at least one triangle */
    uint64_t objects_asked;   /* whose bounds may cover a sample; also all behind the near plane */
    uint64_t clusters_asked;  /* of the objects that were not hidden as a whole */
    uint64_t clusters_drawn;  /* that were not hidden as a whole */
    uint64_t triangles_drawn; /* of those clusters */
    uint64_t triangles_listed;
} crofton_depth_statistics;

CROFTON_API crofton_depth_object crofton_default_depth_object(void);

/* Cuts a mesh, which is copied, into clusters of up to `max_triangles`, 0 to CROFTON_MAX_CLUSTER_TRIANGLES. 0 chooses:
 * 16 for meshes of up to 1,000 triangles, 64 for those of 10,000 and more, and between them in proportion. Errors name
 * the vertex or the index. */
CROFTON_API crofton_status crofton_clustered_mesh_create(const crofton_mesh* mesh, uint32_t max_triangles,
                                                         crofton_clustered_mesh** clustered);
CROFTON_API crofton_status crofton_clustered_mesh_destroy(crofton_clustered_mesh* clustered);
/* Valid while the clustered mesh lives. */
CROFTON_API crofton_status crofton_clustered_mesh_get(const crofton_clustered_mesh* clustered,
                                                      crofton_clusters* clusters);
/* Writes a mesh's `index_count` indices to `permuted` in the order of its clusters, so that each cluster is one range
 * of an index buffer. The arrays must not overlap. */
CROFTON_API crofton_status crofton_permute_triangles(const crofton_clusters* clusters, const uint32_t* indices,
                                                     size_t index_count, uint32_t* permuted);

CROFTON_API crofton_status crofton_depth_culler_create(crofton_depth_culler** culler);
CROFTON_API crofton_status crofton_depth_culler_destroy(crofton_depth_culler* culler);
/* Lists the triangles without which the picture would change, by object, then by cluster; valid until the culler's next
 * call of this. Draw them, or any set that contains them, in the order in which you would draw all, and the picture has
 * the same bits. It holds for opaque triangles with the depth test on, one sample a pixel and 32-bit float depth; the
 * guide says what else the renderer must do. Errors name the object. A call that fails leaves the last answer as it
 * was. Allocates nothing once it has grown to the largest answer. `statistics` or NULL: a struct whose `size` is set.
 */
CROFTON_API crofton_status crofton_depth_culler_find_visible(crofton_depth_culler* culler,
                                                             const crofton_depth_object* objects, size_t object_count,
                                                             const crofton_picture_view* picture,
                                                             const crofton_visible_cluster** clusters, size_t* count,
                                                             crofton_depth_statistics* statistics);
/* The nearness that the listed triangles surely have at a pixel of the last picture: its depth, negated unless
 * reversed; minus infinity where none surely covers it. Row 0 is at the bottom. CROFTON_OUT_OF_RANGE: not a pixel of
 * that picture, or there was none. */
CROFTON_API crofton_status crofton_depth_culler_nearness(const crofton_depth_culler* culler, uint32_t x, uint32_t y,
                                                         float* nearness);

/* What touches what? Exactly; touching counts. */

typedef struct crofton_broadphase crofton_broadphase; /* all pairs of many moving boxes */

/* Two items are tested iff each one's layers meet what the other collides with. */
typedef struct crofton_filter {
    uint32_t layers, collides_with;
} crofton_filter;

typedef struct crofton_pair {
    uint32_t first, second;
} crofton_pair;

typedef enum crofton_pairs {
    CROFTON_PAIRS_ALL = 0,
    CROFTON_PAIRS_BEGAN = 1, /* not there after the update before */
    CROFTON_PAIRS_STAYED = 2,
    CROFTON_PAIRS_ENDED = 3
} crofton_pairs;

typedef struct crofton_broadphase_statistics {
    size_t size;
    uint64_t bound_pairs, box_pairs, nodes_tested;
    uint32_t rejected; /* items whose box is invalid: they meet nothing */
} crofton_broadphase_statistics;

/* *meet is 1 where the boxes share a point, else 0. */
CROFTON_API crofton_status crofton_boxes_meet(const crofton_box* a, const crofton_box* b, int* meet);

CROFTON_API crofton_status crofton_broadphase_create(crofton_broadphase** broadphase);
CROFTON_API crofton_status crofton_broadphase_destroy(crofton_broadphase* broadphase);
/* boxes[i] is the same item as in the update before; `filters` or NULL: all pass; `jobs` or NULL. */
CROFTON_API crofton_status crofton_broadphase_update(crofton_broadphase* broadphase, const crofton_box* boxes,
                                                     const crofton_filter* filters, size_t count,
                                                     const crofton_jobs* jobs);
/* `which` is a crofton_pairs. In order, first < second; valid until the next update. */
CROFTON_API crofton_status crofton_broadphase_pairs(const crofton_broadphase* broadphase, uint32_t which,
                                                    const crofton_pair** pairs, size_t* count);
CROFTON_API crofton_status crofton_broadphase_get_statistics(const crofton_broadphase* broadphase,
                                                             crofton_broadphase_statistics* statistics);

/* Where do boxes touch, how deep, and how far are they apart? */

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
    uint32_t point_count; /* 0 where the boxes do not meet */
    crofton_contact_point points[CROFTON_MAX_MANIFOLD_POINTS];
} crofton_manifold;

/* Fills a manifold whose `size` is set. */
CROFTON_API crofton_status crofton_boxes_manifold(const crofton_box* a, const crofton_box* b,
                                                  crofton_manifold* manifold);
/* 0 where they meet; nearest points, or NULL. */
CROFTON_API crofton_status crofton_boxes_distance(const crofton_box* a, const crofton_box* b, double* distance,
                                                  double* on_a, double* on_b);

/* Bodies, convex or made of convex parts: do they meet, how far, how deep, where, and when? docs/convex.md is the
 * guide. A pose is a rotation and a translation, without reflection. The structs of this part that begin with `size`
 * may grow: members that an older, smaller one lacks are 0, the default of every member. */

/* A body never changes. What uses it (a World, a compound, a rounded body) keeps what it needs: destroy it at any time.
 */
typedef struct crofton_body crofton_body;
typedef struct crofton_body_contacts crofton_body_contacts; /* where one pair touches, kept from step to step */

typedef enum crofton_body_kind {
    CROFTON_BODY_SPHERE = 0,
    CROFTON_BODY_CAPSULE = 1,
    CROFTON_BODY_CYLINDER = 2,
    CROFTON_BODY_CONE = 3,
    CROFTON_BODY_BOX = 4,
    CROFTON_BODY_TRIANGLE = 5,
    CROFTON_BODY_HULL = 6,
    CROFTON_BODY_HALF_SPACE = 7, /* up to here convex */
    CROFTON_BODY_MESH = 8,
    CROFTON_BODY_HEIGHT_FIELD = 9,
    CROFTON_BODY_COMPOUND = 10,
    CROFTON_BODY_ROUNDED = 11 /* in descriptions alone */
} crofton_body_kind;

#define CROFTON_HOLE 255u /* as a cell's material: nothing is there */

/* Corner (i, j) is at (i * spacing[0], heights[j * columns + i], j * spacing[1]); two triangles a cell. */
typedef struct crofton_height_field {
    size_t size;
    uint32_t columns, rows;   /* corners along x and along z, 2 to 32768 */
    const float* heights;     /* columns * rows */
    const uint8_t* materials; /* of the cells, row by row: (columns - 1) * (rows - 1); or NULL: all 0 */
    double spacing[2];        /* 0: 1 */
} crofton_height_field;

/* What a body is made of: `kind`, and the members that are named for it. Lengths are >= 0 and at most 1e15. Solids of
 * revolution stand along y, with the origin half way up. Arrays are copied. */
typedef struct crofton_body_description {
    size_t size;
    uint32_t kind;         /* a crofton_body_kind */
    float radius;          /* spheres, capsules, cylinders, cones; of a rounded body: how far around its core */
    float half_height;     /* capsules, without their caps; cylinders, cones */
    float half_extents[3]; /* boxes */
    float corners[9];      /* triangles: three corners, x y z each, counter-clockwise seen from the front */
    crofton_plane plane;   /* half-spaces: the normal, of any length but 0, points into the solid */
    const float* points;   /* hulls: x y z each */
    size_t point_count;
    uint32_t max_vertices;    /* hulls: 4 to 256; 0: 256. One with more is replaced by one that contains it */
    float face_tolerance;     /* hulls: triangles so close to a plane, relative to the size, are one face; 0: 1e-5 */
    const crofton_mesh* mesh; /* meshes: the triangles, as a surface */
    const crofton_height_field* height_field;
    uint32_t front_only; /* meshes, height fields; 1: contacts push to the front alone, of fields up, and casts from
                            behind pass */
    const crofton_body* core;            /* rounded: a convex body other than a half-space */
    const crofton_body* const* children; /* compounds: children[i] stands at poses[i] in the compound's frame */
    const crofton_transform* poses;
    size_t child_count;
} crofton_body_description;

typedef struct crofton_body_info {
    size_t size;
    uint32_t kind;                     /* a crofton_body_kind */
    uint32_t vertex_count, face_count; /* of a hull, else 0 */
    uint32_t part_count;               /* of a compound, else 1 */
    double min[3], max[3];             /* in its frame, rounded outward; infinite for half-spaces */
    double max_overshoot;              /* how far a hull reaches beyond that of its points at most */
    /* Of a hull, for drawing: its vertices, x y z each, and its triangles; else NULL. Valid while the body lives. */
    const float* vertices;
    const uint16_t* indices;
    size_t index_count;
} crofton_body_info;

/* Of a body of density 1, in its frame; the inertia about the center of mass, symmetric. */
typedef struct crofton_mass_properties {
    size_t size;
    double volume, center[3], inertia[9];
} crofton_mass_properties;

/* A body where it stands. */
typedef struct crofton_placed {
    const crofton_body* body;
    const crofton_transform* pose;
} crofton_placed;

typedef enum crofton_shape_kind {
    CROFTON_SHAPE_BOX = 0,
    CROFTON_SHAPE_SPHERE = 1,
    CROFTON_SHAPE_CAPSULE = 2,
    CROFTON_SHAPE_BODY = 3
} crofton_shape_kind;

/* What a query asks with. */
typedef struct crofton_shape {
    uint32_t kind;   /* a crofton_shape_kind: which members below count */
    crofton_box box; /* of a box */
    double begin[3]; /* of a capsule; of a sphere its center */
    double end[3];   /* of a capsule */
    double radius;   /* of a sphere or capsule */
    crofton_placed body;
} crofton_shape;

/* What a pair remembers: all 0 for a new pair. It belongs to one pair in one order. It makes calls faster and changes
 * no yes or no. */
typedef struct crofton_pair_cache {
    uint64_t opaque[16];
} crofton_pair_cache;

/* A convex part of a body: a child of a compound, a triangle of a mesh or height field. */
typedef struct crofton_part {
    uint32_t child, triangle;
} crofton_part;

typedef struct crofton_body_distance {
    size_t size;
    double distance, lower, upper;      /* proven: the true distance lies between the latter two */
    double on_a[3], on_b[3], normal[3]; /* nearest points; the unit vector from a to b, 0 of bodies that meet */
    crofton_part part_a, part_b;
} crofton_body_distance;

/* Moving b by depth * normal ends the overlap. */
typedef struct crofton_body_penetration {
    size_t size;
    double depth, lower, upper; /* as above; all is 0 where the bodies do not meet */
    double on_a[3], on_b[3], normal[3];
    crofton_part part_a, part_b;
    uint32_t overlapping; /* 1 or 0: as crofton_bodies_meet */
} crofton_body_penetration;

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

/* A point that a physics step holds on to. Features and parts are its id: it stays the same while the same features
 * touch. */
typedef struct crofton_tracked_point {
    double position[3]; /* midway between the surfaces, in the world */
    double depth;       /* along the normal; negative: a gap */
    crofton_feature on_a, on_b;
    crofton_part part_a, part_b;
    double normal[3]; /* unit, from a to b */
    uint8_t began;    /* 1: its id was not there in the step before */
    uint8_t unused[3];
    float memory[4]; /* the caller's, as impulses for a warm start: 0 when the point begins, kept while it stays */
} crofton_tracked_point;

/* As the first members of crofton_tracked_point. */
typedef struct crofton_body_point {
    double position[3];
    double depth;
    crofton_feature on_a, on_b;
    crofton_part part_a, part_b;
} crofton_body_point;

typedef struct crofton_body_manifold {
    size_t size;
    double normal[3];     /* unit, from a to b */
    double depth;         /* of the deepest point */
    uint32_t point_count; /* 0 where the bodies are farther apart than the margin */
    crofton_body_point points[CROFTON_MAX_MANIFOLD_POINTS];
} crofton_body_manifold;

typedef struct crofton_manifold_options {
    size_t size;
    double margin;       /* >= 0: points with a gap of up to this are told, too */
    uint32_t max_points; /* 1 to 8; 0: 4 */
} crofton_manifold_options;

/* The body's `pivot`, in its frame, moves by velocity * t, and the body turns about it by |spin| * t radians around
 * `spin` (world axes). */
typedef struct crofton_motion {
    double velocity[3], spin[3], pivot[3];
} crofton_motion;

typedef struct crofton_cast_options {
    size_t size;
    double duration;                  /* >= 0 */
    double tolerance;                 /* how far apart bodies may still be at the time of a hit; 0: 1e-6 */
    uint32_t max_steps;               /* 0: 500 */
    uint32_t ignore_initial_overlaps; /* 1: leaves out what overlaps or is within the tolerance at time 0 */
} crofton_cast_options;

typedef enum crofton_cast_result {
    CROFTON_CAST_MISS = 0,      /* proven: the bodies do not touch in that time */
    CROFTON_CAST_HIT = 1,       /* at `time` they are within the tolerance, before they do not touch, then they do */
    CROFTON_CAST_UNRESOLVED = 2 /* before `time` they do not touch; later is not known */
} crofton_cast_result;

typedef struct crofton_impact {
    size_t size;
    double time, distance;              /* gap at that time; negative: how deep they overlap, from the start */
    double on_a[3], on_b[3], normal[3]; /* on the surfaces; unit, from a to b; all 0 for a miss */
    crofton_part part_a, part_b;
    uint32_t result; /* a crofton_cast_result */
    uint32_t steps;
} crofton_impact;

/* All 0 but for the size: a sphere of radius 0, seen from both sides where it is a surface. */
CROFTON_API crofton_body_description crofton_default_body_description(void);
CROFTON_API crofton_manifold_options crofton_default_manifold_options(void);
CROFTON_API crofton_cast_options crofton_default_cast_options(void);

/* Errors are the kind's: crofton_last_error says which member, and crofton_last_error_item which point, index or child.
 */
CROFTON_API crofton_status crofton_body_create(const crofton_body_description* description, crofton_body** body);
CROFTON_API crofton_status crofton_body_destroy(crofton_body* body);

/* Both fill a struct whose `size` is set. Surfaces have no mass: CROFTON_UNSUPPORTED. */
CROFTON_API crofton_status crofton_body_get_info(const crofton_body* body, crofton_body_info* info);
CROFTON_API crofton_status crofton_body_get_mass(const crofton_body* body, crofton_mass_properties* mass);
/* Told of a line, in the world; `user` is what the caller gave. It must not throw, and may ask bodies, but not the
 * contacts that are drawn. */
typedef void (*crofton_line_visitor)(void* user, const double from[3], const double to[3]);
/* For debug drawing: the edges of a body and of its parts. What is round is drawn as circles, in pieces of a 24th. */
CROFTON_API crofton_status crofton_body_outline(const crofton_placed* body, crofton_line_visitor visit, void* user);
/* Writes the first `capacity` of the convex parts that may be within `margin` >= 0 of another body, and in *found how
 * many there are. These are all that are so near, and some more. A convex body is its own part. */
CROFTON_API crofton_status crofton_body_parts_near(const crofton_placed* body, const crofton_placed* other,
                                                   double margin, crofton_part* parts, size_t capacity, size_t* found);

/* *meet is 1 where the bodies share a point, else 0. `cache` or NULL. */
CROFTON_API crofton_status crofton_bodies_meet(const crofton_placed* a, const crofton_placed* b,
                                               crofton_pair_cache* cache, int* meet);
/* These fill a struct whose `size` is set. `cache` or NULL. */
CROFTON_API crofton_status crofton_bodies_distance(const crofton_placed* a, const crofton_placed* b,
                                                   crofton_pair_cache* cache, crofton_body_distance* distance);
CROFTON_API crofton_status crofton_bodies_penetration(const crofton_placed* a, const crofton_placed* b,
                                                      crofton_pair_cache* cache, crofton_body_penetration* penetration);
CROFTON_API crofton_status crofton_body_closest_point(const crofton_placed* body, const double point[3],
                                                      crofton_body_distance* distance);
/* Where they touch: the deepest manifold. crofton_body_contacts_update tells all, and what has stayed. */
CROFTON_API crofton_status crofton_bodies_manifold(const crofton_placed* a, const crofton_placed* b,
                                                   const crofton_manifold_options* options, crofton_pair_cache* cache,
                                                   crofton_body_manifold* manifold);
/* When will they first touch? `options` or NULL: within a time of 1. A motion or NULL: that body rests. Bodies that
 * begin within the tolerance hit if they move into each other, not if they part or slide along each other. Bodies that
 * begin overlapping hit at time 0, with the shortest way out. */
CROFTON_API crofton_status crofton_bodies_cast(const crofton_placed* a, const crofton_motion* motion_a,
                                               const crofton_placed* b, const crofton_motion* motion_b,
                                               const crofton_cast_options* options, crofton_impact* impact);

CROFTON_API crofton_status crofton_body_contacts_create(crofton_body_contacts** contacts);
CROFTON_API crofton_status crofton_body_contacts_destroy(crofton_body_contacts* contacts);
/* Once a step, of one pair in one order: where it touches now. `options` or NULL.
 *
 * Gives the points, whose memory is yours to write, and how many have ended; `points`, `count`, `ended` or NULL. Valid
 * until the next update. */
CROFTON_API crofton_status crofton_body_contacts_update(crofton_body_contacts* contacts, const crofton_placed* a,
                                                        const crofton_placed* b,
                                                        const crofton_manifold_options* options,
                                                        crofton_tracked_point** points, size_t* count, size_t* ended);
/* For debug drawing: each point's normal, `length` >= 0 long, with a cross of that size across it. */
CROFTON_API crofton_status crofton_body_contacts_outline(crofton_body_contacts* contacts, double length,
                                                         crofton_line_visitor visit, void* user);

/* What does a ray hit first, and what lies within a body? */

/* The points origin + t direction, 0 <= t <= max_t, which may be infinite. A segment from p to q is {p, q - p, 1}. */
typedef struct crofton_ray {
    double origin[3], direction[3];
    double max_t;
} crofton_ray;

/* Where a ray first meets a body. */
typedef struct crofton_body_ray_hit {
    size_t size;
    double t; /* the ray's; infinite: it hits nothing, and all else is 0 */
    double point[3];
    double normal[3]; /* unit, of the surface, to the side that the ray comes from; 0 if it began inside */
    crofton_part part;
    uint32_t started_inside; /* 1: the ray began in a solid body, and t is 0; else 0 */
} crofton_body_ray_hit;

/* *t is where the ray enters the box, 0 where it starts inside, infinite where it misses. */
CROFTON_API crofton_status crofton_box_raycast(const crofton_box* box, const crofton_ray* ray, double* t);
/* Fills a struct whose `size` is set. A solid body that the ray begins in is hit at 0, without a normal; triangles,
 * meshes and height fields have no inside. */
CROFTON_API crofton_status crofton_body_raycast(const crofton_placed* body, const crofton_ray* ray,
                                                crofton_body_ray_hit* hit);
/* *hit is 1 where the ray hits the body, else 0: quicker than where, of a mesh at the identity. */
CROFTON_API crofton_status crofton_body_raycast_any(const crofton_placed* body, const crofton_ray* ray, int* hit);

/* Two bodies of meshes, by their surfaces. `b_to_a` is a rotation and a translation: the pose of b in a's frame. */

/* Where two triangles meet, in a's frame: the ends of their common segment, and the unit normal of b's triangle. */
typedef struct crofton_mesh_contact {
    crofton_pair triangles; /* of a and of b */
    double begin[3], end[3], normal[3];
} crofton_mesh_contact;

typedef enum crofton_containment {
    CROFTON_CONTAINS_NOTHING = 0, /* or the surfaces meet */
    CROFTON_A_INSIDE_B = 1,
    CROFTON_B_INSIDE_A = 2,
    CROFTON_PARTLY_INSIDE = 3 /* some pieces of a mesh, but not all */
} crofton_containment;

/* How the surfaces of two meshes lie. */
typedef struct crofton_mesh_relation {
    size_t size;
    uint32_t meet;           /* 1: they share a point, else 0 */
    uint32_t containment;    /* a crofton_containment: of meshes that do not touch; the outer one is to be closed */
    double distance;         /* the smallest between the surfaces, 0 where they meet */
    double on_a[3], on_b[3]; /* where it is, in a's frame */
    double depth; /* a motion of b by depth along `direction`, a unit vector, ends the contact; an upper bound
                     of the penetration depth, 0 where the meshes do not meet */
    double direction[3];
} crofton_mesh_relation;

/* What crofton_meshes_relate finds out; the other members are 0. */
typedef enum crofton_mesh_relations {
    CROFTON_MESHES_MEET = 1,
    CROFTON_MESHES_CONTAINMENT = 2,
    CROFTON_MESHES_DISTANCE = 4,
    CROFTON_MESHES_DEPTH = 8
} crofton_mesh_relations;

/* Fills a struct whose `size` is set. `which` is a sum of crofton_mesh_relations: each costs its own search. */
CROFTON_API crofton_status crofton_meshes_relate(const crofton_body* a, const crofton_body* b,
                                                 const crofton_transform* b_to_a, uint32_t which,
                                                 crofton_mesh_relation* relation);
/* Writes the first `capacity` contacts, in order of triangles, and in *count how many there are in all: one for each
 * pair of triangles that meet. */
CROFTON_API crofton_status crofton_meshes_contacts(const crofton_body* a, const crofton_body* b,
                                                   const crofton_transform* b_to_a, crofton_mesh_contact* contacts,
                                                   size_t capacity, size_t* count);

/* Boxes around points, best by the criterion that the queries imply. */

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

/* Tight, minimal perimeter: the sum of the edges, for frusta large beside the objects. */
CROFTON_API crofton_fit_options crofton_default_fit_options(void);
/* The criterion that makes the camera's expected number of hits smallest; its far distance must be finite. */
CROFTON_API crofton_status crofton_criterion_for_frustum(const crofton_camera* camera, crofton_criterion* criterion);
/* For rays and segments of this length. */
CROFTON_API crofton_status crofton_criterion_for_rays(double length, crofton_criterion* criterion);

/* A box that contains every point, x y z each: float, or double where `is_double` is 1. `options` or NULL: tight,
 * minimal perimeter. */
CROFTON_API crofton_status crofton_fit_points(const void* points, size_t point_count, uint32_t is_double,
                                              const crofton_fit_options* options, crofton_box* box);
/* A box that contains all the boxes; `criterion` or NULL: minimal perimeter. */
CROFTON_API crofton_status crofton_fit_boxes(const crofton_box* boxes, size_t count, const crofton_criterion* criterion,
                                             crofton_box* box);

#ifdef __cplusplus
}
#endif
#endif
