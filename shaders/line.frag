#version 460
// SPDX-License-Identifier: MIT
// The line's own colour, unlit; it is given as it shall appear.

layout(location = 0) in vec4 line_color;
layout(location = 0) out vec4 pixel;

void main() { pixel = line_color; }
