// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

/// Eigenvalues, the largest first, and directions (largest component positive) of a symmetric matrix
/// xx, yy, zz, xy, xz, yz: by Jacobi's rotations.
export function principalAxes([xx, yy, zz, xy, xz, yz]) {
  const a = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]];
  const v = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
  const enough = 1e-12 * (Math.abs(xx) + Math.abs(yy) + Math.abs(zz));
  while (Math.abs(a[0][1]) + Math.abs(a[0][2]) + Math.abs(a[1][2]) > enough)
    for (const [p, q] of [[0, 1], [0, 2], [1, 2]]) {
      if (a[p][q] === 0) continue;
      const theta = (a[q][q] - a[p][p]) / (2 * a[p][q]);
      const t = (theta < 0 ? -1 : 1) / (Math.abs(theta) + Math.sqrt(theta * theta + 1));
      const c = 1 / Math.sqrt(t * t + 1), s = t * c;
      const turn = (rows, at) => {
        const [x, y] = [rows[at][p], rows[at][q]];
        rows[at][p] = c * x - s * y;
        rows[at][q] = s * x + c * y;
      };
      for (let k = 0; k < 3; ++k) turn(a, k);
      [a[p], a[q]] = [a[p].map((x, k) => c * x - s * a[q][k]), a[q].map((y, k) => s * a[p][k] + c * y)];
      for (let k = 0; k < 3; ++k) turn(v, k);
    }
  const order = [0, 1, 2].sort((i, j) => a[j][j] - a[i][i]);
  return { values: order.map((i) => a[i][i]),
    axes: order.map((i) => {
      const axis = v.map((row) => row[i]);
      const sign = axis.reduce((most, value) => (Math.abs(value) > Math.abs(most) ? value : most)) < 0 ? -1 : 1;
      return axis.map((value) => sign * value);
    }) };
}
