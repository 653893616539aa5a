#version 460
// SPDX-License-Identifier: MIT
// The triangle's number in the four bytes of the pixel; faces as in scene.frag.

layout(constant_id = 0) const uint faces = 0;  // 0: both, 1: back faces are dropped here, 2: they do not come here

layout(location = 0) flat in uint first_number;
layout(location = 0) out vec4 pixel;

void main() {
    if (isnan(gl_FragCoord.z)) discard;
    if (faces == 1 && !gl_FrontFacing) discard;
    pixel = unpackUnorm4x8(first_number + uint(gl_PrimitiveID));
}
