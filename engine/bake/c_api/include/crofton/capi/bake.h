/* SPDX-License-Identifier: MIT */
/* What tools do before a game runs: triangulate polygons, bake scenes into files, open visible sets.
 * Link crofton_bake as well as crofton. */
#ifndef CROFTON_CAPI_BAKE_H
#define CROFTON_CAPI_BAKE_H
#include <crofton/capi/scene.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Polygons with holes to triangles of minimum weight. */

typedef struct crofton_triangulator crofton_triangulator; /* memory kept from one polygon to the next */

/* Rings one after another; ring r is [ring_ends[r - 1], ring_ends[r]), the first is the outer one, the others holes. */
typedef struct crofton_polygon {
    size_t size;
    const double* points; /* x y each */
    size_t point_count;
    const uint32_t* ring_ends;
    size_t ring_count;
} crofton_polygon;

typedef enum crofton_triangulation_method {
    CROFTON_TRIANGULATE_EAR = 0,
    CROFTON_TRIANGULATE_DELAUNAY = 1,
    CROFTON_TRIANGULATE_MINIMUM_WEIGHT = 2
} crofton_triangulation_method;

typedef struct crofton_triangulation {
    size_t size;
    const uint32_t* indices; /* three per triangle, counter-clockwise; valid until the triangulator's next call */
    size_t triangle_count;
    double weight;    /* total length of the diagonals */
    double gap;       /* proven bound on (weight - minimum) / minimum; infinite when unknown */
    uint32_t optimal; /* 1 where the weight is proven minimal */
} crofton_triangulation;

CROFTON_API crofton_status crofton_triangulator_create(crofton_triangulator** triangulator);
CROFTON_API crofton_status crofton_triangulator_destroy(crofton_triangulator* triangulator);
/* Fills a triangulation whose `size` is set; `method` is a crofton_triangulation_method. */
CROFTON_API crofton_status crofton_triangulate(crofton_triangulator* triangulator, const crofton_polygon* polygon,
                                               uint32_t method, crofton_triangulation* triangulation);

/* Scenes made ready at build time: boxes, tree and meshes in one file that is used where it lies. */

typedef struct crofton_baked_scene crofton_baked_scene;

/* A mesh as it lies in the file. */
typedef struct crofton_baked_mesh {
    size_t size;
    const float* positions; /* x y z per vertex */
    size_t vertex_count;
    const float* colors; /* linear r g b per vertex, or NULL */
    const uint32_t* indices;
    size_t index_count;
    const char* name; /* `name_length` characters, with no 0 behind them */
    size_t name_length;
    crofton_box box; /* in the mesh's own frame */
    /* 1 or 0, 0 if the file was baked without: back faces are not seen; each face has its own normal; the colours are
     * light already */
    uint32_t one_sided, flat, unlit;
    uint32_t reserved; /* 0 */
} crofton_baked_mesh;

typedef struct crofton_baked_instance {
    uint32_t mesh, node;
} crofton_baked_instance;

typedef struct crofton_baked_node {
    crofton_transform world;
    uint32_t parent; /* or CROFTON_NONE */
    uint32_t reserved;
} crofton_baked_node;

/* Writes the scene as of its last update, and its meshes' clusters, into a file. Either all of it is written and
 * flushed to the disk, or the old file stays. Whoever has the old file open keeps its contents. `jobs` or NULL. */
CROFTON_API crofton_status crofton_scene_bake(const crofton_scene* scene, const char* path, const crofton_jobs* jobs);

/* Maps a file and checks it whole. `tree` lies over the instances, item i being instance i; it is a handle of its own,
 * which may change and outlive `baked`. Do not shorten or change the file meanwhile: reading what was cut off ends the
 * program (SIGBUS). Replacing it, as crofton_scene_bake does, is safe. `jobs` or NULL. */
CROFTON_API crofton_status crofton_baked_scene_open(const char* path, const crofton_jobs* jobs,
                                                    crofton_baked_scene** baked, crofton_tree** tree);
/* As crofton_baked_scene_open, with the file read into memory first: what then happens to the file does no harm. */
CROFTON_API crofton_status crofton_baked_scene_read(const char* path, const crofton_jobs* jobs,
                                                    crofton_baked_scene** baked, crofton_tree** tree);
CROFTON_API crofton_status crofton_baked_scene_destroy(crofton_baked_scene* baked);

/* All pointers lead into the file, and hold as long as `baked` lives. */
CROFTON_API crofton_status crofton_baked_scene_mesh_count(const crofton_baked_scene* baked, size_t* count);
CROFTON_API crofton_status crofton_baked_scene_mesh(const crofton_baked_scene* baked, uint32_t mesh_id,
                                                    crofton_baked_mesh* mesh);
/* Makes a mesh's clusters for crofton_depth_object without cutting it anew: a handle of its own, which may outlive
 * `baked`. Returns CROFTON_EMPTY if the mesh was baked without clusters (by an older version, or because it cannot be
 * cut). */
CROFTON_API crofton_status crofton_baked_scene_clusters(const crofton_baked_scene* baked, uint32_t mesh_id,
                                                        crofton_clustered_mesh** clustered);
CROFTON_API crofton_status crofton_baked_scene_instances(const crofton_baked_scene* baked,
                                                         const crofton_baked_instance** instances, size_t* count);
CROFTON_API crofton_status crofton_baked_scene_nodes(const crofton_baked_scene* baked, const crofton_baked_node** nodes,
                                                     size_t* count);

/* Potentially visible sets, as `crofton pvs --out FILE` has baked them: docs/pvs.md. */

typedef struct crofton_pvs crofton_pvs;

typedef enum crofton_pvs_mode {
    CROFTON_PVS_CONSERVATIVE = 0, /* all that is not proved hidden */
    CROFTON_PVS_STATISTICAL = 1   /* what lines have seen */
} crofton_pvs_mode;

#define CROFTON_PVS_NO_CELL 0xffffffffu

/* More than 2^30 pairs of a cell and an object are refused (CROFTON_OUT_OF_RANGE): each takes a byte meanwhile. */
CROFTON_API crofton_status crofton_pvs_open(const char* path, crofton_pvs** pvs);
CROFTON_API crofton_status crofton_pvs_destroy(crofton_pvs* pvs);
/* Numbers of cells and of objects; either may be NULL. */
CROFTON_API crofton_status crofton_pvs_counts(const crofton_pvs* pvs, size_t* cells, size_t* objects);
/* The cell of an eye (three numbers), or CROFTON_PVS_NO_CELL where none holds it, or a solid one. */
CROFTON_API crofton_status crofton_pvs_find_cell(const crofton_pvs* pvs, const double* eye, uint32_t* cell);
/* What may be seen by an eye, for the candidate_mask of a request; `mode` is a crofton_pvs_mode. Without a cell *words
 * is NULL and *count 0: everything. Holds as long as `pvs` lives; nothing is allocated. */
CROFTON_API crofton_status crofton_pvs_visible(const crofton_pvs* pvs, const double* eye, uint32_t mode,
                                               const uint64_t** words, size_t* count);

#ifdef __cplusplus
}
#endif
#endif
