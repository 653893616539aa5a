#version 460
// Lit triangles. The position is computed exactly as ClipPredictor does, so that triangle counts agree to the bit.

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
layout(location = 2) in vec3 color;
// One per draw, stepped by instance: the draw's transform.
layout(location = 3) in mat4 to_clip;
layout(location = 7) in mat3x4 to_world_normal;  // cofactors of the linear part; .w of the columns: the tint
layout(location = 10) in vec4 options;           // x: share of the tint in the colour, y: 1 = unlit

layout(location = 0) out vec4 lit_color;  // .a: how much brighter the back is than the front, less 1

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
    vec3 albedo = mix(color, tint, options.x);
    vec3 ambient = 0.5 * (frame.sky_ambient.rgb + frame.ground_ambient.rgb);
    vec3 slope = (0.5 * n.y) * (frame.sky_ambient.rgb - frame.ground_ambient.rgb);
    float facing = dot(n, frame.to_sun.xyz);
    vec3 front = mix(ambient + slope + frame.sun.rgb * max(facing, 0.0), vec3(1.0), options.y);
    vec3 back = mix(ambient - slope + frame.sun.rgb * max(-facing, 0.0), vec3(1.0), options.y);
    lit_color = vec4(albedo * front, back.g / max(front.g, 1e-4) - 1.0);
}
