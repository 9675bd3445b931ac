// SPDX-License-Identifier: BSD-3-Clause
// The 3-D view with its switches, legend and the card of the cell under the pointer.
import {classColour, rgb, seriesColour, typeColours} from '../colours.js';
import {facts, hasGroup, table, values} from '../data.js';
import {amount, h, show, words} from '../dom.js';
import {missing} from '../figure.js';
import {readModel} from './model.js';
import {View} from './view.js';

const typeNames = () => values('/types/name') ?? [], classNames = () => values('/types/class') ?? [];

// The layer of each cell by the height of its soma; '' where the document has no layers.
function layers(model) {
  const names = values('/domain/layer_name'), lo = values('/domain/layer_lo'), hi = values('/domain/layer_hi');
  if (!names || !lo || !hi) return null;
  return cell => {
    const z = model.somaPosition[3 * cell + 2] + model.centre[2];
    const i = names.findIndex((_, k) => z >= lo[k] && z < hi[k]);
    return i < 0 ? 'outside' : names[i];
  };
}

// Ways to colour: name -> {keys, colours, of(cell)}.
function colourings(model) {
  const types = typeNames(), classes = classNames(), shades = typeColours();
  const ways = {
    type: {keys: types, colours: shades, of: cell => types[model.type[cell]]},
    class: {keys: [...new Set(classes)], colours: [...new Set(classes)].map(classColour), of: cell => classes[model.type[cell]]},
  };
  const layer = layers(model);
  if (layer) {
    const keys = [...(values('/domain/layer_name') ?? []), 'outside'];
    ways.layer = {keys, colours: keys.map((_, i) => seriesColour(i)), of: layer};
  }
  ways.cell = {keys: types, colours: shades, of: cell => types[model.type[cell]], colour: cell => seriesColour(cell * 5 + 1)};
  return ways;
}

function card(model, cell) {
  const type = model.type[cell], row = table('cell')?.records.find(r => String(r.id) === String(model.ids[cell]));
  const soma = [0, 1, 2].map(a => show(model.somaPosition[3 * cell + a] + model.centre[a], 4)).join(', ');
  const rows = [['type', typeNames()[type]], ['class', classNames()[type]], ['soma', `${soma} µm`], ['soma radius', amount(model.somaRadius[cell], 'um', 3)]];
  if (row) for (const c of table('cell').columns) if (!['id', 'type', 'soma_radius'].includes(c.name)) rows.push([words(c.name), amount(row[c.name], c.unit, 4)]);
  return [h('strong', {}, `cell ${model.ids[cell]}`), h('dl', {}, rows.map(([k, v]) => [h('dt', {}, k), h('dd', {}, v)]))];
}

function webgl() {
  try {
    return !!document.createElement('canvas').getContext('webgl2');
  } catch {
    return false;
  }
}

function axesSvg() {
  const ns = 'http://www.w3.org/2000/svg', svg = document.createElementNS(ns, 'svg');
  svg.setAttribute('class', 'axes'), svg.setAttribute('viewBox', '-32 -32 64 64'), svg.setAttribute('aria-hidden', 'true');
  return {svg, draw(directions) {
    svg.replaceChildren(...directions.flatMap(([x, y], a) => {
      const line = document.createElementNS(ns, 'line'), text = document.createElementNS(ns, 'text');
      line.setAttribute('x2', 20 * x), line.setAttribute('y2', 20 * y), line.setAttribute('class', `axis${a}`);
      text.setAttribute('x', 27 * x), text.setAttribute('y', 27 * y + 3.5), text.textContent = 'xyz'[a];
      return [line, text];
    }));
  }};
}

/** The section's content. */
export function scenePanel() {
  const scene = facts.scene;
  if (!scene.cells) return missing('No cells', 'No /cells: conceg place makes them, conceg import reads those of others.', 'conceg run apps/recipes/cube.yaml --until mesh -o cube.cgx');
  const notes = [...scene.left_out];
  const hasSkeleton = document.getElementById('run-cell').textContent.length > 0, hasSurface = scene.surfaces.length > 0;
  if (!hasSkeleton && !hasGroup('/skeleton')) notes.push('No /skeleton: conceg grow makes processes; only somata are drawn, where cells have any.');
  if (!hasSurface && !hasGroup('/meshes')) notes.push('No /meshes: conceg mesh makes surfaces.');
  if (!hasSkeleton && !hasSurface && hasGroup('/volumes')) notes.push('Cells that are labels of /volumes alone have no shape here; their tables are below.');
  const holder = h('div', {class: 'scene', 'data-surface': String(hasSurface)}), info = h('div', {class: 'cellcard', 'aria-live': 'polite'}), bar = h('div', {class: 'controls'}), legend = h('div', {class: 'legend', role: 'group', 'aria-label': 'cells shown'});
  const help = h('span', {}, 'Drag to turn, scroll to zoom, right button to move. Point at a cell for its name, click to keep it. ');
  const panel = h('div', {class: 'scenepanel'}, bar, legend, holder, h('p', {class: 'note'}, help, notes.join(' ')));
  if (!webgl()) {
    holder.replaceWith(missing('No WebGL here', 'This browser shows no WebGL 2, so the 3-D view is left out. All charts and tables work without it.'));
    bar.remove(), legend.remove(), help.remove();
    return panel;
  }
  // The element needs its size first.
  requestAnimationFrame(() => {
    try {
      start(holder, info, bar, legend, {hasSkeleton, hasSurface});
    } catch (error) {
      console.error('3-D view:', error);
      holder.replaceWith(missing('The 3-D view failed', String(error.message)));
    }
  });
  return panel;
}

function start(holder, info, bar, legend, {hasSkeleton, hasSurface}) {
  const model = readModel(), view = new View(model, holder), ways = colourings(model), axes = axesSvg();
  const periodic = model.hasBox && model.periodic.some(Boolean);
  const state = {surface: hasSurface, folded: periodic, by: 'type', axis: -1, share: 0.5, flipped: false, hidden: new Set(), kept: null};
  holder.append(axes.svg, info);
  if (model.hasBox) holder.append(h('span', {class: 'boxsize'}, `box ${model.hi.map((v, a) => show(v - model.lo[a], 4)).join(' × ')} µm`));
  view.onDraw = () => { axes.draw(view.axes()); holder.dataset.drawn = 'yes'; };

  const recolour = () => {
    const way = ways[state.by], colours = new Map(way.keys.map((key, i) => [key, rgb(way.colours[i])]));
    view.colour(cell => (state.hidden.has(way.of(cell)) ? null : way.colour ? rgb(way.colour(cell)) : colours.get(way.of(cell)) ?? [0.6, 0.6, 0.6]));
  };
  const fillLegend = () => {
    const way = ways[state.by];
    state.hidden.clear();
    const counts = new Map();
    for (let i = 0; i < model.type.length; i++) counts.set(way.of(i), (counts.get(way.of(i)) ?? 0) + 1);
    legend.replaceChildren(...way.keys.map((key, i) => ({key, colour: way.colours[i]})).filter(k => counts.has(k.key)).map(({key, colour}) => {
      const button = h('button', {type: 'button', class: 'key', 'aria-pressed': 'true', title: 'show or hide'}, h('span', {class: 'chip', style: {'--chip': way.colour ? 'var(--soft)' : colour}}), `${key} `, h('span', {class: 'unit'}, show(counts.get(key))));
      button.addEventListener('click', () => {
        if (!state.hidden.delete(key)) state.hidden.add(key);
        button.setAttribute('aria-pressed', String(!state.hidden.has(key)));
        recolour();
      });
      return button;
    }));
    recolour();
  };
  const select = (label, choices, value, use) => {
    const element = h('select', {'aria-label': label, onchange: event => use(event.target.value)}, Object.entries(choices).map(([key, name]) => h('option', {value: key, selected: key === value}, name)));
    return h('label', {class: 'switch'}, `${label} `, element);
  };
  const again = () => view.show(state);
  const cut = () => view.cut(state.axis, state.share, state.flipped);
  const slider = h('input', {type: 'range', min: '0', max: '1', step: '0.005', value: '0.5', 'aria-label': 'place of the cut', hidden: true, oninput: event => { state.share = Number(event.target.value); cut(); where(); }});
  const place = h('output', {class: 'unit'});
  const where = () => { place.textContent = state.axis < 0 ? '' : `${show(model.centre[state.axis] + model.lo[state.axis] + state.share * (model.hi[state.axis] - model.lo[state.axis]), 4)} µm`; };
  const side = h('button', {type: 'button', class: 'small', hidden: true, onclick: () => { state.flipped = !state.flipped; cut(); }}, 'Other side');
  bar.append(...[
    hasSurface && hasSkeleton && select('Draw', {surface: 'surfaces', skeleton: 'skeletons'}, 'surface', value => { state.surface = value === 'surface'; again(); }),
    periodic && select('Cells', {box: 'within the box', whole: 'whole'}, 'box', value => { state.folded = value === 'box'; again(), view.fit(!state.folded); }),
    select('Colour', Object.fromEntries(Object.keys(ways).map(k => [k, `by ${k}`])), 'type', value => { state.by = value; fillLegend(); }),
    model.hasBox && select('Cut', {'-1': 'none', 0: 'across x', 1: 'across y', 2: 'across z'}, '-1', value => { state.axis = Number(value); state.flipped = state.axis >= 0 && view.facesLow(state.axis); slider.hidden = side.hidden = state.axis < 0; cut(), where(); }),
    model.hasBox && slider, model.hasBox && place, model.hasBox && side,
    h('button', {type: 'button', class: 'small', onclick: () => view.fit(!state.folded)}, 'Reset view'),
    h('button', {type: 'button', class: 'small', onclick: () => h('a', {href: view.renderer.domElement.toDataURL('image/png'), download: 'tissue.png'}).click()}, 'Save PNG'),
  ].filter(Boolean));

  const tell = cell => { info.replaceChildren(...(cell === null ? [] : card(model, cell))); view.highlight(cell); };
  let busy = false, last = null, down = null;
  const canvas = view.renderer.domElement;
  canvas.addEventListener('pointermove', event => {
    if (busy || state.kept !== null || event.buttons) return;
    busy = true;
    requestAnimationFrame(() => {
      busy = false;
      const cell = view.cellAt(event.offsetX, event.offsetY);
      if (cell !== last) tell(last = cell);
    });
  });
  canvas.addEventListener('pointerdown', event => { down = [event.offsetX, event.offsetY]; });
  canvas.addEventListener('pointerup', event => {
    if (!down || Math.hypot(event.offsetX - down[0], event.offsetY - down[1]) > 4) return;
    state.kept = last = view.cellAt(event.offsetX, event.offsetY);
    tell(state.kept);
  });
  canvas.addEventListener('pointerleave', () => { if (state.kept === null) tell(last = null); });
  holder.pick = (x, y) => view.cellAt(x, y); // for tests
  fillLegend(), again();
}
