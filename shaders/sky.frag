#version 460
// SPDX-License-Identifier: MIT
// A clear sky: horizon to zenith by height, and the sun's disc with its glow. All colours are given as they appear: each
// root costs software devices as much as the rest of the sky.

layout(push_constant) uniform Frame {
    vec4 to_sun;
    vec4 zenith;
    vec4 horizon;
    vec4 ground;
    vec4 sun;
    vec4 right;
    vec4 up;
    vec4 forward;
} frame;

layout(location = 0) in vec3 direction;
layout(location = 0) out vec4 pixel;

void main() {
    float scale = inversesqrt(dot(direction, direction));
    float up = direction.y * scale;
    float height = sqrt(clamp(up, 0.0, 1.0));
    vec3 color = mix(frame.horizon.rgb, frame.zenith.rgb, height);
    color = mix(color, frame.ground.rgb, clamp(-8.0 * up, 0.0, 1.0));
    float toward = max(dot(direction, frame.to_sun.xyz) * scale, 0.0);
    float glow = toward * toward;
    glow *= glow;
    glow *= glow;
    glow *= glow;
    color += frame.sun.rgb * (0.1 * glow + clamp((toward - 0.9993) * 3333.0, 0.0, 1.0));
    pixel = vec4(color, 1.0);
}
