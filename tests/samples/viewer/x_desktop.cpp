// SPDX-License-Identifier: MIT
// What a desktop does to a window, without a desktop: minimises it, restores it, drops a file on it.
//   x_desktop minimise|restore WINDOW
//   x_desktop drop WINDOW FILE          (the XDND protocol, version 5, as a file manager speaks it)
#include <X11/Xatom.h>
#include <X11/Xlib.h>
#include <X11/Xutil.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>

namespace {

class Desktop {
  public:
    explicit Desktop(Display* display) : display_(display) {
        source_ = XCreateSimpleWindow(display_, DefaultRootWindow(display_), 0, 0, 1, 1, 0, 0, 0);
    }

    // As a window manager does (ICCCM 4.1.4): the state says iconic, and the window is unmapped.
    void set_minimised(Window window, bool minimised) {
        const long state[2] = {minimised ? IconicState : NormalState, None};
        if (!minimised) XMapWindow(display_, window);
        XChangeProperty(display_, window, atom("WM_STATE"), atom("WM_STATE"), 32, PropModeReplace,
                        reinterpret_cast<const unsigned char*>(state), 2);
        if (minimised) XUnmapWindow(display_, window);
        XSync(display_, False);
    }

    bool drop(Window window, const std::string& file) {
        list_ = "file://" + file + "\r\n";
        XSetSelectionOwner(display_, atom("XdndSelection"), source_, CurrentTime);
        send(window, "XdndEnter", 5L << 24, static_cast<long>(atom("text/uri-list")), 0, 0);
        const long middle = 100L << 16 | 100L;
        send(window, "XdndPosition", 0, middle, CurrentTime, static_cast<long>(atom("XdndActionCopy")));
        if (!serve_until("XdndStatus")) return false;
        send(window, "XdndDrop", 0, CurrentTime, 0, 0);
        return serve_until("XdndFinished");
    }

  private:
    Atom atom(const char* name) { return XInternAtom(display_, name, False); }

    void send(Window window, const char* type, long a, long b, long c, long d) {
        XEvent event{};
        event.xclient.type = ClientMessage;
        event.xclient.window = window;
        event.xclient.message_type = atom(type);
        event.xclient.format = 32;
        const long data[5] = {static_cast<long>(source_), a, b, c, d};
        std::memcpy(event.xclient.data.l, data, sizeof data);
        XSendEvent(display_, window, False, NoEventMask, &event);
        XFlush(display_);
    }

    // Hands the list of files to whoever asks, until the message comes; false where the window refuses.
    bool serve_until(const char* message) {
        for (;;) {
            XEvent event;
            XNextEvent(display_, &event);
            if (event.type == SelectionRequest) hand_over(event.xselectionrequest);
            if (event.type == ClientMessage && event.xclient.message_type == atom(message))
                return event.xclient.data.l[1] != 0;
        }
    }

    void hand_over(const XSelectionRequestEvent& request) {
        XChangeProperty(display_, request.requestor, request.property, request.target, 8, PropModeReplace,
                        reinterpret_cast<const unsigned char*>(list_.data()), static_cast<int>(list_.size()));
        XEvent answer{};
        answer.xselection.type = SelectionNotify;
        answer.xselection.requestor = request.requestor;
        answer.xselection.selection = request.selection;
        answer.xselection.target = request.target;
        answer.xselection.property = request.property;
        answer.xselection.time = request.time;
        XSendEvent(display_, request.requestor, False, NoEventMask, &answer);
        XFlush(display_);
    }

    Display* display_;
    Window source_;
    std::string list_;
};

}  // namespace

int main(int count, char** arguments) {
    Display* display = XOpenDisplay(nullptr);
    if (display == nullptr || count < 3) {
        std::fprintf(stderr, "usage: x_desktop minimise|restore|drop WINDOW [FILE], on a display\n");
        return 2;
    }
    const std::string what = arguments[1];
    const auto window = static_cast<Window>(std::strtoul(arguments[2], nullptr, 0));
    Desktop desktop(display);
    bool done = true;
    if (what == "drop" && count > 3)
        done = desktop.drop(window, arguments[3]);
    else
        desktop.set_minimised(window, what == "minimise");
    XCloseDisplay(display);
    return done ? 0 : 1;
}
