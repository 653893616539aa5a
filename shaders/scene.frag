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
    float depth = frame.to_sun.w / gl_FragCoord.w;
    float haze = depth * depth / (1.0 + depth * depth);
    pixel = vec4(sqrt(mix(lit, frame.fog.rgb, haze)), 1.0);
}
