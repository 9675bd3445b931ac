// SPDX-License-Identifier: BSD-3-Clause
// A chart in its frame: title, what it says, switches, legend, the chart, and where its numbers are.
import * as Plot from '@observablehq/plot';
import {h, offer, show} from './dom.js';
import {tableWithTools} from './table.js';

export const figures = {drawn: 0, failed: 0};

const redraws = new Set();
/** Draws all charts anew, for another theme or before printing. */
export const redrawAll = () => redraws.forEach(redraw => redraw());

// At the next frame, as a chart that grows while its size is looked at would be looked at again.
const watcher = new ResizeObserver(entries => requestAnimationFrame(() => entries.forEach(entry => entry.target.redraw?.(entry.contentRect.width))));

const tick = value => show(value);

/** Scale options of a logarithmic axis that holds these values (those above 0), with ticks at 1, 2 and 5 or at powers of ten. */
export function logAxis(label, list) {
  const some = list.filter(v => v > 0), low = Math.min(...some) / 1.15, high = Math.max(...some) * 1.15;
  if (!some.length) return {label, type: 'log', grid: true};
  const decades = [], fine = Math.log10(high / low) < 2.5 ? [1, 2, 5] : [1];
  for (let power = Math.floor(Math.log10(low)); power <= Math.ceil(Math.log10(high)); power++) for (const digit of fine) decades.push(Number(`${digit}e${power}`));
  const inside = decades.filter(v => v >= low && v <= high), every = Math.ceil(inside.length / 8);
  return {label, type: 'log', grid: true, domain: [low, high], ticks: inside.filter((_, i) => i % every === 0)};
}

/** Arrays of one group as '/group/{a, b}'. */
export function grouped(paths) {
  const groups = new Map();
  for (const path of paths) {
    const cut = path.lastIndexOf('/'), group = path.slice(0, cut);
    groups.set(group, [...(groups.get(group) ?? []), path.slice(cut + 1)]);
  }
  return [...groups].map(([group, names]) => (names.length === 1 ? `${group}/${names[0]}` : `${group}/{${names.join(', ')}}`));
}

/** Plot.plot with the page's look. */
export function plot(width, options) {
  return Plot.plot({
    width, height: Math.round(Math.min(380, Math.max(240, width * 0.5))), marginLeft: 58, marginBottom: 42, marginTop: 24, marginRight: 24,
    ...options, x: {tickFormat: tick, ...options.x}, y: {tickFormat: tick, ...options.y},
    style: {background: 'transparent', color: 'currentColor', fontSize: '12px', overflow: 'visible', fontFamily: 'inherit'},
  });
}

function legend(series, hidden, redraw) {
  if (!series || series.length < 2) return null;
  return h('div', {class: 'legend', role: 'group', 'aria-label': 'series'}, series.map(s => {
    const button = h('button', {type: 'button', class: 'key', 'aria-pressed': String(!hidden.has(s.key)), title: 'show or hide'},
      h('span', {class: `chip${s.dashed ? ' dashed' : ''}`, style: {'--chip': s.colour}}), s.label ?? s.key);
    button.addEventListener('click', () => {
      if (!hidden.delete(s.key)) hidden.add(s.key);
      button.setAttribute('aria-pressed', String(!hidden.has(s.key)));
      redraw();
    });
    return button;
  }));
}

function switches(list, state, redraw) {
  return (list ?? []).map(s => {
    state[s.key] = s.value ?? (s.choices ? s.choices[0] : false);
    if (s.choices) {
      const select = h('select', {'aria-label': s.label, onchange: event => { state[s.key] = event.target.value; redraw(); }},
        s.choices.map(choice => h('option', {value: choice, selected: choice === state[s.key]}, s.names?.[choice] ?? choice)));
      return h('label', {class: 'switch'}, `${s.label} `, select);
    }
    const box = h('input', {type: 'checkbox', checked: state[s.key], onchange: event => { state[s.key] = event.target.checked; redraw(); }});
    return h('label', {class: 'switch'}, box, s.label);
  });
}

function saveSvg(element, name) {
  const svg = element.querySelector('svg').cloneNode(true);
  svg.setAttribute('xmlns', 'http://www.w3.org/2000/svg');
  svg.style.color = '#1c2330', svg.style.background = '#ffffff';
  offer(`${name}.svg`, 'image/svg+xml', new XMLSerializer().serializeToString(svg));
}

/**
 * A <figure>. `draw(width, state)` gives an element; state.hidden has the keys of hidden series, and state[key] the value of
 * each switch; those with `off` begin hidden. `from` lists the arrays that are drawn; `table`, one or more, is shown on demand.
 */
export function figure({id, title, text, from = [], series, controls, draw, table, half = false}) {
  const state = {hidden: new Set((series ?? []).filter(s => s.off).map(s => s.key))};
  const canvas = h('div', {class: 'plot'});
  let width = 0;
  const redraw = to => {
    if (typeof to === 'number') {
      if (Math.abs(to - width) < 1) return;
      width = to;
    }
    if (!(width > 0)) return;
    try {
      canvas.replaceChildren(draw(Math.floor(width), state));
    } catch (error) {
      figures.failed++;
      console.error(`figure ${id}:`, error);
      canvas.replaceChildren(h('p', {class: 'note'}, `This chart could not be drawn: ${error.message}`));
    }
  };
  const bar = h('div', {class: 'controls'}, legend(series, state.hidden, redraw), switches(controls, state, redraw));
  canvas.redraw = redraw;
  redraws.add(redraw), watcher.observe(canvas);
  figures.drawn++;
  return h('figure', {id, class: half ? 'half' : null},
    h('figcaption', {}, h('h3', {}, title), text && h('p', {}, text)),
    bar.childElementCount ? bar : null, canvas,
    h('footer', {}, h('span', {class: 'from'}, grouped(from).map(path => h('code', {}, path))),
      h('button', {type: 'button', class: 'small', onclick: () => saveSvg(canvas, id)}, 'Save SVG')),
    table && h('details', {class: 'numbers'}, h('summary', {}, 'Numbers'), [table].flat().filter(Boolean).map(tableWithTools)));
}

/** What stands where a part of the document is missing. */
export function missing(title, text, command) {
  return h('div', {class: 'missing'}, h('h3', {}, title), h('p', {}, text), command && h('pre', {class: 'command'}, h('code', {}, command)));
}
