#include "panels.hpp"

#include <cinttypes>
#include <cmath>
#include <cstdio>

#include "scene_panel.hpp"

namespace crofton::viewer {
namespace {

using Frame = pipeline::FrameStatistics;

constexpr float kFontPixels = 13.0f;  // what Dear ImGui's own font is made for

ImVec4 display_color(const glm::vec3& linear) {
    return {std::sqrt(linear.r), std::sqrt(linear.g), std::sqrt(linear.b), 1.0f};
}
ImVec4 display_color(std::uint32_t rgba) {
    return ImGui::ColorConvertU32ToFloat4(rgba);
}

// One row: name, this frame's value, B's value where there is a comparison.
void row(const char* name, std::uint64_t value, const std::uint64_t* other) {
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    ImGui::TextUnformatted(name);
    ImGui::TableNextColumn();
    ImGui::Text("%" PRIu64, value);
    if (other == nullptr) return;
    ImGui::TableNextColumn();
    ImGui::Text("%" PRIu64, *other);
}
void row(const char* name, double value, const double* other) {
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    ImGui::TextUnformatted(name);
    ImGui::TableNextColumn();
    ImGui::Text("%.2f", value);
    if (other == nullptr) return;
    ImGui::TableNextColumn();
    ImGui::Text("%.2f", *other);
}

void statistics_table(const PanelInput& input) {
    const Frame& a = input.frame;
    const Frame* b = input.other;
    if (!ImGui::BeginTable("statistics", b != nullptr ? 3 : 2, ImGuiTableFlags_RowBg)) return;
    if (b != nullptr) {
        ImGui::TableSetupColumn("");
        ImGui::TableSetupColumn("A");
        ImGui::TableSetupColumn("B");
        ImGui::TableHeadersRow();
    }
    const auto whole = [&](const char* name, std::uint64_t Frame::*member) {
        row(name, a.*member, b != nullptr ? &(b->*member) : nullptr);
    };
    const auto real = [&](const char* name, double Frame::*member, double unit) {
        const double value = b != nullptr ? b->*member * unit : 0.0;
        row(name, a.*member * unit, b != nullptr ? &value : nullptr);
    };
    whole("instances", &Frame::instances);
    whole("visible", &Frame::visible);
    whole("  inside", &Frame::inside);
    whole("  straddling", &Frame::straddling);
    whole("improper", &Frame::improper);
    whole("nodes tested", &Frame::nodes_tested);
    whole("triangles submitted", &Frame::triangles_submitted);
    whole("triangles passed", &Frame::triangles_passed);
    whole("colliding pairs", &Frame::colliding_pairs);
    real("update ms", &Frame::update_us, 1e-3);
    real("cull ms", &Frame::cull_us, 1e-3);
    real("collide ms", &Frame::collide_us, 1e-3);
    ImGui::EndTable();
}

void counters(const PanelInput& input) {
    if (input.drawn == nullptr || !input.drawn->gpu) return;
    const Frame& frame = *input.drawn;
    const bool same = frame.triangles_clipped == frame.gpu->clipping_primitives;
    ImGui::TextColored(same ? ImVec4(0.4f, 0.9f, 0.4f, 1.0f) : ImVec4(1.0f, 0.5f, 0.3f, 1.0f),
                       "clipped: predicted %" PRIu64 " %s %" PRIu64 " counted", frame.triangles_clipped,
                       same ? "=" : "but", frame.gpu->clipping_primitives);
    ImGui::Text("GPU: assembled %" PRIu64 ", samples %" PRIu64, frame.gpu->input_assembly_primitives,
                frame.gpu->samples_passed);
}

void plots(const Journal& journal) {
    const auto plot = [&](const char* name, double (*value)(const JournalEntry&), const char* format) {
        const auto history = journal.history(value);
        if (history.empty()) return;
        char now[64];
        std::snprintf(now, sizeof now, format, static_cast<double>(history.back()));
        ImGui::PlotLines(name, history.data(), static_cast<int>(history.size()), 0, now, 0.0f, 3.4e38f,
                         ImVec2(0.0f, 36.0f));
    };
    plot(
        "frame", [](const JournalEntry& e) { return e.frame_us * 1e-3; }, "%.1f ms");
    plot(
        "cull", [](const JournalEntry& e) { return e.frame.cull_us * 1e-3; }, "%.3f ms");
    plot(
        "collide", [](const JournalEntry& e) { return e.frame.collide_us * 1e-3; }, "%.3f ms");
    plot(
        "visible", [](const JournalEntry& e) { return static_cast<double>(e.frame.visible); }, "%.0f");
    plot(
        "passed", [](const JournalEntry& e) { return static_cast<double>(e.frame.triangles_passed); }, "%.0f");
    const auto bins = journal.frame_time_histogram();
    ImGui::PlotHistogram("0-100 ms", bins.data(), static_cast<int>(bins.size()), 0, "frame time", 0.0f, 3.4e38f,
                         ImVec2(0.0f, 48.0f));
}

template <class Enum>
void combo(const char* label, Enum& value, std::span<const Enum> choices) {
    if (!ImGui::BeginCombo(label, to_string(value))) return;
    for (const Enum choice : choices)
        if (ImGui::Selectable(to_string(choice), choice == value)) value = choice;
    ImGui::EndCombo();
}

void method(const char* bounds_label, const char* cull_label, const char* triangulation_label, Method& value) {
    using enum pipeline::BoundsKind;
    static constexpr pipeline::BoundsKind kBounds[] = {sphere, aabb, obb_volume, obb_area, obb_perimeter, obb_frustum};
    static constexpr pipeline::CullMode kModes[] = {pipeline::CullMode::none, pipeline::CullMode::flat,
                                                    pipeline::CullMode::tree};
    combo(bounds_label, value.bounds, std::span<const pipeline::BoundsKind>(kBounds));
    combo(cull_label, value.cull, std::span<const pipeline::CullMode>(kModes));
    static constexpr Triangulation kTriangulations[] = {Triangulation::loaded, Triangulation::ear,
                                                        Triangulation::delaunay, Triangulation::minimum_weight};
    combo(triangulation_label, value.triangulation, std::span<const Triangulation>(kTriangulations));
}

void switches(const PanelInput& input, PanelWish& wish) {
    Settings& s = input.settings;
    auto coloring = static_cast<int>(s.coloring);
    if (ImGui::Combo("colour (C)", &coloring, kColoringNames, static_cast<int>(std::size(kColoringNames))))
        s.coloring = static_cast<Coloring>(coloring);
    method("bounds (N)", "cull (M)", "triangles (Y)", s.method);
    ImGui::Checkbox("freeze (F)", &s.freeze);
    ImGui::SameLine();
    ImGui::Checkbox("inset (I)", &s.inset);
    ImGui::SameLine();
    ImGui::Checkbox("exact (L)", &s.exact);
    ImGui::Checkbox("outside (O)", &s.outside);
    ImGui::SameLine();
    ImGui::Checkbox("bounds (B)", &s.bounds);
    ImGui::SameLine();
    ImGui::Checkbox("wires (X)", &s.wireframe);
    ImGui::Checkbox("collisions (K)", &s.collisions);
    ImGui::SameLine();
    ImGui::Checkbox("compare (G)", &s.compare);
    if (s.compare) method("B: bounds", "B: cull", "B: triangles", s.other);
    const int height = static_cast<int>(input.stage.pipeline().tree().height());
    ImGui::SliderInt("tree level (T)", &s.tree_level, -1, height - 1, s.tree_level < 0 ? "off" : "%d");
    ImGui::SliderInt("views (V)", &s.cascades, 1, 8);
    ImGui::Checkbox("pause (P)", &s.paused);
    ImGui::SameLine();
    wish.step = ImGui::Button("step (.)");
    ImGui::SameLine();
    auto scale = static_cast<float>(s.time_scale);
    ImGui::SetNextItemWidth(7.0f * ImGui::GetFontSize());
    if (ImGui::SliderFloat("time", &scale, 0.0f, 4.0f, "%.2fx")) s.time_scale = static_cast<double>(scale);
    wish.frame_all = ImGui::Button("frame all (Home)");
    ImGui::SameLine();
    wish.record = ImGui::Button(input.recording ? "stop (R)" : "record (R)");
    ImGui::SameLine();
    wish.replay = ImGui::Button(input.replaying ? "stop replay" : "replay");
    wish.export_files = ImGui::Button("export (F5)");
    ImGui::SameLine();
    wish.screenshot = ImGui::Button("screenshot (F2)");
    bool orbit = input.eye.mode == EyeMode::orbit;
    ImGui::SameLine();
    if (ImGui::Checkbox("orbit (Tab)", &orbit)) input.eye.mode = orbit ? EyeMode::orbit : EyeMode::fly;
}

void legend(const PanelInput& input) {
    for (const Painter::Count& tint : input.painter.counts()) {
        ImGui::ColorButton(tint.name, display_color(tint.color), ImGuiColorEditFlags_NoTooltip,
                           ImVec2(ImGui::GetFontSize(), ImGui::GetFontSize()));
        ImGui::SameLine();
        ImGui::Text("%s: %" PRIu64, tint.name, tint.instances);
    }
    if (input.cascades.size() > 1)
        for (std::size_t i = 0; i < input.cascades.size(); ++i) {
            const Cascade& cascade = input.cascades[i];
            ImGui::TextColored(display_color(cascade.color), "view %zu: %.1f to %.1f m, %" PRIu64 " visible", i + 1,
                               cascade.camera.near, cascade.camera.far, cascade.visible);
        }
    if (input.settings.coloring == Coloring::shape)
        ImGui::TextUnformatted("triangles: red = slivers, green = equilateral");
    if (input.settings.coloring == Coloring::collision) {
        ImGui::Text("contacts between triangles: %" PRIu64, input.overlay.contact_count());
        ImGui::Text("near misses with their separating axis: %" PRIu64, input.overlay.separation_count());
    }
}

}  // namespace

void apply_style(float scale) {
    ImGui::StyleColorsDark();
    ImGuiStyle& style = ImGui::GetStyle();
    style.WindowRounding = 4.0f;
    style.Colors[ImGuiCol_WindowBg].w = 0.86f;
    style.ScaleAllSizes(scale);
    // Drawn at its size, not enlarged.
    ImFontConfig font;
    font.SizePixels = std::round(kFontPixels * scale);
    ImGui::GetIO().Fonts->AddFontDefault(&font);
}

PanelWish draw_panels(const PanelInput& input) {
    PanelWish wish;
    const ImVec2 display = ImGui::GetIO().DisplaySize;
    const float unit = ImGui::GetFontSize() / kFontPixels;
    ImGui::SetNextWindowPos(ImVec2(8.0f, 8.0f), ImGuiCond_FirstUseEver);
    ImGui::SetNextWindowSize(ImVec2(330.0f * unit, display.y - 16.0f), ImGuiCond_FirstUseEver);
    if (ImGui::Begin("Crofton")) {
        const double ms = input.journal.mean([](const JournalEntry& e) { return e.frame_us * 1e-3; }, 30);
        ImGui::Text("%s: %.1f frames/s", input.stage.source().name.c_str(), ms > 0.0 ? 1000.0 / ms : 0.0);
        ImGui::TextDisabled("%s", input.device.c_str());
        if (input.settings.freeze)
            ImGui::TextColored(ImVec4(1.0f, 0.85f, 0.3f, 1.0f), "FROZEN: culling keeps its camera");
        statistics_table(input);
        counters(input);
        legend(input);
        if (ImGui::CollapsingHeader("Switches", ImGuiTreeNodeFlags_DefaultOpen)) switches(input, wish);
        if (ImGui::CollapsingHeader("History")) plots(input.journal);
    }
    ImGui::End();
    scene_panel(input, wish);
    if (input.inset != nullptr) {
        ImGui::SetNextWindowPos(ImVec2(display.x - input.inset_size.x - 28.0f, display.y - input.inset_size.y - 48.0f),
                                ImGuiCond_FirstUseEver);
        if (ImGui::Begin("From outside", nullptr, ImGuiWindowFlags_AlwaysAutoResize))
            ImGui::Image(input.inset, input.inset_size);
        ImGui::End();
    }
    return wish;
}

}  // namespace crofton::viewer
