#version 460
// SPDX-License-Identifier: MIT
// Triangles as their numbers. The position is computed exactly as in scene.vert, so that each pixel has the same owner.

layout(location = 0) in vec3 position;
// One per draw, stepped by instance: the draw's transform.
layout(location = 3) in mat4 to_clip;
layout(location = 10) in vec4 options;  // z, w: lower and upper 16 bits of the number of the draw's first triangle

layout(location = 0) flat out uint first_number;

void main() {
    precise vec4 x = to_clip[0] * position.x;
    precise vec4 y = to_clip[1] * position.y;
    precise vec4 z = to_clip[2] * position.z;
    precise vec4 xy = x + y;
    precise vec4 xyz = xy + z;
    precise vec4 clip = xyz + to_clip[3];
    gl_Position = clip;
    first_number = uint(options.z) | uint(options.w) << 16;
}
