/* SPDX-License-Identifier: MIT */
/* Scenes made ready at build time: boxes, tree and meshes in one file that is used where it lies. */
#ifndef CROFTON_CAPI_BAKE_H
#define CROFTON_CAPI_BAKE_H
#include <crofton/capi/cull.h>
#include <crofton/capi/scene.h>

#ifdef __cplusplus
extern "C" {
#endif

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
} crofton_baked_mesh;

typedef struct crofton_baked_instance {
    uint32_t mesh, node;
} crofton_baked_instance;

typedef struct crofton_baked_node {
    crofton_transform world;
    uint32_t parent; /* or CROFTON_NONE */
    uint32_t reserved;
} crofton_baked_node;

/* Writes the scene as of its last update into a file: all of it, flushed to the disk, or the old file stays as it was.
 * Whoever has the old file open keeps its contents. `jobs` or NULL. */
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
CROFTON_API crofton_status crofton_baked_scene_instances(const crofton_baked_scene* baked,
                                                         const crofton_baked_instance** instances, size_t* count);
CROFTON_API crofton_status crofton_baked_scene_nodes(const crofton_baked_scene* baked, const crofton_baked_node** nodes,
                                                     size_t* count);

#ifdef __cplusplus
}
#endif
#endif
