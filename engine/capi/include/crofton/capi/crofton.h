/* SPDX-License-Identifier: MIT */
/* Crofton for C and for languages that call C: all of the CPU modules behind opaque handles.
 *
 * Every function returns a status; nothing throws, and nothing but a failed allocation ends the program. Results go to
 * the last parameters and are untouched on failure. Structs that may grow begin with `size`: set it to sizeof(the
 * struct), so that library and caller agree on what it holds; those of World may be older and smaller. Optional
 * pointers are marked "or NULL".
 *
 * Threads: calls on different handles are independent. On one handle, calls that take a pointer to const may run at the
 * same time; any other call needs the handle to itself. crofton_set_thread_checks makes a breach a status.
 */
#ifndef CROFTON_CAPI_CROFTON_H
#define CROFTON_CAPI_CROFTON_H
#include <crofton/capi/bake.h>
#include <crofton/capi/base.h>
#include <crofton/capi/collide.h>
#include <crofton/capi/contacts.h>
#include <crofton/capi/cull.h>
#include <crofton/capi/fit.h>
#include <crofton/capi/geometry.h>
#include <crofton/capi/hooks.h>
#include <crofton/capi/rays.h>
#include <crofton/capi/scene.h>
#include <crofton/capi/triangulate.h>
#include <crofton/capi/world.h>
#include <crofton/capi/world_occlusion.h>
#include <crofton/capi/world_queries.h>
#endif
