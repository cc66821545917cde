// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0
// Values counted in bins.

const kMostBins = 40;

/// As many as Rice's rule says; of whole numbers (`discrete`) one each, or for as many as it takes.
export function binEdges(values, discrete) {
  let low = Infinity, high = -Infinity, known = 0;
  for (const value of values) {
    if (Number.isNaN(value)) continue;
    low = Math.min(low, value);
    high = Math.max(high, value);
    ++known;
  }
  if (known === 0) [low, high] = [0, 1];
  let count = Math.max(5, Math.min(kMostBins, Math.round(2 * Math.cbrt(known))));
  if (discrete) {
    const width = Math.ceil((high - low + 1) / kMostBins);
    low -= 0.5;
    count = Math.ceil((high + 0.5 - low) / width);
    high = low + count * width;
  } else if (high === low) {
    [low, high] = [low - (Math.abs(low) / 2 || 0.5), high + (Math.abs(high) / 2 || 0.5)];
  }
  return Array.from({ length: count + 1 }, (_, i) => low + (high - low) * i / count);
}

/// The weights (1, if null) in each bin, of all rows or of those whose flag is set.
export function sumsOf(values, weights, edges, flags = null) {
  const count = edges.length - 1, low = edges[0], high = edges[count];
  const sums = new Array(count).fill(0);
  for (let row = 0; row < values.length; ++row) {
    if (Number.isNaN(values[row]) || (flags && !flags[row])) continue;
    const bin = Math.floor((values[row] - low) / (high - low) * count);
    sums[Math.max(0, Math.min(count - 1, bin))] += weights ? weights[row] : 1;
  }
  return sums;
}

/// Two standard errors of the weights in each bin (of counts, if null), as if rows came by chance:
/// of weights as shares, in percent of those of all rows.
export function doubtsOf(values, weights, edges, flags) {
  if (!weights) return sumsOf(values, null, edges, flags).map((count) => 2 * Math.sqrt(count));
  const squares = weights.map((weight) => weight * weight);
  return shareDoubts(sumsOf(values, weights, edges, flags), sumsOf(values, squares, edges, flags),
    sumsOf(values, weights, edges), sumsOf(values, squares, edges)).map((doubt) => 100 * doubt);
}

/// Two standard errors of the shares that sums have of the whole, with sums of squares (of ratios).
export function shareDoubts(sums, squares, whole = sums, wholeSquares = squares) {
  const add = (list) => list.reduce((a, b) => a + b, 0);
  const total = add(whole), square = add(wholeSquares);
  return sums.map((sum, i) => {
    const share = total > 0 ? sum / total : 0;
    return total > 0 ? 2 * Math.sqrt((1 - 2 * share) * squares[i] + share * share * square) / total : 0;
  });
}

export function inPercent(sums, total) {
  return sums.map((sum) => (total > 0 ? 100 * sum / total : 0));
}
