// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

/// Eigenvalues, the largest first, and directions (largest component positive) of a symmetric matrix
/// xx, yy, zz, xy, xz, yz: by Jacobi's rotations.
export function principalAxes([xx, yy, zz, xy, xz, yz]) {
  const d = [xx, yy, zz], o = [yz, xz, xy];  // o[k]: of the two axes beside k
  const v = [1, 0, 0, 0, 1, 0, 0, 0, 1];
  const enough = 1e-12 * (Math.abs(xx) + Math.abs(yy) + Math.abs(zz));
  while (Math.abs(o[0]) + Math.abs(o[1]) + Math.abs(o[2]) > enough)
    for (let k = 0; k < 3; ++k) {
      if (o[k] === 0) continue;
      const p = (k + 1) % 3, q = (k + 2) % 3;
      const theta = (d[q] - d[p]) / (2 * o[k]);
      const t = (theta < 0 ? -1 : 1) / (Math.abs(theta) + Math.sqrt(theta * theta + 1));
      const c = 1 / Math.sqrt(t * t + 1), s = t * c;
      d[p] -= t * o[k];
      d[q] += t * o[k];
      o[k] = 0;
      const kp = o[q], kq = o[p];
      o[q] = c * kp - s * kq;
      o[p] = s * kp + c * kq;
      for (let row = 0; row < 9; row += 3) {
        const x = v[row + p], y = v[row + q];
        v[row + p] = c * x - s * y;
        v[row + q] = s * x + c * y;
      }
    }
  const order = [0, 1, 2].sort((i, j) => d[j] - d[i]);
  return { values: order.map((i) => d[i]),
    axes: order.map((i) => {
      const axis = [v[i], v[3 + i], v[6 + i]];
      const largest = axis.reduce((most, value) => (Math.abs(value) > Math.abs(most) ? value : most));
      return largest < 0 ? axis.map((value) => -value) : axis;
    }) };
}
