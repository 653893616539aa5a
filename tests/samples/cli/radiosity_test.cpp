// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <cmath>

#include "run_cli.hpp"

using namespace crofton::test;

namespace {

// A closed box whose faces look inward, of one material.
std::string box(const std::string& material) {
    write_contents(scratch().file("box.mtl"), "newmtl m\n" + material);
    const std::string path = scratch().file("box.obj");
    write_contents(path,
                   "mtllib box.mtl\nusemtl m\n"
                   "v 0 0 0\nv 3 0 0\nv 3 1 0\nv 0 1 0\nv 0 0 2\nv 3 0 2\nv 3 1 2\nv 0 1 2\n"
                   "f 1 2 3 4\nf 6 5 8 7\nf 5 1 4 8\nf 2 6 7 3\nf 5 6 2 1\nf 4 3 7 8\n");
    return "'" + path + "'";
}
const char* const kGlowing = "Kd 0.5 0.5 0.5\nKe 1 1 1\n";
// Kd is sRGB; every face gives off 1, so the light is 1/(1 − reflectance) everywhere.
const double kFurnace = 1.0 / (1.0 - std::pow((0.5 + 0.055) / 1.055, 2.4));

std::string common() {
    return " --sun 0 --sky 0 --edge 0.5 ";
}

}  // namespace

TEST_SUITE("cli/radiosity") {
    TEST_CASE("bad input is refused by name and leaves no output behind") {
        const std::string out = scratch().file("bad.json");
        const auto refused = [&](const std::string& arguments, const char* reason) {
            const CliRun run = run_cli(arguments + " --json '" + out + "'");
            CHECK(run.status == 2);
            CHECK_MESSAGE(run.err.find(reason) != std::string::npos, run.err);
            CHECK_FALSE(std::filesystem::exists(out));
        };
        refused("study radiosity '" + scratch().file("missing.obj") + "'", "missing.obj");
        refused("study radiosity " + box(kGlowing) + common() + "--method guess", "guess");
        refused("study radiosity " + box(kGlowing) + common() + "--lines 5 --error 0.1", "--error");
        refused("study radiosity " + box("Kd 0.5 0.5 0.5\n") + common(), "nothing gives light");
        refused("study radiosity " + box("Kd 0.5 0.5 0.5\nKe -1 0 0\n") + common(), "emission");
        const std::string damaged = scratch().file("damaged.state");
        write_contents(damaged, "no checkpoint");
        refused("study radiosity " + box(kGlowing) + common() + "--checkpoint '" + damaged + "'", "damaged.state");
        CHECK(run_cli("study radiosity").status == 2);
    }

    TEST_CASE("furnace: every method finds 1/(1 - reflectance), with the emission and reflectance of the file") {
        for (const char* method : {"global", "local", "bundles", "walls"}) {
            const CliRun run =
                run_cli("study radiosity " + box(kGlowing) + common() + "--lines 400000 --json - --method " + method);
            CHECK(run.status == 0);
            const auto report = run.json();
            REQUIRE(report.is_object());
            CHECK(report["method"] == method);
            CHECK(report["lines"].get<double>() >= 400000.0);
            for (const auto& channel : report["mean_radiosity"])
                CHECK(channel.get<double>() == doctest::Approx(kFurnace).epsilon(0.01));
        }
    }

    TEST_CASE("--error runs until the estimated error is reached") {
        const CliRun run = run_cli("study radiosity " + box(kGlowing) + common() + "--error 0.01 --json -");
        CHECK(run.status == 0);
        CHECK(run.json()["relative_error"].get<double>() <= 0.01);
        CHECK(run.json()["runs"].get<int>() >= 2);
    }

    TEST_CASE("interrupted and resumed, or with more threads, a run writes the same bytes") {
        const std::string whole = scratch().file("whole.glb"), resumed = scratch().file("resumed.glb"),
                          threads = scratch().file("threads.glb"), state = scratch().file("run.state");
        const std::string scene = "study radiosity " + box(kGlowing) + common();
        CHECK(run_cli(scene + "--lines 300000 --out '" + whole + "'").status == 0);
        CHECK(run_cli(scene + "--lines 150000 --checkpoint '" + state + "'").status == 0);
        CHECK(run_cli(scene + "--lines 300000 --checkpoint '" + state + "' --out '" + resumed + "'").status == 0);
        CHECK(run_cli(scene + "--lines 300000 --threads 3 --out '" + threads + "'").status == 0);
        const std::string bytes = contents_of(whole);
        CHECK(bytes.substr(0, 4) == "glTF");
        CHECK(bytes.find("KHR_materials_unlit") != std::string::npos);
        CHECK(bytes == contents_of(resumed));
        CHECK(bytes == contents_of(threads));
        // The state is of this scene only.
        CHECK(run_cli("study radiosity room --checkpoint '" + state + "'").status == 2);
    }

    TEST_CASE("shards merge to the state of one run, a lost one is named, and one given twice counts once") {
        const auto quoted = [](const std::string& name) { return "'" + scratch().file(name) + "'"; };
        const std::string base = "study radiosity " + box(kGlowing) + common() + "--runs 28 ";
        for (int i = 0; i < 3; ++i)
            REQUIRE(run_cli(base + "--shard " + std::to_string(i) + "/3 --state " + quoted("light" + std::to_string(i)))
                        .status == 0);
        const CliRun one = run_cli(base + "--threads 2 --json - --state " + quoted("one_light"));
        REQUIRE_MESSAGE(one.status == 0, one.err);
        CHECK(one.json().at("runs") == 28);
        CHECK(one.json().at("runs_planned") == 28);
        CHECK(one.json().at("mean_radiosity")[0].get<double>() == doctest::Approx(kFurnace).epsilon(0.01));
        const CliRun lost =
            run_cli("merge " + quoted("light0") + " " + quoted("light2") + " --shards 3 --out " + quoted("light_sum"));
        CHECK(lost.status == 1);
        CHECK_MESSAGE(lost.err.find("runs are missing; run again: --shard 1/3") != std::string::npos, lost.err);
        CHECK(run_cli("merge " + quoted("light2") + " " + quoted("light0") + " " + quoted("light1") + " " +
                      quoted("light0") + " --shards 3 --out " + quoted("light_sum"))
                  .status == 0);
        CHECK(contents_of(scratch().file("light_sum")) == contents_of(scratch().file("one_light")));
        // The sum is a finished bake: it is only read, and gives the light.
        const CliRun whole = run_cli(base + "--json - --state " + quoted("light_sum"));
        CHECK(whole.json().at("mean_radiosity") == one.json().at("mean_radiosity"));
        CHECK(contents_of(scratch().file("light_sum")) == contents_of(scratch().file("one_light")));

        // 28 runs are four chains: of five parts one has none.
        std::size_t without = 0;
        for (int i = 0; i < 5; ++i) {
            const CliRun part = run_cli(base + "--shard " + std::to_string(i) + "/5 --state " + quoted("fifth"));
            CHECK(part.status == 0);
            CHECK(part.out.find("inf") == std::string::npos);
            without += part.out.find("this part has no runs") != std::string::npos;
            std::filesystem::remove(scratch().file("fifth"));
        }
        CHECK(without == 1);

        REQUIRE(run_cli(base + "--seed 2 --state " + quoted("other_light")).status == 0);
        const CliRun other =
            run_cli("merge " + quoted("light0") + " " + quoted("other_light") + " --out " + quoted("light_sum"));
        CHECK(other.status == 2);
        CHECK_MESSAGE(other.err.find("other") != std::string::npos, other.err);
        CHECK(run_cli(base + "--state " + quoted("other_light")).status == 2);
        write_contents(scratch().file("no_part"), "nothing of the kind");
        const CliRun none =
            run_cli("merge " + quoted("light0") + " " + quoted("no_part") + " --out " + quoted("light_sum"));
        CHECK(none.status == 2);
        CHECK_MESSAGE(none.err.find("no_part") != std::string::npos, none.err);
        for (const char* bad :
             {"--shard 3/3 --state x", "--shard 0/3", "--error 0.1", "--lines 5", "--shard 0/3 --state x --out y.glb"})
            CHECK_MESSAGE(run_cli(base + bad).status == 2, bad);
        CHECK(run_cli("study radiosity " + box(kGlowing) + common() + "--shard 0/3 --state x").status == 2);
    }

    TEST_CASE("--png draws the lit scene") {
        const std::string picture = scratch().file("lit.png");
        CHECK(
            run_cli("study radiosity " + box(kGlowing) + common() + "--lines 100000 --png '" + picture + "'").status ==
            0);
        CHECK(contents_of(picture).substr(1, 3) == "PNG");
    }

    TEST_CASE("--light-field draws from stored lines, and says how far that is from the scene's own picture") {
        const std::string picture = scratch().file("lines.png");
        const std::string room = "study radiosity room --edge 0.5 --lines 300000 --json -";
        const CliRun run = run_cli(room + " --stored-lines 200000 --light-field '" + picture + "'");
        REQUIRE(run.status == 0);
        const auto field = run.json().at("light_field");
        CHECK(field.at("lines").get<double>() == doctest::Approx(200000.0).epsilon(0.15));
        CHECK(field.at("crossings").get<double>() > field.at("lines").get<double>());
        CHECK(field.at("relative_error").get<double>() < 0.3);
        CHECK(field.at("color_error").get<double>() < 0.03);
        CHECK(contents_of(picture).substr(1, 3) == "PNG");
        CHECK(run_cli(room + " --stored-lines 0").status == 2);
        CHECK(run_cli(room).json().at("light_field") == nullptr);
    }
}
