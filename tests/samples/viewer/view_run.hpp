// SPDX-License-Identifier: MIT
// Runs `crofton view` as a user does, under a virtual display of its own, and hands back what it says.
#pragma once
#include <doctest/doctest.h>

#include <cstdlib>

#include "../cli/run_cli.hpp"
#include "pixels.hpp"

namespace crofton::test {

using nlohmann::json;

inline bool have(const char* program) {
    return std::system((std::string("command -v ") + program + " >/dev/null 2>&1").c_str()) == 0;
}

// Runs a script in a window on a virtual display of its own, with validation, and hands back the JSON.
struct ViewRun {
    CliRun run;
    json document;
};

inline ViewRun view(const json& events, const std::string& arguments = {}, bool window = true) {
    const std::string script = scratch().file("script.json"), out = scratch().file("out.json");
    std::filesystem::remove(out);
    write_contents(script, json{{"events", events}}.dump());
    const std::string size = arguments.find("--size") == std::string::npos ? "--size 480x270" : "";
    // The town: any other scene says itself what is in it.
    const bool is_town = arguments.find_first_not_of(" ") == std::string::npos || arguments.find("--") == 0;
    const std::string instances =
        is_town && arguments.find("--instances") == std::string::npos ? "--instances 400 " : "";
    const std::string all = "view " + instances + size + " --validation --device cpu --output '" + scratch().file("") +
                            "' --script '" + script + "' --json '" + out + "' " + (window ? "" : "--no-window ") +
                            arguments;
    ViewRun result;
    const std::string err = scratch().file("view_stderr");
    const std::string command = std::string(window ? "xvfb-run -a " : "") + "'" CROFTON_CLI "' " + all +
                                " >/dev/null 2>'" + err + "' </dev/null";
    const int status = std::system(command.c_str());
    result.run.status = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    result.run.err = contents_of(err);
    result.document = json::parse(contents_of(out), nullptr, false);
    return result;
}

// A clean run: it ended well, every prediction came true, and validation had nothing to say.
inline void check_clean(const ViewRun& result) {
    INFO(result.run.err);
    REQUIRE(result.run.status == 0);
    REQUIRE(result.document.is_object());
    CHECK(result.document["validation_messages"].empty());
    for (const json& frame : result.document["frames"]) {
        CHECK(frame["gpu"]["clipping_primitives"] == frame["triangles_clipped"]);
        CHECK(frame["gpu"]["input_assembly_primitives"] == frame["triangles_submitted"]);
    }
}

inline json shot(int frame, const std::string& name) {
    return {{"frame", frame}, {"screenshot", scratch().file(name)}};
}
inline json set(int frame, const json& switches) {
    return {{"frame", frame}, {"set", switches}};
}

inline const json& picture(const ViewRun& result, const std::string& name) {
    for (const json& entry : result.document["pictures"])
        if (entry["file"] == scratch().file(name)) return entry;
    FAIL("no picture " << name);
    return result.document;
}

// Instances of a picture that have a tint.
inline std::uint64_t tinted(const json& picture, const char* name) {
    for (const json& tint : picture["tints"])
        if (tint["name"] == name) return tint["instances"].get<std::uint64_t>();
    return 0;
}

}  // namespace crofton::test

#define CROFTON_REQUIRE_DISPLAY()                      \
    if (!have("xvfb-run")) {                           \
        MESSAGE("skipped: xvfb-run is not installed"); \
        return;                                        \
    }
