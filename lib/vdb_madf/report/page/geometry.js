// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0
// Points and triangles of what the scene draws, in world places (shaders.js).
import * as three from 'three';

const kDiscCorners = 20;

function attribute(array, size) {
  return new three.BufferAttribute(array, size);
}

/// Made in place: the mesh's points move to the world.
export function grainGeometry(mesh, space) {
  const { positions, corners } = mesh;
  for (let i = 0; i < positions.length; ++i)
    positions[i] = (positions[i] - space.middle[i % 3]) * space.edges[i % 3];
  const geometry = new three.BufferGeometry();
  geometry.setAttribute('position', attribute(positions, 3));
  geometry.setAttribute('normal', attribute(normalsOf(positions, corners), 3));
  geometry.setAttribute('grain', attribute(mesh.grainOf, 1));
  geometry.setIndex(attribute(corners.slice(), 1));  // the scene sorts it
  return geometry;
}

/// Of the points: the mean of those of the triangles around, by their areas.
function normalsOf(points, corners) {
  const normals = new Float32Array(points.length);
  for (let i = 0; i < corners.length; i += 3) {
    const a = 3 * corners[i], b = 3 * corners[i + 1], c = 3 * corners[i + 2];
    const ux = points[b] - points[a], uy = points[b + 1] - points[a + 1], uz = points[b + 2] - points[a + 2];
    const vx = points[c] - points[a], vy = points[c + 1] - points[a + 1], vz = points[c + 2] - points[a + 2];
    const x = uy * vz - uz * vy, y = uz * vx - ux * vz, z = ux * vy - uy * vx;
    for (const corner of [a, b, c]) {
      normals[corner] += x;
      normals[corner + 1] += y;
      normals[corner + 2] += z;
    }
  }
  for (let i = 0; i < normals.length; i += 3) {
    const length = Math.hypot(normals[i], normals[i + 1], normals[i + 2]) || 1;
    for (let k = 0; k < 3; ++k) normals[i + k] /= length;
  }
  return normals;
}

/// The edges of the box.
export function frameGeometry(space) {
  const places = [];
  for (let axis = 0; axis < 3; ++axis)
    for (let corner = 0; corner < 4; ++corner)
      for (const end of ['low', 'high']) {
        const place = [0, 0, 0];
        place[axis] = space[end][axis];
        place[(axis + 1) % 3] = space[corner & 1 ? 'high' : 'low'][(axis + 1) % 3];
        place[(axis + 2) % 3] = space[corner & 2 ? 'high' : 'low'][(axis + 2) % 3];
        places.push(...place);
      }
  const geometry = new three.BufferGeometry();
  geometry.setAttribute('position', attribute(new Float32Array(places), 3));
  return geometry;
}

/// The rectangle of the box where a coordinate is `at`.
export function cutGeometry(space, axis, at) {
  const [right, up] = [0, 1, 2].filter((other) => other !== axis);
  const places = new Float32Array(12);
  for (let corner = 0; corner < 4; ++corner) {
    places[3 * corner + axis] = at;
    places[3 * corner + right] = space[corner & 1 ? 'high' : 'low'][right];
    places[3 * corner + up] = space[corner & 2 ? 'high' : 'low'][up];
  }
  const geometry = new three.BufferGeometry();
  geometry.setAttribute('position', attribute(places, 3));
  geometry.setIndex([0, 1, 2, 1, 3, 2]);
  return geometry;
}

/// `center`: what explodes with the bond. `colors`: three bytes for each bond of the sample.
export function bondGeometry(sample, space, bonds, colors, as) {
  return as === 'discs' ? discs(sample, space, bonds, colors) : lines(sample, space, bonds, colors);
}

function discs(sample, space, bonds, colors) {
  const shortest = Math.min(...sample.edges);
  const radii = sample.bonds.column('radius');
  const normals = ['x', 'y', 'z'].map((axis) => sample.bonds.column(`normal_${axis}`));
  const places = [], centers = [], directions = [], shades = [], index = [];
  for (const bond of bonds) {
    const center = space.toWorld(sample.placeOf('bonds', bond));
    const n = normals.map((column) => column[bond]);
    const radius = radii[bond] / shortest;
    const first = places.length / 3;
    const { u, v } = across(n);
    for (let i = 0; i < kDiscCorners; ++i) {
      const angle = 2 * Math.PI * i / kDiscCorners;
      for (let k = 0; k < 3; ++k)
        places.push(center[k] + radius * (Math.cos(angle) * u[k] + Math.sin(angle) * v[k]));
      centers.push(...center);
      directions.push(...n);
      shades.push(...colors.subarray(3 * bond, 3 * bond + 3));
      if (i >= 2) index.push(first, first + i - 1, first + i);
    }
  }
  const geometry = bondAttributes(places, centers, directions, shades);
  geometry.setIndex(attribute(new Uint32Array(index), 1));
  return geometry;
}

function lines(sample, space, bonds, colors) {
  const places = [], shades = [];
  for (const bond of bonds)
    for (const end of ['first', 'second']) {
      places.push(...space.toWorld(sample.placeOf('grains', sample.bondEnds[end][bond])));
      shades.push(...colors.subarray(3 * bond, 3 * bond + 3));
    }
  return bondAttributes(places, places, places, shades);
}

function bondAttributes(places, centers, directions, shades) {
  const geometry = new three.BufferGeometry();
  geometry.setAttribute('color', new three.BufferAttribute(new Uint8Array(shades), 3, true));
  for (const [name, values] of [['position', places], ['center', centers], ['normal', directions]])
    geometry.setAttribute(name, attribute(new Float32Array(values), 3));
  return geometry;
}

/// Two directions across a third.
function across(n) {
  const least = n.map(Math.abs).indexOf(Math.min(...n.map(Math.abs)));
  const axis = [0, 0, 0];
  axis[least] = 1;
  const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
  const unit = (a) => a.map((value) => value / Math.hypot(...a));
  const u = unit(cross(n, axis));
  return { u, v: cross(n, u) };
}
