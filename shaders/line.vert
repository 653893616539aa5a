#version 460
// SPDX-License-Identifier: MIT
// Coloured lines in camera-relative coordinates.

layout(push_constant) uniform Frame { mat4 to_clip; } frame;

layout(location = 0) in vec3 position;
layout(location = 1) in vec4 color;
layout(location = 0) out vec4 line_color;

void main() {
    line_color = color;
    gl_Position = frame.to_clip * vec4(position, 1.0);
}
