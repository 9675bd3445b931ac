// SPDX-License-Identifier: BSD-3-Clause
// The scene's bytes as arrays, and where the periodic images of its parts lie. No drawing here.
import {block, facts, scalar, values} from '../data.js';

/** Arrays of the page's scene: positions in um relative to `centre`. */
export function readModel() {
  const scene = facts.scene;
  const steps = block('run-position', Uint16Array), radii = block('run-radius', Uint16Array);
  const lo = values('/domain@lo') ?? scene.lo, hi = values('/domain@hi') ?? lo.map((v, a) => v + 65535 * scene.step * (a >= 0));
  const centre = lo.map((v, a) => (v + hi[a]) / 2);
  const position = new Float32Array(steps.length);
  for (let i = 0; i < steps.length; i++) position[i] = scene.lo[i % 3] - centre[i % 3] + scene.step * steps[i];
  const radius = Float32Array.from(radii, r => r * scene.radius_step);
  const soma = block('soma', Float32Array);
  const model = {
    ids: scene.id, type: block('cell-type', Uint32Array), centre, lo: lo.map((v, a) => v - centre[a]), hi: hi.map((v, a) => v - centre[a]),
    periodic: values('/domain@periodic') ?? [0, 0, 0], pia: values('/domain@pia') ?? [0, 0, 1],
    position, radius, runOffset: block('run-offset', Uint32Array), runCell: block('run-cell', Uint32Array), runKind: block('run-kind', Uint8Array),
    somaPosition: new Float32Array(scene.cells * 3), somaRadius: new Float32Array(scene.cells),
    meshStep: scene.step, meshLo: scene.lo.map((v, a) => v - centre[a]), meshPosition: block('mesh-position', Uint16Array), meshFace: block('mesh-face', Uint32Array), surfaces: scene.surfaces, hasBox: scalar('/domain@lo') !== null,
  };
  for (let i = 0; i < scene.cells; i++) {
    for (let a = 0; a < 3; a++) model.somaPosition[3 * i + a] = soma[4 * i + a] - centre[a];
    model.somaRadius[i] = soma[4 * i + 3];
  }
  return model;
}

/** Calls use(x, y, z) for each shift at which the box lo..hi of a thing meets the domain; folded false: once, for 0. */
export function images(model, lo, hi, folded, use) {
  if (!folded) return use(0, 0, 0);
  const from = [], to = [];
  for (let a = 0; a < 3; a++) {
    const side = model.hi[a] - model.lo[a];
    from[a] = model.periodic[a] ? Math.ceil((model.lo[a] - hi[a]) / side) : 0;
    to[a] = model.periodic[a] ? Math.floor((model.hi[a] - lo[a]) / side) : 0;
    if (to[a] - from[a] > 20) to[a] = from[a] + 20;
  }
  for (let x = from[0]; x <= to[0]; x++)
    for (let y = from[1]; y <= to[1]; y++)
      for (let z = from[2]; z <= to[2]; z++)
        use(x * (model.hi[0] - model.lo[0]), y * (model.hi[1] - model.lo[1]), z * (model.hi[2] - model.lo[2]));
}

/** Segments of all runs as instances: a (xyz, radius), b (xyz, radius), directions of the tube at a and b, cell, kind. */
export function segments(model, folded) {
  const out = {a: [], b: [], ta: [], tb: [], cell: [], kind: []};
  const p = i => [model.position[3 * i], model.position[3 * i + 1], model.position[3 * i + 2]];
  const unit = v => { const l = Math.hypot(...v) || 1; return [v[0] / l, v[1] / l, v[2] / l]; };
  const between = (i, j) => unit([0, 1, 2].map(a => model.position[3 * j + a] - model.position[3 * i + a]));
  for (let run = 0; run < model.runCell.length; run++) {
    const first = model.runOffset[run], end = model.runOffset[run + 1];
    for (let i = first; i + 1 < end; i++) {
      const a = p(i), b = p(i + 1), ra = model.radius[i], rb = model.radius[i + 1], r = Math.max(ra, rb);
      const ta = between(Math.max(first, i - 1), i + 1), tb = between(i, Math.min(end - 1, i + 2));
      images(model, a.map((v, k) => Math.min(v, b[k]) - r), a.map((v, k) => Math.max(v, b[k]) + r), folded, (x, y, z) => {
        out.a.push(a[0] + x, a[1] + y, a[2] + z, ra), out.b.push(b[0] + x, b[1] + y, b[2] + z, rb);
        out.ta.push(...ta), out.tb.push(...tb), out.cell.push(model.runCell[run]), out.kind.push(model.runKind[run]);
      });
    }
  }
  return out;
}

/** Somata as instances: centre and radius, cell. */
export function somata(model, folded) {
  const out = {sphere: [], cell: []};
  for (let i = 0; i < model.somaRadius.length; i++) {
    const r = model.somaRadius[i];
    if (!(r > 0)) continue;
    const c = [0, 1, 2].map(a => model.somaPosition[3 * i + a]);
    images(model, c.map(v => v - r), c.map(v => v + r), folded, (x, y, z) => { out.sphere.push(c[0] + x, c[1] + y, c[2] + z, r), out.cell.push(i); });
  }
  return out;
}

/** Faces of the surfaces by the shift at which they are drawn: [{shift, index}]; `cell` has the cell of each vertex. */
export function faces(model, folded) {
  const groups = new Map(), face = model.meshFace, at = model.meshPosition, step = model.meshStep, low = model.meshLo;
  const lo = [0, 0, 0], hi = [0, 0, 0];
  for (let f = 0; f < face.length; f += 3) {
    for (let a = 0; a < 3; a++) {
      const x = at[3 * face[f] + a], y = at[3 * face[f + 1] + a], z = at[3 * face[f + 2] + a];
      lo[a] = low[a] + step * Math.min(x, y, z), hi[a] = low[a] + step * Math.max(x, y, z);
    }
    images(model, lo, hi, folded, (x, y, z) => {
      const key = `${x},${y},${z}`;
      let group = groups.get(key);
      if (!group) groups.set(key, group = {shift: [x, y, z], index: []});
      group.index.push(face[f], face[f + 1], face[f + 2]);
    });
  }
  return [...groups.values()];
}

/** Cell of each vertex of the surfaces, and smooth normals as signed bytes. */
export function vertexData(model) {
  const count = model.meshPosition.length / 3, cell = new Float32Array(count), normal = new Float32Array(3 * count), p = model.meshPosition, face = model.meshFace;
  let first = 0;
  for (const [row, vertices] of model.surfaces) cell.fill(row, first, first += vertices);
  for (let f = 0; f < face.length; f += 3) {
    const [i, j, k] = [3 * face[f], 3 * face[f + 1], 3 * face[f + 2]];
    const ux = p[j] - p[i], uy = p[j + 1] - p[i + 1], uz = p[j + 2] - p[i + 2], vx = p[k] - p[i], vy = p[k + 1] - p[i + 1], vz = p[k + 2] - p[i + 2];
    const n = [uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx];
    for (const corner of [i, j, k]) for (let a = 0; a < 3; a++) normal[corner + a] += n[a];
  }
  const bytes = new Int8Array(3 * count);
  for (let v = 0; v < count; v++) {
    const l = Math.hypot(normal[3 * v], normal[3 * v + 1], normal[3 * v + 2]) || 1;
    for (let a = 0; a < 3; a++) bytes[3 * v + a] = Math.round(127 * normal[3 * v + a] / l);
  }
  return {cell, normal: bytes};
}
