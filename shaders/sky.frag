#version 460
// A clear sky: horizon to zenith by height, and the sun's disc with its glow.

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
    vec3 d = normalize(direction);
    float height = sqrt(clamp(d.y, 0.0, 1.0));
    vec3 color = mix(frame.horizon.rgb, frame.zenith.rgb, height);
    color = mix(color, frame.ground.rgb, clamp(-8.0 * d.y, 0.0, 1.0));
    float toward = max(dot(d, frame.to_sun.xyz), 0.0);
    float glow = toward * toward;
    glow *= glow;
    glow *= glow;
    glow *= glow;
    color += frame.sun.rgb * (0.15 * glow + smoothstep(0.9993, 0.9996, toward));
    pixel = vec4(sqrt(min(color, vec3(1.0))), 1.0);
}
