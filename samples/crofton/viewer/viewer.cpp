// SPDX-License-Identifier: MIT
#include "viewer.hpp"

#include "session.hpp"

namespace crofton::viewer {

Result<void> run_viewer(const ViewerOptions& options) {
    Session session(options);
    if (auto started = session.start(); !started) return started;
    while (session.running())
        if (auto turned = session.run_frame(); !turned) {
            session.save_what_there_is();
            return turned;
        }
    return session.finish();
}

}  // namespace crofton::viewer
