// SPDX-License-Identifier: MIT
// Calls a function of the C API with each of its handles wrong in turn, and all else as it should be.
#pragma once
#include <algorithm>
#include <array>
#include <set>
#include <tuple>
#include <type_traits>

#include "world_fixture.hpp"

namespace crofton::capi_test {

template <class T, class... All>
inline constexpr bool kIsOneOf = (std::is_same_v<T, All> || ...);
template <class P>
using Pointee = std::remove_const_t<std::remove_pointer_t<P>>;
template <class P>
inline constexpr bool kIsHandle = std::is_pointer_v<P>&&
    kIsOneOf<Pointee<P>, crofton_scene, crofton_tree, crofton_broadphase, crofton_triangulator, crofton_world,
             crofton_view_result, crofton_shape, crofton_shape_contacts, crofton_found, crofton_baked_scene,
             crofton_pvs, crofton_clustered_mesh, crofton_depth_culler, crofton_region, crofton_region_index>;

constexpr unsigned char kUntouched = 0xA5;

// What a call may write to, or read where what it reads does not matter.
struct alignas(64) Room {
    std::array<unsigned char, 1024> bytes;
    Room() { bytes.fill(kUntouched); }
    [[nodiscard]] bool is_untouched() const {
        return std::all_of(bytes.begin(), bytes.end(), [](unsigned char b) { return b == kUntouched; });
    }
};

// Live handles of each kind that a call takes beside another, and input that is right.
struct Sound {
    SmallWorld small;
    Scene scene = make_scene();
    Triangulator triangulator = make_triangulator();
    Tree tree = [] {
        const crofton_box item = box_at(0, 0, -5);
        crofton_tree* made = nullptr;
        REQUIRE(crofton_tree_create(&item, nullptr, 1, nullptr, &made) == CROFTON_OK);
        return Tree(made);
    }();
    VisibleSet visible_set = make_visible_set();
    ShapeHandle shape = [] {
        crofton_shape* made = nullptr;
        REQUIRE(shape_sphere(1.0f, &made) == CROFTON_OK);
        return ShapeHandle(made);
    }();
    RegionOwner region = [] {
        crofton_region* made = nullptr;
        REQUIRE(crofton_region_prepare(nullptr, 0, nullptr, nullptr, &made) == CROFTON_OK);
        return RegionOwner(made);
    }();
    crofton_box box = box_at(0, 0, -5);
    crofton_transform pose = translation(0, 0, 0);
    crofton_placed placed{shape.get(), &pose};
    View view = default_view();
    crofton_object_description description = sized<crofton_object_description>();

    template <class P>
    P handle() {
        using T = Pointee<P>;
        if constexpr (std::is_same_v<T, crofton_world>)
            return small.world.get();
        else if constexpr (std::is_same_v<T, crofton_view_result>)
            return small.visible.get();
        else if constexpr (std::is_same_v<T, crofton_found>)
            return small.found.get();
        else if constexpr (std::is_same_v<T, crofton_tree>)
            return tree.get();
        else if constexpr (std::is_same_v<T, crofton_shape>)
            return shape.get();
        else if constexpr (std::is_same_v<T, crofton_region>)
            return region.get();
        else
            return nullptr;  // never beside another
    }
    template <class P>
    P input(Room& room) {
        using T = Pointee<P>;
        if constexpr (std::is_same_v<T, crofton_box>)
            return &box;
        else if constexpr (std::is_same_v<T, crofton_placed>)
            return &placed;
        else if constexpr (std::is_same_v<T, crofton_object_description>)
            return &description;
        else
            return reinterpret_cast<P>(room.bytes.data());
    }

    // Asked before and after: what stands in the objects.
    void fill() {
        const auto& [world, visible, in_views, found, object] = small;
        REQUIRE(look(world.get(), view, visible.get()) == CROFTON_OK);
        REQUIRE(look_at_many(world.get(), std::span(&view, 1), in_views.get()) == CROFTON_OK);
        REQUIRE(world_overlap(world.get(), &box, nullptr, found.get()) == CROFTON_OK);
        REQUIRE(cull_tree(tree.get(), &view, nullptr, nullptr, visible_set.get()) == CROFTON_OK);
    }
    void check_contents() {
        const auto& [world, visible, in_views, found, object] = small;
        const std::uint32_t* ids = nullptr;
        const crofton_object_ref* objects = nullptr;
        std::size_t count = 0;
        std::uint64_t user = 0;
        CHECK((world_object_count(world.get(), &count) == CROFTON_OK && count == 1));
        CHECK((world_get_user(world.get(), object, &user) == CROFTON_OK && user == 7));
        CHECK((crofton_view_result_ids(visible.get(), &ids, &count, nullptr, nullptr) == CROFTON_OK && count == 1));
        CHECK((crofton_view_result_ids(in_views.get(), &ids, &count, nullptr, nullptr) == CROFTON_OK && count == 1));
        CHECK((crofton_found_objects(found.get(), &objects, &count) == CROFTON_OK && count == 1));
        CHECK((visible_set_items(visible_set.get(), &ids, nullptr, &count) == CROFTON_OK && count == 1));
        std::uint32_t first_node = 7;
        CHECK(crofton_scene_add_node(scene.get(), CROFTON_NONE, nullptr, ~0u, &first_node) == CROFTON_OK);
        CHECK(first_node == 0);
    }
};

class Table {
  public:
    explicit Table(Sound& sound) : sound_(sound) { nothing_.bytes.fill(0); }

    template <class... P>
    void refuse(const char* name, crofton_status (*call)(P...)) {
        names_.insert(name);
        constexpr std::array<bool, sizeof...(P)> handles{kIsHandle<P>...};
        static_assert((kIsHandle<P> || ...));
        for (std::size_t place = 0; place < sizeof...(P); ++place)
            for (int wrong = 0; handles[place] && wrong < 3; ++wrong)
                try_one(name, call, place, wrong, std::index_sequence_for<P...>());
    }
    [[nodiscard]] const std::set<std::string>& names() const { return names_; }
    // A destroyed handle has no kind; nothing has been written to it.
    [[nodiscard]] bool nothing_is_changed() const { return nothing_.bytes == std::array<unsigned char, 1024>{}; }

  private:
    template <class... P, std::size_t... I>
    void try_one(const char* name, crofton_status (*call)(P...), std::size_t place, int wrong,
                 std::index_sequence<I...>) {
        CAPTURE(name);
        CAPTURE(place);
        CAPTURE(wrong);
        std::array<Room, sizeof...(P)> rooms;
        CHECK(call(argument<P>(I == place, wrong, rooms[I])...) == CROFTON_BAD_HANDLE);
        CHECK(std::all_of(rooms.begin(), rooms.end(), [](const Room& r) { return r.is_untouched(); }));
        const std::string reason =
            wrong == 0 ? "the handle is NULL" : "not a handle of this kind, or destroyed already";
        CHECK(crofton_last_error() == name + (": " + reason));
        CHECK(crofton_last_error_item() == CROFTON_NO_ITEM);
    }
    template <class P>
    P argument(bool is_wrong, int wrong, Room& room) {
        if constexpr (kIsHandle<P>)
            return is_wrong ? wrong_handle<P>(wrong) : sound_.handle<P>();
        else if constexpr (std::is_pointer_v<P> && std::is_const_v<std::remove_pointer_t<P>>)
            return sound_.input<P>(room);
        else if constexpr (std::is_pointer_v<P>)
            return reinterpret_cast<P>(room.bytes.data());
        else
            return P{};
    }
    template <class P>
    P wrong_handle(int wrong) {
        if (wrong == 0) return nullptr;
        if (wrong == 1) return reinterpret_cast<P>(nothing_.bytes.data());
        if constexpr (std::is_same_v<Pointee<P>, crofton_scene>)
            return reinterpret_cast<P>(sound_.triangulator.get());
        else
            return reinterpret_cast<P>(sound_.scene.get());
    }

    Sound& sound_;
    Room nothing_;
    std::set<std::string> names_;
};

}  // namespace crofton::capi_test
