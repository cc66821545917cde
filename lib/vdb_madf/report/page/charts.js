// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0
// Charts of what passes the filters, over all; dragging in one sets a filter.
import { binEdges, doubtsOf, inPercent, sumsOf } from './bins.js';
import { element } from './decode.js';
import { Plot } from './plot.js';
import { fullRose, quarterRose, tensorRose } from './roses.js';
import { make } from './sample.js';

/// Bars of the values of a column, each counted as one or by its weight.
class Histogram {
  constructor(sample, selection, { kind, name, title, weight, discrete, what }) {
    Object.assign(this, { sample, selection, kind, name, weight, discrete });
    this.flags = () => (kind === 'grains' ? selection.visible : selection.visibleBonds);
    this.plot = new Plot(title || sample.titleOf(name), sample.titleWithUnit(kind, name), what, { x: [0, 1] });
    this.load();
    this.plot.onDrag(([low, high]) => selection.setFilter(kind, name, this.rounded(low, high)),
      () => selection.setFilter(kind, name, null));
    this.figure = this.plot.figure;
  }

  /// Takes the numbers of the sample as it is now.
  load() {
    const { sample, kind, name, weight, discrete } = this;
    this.values = sample[kind].column(name);
    this.weights = weight && sample[kind].column(weight);
    this.edges = binEdges(this.values, discrete);
    this.total = sumsOf(this.values, this.weights, this.edges).reduce((a, b) => a + b, 0);
    this.plot.x = [this.edges[0], this.edges[this.edges.length - 1]];
  }

  sums(flags) {
    const sums = sumsOf(this.values, this.weights, this.edges, flags);
    return this.weights ? inPercent(sums, this.total) : sums;
  }

  /// A range with few digits, for the field of the table.
  rounded(low, high) {
    if (this.discrete) return [Math.ceil(low), Math.floor(high)];
    const digits = Math.ceil(-Math.log10((high - low) || 1)) + 2;
    const factor = 10 ** digits;
    return [low, high].map((value) => Math.round(value * factor) / factor);
  }

  draw() {
    const all = this.sums(null), shown = this.sums(this.flags());
    const doubts = doubtsOf(this.values, this.weights, this.edges, this.flags());
    this.plot.clear(Math.max(...all, ...shown.map((sum, i) => sum + doubts[i])));
    this.plot.bars(this.edges, all, 'all');
    this.plot.bars(this.edges, shown, 'shown');
    this.plot.whiskers(this.edges, shown, doubts);
    this.plot.mark(this.selection.filters[this.kind].get(this.name));
  }
}

/// A point a grain; dragging filters by both columns.
class Scatter {
  constructor(sample, selection, title, names) {
    Object.assign(this, { sample, selection, names });
    this.load();
    this.plot = new Plot(title, sample.titleOf(names[0]), sample.titleOf(names[1]), { x: [0, 1], y: [0, 1] });
    this.plot.onDrag((x, y) => this.filter([x, y]), () => this.filter([null, null]));
    this.figure = this.plot.figure;
  }

  load() {
    this.values = this.names.map((name) => this.sample.grains.column(name));
  }

  filter(ranges) {
    const { grains } = this.selection.filters;
    this.names.forEach((name, i) => {
      const range = ranges[i] && ranges[i].map((value) => Math.round(value * 1000) / 1000);
      if (range) grains.set(name, range); else grains.delete(name);
    });
    this.selection.changed('filter');
  }

  draw() {
    const { visible, filters } = this.selection;
    this.plot.clear(1);
    for (const [flag, look] of [[0, 'all'], [1, 'shown']]) {
      const rows = Array.from(visible.keys()).filter((row) => visible[row] === flag);
      this.plot.points(rows.map((row) => [this.values[0][row], this.values[1][row]]), look);
    }
    this.plot.mark(...this.names.map((name) => filters.grains.get(name)));
    this.plot.zinggLines();
  }
}

export function startCharts(sample, selection) {
  const grains = (spec) => new Histogram(sample, selection, { kind: 'grains', what: 'grains', ...spec });
  const charts = [
    grains({ name: 'equivalent_diameter', title: 'Diameter, by number' }),
    grains({ name: 'equivalent_diameter', title: 'Diameter, by volume', weight: 'volume', what: '% of volume' }),
    grains({ name: 'coordination', title: 'Bonds a grain', discrete: true }),
    new Histogram(sample, selection, { kind: 'bonds', name: 'radius_ratio', title: 'Bond size', what: 'bonds' }),
    grains({ name: 'sphericity', title: 'Sphericity' }),
    new Scatter(sample, selection, 'Shape (Zingg)', ['aspect_3_to_2', 'aspect_2_to_1']),
    fullRose(sample, selection, 'Bonds, direction in x-y, by area', 'bonds', 'normal', 'area'),
    quarterRose(sample, selection, 'Bonds, angle to z, by area', 'bonds', 'normal', 'area'),
    quarterRose(sample, selection, 'Long axes, angle to z, by volume', 'grains', 'axis1', 'volume'),
  ];
  const { bond_conductivity_tensor: conducts } = sample.numbers;
  const conductivity = conducts ? [tensorRose('Bonds conduct, of the full box', conducts.tensor)] : [];
  element('charts').append(make('h2', {}, 'Charts'),
    make('p', { className: 'hint' }, 'Gray: all. Blue: what passes the filters. Drag in a chart to filter by it, click in it to take that back. Circles of roses: no preferred direction. Whiskers: two standard errors, by the numbers counted; a sector whose whisker reaches the circle shows no preference.'),
    make('div', { className: 'panels' }, ...charts.map((chart) => chart.figure), ...conductivity));
  const drawAll = () => charts.forEach((chart) => chart.draw());
  let isDue = false;
  selection.listen((what) => {
    if (what === 'filter' && !isDue) drawAll();
    if (what !== 'strictness' || isDue) return;
    // The view and the slices are what a reader looks at: charts come after their picture.
    isDue = true;
    requestAnimationFrame(() => setTimeout(() => {
      isDue = false;
      charts.forEach((chart) => chart.load());
      drawAll();
    }));
  });
  drawAll();
}
