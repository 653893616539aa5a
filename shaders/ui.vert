#version 460
// SPDX-License-Identifier: MIT
// Dear ImGui's vertices: pixels to clip space.

layout(push_constant) uniform Frame {
    vec2 scale;
    vec2 shift;
} frame;

layout(location = 0) in vec2 position;
layout(location = 1) in vec2 uv;
layout(location = 2) in vec4 color;
layout(location = 0) out vec2 texture_uv;
layout(location = 1) out vec4 tint;

void main() {
    texture_uv = uv;
    tint = color;
    gl_Position = vec4(position * frame.scale + frame.shift, 0.0, 1.0);
}
