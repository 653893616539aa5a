/* SPDX-License-Identifier: MIT */
/* Triangulates polygons, bakes scenes into files, opens baked scenes, regions and visible sets.
 * Link crofton_bake as well as crofton. */
#ifndef CROFTON_CAPI_BAKE_H
#define CROFTON_CAPI_BAKE_H
#include <crofton/capi/crofton.h>
#include <crofton/capi/scene.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Triangulate polygons with holes, at minimum weight. */

typedef struct crofton_triangulator crofton_triangulator; /* keeps its memory from one polygon to the next */

/* The points of all rings, one ring after another. Ring r is [ring_ends[r - 1], ring_ends[r]). The first ring is the
 * outer one, the others are holes. */
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
    double gap;       /* proved bound of (weight - minimum) / minimum; infinite if unknown */
    uint32_t optimal; /* 1 if the weight is proved to be minimal */
} crofton_triangulation;

CROFTON_API crofton_status crofton_triangulator_create(crofton_triangulator** triangulator);
CROFTON_API crofton_status crofton_triangulator_destroy(crofton_triangulator* triangulator);
/* Fills a triangulation whose `size` is set; `method` is a crofton_triangulation_method. */
CROFTON_API crofton_status crofton_triangulate(crofton_triangulator* triangulator, const crofton_polygon* polygon,
                                               uint32_t method, crofton_triangulation* triangulation);

/* Baked scenes: boxes, tree and meshes in one file, which is mapped and used in place. */

typedef struct crofton_baked_scene crofton_baked_scene;

/* A mesh in the file. */
typedef struct crofton_baked_mesh {
    size_t size;
    const float* positions; /* x y z per vertex */
    size_t vertex_count;
    const float* colors; /* linear r g b per vertex, or NULL */
    const uint32_t* indices;
    size_t index_count;
    const char* name; /* `name_length` characters, not ended by a 0 */
    size_t name_length;
    crofton_box box; /* in the mesh's own frame */
    /* 1 or 0; 0 if the file does not say: back faces are not drawn; each face has its own normal; colours are not
     * lit */
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

/* Writes the scene as of its last update, and its meshes' clusters, to a file. The file is either complete and flushed
 * to the disk, or an old file stays unchanged. A process that has the old file open keeps its contents. `jobs` or
 * NULL. */
CROFTON_API crofton_status crofton_scene_bake(const crofton_scene* scene, const char* path, const crofton_jobs* jobs);

/* Maps a file and checks all of it. Item i of `tree` is instance i. The tree is a handle of its own: you may change it,
 * and it may outlive `baked`. Do not shorten or change the file while it is mapped: reading what was cut off ends the
 * program (SIGBUS). Replacing it, as crofton_scene_bake does, is safe. `jobs` or NULL. */
CROFTON_API crofton_status crofton_baked_scene_open(const char* path, const crofton_jobs* jobs,
                                                    crofton_baked_scene** baked, crofton_tree** tree);
/* Does the same, but reads the file into memory; later changes to the file do no harm. */
CROFTON_API crofton_status crofton_baked_scene_read(const char* path, const crofton_jobs* jobs,
                                                    crofton_baked_scene** baked, crofton_tree** tree);
CROFTON_API crofton_status crofton_baked_scene_destroy(crofton_baked_scene* baked);

/* Pointers lead into the mapped file and are valid as long as `baked`. */
CROFTON_API crofton_status crofton_baked_scene_mesh_count(const crofton_baked_scene* baked, size_t* count);
CROFTON_API crofton_status crofton_baked_scene_mesh(const crofton_baked_scene* baked, uint32_t mesh_id,
                                                    crofton_baked_mesh* mesh);
/* Makes a mesh's clusters for crofton_depth_object without cutting it again: a handle of its own, which may outlive
 * `baked`. Returns CROFTON_EMPTY if the mesh was baked without clusters (by an older version, or because it cannot be
 * cut). */
CROFTON_API crofton_status crofton_baked_scene_clusters(const crofton_baked_scene* baked, uint32_t mesh_id,
                                                        crofton_clustered_mesh** clustered);
CROFTON_API crofton_status crofton_baked_scene_instances(const crofton_baked_scene* baked,
                                                         const crofton_baked_instance** instances, size_t* count);
CROFTON_API crofton_status crofton_baked_scene_nodes(const crofton_baked_scene* baked, const crofton_baked_node** nodes,
                                                     size_t* count);

/* Regions of a world, from baked files. Guide: docs/large_worlds.md. */

typedef struct crofton_baked_region_options {
    size_t size;
    uint32_t triangles; /* 1: rays, probes and contacts test the triangles, for which a tree is built over each mesh; 0:
                           they test the meshes' boxes */
    uint32_t occluders; /* 1: objects hide others by the occluders of the file; 0: they do not, which saves half of the
                           time */
    uint32_t collides_with;  /* all; of all objects */
    uint32_t trust_contents; /* 0; 1: does not check that the bounds in the file contain the boxes below them. Only for
                                files of your own: wrong bounds would lose objects later */
    uint64_t max_objects;    /* 2^24; a region with more is refused */
    double max_origin; /* 1e9, as in crofton_region_options; for another value the tree of the file is not used, but
                          built anew */
} crofton_baked_region_options;

CROFTON_API crofton_baked_region_options crofton_default_baked_region_options(void);
/* Opens a file that `crofton bake` or crofton_scene_bake wrote, checks all of it, and prepares a region; call it on any
 * thread. The object at place i is instance i, with the user number i. Meshes have the numbers of the file. Everything
 * is copied: nothing is read from the file afterwards. `options`, `jobs` or NULL. */
CROFTON_API crofton_status crofton_baked_region_open(const char* path, const crofton_baked_region_options* options,
                                                     const crofton_jobs* jobs, crofton_region** region);

/* The index of a world that `crofton bake --regions` has split: a folder with a file for each region. */
typedef struct crofton_region_index crofton_region_index;

typedef struct crofton_region_file {
    const char* name;      /* of the file, in the folder of the index */
    double origin[3];      /* where to attach it */
    double min[3], max[3]; /* around its objects, relative to the origin */
    uint64_t objects;
    uint64_t bytes; /* of the file */
} crofton_region_file;

/* Reads FOLDER/index.crofton. */
CROFTON_API crofton_status crofton_region_index_open(const char* folder, crofton_region_index** index);
CROFTON_API crofton_status crofton_region_index_destroy(crofton_region_index* index);
/* Returns where the regions are; valid as long as `index`. */
CROFTON_API crofton_status crofton_region_index_files(const crofton_region_index* index,
                                                      const crofton_region_file** files, size_t* count);
/* Does the same as crofton_baked_region_open for the region at a place in the index. CROFTON_PARSE: also for a file
 * that has another size or other objects than the index says. CROFTON_OUT_OF_RANGE: there is no such place. */
CROFTON_API crofton_status crofton_region_index_prepare(const crofton_region_index* index, size_t place,
                                                        const crofton_baked_region_options* options,
                                                        const crofton_jobs* jobs, crofton_region** region);

/* Potentially visible sets, baked by `crofton pvs --out FILE`. Guide: docs/pvs.md. */

typedef struct crofton_pvs crofton_pvs;

typedef enum crofton_pvs_mode {
    CROFTON_PVS_CONSERVATIVE = 0, /* everything that is not proved to be hidden */
    CROFTON_PVS_STATISTICAL = 1   /* what random lines have seen */
} crofton_pvs_mode;

#define CROFTON_PVS_NO_CELL 0xffffffffu

/* CROFTON_OUT_OF_RANGE: the file has more than 2^30 pairs of a cell and an object, each of which takes a byte while it
 * is opened. */
CROFTON_API crofton_status crofton_pvs_open(const char* path, crofton_pvs** pvs);
/* Does the same for a file that lies in memory, as one of an archive does. Copies what it needs. */
CROFTON_API crofton_status crofton_pvs_read(const uint8_t* bytes, size_t count, crofton_pvs** pvs);
CROFTON_API crofton_status crofton_pvs_destroy(crofton_pvs* pvs);
/* Returns the numbers of cells and of objects; either may be NULL. */
CROFTON_API crofton_status crofton_pvs_counts(const crofton_pvs* pvs, size_t* cells, size_t* objects);
/* Finds the cell of an eye (three numbers), or CROFTON_PVS_NO_CELL if it is in none, or in a solid one. */
CROFTON_API crofton_status crofton_pvs_find_cell(const crofton_pvs* pvs, const double* eye, uint32_t* cell);
/* Returns what an eye may see, for the candidate_mask of a request; `mode` is a crofton_pvs_mode. If the eye is in no
 * cell, *words is NULL and *count 0, which stands for everything. Valid as long as `pvs`. Allocates nothing. */
CROFTON_API crofton_status crofton_pvs_visible(const crofton_pvs* pvs, const double* eye, uint32_t mode,
                                               const uint64_t** words, size_t* count);

#ifdef __cplusplus
}
#endif
#endif
