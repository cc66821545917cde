// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0
// What the page shows: the tables, colors and labels of one sample, and how numbers are written.
import { bytes, grainMesh, json, labelVolume, table } from './decode.js';
import { Levels } from './levels.js';
import { colorsOfUnions } from './looks.js';

const powers = { '-2': '1/u\u00b2', '-1': '1/u', 1: 'u', 2: 'u\u00b2', 3: 'u\u00b3' };

const titles = {
  id: 'grain', first: 'grain 1', second: 'grain 2', faces: 'voxel faces',
  at_domain_face: 'cut by a face', equivalent_diameter: 'diameter', coordination: 'bonds',
  radius_ratio: 'bond radius / grain radius', aspect_2_to_1: 'axis 2 / axis 1',
  aspect_3_to_2: 'axis 3 / axis 2', cos_alpha: 'cos alpha',
};

/// Of lines, told apart by those who are blind to a color, too (Okabe and Ito).
export const lineColors = ['#0072b2', '#d55e00', '#009e73', '#cc79a7', '#e69f00', '#56b4e9', '#000000', '#999999'];

export class Sample {
  /// Its tables. `suffix`: of the ids of its elements.
  static async load(suffix = '') {
    const sample = new Sample();
    sample.isOwn = true;
    sample.about = json(`about${suffix}`);
    sample.numbers = json(`sample${suffix}`);
    const text = new TextDecoder();
    const { columns } = sample.about;
    sample.grains = table(text.decode(await bytes(`grains${suffix}`)), columns.grains);
    sample.bonds = table(text.decode(await bytes(`bonds${suffix}`)), columns.bonds);
    sample.link();
    return sample;
  }

  async loadVoxels() {
    this.colors = await bytes('colors');
    this.levels = await Levels.load(this.about);
    // Bodies: what slices and mesh are made of, the grains or the leaves of the levels.
    this.bodies = this.levels ? this.levels.leaves : this.count;
    this.rowOfBody = this.levels ? Uint32Array.from(this.levels.ownGrain, (id) => this.rowOf.get(id))
      : Uint32Array.from({ length: this.count }, (_, row) => row);
    this.volume = labelVolume(await bytes('labels'), this.about.slices.size, this.bodies);
    this.own = { ...this };
  }

  /// Shows the grains at another strictness; null: those of the labels.
  setStrictness(strictness) {
    this.isOwn = strictness === null;
    if (this.isOwn) {
      Object.assign(this, this.own);
      return;
    }
    Object.assign(this, this.levels.at(strictness, this.own));
    this.link();
    this.numbers = numbersOf(this, strictness);
    this.colors = colorsOfUnions(this);
  }

  async loadMesh() {
    const packed = await bytes('mesh');
    return packed && grainMesh(packed, this.about.mesh, this.bodies);
  }

  /// Grains by number, rows of the grains of each bond, bonds of each grain, and the ratio of the
  /// radii.
  link() {
    const { bonds, grains } = this;
    this.count = grains.rows;
    this.ids = grains.column('id');
    this.rowOf = new Map(Array.from(this.ids, (id, row) => [id, row]));
    const [first, second] = ['first', 'second'].map((name) =>
      Uint32Array.from(bonds.column(name), (id) => this.rowOf.get(id)));
    this.bondEnds = { first, second };
    this.bondsOf = Array.from({ length: this.count }, () => []);
    const radius = bonds.column('radius'), diameter = grains.column('equivalent_diameter');
    const ratio = new Float64Array(bonds.rows);
    for (let bond = 0; bond < bonds.rows; ++bond) {
      this.bondsOf[first[bond]].push(bond);
      this.bondsOf[second[bond]].push(bond);
      ratio[bond] = 2 * radius[bond] / Math.min(diameter[first[bond]], diameter[second[bond]]);
    }
    const column = bonds.column;
    bonds.columns = [...bonds.columns, { name: 'radius_ratio', power: 0, isDerived: true }];
    bonds.column = (name) => (name === 'radius_ratio' ? ratio : column(name));
  }

  unit(power) {
    const { unit } = this.about;
    const name = unit === 'um' ? '\u00b5m' : unit === 'voxel' && power > 0 ? 'voxels' : unit;
    return power ? powers[power].replace('u', name) : '';
  }

  /// A length with its unit, micrometers where that is easier to read.
  length(value, digits = 4) {
    return this.about.unit === 'mm' && value > 0 && value < 0.1
      ? `${written(1000 * value, digits)} \u00b5m` : `${written(value, digits)} ${this.unit(1)}`;
  }

  columnOf(kind, name) {
    return this[kind].columns.find((column) => column.name === name);
  }

  /// "equivalent diameter", and with the unit.
  titleOf(name) {
    return titles[name] || name.replace(/_/g, ' ');
  }
  titleWithUnit(kind, name) {
    const column = this.columnOf(kind, name);
    const unit = column ? this.unit(column.power) : '';
    return this.titleOf(name) + (unit ? ` (${unit})` : '');
  }

  /// Index coordinates of a place in the tables.
  placeOf(kind, row, name = 'centroid') {
    return ['x', 'y', 'z'].map((axis, i) =>
      this[kind].column(`${name}_${axis}`)[row] / this.about.edges[i]);
  }

  /// From 1 on; 0: none.
  bodyAt(i, j, k) {
    const { size } = this.about.slices;
    return this.volume[(k * size[1] + j) * size[0] + i];
  }
  /// -1: none.
  rowAt(i, j, k) {
    const body = this.bodyAt(i, j, k);
    return body > 0 ? this.rowOfBody[body - 1] : -1;
  }
}

/// Those of the labels, but for what another strictness changes.
function numbersOf({ grains, bonds, own, about }, strictness) {
  const diameters = grains.column('equivalent_diameter');
  const median = (weights) => {
    const rows = Array.from(diameters.keys()).sort((a, b) => diameters[a] - diameters[b]);
    const half = 0.5 * weights.reduce((sum, weight) => sum + weight, 0);
    let below = 0;
    return { d50: diameters[rows.find((row) => (below += weights[row]) >= half)] };
  };
  const ratios = bonds.column('radius_ratio');
  return { ...own.numbers, grains: grains.rows, bonds: bonds.rows,
    mean_coordination: grains.rows > 0 ? 2 * bonds.rows / grains.rows : 0,
    bond_to_grain_ratio: bonds.rows > 0 ? ratios.reduce((sum, ratio) => sum + ratio, 0) / bonds.rows : null,
    [`grain_diameter_by_number_${about.unit}`]: median(diameters.map(() => 1)),
    [`grain_diameter_by_volume_${about.unit}`]: median(grains.column('voxels')),
    bonds_without_curvature: 0, segmentation: { ...own.numbers.segmentation, strictness } };
}

/// Four digits, without an exponent where that is short.
export function written(value, digits = 4) {
  if (value === null || value === undefined || Number.isNaN(value)) return '\u2013';
  if (Number.isInteger(value) && Math.abs(value) < 1e12) return String(value);
  const size = Math.abs(value);
  if (size >= 1e6 || size < 1e-4) return value.toExponential(digits - 1).replace('e+', 'e');
  return String(Number(value.toPrecision(digits)));
}

/// With thin spaces between thousands.
export function counted(value) {
  return String(value).replace(/\B(?=(\d{3})+$)/g, '\u2009');
}

/// An element with properties and children.
export function make(tag, properties = {}, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(properties))
    if (name in made) made[name] = value; else made.setAttribute(name, value);
  made.append(...children);
  return made;
}

export function makeSvg(tag, attributes = {}, ...children) {
  const made = document.createElementNS('http://www.w3.org/2000/svg', tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  made.append(...children);
  return made;
}
