// A mechanism in its positions: a picture, the list of positions, and a slider along each branch. Positions are those that
// were computed; nothing is solved here, so that no posture jumps. Draws by scene.js.
'use strict';

/** Shows `data`, which is what page.json holds, in an element. */
function showMechanism(place, data) {
  const el = (tag, attributes, ...children) => {
    const element = document.createElement(tag);
    for (const [key, value] of Object.entries(attributes)) {
      if (key.startsWith('on')) element.addEventListener(key.slice(2), value);
      else if (value !== false && value !== null) element.setAttribute(key, value === true ? '' : value);
    }
    element.append(...children);
    return element;
  };
  const COLORS = ['#0072B2', '#D55E00', '#009E73', '#CC79A7', '#E69F00', '#56B4E9'], GROUND = '#7d838c';
  const flat = data.space === 'planar';
  const canvas = el('canvas', { role: 'img' });
  const scene = new Scene(canvas, flat);
  const color = i => i ? COLORS[(i - 1) % COLORS.length] : GROUND;

  /** Points of a body in the world, by its place [qw, qx, qy, qz, x, y, z]. */
  const mover = ([w, x, y, z, ...p]) => {
    const rows = [[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
      [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
      [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]];
    const turn = q => rows.map(row => row[0] * q[0] + row[1] * q[1] + row[2] * q[2]);
    return { turn, at: q => turn(q).map((c, k) => c + p[k]) };
  };
  /** Points around a centre, across an axis. */
  const around = (centre, axis, radius, n) => {
    const length = Math.hypot(...axis) || 1, [x, y, z] = axis.map(c => c / length);
    const u = Math.abs(z) > 0.9 ? [1, 0, 0] : [0, 0, 1];
    const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    let e = cross(u, [x, y, z]);
    const l = Math.hypot(...e); e = e.map(c => c / l);
    const f = cross([x, y, z], e);
    return [...Array(n).keys()].map(k => {
      const c = Math.cos(2 * Math.PI * (k + 0.5) / n), s = Math.sin(2 * Math.PI * (k + 0.5) / n);
      return centre.map((q, i) => q + radius * (c * e[i] + s * f[i]));
    });
  };
  const ink = () => getComputedStyle(canvas).color;
  const kindOf = joint => ['P', 'S'].includes(joint.type) ? joint.type : 'R';

  /** Everything that is drawn of one position; `poses` are by the names of bodies. */
  function partsOf(poses, faint) {
    const movers = data.bodies.map(body => poses[body.name] && mover(poses[body.name]));
    const parts = [], opacity = faint ? 0.18 : 1, line = faint ? 1.2 : 4;
    data.bodies.forEach((body, i) => {
      const m = movers[i];
      if (!m || faint && !i) return;
      for (const face of body.faces) parts.push({ points: face.map(m.at), color: color(i), opacity: 0.22 * opacity });
      for (const rod of body.segments) parts.push({ points: rod.map(m.at), color: color(i), width: i ? line : 2, opacity, bias: 0.002 });
    });
    for (const ends of data.rods) {
      if (ends.every(([i]) => movers[i]))
        parts.push({ points: ends.map(([i, p]) => movers[i].at(p)), color: faint ? GROUND : ink(), width: line * 0.6, opacity, bias: 0.003 });
    }
    if (faint) return parts;
    for (const joint of data.joints) {
      // A joint on the ground gets a plate in space, if the ground has no faces.
      if (!joint.body && !flat && !data.bodies[0].faces.length)
        parts.push({ points: around(joint.point, joint.axis, 0.09 * scene.size, 24), color: GROUND, opacity: 0.4 });
      const m = movers[joint.body];
      if (!m) continue;
      const centre = m.at(joint.point), shape = kindOf(joint);
      if (flat && shape === 'R' || shape === 'S') parts.push({ points: [centre], color: ink(), width: 4.5, bias: 0.02 });
      else parts.push({ points: around(centre, m.turn(joint.axis), 0.022 * scene.size, shape === 'P' ? 4 : 14), color: ink(), bias: 0.02 });
    }
    if (poses.output && !flat) {
      const m = mover(poses.output), origin = m.at([0, 0, 0]);
      ['#c0392b', '#1e8449', '#2471a3'].forEach((c, k) => {
        const tip = m.at([0, 1, 2].map(i => i === k ? 0.09 * scene.size : 0));
        parts.push({ points: [origin, tip], color: c, width: 2, bias: 0.02 });
      });
    }
    return parts;
  }
  const curves = () => data.curves.flatMap(curve => curve.points.slice(1).map((p, k) =>
    ({ points: [curve.points[k], p], color: '#b02020', width: 1.5 })));
  const branchPoses = (branch, k) => Object.fromEntries(Object.entries(branch.poses).map(([name, list]) => [name, list[k]]).filter(([, p]) => p));
  const extent = poses => partsOf(poses, false).flatMap(part => part.points);
  const all = [...data.sets.map(set => set.poses), ...data.branches.flatMap(b =>
    [...Array(Math.min(20, b.input.length)).keys()].map(k => branchPoses(b, Math.floor(k * b.input.length / Math.min(20, b.input.length)))))];
  scene.fit([...all.flatMap(extent), ...data.curves.flatMap(curve => curve.points)]);

  // ---- what is shown ----
  let shown = { set: data.sets.length ? 0 : null, branch: data.sets.length ? null : 0, sample: 0 };
  const ghosts = el('input', { type: 'checkbox', id: 'ghosts', onchange: () => draw() });
  const status = el('p', { role: 'status', class: 'dim' });
  const slider = el('input', { type: 'range', min: '0', max: '0', value: '0', 'aria-label': 'Place on the branch',
    oninput: () => { shown.sample = Number(slider.value); draw(); } });
  const play = el('button', { type: 'button', onclick: () => run(!running) }, 'Play');
  let running = false, direction = 1;
  function run(wanted) {
    running = wanted; play.textContent = running ? 'Stop' : 'Play';
    const step = () => {
      if (!running || !canvas.isConnected) return;
      const last = data.branches[shown.branch].input.length - 1;
      if (shown.sample + direction > last || shown.sample + direction < 0) direction = -direction;
      shown.sample = Math.max(0, Math.min(last, shown.sample + direction));
      draw(); setTimeout(step, 40);
    };
    step();
  }
  const buttons = [];
  const choose = (what, words) => {
    const button = el('button', { type: 'button', onclick: () => { run(false); shown = { ...shown, set: null, branch: null, sample: 0, ...what }; draw(); } }, words);
    buttons.push([button, what]);
    return button;
  };
  const cells = values => values.map(value => el('td', { class: 'number' }, value === null ? '' : String(Number(value.toPrecision(7)))));
  const yes = (value, words) => value === null || value === undefined ? '' : value ? words[0] : words[1];
  const known = [['proved', set => yes(set.proved, ['yes', 'no'])], ['limits', set => yes(set.limits, ['within', 'beyond'])]]
    .filter(([, of]) => data.sets.some(set => of(set)));
  const table = data.sets.length ? el('div', { class: 'wide', tabindex: '0', role: 'region', 'aria-label': 'Positions' }, el('table', {},
    el('caption', {}, data.left_out ? `The first ${data.sets.length} real positions; ${data.left_out} more are in the other files` : 'Real positions'),
    el('thead', {}, el('tr', {}, ...['', ...known.map(([name]) => name), ...data.columns].map(name => el('th', { scope: 'col' }, name)))),
    el('tbody', {}, ...data.sets.map((set, i) => el('tr', {}, el('td', {}, choose({ set: i }, set.title)),
      ...known.map(([, of]) => el('td', {}, of(set))), ...cells(set.inputs)))))) : '';
  const branches = data.branches.length ? el('div', { class: 'row' }, play, slider, ...data.branches.map((b, i) => choose({ branch: i }, b.title))) : '';

  function draw() {
    const branch = shown.branch === null ? null : data.branches[shown.branch];
    const poses = branch ? branchPoses(branch, shown.sample) : shown.set === null ? null : data.sets[shown.set].poses;
    play.disabled = slider.disabled = !branch;
    if (branch) { slider.max = branch.input.length - 1; slider.value = shown.sample; }
    for (const [button, what] of buttons)
      button.setAttribute('aria-pressed', String('set' in what ? what.set === shown.set : what.branch === shown.branch));
    const faint = ghosts.checked ? data.sets.filter((_, i) => i !== shown.set).flatMap(set => partsOf(set.poses, true)) : [];
    scene.show([...curves(), ...faint, ...(poses ? partsOf(poses, false) : [])]);
    status.textContent = branch
      ? `${branch.title}: sample ${Number(branch.input[shown.sample].toPrecision(6))}, ${shown.sample + 1} of ${branch.input.length}` +
        (branch.folds.length ? `; folds at ${branch.folds.map(f => Number(f.toPrecision(6))).join(', ')}` : '')
      : shown.set === null ? 'There is no real position to show.' : `Position ${data.sets[shown.set].title}, real${yes(data.sets[shown.set].proved, [' and proved', ''])}`;
    canvas.setAttribute('aria-label', `${data.name}. ${status.textContent}. Drag or use the keys of arrows to ${flat ? 'move' : 'turn'} it, + and - to come nearer.`);
  }
  const counts = el('p', { class: 'dim' }, data.counts.map(([name, n]) => `${n} ${name}`).join(', '));
  place.replaceChildren(counts, ...data.notes.map(note => el('p', { class: 'warn' }, note)), canvas, status,
    data.sets.length > 1 ? el('div', { class: 'row' }, el('span', {}, ghosts, el('label', { for: 'ghosts' }, ' all positions, faintly'))) : '',
    branches, table);
  draw();
  return draw;
}
