// SPDX-License-Identifier: MIT
#include "viewer.hpp"

#include "session.hpp"

namespace crofton::viewer {

Result<void> run_viewer(const ViewerOptions& options) {
    Session session(options);
    if (auto started = session.start(); !started) return started;
    while (session.running())
        if (auto turned = session.run_frame(); !turned) return turned;
    return session.finish();
}

}  // namespace crofton::viewer
