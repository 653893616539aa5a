#version 460
// SPDX-License-Identifier: MIT
// Light, haze and the display's gamma come from the vertices: lavapipe pays for every operation here.

layout(constant_id = 0) const uint faces = 0;  // 0: both, 1: back faces are dropped here, 2: they do not come here

layout(location = 0) in vec4 front;
layout(location = 0) out vec4 pixel;

void main() {
    if (isnan(gl_FragCoord.z)) discard;  // of a triangle whose area is 0 before its vertices are snapped
    if (faces == 1 && !gl_FrontFacing) discard;
    pixel = vec4(faces != 0 || gl_FrontFacing ? front.rgb : front.rgb * front.a, 1.0);
}
