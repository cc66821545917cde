// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0
// World places are voxels from the middle of the box, in true proportions.

const head = '#version 300 es\nprecision highp float;\nprecision highp int;\n';

/// Grains are the bodies of the sample (sample.js). looks: of each red, green, blue and its state (selection.js); places: the
/// centroid of the grain that it is part of.
const grainTables = `
uniform sampler2D looks;
uniform sampler2D places;
uniform int tableWidth;
ivec2 cellOf(int grain) { return ivec2(grain % tableWidth, grain / tableWidth); }
`;

/// Light from above on the left, as the viewer sees it.
const light = `
vec3 lit(vec3 color, vec3 normal) {
  float facing = max(dot(normalize(normal), normalize(vec3(-0.35, 0.55, 0.75))), 0.0);
  return color * (0.5 + 0.6 * facing);
}
vec4 idColor(int grain) {
  int number = grain + 1;
  return vec4(float(number & 255), float((number >> 8) & 255), float(number >> 16), 255.0) / 255.0;
}
`;

export const grainVertex = `${head}${grainTables}
uniform mat4 modelViewMatrix, projectionMatrix;
uniform mat3 normalMatrix;
uniform float explode;
in vec3 position, normal;
in float grain;
out vec3 place, viewNormal;
flat out vec3 color;
flat out int number;
void main() {
  number = int(grain);
  color = texelFetch(looks, cellOf(number), 0).rgb;
  place = position;
  viewNormal = normalMatrix * normal;
  vec3 center = texelFetch(places, cellOf(number), 0).xyz;
  gl_Position = projectionMatrix * modelViewMatrix * vec4(position + explode * center, 1.0);
}`;

export const grainFragment = `${head}${light}
uniform vec3 low, high;
uniform float strength;
uniform bool picking;
in vec3 place, viewNormal;
flat in vec3 color;
flat in int number;
out vec4 result;
void main() {
  if (any(lessThan(place, low)) || any(greaterThan(place, high))) discard;
  // Where a cut shows the inside of a surface, the cut face is drawn over it (but for a rim).
  result = picking ? idColor(number)
    : vec4(gl_FrontFacing ? lit(color, viewNormal) : 0.9 * color, 1.0) * strength;
}`;

/// The face of a cut: slice has the numbers of the grains there, from 1 on.
export const cutVertex = `${head}
uniform mat4 modelViewMatrix, projectionMatrix;
in vec3 position;
out vec3 place;
void main() {
  place = position;
  gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
}`;

export const cutFragment = `${head}${grainTables}${light}
uniform sampler2D slice;
uniform vec3 low, high, perCell, firstCell;
uniform int axis;
uniform float lowState, highState, strength;
uniform bool picking;
in vec3 place;
out vec4 result;
void main() {
  vec3 inside = place;
  inside[axis] = 0.5 * (low[axis] + high[axis]);
  if (any(lessThan(inside, low)) || any(greaterThan(inside, high))) discard;
  ivec3 cell = ivec3(floor(place * perCell + firstCell));
  ivec2 at = axis == 0 ? cell.yz : axis == 1 ? cell.xz : cell.xy;
  ivec4 bytes = ivec4(round(texelFetch(slice, clamp(at, ivec2(0), textureSize(slice, 0) - 1), 0) * 255.0));
  int grain = bytes.r + 256 * bytes.g + 65536 * bytes.b - 1;
  if (grain < 0) discard;
  vec4 look = texelFetch(looks, cellOf(grain), 0);
  float state = look.a * 255.0;
  if (state < lowState || state > highState) discard;
  result = picking ? idColor(grain) : vec4(0.97 * look.rgb, 1.0) * strength;
}`;

/// Bonds: discs, or lines between the grains' centroids.
export const bondVertex = `${head}
uniform mat4 modelViewMatrix, projectionMatrix;
uniform mat3 normalMatrix;
uniform float explode;
in vec3 position, center, normal, color;
out vec3 place, viewNormal, shade;
void main() {
  place = position;
  shade = color;
  viewNormal = normalMatrix * normal;
  gl_Position = projectionMatrix * modelViewMatrix * vec4(position + explode * center, 1.0);
}`;

export const bondFragment = `${head}${light}
uniform vec3 low, high;
uniform bool isLit;
in vec3 place, viewNormal, shade;
out vec4 result;
void main() {
  if (any(lessThan(place, low)) || any(greaterThan(place, high))) discard;
  result = vec4(isLit ? lit(shade, gl_FrontFacing ? viewNormal : -viewNormal) : shade, 1.0);
}`;

export const lineVertex = `${head}
uniform mat4 modelViewMatrix, projectionMatrix;
in vec3 position;
void main() { gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0); }`;

export const lineFragment = `${head}
out vec4 result;
void main() { result = vec4(0.45, 0.47, 0.5, 1.0); }`;
