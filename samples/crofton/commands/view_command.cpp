// SPDX-License-Identifier: MIT
// `crofton view`: see what is culled, why, and what it costs.
#include <memory>

#include "commands.hpp"
#include "frames_output.hpp"
#include "pipeline/bounds.hpp"
#include "pipeline/pipeline.hpp"
#include "read_options.hpp"
#include "report.hpp"
#include "viewer/keys.hpp"
#include "viewer/viewer.hpp"

namespace crofton::cli {
namespace {

struct ViewArguments {
    viewer::ViewerOptions options;
    std::string size = "1280x720", bounds = "obb-perimeter", cull = "tree";
    bool no_window = false;
    ReadOptions read;
};

Result<void> run(ViewArguments arguments) {
    const auto size = image_size_from(arguments.size);
    if (!size) return size.error();
    const auto bounds = pipeline::bounds_kind_from(arguments.bounds);
    if (!bounds) return bounds.error();
    const auto mode = pipeline::cull_mode_from(arguments.cull);
    if (!mode) return mode.error();
    viewer::ViewerOptions& options = arguments.options;
    options.scene.limits = arguments.read.limits;
    options.scene.strict = arguments.read.strict;
    options.scene.unit = arguments.read.unit;
    options.width = size->width;
    options.height = size->height;
    options.settings.method.bounds = *bounds;
    options.settings.method.cull = *mode;
    options.window = !arguments.no_window;
    if (!options.window && options.frames == 0 && options.script.empty())
        return fail(ErrorCode::invalid_argument, kNoItem,
                    "--no-window needs --after or --script, or it would never end");
    if (!options.screenshot.empty() && options.frames == 0)
        return fail(ErrorCode::invalid_argument, kNoItem, "--screenshot needs --after FRAMES");
    return viewer::run_viewer(options);
}

constexpr const char* kScriptHelp =
    "Script: {\"events\": [{\"frame\": 1, \"key\": \"F\"}, ...]}, frames in order, one action for each event:\n"
    "  key, key_down, key_up \"W\"       a key by its name above\n"
    "  set {\"coloring\": \"verdict\"}    switches by name; docs/viewer.md lists them\n"
    "  camera {\"position\": [0, 2, 9], \"forward\": [0, 0, -1]}\n"
    "  click [640, 360], resize [800, 600]   in pixels\n"
    "  drop \"scene.glb\"                a file opened as if dropped on the window\n"
    "  screenshot \"a.png\"              the picture of this frame, with panels\n"
    "  scale 2.0                       as if the window had come onto a display of that scale\n"
    "  lose_device true, quit true\n";
constexpr const char* kViewExamples =
    "Examples:\n"
    "  crofton view                                        # the town\n"
    "  crofton view level.wad --map MAP07\n"
    "  crofton view scene.glb --camera street --bounds aabb\n"
    "  crofton view                                        # then C until 'clusters', F, fly up: why each triangle is "
    "drawn or not\n"
    "  crofton pvs town --out sets.crofton && crofton view town --baked sets.crofton\n"
    "  crofton view regions/ --camera flight               # regions by 'crofton bake --regions' come and go\n"
    "  crofton view --no-window --after 10 --screenshot town.png --json -\n"
    "  xvfb-run -a crofton view --script tour.json         # no display: a virtual one\n";

}  // namespace

void add_view_command(CommandLine& line) {
    auto arguments = std::make_shared<ViewArguments>();
    viewer::ViewerOptions& options = arguments->options;
    Command command =
        line.command("view", "Fly through a scene and see which objects are culled, why, and how long that takes");
    command.footer(viewer::key_help() + "\n" + kScriptHelp + "\n" + kViewExamples);
    command
        .option(
            "SCENE", options.scene.source,
            "town, room, office, valley, hall, a folder of city parts or of regions, or a .glb, .gltf, .obj, .wad or "
            ".crofton file")
        .show_default();
    command.option("--map", options.scene.map, "Level of a .wad file");
    command.option("--seed", options.scene.seed, "of the town").show_default();
    command.option("--instances", options.scene.instances, "Approximate number of instances of the town");
    command.option("--scale", options.scale, "Scale of texts and panels; that of the display by default")
        .between(0.5, 8.0);
    command
        .option("--resolution", options.settings.resolution,
                "Draw this share of the pixels each way, and enlarge the picture")
        .between(viewer::kMinResolution, 1.0)
        .show_default();
    command.option("--size", arguments->size, "Size of the window, WIDTHxHEIGHT").show_default();
    command.option("--bounds", arguments->bounds, "sphere | aabb | obb-volume | obb-area | obb-perimeter | obb-frustum")
        .show_default();
    command.option("--cull", arguments->cull, "none | flat | tree").show_default();
    command.flag("--occlude", options.settings.method.occlude, "Leave out objects that are hidden behind others");
    command.option("--baked", options.scene.baked,
                   "A baked file of the scene: occluders by 'crofton bake', visible sets by 'crofton pvs'");
    command.option("--camera", options.camera, "orbit | street | flight | random, or a JSON file: plays a path");
    command.option("--after", options.frames, "Quit after this many frames");
    command.option("--screenshot", options.screenshot, "Write the last frame as PNG").writable_file();
    command.option("--script", options.script, "JSON file of keys, cameras, switches and screenshots by frame");
    command.option("--json", options.json, "Write the statistics of all frames as JSON; - for stdout")
        .writable_file_or_stdout();
    command.option("--output", options.output_folder, "Folder for recorded paths, exports and screenshots")
        .show_default();
    command.option("--device", options.device, "Part of the Vulkan device's name, or cpu");
    command.flag("--validation", options.validation, "Check every Vulkan call (needs the validation layer)");
    command.flag("--no-window", arguments->no_window, "Draw without a display");
    add_unit_option(command, arguments->read);
    add_read_options(command, arguments->read);
    command.action_with_window([arguments] {
        const auto done = run(*arguments);
        return done ? kSuccess : report_error("", done.error());
    });
}

}  // namespace crofton::cli
