// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0
// The grains at other strictnesses than that of the labels: each is a union of leaves, the grains at
// the largest one, and its measures are made of theirs.
import { bytes } from './decode.js';
import { principalAxes } from './principal.js';

const kUnitsOfScore = 512;
const kLeastOfSphericity = 27;  // voxels
const axes = ['x', 'y', 'z'];
const products = ['xx', 'yy', 'zz', 'xy', 'xz', 'yz'];
const normalColumns = axes.map((axis) => `normal_${axis}`);
const ellipsoidColumns = ['aspect_2_to_1', 'aspect_3_to_2',
  ...[1, 2, 3].flatMap((k) => [`axis${k}_length`, ...axes.map((axis) => `axis${k}_${axis}`)])];

/// Numbers of the next planes of bytes.
function planeReader(packed) {
  let at = 0;
  return (Type, count) => {
    const width = Type.BYTES_PER_ELEMENT, own = new Uint8Array(width * count);
    for (let plane = 0; plane < width; ++plane)
      for (let i = 0; i < count; ++i) own[width * i + plane] = packed[at++];
    return new Type(own.buffer);
  };
}

export class Levels {
  /// Null if the page has none.
  static async load(about) {
    return about.levels ? new Levels(about, await bytes('joins'), await bytes('leaves')) : null;
  }

  constructor(about, joins, leaves) {
    const { levels } = about;
    Object.assign(this, levels, { edges: about.edges });
    const next = planeReader(joins);
    this.ownGrain = next(Int32Array, levels.leaves);  // labels
    [this.kept, this.gone] = [next(Uint32Array, levels.joins), next(Uint32Array, levels.joins)];
    this.strictness = next(Int32Array, levels.joins);
    const column = planeReader(leaves);
    const table = ({ rows, columns }) => Object.fromEntries(columns.map(({ name, exact }) =>
      [name, column(exact ? Float64Array : Float32Array, rows)]));
    const { grains, contacts, changes, steps } = levels.tables;
    [this.leaf, this.contact, this.change, this.step] = [grains, contacts, changes, steps].map(table);
    this.areaUnit = Math.min(...this.edges) ** 2 / 2 ** 20;
    this.meanFace = Math.cbrt(this.edges.reduce((product, edge) => product * edge, 1)) ** 2;
    const empty = new Set(levels.empty);
    this.places = levels.leaves + levels.empty.length;
    this.placeOf = Uint32Array.from(Array.from({ length: this.places }, (_, i) => i).filter((i) => !empty.has(i)));
  }

  /// How many joins there are at a strictness.
  joinsAt(strictness) {
    const least = Math.round(strictness * kUnitsOfScore);
    let made = 0;
    while (made < this.joins && this.strictness[made] >= least) ++made;
    return made;
  }

  /// What the name of each place is after so many joins.
  namesAfter(made) {
    // What a name became in the end is known of the later joins first.
    const name = Uint32Array.from({ length: this.places }, (_, i) => i);
    for (let join = made - 1; join >= 0; --join) name[this.gone[join]] = name[this.kept[join]];
    return name;
  }

  /// How many grains there are, numbered from 0 on as 'vdb_madf remerge' does (from 1 on), the grain
  /// of each leaf, after how many joins, and that of a name before any of these.
  grainsAt(strictness) {
    const made = this.joinsAt(strictness), name = this.namesAfter(made);
    const hasVoxels = new Uint8Array(this.places);
    for (const place of this.placeOf) hasVoxels[name[place]] = 1;
    const number = new Uint32Array(this.places);
    let count = 0;
    for (let place = 0; place < this.places; ++place) if (hasVoxels[place]) number[place] = count++;
    const grainOfName = (place) => number[name[place]];
    return { count, grainOf: this.placeOf.map(grainOfName), made, grainOfName };
  }

  /// The strictnesses between which each row of grains is the same, and that at which each bond
  /// vanishes, as method/grain_lives.h says; NaN: none. What happens beyond the slider does not count.
  lives(strictness, rowOfBody, count, bondEnds) {
    const cut = this.joinsAt(strictness), name = this.namesAfter(cut);
    const at = (join) => this.strictness[join] / kUnitsOfScore;
    const voxels = new Float64Array(this.places), grainVoxels = new Float64Array(this.places);
    this.placeOf.forEach((place, body) => { voxels[place] = this.leaf.voxels[body]; });
    voxels.forEach((value, place) => { grainVoxels[name[place]] += value; });
    const isBorn = new Uint8Array(this.places), alive = new Int32Array(this.places).fill(-1);
    voxels.forEach((value, place) => {
      if (isAlmost(value, grainVoxels[name[place]])) isBorn[name[place]] = 1;
      if (name[place] === place && grainVoxels[place] > 0) alive[place] = place;
    });
    const born = new Float64Array(this.places).fill(NaN), dies = born.slice();
    for (let join = 0; join < this.joins; ++join) {
      const one = this.kept[join], other = this.gone[join], sum = voxels[one] + voxels[other];
      const grain = name[one];
      if (join >= cut) {
        const lived = [alive[one], alive[other]].filter((its) => its >= 0);
        const survivors = lived.filter((its) => isAlmost(grainVoxels[its], sum));
        for (const its of lived) if (!survivors.includes(its)) dies[its] = at(join);
        alive[one] = survivors.length > 0 ? survivors[0] : -1;
      } else if (!isBorn[grain] && isAlmost(sum, grainVoxels[grain])) {
        isBorn[grain] = 1;
        born[grain] = at(join);
      }
      voxels[one] = sum;
    }
    const nameOf = this.namesOfRows(name, rowOfBody, count);
    const first = born.map((value) => value - strictness), last = dies.map((value) => strictness - value);
    const range = this.highest - this.lowest;
    const stability = first.map((value, place) => Math.min(Number.isNaN(value) ? range : value,
      Number.isNaN(last[place]) ? range : last[place]));
    const ofRows = (values) => Float64Array.from(nameOf, (place) => values[place]);
    return { born: ofRows(born), dies: ofRows(dies), stability: ofRows(stability),
      vanishes: Float64Array.from(bondEnds.first, (row, bond) =>
        this.joinedAt(cut, nameOf[row], nameOf[bondEnds.second[bond]])) };
  }

  /// That of its largest leaf, of each row.
  namesOfRows(name, rowOfBody, count) {
    const { voxels } = this.leaf;
    const names = new Uint32Array(count), largest = new Float64Array(count);
    rowOfBody.forEach((row, body) => {
      if (voxels[body] <= largest[row]) return;
      largest[row] = voxels[body];
      names[row] = name[this.placeOf[body]];
    });
    return names;
  }

  /// The largest strictness at which two names after the first joins are one; NaN: none.
  joinedAt(cut, one, other) {
    if (!this.joinOfGone) {
      this.joinOfGone = new Int32Array(this.places).fill(this.joins);
      this.gone.forEach((place, join) => { this.joinOfGone[place] = join; });
    }
    let last = cut - 1;
    while (one !== other) {
      const joins = [this.joinOfGone[one], this.joinOfGone[other]];
      last = Math.min(...joins);
      if (last === this.joins) return NaN;
      if (joins[0] === last) one = this.kept[last]; else other = this.kept[last];
    }
    return last < cut ? NaN : this.strictness[last] / kUnitsOfScore;
  }

  /// The two that a grain was made of by its last join, as 'vdb_madf edit' splits it: the bodies and
  /// voxels of each, and the strictness of the join; null if no join made it.
  partsOf(strictness, rowOfBody, row) {
    const { voxels } = this.leaf;
    const bodies = Array.from(rowOfBody.keys()).filter((body) => rowOfBody[body] === row);
    const cut = this.joinsAt(strictness), nameAtCut = this.namesAfter(cut);
    const names = new Set(bodies.map((body) => nameAtCut[this.placeOf[body]]));
    if (names.size > 1) return null;  // something else made it
    for (let join = cut - 1; join >= 0; --join) {
      if (!names.has(nameAtCut[this.kept[join]])) continue;
      const name = this.namesAfter(join);
      const parts = [this.kept[join], this.gone[join]].map((place) => {
        const its = bodies.filter((body) => name[this.placeOf[body]] === place);
        return { bodies: its, voxels: its.reduce((sum, body) => sum + voxels[body], 0) };
      });
      if (parts.every((part) => part.voxels > 0))
        return { parts, strictness: this.strictness[join] / kUnitsOfScore };
    }
    return null;
  }

  /// That of a grain.
  largestLeaf(grainOf, grain) {
    const { voxels } = this.leaf;
    return grainOf.reduce((best, its, i) =>
      (its === grain && (best < 0 || voxels[i] > voxels[best]) ? i : best), -1);
  }

  /// The measures of grains, by name; what does not follow from those of leaves is missing.
  grainColumns({ count, grainOf, made, grainOfName }, bonds) {
    const { leaf, edges } = this;
    const sum = (value) => {
      const sums = new Float64Array(count);
      for (let i = 0; i < grainOf.length; ++i) sums[grainOf[i]] += value(i);
      return sums;
    };
    const extreme = (values, sign) => {
      const found = new Float64Array(count).fill(-Infinity);
      for (let i = 0; i < grainOf.length; ++i) found[grainOf[i]] = Math.max(found[grainOf[i]], sign * values[i]);
      return found.map((value) => sign * value);
    };
    const voxels = sum((i) => leaf.voxels[i]);
    const result = { id: Float64Array.from(voxels, (_, grain) => grain + 1), voxels,
      volume: voxels.map((value) => value * edges[0] * edges[1] * edges[2]) };
    result.equivalent_diameter = result.volume.map((volume) => Math.cbrt(6 * volume / Math.PI));
    for (const axis of axes) {
      result[`centroid_${axis}`] = sum((i) => leaf.voxels[i] * leaf[`centroid_${axis}`][i])
        .map((value, grain) => value / voxels[grain]);
      result[`box_min_${axis}`] = extreme(leaf[`box_min_${axis}`], -1);
      result[`box_max_${axis}`] = extreme(leaf[`box_max_${axis}`], 1);
    }
    this.addRepresentatives(result, count, grainOf);
    for (const name of ['free_area', 'cut_area']) result[name] = sum((i) => leaf[name][i]);
    for (let join = 0; join < made; ++join)
      result.free_area[grainOfName(this.kept[join])] += this.step.free_area[join] * this.areaUnit;
    result.at_domain_face = extreme(leaf.at_domain_face, 1);
    result.shared_area = new Float64Array(count);
    result.coordination = new Float64Array(count);
    for (const { first, second, area, faces } of bonds)
      for (const grain of [first, second]) {
        result.shared_area[grain] += area;
        if (faces >= this.minFaces) ++result.coordination[grain];
      }
    result.area = result.free_area.map((area, grain) => area + result.shared_area[grain]);
    result.sphericity = result.area.map((area, grain) => {
      const whole = area + result.cut_area[grain];
      return voxels[grain] >= kLeastOfSphericity && whole > 0
        ? Math.PI * result.equivalent_diameter[grain] ** 2 / whole : NaN;
    });
    lazily(result, ellipsoidColumns, () => this.ellipsoids(result, grainOf, sum));
    return result;
  }

  /// The deepest one of the leaves, of several the first.
  addRepresentatives(result, count, grainOf) {
    const { leaf } = this;
    const names = axes.map((axis) => `representative_${axis}`);
    const isBefore = (a, b) => {
      const name = names.find((one) => leaf[one][a] !== leaf[one][b]);
      return name !== undefined && leaf[name][a] < leaf[name][b];
    };
    const radius = leaf.inscribed_radius;
    const best = new Int32Array(count).fill(-1);
    grainOf.forEach((grain, i) => {
      const other = best[grain];
      if (!Number.isNaN(radius[i]) && (other < 0 || radius[i] > radius[other] ||
          (radius[i] === radius[other] && isBefore(i, other)))) best[grain] = i;
    });
    for (const name of ['inscribed_radius', ...names])
      result[name] = Float64Array.from(best, (i) => (i < 0 ? NaN : leaf[name][i]));
  }

  /// Of the ellipsoid of the same second moments: these add up about the common centroid.
  ellipsoids(grains, grainOf, sum) {
    const { leaf } = this;
    const centroids = axes.map((axis) => leaf[`centroid_${axis}`]);
    const middles = axes.map((axis) => grains[`centroid_${axis}`]);
    const moments = products.map((name) => {
      const [a, b] = [...name].map((axis) => axes.indexOf(axis));
      const away = (axis, i) => centroids[axis][i] - middles[axis][grainOf[i]];
      return sum((i) => leaf.voxels[i] * (leaf[`moment_${name}`][i] + away(a, i) * away(b, i)))
        .map((value, grain) => value / grains.voxels[grain]);
    });
    const result = {};
    const rows = Array.from(grains.voxels, (_, grain) => principalAxes(moments.map((values) => values[grain])));
    const column = (value) => {
      const values = new Float64Array(rows.length);
      rows.forEach((row, grain) => { values[grain] = value(row); });
      return values;
    };
    for (let k = 0; k < 3; ++k) {
      result[`axis${k + 1}_length`] = column(({ values }) => 2 * Math.sqrt(5 * Math.max(0, values[k])));
      axes.forEach((axis, i) => { result[`axis${k + 1}_${axis}`] = column((row) => row.axes[k][i]); });
    }
    const ratio = (a, b) => result[a].map((length, grain) => length / result[b][grain]);
    result.aspect_2_to_1 = ratio('axis2_length', 'axis1_length');
    result.aspect_3_to_2 = ratio('axis3_length', 'axis2_length');
    return result;
  }

  /// What grains share, by first, then second.
  bondsOf({ count, grainOf, made, grainOfName }) {
    const { contact, change } = this;
    const found = new Map();
    const bondOf = (one, two) => {
      const first = Math.min(one, two), second = Math.max(one, two), key = first * count + second;
      let bond = found.get(key);
      if (!bond) {
        bond = { key, first, second, faces: 0, areas: [0, 0, 0], place: [0, 0, 0], across: [0, 0, 0] };
        found.set(key, bond);
      }
      return bond;
    };
    const addAreas = ({ areas }, from, i) => {
      areas[0] += from.area1[i];
      areas[1] += from.area2[i];
      areas[2] += from.area4[i];
    };
    const places = axes.map((axis) => contact[`centroid_${axis}`]), across = axes.map((axis) => contact[`across_${axis}`]);
    for (let i = 0; i < contact.faces.length; ++i) {
      const one = grainOf[contact.first[i] - 1], two = grainOf[contact.second[i] - 1], faces = contact.faces[i];
      if (one === two) continue;
      const bond = bondOf(one, two), sign = one === bond.first ? 1 : -1;
      bond.faces += faces;
      addAreas(bond, contact, i);
      for (let k = 0; k < 3; ++k) {
        bond.place[k] += faces * places[k][i];
        bond.across[k] += sign * across[k][i];
      }
    }
    for (let i = 0; change.join[i] < made; ++i) {
      const one = grainOfName(this.kept[change.join[i]]), two = grainOfName(change.other[i]);
      if (one !== two) addAreas(bondOf(one, two), change, i);
    }
    const bonds = [...found.values()].filter(({ faces }) => faces > 0).sort((a, b) => a.key - b.key);
    for (const bond of bonds) bond.area = this.areaOf(bond.areas);
    return bonds;
  }

  /// From pairs of voxels 1, 2 and 4 apart, as bondArea() of measure/detail/leaf_surface.h.
  areaOf(areas) {
    const [one, two, four] = areas.map((area, i) => area / 2 ** i * this.areaUnit / this.meanFace);
    const groove = clamp((four - two) / (2 * Math.sqrt(Math.PI * Math.max(two, 1))) / 0.4, 0, 1);
    const atZero = (1 - groove) * (2 * one - two) + groove * (2 * two - four);
    return this.meanFace * clamp(atZero, 0.25 * one, 1.1 * one);
  }

  bondColumns(bonds, grains) {
    const column = (value) => {
      const values = new Float64Array(bonds.length);
      bonds.forEach((bond, i) => { values[i] = value(bond, i); });
      return values;
    };
    const result = { first: column((bond) => bond.first + 1), second: column((bond) => bond.second + 1),
      faces: column((bond) => bond.faces), area: column((bond) => bond.area),
      radius: column((bond) => Math.sqrt(bond.area / Math.PI)) };
    axes.forEach((axis, k) => { result[`centroid_${axis}`] = column((bond) => bond.place[k] / bond.faces); });
    lazily(result, normalColumns, () => {
      const normals = bonds.map(({ across }) => {
        const normal = across.map((faces, k) => faces / this.edges[k]), length = Math.hypot(...normal);
        return normal.map((value) => value / length);
      });
      return Object.fromEntries(normalColumns.map((name, k) => [name, column((_, i) => normals[i][k])]));
    });
    lazily(result, ['distance', 'cos_alpha'], () => {
      const distance = column(({ first, second }) => Math.hypot(...axes.map((axis) =>
        grains[`representative_${axis}`][first] - grains[`representative_${axis}`][second])));
      return { distance, cos_alpha: column(({ first, second }, i) => {
        const a = grains.inscribed_radius[first], b = grains.inscribed_radius[second];
        return (distance[i] ** 2 - a * a - b * b) / (2 * a * b);
      }) };
    });
    return result;
  }

  /// Tables as decode.js reads them, and the grain of each leaf. `own`: those of the labels.
  at(strictness, own) {
    const cut = this.grainsAt(strictness);
    const all = this.bondsOf(cut);
    const grains = this.grainColumns(cut, all);
    const bonds = all.filter(({ faces }) => faces >= this.minFaces);
    return { rowOfBody: cut.grainOf, grains: tableLike(own.grains, grains, cut.count),
      bonds: tableLike(own.bonds, this.bondColumns(bonds, grains), bonds.length) };
  }
}

/// Columns that are made, together, when one is asked for: a step of the slider does not need them.
function lazily(columns, names, make) {
  let made = null;
  for (const name of names) Object.defineProperty(columns, name, { get: () => (made ??= make())[name] });
}

function clamp(value, least, most) {
  return Math.min(Math.max(value, least), most);
}

function isAlmost(smaller, larger) {
  return 50 * smaller >= 49 * larger;
}

/// A table with the columns of another one; NaN where there are no numbers.
function tableLike(table, numbers, rows) {
  const columns = table.columns.filter(({ isDerived }) => !isDerived);
  const unknown = new Float64Array(rows).fill(NaN);
  const column = (name) => numbers[name] || unknown;
  return { rows, columns, column,
    get lines() {
      const values = columns.map(({ name }) => column(name));
      const cell = (value) => (Number.isNaN(value) ? '' : String(Number(value.toPrecision(9))));
      return [table.lines[0], ...Array.from({ length: rows }, (_, row) =>
        values.map((column) => cell(column[row])).join(','))];
    } };
}
