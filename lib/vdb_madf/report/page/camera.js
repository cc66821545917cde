// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0
// The direction of view, in parallel projection, and the hands and keys that change it.

const turn = Math.PI / 180;

export class Camera {
  /// Azimuth and elevation as those of 'vdb_madf render', degrees. Zoom 1 shows the whole box from any
  /// side; `target` is what is in the middle, from the middle of the box.
  constructor(view, diagonal) {
    this.view = view;
    this.diagonal = diagonal;
    this.home();
  }

  home() {
    Object.assign(this, { azimuth: this.view.azimuth, elevation: this.view.elevation, zoom: 1, target: [0, 0, 0] });
  }

  /// To the right, up, and away from the viewer.
  axes() {
    const a = this.azimuth * turn, e = this.elevation * turn;
    const right = [Math.cos(a), Math.sin(a), 0];
    const away = [-Math.sin(a) * Math.cos(e), Math.cos(a) * Math.cos(e), -Math.sin(e)];
    const up = [-Math.sin(a) * Math.sin(e), Math.cos(a) * Math.sin(e), Math.cos(e)];
    return { right, up, away };
  }

  /// Pixels a voxel (its shortest edge).
  scale(width, height) {
    return this.zoom * Math.min(width, height) / this.diagonal;
  }

  rotate(x, y) {
    this.azimuth = (this.azimuth - x) % 360;
    this.elevation = Math.max(-90, Math.min(90, this.elevation + y));
  }

  move(x, y, scale) {
    const { right, up } = this.axes();
    this.target = this.target.map((value, i) => value - (x * right[i] - y * up[i]) / scale);
  }

  zoomBy(factor) {
    this.zoom = Math.max(0.2, Math.min(100, this.zoom * factor));
  }

  axis(name) {
    const views = { x: [90, 0], y: [0, 0], z: [0, 90] };
    [this.azimuth, this.elevation] = views[name];
  }
}

/// Calls changed() whenever the camera was moved, click(x, y, more) for a click, in pixels of `stage`.
export function steer(stage, camera, scale, changed, click) {
  const pointers = new Map();
  let travelled = 0;
  stage.addEventListener('pointerdown', (event) => {
    if (event.button > 2) return;
    pointers.set(event.pointerId, [event.clientX, event.clientY]);
    if (pointers.size === 1) travelled = 0;
    stage.setPointerCapture(event.pointerId);
  });
  stage.addEventListener('pointermove', (event) => {
    const before = pointers.get(event.pointerId);
    if (!before) return;
    const x = event.clientX - before[0], y = event.clientY - before[1];
    const other = [...pointers.entries()].find(([id]) => id !== event.pointerId);
    pointers.set(event.pointerId, [event.clientX, event.clientY]);
    travelled += Math.abs(x) + Math.abs(y);
    if (travelled < 4) return;
    if (other) {
      const distance = (p) => Math.hypot(p[0] - other[1][0], p[1] - other[1][1]);
      camera.zoomBy(distance([event.clientX, event.clientY]) / Math.max(1, distance(before)));
      camera.move(x / 2, y / 2, scale());
    } else if (event.shiftKey || event.buttons !== 1) {
      camera.move(x, y, scale());
    } else {
      camera.rotate(x * 0.5, y * 0.5);
    }
    changed();
  });
  const end = (event) => {
    const wasOne = pointers.size === 1 && pointers.delete(event.pointerId);
    pointers.delete(event.pointerId);
    if (event.type !== 'pointerup' || !wasOne || travelled >= 4 || event.button !== 0) return;
    const place = stage.getBoundingClientRect();
    click(event.clientX - place.left, event.clientY - place.top, event.shiftKey || event.ctrlKey);
  };
  stage.addEventListener('pointerup', end);
  stage.addEventListener('pointercancel', end);
  stage.addEventListener('contextmenu', (event) => event.preventDefault());
  stage.addEventListener('wheel', (event) => {
    event.preventDefault();
    camera.zoomBy(Math.exp(-event.deltaY * (event.deltaMode ? 0.05 : 0.0015)));
    changed();
  }, { passive: false });
  stage.addEventListener('keydown', (event) => {
    const moves = {
      ArrowLeft: () => camera.rotate(-5, 0), ArrowRight: () => camera.rotate(5, 0),
      ArrowUp: () => camera.rotate(0, -5), ArrowDown: () => camera.rotate(0, 5),
      '+': () => camera.zoomBy(1.15), '=': () => camera.zoomBy(1.15), '-': () => camera.zoomBy(1 / 1.15),
      Home: () => camera.home(),
    };
    if (!moves[event.key] || event.ctrlKey || event.altKey || event.metaKey) return;
    event.preventDefault();
    moves[event.key]();
    changed();
  });
}
