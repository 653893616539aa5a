#version 460
// SPDX-License-Identifier: MIT
// Text and panels: the texture times the vertex's colour, blended over the picture.

layout(binding = 0) uniform sampler2D image;

layout(location = 0) in vec2 texture_uv;
layout(location = 1) in vec4 tint;
layout(location = 0) out vec4 pixel;

void main() { pixel = tint * texture(image, texture_uv); }
