// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0
// The data elements of the page, as arrays.

export function element(id) {
  return document.getElementById(id);
}

export function json(id) {
  return JSON.parse(element(id).textContent);
}

/// The bytes of an element, or null if it is not there. The text is let go of.
export async function bytes(id) {
  const source = element(id);
  if (!source) return null;
  const text = atob(source.textContent);
  source.remove();
  const packed = new Uint8Array(text.length);
  for (let i = 0; i < text.length; ++i) packed[i] = text.charCodeAt(i);
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream('deflate'));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/// Columns of numbers, NaN where a cell is empty. `columns`: their names and powers of the length.
export function table(csv, columns) {
  const lines = csv.split('\n');
  lines.pop();
  const rows = lines.length - 1;
  const values = columns.map(() => new Float64Array(rows));
  for (let row = 0; row < rows; ++row) {
    const cells = lines[row + 1].split(',');
    for (let i = 0; i < columns.length; ++i)
      values[i][row] = cells[i] === '' ? NaN : Number(cells[i]);
  }
  const byName = new Map(columns.map((column, i) => [column.name, values[i]]));
  return { csv, lines, rows, columns, column: (name) => byName.get(name) };
}

/// Places of labels from 1 on, 0: none; x fastest.
export function labelVolume(packed, size, grains) {
  const count = size[0] * size[1] * size[2];
  const volume = grains < 65536 ? new Uint16Array(count) : new Uint32Array(count);
  let at = 0;
  function number() {
    let value = 0;
    for (let factor = 1; ; factor *= 128) {
      const byte = packed[at++];
      value += (byte & 127) * factor;
      if (byte < 128) return value;
    }
  }
  for (let to = 0; at < packed.length;) {
    const run = number();
    volume.fill(number(), to, to + run);
    to += run;
  }
  return volume;
}

/// The bodies of the grains one after the other: grain g has the points from firstPoint[g] on, its
/// triangles name points of the whole. Places in voxels.
export function grainMesh(packed, about, grains) {
  const header = new DataView(packed.buffer, packed.byteOffset);
  const unsigned = (i) => header.getUint32(4 * i, true);
  const signed = (i) => header.getInt32(4 * i, true);
  const { points, triangles, step } = about;
  let at = 4 * 5 * grains;
  function planes(count, width) {
    const values = new Uint32Array(count);
    for (let plane = 0; plane < width; ++plane)
      for (let i = 0; i < count; ++i) values[i] |= packed[at++] << (8 * plane);
    return values;
  }
  const positions = new Float32Array(3 * points);
  const grainOf = new Float32Array(points);
  const firstPoint = new Uint32Array(grains + 1);
  const firstTriangle = new Uint32Array(grains + 1);
  for (let g = 0; g < grains; ++g) {
    firstPoint[g + 1] = firstPoint[g] + unsigned(g);
    firstTriangle[g + 1] = firstTriangle[g] + unsigned(grains + g);
    grainOf.fill(g, firstPoint[g], firstPoint[g + 1]);
  }
  for (let axis = 0; axis < 3; ++axis) {
    const folded = planes(points, 2);
    for (let g = 0; g < grains; ++g) {
      let place = signed(2 * grains + 3 * g + axis);
      for (let i = firstPoint[g]; i < firstPoint[g + 1]; ++i) {
        place += folded[i] & 1 ? -((folded[i] + 1) >> 1) : folded[i] >> 1;
        positions[3 * i + axis] = place * step;
      }
    }
  }
  const corners = planes(3 * triangles, 4);
  for (let g = 0; g < grains; ++g) {
    let named = 0;
    for (let i = 3 * firstTriangle[g]; i < 3 * firstTriangle[g + 1]; ++i) {
      const distance = corners[i];
      corners[i] = firstPoint[g] + named - distance;
      if (distance === 0) ++named;
    }
  }
  return { positions, grainOf, corners, firstPoint, firstTriangle };
}
