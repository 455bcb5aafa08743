// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
// A camera that flies: drag to look around, keys and the wheel to move. z is up.

/* global THREE */
const speed = 2.5; // metres a second

export class Flight {
  constructor(stage, data, redraw) {
    this.camera = new THREE.PerspectiveCamera(60, 1, 0.05, 2000);
    this.camera.up.set(0, 0, 1);
    this.low = data.extent_m[0];
    this.high = data.extent_m[1];
    this.redraw = redraw;
    this.onLeave = () => {};
    this.isAbove = true;
    this.isEye = false;
    this.heading = 0;
    this.tilt = 0;
    this.keys = new Set();
    this.listen(stage);
  }

  resize(width, height) {
    this.camera.aspect = width / Math.max(1, height);
    this.camera.updateProjectionMatrix();
    if (this.isAbove) this.above();
  }

  /** All of the world, from above and a little from the side. */
  above() {
    this.isAbove = true;
    this.isEye = false;
    this.camera.fov = 45;
    const middle = [0, 1].map((i) => (this.low[i] + this.high[i]) / 2);
    const size = [0, 1].map((i) => this.high[i] - this.low[i]);
    const half = Math.tan(this.camera.fov * Math.PI / 360);
    const far = 0.56 * Math.max(size[0] / this.camera.aspect, size[1]) / half + this.high[2];
    this.tilt = -1.12;
    this.heading = Math.PI / 2;
    this.camera.position.set(middle[0], middle[1] - far * Math.cos(-this.tilt), far * Math.sin(-this.tilt));
    this.turn();
  }

  /** What the left camera of a robot at a pose sees. */
  eye([x, y, heading], camera) {
    const changed = this.isAbove || !this.isEye;
    this.isAbove = false;
    this.isEye = true;
    this.camera.fov = camera.vertical_deg;
    this.heading = heading;
    this.tilt = -camera.pitch_rad;
    this.camera.position.set(x, y, camera.height_m);
    this.turn();
    return changed;
  }

  turn() {
    const c = Math.cos(this.tilt);
    const p = this.camera.position;
    this.camera.lookAt(p.x + c * Math.cos(this.heading), p.y + c * Math.sin(this.heading),
      p.z + Math.sin(this.tilt));
    this.camera.updateProjectionMatrix();
  }

  leave() {
    if (!this.isEye) return;
    this.isEye = false;
    this.onLeave();
  }

  look(dx, dy) {
    this.leave();
    this.heading += dx * 0.004;
    this.tilt = Math.max(-1.55, Math.min(1.55, this.tilt + dy * 0.004));
    this.turn();
    this.redraw();
  }

  /** Forwards along the view, to the left, up; metres. */
  move(ahead, left, up) {
    this.leave();
    const c = Math.cos(this.heading), s = Math.sin(this.heading), t = Math.cos(this.tilt);
    const p = this.camera.position;
    p.x += ahead * c * t - left * s;
    p.y += ahead * s * t + left * c;
    p.z += ahead * Math.sin(this.tilt) + up;
    const wasAbove = this.isAbove;
    this.isAbove = p.z > this.high[2];
    this.turn();
    if (wasAbove !== this.isAbove) this.onLeave();
    this.redraw();
  }

  listen(stage) {
    stage.addEventListener("pointerdown", (event) => {
      stage.setPointerCapture(event.pointerId);
      this.from = [event.clientX, event.clientY];
    });
    stage.addEventListener("pointermove", (event) => {
      if (!this.from) return;
      this.look(event.clientX - this.from[0], event.clientY - this.from[1]);
      this.from = [event.clientX, event.clientY];
    });
    for (const end of ["pointerup", "pointercancel"]) {
      stage.addEventListener(end, () => { this.from = null; });
    }
    stage.addEventListener("wheel", (event) => {
      event.preventDefault();
      const step = this.isAbove ? 0.02 * this.camera.position.z : 0.006;
      this.move(-Math.sign(event.deltaY) * step * Math.min(100, Math.abs(event.deltaY)) / (this.isAbove ? 20 : 1), 0, 0);
    }, { passive: false });
    const known = { w: "ahead", arrowup: "ahead", s: "back", arrowdown: "back", a: "left",
      arrowleft: "left", d: "right", arrowright: "right", e: "up", q: "down" };
    stage.addEventListener("keydown", (event) => {
      const key = known[event.key.toLowerCase()];
      if (!key || event.ctrlKey || event.metaKey || event.altKey) return;
      event.preventDefault();
      this.keys.add(key);
      if (!this.flying) this.fly(performance.now());
    });
    stage.addEventListener("keyup", (event) => this.keys.delete(known[event.key.toLowerCase()]));
    stage.addEventListener("blur", () => this.keys.clear());
  }

  fly(before) {
    this.flying = this.keys.size > 0;
    if (!this.flying) return;
    requestAnimationFrame((now) => {
      const step = speed * Math.min(0.1, (now - before) / 1000) * (this.isAbove ? 4 : 1);
      const on = (a, b) => (this.keys.has(a) ? step : 0) - (this.keys.has(b) ? step : 0);
      this.move(on("ahead", "back"), on("left", "right"), on("up", "down"));
      this.fly(now);
    });
  }
}
