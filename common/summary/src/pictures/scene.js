// A picture in space on a canvas: faces, lines and balls, drawn from back to front, turned by hand or by keys. No library.
'use strict';

/** The 3-D picture of a canvas. What it shows are parts: {points, color, width, opacity, shaded, bias}; one point is a ball
    of `width` pixels, two are a line, more are a face. A flat one is seen along z and is moved instead of turned. */
class Scene {
  constructor(canvas, flat) {
    this.canvas = canvas; this.flat = flat; this.parts = [];
    this.middle = [0, 0, 0]; this.size = 1; this.zoom = 1; this.shift = [0, 0];
    // Rows: to the right, up, to the viewer.
    this.view = flat ? [[1, 0, 0], [0, 1, 0], [0, 0, 1]]
      : [[-0.8, 0.6, 0], [-0.288, -0.384, 0.877268], [0.526361, 0.701814, 0.48]];
    canvas.tabIndex = 0; canvas.style.touchAction = 'none'; canvas.style.cursor = 'grab';
    let last = null;
    canvas.addEventListener('pointerdown', e => { last = [e.clientX, e.clientY]; canvas.setPointerCapture(e.pointerId); });
    canvas.addEventListener('pointerup', () => { last = null; });
    canvas.addEventListener('pointermove', e => {
      if (!last) return;
      this.move(e.clientX - last[0], e.clientY - last[1]);
      last = [e.clientX, e.clientY];
    });
    canvas.addEventListener('wheel', e => { e.preventDefault(); this.nearer(Math.exp(-e.deltaY / 500)); }, { passive: false });
    canvas.addEventListener('keydown', e => {
      const moves = { ArrowLeft: [-15, 0], ArrowRight: [15, 0], ArrowUp: [0, -15], ArrowDown: [0, 15] };
      if (moves[e.key]) this.move(...moves[e.key]);
      else if (e.key === '+' || e.key === '=') this.nearer(1.2);
      else if (e.key === '-') this.nearer(1 / 1.2);
      else return;
      e.preventDefault();
    });
  }
  move(x, y) {
    if (this.flat) this.shift = [this.shift[0] + x, this.shift[1] + y];
    else {
      const turned = (a, b, angle) => {
        const c = Math.cos(angle), s = Math.sin(angle);
        return [a.map((x, k) => c * x + s * b[k]), b.map((x, k) => c * x - s * a[k])];
      };
      [this.view[0], this.view[2]] = turned(this.view[0], this.view[2], -x / 150);
      [this.view[1], this.view[2]] = turned(this.view[1], this.view[2], y / 150);
    }
    this.draw();
  }
  nearer(factor) { this.zoom *= factor; this.draw(); }
  /** Takes the middle and the size of these points. */
  fit(points) {
    const low = [Infinity, Infinity, Infinity], high = low.map(x => -x);
    for (const p of points) for (let k = 0; k < 3; k++) { low[k] = Math.min(low[k], p[k]); high[k] = Math.max(high[k], p[k]); }
    if (!points.length) return;
    this.middle = low.map((x, k) => (x + high[k]) / 2);
    this.extent = low.map((x, k) => high[k] - x);
    this.size = Math.max(...this.extent) || 1;
  }
  show(parts) { this.parts = parts; this.draw(); }
  draw() {
    const canvas = this.canvas, ratio = window.devicePixelRatio || 1, box = canvas.getBoundingClientRect();
    canvas.width = Math.round(box.width * ratio); canvas.height = Math.round(box.height * ratio);
    const c = canvas.getContext('2d'), w = canvas.width, h = canvas.height;
    const room = this.flat && this.extent ? Math.min(w / (this.extent[0] || 1e-9), h / (this.extent[1] || 1e-9), Math.max(w, h) / this.size)
      : 0.85 * Math.min(w, h) / this.size;
    const scale = (this.flat ? 0.86 : 1) * this.zoom * room;
    const seen = p => this.view.map(row => row.reduce((sum, x, k) => sum + x * (p[k] - this.middle[k]), 0));
    const parts = this.parts.map(part => {
      const points = part.points.map(seen);
      return [points.reduce((sum, p) => sum + p[2], 0) / points.length + (part.bias || 0) * this.size, points, part];
    });
    parts.sort((a, b) => a[0] - b[0]);
    const at = p => [w / 2 + scale * p[0] + ratio * this.shift[0], h / 2 - scale * p[1] + ratio * this.shift[1]];
    c.lineCap = c.lineJoin = 'round';
    for (const [, points, part] of parts) {
      c.globalAlpha = part.opacity ?? 1;
      c.fillStyle = c.strokeStyle = part.shaded ? Scene.shade(points, part.shaded) : part.color;
      c.lineWidth = (part.width ?? 0.5) * ratio;
      c.beginPath();
      if (points.length === 1) c.arc(...at(points[0]), part.width * ratio, 0, 7);
      else points.forEach((p, k) => k ? c.lineTo(...at(p)) : c.moveTo(...at(p)));
      if (points.length !== 2) { c.closePath(); c.fill(); }
      if (points.length > 1) c.stroke();
    }
    c.globalAlpha = 1;
  }
  /** A colour [r, g, b], each from 0 to 1, in the light that falls on a face. */
  static shade([a, b, c], color) {
    const p = b.map((x, k) => x - a[k]), q = c.map((x, k) => x - a[k]);
    const n = [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]];
    const length = Math.hypot(...n) || 1, side = n[2] < 0 ? -1 : 1;
    const light = 60 + 190 * Math.max(0, side * (-0.3 * n[0] + 0.5 * n[1] + 0.8 * n[2]) / length);
    return `rgb(${color.map(x => x * light).join(',')})`;
  }
}

/** Parts of surfaces and curves, {compact, vertices, triangles, segments}, in space; and what a person should know of the
    picture. What goes to infinity is shown within a ball around the middle of its vertices. */
function partsOfSurfaces(surfaces) {
  const median = list => list.sort((a, b) => a - b)[Math.floor(list.length / 2)];
  const distance = (p, q) => Math.hypot(...p.map((x, k) => x - q[k]));
  const far = surfaces.filter(s => s.compact === false).flatMap(s => s.vertices);
  const ball = far.length ? [0, 1, 2].map(k => median(far.map(p => p[k]))) : null;
  const most = far.length ? 2 * median(far.map(p => distance(p, ball))) : Infinity;
  // The part of a triangle or a line that is within the ball, as triangles or lines.
  const within = corners => {
    if (!ball) return [corners];
    const out = corners.map(p => distance(p, ball) - most), kept = [];
    corners.forEach((p, i) => {
      const j = (i + 1) % corners.length, q = corners[j];
      if (out[i] <= 0) kept.push(p);
      if (out[i] <= 0 !== out[j] <= 0 && (corners.length > 2 || !i))
        kept.push(p.map((x, c) => x + (q[c] - x) * out[i] / (out[i] - out[j])));
    });
    if (corners.length === 2) return kept.length === 2 ? [kept] : [];
    return kept.slice(2).map((p, i) => [kept[0], kept[i + 1], p]);
  };
  const parts = surfaces.flatMap(s => [
    ...s.triangles.flatMap(t => within(t.map(k => s.vertices[k]))).map(points => ({ points, shaded: [0.55, 0.75, 1] })),
    ...s.segments.flatMap(t => within(t.map(k => s.vertices[k]))).map(points => ({ points, color: '#b02020', width: 2, bias: 0.01 }))]);
  const note = ball ? `Cut at distance ${most.toPrecision(3)} from (${ball.map(x => x.toPrecision(3)).join(', ')}).` : '';
  return { parts, note };
}
