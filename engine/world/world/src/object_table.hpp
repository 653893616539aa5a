// SPDX-License-Identifier: MIT
// The data of a World's objects except their boxes. Indices are those of the spatial index.
#pragma once
#include <bit>
#include <crofton/core/error.hpp>
#include <crofton/core/growing_vector.hpp>
#include <crofton/core/memory.hpp>
#include <crofton/world/answers.hpp>
#include <crofton/world/inputs.hpp>
#include <cstring>
#include <span>

#include "rigid.hpp"

namespace crofton::world {

struct Object {
    BoundKind kind = BoundKind::none;  // none: a mesh
    bool alive = false;
    bool shown = true;
    bool occludes = true;  // if its mesh has occluders
    bool only_occludes = false;
    std::uint32_t staged = kNoIndex;  // its entry among the changes that wait for update()
    std::uint32_t layers = ~0u;       // as they will be after the next update
    std::uint32_t collides_with = ~0u;
    std::uint32_t instance = kNoIndex;  // of a mesh, in the scene
    std::uint32_t own_node = kNoIndex;  // that the object alone hangs on
    std::uint32_t mesh = kNoIndex;      // as of the last update
    double radius = 0.0;                // of a sphere
};

// Grows the room by an eighth: what is loaded and then changes a little does not double its memory.
template <class T>
void resize(Vector<T>& items, std::size_t size, const T& value = T()) {
    if (size > items.capacity()) items.reserve(size + size / 8 + 16);
    items.resize(size, value);
}

// Empties lists and gives back their memory.
template <class... Lists>
void release(Lists&... lists) {
    (Lists().swap(lists), ...);
}

// Where the generations of one more World begin. Each World of the process begins elsewhere, far from all others, so
// that a handle of another World is no one's here. The first begins at 1.
[[nodiscard]] std::uint32_t next_first_generation();

// Unlike any other of the process, and not 0.
[[nodiscard]] std::uint64_t next_revision();

// Makes the handles of this generation stale. A handle that is all 0 names nothing: in C that is one that was never
// set.
inline void renew(std::uint32_t& generation) {
    if (++generation == 0) ++generation;
}

// The error of a handle that is not alive. `thing` is what it should name; `generations` are those of this World's
// things, which began at `first`.
[[nodiscard]] Result<void> refuse(const char* thing, std::uint32_t index, std::uint32_t generation,
                                  std::span<const std::uint32_t> generations, std::uint32_t first, std::uint64_t item);

struct ObjectTable {
    explicit ObjectTable(std::uint32_t first) : first_generation(first) {}

    GrowingVector<Object> objects;
    GrowingVector<std::uint32_t> generations;
    GrowingVector<std::uint64_t> users;
    ObjectNames names;  // of these two
    std::uint32_t first_generation;
    std::size_t count = 0;  // alive

    void add(std::uint32_t index, const Object& object, std::uint64_t user) {
        if (index >= objects.size()) {
            const std::size_t more = index + std::size_t{1} - objects.size();
            objects.append(more, Object());
            generations.append(more, first_generation);
            users.append(more, 0);
            show_names();
        }
        objects.set(index, object);
        objects.edit(index).alive = true;
        users.set(index, user);
        ++count;
    }
    void reserve(std::size_t size) {
        objects.reserve_pages(size);
        generations.reserve_pages(size);
        users.reserve_pages(size);
        show_names();
    }
    void make_room(std::size_t more) {
        objects.make_room(more);
        generations.make_room(more);
        users.make_room(more);
        show_names();
    }
    // Handles become stale at once; the index is free once the spatial index has removed it too.
    void remove(std::uint32_t index) {
        objects.edit(index).alive = false;
        renew(generations.edit(index));
        --count;
    }
    // Goes on copying arrays that grow, or ends it.
    void settle() {
        objects.settle();
        generations.settle();
        users.settle();
        show_names();
    }
    void finish() {
        objects.finish();
        generations.finish();
        users.finish();
        show_names();
    }
    void show_names() {
        names.generations = generations.view();
        names.users = users.view();
    }
    [[nodiscard]] bool contains(ObjectHandle handle) const {
        return handle.index < objects.size() && objects[handle.index].alive &&
               generations[handle.index] == handle.generation;
    }
    [[nodiscard]] ObjectHandle handle(std::uint32_t index) const { return {index, generations[index]}; }
    [[nodiscard]] ObjectRef ref(std::uint32_t index) const { return {handle(index), users[index]}; }
};

// Which objects are boxes in the list of what moves, and their entries: all that a call for many of them looks up.
class MoverTable {
  public:
    // The entries of handles[begin … end), up to the first that is another thing or stale, or whose box may not cover
    // its shape. Returns how many.
    std::size_t list_entries(const Strided<ObjectHandle>& handles, const Strided<Obb>& boxes, std::size_t begin,
                             std::size_t end, std::uint32_t* entries) const {
        std::size_t count = 0;
        if (const std::uint32_t first = first_in_row(handles, begin, end); first != kNoIndex)
            for (; count < end - begin; ++count) entries[count] = first + static_cast<std::uint32_t>(count);
        for (std::size_t i = begin + count; i < end; ++i, ++count) {
            const ObjectHandle handle = handles[i];
            const Key* const key = find(handle.index);
            if (key == nullptr || key->generation != handle.generation || key->entry == kNoIndex) break;
            entries[count] = key->entry;
        }
        for (std::size_t n = 0; !least_.empty() && n < count; ++n)
            if (entries[n] < least_.size() && !covers(boxes[begin + n], least_[entries[n]])) return n;
        return count;
    }
    // `least_half_extents` as ObjectShapes tells them. kNoIndex: the object is no such box.
    void set(ObjectHandle handle, std::uint32_t entry, const glm::vec3& least_half_extents) {
        if (entry == kNoIndex) return forget(handle.index);
        const std::size_t page = handle.index / kPage;
        if (page >= pages_.size()) pages_.resize(page + 1);
        if (pages_[page].empty()) pages_[page].resize(kPage);
        pages_[page][handle.index % kPage] = {entry, handle.generation};
        if (entry >= least_.size() && least_half_extents.x >= 0.0f)
            resize(least_, entry + std::size_t{1}, kAnyHalfExtents);
        if (entry < least_.size()) least_[entry] = least_half_extents;
    }
    void forget(std::uint32_t object) {
        if (find(object) != nullptr) pages_[object / kPage][object % kPage].entry = kNoIndex;
    }

  private:
    struct Key {  // as a handle
        std::uint32_t entry = kNoIndex, generation = 0;
    };
    static constexpr std::size_t kPage = 4096;
    static constexpr glm::vec3 kAnyHalfExtents{-1.0f};

    [[nodiscard]] const Key* find(std::uint32_t object) const {
        const std::size_t page = object / kPage;
        return page < pages_.size() && !pages_[page].empty() ? &pages_[page][object % kPage] : nullptr;
    }

    // The entry of the first handle, where all are boxes in the list with consecutive entries and consecutive indices
    // in one page; else kNoIndex.
    [[nodiscard]] std::uint32_t first_in_row(const Strided<ObjectHandle>& handles, std::size_t begin,
                                             std::size_t end) const {
        static_assert(sizeof(ObjectHandle) == 8 && sizeof(Key) == 8 && std::endian::native == std::endian::little);
        const std::size_t count = end - begin;
        if (count == 0 || handles.stride() != sizeof(ObjectHandle)) return kNoIndex;
        const std::uint32_t first = handles[begin].index;
        const Key* const key_of_first = find(first);
        if (key_of_first == nullptr || first % kPage + count > kPage) return kNoIndex;
        const std::uint32_t entry = key_of_first->entry;
        if (entry > kNoIndex - count) return kNoIndex;
        // Without a branch a handle, and as whole words: vectors do it. A handle less its key is the index less the
        // entry, which is that of the first, if generations agree.
        const std::byte* const some = reinterpret_cast<const std::byte*>(&handles[begin]);
        const std::byte* const keys = reinterpret_cast<const std::byte*>(key_of_first);
        std::uint64_t differing = 0;
        for (std::size_t i = 0; i < count; ++i) {
            std::uint64_t handle, key;
            std::memcpy(&handle, some + 8 * i, 8);
            std::memcpy(&key, keys + 8 * i, 8);
            differing |= ((handle - key) ^ (std::uint64_t{first} - entry)) | ((handle ^ (first + i)) & 0xffffffffu);
        }
        return differing == 0 ? entry : kNoIndex;
    }
    [[nodiscard]] static bool covers(const Obb& box, const glm::vec3& least) {
        if (least.x < 0.0f) return true;
        const glm::vec3& half = box.half_extents;
        return half.x >= least.x && half.y >= least.y && half.z >= least.z && is_clearly_rotation(glm::dmat3(box.axes));
    }
    Vector<Vector<Key>> pages_;  // by object; pages without one that has moved are empty
    Vector<glm::vec3> least_;    // by entry, up to the last with a shape
};

[[nodiscard]] inline Sphere sphere_of(const Object& object, const Obb& box) {
    return {box.center, object.radius};
}

}  // namespace crofton::world
