/* SPDX-License-Identifier: MIT */
/* Crofton for C and for languages that call C. World comes first; modules.h has the parts that it is made of.
 *
 * Every function that can fail returns a status; nothing throws. Results go to the last parameters, which stay
 * untouched on failure. Only a failed allocation may end the program. Parameters that may be NULL are marked "or NULL".
 *
 * Structs that may grow begin with `size`. Fill descriptions and options by their crofton_default_...(), then change
 * what differs. Of the structs that a call fills, set `size` to sizeof(the struct).
 *
 * Threads: calls on different handles are independent. On one handle, calls that take a pointer to const may run at the
 * same time; any other call needs the handle to itself. crofton_set_thread_checks makes a breach a status.
 */
#ifndef CROFTON_CAPI_CROFTON_H
#define CROFTON_CAPI_CROFTON_H
#include <crofton/capi/base.h>
#include <crofton/capi/modules.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The front door: an engine's objects, what they are and where. docs/world.md is the guide. */

/* Owns nodes, meshes and objects. Changes take effect in crofton_world_update. */
typedef struct crofton_world crofton_world;

/* An index that is used again and a generation that tells its users apart; index CROFTON_NONE: none. A call that takes
 * the handle of what has been removed, or one of another world, returns CROFTON_STALE_HANDLE. Generations begin
 * elsewhere in each world of the process and are never 0: so it does for {0, 0}. */
typedef struct crofton_object {
    uint32_t index, generation;
} crofton_object;
typedef struct crofton_node {
    uint32_t index, generation;
} crofton_node;
typedef struct crofton_world_mesh {
    uint32_t index, generation;
} crofton_world_mesh;

/* A struct of this header that was compiled against an older version, and is smaller, is accepted: members that it
 * lacks have their defaults, and results are written as far as it goes. A larger one is CROFTON_WRONG_SIZE. */

#define CROFTON_AUTOMATIC UINT64_MAX

typedef struct crofton_world_options {
    size_t size;
    uint32_t pairs;           /* 1: look for pairs and contacts; 0: for neither */
    uint32_t contacts;        /* 1; 0: pairs alone */
    uint32_t containment;     /* 1: an object inside a closed mesh touches it */
    uint32_t mesh_depth;      /* 0; 1: contacts between meshes have a way out, which costs more */
    uint64_t max_pairs;       /* 2^24; more are an error */
    uint64_t rebuild_budget;  /* items' worth of background work on the tree an update; CROFTON_AUTOMATIC: while
                                 one is under way, at least a 2048th of the objects and 128. 0: none, and no allocation
                                 for it */
    uint32_t updates_to_rest; /* 16: updates without motion until an object counts as resting */
    double contact_margin;    /* 0: gaps up to this between bodies are contacts */
} crofton_world_options;

/* As of the last update. */
typedef struct crofton_world_statistics {
    size_t size;
    uint64_t objects, resting, moving; /* the latter two: shown ones */
    uint64_t box_pairs_tested, contact_pairs_tested;
    uint32_t boxes_changed, nodes_updated;
    uint32_t out_of_range; /* objects that the product of transforms has put beyond it: hidden until they return */
    uint32_t tree_built;   /* 1: all at once, because much has come to rest, or come and gone */
    uint64_t object_count; /* now: hidden ones count, removed ones do not */
} crofton_world_statistics;

/* A mesh in its own frame, in the caller's arrays; World copies what it needs. Three indices a triangle,
 * counter-clockwise seen from outside; with an index_count of 0 three positions are one. */
typedef struct crofton_mesh_data {
    size_t size;
    const void* positions; /* x y z; of any alignment */
    size_t position_count;
    size_t position_stride; /* in bytes; 0: packed */
    const void* indices;    /* packed */
    size_t index_count;
    uint32_t is_double; /* 1: positions are double, rounded to float; 0: float */
    uint32_t is_short;  /* 1: indices are uint16_t; 0: uint32_t */
    uint32_t triangles; /* 1: rays and contacts ask the triangles; 0: the mesh's box stands for it */
    uint32_t clusters;  /* 0; 1: views with a picture list the triangles, in the clusters of crofton_world_get_mesh */
    uint32_t one_sided; /* 0; 1, with clusters: back faces are not drawn, and not listed but of mirrored objects */
} crofton_mesh_data;

typedef enum crofton_bound_kind {
    CROFTON_BOUND_NONE = 0,
    CROFTON_BOUND_BOX = 1,
    CROFTON_BOUND_ALIGNED_BOX = 2,
    CROFTON_BOUND_SPHERE = 3
} crofton_bound_kind;

/* The shape of an object without a mesh, in the world's coordinates. */
typedef struct crofton_bound {
    uint32_t kind;            /* a crofton_bound_kind: which members below count */
    crofton_box box;          /* of a box */
    double min[3], max[3];    /* of an aligned box */
    double center[3], radius; /* of a sphere */
} crofton_bound;

/* A mesh or a body, which `transform` places under `node` or in the world; or a bound. An object with a body needs
 * neither mesh nor bound. */
typedef struct crofton_object_description {
    size_t size;
    uint64_t user;                      /* given back with every answer */
    const crofton_bound* bound;         /* or NULL, of a mesh or a body alone */
    const crofton_transform* transform; /* or NULL: the node's own */
    uint32_t has_mesh, has_node;        /* 1: the next two count */
    crofton_world_mesh mesh;
    crofton_node node;
    uint32_t layers;        /* all: views and queries ask for layers */
    uint32_t collides_with; /* all layers; 0: the object has no pairs */
    uint32_t occludes;      /* 1: an object with a mesh hides others; 0: it does not, as where it is transparent */
    uint32_t only_occludes; /* 0; 1: of an object with a mesh: it is in no answer, and hides what its occluders hide */
    /* Or NULL. Destroy it at any time: the world keeps what it needs. It counts for pairs from the next update on, for
     * queries at once. From the next update on the object's box also covers it. Half-spaces, and compounds that hold
     * some, are ground without end. The object's transform scales the body; CROFTON_UNSUPPORTED: a transform that turns
     * it into another kind of body, as an uneven scale does with a sphere. Calls that move objects and nodes refuse
     * such transforms too. */
    const crofton_body* body;
    uint32_t hidden; /* 0; 1: the object is in no answer */
} crofton_object_description;

/* Which members crofton_world_set takes of a description. */
typedef enum crofton_object_members {
    CROFTON_SET_USER = 1,
    CROFTON_SET_LAYERS = 2,
    CROFTON_SET_COLLIDES_WITH = 4,
    CROFTON_SET_HIDDEN = 8,
    CROFTON_SET_OCCLUDES = 16, /* of an object with a mesh */
    CROFTON_SET_MESH = 32,     /* of an object that has one */
    CROFTON_SET_BOUND = 64,    /* of an object that was added with one */
    CROFTON_SET_BODY = 128     /* NULL takes it away, but not from an object that was added by its body alone */
} crofton_object_members;

CROFTON_API crofton_world_options crofton_default_world_options(void);
CROFTON_API crofton_mesh_data crofton_default_mesh_data(void);
CROFTON_API crofton_object_description crofton_default_object_description(void);

/* `options` or NULL: all defaults. */
CROFTON_API crofton_status crofton_world_create(const crofton_world_options* options, crofton_world** world);
CROFTON_API crofton_status crofton_world_destroy(crofton_world* world);

CROFTON_API crofton_status crofton_world_add_mesh(crofton_world* world, const crofton_mesh_data* data,
                                                  crofton_world_mesh* mesh);
CROFTON_API crofton_status crofton_world_replace_mesh(crofton_world* world, crofton_world_mesh mesh,
                                                      const crofton_mesh_data* data);
/* For a mesh that deforms: as many positions as before. The other members of `data` are not looked at. */
CROFTON_API crofton_status crofton_world_set_vertices(crofton_world* world, crofton_world_mesh mesh,
                                                      const crofton_mesh_data* data);
/* An error while objects use it. */
CROFTON_API crofton_status crofton_world_remove_mesh(crofton_world* world, crofton_world_mesh mesh);

/* `parent` or NULL: none; `transform` or NULL: the identity. `layers` limits those of all objects below. */
CROFTON_API crofton_status crofton_world_add_node(crofton_world* world, const crofton_node* parent,
                                                  const crofton_transform* transform, uint32_t layers,
                                                  crofton_node* node);
/* Removes the node with all nodes and objects below it. */
CROFTON_API crofton_status crofton_world_remove_node(crofton_world* world, crofton_node node);
/* `parent` or NULL: none. CROFTON_INVALID_ARGUMENT: the node itself, or one below it. */
CROFTON_API crofton_status crofton_world_set_parent(crofton_world* world, crofton_node node,
                                                    const crofton_node* parent);
CROFTON_API crofton_status crofton_world_set_node_layers(crofton_world* world, crofton_node node, uint32_t layers);

/* The calls with strides read members of the caller's structs: `stride` bytes apart, 0: packed. A stride is a multiple
 * of the type's alignment and no less than its size. Items that are refused stay as they are and all others change;
 * crofton_last_error_item is the place of the first that was refused. */

CROFTON_API crofton_status crofton_world_set_node_transforms(crofton_world* world, const crofton_node* nodes,
                                                             size_t node_stride, const crofton_transform* transforms,
                                                             size_t transform_stride, size_t count);

CROFTON_API crofton_status crofton_world_add(crofton_world* world, const crofton_object_description* description,
                                             crofton_object* object);
CROFTON_API crofton_status crofton_world_remove(crofton_world* world, crofton_object object);
/* Requires objects that were added with a transform, or by a body under no node. */
CROFTON_API crofton_status crofton_world_set_transforms(crofton_world* world, const crofton_object* objects,
                                                        size_t object_stride, const crofton_transform* transforms,
                                                        size_t transform_stride, size_t count);
/* Requires objects that were added with a bound, which becomes a box. */
CROFTON_API crofton_status crofton_world_set_boxes(crofton_world* world, const crofton_object* objects,
                                                   size_t object_stride, const crofton_box* boxes, size_t box_stride,
                                                   size_t count);
/* Sets members of an object: `members` is a sum of crofton_object_members, at most one of the last four. An error
 * changes nothing. */
CROFTON_API crofton_status crofton_world_set(crofton_world* world, crofton_object object, uint32_t members,
                                             const crofton_object_description* description);

/* Regions: parts of a large world, prepared on any thread and attached in constant time (docs/large_worlds.md). */

/* Many objects that do not move. It does not change, and any thread may use it. */
typedef struct crofton_region crofton_region;
/* A region at one origin. */
typedef struct crofton_attached_region {
    uint32_t index, generation;
} crofton_attached_region;

#define CROFTON_FIRST_REGION_INDEX 0x80000000u /* indices of regions' objects begin here, consecutive in each */

/* Begin with crofton_default_region_object(). */
typedef struct crofton_region_object {
    crofton_bound bound; /* relative to the region's origin */
    uint64_t user;
    uint32_t layers, collides_with; /* all */
} crofton_region_object;

typedef struct crofton_region_options {
    size_t size;
    uint64_t max_objects; /* 2^24; more are an error */
    /* Or NULL. Return 1 to stop: CROFTON_CANCELLED. It is not asked while the tree is built. */
    int (*should_stop)(void* user, double share_done);
    void* stop_user;
} crofton_region_options;

CROFTON_API crofton_region_object crofton_default_region_object(void);
CROFTON_API crofton_region_options crofton_default_region_options(void);
/* Call it on any thread. `options`, `jobs` or NULL. crofton_last_error_item is the place of an object that is
 * refused. */
CROFTON_API crofton_status crofton_region_prepare(const crofton_region_object* objects, size_t count,
                                                  const crofton_region_options* options, const crofton_jobs* jobs,
                                                  crofton_region** region);
/* At any time: a world keeps what it needs. */
CROFTON_API crofton_status crofton_region_destroy(crofton_region* region);
/* From the next update on, answers contain the region's objects; their centers are moved by `origin`. */
CROFTON_API crofton_status crofton_world_attach(crofton_world* world, const crofton_region* region,
                                                const double origin[3], crofton_attached_region* attached);
/* Handles of its objects are stale at once; views follow with the next update. */
CROFTON_API crofton_status crofton_world_detach(crofton_world* world, crofton_attached_region region);
/* The object at `place` of those that the region was prepared from. crofton_world_set hides it; other changes are
 * CROFTON_UNSUPPORTED. */
CROFTON_API crofton_status crofton_world_object_in(const crofton_world* world, crofton_attached_region region,
                                                   uint32_t place, crofton_object* object);
/* The reverse. CROFTON_INVALID_ARGUMENT: an object that crofton_world_add has added. */
CROFTON_API crofton_status crofton_world_place_of(const crofton_world* world, crofton_object object,
                                                  crofton_attached_region* region, uint32_t* place);

/* Makes the changes take effect; once a frame. `jobs` or NULL. CROFTON_BUDGET_EXCEEDED: more than max_pairs pairs;
 * then there are none, and all else is as it should be. */
CROFTON_API crofton_status crofton_world_update(crofton_world* world, const crofton_jobs* jobs);
CROFTON_API crofton_status crofton_world_get_statistics(const crofton_world* world,
                                                        crofton_world_statistics* statistics);

/* Queries, all as of the last update: what is seen, what rays and shapes meet, what touches. */

typedef struct crofton_found crofton_found; /* a list of objects or of hits; its memory is kept */

typedef struct crofton_object_ref {
    crofton_object object;
    uint64_t user;
} crofton_object_ref;

typedef struct crofton_object_hit {
    crofton_object object; /* index CROFTON_NONE: no hit, and t is infinite */
    uint64_t user;
    double t; /* the ray's */
    double point[3];
    uint32_t triangle;      /* of the object's mesh or of its body's surface, or CROFTON_NONE */
    uint32_t child;         /* of a body that is a compound: which */
    double normal[3];       /* unit, of the surface, to the side that the ray comes from; 0 if it began inside */
    uint8_t started_inside; /* 1: the ray began in the body, box or sphere, and t is 0; else 0 */
} crofton_object_hit;

typedef struct crofton_closest_object {
    size_t size;
    crofton_object object; /* index CROFTON_NONE: none within the distance, which is infinite then */
    uint64_t user;
    double distance;
    double on_shape[3], on_object[3]; /* a nearest point of each; any where they meet */
} crofton_closest_object;

typedef struct crofton_object_pair {
    crofton_object_ref first, second; /* first.object.index < second.object.index */
} crofton_object_pair;

typedef enum crofton_contact_phase {
    CROFTON_CONTACT_BEGAN = 0,
    CROFTON_CONTACT_STAYED = 1,
    CROFTON_CONTACT_ENDED = 2
} crofton_contact_phase;

/* Two objects that touch, or that did in the update before. Ended contacts carry only the two object handles, which are
 * stale where they have been removed. */
typedef struct crofton_object_contact {
    crofton_object_ref first, second;    /* ordered as in crofton_object_pair */
    uint8_t phase;                       /* a crofton_contact_phase */
    uint8_t inside;                      /* a crofton_containment of first (a) and second (b) */
    double normal[3];                    /* unit, from first to second; 0 where no direction is known */
    double depth;                        /* between meshes the deepest point's, unless options ask for a way out */
    const crofton_contact_point* points; /* at most four, in the world; valid until the next update */
    size_t point_count;
    const crofton_mesh_contact* triangles; /* of two meshes, or a mesh and a box; likewise */
    size_t triangle_count;
} crofton_object_contact;

/* Two objects with bodies that touch, or did in the update before. Ended contacts have no points. */
typedef struct crofton_body_contact {
    crofton_object_ref first, second; /* ordered as in crofton_object_pair; the first is body a */
    uint8_t phase;                    /* a crofton_contact_phase */
    uint8_t unused[sizeof(void*) - 1];
    crofton_tracked_point* points; /* their memory is yours to write; valid until the next update */
    uint32_t point_count;
    uint32_t unused_too;
} crofton_body_contact;

/* The first object that a moving body meets. */
typedef struct crofton_body_hit {
    size_t size;
    crofton_object object; /* index CROFTON_NONE: nothing, and time is infinite */
    uint64_t user;
    double time;
    double normal[3];  /* unit, from the body to the object */
    double point[3];   /* on the object's surface */
    uint32_t triangle; /* of a surface */
    uint32_t result;   /* a crofton_cast_result; unresolved: up to `time` nothing is met, later is not known */
    double distance;   /* gap at that time; negative: how deep they overlap, from the start */
} crofton_body_hit;

/* What is known of an object; box and transform as of the last update. */
typedef struct crofton_object_info {
    size_t size;
    uint64_t user;
    uint32_t has_box;       /* 0 before the first update after the object was added: box is 0 */
    uint32_t has_transform; /* 1 where the object has a mesh, and likewise */
    crofton_box box;
    crofton_transform transform; /* object to world */
} crofton_object_info;

typedef struct crofton_mesh_info {
    size_t size;
    size_t occluder_count;
    crofton_clusters clusters; /* as of the last update, valid until the next; of a mesh without clusters all is 0 */
} crofton_mesh_info;

/* Fill a struct whose `size` is set. CROFTON_STALE_HANDLE: it is not in the world. */
CROFTON_API crofton_status crofton_world_get_object(const crofton_world* world, crofton_object object,
                                                    crofton_object_info* info);
CROFTON_API crofton_status crofton_world_get_mesh(const crofton_world* world, crofton_world_mesh mesh,
                                                  crofton_mesh_info* info);
/* *contains is 1 or 0. */
CROFTON_API crofton_status crofton_world_contains_node(const crofton_world* world, crofton_node node, int* contains);

/* Finds what `count` views see, 1 to 32, by the objects' boxes, and with occlusion by what is not hidden: each object
 * once. Each view keeps its own options. `jobs` or NULL.
 *
 * All requests have the same `size` and lie so far apart; crofton_last_error_item is the place of one of several that
 * is refused. Allocates nothing once `result` has grown to the largest answer. */
CROFTON_API crofton_status crofton_world_view(const crofton_world* world, const crofton_view_request* requests,
                                              size_t count, const crofton_jobs* jobs, crofton_view_result* result);
/* Writes the objects from place `first` on, at most `capacity`; bit v of view_masks[i] (or NULL): view v sees
 * objects[i].
 *
 * `world` is the one that was viewed. After its next update it is CROFTON_INVALID_ARGUMENT. */
CROFTON_API crofton_status crofton_view_result_list(const crofton_view_result* result, const crofton_world* world,
                                                    size_t first, crofton_object_ref* objects, uint32_t* view_masks,
                                                    size_t capacity);

/* Rays meet bodies; of objects without one triangles of meshes, boxes and spheres. hits[i] is the nearest of rays[i].
 */
CROFTON_API crofton_status crofton_world_raycast(const crofton_world* world, const crofton_ray* rays, size_t count,
                                                 uint32_t layer_mask, crofton_object_hit* hits);
/* *hit is 1 where the ray hits anything, else 0. */
CROFTON_API crofton_status crofton_world_raycast_any(const crofton_world* world, const crofton_ray* ray,
                                                     uint32_t layer_mask, int* hit);

CROFTON_API crofton_status crofton_found_create(crofton_found** found);
CROFTON_API crofton_status crofton_found_destroy(crofton_found* found);
/* What the last query into `found` has found, of its kind; valid until the next. */
CROFTON_API crofton_status crofton_found_objects(const crofton_found* found, const crofton_object_ref** objects,
                                                 size_t* count);
CROFTON_API crofton_status crofton_found_hits(const crofton_found* found, const crofton_object_hit** hits,
                                              size_t* count);

/* Finds the nearest hit of every object that the ray meets, by t, then by index: hits. */
CROFTON_API crofton_status crofton_world_raycast_all(const crofton_world* world, const crofton_ray* ray,
                                                     uint32_t layer_mask, crofton_found* found);
/* Finds the objects whose box or sphere meets the shape, in order of index; a mesh counts as its box. A body meets
 * bodies of objects exactly; CROFTON_UNSUPPORTED: a half-space. */
CROFTON_API crofton_status crofton_world_overlap(const crofton_world* world, const crofton_shape* shape,
                                                 uint32_t layer_mask, crofton_found* found);
/* Fills a struct whose `size` is set: the object nearest to the shape, as above, no farther than max_distance, which
 * may be infinite. Of several the lowest index. */
CROFTON_API crofton_status crofton_world_closest(const crofton_world* world, const crofton_shape* shape,
                                                 double max_distance, uint32_t layer_mask,
                                                 crofton_closest_object* closest);

/* Objects whose boxes or spheres meet, in order; valid until the next update. */
CROFTON_API crofton_status crofton_world_pairs(const crofton_world* world, const crofton_object_pair** pairs,
                                               size_t* count);
/* In order of the pairs; valid until the next update. */
CROFTON_API crofton_status crofton_world_contacts(const crofton_world* world, const crofton_object_contact** contacts,
                                                  size_t* count);

/* Of objects that both have bodies, in order; valid until the next update. Pairs of which neither has moved are not
 * computed again. */
CROFTON_API crofton_status crofton_world_body_contacts(const crofton_world* world,
                                                       const crofton_body_contact** contacts, size_t* count);
/* Fills a struct whose `size` is set: the first object that a moving body meets. `options` or NULL. */
CROFTON_API crofton_status crofton_world_cast(const crofton_world* world, const crofton_placed* shape,
                                              const crofton_motion* motion, const crofton_cast_options* options,
                                              uint32_t layer_mask, crofton_body_hit* hit);

/* Occluders: what the objects of a mesh hide others with. docs/occlude.md is the guide. */

typedef enum crofton_occluder_kind {
    CROFTON_OCCLUDER_BOX = 0,    /* inside a closed piece of the mesh */
    CROFTON_OCCLUDER_WALLED = 1, /* a box behind walls of the mesh, that may be open on some sides */
    CROFTON_OCCLUDER_CONVEX = 2, /* the convex hull of the positions */
    CROFTON_OCCLUDER_PATCH = 3   /* any triangles */
} crofton_occluder_kind;

/* In the mesh's frame: within what is drawn of it, and opaque. */
typedef struct crofton_occluder {
    size_t size;
    uint32_t kind;          /* a crofton_occluder_kind */
    uint32_t is_one_sided;  /* of a patch, 1: it hides only from where its triangles are counter-clockwise */
    const float* positions; /* x y z, packed; of a box that is given they may be missing */
    size_t position_count;
    const uint32_t* indices; /* of a convex hull that is given they may be missing */
    size_t index_count;
    crofton_box box;                   /* of a box, walled or not */
    uint32_t edges;                    /* what it costs; 0: estimated */
    uint32_t has_piece, has_eyes;      /* 1: the next members count */
    double piece_min[3], piece_max[3]; /* an eye in here does not use it */
    double eyes_min[3], eyes_max[3];   /* an eye must be in here; may be infinite */
    double mean_shadow, gain;          /* of what was found: how much it covers, and adds to those before it */
} crofton_occluder;

/* 0: the default. */
typedef struct crofton_find_options {
    size_t size;
    uint32_t is_two_sided; /* 1: back faces are drawn as well */
    uint32_t max_occluders, max_edges, max_boxes_a_piece, grid;
    double least_gain, flatness;
    uint32_t max_patch_triangles;
    uint32_t level_triangles; /* not 0: a level of many small pieces, as surfaces of so many triangles, say 48 */
} crofton_find_options;

typedef struct crofton_occluder_ref {
    crofton_object object;
    uint64_t user;
    uint32_t place; /* among the occluders of the object's mesh */
    uint32_t unused;
} crofton_occluder_ref;

CROFTON_API crofton_find_options crofton_default_find_options(void);
/* Looks for occluders in a mesh; `options` or NULL: defaults. They take effect in the next update. Takes a second or
 * more for 100,000 triangles. */
CROFTON_API crofton_status crofton_world_find_occluders(crofton_world* world, crofton_world_mesh mesh,
                                                        const crofton_find_options* options);
/* Gives a mesh its occluders: those stored of an earlier search, or the caller's own; none: count 0. All have the same
 * `size` and lie so far apart. crofton_last_error_item is the place of one that is refused; then all is as before. */
CROFTON_API crofton_status crofton_world_set_occluders(crofton_world* world, crofton_world_mesh mesh,
                                                       const crofton_occluder* occluders, size_t count);
/* Fills a struct whose `size` is set; its arrays are valid until the mesh's occluders change. */
CROFTON_API crofton_status crofton_world_get_occluder(const crofton_world* world, crofton_world_mesh mesh, size_t place,
                                                      crofton_occluder* occluder);
/* Writes the occluders that hide an object, none where it is not hidden; `hidden` NULL: all that were drawn, those
 * worth most first. At most `capacity`, and how many there are to *count. `world` is the one that was viewed; after its
 * next update it is CROFTON_INVALID_ARGUMENT. `result` is of one view. To ask for one object is slow. */
CROFTON_API crofton_status crofton_view_result_occluders(const crofton_view_result* result, const crofton_world* world,
                                                         const crofton_object* hidden, crofton_occluder_ref* occluders,
                                                         size_t capacity, size_t* count);

#ifdef __cplusplus
}
#endif
#endif
