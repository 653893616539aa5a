// SPDX-License-Identifier: MIT
// Ctrl-C and SIGTERM: every command ends within two seconds, with what there is, and says how far it is before.
#include <doctest/doctest.h>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <thread>

#include "child.hpp"
#include "run_cli.hpp"

using namespace crofton::test;

namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

// What is promised is 2 s on an idle machine. A busy one takes longer, and less processor time than that.
constexpr double kPromised = 2.0, kBusy = 1.0, kAlways = 20.0;

struct Ended {
    int status = 0;
    double seconds = 0.0, processor_seconds = 0.0;  // from the signal to the end
    std::string out, err;
};

// Signals after this time, or before it once the command's standard error has these words.
Ended end_after(const std::vector<std::string>& arguments, milliseconds wait, int signal,
                const std::string& told = {}) {
    const std::string out = scratch().file("ended.out"), err = scratch().file("ended.err");
    std::filesystem::remove(err);  // what an earlier command said there does not count
    const Child child(arguments, out, err);
    if (told.empty()) std::this_thread::sleep_for(wait);
    for (const auto end = Clock::now() + wait; !told.empty() && Clock::now() < end;) {
        if (contents_of(err).find(told) != std::string::npos) break;
        std::this_thread::sleep_for(milliseconds(50));
    }
    const auto start = Clock::now();
    const double used = child.processor_seconds();
    child.signal(signal);
    const Child::Exit exit = child.wait();
    Ended ended;
    ended.status = exit.status;
    ended.seconds = std::chrono::duration<double>(Clock::now() - start).count();
    ended.processor_seconds = exit.processor_seconds - used;
    ended.out = contents_of(out);
    ended.err = contents_of(err);
    return ended;
}

void check_ended(const Ended& ended) {
    CHECK(ended.status == 130);
    CHECK(ended.seconds < kAlways);
    CHECK(std::min(ended.seconds, ended.processor_seconds) < kPromised + kBusy);
    CHECK_MESSAGE(ended.err.find("interrupted") != std::string::npos, ended.err);
}

std::string fresh(const std::string& name) {
    const std::string folder = scratch().file(name);
    std::filesystem::remove_all(folder);
    std::filesystem::create_directories(folder);
    return folder;
}

std::size_t files_in(const std::string& folder) {
    std::size_t count = 0;
    for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(folder)) ++count;
    return count;
}

// Points on a sphere, all of which count, and a smooth ring: both take minutes.
std::string sphere_file() {
    std::string text;
    for (int i = 0; i < 30'000; ++i) {
        const double y = 1.0 - (2.0 * i + 1.0) / 30'000, r = std::sqrt(1.0 - y * y), a = 2.399963229728653 * i;
        text += "v " + std::to_string(r * std::cos(a)) + " " + std::to_string(y) + " " +
                std::to_string(r * std::sin(a)) + "\n";
    }
    const std::string path = scratch().file("sphere.obj");
    write_contents(path, text + "f 1 2 3\n");
    return path;
}

std::string ring_file() {
    constexpr int kPoints = 12'000;
    std::string text = "P ring 1\n" + std::to_string(kPoints);
    for (int i = 0; i < kPoints; ++i) {
        const double a = 2.0 * 3.141592653589793 * i / kPoints, r = 1.0 + 0.05 * std::sin(3.0 * a);
        text += " " + std::to_string(r * std::cos(a)) + " " + std::to_string(r * std::sin(a));
    }
    const std::string path = scratch().file("ring.poly");
    write_contents(path, text + "\n");
    return path;
}

}  // namespace

TEST_SUITE("cli/interrupt") {
    TEST_CASE("at any time SIGINT and SIGTERM end a command, with status 130 and nothing half written") {
        const std::string folder = fresh("half");
        const std::string out = folder + "/out";
        const std::vector<std::string> commands[] = {
            {"bake", "town", "--instances", "900000", "-o", out},
            {"frames", "town", "--instances", "1000000", "--no-draw", "--json", out},
            {"study", "measure", "room", "--lines", "1000000000000", "--json", out},
            {"study", "factors", "room", "--blocks", "100000", "--json", out},
            {"study", "hierarchy", "--lines", "60000000000", "--json", out},
            {"verify", "--trials", "1000000000", "--json", out},
            {"triangulate", ring_file(), "--work-limit", "1e15", "--svg", out},
            {"pvs", "town", "--cells", "400x4x400", "--epsilon", "1e-6", "--threads", "2"}};
        int signal = SIGINT;
        for (const auto& command : commands) {
            CAPTURE(command[0]);
            check_ended(end_after(command, milliseconds(500), signal));
            for (const auto& entry : std::filesystem::directory_iterator(folder)) {
                CHECK(entry.path().filename() == "out");
                CHECK(entry.file_size() > 0);
                std::filesystem::remove(entry.path());
            }
            signal = signal == SIGINT ? SIGTERM : SIGINT;
        }
        CHECK(files_in(folder) == 0);
    }

    TEST_CASE("pvs that proves ends with what is proved, and the sets can be used") {
        const std::string folder = fresh("proofs");
        const std::string file = folder + "/sets.crofton", json = folder + "/figures.json";
        // Few lines, and proofs for hours.
        const Ended ended = end_after({"pvs",          "town", "--cells",         "40x2x40", "--epsilon",  "0.9",
                                       "--confidence", "0.1",  "--surface-steps", "1000000", "--halvings", "16",
                                       "--near",       "0.05", "--out",           file,      "--json",     json,
                                       "--threads",    "2"},
                                      milliseconds(60'000), SIGTERM, "pvs: proofs: ");
        check_ended(ended);
        CHECK(ended.err.find("crofton: pvs: ") != std::string::npos);  // progress
        CHECK(ended.err.find("count as unseen") != std::string::npos);
        const auto figures = nlohmann::json::parse(contents_of(json), nullptr, false);
        REQUIRE(figures.is_object());
        CHECK(figures.at("unseen").get<double>() > 0.0);
        CHECK(std::filesystem::file_size(file) > 1000);
    }

    TEST_CASE("radiosity drops the run that it is in and writes the light of those before, if there are any") {
        const std::string folder = fresh("light");
        const std::string glb = folder + "/lit.glb";
        const Ended first =
            end_after({"study", "radiosity", "town", "--edge", "0.5", "--out", glb}, milliseconds(4000), SIGINT);
        check_ended(first);
        CHECK_FALSE(std::filesystem::exists(glb));
        const Ended later =
            end_after({"study", "radiosity", "room", "--edge", "0.5", "--lines", "1000000000000", "--out", glb},
                      milliseconds(4000), SIGTERM);
        check_ended(later);
        CHECK(later.err.find("radiosity: 0 % after 2 s") != std::string::npos);
        CHECK(contents_of(glb).substr(0, 4) == "glTF");
        CHECK(files_in(folder) == 1);
    }

    TEST_CASE("radiosity that stores lines, or makes runs to compare with, ends without these and writes the light") {
        const std::string folder = fresh("studies");
        const std::string glb = folder + "/lit.glb", json = folder + "/figures.json", field = folder + "/field.png";
        const std::vector<std::string> bake{"study", "radiosity", "room", "--edge", "2", "--shadow-cuts", "0", "--runs",
                                            "2",     "--out",     glb,    "--json", json};
        const std::vector<std::string> studies[] = {
            {"--reference", "1000000"}, {"--light-field", field, "--stored-lines", "268435456", "--threads", "1"}};
        const char* const begun[] = {"radiosity: reference: ", "radiosity: light field: "};
        const char* const missing[] = {"but no comparison with a reference", "but no light field"};
        for (int k = 0; k < 2; ++k) {
            std::vector<std::string> command = bake;
            command.insert(command.end(), studies[k].begin(), studies[k].end());
            const Ended ended = end_after(command, milliseconds(60'000), SIGTERM, begun[k]);
            check_ended(ended);
            CHECK_MESSAGE(ended.err.find(missing[k]) != std::string::npos, ended.err);
            CHECK(contents_of(glb).substr(0, 4) == "glTF");
            CHECK(nlohmann::json::parse(contents_of(json), nullptr, false).at("runs") == 2);
            CHECK(files_in(folder) == 2);
            std::filesystem::remove(glb);
        }
    }

    TEST_CASE("fit gives the best box so far, with a gap, of several files those that are done") {
        const std::string sphere = sphere_file();
        const Ended one =
            end_after({"fit", sphere, "--criterion", "volume", "--json", "-"}, milliseconds(1500), SIGINT);
        check_ended(one);
        const auto box = nlohmann::json::parse(one.out, nullptr, false);
        CHECK(box.is_object());
        const Ended none = end_after({"fit", sphere, sphere}, milliseconds(1000), SIGINT);
        check_ended(none);
    }

    TEST_CASE("a command that takes longer than two seconds reports its progress on standard error") {
        const Ended ended =
            end_after({"study", "measure", "room", "--lines", "1000000000000"}, milliseconds(3500), SIGINT);
        CHECK(ended.err.find("crofton: measure: 2 s\n") == 0);
        CHECK(ended.out.empty());
        // Where it is known how much there is to do, the time that is left is told as well.
        const Ended frames = end_after({"frames", "room", "--no-draw", "--frames", "1000000", "--json", "-"},
                                       milliseconds(3500), SIGINT);
        const std::size_t told = frames.err.find(" % after 2 s, about ");
        REQUIRE(told != std::string::npos);
        CHECK(frames.err.find(" left\n", told) != std::string::npos);
        // What is done sooner says nothing.
        CHECK(run_cli("study measure room --lines 1000").err == "");
    }

    TEST_CASE("a signal that comes twice at once, as `timeout` sends it, is one: what there is is written") {
        const std::string folder = fresh("timeout");
        const std::string json = folder + "/out.json";
        const Child child({"frames", "room", "--no-draw", "--frames", "1000000", "--json", json},
                          scratch().file("timeout.out"));
        std::this_thread::sleep_for(milliseconds(1500));
        child.signal(SIGTERM);
        std::this_thread::sleep_for(milliseconds(2));
        child.signal(SIGTERM);
        CHECK(child.wait().status == 130);
        CHECK(nlohmann::json::parse(contents_of(json), nullptr, false).is_object());
    }
}
