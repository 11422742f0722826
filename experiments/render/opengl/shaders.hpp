#pragma once

/// The renderer's shaders in GLSL 3.30. Light is computed linearly and encoded as sRGB at the end.
namespace taut::shaders {

inline constexpr const char* kVersion = "#version 330 core\n";

/// Light that a point receives from all lights. `light.w` is the light's share of the light on open
/// ground. `visible` is the share of the four texels around the point that the light reaches;
/// nothing beyond the maps casts a shadow.
inline constexpr const char* kLightCommon = R"(#version 330 core
const int kMostLights = 96;
uniform int lights;
uniform vec4 light[kMostLights];     // unit, towards the light; its share
uniform mat4 to_map[kMostLights];    // world to texture coordinates and depth
uniform float texel;                 // m
uniform float bias;                  // of depth
uniform sampler2DArrayShadow depth_maps;
float visible(int k, vec3 p) {
  vec3 q = (to_map[k] * vec4(p, 1.0)).xyz;
  return texture(depth_maps, vec4(q.xy, float(k), min(q.z - bias, 1.0)));
}
)";

inline constexpr const char* kFragmentCommon = R"(#version 330 core
vec3 decode(vec3 c) { return mix(c / 12.92, pow((c + 0.055) / 1.055, vec3(2.4)), vec3(greaterThan(c, vec3(0.04045)))); }
vec3 encode(vec3 c) {
  c = clamp(c, 0.0, 1.0);
  return mix(12.92 * c, 1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, vec3(greaterThan(c, vec3(0.0031308))));
}
/// Coverage of lines at whole numbers of p, `width` pixels wide; fades where they crowd.
float lines(vec2 p, float width) {
  vec2 footprint = max(fwidth(p), 1e-6);
  vec2 pixels = abs(fract(p - 0.5) - 0.5) / footprint;
  vec2 covered = 1.0 - smoothstep(width * 0.5 - 0.5, width * 0.5 + 0.5, pixels);
  covered *= 1.0 - smoothstep(0.12, 0.4, footprint);
  return max(covered.x, covered.y);
}
)";

/// A triangle that covers the picture.
inline constexpr const char* kBackgroundVertex = R"(
out float height;
void main() {
  vec2 p = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);
  height = p.y * 0.5 + 0.5;
  gl_Position = vec4(p, 1.0, 1.0);
}
)";
inline constexpr const char* kBackgroundFragment = R"(
uniform vec3 top, bottom;
in float height;
out vec4 pixel;
void main() { pixel = vec4(mix(bottom, top, height), 1.0); }
)";

/// A depth map, without colour.
inline constexpr const char* kDepthVertex = R"(
uniform mat4 to_map;
layout(location = 0) in vec3 at;
void main() { gl_Position = vec4(2.0 * (to_map * vec4(at, 1.0)).xyz - 1.0, 1.0); }
)";
inline constexpr const char* kDepthFragment = "void main() {}\n";

/// Light that reaches the ground, relative to open ground: one texel of a map that covers it.
inline constexpr const char* kGroundLightFragment = R"(
uniform vec3 origin, u, v, up;
uniform float half_side, size;
out vec4 received;
void main() {
  vec2 place = half_side * (2.0 * gl_FragCoord.xy / size - 1.0);
  vec3 p = origin + place.x * u + place.y * v;
  float sum = 0.0;
  for (int k = 0; k < lights; ++k) sum += light[k].w * dot(light[k].xyz, up) * visible(k, p);
  received = vec4(sum);
}
)";

/// The ground shows only shadows and lines. Unshaded ground is the background itself, so there is
/// no horizon. Blended as pixel.rgb + background * pixel.a.
inline constexpr const char* kGroundVertex = R"(
uniform mat4 world_to_clip;
uniform vec3 origin, u, v;
uniform float reach;
out vec2 place;
void main() {
  place = reach * vec2((gl_VertexID & 1) * 2 - 1, (gl_VertexID >> 1) * 2 - 1);
  gl_Position = world_to_clip * vec4(origin + place.x * u + place.y * v, 1.0);
}
)";
inline constexpr const char* kGroundFragment = R"(
uniform sampler2D map;
uniform float half_side, shadow, line, cell, line_width;
in vec2 place;
out vec4 pixel;
float received(vec2 at) {  // smoothed over three by three texels
  vec2 step = 0.75 / vec2(textureSize(map, 0));
  return 0.25 * (texture(map, at - step).r + texture(map, at + step).r +
                 texture(map, at + vec2(step.x, -step.y)).r + texture(map, at + vec2(-step.x, step.y)).r);
}
void main() {
  vec2 st = place / half_side;
  float inside = 1.0 - smoothstep(0.75, 1.0, max(abs(st.x), abs(st.y)));
  float open = mix(1.0, min(received(st * 0.5 + 0.5), 1.0), inside);
  float kept = pow(mix(1.0, open, shadow), 1.0 / 2.2);
  float fade = exp(-dot(place, place) / (half_side * half_side) * 0.9);
  float drawn = abs(line) * lines(place / cell, line_width) * fade;
  pixel = line > 0.0 ? vec4(vec3(drawn * kept), kept) : vec4(vec3(0.0), kept * (1.0 - drawn));
}
)";

/// Light on both sides of the surface, per vertex.
inline constexpr const char* kSurfaceVertex = R"(
uniform mat4 world_to_clip;
layout(location = 0) in vec3 at;
layout(location = 1) in vec3 at_normal;
layout(location = 2) in vec2 at_uv;
layout(location = 3) in vec2 at_data;  // value, depth inside a collider
out vec3 world, normal;
out vec4 data;
out vec2 uv;
void main() {
  world = at;
  normal = at_normal;
  uv = at_uv;
  data = vec4(0.0, 0.0, at_data);
  for (int k = 0; k < lights; ++k) {
    float cosine = dot(at_normal, light[k].xyz);
    vec3 above = at + sign(cosine) * 1.3 * texel * at_normal;
    data[cosine > 0.0 ? 0 : 1] += light[k].w * abs(cosine) * visible(k, above);
  }
  gl_Position = world_to_clip * vec4(at, 1.0);
}
)";
/// Sum of the light on the visible side, 0.12 of the light on the other side shining through,
/// ambient light, and light reflected by the ground. Normalised to 1 for open cloth that faces the
/// sky.
inline constexpr const char* kSurfaceFragment = R"(
uniform sampler2D map;
uniform vec2 range;      // values of the map's ends
uniform vec4 colour;     // a > 0: this instead of the map
uniform vec3 eye, up;
uniform float spacing;   // quads between material lines; 0: none
uniform float line_width, hatch_depth;
in vec3 world, normal;
in vec4 data;  // front light, back light, value, depth inside a collider
in vec2 uv;
out vec4 pixel;
void main() {
  bool solid = colour.a > 0.0;
  bool facing = solid || gl_FrontFacing;
  vec3 n = normalize(normal) * (facing ? 1.0 : -1.0);
  vec3 to_eye = normalize(eye - world);
  float seen = facing ? data.x : data.y;
  float behind = solid ? 0.0 : facing ? data.y : data.x;
  float size = float(textureSize(map, 0).x);
  float s = clamp((data.z - range.x) / (range.y - range.x), 0.0, 1.0);
  vec3 base = solid ? colour.rgb : decode(texture(map, vec2((s * (size - 1.0) + 0.5) / size, 0.5)).rgb);
  float level = dot(n, up);
  float openness = mix(0.35, 1.0, clamp(seen + behind, 0.0, 1.0));
  float light = 0.90 * seen + 0.12 * behind + 0.10 + 0.16 * (0.5 - 0.5 * level) * openness;
  light = light <= 1.0 ? light : 1.0 + 0.12 * (1.0 - exp(-(light - 1.0) / 0.12));
  float grazing = pow(1.0 - clamp(dot(n, to_eye), 0.0, 1.0), 4.0);
  vec3 lit = base * light + (solid ? 0.05 : 0.035) * grazing * seen;
  if (spacing > 0.0) lit *= 1.0 - 0.42 * lines(uv / spacing, line_width);
  if (hatch_depth > 0.0 && spacing > 0.0) {
    float across = (uv.x + uv.y) * 4.0 / spacing, footprint = max(fwidth(across), 1e-6);
    float stripe = smoothstep(-footprint, footprint, abs(fract(across) - 0.5) - 0.25);
    stripe = mix(stripe, 0.5, smoothstep(0.3, 0.7, footprint));
    lit *= 1.0 - 0.3 * stripe * smoothstep(0.7, 1.3, data.w / hatch_depth);
  }
  pixel = vec4(encode(lit), 1.0);
}
)";

}  // namespace taut::shaders
