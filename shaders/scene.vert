#version 460
// Lit triangles. The position is computed exactly as ClipPredictor does, so that triangle counts agree to the bit.

struct Draw {
    mat4 to_clip;
    mat3x4 normal;  // rows: linear part's cofactors; .w of the columns is the tint
    vec4 options;   // x: share of the tint in the colour, y: 1 = unlit
};
layout(std430, binding = 0) readonly buffer Draws { Draw draws[]; };

layout(push_constant) uniform Frame {
    vec4 to_sun;        // unit vector; w: fog density per metre
    vec4 sun;           // linear RGB
    vec4 sky_ambient;   // light from above
    vec4 ground_ambient;
    vec4 fog;
    vec4 spare[3];
} frame;

layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec3 color;

layout(location = 0) out vec3 front_color;
layout(location = 1) out vec3 back_color;

vec3 light(vec3 n) {
    return mix(frame.ground_ambient.rgb, frame.sky_ambient.rgb, 0.5 + 0.5 * n.y) +
           frame.sun.rgb * max(dot(n, frame.to_sun.xyz), 0.0);
}

void main() {
    Draw draw = draws[gl_BaseInstance + gl_DrawID];
    precise vec4 x = draw.to_clip[0] * position.x;
    precise vec4 y = draw.to_clip[1] * position.y;
    precise vec4 z = draw.to_clip[2] * position.z;
    precise vec4 xy = x + y;
    precise vec4 xyz = xy + z;
    precise vec4 clip = xyz + draw.to_clip[3];
    gl_Position = clip;

    vec3 n = normalize(mat3(draw.normal[0].xyz, draw.normal[1].xyz, draw.normal[2].xyz) * normal);
    vec3 tint = vec3(draw.normal[0].w, draw.normal[1].w, draw.normal[2].w);
    vec3 albedo = mix(color, tint, draw.options.x);
    front_color = mix(albedo * light(n), albedo, draw.options.y);
    back_color = mix(albedo * light(-n), albedo, draw.options.y);
}
