// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0
// What the page shows: the tables, colors and labels of one sample, and how numbers are written.
import { bytes, grainMesh, json, labelVolume, table } from './decode.js';
import { Levels } from './levels.js';
import { colorsOfUnions } from './looks.js';

const powers = { '-2': '1/u\u00b2', '-1': '1/u', 1: 'u', 2: 'u\u00b2', 3: 'u\u00b3' };

const titles = {
  __proto__: null,  // columns may have any name
  id: 'grain', first: 'grain 1', second: 'grain 2', faces: 'voxel faces',
  at_domain_face: 'cut by a face', equivalent_diameter: 'diameter', coordination: 'bonds',
  radius_ratio: 'bond radius / grain radius', aspect_2_to_1: 'axis 2 / axis 1',
  aspect_3_to_2: 'axis 3 / axis 2', cos_alpha: 'cos alpha',
  cut_x: 'minimum cut, x', cut_y: 'minimum cut, y', cut_z: 'minimum cut, z',
  current_x: 'current, x', current_y: 'current, y', current_z: 'current, z',
};

/// What columns mean whose titles do not say it.
const hints = {
  __proto__: null,  // columns may have any name
  cos_alpha: 'cos alpha: by the law of cosines, of the radii at the deepest places of two grains and the distance of these; above 1 where the balls there do not meet.',
  vanishes: 'vanishes: the strictness from which on, downwards, the two grains of a bond are one. A bond is doubtful where that is near the strictness shown; none: they stay two as far as the slider goes.',
  born: 'born: above this strictness the grain is in parts; none: nowhere on the slider.',
  dies: 'dies: below this strictness the grain is part of another one; none: nowhere on the slider.',
  stability: 'stability: how far the strictness is from where the grain is in parts, or part of another one. From 1 on it is sure.',
  patches: 'patches: the parts of an interface that hang together.',
  flatness: 'flatness: variance of the places of a bond across it; 0 for a plane.',
};

/// Of lines, told apart by those who are blind to a color, too (Okabe and Ito).
export const lineColors = ['#0072b2', '#d55e00', '#009e73', '#cc79a7', '#e69f00', '#56b4e9', 'currentColor', '#999999'];

const perMetre = { nm: 1e9, um: 1e6, mm: 1e3 };
const smaller = { mm: 'um', um: 'nm' };
const kShort = 0.1;  // of a unit, for the size of a grain

export class Sample {
  /// Its tables. `suffix`: of the ids of its elements; `unit`: to show lengths in, if it is one of
  /// `units`, else the one in which grains are easiest to read.
  static async load(suffix = '', unit = null) {
    const sample = new Sample();
    sample.isOwn = true;
    sample.suffix = suffix;
    sample.about = json(`about${suffix}`);
    sample.numbers = json(`sample${suffix}`);
    sample.chooseUnit(unit);
    const text = new TextDecoder();
    const { columns } = sample.about;
    sample.grains = sample.inUnit(table(text.decode(await bytes(`grains${suffix}`)), columns.grains));
    sample.bonds = sample.inUnit(table(text.decode(await bytes(`bonds${suffix}`)), columns.bonds));
    sample.link();
    return sample;
  }

  chooseUnit(unit) {
    const { unit: own, edges, voxelSizeKnown } = this.about;
    const isCube = new Set(edges).size === 1;
    this.units = voxelSizeKnown ? [...Object.keys(perMetre), ...(isCube ? ['voxel'] : [])] : [own];
    const { d50 } = this.numbers[`grain_diameter_by_volume_${own}`];
    this.usualUnit = smaller[own] && d50 > 0 && d50 < kShort ? smaller[own] : own;
    this.shownUnit = this.units.includes(unit) ? unit : this.usualUnit;
    this.factor = this.factorTo(this.shownUnit);
    this.edges = edges.map((edge) => edge * this.factor);
  }

  /// From the unit of the files.
  factorTo(unit) {
    const { unit: own, edges } = this.about;
    return unit === own ? 1 : unit === 'voxel' ? 1 / edges[0] : perMetre[unit] / perMetre[own];
  }

  /// A table with its columns in the unit that is shown; its lines are those of the file.
  inUnit(file) {
    const made = new Map();
    const column = (name) => {
      const power = file.columns.find((one) => one.name === name)?.power;
      if (!power || this.factor === 1) return file.column(name);
      if (!made.has(name)) made.set(name, file.column(name).map((value) => value * this.factor ** power));
      return made.get(name);
    };
    return Object.assign(Object.create(file), { columns: file.columns, column });
  }

  async loadVoxels() {
    this.colors = await bytes(`colors${this.suffix}`);
    this.levels = await Levels.load(this.about);
    // Bodies: what slices and mesh are made of, the grains or the leaves of the levels.
    this.bodies = this.levels ? this.levels.leaves : this.count;
    this.rowOfBody = this.levels ? Uint32Array.from(this.levels.ownGrain, (id) => this.rowOf.get(id))
      : Uint32Array.from({ length: this.count }, (_, row) => row);
    this.volume = labelVolume(await bytes(`labels${this.suffix}`), this.about.slices.size, this.bodies);
    this.gray = await bytes(`gray${this.suffix}`);  // of the scan, as the volume; null: not there
    if (this.levels) this.addLives(this.levels.own);
    this.own = { ...this };
  }

  /// Shows the grains at another strictness; null: those of the labels.
  setStrictness(strictness) {
    this.isOwn = strictness === null;
    if (this.isOwn) {
      Object.assign(this, this.own);
      return;
    }
    const { rowOfBody, grains, bonds } = this.levels.at(strictness, this.own);
    Object.assign(this, { rowOfBody, grains: this.inUnit(grains), bonds: this.inUnit(bonds) });
    this.link();
    this.addLives(strictness);
    const { numbers } = this.own;
    this.numbers = { ...numbers, bonds_without_curvature: 0, expected_bias_percent: {},
      segmentation: { ...numbers.segmentation, strictness } };
    this.colors = colorsOfUnions(this);
  }

  async loadMesh() {
    const packed = await bytes(`mesh${this.suffix}`);
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
    addColumn(bonds, 'radius_ratio', ratio);
    this.bondOfPair = new Map(Array.from(first, (one, bond) => [one * this.count + second[bond], bond]));
  }

  /// How sure grains and bonds are, as far as the slider goes.
  addLives(strictness) {
    const { born, dies, stability, vanishes } = this.levels.lives(strictness, this.rowOfBody, this.count, this.bondEnds);
    for (const [name, values] of Object.entries({ born, dies, stability })) addColumn(this.grains, name, values);
    addColumn(this.bonds, 'vanishes', vanishes);
  }

  /// That of two rows of grains; -1: none.
  bondBetween(one, other) {
    return this.bondOfPair.get(Math.min(one, other) * this.count + Math.max(one, other)) ?? -1;
  }

  unit(power) {
    const name = this.shownUnit === 'um' ? '\u00b5m'
      : this.shownUnit === 'voxel' && power > 0 ? 'voxels' : this.shownUnit;
    return power ? powers[power].replace('u', name) : '';
  }

  /// A length with its unit.
  length(value, digits = 4) {
    return `${written(value, digits)} ${this.unit(1)}`;
  }

  /// The numbers of the grains and bonds whose flags are set, lengths in the unit that is shown.
  /// A bond to a grain that is not visible counts for the visible one alone.
  summary(visible, passingBonds) {
    const { grains, bonds, numbers, factor, about } = this;
    const { first, second } = this.bondEnds;
    const visibleEnds = passingBonds.map((passes, bond) => passes * (visible[first[bond]] + visible[second[bond]]));
    const visibleBonds = visibleEnds.map((ends) => ends === 2);
    const isAll = this.isOwn && !visible.includes(0) && !visibleBonds.includes(0);
    const sum = (values, flags) => values.reduce((total, value, row) => total + (flags[row] ? value : 0), 0);
    const volume = grains.column('volume'), shownVolume = sum(volume, visible);
    const count = sum(visible, visible), bondCount = sum(visibleBonds, visibleBonds);
    const share = visible.includes(0) ? shownVolume / sum(volume, volume) : 1;
    const surface = (numbers[`specific_surface_per_${about.unit}`] ?? NaN) / factor;
    const median = (by) => (isAll ? factor * (numbers[`grain_diameter_by_${by}_${about.unit}`].d50 ?? NaN)
      : medianOf(grains.column('equivalent_diameter'), by === 'number' ? visible : volume, visible));
    const shownSurface = this.isOwn && !visible.includes(0) ? surface
      : sum(grains.column('free_area'), visible) / shownVolume;
    return { grains: count, bonds: bondCount, solidFraction: share * numbers.solid_fraction,
      coordination: isAll ? numbers.mean_coordination : sum(visibleEnds, passingBonds) / count,
      diameterByVolume: median('volume'), diameterByNumber: median('number'), surface: shownSurface,
      ratio: isAll ? numbers.bond_to_grain_ratio : sum(bonds.column('radius_ratio'), visibleBonds) / bondCount,
      surfaceOfMass: numbers.specific_surface_m2_per_kg * shownSurface / surface,
      density: numbers.bulk_density_kg_per_m3 * share };
  }

  /// Beyond closed faces is nothing, so that grains there are whole.
  isCut(row) {
    return this.numbers.boundary !== 'closed' && this.grains.column('at_domain_face')[row] !== 0;
  }

  columnOf(kind, name) {
    return this[kind].columns.find((column) => column.name === name);
  }

  /// "equivalent diameter", and with the unit.
  titleOf(name) {
    if (name === 'at_domain_face' && this.numbers.boundary === 'closed') return 'at a face';
    return titles[name] || name.replace(/_/g, ' ');
  }
  /// What it means; empty where the title says that.
  hintOf(name) {
    return hints[name] || '';
  }
  titleWithUnit(kind, name) {
    const column = this.columnOf(kind, name);
    const unit = column ? this.unit(column.power) : '';
    return this.titleOf(name) + (unit ? ` (${unit})` : '');
  }

  /// Index coordinates of a place in the tables.
  placeOf(kind, row, name = 'centroid') {
    return ['x', 'y', 'z'].map((axis, i) => this[kind].column(`${name}_${axis}`)[row] / this.edges[i]);
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

/// One that the files do not have.
function addColumn(table, name, values) {
  const { column } = table;
  table.columns = [...table.columns, { name, power: 0, isDerived: true }];
  table.column = (one) => (one === name ? values : column(one));
}

function medianOf(values, weights, flags) {
  const rows = Array.from(values.keys()).filter((row) => flags[row]).sort((a, b) => values[a] - values[b]);
  const half = 0.5 * rows.reduce((sum, row) => sum + weights[row], 0);
  let below = 0;
  return values[rows.find((row) => (below += weights[row]) >= half)];
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
