// SPDX-License-Identifier: BSD-3-Clause
// Tables diffusivity*: D(t) of the walkers with the power laws that were fitted to its end.
import * as Plot from '@observablehq/plot';
import {seriesColour} from '../colours.js';
import {table} from '../data.js';
import {amount, h, show} from '../dom.js';
import {figure, plot} from '../figure.js';
import {explorer} from './generic.js';

// D(t) = limit + amplitude t^-exponent at some times.
function law(fit) {
  const steps = 40;
  return Array.from({length: steps + 1}, (_, i) => fit.from * (fit.to / fit.from) ** (i / steps)).map(time => ({compartment: fit.compartment, law: fit.law, time, value: fit.limit + fit.amplitude * time ** -fit.exponent}));
}

function tail(t, fits) {
  const names = [...new Set(t.records.map(r => r.compartment))], colour = name => seriesColour(names.indexOf(name));
  const usable = (fits?.records ?? []).filter(f => f.state === 'fitted' && f.from > 0 && f.to > f.from), laws = [...new Set(usable.map(f => f.law))];
  const axes = ['mean', 'x', 'y', 'z'].filter(a => a === 'mean' || t.has(`diffusivity_${a}`));
  const of = (axis, error = '') => (axis === 'mean' ? `diffusivity${error}` : `diffusivity_${axis}${error}`);
  return figure({
    id: 'diffusivity-tail', half: true, title: 'How D(t) ends', text: ['D(t) = D∞ + A t', h('sup', {}, '−θ'), ' fitted to its end (dashed). Disorder in one dimension gives θ = ½, in two 1, in three 3/2.'], from: [...t.where('time', 'diffusivity', 'diffusivity_error'), ...(fits ? fits.where('limit', 'amplitude', 'exponent') : [])], table: [t, fits],
    series: names.map(key => ({key, colour: colour(key)})),
    controls: [{key: 'axis', label: 'Axis', choices: axes}, ...(laws.length ? [{key: 'law', label: 'Law', choices: laws}] : []), {key: 'x', label: 'x', choices: ['t', 'root'], names: {t: 't', root: '1/√t'}}],
    draw: (width, state) => {
      const at = r => (state.x === 't' ? r.time : 1 / Math.sqrt(r.time)), shown = r => !state.hidden.has(r.compartment);
      const rows = t.records.filter(r => shown(r) && r.time > 0).map(r => ({...r, value: r[of(state.axis)], error: r[of(state.axis, '_error')] ?? 0}));
      const curves = usable.filter(f => shown(f) && f.law === state.law && f.axis === state.axis).flatMap(law);
      return plot(width, {
        x: {label: state.x === 't' ? 'time t (ms)' : '1 / √t (ms^-½)', grid: true, nice: true, zero: true}, y: {label: 'D(t) (µm²/ms)', grid: true, nice: true},
        marks: [Plot.line(curves, {x: at, y: 'value', z: 'compartment', stroke: r => colour(r.compartment), strokeDasharray: '5 4', strokeWidth: 2}), Plot.ruleX(rows, {x: at, y1: r => r.value - r.error, y2: r => r.value + r.error, stroke: r => colour(r.compartment)}),
          Plot.dot(rows, {x: at, y: 'value', r: 3.5, fill: r => colour(r.compartment), ariaLabel: r => `${r.compartment} ${r.time} ${r.value}`, title: r => `${r.compartment}, t ${amount(r.time, 'ms')}\n${show(r.value, 4)} ± ${show(r.error, 2)} µm²/ms`, tip: true})],
      });
    },
  });
}

/** Figures for the tables of these names: D(t) with its fits where the columns are known, all else generic. */
export function timeTables(names) {
  const t = names.includes('diffusivity') ? table('diffusivity') : null, found = names.includes('diffusivity_fit') ? table('diffusivity_fit') : null;
  const known = t && t.records.length && t.has('compartment', 'time', 'diffusivity', 'diffusivity_error');
  const fits = found && found.has('compartment', 'axis', 'law', 'state', 'from', 'to', 'limit', 'amplitude', 'exponent') ? found : null;
  return [known ? tail(t, fits) : null, ...names.filter(name => !(known && name === 'diffusivity_fit' && fits)).map(name => explorer(table(name), true))];
}
