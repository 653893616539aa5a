// SPDX-License-Identifier: MIT
// The eye's cell and its potentially visible set, hulls and manifolds, in pictures and numbers.
#include "view_run.hpp"

using namespace crofton::test;

namespace {

// A closed wall of 8 × 8 × 1 m across the view, a triangle behind it and one beside it.
std::string yard_obj() {
    std::string text = "o wall\n";
    for (int i = 0; i < 8; ++i)
        text += std::string("v ") + ((i & 1) != 0 ? "4 " : "-4 ") + ((i & 2) != 0 ? "4 " : "-4 ") +
                ((i & 4) != 0 ? "0.5\n" : "-0.5\n");
    text += "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
    return text + "o behind\nv -1 -1 -6\nv 1 -1 -6\nv 0 1 -6\nf 9 10 11\n" +
           "o beside\nv 7 -1 -6\nv 9 -1 -6\nv 8 1 -6\nf 12 13 14\n";
}
const json kYardEye{{"position", {0, 0, 10}}, {"forward", {0, 0, -1}}};

int cyan(const char* name) {
    return Pixels(scratch().file(name)).near(80, 255, 255, 8);
}

}  // namespace

TEST_SUITE("viewer/visible_set") {
    TEST_CASE("objects proved hidden from the eye's cell are magenta, and visible only from elsewhere") {
        const std::string scene = scratch().file("yard.obj"), cells = scratch().file("cells.txt"),
                          sets = scratch().file("sets.crofton");
        write_contents(scene, yard_obj());
        write_contents(cells, "-0.5 -0.5 9.5 0.5 0.5 10.5\n");
        const CliRun baked = run_cli("pvs " + scene + " --cells " + cells + " --out " + sets + " --json -");
        REQUIRE(baked.status == 0);
        const ViewRun run =
            view({{{"frame", 0}, {"camera", kYardEye}},
                  set(0, {{"panels", false}, {"coloring", "visible-set"}}),
                  shot(1, "in_cell.png"),
                  {{"frame", 2}, {"key", "F"}},
                  {{"frame", 3}, {"camera", {{"position", {12, 2, -14}}, {"forward", {-0.6, -0.1, 0.8}}}}},
                  shot(4, "from_behind.png"),
                  {{"frame", 5}, {"key", "F"}},
                  shot(6, "no_cell.png")},
                 "'" + scene + "' --baked '" + sets + "'", false);
        check_clean(run);
        const json &in_cell = picture(run, "in_cell.png"), &behind = picture(run, "from_behind.png");
        CHECK(tinted(in_cell, "seen from the cell") == 2);
        CHECK(tinted(in_cell, "proved hidden") == 1);
        CHECK(in_cell["visible_set"] == json{{"cell", 0}, {"kind", "open"}, {"seen", 2}, {"unseen", 0}, {"hidden", 1}});
        const Pixels eye(scratch().file("in_cell.png")), back(scratch().file("from_behind.png"));
        CHECK(eye.green() > 5000);
        CHECK(eye.magenta() == 0);
        CHECK(back.magenta() > 100);
        CHECK(back.green() > 1000);
        CHECK(behind["visible_set"] == in_cell["visible_set"]);
        CHECK(behind["lines"] == 24);  // the cell, and the view that culls
        CHECK(cyan("from_behind.png") > 10);
        const json& outside = picture(run, "no_cell.png");
        CHECK_FALSE(outside.contains("visible_set"));
        CHECK(tinted(outside, "in no set") == outside["statistics"]["visible"]);
        const Pixels grey(scratch().file("no_cell.png"));
        CHECK(grey.green() + grey.magenta() + grey.amber() == 0);
        CHECK(cyan("no_cell.png") == 0);
    }
    TEST_CASE("without sets everything is grey, and the panel says what to do") {
        const ViewRun run =
            view({set(0, {{"paused", true}, {"coloring", "visible-set"}}), shot(2, "none.png")}, {}, false);
        check_clean(run);
        const json& none = picture(run, "none.png");
        CHECK(tinted(none, "in no set") == none["statistics"]["visible"]);
        CHECK_FALSE(none.contains("visible_set"));
    }
}

TEST_SUITE("viewer/hulls") {
    TEST_CASE("hulls of what is visible are drawn in orange, with the manifolds of movers that meet") {
        const ViewRun run = view({set(0, {{"panels", false}, {"paused", true}}),
                                  {{"frame", 0}, {"key", "Home"}},
                                  shot(1, "plain.png"),
                                  {{"frame", 2}, {"key", "U"}},
                                  shot(3, "hulls.png"),
                                  {{"frame", 4}, {"key", "K"}},
                                  shot(5, "no_pairs.png"),
                                  {{"frame", 6}, {"key", "U"}},
                                  {{"frame", 6}, {"key", "K"}},
                                  shot(7, "again.png")},
                                 {}, false);
        check_clean(run);
        const auto orange = [](const char* name) { return Pixels(scratch().file(name)).near(255, 165, 40, 10); };
        const json &hulls = picture(run, "hulls.png"), &none = picture(run, "no_pairs.png");
        const auto visible = hulls["statistics"]["visible"].get<std::uint64_t>();
        const auto shown = hulls["hulls"].get<std::uint64_t>();
        CHECK(shown <= std::min<std::uint64_t>(visible, 400));
        CHECK(2 * shown > std::min<std::uint64_t>(visible, 400));  // what is flat has none
        CHECK(orange("plain.png") < 20);
        CHECK(orange("hulls.png") > 1000);
        const auto pairs = hulls["statistics"]["colliding_pairs"].get<std::uint64_t>();
        const auto points = hulls["manifold_points"].get<std::uint64_t>();
        REQUIRE(pairs > 0);
        CHECK(points > 0);
        CHECK(points <= 4 * pairs);
        CHECK(none["manifold_points"] == 0);
        CHECK(none["hulls"] == shown);
        CHECK(none["lines"] < hulls["lines"]);
        CHECK(Pixels(scratch().file("again.png")).different(Pixels(scratch().file("plain.png"))) == 0);
    }
}
