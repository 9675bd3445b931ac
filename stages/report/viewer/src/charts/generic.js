// SPDX-License-Identifier: BSD-3-Clause
// Any table: sortable, and a chart of columns that the reader picks. Nothing of /statistics is left out.
import * as Plot from '@observablehq/plot';
import {seriesColour} from '../colours.js';
import {amount, h, labelled, show, words} from '../dom.js';
import {figure, logAxis, plot} from '../figure.js';
import {tableWithTools} from '../table.js';

const numeric = t => t.columns.filter(c => c.type !== 'text').map(c => c.name);
const textual = t => t.columns.filter(c => c.type === 'text').map(c => c.name);
const spread = (t, name) => new Set(t.records.map(r => r[name])).size;

// The column that holds the error of another one, by its name.
const errorOf = (t, name) => [`${name}_error`, `${name}_standard_error`, `${name}_se`, `${name}_sd`].find(c => t.has(c)) ?? (['error', 'standard_error', 'sd'].find(c => t.has(c) && ['value', 'mean', 'effect'].includes(name)) ?? null);

// What is worth being the first thing drawn: a coordinate against the first other number.
function guess(t) {
  const numbers = numeric(t), labels = textual(t).filter(c => spread(t, c) > 1);
  const coordinate = numbers.find(c => /^(time|t|b|q|side|r|distance|voxel|delta|separation|step|lag|radius)(_|$)/.test(c) && spread(t, c) > 2);
  const plain = numbers.filter(c => !/(_error|_se|_sd|_low|_high|count|cells)$/.test(c) && c !== coordinate);
  const y = plain.find(c => /(effect|value|mean|diffusivity|distance)/.test(c)) ?? plain[0] ?? numbers[0];
  if (coordinate) return {x: coordinate, y, series: labels[0] ?? ''};
  // Names that still can be read below one another; the one with most of them.
  const readable = labels.filter(c => spread(t, c) <= 30), x = readable.find(c => spread(t, c) === Math.max(...readable.map(l => spread(t, l))));
  if (x) return {x, y, series: readable.find(c => spread(t, c) < 9 && c !== x) ?? ''};
  return {x: numbers[0], y: numbers[1] ?? numbers[0], series: ''};
}

function bars(t, width, {x, y, series}, hidden, error) {
  const rows = t.records.filter(r => r[y] !== null && !hidden.has(String(r[series])));
  const names = [...new Set(t.records.map(r => String(r[x])))], keys = [...new Set(t.records.map(r => String(r[series])))];
  const colour = r => seriesColour(series ? keys.indexOf(String(r[series])) : 0);
  return plot(width, {
    height: Math.min(900, 70 + 26 * names.length), marginLeft: Math.min(220, width * 0.36), x: {label: labelled(words(y), t.unit(y)), grid: true, nice: true}, y: {label: null, domain: names},
    marks: [Plot.ruleX([0]),
      error ? Plot.ruleY(rows, {y: r => String(r[x]), x1: r => r[y] - r[error], x2: r => r[y] + r[error], stroke: colour, strokeOpacity: 0.5, strokeWidth: 2}) : null,
      Plot.dot(rows, {x: y, y: r => String(r[x]), r: 5, fill: colour, ariaLabel: r => `${r[x]} ${r[y]}`, title: r => `${r[x]}${series ? `, ${r[series]}` : ''}\n${words(y)} ${amount(r[y], t.unit(y))}${error ? ` ± ${show(r[error], 2)}` : ''}`, tip: true})],
  });
}

function curves(t, width, {x, y, series, logx, logy}, hidden, error) {
  const keys = [...new Set(t.records.map(r => String(r[series])))];
  const rows = t.records.filter(r => r[x] !== null && r[y] !== null && !hidden.has(String(r[series])) && (!logx || r[x] > 0) && (!logy || r[y] > 0));
  const colour = r => seriesColour(series ? keys.indexOf(String(r[series])) : 0), z = series ? r => String(r[series]) : null;
  return plot(width, {
    x: logx ? logAxis(labelled(words(x), t.unit(x)), rows.map(r => r[x])) : {label: labelled(words(x), t.unit(x)), grid: true, nice: true}, y: logy ? logAxis(labelled(words(y), t.unit(y)), rows.map(r => r[y])) : {label: labelled(words(y), t.unit(y)), grid: true, nice: true},
    marks: [
      rows.length < 2000 && spread(t, x) > 2 ? Plot.line(rows, {x, y, z, sort: x, stroke: colour, strokeOpacity: 0.6}) : null,
      error ? Plot.ruleX(rows, {x, y1: r => (logy ? Math.max(r[y] - r[error], r[y] * 0.05) : r[y] - r[error]), y2: r => r[y] + r[error], stroke: colour}) : null,
      Plot.dot(rows, {x, y, r: rows.length > 200 ? 2 : 4, fill: colour, ariaLabel: r => `${r[x]} ${r[y]}`, title: r => `${series ? `${r[series]}\n` : ''}${words(x)} ${amount(r[x], t.unit(x))}\n${words(y)} ${amount(r[y], t.unit(y))}${error ? ` ± ${show(r[error], 2)}` : ''}`, tip: true}),
    ],
  });
}

/** A chart of any two columns of the table; the table alone where it has no numbers or hardly any rows. */
export function explorer(t, half = false) {
  const numbers = numeric(t);
  if (!numbers.length || t.records.length < 3) return h('div', {class: 'frame'}, h('h3', {}, words(t.name || 'statistics')), tableWithTools(t));
  const first = guess(t), labels = textual(t);
  const keys = first.series ? [...new Set(t.records.map(r => String(r[first.series])))] : [];
  const names = Object.fromEntries([...numbers, ...labels].map(c => [c, words(c)]));
  const series = keys.length > 1 && keys.length < 13 ? keys.map((key, i) => ({key, colour: seriesColour(i)})) : null;
  return figure({
    id: `table-${t.name.replaceAll('/', '-')}`, half, title: words(t.name || 'statistics'), text: `${show(t.rows)} rows; pick what is drawn.`, from: [t.path], table: t, series,
    controls: [{key: 'x', label: 'x', choices: [...numbers, ...labels], value: first.x, names}, {key: 'y', label: 'y', choices: numbers, value: first.y, names}, {key: 'series', label: 'by', choices: ['', ...labels], value: first.series, names: {...names, '': 'nothing'}},
      {key: 'logx', label: 'log x', value: false}, {key: 'logy', label: 'log y', value: false}],
    draw: (width, state) => {
      const error = errorOf(t, state.y);
      return labels.includes(state.x) ? bars(t, width, state, state.hidden, error) : curves(t, width, state, state.hidden, error);
    },
  });
}
