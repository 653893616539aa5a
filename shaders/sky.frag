#version 460
// SPDX-License-Identifier: MIT
// A clear sky: horizon to zenith by height, and the sun's disc with its glow. All colours are given as they appear: each
// root costs software devices as much as the rest of the sky.

layout(location = 0) noperspective in vec3 direction;
layout(location = 1) flat in vec3 to_sun;
layout(location = 2) flat in vec3 zenith;
layout(location = 3) flat in vec3 horizon;
layout(location = 4) flat in vec3 ground;
layout(location = 5) flat in vec3 sun;
layout(location = 0) out vec4 pixel;

void main() {
    float scale = inversesqrt(dot(direction, direction));
    float up = direction.y * scale;
    float height = sqrt(clamp(up, 0.0, 1.0));
    vec3 color = mix(horizon, zenith, height);
    color = mix(color, ground, clamp(-8.0 * up, 0.0, 1.0));
    float toward = max(dot(direction, to_sun) * scale, 0.0);
    float glow = toward * toward;
    glow *= glow;
    glow *= glow;
    glow *= glow;
    color += sun * (0.1 * glow + clamp((toward - 0.9993) * 3333.0, 0.0, 1.0));
    pixel = vec4(color, 1.0);
}
