// SPDX-License-Identifier: MIT
// Drives the viewer's window by hand, as it were: real pointer, wheel and keys on a virtual display.
#pragma once
#include "view_run.hpp"

namespace crofton::test {
// A hand is quicker than frames under a sanitizer, which take seconds: there the scripts of the other tests do.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool kHandIsTooQuick = true;
#else
inline constexpr bool kHandIsTooQuick = false;
#endif
}  // namespace crofton::test

#define CROFTON_REQUIRE_XDOTOOL()                                                 \
    CROFTON_REQUIRE_DISPLAY()                                                     \
    if (crofton::test::kHandIsTooQuick) {                                         \
        MESSAGE("skipped: driving by hand needs frames as quick as a release's"); \
        return;                                                                   \
    }                                                                             \
    if (!have("xdotool")) {                                                       \
        MESSAGE("skipped: xdotool is not installed (third_party/install.sh)");    \
        return;                                                                   \
    }

namespace crofton::test {

// `steps` is shell: xdotool's commands, `shoot` for a picture (which also waits until all before it has been seen), and
// $window. The run ends with Escape. Pictures are in the order of their frames.
inline ViewRun drive(const std::string& steps, const std::string& arguments = {}, const std::string& size = "800x600") {
    const std::string out = scratch().file("driven.json"), err = scratch().file("driven_stderr"),
                      folder = scratch().file("driven"), script = scratch().file("drive.sh");
    std::filesystem::remove_all(folder);
    std::filesystem::create_directories(folder);
    std::filesystem::remove(out);
    write_contents(script, "cd '" + folder + "'\n'" CROFTON_CLI "' view --instances 400 --size " + size +
                               " --validation --device cpu --json '" + out + "' " + arguments + " >/dev/null 2>'" +
                               err + "' &\nviewer=$!\n" + R"sh(
pictures() { ls crofton_*.png 2>/dev/null | wc -l; }
shoot() {
    before=$(pictures)
    xdotool key F2
    for try in $(seq 6000); do
        [ "$(pictures)" -gt "$before" ] && return
        kill -0 $viewer 2>/dev/null || exit 8
        sleep 0.05
    done
    exit 9
}
window=$(timeout 120 xdotool search --sync --onlyvisible --name Crofton | head -n 1)
xdotool mousemove 400 300
shoot
)sh" + steps + "\nxdotool key Escape\nwait $viewer\n");
    ViewRun result;
    const int status = std::system(("xvfb-run -a sh '" + script + "' </dev/null").c_str());
    result.run.status = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    result.run.err = contents_of(err);
    result.document = json::parse(contents_of(out), nullptr, false);
    return result;
}

}  // namespace crofton::test
