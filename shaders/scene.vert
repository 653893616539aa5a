#version 460
// SPDX-License-Identifier: MIT
// Lit triangles. The position is computed exactly as ClipPredictor does, so that triangle counts agree to the bit.

layout(constant_id = 0) const uint faces = 0;  // 0: both will be seen, else only the front

layout(push_constant) uniform Frame {
    vec4 to_sun;        // unit vector; w: distance of half the haze
    vec4 sun;           // linear RGB
    vec4 sky_ambient;   // light from above
    vec4 ground_ambient;
    vec4 fog;           // linear RGB; w: 1, or 0 without haze
    vec4 spare[3];
} frame;

layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec3 root_color;  // square roots of linear RGB
// One per draw, stepped by instance: the draw's transform.
layout(location = 3) in mat4 to_clip;
layout(location = 7) in mat3x4 to_world_normal;  // cofactors of the linear part; .w of the columns: the tint
layout(location = 10) in vec4 options;           // x: share of the tint in the colour, y: 1 = unlit

layout(location = 0) out vec4 front;  // display colour; .a: how bright the back is by comparison

// Haze by view depth d and its distance h: d² / (h² + d²); then a square root for the display's gamma.
vec3 shown(vec3 lit, float depth) {
    float square = max(depth, 0.0) * max(depth, 0.0);
    float haze = frame.fog.w * square / (square + frame.to_sun.w * frame.to_sun.w);
    return sqrt(mix(lit, frame.fog.rgb, haze));
}

void main() {
    precise vec4 x = to_clip[0] * position.x;
    precise vec4 y = to_clip[1] * position.y;
    precise vec4 z = to_clip[2] * position.z;
    precise vec4 xy = x + y;
    precise vec4 xyz = xy + z;
    precise vec4 clip = xyz + to_clip[3];
    gl_Position = clip;

    vec3 n = normalize(mat3(to_world_normal) * normal);
    vec3 tint = vec3(to_world_normal[0].w, to_world_normal[1].w, to_world_normal[2].w);
    vec3 albedo = mix(root_color * root_color, tint, options.x);
    vec3 ambient = 0.5 * (frame.sky_ambient.rgb + frame.ground_ambient.rgb);
    vec3 slope = (0.5 * n.y) * (frame.sky_ambient.rgb - frame.ground_ambient.rgb);
    float facing = dot(n, frame.to_sun.xyz);
    vec3 to_front = mix(ambient + slope + frame.sun.rgb * max(facing, 0.0), vec3(1.0), options.y);
    front = vec4(shown(albedo * to_front, clip.w), 1.0);
    if (faces == 0) {
        vec3 to_back = mix(ambient - slope + frame.sun.rgb * max(-facing, 0.0), vec3(1.0), options.y);
        front.a = shown(to_back, clip.w).g / max(shown(to_front, clip.w).g, 1e-2);
    }
}
