// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <hwy/targets.h>
#include <algorithm>
#include <counting_memory.hpp>
#include <crofton/boxtree/box_tree.hpp>
#include <crofton/core/executor.hpp>
#include <crofton/cull/bound_set.hpp>
#include <crofton/cull/list_layout.hpp>
#include <crofton/geometry/same_bits.hpp>
#include <cstring>
#include <error_of.hpp>
#include <limits>
#include <map>
#include <oracle/random_boxes.hpp>
#include <vector>

#include "../../ranges.hpp"

using namespace crofton;
using boxtree::BoxTree;
using cull::ItemId;
using cull::Verdict;

namespace {

// A tree, what moves beside it, and each item's true box.
struct Crowd {
    BoxTree tree;
    cull::MovingBoxes moving;
    std::vector<ItemId> items;
    std::vector<Obb> boxes;
    std::map<ItemId, Obb> all;

    Crowd(const oracle::Crowd& crowd, std::size_t detached_every) : tree(*BoxTree::build(std::span<const Obb>{})) {
        for (ItemId i = 0; i < crowd.boxes.size(); i += static_cast<ItemId>(detached_every)) items.push_back(i);
        for (const ItemId item : items) boxes.push_back(crowd.boxes[item]);
        tree = *BoxTree::build(crowd.boxes, crowd.layers, {.detached = items});
        for (ItemId i = 0; i < crowd.boxes.size(); ++i) all[i] = crowd.boxes[i];
        REQUIRE(moving.update(tree, items, boxes).has_value());
    }
    void detach(ItemId item) {
        REQUIRE(tree.detach(item).has_value());
        items.push_back(item);
        boxes.push_back(all.at(item));
    }
    ItemId take(std::size_t k) {  // from the items that move
        const ItemId item = items[k];
        items[k] = items.back();
        boxes[k] = boxes.back();
        items.pop_back();
        boxes.pop_back();
        return item;
    }
    std::map<ItemId, Verdict> seen(const cull::View& view, cull::CullMode mode) const {
        std::map<ItemId, Verdict> result;
        for (const auto& [item, box] : all)
            if (tree.layer_masks()[item] & view.layer_mask)
                if (const Verdict verdict = cull::classify(view.frustum, box, mode); verdict != Verdict::outside)
                    result[item] = verdict;
        return result;
    }
};

cull::View view_near(oracle::NearMisses& random, unsigned v) {
    Camera camera = random.camera();
    camera.far_distance = camera.near_distance + random.number(1.0, 60.0);
    return {*frustum_of(camera), v % 3 ? ~0u : 1u << (v % 4)};
}

void check_answers(const Crowd& crowd, std::span<const cull::View> views, Executor& executor) {
    cull::VisibleSet visible, threaded;
    cull::MaskedVisibleSet many;
    for (const cull::CullMode mode : {cull::CullMode::conservative, cull::CullMode::exact}) {
        std::map<ItemId, std::uint32_t> masks;
        for (std::size_t v = 0; v < views.size(); ++v) {
            const std::map<ItemId, Verdict> expected = crowd.seen(views[v], mode);
            for (const auto& [item, verdict] : expected) masks[item] |= 1u << v;
            for (const cull::ResultOrder order : {cull::ResultOrder::ascending, cull::ResultOrder::tree}) {
                cull::find_visible(crowd.tree, crowd.moving, views[v], visible, {mode, order});
                cull::find_visible(crowd.tree, crowd.moving, views[v], threaded, {mode, order}, executor);
                REQUIRE(test::ranges::equal(visible.ids(), threaded.ids()));
                REQUIRE(visible.inside_count() == threaded.inside_count());
                REQUIRE(visible.size() == expected.size());
                for (std::size_t i = 0; i < visible.size(); ++i) {
                    const Verdict verdict = order == cull::ResultOrder::ascending ? visible.verdicts()[i]
                                            : i < visible.inside_count()          ? Verdict::inside
                                                                                  : Verdict::straddling;
                    REQUIRE(expected.at(visible.ids()[i]) == verdict);
                }
                if (order == cull::ResultOrder::ascending) REQUIRE(test::ranges::is_sorted(visible.ids()));
                if (cull::kCountStatistics)
                    CHECK(visible.statistics().straddling == visible.size() - visible.inside_count());
            }
        }
        (void)cull::find_visible(crowd.tree, crowd.moving, views, many, mode);
        REQUIRE(many.size() == masks.size());
        for (std::size_t i = 0; i < many.size(); ++i) REQUIRE(masks.at(many.ids()[i]) == many.view_mask(i));
    }
}

}  // namespace

TEST_SUITE("cull/moving_boxes") {
    TEST_CASE("a box that is not valid is refused by its item's name, and the list answers as before") {
        Crowd crowd(oracle::random_crowd(2000, 0.0, 1), 3);
        const float infinity = std::numeric_limits<float>::infinity();
        const auto spoil = [&](Obb& box, int fault) {
            if (fault == 0) box.center.y = std::nan("");
            if (fault == 1) box.center.z = -1.0000001e30;
            if (fault == 2) box.half_extents.x = infinity;
            if (fault == 3) box.half_extents.y = -1e-20f;
            if (fault == 4) box.half_extents.z = 1.0000001e30f;
            if (fault == 5) box.axes[1][1] = std::nanf("");
            if (fault == 6) box.axes[2][0] = infinity;
            if (fault == 7) box.axes[0] *= 1.0002f;
            if (fault == 8) box.axes[0] = glm::vec3(0.0f);
            if (fault == 9) box.half_extents.y = std::numeric_limits<float>::quiet_NaN();
            if (fault == 10) box.center.x = -std::numeric_limits<double>::infinity();
        };
        for (int fault = 0; fault <= 10; ++fault)
            for (const std::size_t at : {0u, 17u, 400u, 666u}) {
                std::vector<Obb> bad = crowd.boxes;
                for (Obb& box : bad) box.center.x += 7.0;
                spoil(bad[at], fault);
                spoil(bad.back(), fault);
                const auto result = crowd.moving.update(crowd.tree, crowd.items, bad);
                REQUIRE(!result.has_value());
                CHECK(error_of(result).item == crowd.items[at]);
                CHECK(error_of(result).message == error_of(validate(bad[at])).message);
            }
        std::vector<ItemId> others = crowd.items;
        others[5] = 1;  // rests
        CHECK(error_of(crowd.moving.update(crowd.tree, others, crowd.boxes)).item == 1);
        others[5] = 5000;
        CHECK(error_of(crowd.moving.update(crowd.tree, others, crowd.boxes)).item == 5000);
        CHECK(!crowd.moving.update(crowd.tree, std::span(others).first(9), crowd.boxes).has_value());
        oracle::NearMisses random(2);
        const std::vector<cull::View> views{view_near(random, 0), view_near(random, 1), view_near(random, 2)};
        check_answers(crowd, views, serial_executor());
    }

    TEST_CASE("answers are classify's whatever begins to move, rests, comes, goes or changes layers, at every offset") {
        ThreadPool three(3);
        for (const double offset : {0.0, 1e4, 1e6, 1e7})
            for (const std::size_t count : {1u, 300u, 9000u}) {
                Crowd crowd(oracle::random_crowd(count, offset, count), 2);
                oracle::NearMisses random(3, offset);
                for (int frame = 0; frame < 5; ++frame) {
                    std::vector<cull::View> views;
                    for (unsigned v = 0; v < 5; ++v) views.push_back(view_near(random, v));
                    const auto new_box = [&] {
                        return random.index(4) ? oracle::random_box(random, views[0].frustum.origin, 40.0)
                                               : random.box(views[0].frustum, 1e-9, 1e-3);
                    };
                    for (int change = 0; change < 40; ++change) {
                        const ItemId item = random.index(static_cast<unsigned>(crowd.tree.boxes().size()));
                        const bool moves = crowd.tree.is_detached(item);
                        const auto at =
                            static_cast<std::size_t>(test::ranges::find(crowd.items, item) - crowd.items.begin());
                        if (!crowd.all.contains(item)) continue;
                        switch (random.index(5)) {
                            case 0:
                                if (moves) {
                                    crowd.all[item] = new_box();
                                    REQUIRE(crowd.tree.attach(crowd.take(at), crowd.all[item]).has_value());
                                } else {
                                    crowd.detach(item);
                                }
                                break;
                            case 1:
                                if (moves) crowd.take(at);
                                REQUIRE(crowd.tree.remove(item).has_value());
                                crowd.all.erase(item);
                                break;
                            case 2: {
                                const Obb box = new_box();
                                const ItemId fresh = *crowd.tree.insert(box, 1u << random.index(4));
                                crowd.all[fresh] = box;
                                if (random.index(2)) crowd.detach(fresh);
                                break;
                            }
                            case 3:
                                REQUIRE(crowd.tree.set_layer_mask(item, 1u << random.index(4)).has_value());
                                break;
                            default:
                                if (moves) break;
                                crowd.all[item] = new_box();
                                REQUIRE(crowd.tree.move(item, crowd.all[item]).has_value());
                        }
                    }
                    for (std::size_t k = 0; k < crowd.items.size(); ++k)
                        crowd.all[crowd.items[k]] = crowd.boxes[k] = new_box();
                    crowd.tree.refit();
                    (void)crowd.tree.rebuild_step(1000);
                    REQUIRE(crowd.moving.update(crowd.tree, crowd.items, crowd.boxes, three).has_value());
                    check_answers(crowd, views, three);
                }
            }
    }

    TEST_CASE(
        "an update in pieces answers as one of all boxes does, and queries see none of it before it is finished") {
        struct Enemy {
            std::uint32_t health;
            Obb box;
            float speed;
        };
        ThreadPool three(3);
        for (const double offset : {0.0, 1e7})
            for (const std::size_t count : {1u, 300u, 9000u}) {
                Crowd crowd(oracle::random_crowd(count, offset, 40 + count), 1);
                oracle::NearMisses random(41, offset);
                std::size_t staged = 0, refused = 0;
                for (int frame = 0; frame < 6; ++frame) {
                    std::vector<cull::View> views;
                    for (unsigned v = 0; v < 3; ++v) views.push_back(view_near(random, v));
                    const auto new_box = [&] {
                        Obb box = random.index(4) ? oracle::random_box(random, views[0].frustum.origin, 40.0)
                                                  : random.box(views[0].frustum, 1e-9, 1e-3);
                        if (random.index(50) == 0) box.half_extents.x = 2e18f;  // valid, but not for the kernel
                        return box;
                    };
                    std::vector<Obb> next = crowd.boxes;
                    std::vector<std::uint32_t> entries;
                    // Of a chunk's boxes a third is missing, or several hundred.
                    for (std::uint32_t k = 0; k < next.size(); ++k)
                        if (frame % 3 != 2 || random.index(frame == 5 ? 7 : 3)) entries.push_back(k);
                    if (frame % 3 == 1)
                        for (std::size_t k = entries.size(); k > 1; --k)
                            std::swap(entries[k - 1], entries[random.index(static_cast<unsigned>(k))]);
                    for (int twice = 0; twice < 5 && !entries.empty(); ++twice)
                        entries.push_back(entries[random.index(static_cast<unsigned>(entries.size()))]);
                    std::vector<Enemy> game(entries.size());
                    for (Enemy& enemy : game) enemy.box = new_box();
                    for (std::size_t done = 0; done < entries.size();) {
                        const std::size_t piece = std::min<std::size_t>(1 + random.index(300), entries.size() - done);
                        const std::size_t taken =
                            crowd.moving.stage(std::span(entries).subspan(done, piece), &game[done].box, sizeof(Enemy));
                        REQUIRE(taken <= piece);
                        staged += taken;
                        for (std::size_t k = done; k < done + taken; ++k) next[entries[k]] = game[k].box;
                        done += taken;
                        if (taken == piece) continue;
                        ++refused;
                        crowd.moving.unstage(entries[done]);
                        next[entries[done]] = game[done].box;
                        ++done;
                    }
                    check_answers(crowd, views, three);
                    for (int change = 0; change < 9 && frame % 2; ++change) {
                        const auto at = random.index(static_cast<unsigned>(crowd.items.size()));
                        const auto last = static_cast<unsigned>(crowd.items.size());
                        if (change % 3 == 0) {
                            next[at] = new_box();
                            crowd.moving.unstage(at);
                        } else if (change % 3 == 1) {
                            crowd.items.push_back(*crowd.tree.insert_detached(1u << random.index(4)));
                            next.push_back(new_box());
                            crowd.moving.unstage(last);
                        } else if (last > 1) {
                            const ItemId item = crowd.items[at];
                            crowd.items[at] = crowd.items.back();
                            next[at] = next.back();
                            crowd.items.pop_back();
                            next.pop_back();
                            crowd.moving.unstage(at);
                            REQUIRE(crowd.tree.remove(item).has_value());
                            crowd.all.erase(item);
                        }
                    }
                    crowd.boxes.swap(next);
                    for (std::size_t k = 0; k < crowd.items.size(); ++k) crowd.all[crowd.items[k]] = crowd.boxes[k];
                    crowd.moving.finish(crowd.items, crowd.boxes, three);
                    check_answers(crowd, views, three);
                }
                CHECK(staged > 4 * count);
                if (count > 1) CHECK(refused > 0);
            }
    }

    TEST_CASE("boxes that move without turning give the same list to the bit, whatever else changes meanwhile") {
        std::int64_t targets = hwy::SupportedTargets();  // one after the other
        for (const double offset : {0.0, 1e6})
            for (unsigned seed = 0; seed < 12; ++seed) {
                CAPTURE(seed);
                hwy::SetSupportedTargetsForTest(0);
                if (targets == 0) targets = hwy::SupportedTargets();
                hwy::SetSupportedTargetsForTest(targets & -targets);
                targets &= targets - 1;
                const std::size_t count = seed % 3 == 0 ? 5000 : 700;
                Crowd told(oracle::random_crowd(count, offset, 50 + seed), 1),
                    plain(oracle::random_crowd(count, offset, 50 + seed), 1);
                oracle::NearMisses random(51 + seed, offset);
                const auto any = [&] { return random.index(static_cast<unsigned>(told.boxes.size())); };
                const auto same_bytes = [](const auto& a, const auto& b) {
                    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size_bytes()) == 0;
                };
                for (int frame = 0; frame < 60; ++frame) {
                    std::vector<Obb> next = told.boxes;
                    const bool stays = frame % 13 == 5;
                    const auto change = [&](Obb box) {
                        if (stays) return box;
                        box.center += random.number(0.01, 0.2) * random.direction();
                        if (random.index(frame % 4 ? 4000 : 30) == 0)
                            box = oracle::random_box(random, box.center, 20.0);
                        if (random.index(20000) == 0) box.center *= 1e6;           // out of its chunk's frame
                        if (random.index(20000) == 0) box.half_extents.x = 2e18f;  // valid, but not for the kernel
                        return box;
                    };
                    const auto stage = [&](std::size_t first, std::size_t size) {
                        std::vector<std::uint32_t> entries(size);
                        std::vector<Obb> boxes(size);
                        std::vector<std::uint8_t> differs(next.size(), 2);
                        for (std::size_t k = 0; k < size; ++k) {
                            entries[k] = static_cast<std::uint32_t>(first + k);
                            next[first + k] = boxes[k] =
                                change(random.index(3) ? told.boxes[first + k] : next[first + k]);
                        }
                        for (std::size_t done = 0; done < size; ++done) {
                            const auto rest = std::span(entries).subspan(done);
                            const std::size_t taken =
                                told.moving.stage(rest, &boxes[done], sizeof(Obb), told.boxes.data(), differs.data());
                            for (std::size_t k = done; k < done + taken; ++k)
                                REQUIRE(differs[entries[k]] == !have_same_bits(boxes[k], told.boxes[entries[k]]));
                            REQUIRE(plain.moving.stage(rest, &boxes[done], sizeof(Obb)) == taken);
                            done += taken;
                            if (done == size) break;
                            told.moving.unstage(entries[done]);
                            plain.moving.unstage(entries[done]);
                        }
                    };
                    if (frame % 11 != 8) stage(0, next.size());
                    for (int more = 0; more < 3 && frame % 5 == 2; ++more) {  // some twice, at any place
                        const std::size_t first = any();
                        stage(first, std::min<std::size_t>(random.index(200), next.size() - first));
                    }
                    for (int n = 0; n < 3 && frame % 7 == 3; ++n) {
                        const std::size_t at = any();
                        next[at] = oracle::random_box(random, next[at].center, 5.0);
                        told.moving.unstage(at);
                        plain.moving.unstage(at);
                    }
                    if (stays && frame % 2 == 0) {  // nothing has moved
                        told.moving.unstage_all();
                        plain.moving.unstage_all();
                        continue;
                    }
                    // Many go and come back, also where nothing is staged between.
                    const bool all_are_staged = next.size() == count;
                    while (frame % 11 == 7 && next.size() + 40 > count) {
                        next.pop_back();
                        for (Crowd* crowd : {&told, &plain}) crowd->items.pop_back();
                    }
                    while (frame % 11 == 9 && !all_are_staged && next.size() < count) {
                        const auto entry = static_cast<std::uint32_t>(next.size());
                        next.push_back(oracle::random_box(random, next[0].center, 20.0));
                        for (Crowd* crowd : {&told, &plain}) {
                            crowd->items.push_back(entry);
                            crowd->moving.unstage(entry);
                        }
                    }
                    told.boxes = next;
                    plain.boxes = next;
                    told.moving.finish(told.items, told.boxes);
                    plain.moving.finish(plain.items, plain.boxes);
                    REQUIRE(same_bytes(told.moving.set().rows(), plain.moving.set().rows()));
                    REQUIRE(same_bytes(told.moving.set().records(), plain.moving.set().records()));
                    for (std::size_t c = 0; c < told.moving.set().chunks().size(); ++c) {
                        const auto &a = told.moving.set().chunks()[c], &b = plain.moving.set().chunks()[c];
                        REQUIRE(std::equal(a.origin, a.origin + 3, b.origin));
                        REQUIRE(std::equal(a.extent, a.extent + 3, b.extent));
                        REQUIRE(a.quantum == b.quantum);
                        REQUIRE(a.l1_radius == b.l1_radius);
                        REQUIRE(a.largest_radius == b.largest_radius);
                        REQUIRE(a.out_of_frame == b.out_of_frame);
                    }
                }
            }
        hwy::SetSupportedTargetsForTest(0);
    }

    TEST_CASE("an unstaged box leaves nothing behind") {
        Crowd crowd(oracle::random_crowd(5000, 0.0, 42), 1);
        oracle::NearMisses random(43);
        const std::vector<cull::View> views{view_near(random, 0), view_near(random, 1)};
        std::vector<std::uint32_t> entries(crowd.items.size());
        for (std::uint32_t k = 0; k < entries.size(); ++k) entries[k] = k;
        std::vector<Obb> elsewhere = crowd.boxes;
        for (Obb& box : elsewhere) box.center *= -3.0;
        CHECK(crowd.moving.stage(entries, elsewhere.data(), sizeof(Obb)) == entries.size());
        crowd.moving.unstage_all();
        check_answers(crowd, views, serial_executor());
        crowd.moving.finish(crowd.items, crowd.boxes);
        check_answers(crowd, views, serial_executor());
        // The first that is no box ends the staging, whichever place it has among those written together.
        for (std::uint32_t bad = 0; bad < 40; ++bad) {
            Obb spoilt = elsewhere[bad];
            spoilt.axes[0][0] = std::nanf("");
            std::swap(spoilt, elsewhere[bad]);
            CHECK(crowd.moving.stage(entries, elsewhere.data(), sizeof(Obb)) == bad);
            std::swap(spoilt, elsewhere[bad]);
        }
        // update() counts all, whatever has been staged.
        REQUIRE(crowd.moving.update(crowd.tree, crowd.items, crowd.boxes).has_value());
        crowd.moving.finish(crowd.items, crowd.boxes);
        check_answers(crowd, views, serial_executor());
    }

    TEST_CASE("zero, denormal and enormous boxes and views that are not finite get classify's verdicts") {
        Crowd crowd(oracle::random_crowd(5000, 0.0, 4), 1);
        oracle::NearMisses random(5);
        for (std::size_t i = 0; i < 300; ++i) {
            Obb& box = crowd.boxes[11 * i];
            if (i % 5 == 0) box.half_extents = glm::vec3(0.0f);
            if (i % 5 == 1) box.half_extents = glm::vec3(std::numeric_limits<float>::denorm_min());
            if (i % 5 == 2) box.half_extents = glm::vec3(1e30f, 0.0f, 9e29f);
            if (i % 5 == 3) box.center *= 1e28;
            if (i % 5 == 4) box.axes[0][2] += 0.9e-4f;
            if (!validate(box)) box = Obb{};
            crowd.all[crowd.items[11 * i]] = box;
        }
        REQUIRE(crowd.moving.update(crowd.tree, crowd.items, crowd.boxes).has_value());
        std::vector<cull::View> views;
        for (unsigned v = 0; v < 12; ++v) views.push_back(view_near(random, v));
        views[1].frustum.origin *= 1e29;
        views[2].frustum.planes[2].offset = 1e49;
        views[3].frustum.planes[3].offset = -1e31;
        views[4].frustum.planes[0].offset = std::nan("");
        views[5].frustum.planes[2].normal *= 1.5;
        views[6].frustum.plane_count = 0;
        check_answers(crowd, views, serial_executor());
    }

    TEST_CASE(
        "a list that grows, shrinks and gathers elsewhere answers rightly, and allocates nothing once it has been "
        "large") {
        const testing::CountingMemory counting;
        const oracle::Crowd boxes = oracle::random_crowd(20000, 0.0, 6);
        std::vector<ItemId> items(boxes.boxes.size());
        for (ItemId i = 0; i < items.size(); ++i) items[i] = i;
        const BoxTree tree = *BoxTree::build(boxes.boxes, boxes.layers, {.detached = items});
        cull::MovingBoxes moving;
        cull::VisibleSet visible;
        cull::MaskedVisibleSet many;
        oracle::NearMisses random(7);
        std::size_t warm = 0;
        std::vector<Obb> moved = boxes.boxes;
        for (int frame = 0; frame < 24; ++frame) {
            const std::size_t count = frame < 4 ? items.size() : 4096 + random.index(15000);
            for (std::size_t i = 0; i < count; ++i) {
                moved[i].center *= frame % 3 ? 0.2 : 20.0;
                moved[i].center.x += 10.0;
            }
            const auto some = std::span<const Obb>(moved).first(count);
            REQUIRE(moving.update(tree, std::span<const ItemId>(items).first(count), some).has_value());
            std::vector<cull::View> views;
            for (unsigned v = 0; v < 4; ++v) views.push_back(view_near(random, v));
            cull::find_visible(tree, moving, views[0], visible);
            std::size_t expected = 0;
            for (std::size_t i = 0; i < count; ++i)
                expected += (boxes.layers[i] & views[0].layer_mask) != 0 &&
                            cull::classify(views[0].frustum, some[i]) != Verdict::outside;
            CHECK(visible.size() == expected);
            (void)cull::find_visible(tree, moving, views, many);
            if (frame == 5) warm = counting.allocations();
        }
        CHECK(warm > 0);
        CHECK(counting.allocations() == warm);
    }

    TEST_CASE(
        "every instruction set that this machine has gives the same ids in the same order, and the same statistics") {
        std::vector<ItemId> first;
        cull::Statistics cost;
        for (std::int64_t rest = hwy::SupportedTargets(); rest != 0; rest &= rest - 1) {
            hwy::SetSupportedTargetsForTest(rest & -rest);
            const Crowd crowd(oracle::random_crowd(20000, 1e6, 8), 2);
            oracle::NearMisses random(9, 1e6);
            cull::VisibleSet visible;
            std::vector<ItemId> ids;
            cull::Statistics sum;
            for (unsigned v = 0; v < 6; ++v) {
                cull::find_visible(crowd.tree, crowd.moving, view_near(random, v), visible,
                                   {cull::CullMode::exact, cull::ResultOrder::tree});
                ids.insert(ids.end(), visible.ids().begin(), visible.ids().end());
                sum += visible.statistics();
            }
            if (first.empty()) {
                first = ids;
                cost = sum;
            }
            CHECK(ids == first);
            CHECK(sum.boxes_tested == cost.boxes_tested);
            CHECK(sum.false_positives == cost.false_positives);
            CHECK(sum.straddling == cost.straddling);
        }
        hwy::SetSupportedTargetsForTest(0);
        CHECK(first.size() > 100);
    }
}
