// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0
// What is selected, filtered and how it is shown: the one state that all parts of the page follow.
import { colorsOf } from './looks.js';

export const kHidden = 0, kPale = 85, kPlain = 170, kSelected = 255;

export class Selection {
  constructor(sample) {
    this.sample = sample;
    this.listeners = [];
    this.selected = new Set();  // rows of grains
    this.absent = [];  // numbers of grains that are selected, but in another scan
    this.scan = 0;
    this.filters = { grains: new Map(), bonds: new Map() };  // column name: [low, high]
    this.insideOnly = false;
    this.only = null;  // { bodies, absent } of grains that were selected to pass alone; null: all may
    this.colorBy = '';  // a column of grains; '': the labels' colors
    this.others = 'pale';  // grains beside the selected: pale, plain or hidden
    this.bondsAs = 'none';  // none, discs or lines
    this.bondColorBy = '';  // a column of bonds; '': one color
    this.explode = 0;
    // An axis each: where it is cut, as a share of the box; what lies beyond is not shown.
    this.cuts = [1, 1, 1];
    this.flips = [false, false, false];
    const { size } = sample.about.slices;
    this.slices = size.map((count) => Math.floor(count / 2));
    this.slicesAs = sample.gray ? 'outlines' : 'grains';  // or 'scan'
    this.edits = [];
    this.editsAt = null;  // the strictness that they are of, if the page knows one
    this.showsParts = false;  // of a grain that is selected alone, in two colors
    this.unit = sample.shownUnit;
    this.theme = null;  // that of the system
    this.strictness = null;  // that of the labels
    this.pieces = [];  // bodies: see setStrictness()
    this.startFlags();
    this.updateColors();
    this.updateParts();
  }

  updateColors() {
    this.colors = colorsOf(this.sample, 'grains', this.colorBy);
    this.bondColors = colorsOf(this.sample, 'bonds', this.bondColorBy);
  }

  startFlags() {
    const { sample } = this;
    this.visible = new Uint8Array(sample.count).fill(1);
    this.visibleBonds = new Uint8Array(sample.bonds.rows).fill(1);
    this.passingBonds = new Uint8Array(sample.bonds.rows).fill(1);  // their grains may not
    this.states = new Uint8Array(sample.count).fill(kPlain);
  }

  /// Another one, or null for that of the labels. Filters stay; selected are the grains that have
  /// the largest pieces of those that a reader has selected, also on the way back.
  setStrictness(strictness) {
    this.keepPieces();
    this.strictness = strictness;
    this.sample.setStrictness(strictness);
    this.selected = this.rowsOf(this.pieces);
    this.startFlags();
    this.changed('strictness');
  }

  keepPieces() {
    const before = this.rowsOf(this.pieces);
    if (before.size !== this.selected.size || [...before].some((row) => !this.selected.has(row)))
      this.pieces = this.bodiesOf([...this.selected]);
  }

  /// The largest body of each grain, and the grains of bodies.
  bodiesOf(rows) {
    const { levels, rowOfBody } = this.sample;
    return levels ? rows.map((row) => levels.largestLeaf(rowOfBody, row)) : rows;
  }
  rowsOf(bodies) {
    return new Set(bodies.map((body) => this.sample.rowOfBody[body]));
  }

  /// call(what): 'selection', 'filter', 'looks', 'cuts', 'slices', 'edits', 'camera', 'theme',
  /// 'strictness' (all of the sample is new)
  listen(call) {
    this.listeners.push(call);
  }

  changed(...what) {
    const isNew = what.includes('strictness');
    if (isNew || what.includes('filter')) this.applyFilters();
    if (isNew || what.includes('looks')) this.updateColors();
    if (isNew || what.includes('selection') || what.includes('looks')) this.updateParts();
    this.updateStates();
    for (const one of what) for (const call of this.listeners) call(one);
  }

  select(rows, more = false) {
    if (!more) {
      this.selected.clear();
      this.absent = [];
    }
    for (const row of rows)
      if (more && this.selected.has(row)) this.selected.delete(row); else this.selected.add(row);
    const last = rows[rows.length - 1];
    if (last !== undefined && this.selected.has(last)) {
      this.goTo(this.sample.placeOf('grains', last));
      this.changed('selection', 'slices');
    } else {
      this.changed('selection');
    }
  }

  /// Slices through a place, index coordinates.
  goTo(place) {
    const { factor, min, size } = this.sample.about.slices;
    this.slices = place.map((value, axis) =>
      Math.max(0, Math.min(size[axis] - 1, Math.floor((value + 0.5) / factor) - min[axis])));
  }

  setFilter(kind, name, range) {
    if (range) this.filters[kind].set(name, range); else this.filters[kind].delete(name);
    this.changed('filter');
  }

  /// Only the grains that are selected now pass, whatever is selected later; or all may again.
  setOnly(isOn) {
    this.keepPieces();
    this.only = isOn ? { bodies: this.pieces, absent: this.absent } : null;
    this.changed('filter');
  }
  get onlyRows() {
    return this.rowsOf(this.only ? this.only.bodies : []);
  }

  /// For the page when it is opened anew: filters keep what they let pass.
  useUnit(unit) {
    const factor = this.sample.factorTo(unit) / this.sample.factor;
    for (const kind of ['grains', 'bonds'])
      for (const [name, range] of this.filters[kind]) {
        const scale = factor ** this.sample.columnOf(kind, name).power;
        this.filters[kind].set(name, range.map((value) => Number((scale * value).toPrecision(12))));
      }
    this.unit = unit;
  }

  clearFilters() {
    this.filters.grains.clear();
    this.filters.bonds.clear();
    this.insideOnly = false;
    this.only = null;
    this.changed('filter');
  }

  get grainFilterCount() {
    return this.filters.grains.size + (this.insideOnly ? 1 : 0) + (this.only ? 1 : 0);
  }
  get filterCount() {
    return this.grainFilterCount + this.filters.bonds.size;
  }

  applyFilters() {
    const { grains, bonds, bondEnds } = this.sample;
    this.visible.fill(this.only ? 0 : 1);
    for (const row of this.onlyRows) this.visible[row] = 1;
    restrict(this.visible, grains, this.filters.grains);
    if (this.insideOnly)
      for (let row = 0; row < grains.rows; ++row) if (this.sample.isCut(row)) this.visible[row] = 0;
    this.passingBonds.fill(1);
    restrict(this.passingBonds, bonds, this.filters.bonds);
    for (let bond = 0; bond < bonds.rows; ++bond)
      this.visibleBonds[bond] = this.passingBonds[bond] & this.visible[bondEnds.first[bond]] & this.visible[bondEnds.second[bond]];
  }

  /// Hidden, pale, plain or selected, for each grain.
  updateStates() {
    const others = this.selected.size === 0 ? kPlain
      : { pale: kPale, plain: kPlain, hidden: kHidden }[this.others];
    for (let row = 0; row < this.sample.count; ++row)
      this.states[row] = this.visible[row] ? others : kHidden;
    for (const row of this.selected)
      for (const neighbor of this.neighbors(row))
        if (this.visible[neighbor]) this.states[neighbor] = kPlain;
    for (const row of this.selected) this.states[row] = kSelected;
  }

  neighbors(row) {
    const { first, second } = this.sample.bondEnds;
    return this.sample.bondsOf[row].map((bond) => (first[bond] === row ? second[bond] : first[bond]));
  }

  /// The strictness that the page shows; null: it has no levels.
  get shownStrictness() {
    const { levels } = this.sample;
    return !levels ? null : this.strictness === null ? levels.own : this.strictness;
  }

  /// parts: what a grain that is selected alone was made of (Levels.partsOf()); null: none is known.
  updateParts() {
    const { levels, rowOfBody } = this.sample;
    const [row] = this.selected;
    this.parts = levels && this.selected.size === 1 ? levels.partsOf(this.shownStrictness, rowOfBody, row) : null;
    this.secondPart = new Set(this.showsParts && this.parts ? this.parts.parts[1].bodies : []);
  }

  addEdits(...edits) {
    this.editsAt = this.shownStrictness;
    this.edits.push(...edits.filter((edit) => !this.edits.includes(edit)));
    this.changed('edits');
  }
  /// The numbers of grains mean something at the strictness alone that the list is of.
  get mayEdit() {
    return this.edits.length === 0 || this.editsAt === this.shownStrictness;
  }

  /// Bonds to draw: those of the selected grains, or all.
  shownBonds() {
    const { first, second } = this.sample.bondEnds;
    const shown = [];
    for (let bond = 0; bond < this.visibleBonds.length; ++bond)
      if (this.visibleBonds[bond] && (this.selected.size === 0 ||
          this.selected.has(first[bond]) || this.selected.has(second[bond]))) shown.push(bond);
    return shown;
  }
}

function restrict(flags, table, filters) {
  for (const [name, [low, high]] of filters) {
    const values = table.column(name);
    for (let row = 0; row < flags.length; ++row)
      if (!(values[row] >= low && values[row] <= high)) flags[row] = 0;
  }
}
