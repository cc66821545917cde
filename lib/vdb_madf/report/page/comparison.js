// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0
// Several samples side by side: numbers, pictures, distributions, roses.
import { binEdges, doubtsOf, inPercent, sumsOf } from './bins.js';
import { element } from './decode.js';
import { Plot } from './plot.js';
import { fullRose, quarterRose } from './roses.js';
import { lineColors, make, Sample } from './sample.js';
import { originOf, tellMaker, tiles, warnings } from './summary.js';

const distributions = [
  { kind: 'grains', name: 'equivalent_diameter', title: 'Diameter, by number', what: '% of grains' },
  { kind: 'grains', name: 'equivalent_diameter', title: 'Diameter, by volume', weight: 'volume', what: '% of volume' },
  { kind: 'grains', name: 'coordination', title: 'Bonds a grain', discrete: true, what: '% of grains' },
  { kind: 'bonds', name: 'radius_ratio', title: 'Bond size', what: '% of bonds' },
  { kind: 'grains', name: 'sphericity', title: 'Sphericity', what: '% of grains' },
  { kind: 'grains', name: 'aspect_2_to_1', title: 'Elongation', what: '% of grains' },
];

export async function startComparison(count) {
  document.body.classList.add('several');
  const samples = [];
  for (let i = 0; i < count; ++i) samples.push(await Sample.load(`-${i}`, i > 0 ? samples[0].shownUnit : null));
  element('origin').textContent = `${count} samples`;
  element('numbers').append(numbersTable(samples));
  element('warnings').append(...samples.filter((sample) => warnings(sample).length > 0).map((sample) =>
    make('details', {}, make('summary', {}, `${sample.about.title}: what to be wary of`),
      make('ul', {}, ...warnings(sample).map((text) => make('li', {}, text))))));
  element('charts').append(make('h2', {}, 'Pictures'), pictures(samples), make('h2', {}, 'Distributions'),
    legend(samples), make('div', { className: 'panels' }, ...distributions.map((spec) => overlaid(samples, spec))),
    ...roses(samples));
  tellMaker(samples[0].about.version, samples.map(({ numbers }) => numbers.labels_digest));
}

function numbersTable(samples) {
  const columns = samples.map((sample) => tiles(sample));
  const head = make('tr', {}, make('td', {}), ...samples.map(({ about }) => make('th', { scope: 'col' }, about.title)));
  const rows = columns[0].map(([title], row) => make('tr', {}, make('th', { scope: 'row' }, title),
    ...columns.map((values) => make('td', {}, values[row][1]))));
  return make('table', { className: 'table' }, make('thead', {}, head), make('tbody', {}, ...rows));
}

function pictures(samples) {
  return make('div', { className: 'panels' }, ...samples.map((sample, i) => make('figure', {},
    make('figcaption', {}, sample.about.title), element(`picture-${i}`),
    make('p', { className: 'hint' }, originOf(sample)))));
}

function colorOf(i) {
  return lineColors[i % lineColors.length];
}

function legend(samples) {
  return make('ul', { className: 'legend' }, ...samples.map((sample, i) => {
    const line = make('i');
    line.style.borderTop = `4px solid ${colorOf(i)}`;
    return make('li', {}, line, sample.about.title);
  }));
}

/// Shares of each sample in the same bins.
function overlaid(samples, { kind, name, title, weight, discrete, what }) {
  const values = samples.map((sample) => sample[kind].column(name));
  const edges = binEdges(values.flatMap((column) => Array.from(column)), discrete);
  const plot = new Plot(title, samples[0].titleWithUnit(kind, name), what, { x: [edges[0], edges[edges.length - 1]] });
  const shares = samples.map((sample, i) => {
    const sums = sumsOf(values[i], weight && sample[kind].column(weight), edges);
    return inPercent(sums, sums.reduce((a, b) => a + b, 0));
  });
  const doubts = samples.map((sample, i) => doubtsOf(values[i],
    weight ? sample[kind].column(weight) : values[i].map(() => 1), edges));
  plot.clear(Math.max(...shares.flatMap((heights, i) => heights.map((height, bin) => height + doubts[i][bin]))));
  shares.forEach((heights, i) => {
    plot.steps(edges, heights, colorOf(i));
    plot.whiskers(edges, heights, doubts[i], colorOf(i), (i + 1) / (samples.length + 1));
  });
  return plot.figure;
}

function roses(samples) {
  const kinds = [['Bonds, direction in x-y, by area', fullRose, 'bonds', 'normal', 'area'],
    ['Bonds, angle to z, by area', quarterRose, 'bonds', 'normal', 'area'],
    ['Long axes, angle to z, by volume', quarterRose, 'grains', 'axis1', 'volume']];
  return kinds.flatMap(([title, makeRose, kind, name, weight]) => {
    const figures = samples.map((sample) => {
      const all = { visible: new Uint8Array(sample.count).fill(1),
        visibleBonds: new Uint8Array(sample.bonds.rows).fill(1) };
      const rose = makeRose(sample, all, sample.about.title, kind, name, weight);
      rose.draw();
      return rose.figure;
    });
    return [make('h2', {}, title), make('div', { className: 'panels' }, ...figures)];
  });
}
