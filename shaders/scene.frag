#version 460
// Two-sided light from the vertices, fog by view depth, and a square root for the display's gamma.

layout(push_constant) uniform Frame {
    vec4 to_sun;
    vec4 sun;
    vec4 sky_ambient;
    vec4 ground_ambient;
    vec4 fog;
    vec4 spare[3];
} frame;

layout(location = 0) in vec4 lit_color;
layout(location = 0) out vec4 pixel;

void main() {
    vec3 lit = gl_FrontFacing ? lit_color.rgb : lit_color.rgb * (1.0 + lit_color.a);
    // With view depth d = 1 / gl_FragCoord.w and the haze distance h: d² / (h² + d²), by one division.
    float nearness = gl_FragCoord.w * frame.to_sun.w;
    float haze = frame.fog.w / (1.0 + nearness * nearness);
    pixel = vec4(sqrt(mix(lit, frame.fog.rgb, haze)), 1.0);
}
