// SPDX-License-Identifier: MIT
// Every call of Vulkan fails once, at the viewer's start and while it runs: a message that names the call, the right
// exit status, and nothing lost.
#include <set>
#include <sstream>

#include "view_run.hpp"

using namespace crofton::test;

#ifdef CROFTON_FAILING_LAYER_FOLDER
namespace {

struct FailingRun {
    CliRun run;
    std::string failed;  // the call's name; empty: fewer calls were made
    json document;
};

std::string scene_obj() {
    return "o wall\nv -4 -4 0\nv 4 -4 0\nv 4 4 0\nv -4 4 0\nf 1 2 3\nf 1 3 4\n";
}

// Call `number` gives `result`, of a run with panels, a second picture and a change of size.
FailingRun fail_call(long number, int result, bool window, const std::string& name = {}) {
    const std::string scene = scratch().file("scene.obj"), out = scratch().file("failing.json"),
                      log = scratch().file("failed_call"), script = scratch().file("failing_script.json"),
                      err = scratch().file("failing_stderr");
    write_contents(scene, scene_obj());
    write_contents(script, json{{"events",
                                 {{{"frame", 0}, {"set", {{"inset", true}, {"paused", true}}}},
                                  {{"frame", 1}, {"key", "R"}},
                                  {{"frame", 2}, {"resize", {80, 60}}},
                                  shot(3, "failing.png"),
                                  {{"frame", 4}, {"key", "R"}}}}}
                               .dump());
    std::filesystem::remove(out);
    std::filesystem::remove(log);
    std::filesystem::remove(scratch().file("failing.png"));
    std::filesystem::remove(scratch().file("camera_path.json"));
    const std::string environment = "VK_LAYER_PATH='" CROFTON_FAILING_LAYER_FOLDER
                                    "' VK_INSTANCE_LAYERS=VK_LAYER_CROFTON_failing CROFTON_FAIL_LOG='" +
                                    log + "' CROFTON_FAIL_CALL=" + std::to_string(number) +
                                    " CROFTON_FAIL_RESULT=" + std::to_string(result) + " CROFTON_FAIL_NAME=" + name;
    // The viewer's own status: xvfb-run has mistakes of its own to tell.
    const std::string shell = scratch().file("failing.sh"), status = scratch().file("failing_status");
    write_contents(shell, environment + " '" CROFTON_CLI "' view '" + scene + "' --size 64x48 --device cpu --output '" +
                              scratch().file("") + "' --script '" + script + "' --json '" + out + "' " +
                              (window ? "" : "--no-window ") + ">/dev/null 2>'" + err + "'\necho $? >'" + status +
                              "'\n");
    std::filesystem::remove(status);
    FailingRun failing;
    failing.run.status = -1;
    const std::string command = (window ? "xvfb-run -a sh '" : "sh '") + shell + "' >/dev/null 2>&1 </dev/null";
    const int ran = std::system(command.c_str());
    static_cast<void>(ran);
    if (std::filesystem::exists(status)) std::istringstream(contents_of(status)) >> failing.run.status;
    failing.run.err = contents_of(err);
    if (std::filesystem::exists(log)) std::istringstream(contents_of(log)) >> failing.failed;
    if (std::filesystem::exists(out)) failing.document = json::parse(contents_of(out), nullptr, false);
    return failing;
}

constexpr int kNoMemory = -2, kLost = -4;

// Calls fail in turn, every `step`-th; all where CROFTON_FAIL_EVERY is set (.ci/long). Returns the names of those that
// failed.
std::set<std::string> check_all(int result, const char* result_name, long step, bool window) {
    if (std::getenv("CROFTON_FAIL_EVERY") != nullptr) step = 1;
    const FailingRun sound = fail_call(-1, result, window);
    INFO(sound.run.err);
    REQUIRE(sound.run.status == 0);
    REQUIRE(sound.failed.empty());
    const Pixels expected(scratch().file("failing.png"));
    const std::string path = contents_of(scratch().file("camera_path.json"));
    std::set<std::string> names;
    int at_start = 0, mid_run = 0;
    for (long n = 0;; n += step) {
        const FailingRun failing = fail_call(n, result, window);
        if (failing.failed.empty()) break;
        names.insert(failing.failed);
        CAPTURE(n);
        CAPTURE(failing.failed);
        CAPTURE(failing.run.err);
        CHECK(failing.run.err.find(failing.failed) != std::string::npos);
        CHECK(failing.run.err.find(result_name) != std::string::npos);
        REQUIRE((failing.run.status == 0 || failing.run.status == 2));
        if (failing.run.status == 2) {
            // Before the first frame there is nothing to keep.
            CHECK(mid_run == 0);
            ++at_start;
            continue;
        }
        ++mid_run;
        CHECK(Pixels(scratch().file("failing.png")).different(expected) == 0);
        CHECK(contents_of(scratch().file("camera_path.json")) == path);
        REQUIRE(failing.document.is_object());
        CHECK(failing.document["frames"].size() == sound.document["frames"].size());
    }
    MESSAGE(at_start << " calls failed at the start, " << mid_run << " while it ran, of " << names.size() << " kinds");
    CHECK(at_start > 100 / step);
    CHECK(mid_run > 50 / step);
    return names;
}

}  // namespace

TEST_SUITE("viewer/failing_calls") {
    TEST_CASE("each call fails once: named at the start, made good while it runs, and the picture is the same") {
        const auto names = check_all(kNoMemory, "VK_ERROR_OUT_OF_DEVICE_MEMORY", 7, false);
        CHECK(names.size() > 10);
    }
    TEST_CASE("the viewer recreates a lost device, whichever call reports it") {
        check_all(kLost, "VK_ERROR_DEVICE_LOST", 11, false);
    }
    TEST_CASE("calls of a window fail, too") {
        CROFTON_REQUIRE_DISPLAY();
        check_all(kNoMemory, "VK_ERROR_OUT_OF_DEVICE_MEMORY", 37, true);
    }
    TEST_CASE("a shader that fails names its stage") {
        std::set<std::string> stages;
        for (long n = 0;; ++n) {
            const FailingRun failing = fail_call(n, kNoMemory, false, "vkCreateShaderModule");
            if (failing.failed.empty()) break;
            CAPTURE(failing.run.err);
            CHECK(failing.run.status == 2);
            const std::size_t named = stages.size();
            for (const char* stage : {"vertex", "fragment"})
                if (failing.run.err.find(std::string("vkCreateShaderModule of the ") + stage + " shader") !=
                    std::string::npos)
                    stages.insert(stage + std::to_string(n));
            CHECK(stages.size() == named + 1);
        }
        CHECK(stages.size() >= 4);  // two stages, of the scene and of the panels
    }
}
#endif
