// SPDX-License-Identifier: MIT
// Every call that takes a handle, with each of its handles NULL, without a kind, and of another kind.
#include <filesystem>
#include <fstream>

#include "wrong_handles.hpp"

using namespace crofton::capi_test;

namespace {

#define CROFTON_REFUSE(call) table.refuse(#call, &call)

void refuse_world_changes(Table& table) {
    CROFTON_REFUSE(crofton_world_destroy);
    CROFTON_REFUSE(crofton_world_add_mesh);
    CROFTON_REFUSE(crofton_world_replace_mesh);
    CROFTON_REFUSE(crofton_world_set_vertices);
    CROFTON_REFUSE(crofton_world_remove_mesh);
    CROFTON_REFUSE(crofton_world_add_node);
    CROFTON_REFUSE(crofton_world_remove_node);
    CROFTON_REFUSE(crofton_world_set_parent);
    CROFTON_REFUSE(crofton_world_set_node_layers);
    CROFTON_REFUSE(crofton_world_set_node_transforms);
    CROFTON_REFUSE(crofton_world_add);
    CROFTON_REFUSE(crofton_world_add_many);
    CROFTON_REFUSE(crofton_world_reserve);
    CROFTON_REFUSE(crofton_world_remove);
    CROFTON_REFUSE(crofton_world_set_transforms);
    CROFTON_REFUSE(crofton_world_set_boxes);
    CROFTON_REFUSE(crofton_world_set);
    CROFTON_REFUSE(crofton_world_update);
    CROFTON_REFUSE(crofton_region_destroy);
    CROFTON_REFUSE(crofton_region_get_info);
    CROFTON_REFUSE(crofton_region_mesh_of);
    CROFTON_REFUSE(crofton_region_clusters_of);
    CROFTON_REFUSE(crofton_world_attach);
    CROFTON_REFUSE(crofton_world_detach);
    CROFTON_REFUSE(crofton_world_object_in);
    CROFTON_REFUSE(crofton_world_place_of);
    CROFTON_REFUSE(crofton_world_get_statistics);
    CROFTON_REFUSE(crofton_world_contains_node);
    CROFTON_REFUSE(crofton_world_get_object);
    CROFTON_REFUSE(crofton_world_get_mesh);
}

void refuse_world_queries(Table& table) {
    CROFTON_REFUSE(crofton_world_view);
    CROFTON_REFUSE(crofton_world_raycast);
    CROFTON_REFUSE(crofton_world_raycast_any);
    CROFTON_REFUSE(crofton_world_raycast_all);
    CROFTON_REFUSE(crofton_world_overlap);
    CROFTON_REFUSE(crofton_world_closest);
    CROFTON_REFUSE(crofton_world_pairs);
    CROFTON_REFUSE(crofton_world_contacts);
    CROFTON_REFUSE(crofton_world_cast);
    CROFTON_REFUSE(crofton_world_cast_all);
    CROFTON_REFUSE(crofton_world_manifolds);
    CROFTON_REFUSE(crofton_world_find_occluders);
    CROFTON_REFUSE(crofton_world_set_occluders);
    CROFTON_REFUSE(crofton_world_get_occluder);
}

void refuse_results(Table& table) {
    CROFTON_REFUSE(crofton_view_result_destroy);
    CROFTON_REFUSE(crofton_view_result_ids);
    CROFTON_REFUSE(crofton_view_result_list);
    CROFTON_REFUSE(crofton_view_result_get_view);
    CROFTON_REFUSE(crofton_view_result_occluders);
    CROFTON_REFUSE(crofton_view_boxes);
    CROFTON_REFUSE(crofton_found_destroy);
    CROFTON_REFUSE(crofton_found_objects);
    CROFTON_REFUSE(crofton_found_hits);
    CROFTON_REFUSE(crofton_found_shape_hits);
    CROFTON_REFUSE(crofton_found_manifolds);
    CROFTON_REFUSE(crofton_view_result_depth);
}

void refuse_modules_changes(Table& table) {
    CROFTON_REFUSE(crofton_scene_destroy);
    CROFTON_REFUSE(crofton_scene_add_mesh);
    CROFTON_REFUSE(crofton_scene_add_node);
    CROFTON_REFUSE(crofton_scene_add_instance);
    CROFTON_REFUSE(crofton_scene_set_local);
    CROFTON_REFUSE(crofton_scene_set_layer_mask);
    CROFTON_REFUSE(crofton_scene_remove_instance);
    CROFTON_REFUSE(crofton_scene_update);
    CROFTON_REFUSE(crofton_scene_boxes);
    CROFTON_REFUSE(crofton_scene_moved);
    CROFTON_REFUSE(crofton_tree_destroy);
    CROFTON_REFUSE(crofton_tree_move);
    CROFTON_REFUSE(crofton_tree_insert);
    CROFTON_REFUSE(crofton_tree_remove);
    CROFTON_REFUSE(crofton_tree_set_layer_mask);
    CROFTON_REFUSE(crofton_tree_refit);
    CROFTON_REFUSE(crofton_broadphase_destroy);
    CROFTON_REFUSE(crofton_broadphase_update);
    CROFTON_REFUSE(crofton_broadphase_pairs);
    CROFTON_REFUSE(crofton_broadphase_get_statistics);
}

void refuse_modules_queries(Table& table) {
    CROFTON_REFUSE(crofton_shape_destroy);
    CROFTON_REFUSE(crofton_shape_get_info);
    CROFTON_REFUSE(crofton_shape_get_mass);
    CROFTON_REFUSE(crofton_shape_contacts_destroy);
    CROFTON_REFUSE(crofton_shape_contacts_update);
    CROFTON_REFUSE(crofton_shape_contacts_outline);
    CROFTON_REFUSE(crofton_meshes_relate);
    CROFTON_REFUSE(crofton_meshes_contacts);
    CROFTON_REFUSE(crofton_tree_view);
    CROFTON_REFUSE(crofton_tree_overlap);
    CROFTON_REFUSE(crofton_tree_raycast);
    CROFTON_REFUSE(crofton_triangulator_destroy);
    CROFTON_REFUSE(crofton_triangulate);
    CROFTON_REFUSE(crofton_scene_bake);
    CROFTON_REFUSE(crofton_baked_scene_destroy);
    CROFTON_REFUSE(crofton_baked_scene_mesh_count);
    CROFTON_REFUSE(crofton_baked_scene_mesh);
    CROFTON_REFUSE(crofton_baked_scene_clusters);
    CROFTON_REFUSE(crofton_baked_scene_instances);
    CROFTON_REFUSE(crofton_baked_scene_nodes);
    CROFTON_REFUSE(crofton_region_index_destroy);
    CROFTON_REFUSE(crofton_region_index_files);
    CROFTON_REFUSE(crofton_region_index_prepare);
    CROFTON_REFUSE(crofton_pvs_destroy);
    CROFTON_REFUSE(crofton_pvs_counts);
    CROFTON_REFUSE(crofton_pvs_find_cell);
    CROFTON_REFUSE(crofton_pvs_visible);
}

void refuse_depth(Table& table) {
    CROFTON_REFUSE(crofton_clustered_mesh_destroy);
    CROFTON_REFUSE(crofton_clustered_mesh_lend);
    CROFTON_REFUSE(crofton_clustered_mesh_get);
    CROFTON_REFUSE(crofton_clustered_mesh_box);
    CROFTON_REFUSE(crofton_clustered_mesh_serialise);
    CROFTON_REFUSE(crofton_depth_culler_destroy);
    CROFTON_REFUSE(crofton_depth_culler_find_visible);
    CROFTON_REFUSE(crofton_depth_culler_find_casters);
    CROFTON_REFUSE(crofton_depth_culler_nearness);
}

// Calls without a handle, or with one inside a struct or an array: other tests are theirs.
const std::set<std::string> kWithoutHandle = {
    "api_version",
    "baked_region_open",
    "baked_scene_open",
    "baked_scene_read",
    "shapes_cast",
    "shapes_distance",
    "shapes_manifold",
    "shapes_meet",
    "shapes_penetration",
    "shape_closest_point",
    "shape_contacts_create",
    "shape_create",
    "shape_create_with_jobs",
    "shape_outline",
    "shape_parts_near",
    "shape_raycast",
    "shape_raycast_any",
    "box_raycast",
    "box_transform",
    "boxes_distance",
    "boxes_manifold",
    "boxes_meet",
    "boxes_validate",
    "broadphase_create",
    "classify",
    "clustered_mesh_create",
    "clustered_mesh_deserialise",
    "criterion_for_frustum",
    "criterion_for_rays",
    "default_shape_description",
    "default_baked_region_options",
    "default_camera",
    "default_cast_options",
    "default_depth_object",
    "default_depth_receivers",
    "default_draw_limits",
    "default_find_options",
    "default_fit_options",
    "default_manifold_options",
    "default_mesh_data",
    "default_object_description",
    "default_occlusion_options",
    "default_picture_view",
    "default_query_filter",
    "default_region_object",
    "default_region_options",
    "default_shadow_receivers",
    "default_view_matrix",
    "default_view_request",
    "default_world_options",
    "depth_culler_create",
    "draw_limits_of_camera",
    "fit_boxes",
    "fit_points",
    "found_create",
    "frustum_from_camera",
    "frustum_from_matrix",
    "last_error",
    "last_error_item",
    "log",
    "permute_triangles",
    "pvs_open",
    "pvs_read",
    "region_index_open",
    "region_prepare",
    "scene_create",
    "set_assert_hook",
    "set_log_hook",
    "set_memory_hooks",
    "set_thread_checks",
    "status_name",
    "tree_create",
    "triangulator_create",
    "version_string",
    "view_result_create",
    "world_create",
};

}  // namespace

TEST_SUITE("capi/wrong handles") {
    TEST_CASE("every call refuses NULL, what has been destroyed, and handles of another kind, and changes nothing") {
        Sound sound;
        sound.fill();
        Table table(sound);
        refuse_world_changes(table);
        refuse_world_queries(table);
        refuse_results(table);
        refuse_modules_changes(table);
        refuse_modules_queries(table);
        refuse_depth(table);
        CHECK(table.nothing_is_changed());
        sound.check_contents();

        std::size_t calls = 0;
        for (const char* list : {CROFTON_CAPI_SYMBOLS, CROFTON_BAKE_CAPI_SYMBOLS}) {
            std::ifstream symbols(list);
            REQUIRE(symbols);
            for (std::string name; std::getline(symbols, name);)
                if (name.rfind("crofton_", 0) == 0) {
                    CAPTURE(name);
                    CHECK(table.names().count(name) + kWithoutHandle.count(name.substr(8)) == 1);
                    ++calls;
                }
        }
        CHECK(calls == table.names().size() + kWithoutHandle.size());
    }

    TEST_CASE("shapes that stand nowhere, are none, or are of another kind are refused") {
        Sound sound;
        auto distance = sized<crofton_shape_distance>();
        distance.distance = 42.0;
        const crofton_placed nowhere{sound.shape.get(), nullptr}, none{nullptr, &sound.pose},
            other{reinterpret_cast<const crofton_shape*>(sound.scene.get()), &sound.pose};
        const auto ask = [&](const crofton_placed* a, const crofton_placed* b) {
            return crofton_shapes_distance(a, b, nullptr, &distance);
        };
        for (const auto& [wrong, status] :
             {std::pair(&nowhere, CROFTON_INVALID_ARGUMENT), std::pair(&none, CROFTON_BAD_HANDLE),
              std::pair(&other, CROFTON_BAD_HANDLE),
              std::pair<const crofton_placed*, crofton_status>(nullptr, CROFTON_BAD_HANDLE)}) {
            CHECK(ask(wrong, &sound.placed) == status);
            CHECK(ask(&sound.placed, wrong) == status);
        }
        CHECK(distance.distance == 42.0);
        CHECK(ask(&sound.placed, &sound.placed) == CROFTON_OK);
        CHECK(distance.distance == 0.0);

        crofton_shape* made = nullptr;
        const std::array<const crofton_shape*, 2> children{sound.shape.get(), nullptr};
        const std::array<crofton_transform, 2> poses{sound.pose, sound.pose};
        CHECK(shape_compound(children.data(), poses.data(), 2, &made) == CROFTON_BAD_HANDLE);
        CHECK(crofton_last_error_item() == 1);
        CHECK(made == nullptr);
    }

    TEST_CASE("with thread checks readers share a handle, and a writer waits for none of them") {
        REQUIRE(crofton_set_thread_checks(1) == CROFTON_OK);
        // The host's job asks the scene again, from the middle of a call that reads it.
        struct Attempt {
            Scene scene = make_scene();
            crofton_status read = CROFTON_INTERNAL, write = CROFTON_INTERNAL;
        } attempt;
        REQUIRE(crofton_scene_update(attempt.scene.get(), nullptr, nullptr) == CROFTON_OK);
        const crofton_jobs jobs{sizeof jobs, &attempt, 1,
                                [](void* user, size_t count, size_t grain, crofton_range_task task, void* data) {
                                    auto& a = *static_cast<Attempt*>(user);
                                    const uint32_t* moved = nullptr;
                                    size_t n = 0;
                                    uint32_t id = 0;
                                    a.read = crofton_scene_moved(a.scene.get(), &moved, &n);
                                    a.write = crofton_scene_add_node(a.scene.get(), CROFTON_NONE, nullptr, 1, &id);
                                    for (size_t i = 0; i < count; i += grain)
                                        task(data, i, i + grain < count ? i + grain : count, 0);
                                }};
        const std::string path = (std::filesystem::temp_directory_path() / "crofton_capi_shared").string();
        CHECK(crofton_scene_bake(attempt.scene.get(), path.c_str(), &jobs) == CROFTON_OK);
        std::filesystem::remove(path);
        CHECK(attempt.read == CROFTON_OK);
        CHECK(attempt.write == CROFTON_BUSY);
        std::uint32_t id = 7;
        CHECK(crofton_scene_add_node(attempt.scene.get(), CROFTON_NONE, nullptr, 1, &id) == CROFTON_OK);
        CHECK(id == 0);
#if !defined(CROFTON_ASSERTS)
        REQUIRE(crofton_set_thread_checks(0) == CROFTON_OK);
#endif
    }
}
