// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0
// The grains in three dimensions.
import * as three from 'three';
import { bondGeometry, cutGeometry, frameGeometry, grainGeometry } from './geometry.js';
import { secondColor, selectedColor } from './looks.js';
import { kHidden, kPale, kPlain, kSelected } from './selection.js';
import * as shaders from './shaders.js';

const kTableWidth = 256;
const kPaleStrength = 0.24;
const kFar = 1e9;  // beyond every box

/// WebGL 2, or null. Smooth edges cost too much where software draws.
export function contextOf(canvas) {
  const probe = document.createElement('canvas').getContext('webgl2');
  if (!probe) return null;
  const info = probe.getExtension('WEBGL_debug_renderer_info');
  const name = info ? probe.getParameter(info.UNMASKED_RENDERER_WEBGL) : '';
  const isSoftware = /swiftshader|llvmpipe|software|basic render/i.test(name);
  return canvas.getContext('webgl2', { antialias: !isSoftware });
}

export class Scene {
  constructor(canvas, context, sample, mesh, selection, camera) {
    Object.assign(this, { canvas, sample, selection, camera });
    this.space = new Space(sample.about);
    this.renderer = new three.WebGLRenderer({ canvas, context });
    this.renderer.autoClear = false;
    this.renderer.setClearColor(0, 0);  // the page shows through
    this.eye = new three.OrthographicCamera(-1, 1, 1, -1, 0, 1);
    this.eye.matrixAutoUpdate = false;
    this.pixel = new three.WebGLRenderTarget(1, 1);
    this.makeTables();
    this.makeGrains(mesh);
    this.makeCuts();
    this.makeBonds();
    this.frame = new three.Scene();
    this.frame.add(new three.LineSegments(frameGeometry(this.space), raw(shaders.lineVertex, shaders.lineFragment, {})));
    selection.listen((what) => {
      if (['slices', 'edits', 'theme'].includes(what)) return;
      if (what === 'strictness') this.updatePlaces();
      if (what !== 'camera' && what !== 'cuts') this.updateLooks();
      if (what === 'cuts') this.updateCuts();
      this.redraw();
    });
    this.updateLooks();
    this.updateCuts();
  }

  makeTables() {
    const height = Math.max(1, Math.ceil(this.sample.bodies / kTableWidth));
    const cells = kTableWidth * height;
    this.looks = new three.DataTexture(new Uint8Array(4 * cells), kTableWidth, height,
      three.RGBAFormat, three.UnsignedByteType);
    this.places = new three.DataTexture(new Float32Array(4 * cells), kTableWidth, height,
      three.RGBAFormat, three.FloatType);
    this.updatePlaces();
    this.shared = {
      looks: { value: this.looks }, places: { value: this.places }, tableWidth: { value: kTableWidth },
      low: { value: new three.Vector3() }, high: { value: new three.Vector3() },
      explode: { value: 0 }, lowState: { value: 0 }, highState: { value: 0 }, strength: { value: 1 },
      picking: { value: false },
    };
  }

  updatePlaces() {
    const { sample, space } = this;
    const centers = Array.from({ length: sample.count }, (_, row) => space.toWorld(sample.placeOf('grains', row)));
    sample.rowOfBody.forEach((row, body) => this.places.image.data.set(centers[row], 4 * body));
    this.places.needsUpdate = true;
  }

  makeGrains(mesh) {
    this.grainMaterial = raw(shaders.grainVertex, shaders.grainFragment, this.shared);
    this.grains = new three.Scene();
    this.mesh = mesh;
    this.bodies = grainGeometry(mesh, this.space);
    this.grains.add(drawn(three.Mesh, this.bodies, this.grainMaterial));
  }

  makeCuts() {
    this.cuts = [0, 1, 2].map((axis) => {
      const size = this.sample.about.slices.size.filter((_, i) => i !== axis);
      const slice = new three.DataTexture(new Uint8Array(4 * size[0] * size[1]), size[0], size[1],
        three.RGBAFormat, three.UnsignedByteType);
      const material = raw(shaders.cutVertex, shaders.cutFragment, {
        ...this.shared, slice: { value: slice }, axis: { value: axis },
        perCell: { value: new three.Vector3(...this.space.perCell) },
        firstCell: { value: new three.Vector3(...this.space.firstCell) },
      });
      material.side = three.DoubleSide;
      const face = drawn(three.Mesh, cutGeometry(this.space, axis, 0), material);
      this.grains.add(face);
      return { slice, face };
    });
  }

  makeBonds() {
    const uniforms = { ...this.shared, isLit: { value: true } };
    const material = raw(shaders.bondVertex, shaders.bondFragment, uniforms);
    material.side = three.DoubleSide;
    this.bondUniforms = uniforms;
    this.bonds = new three.Scene();
    this.discs = drawn(three.Mesh, new three.BufferGeometry(), material);
    this.lines = drawn(three.LineSegments, new three.BufferGeometry(), material);
    this.bonds.add(this.discs, this.lines);
  }

  updateLooks() {
    const { colors, states, bondsAs, selected, others, secondPart } = this.selection;
    // Bonds lie within the grains: these make way for them.
    const plain = bondsAs !== 'none' && selected.size === 0
      ? { pale: kPale, plain: kPlain, hidden: kHidden }[others] : kPlain;
    const { data } = this.looks.image;
    this.sample.rowOfBody.forEach((row, body) => {
      const state = states[row];
      const color = state === kSelected ? (secondPart.has(body) ? secondColor : selectedColor) : colors.subarray(3 * row, 3 * row + 3);
      data.set(color, 4 * body);
      data[4 * body + 3] = state === kPlain ? plain : state;
    });
    this.looks.needsUpdate = true;
    this.sortBodies();
    this.shared.explode.value = this.selection.explode;
    this.updateBonds();
    this.showCuts();
  }

  /// Triangles of the grains that are plain or selected come first, then those of pale ones.
  sortBodies() {
    const { corners, firstTriangle } = this.mesh;
    const { data } = this.looks.image;
    const { index } = this.bodies;
    let to = 0;
    const add = (isWanted) => {
      const start = to;
      for (let body = 0; body < this.sample.bodies; ++body) {
        if (!isWanted(data[4 * body + 3])) continue;
        const its = corners.subarray(3 * firstTriangle[body], 3 * firstTriangle[body + 1]);
        index.array.set(its, to);
        to += its.length;
      }
      return { start, count: to - start };
    };
    this.solid = { ...add((state) => state > kPale), low: kPlain, high: kSelected };
    this.pale = { ...add((state) => state === kPale), low: kPale, high: kPale };
    index.needsUpdate = true;
  }

  updateBonds() {
    const { bondsAs, bondColors } = this.selection;
    this.discs.visible = bondsAs === 'discs';
    this.lines.visible = bondsAs === 'lines';
    if (bondsAs === 'none') return;
    const object = bondsAs === 'discs' ? this.discs : this.lines;
    object.geometry.dispose();
    object.geometry = bondGeometry(this.sample, this.space, this.selection.shownBonds(), bondColors, bondsAs);
    this.bondUniforms.isLit.value = bondsAs === 'discs';
  }

  updateCuts() {
    const { cuts, flips } = this.selection;
    const { low, high } = this.space;
    this.isCut = flips.map((flip, axis) => (flip ? cuts[axis] > 0 : cuts[axis] < 1));
    for (let axis = 0; axis < 3; ++axis) {
      const at = low[axis] + cuts[axis] * (high[axis] - low[axis]);
      const from = this.isCut[axis] && flips[axis], to = this.isCut[axis] && !flips[axis];
      this.shared.low.value.setComponent(axis, from ? at : -kFar);
      this.shared.high.value.setComponent(axis, to ? at : kFar);
      if (this.isCut[axis]) this.fillCut(axis, at, flips[axis]);
    }
    this.grainMaterial.side = this.isCut.includes(true) ? three.DoubleSide : three.FrontSide;
    this.showCuts();
  }

  showCuts() {
    this.cuts.forEach(({ face }, axis) => {
      face.visible = this.isCut !== undefined && this.isCut[axis] && this.selection.explode === 0;
    });
  }

  fillCut(axis, at, flipped) {
    const { size } = this.sample.about.slices;
    const cell = at * this.space.perCell[axis] + this.space.firstCell[axis] + (flipped ? 1e-3 : -1e-3);
    const layer = Math.max(0, Math.min(size[axis] - 1, Math.floor(cell)));
    const { slice, face } = this.cuts[axis];
    const { data } = slice.image;
    const [right, up] = [0, 1, 2].filter((other) => other !== axis);
    const p = [0, 0, 0];
    p[axis] = layer;
    let to = 0;
    for (p[up] = 0; p[up] < size[up]; ++p[up])
      for (p[right] = 0; p[right] < size[right]; ++p[right], to += 4) {
        const number = this.sample.bodyAt(p[0], p[1], p[2]);
        data[to] = number & 255;
        data[to + 1] = (number >> 8) & 255;
        data[to + 2] = number >> 16;
      }
    slice.needsUpdate = true;
    face.geometry.dispose();
    face.geometry = cutGeometry(this.space, axis, at);
  }

  get scale() {
    return this.camera.scale(this.width, this.height) / (1 + this.selection.explode);
  }

  resize() {
    const { clientWidth, clientHeight } = this.canvas.parentElement;
    if (clientWidth === 0 || (clientWidth === this.width && clientHeight === this.height)) return;
    this.width = clientWidth;
    this.height = clientHeight;
    this.renderer.setPixelRatio(Math.min(2, window.devicePixelRatio || 1));
    this.renderer.setSize(clientWidth, clientHeight, false);
    this.redraw();
  }

  /// For the pixels from (x, y) on, so many.
  aim(x = 0, y = 0, width = this.width, height = this.height) {
    const { right, up, away } = this.camera.axes();
    const reach = this.space.radius * (1 + this.selection.explode) * 2 + 1 + Math.hypot(...this.camera.target);
    const vector = (v) => new three.Vector3(...v);
    this.eye.matrix.makeBasis(vector(right), vector(up), vector(away).negate());
    this.eye.matrix.setPosition(vector(this.camera.target).addScaledVector(vector(away), -reach));
    this.eye.matrixWorldNeedsUpdate = true;
    this.eye.left = (x - this.width / 2) / this.scale;
    this.eye.right = this.eye.left + width / this.scale;
    this.eye.top = (this.height / 2 - y) / this.scale;
    this.eye.bottom = this.eye.top - height / this.scale;
    this.eye.far = 2 * reach;
    this.eye.updateProjectionMatrix();
  }

  redraw() {
    if (this.isDue) return;
    this.isDue = true;
    requestAnimationFrame(() => {
      this.isDue = false;
      this.draw();
    });
  }

  draw() {
    if (!this.width) return;
    this.aim();
    this.renderer.clear();
    this.renderer.render(this.frame, this.eye);
    if (this.pale.count > 0) this.drawPale();
    this.drawGrains(this.solid);
    if (this.selection.bondsAs !== 'none') this.drawBonds();
    if (this.onDrawn) this.onDrawn();
  }

  /// The view on a ground, so many times as large as on the screen, if that can be drawn.
  picture(times, ground) {
    const { renderer, canvas, width, height } = this;
    const ratio = renderer.getPixelRatio();
    renderer.setPixelRatio(Math.min(times * ratio, renderer.capabilities.maxTextureSize / Math.max(width, height)));
    this.draw();
    const picture = document.createElement('canvas');
    [picture.width, picture.height] = [canvas.width, canvas.height];
    const context = picture.getContext('2d');
    context.fillStyle = ground;
    context.fillRect(0, 0, picture.width, picture.height);
    context.drawImage(canvas, 0, 0);
    renderer.setPixelRatio(ratio);
    this.draw();
    return picture;
  }

  /// In front of the grains, within which they lie.
  drawBonds() {
    this.renderer.clearDepth();
    this.renderer.render(this.bonds, this.eye);
  }

  drawGrains({ start, count, low, high }) {
    this.bodies.setDrawRange(start, count);
    this.shared.lowState.value = low - 1;
    this.shared.highState.value = high + 1;
    this.renderer.render(this.grains, this.eye);
  }

  /// Hides nothing of what is drawn later.
  drawPale() {
    this.shared.strength.value = kPaleStrength;
    this.drawGrains(this.pale);
    this.shared.strength.value = 1;
    this.renderer.clearDepth();
  }

  /// The row of the grain at a pixel, of pale ones only where there is no other; -1: none.
  pick(x, y) {
    this.aim(Math.floor(x), Math.floor(y), 1, 1);
    this.shared.picking.value = true;
    this.renderer.setRenderTarget(this.pixel);
    const bytes = new Uint8Array(4);
    let body = -1;
    for (const part of [this.solid, this.pale]) {
      this.renderer.clear();
      this.drawGrains(part);
      this.renderer.readRenderTargetPixels(this.pixel, 0, 0, 1, 1, bytes);
      body = bytes[0] + 256 * bytes[1] + 65536 * bytes[2] - 1;
      if (body >= 0) break;
    }
    this.renderer.setRenderTarget(null);
    this.shared.picking.value = false;
    return body < 0 ? -1 : this.sample.rowOfBody[body];
  }
}

/// Voxels to world places: shortest edges of a voxel, from the middle of the box.
export class Space {
  constructor(about) {
    const shortest = Math.min(...about.edges);
    this.edges = about.edges.map((edge) => edge / shortest);
    const { min, max } = about.box;
    this.middle = min.map((low, i) => (low + max[i]) / 2);
    this.high = min.map((low, i) => (max[i] - low + 1) / 2 * this.edges[i]);
    this.low = this.high.map((value) => -value);
    this.radius = Math.hypot(...this.high);
    const { factor, min: first } = about.slices;
    this.perCell = this.edges.map((edge) => 1 / (edge * factor));
    this.firstCell = this.middle.map((value, i) => (value + 0.5) / factor - first[i]);
  }

  toWorld(index) {
    return index.map((value, i) => (value - this.middle[i]) * this.edges[i]);
  }
}

function raw(vertexShader, fragmentShader, uniforms) {
  return new three.RawShaderMaterial({ vertexShader, fragmentShader, uniforms });
}

function drawn(Type, geometry, material) {
  const object = new Type(geometry, material);
  object.frustumCulled = false;
  return object;
}
