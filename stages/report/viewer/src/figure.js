// SPDX-License-Identifier: BSD-3-Clause
// A chart in its frame: title, what it says, switches, legend, the chart, and where its numbers are.
import * as Plot from '@observablehq/plot';
import {h, offer} from './dom.js';
import {tableWithTools} from './table.js';

export const figures = {drawn: 0, failed: 0};

const redraws = new Set();
/** Draws all charts anew, for another theme or before printing. */
export const redrawAll = () => redraws.forEach(redraw => redraw());

const watcher = new ResizeObserver(entries => entries.forEach(entry => entry.target.redraw?.(entry.contentRect.width)));

/** Plot.plot with the page's look. */
export function plot(width, options) {
  return Plot.plot({
    width, height: Math.round(Math.min(380, Math.max(240, width * 0.5))), marginLeft: 58, marginBottom: 42, marginTop: 24, marginRight: 24,
    ...options,
    style: {background: 'transparent', color: 'currentColor', fontSize: '12px', overflow: 'visible', fontFamily: 'inherit'},
  });
}

function legend(series, hidden, redraw) {
  if (!series || series.length < 2) return null;
  return h('div', {class: 'legend', role: 'group', 'aria-label': 'series'}, series.map(s => {
    const button = h('button', {type: 'button', class: 'key', 'aria-pressed': 'true', title: 'show or hide'},
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
 * each switch. `from` lists the arrays that are drawn; `table` is shown on demand.
 */
export function figure({id, title, text, from = [], series, controls, draw, table, half = false}) {
  const state = {hidden: new Set()};
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
    h('footer', {}, h('span', {class: 'from'}, from.map(path => h('code', {}, path))),
      h('button', {type: 'button', class: 'small', onclick: () => saveSvg(canvas, id)}, 'Save SVG')),
    table && h('details', {class: 'numbers'}, h('summary', {}, 'Numbers'), tableWithTools(table)));
}

/** What stands where a part of the document is missing. */
export function missing(title, text, command) {
  return h('div', {class: 'missing'}, h('h3', {}, title), h('p', {}, text), command && h('pre', {class: 'command'}, h('code', {}, command)));
}
