#version 460
// SPDX-License-Identifier: MIT
// One triangle over the whole target, at infinite distance (reversed-Z: depth 0).

layout(push_constant) uniform Frame {
    vec4 to_sun;
    vec4 zenith;
    vec4 horizon;
    vec4 ground;
    vec4 sun;
    vec4 right;    // half the view's width, as a world vector
    vec4 up;
    vec4 forward;
} frame;

layout(location = 0) noperspective out vec3 direction;
// For the fragments: lavapipe reads flat inputs many times faster than push constants.
layout(location = 1) flat out vec3 to_sun;
layout(location = 2) flat out vec3 zenith;
layout(location = 3) flat out vec3 horizon;
layout(location = 4) flat out vec3 ground;
layout(location = 5) flat out vec3 sun;

void main() {
    vec2 corner = vec2(gl_VertexIndex == 1 ? 3.0 : -1.0, gl_VertexIndex == 2 ? 3.0 : -1.0);
    direction = frame.forward.xyz + corner.x * frame.right.xyz + corner.y * frame.up.xyz;
    to_sun = frame.to_sun.xyz;
    zenith = frame.zenith.rgb;
    horizon = frame.horizon.rgb;
    ground = frame.ground.rgb;
    sun = frame.sun.rgb;
    gl_Position = vec4(corner, 0.0, 1.0);
}
