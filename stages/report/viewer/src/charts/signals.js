// SPDX-License-Identifier: BSD-3-Clause
// Diffusion MRI: direction-averaged signals, single measurements, displacements over time.
import * as Plot from '@observablehq/plot';
import {seriesColour, typeColour} from '../colours.js';
import {array, rowOf, scalar, values} from '../data.js';
import {amount, show} from '../dom.js';
import {figure, logAxis, missing, plot} from '../figure.js';

const simulate = 'conceg simulate cube.cgx --walkers 100000 -o simulated.cgx';
const compartments = () => values('/signals/compartment') ?? [];
// A compartment "type NAME" has the colour of that type, and begins hidden where there are others.
const colourOf = (name, i) => (name.startsWith('type ') ? typeColour(name.slice(5)) : seriesColour(i));
const colours = () => Object.fromEntries(compartments().map((name, i) => [name, colourOf(name, i)]));
const series = () => compartments().map((key, i) => ({key, colour: colourOf(key, i), off: key.startsWith('type ') && !compartments()[0].startsWith('type ')}));

// b = 0 and values that lie together are one shell when the document has no averages of its own.
function shells() {
  const powder = array('/signals/powder'), b = values('/signals/powder_b'), error = array('/signals/powder_error');
  if (powder && b)
    return {from: ['/signals/powder_b', '/signals/powder', ...(error ? ['/signals/powder_error'] : [])], averaged: true,
      rows: compartments().flatMap((name, x) => b.map((value, i) => ({name, b: value, signal: rowOf(powder, x)[i], error: error ? rowOf(error, x)[i] : 0})))};
  const signal = array('/signals/signal'), own = values('/protocol/b'), spread = array('/signals/standard_error');
  if (!signal || !own) return null;
  return {from: ['/protocol/b', '/signals/signal'], averaged: false, rows: compartments().flatMap((name, x) => own.map((value, i) => ({name, b: value, signal: rowOf(signal, x)[i], error: spread ? rowOf(spread, x)[i] : 0})))};
}

// Values of one protocol column as words: one value or a range.
function timing(path, label) {
  const all = (values(path) ?? []).filter(v => v > 0);
  if (!all.length) return null;
  const least = Math.min(...all), most = Math.max(...all);
  return `${label} ${least === most ? show(least) : `${show(least)} to ${show(most)}`}\u202fms`;
}

export function protocolText() {
  const count = values('/protocol/b')?.length;
  return [count && `${show(count)} measurements`, timing('/protocol/pulse_duration', 'δ'), timing('/protocol/pulse_separation', 'Δ'), timing('/protocol/echo_time', 'TE'),
    values('/signals/walkers') && `${show(values('/signals/walkers').reduce((a, b) => Math.max(a, b), 0))} walkers`, scalar('/walkers@leaks') !== null && `${show(scalar('/walkers@leaks'))} leaks`].filter(Boolean).join(', ');
}

function decay({id, title, text, x, xLabel, y, found}) {
  const rows = found.rows.map(r => ({...r, x: x(r.b)})).filter(r => Number.isFinite(r.x));
  return figure({
    id, half: true, title, text, from: found.from, series: series(), controls: [{key: 'log', label: 'log scale', value: y === 'log'}, {key: 'errors', label: 'error bars', value: true}],
    draw: (width, {hidden, log, errors}) => {
      const shown = rows.filter(r => !hidden.has(r.name) && (!log || r.signal > 0)), colour = colours();
      const low = r => (log ? Math.max(r.signal - r.error, r.signal * 0.3) : r.signal - r.error);
      return plot(width, {
        x: {label: xLabel, grid: true, nice: true, zero: true}, y: log ? logAxis('signal / signal at b = 0', shown.flatMap(r => [r.signal, low(r), r.signal + r.error])) : {label: 'signal / signal at b = 0', grid: true, nice: true, zero: true},
        marks: [
          Plot.line(shown, {x: 'x', y: 'signal', z: 'name', stroke: r => colour[r.name], strokeOpacity: found.averaged ? 0.7 : 0}),
          errors ? Plot.ruleX(shown, {x: 'x', y1: low, y2: r => r.signal + r.error, stroke: r => colour[r.name], strokeWidth: 1.5}) : null,
          Plot.dot(shown, {x: 'x', y: 'signal', r: 3.5, fill: r => colour[r.name], ariaLabel: r => `${r.name} ${r.b} ${r.signal}`, title: r => `${r.name}\nb ${amount(r.b, 'ms/um^2')}\nsignal ${show(r.signal, 4)}${r.error ? ` ± ${show(r.error, 2)}` : ''}`, tip: true}),
        ],
      });
    },
  });
}

function directions() {
  const signal = array('/signals/signal'), b = values('/protocol/b'), direction = array('/protocol/direction');
  if (!signal || !b || !direction || b.length < 7) return null;
  const names = compartments();
  return figure({
    id: 'directions', half: true, title: 'By direction', text: 'Single measurements against the angle of the gradient to the z axis (towards the pia): a spread within a shell is anisotropy. ' + `Dark to light: b from ${show(Math.min(...b.filter(v => v > 0)))} to ${show(Math.max(...b))} ms/µm².`, from: ['/signals/signal', '/protocol/direction', '/protocol/b'],
    controls: [{key: 'name', label: 'Compartment', choices: names, value: names.includes('all') ? 'all' : names[0]}],
    draw: (width, {name}) => {
      const own = rowOf(signal, names.indexOf(name));
      const rows = b.map((value, i) => ({b: value, angle: Math.acos(Math.min(1, Math.abs(rowOf(direction, i)[2]))) * 180 / Math.PI, signal: own[i]})).filter(r => r.b > 0);
      return plot(width, {
        x: {label: 'angle to z (°)', domain: [0, 90], grid: true}, y: {label: 'signal', grid: true, zero: true, nice: true}, color: {type: 'linear', scheme: 'viridis', label: 'b (ms/µm²)', legend: false},
        marks: [Plot.dot(rows, {x: 'angle', y: 'signal', r: 2.8, fill: 'b', fillOpacity: 0.85, ariaLabel: r => `${name} ${r.b} ${r.signal}`, title: r => `b ${amount(r.b, 'ms/um^2')}, ${show(r.angle, 3)}°\nsignal ${show(r.signal, 4)}`, tip: true})],
      });
    },
  });
}

// A quantity over diffusion time, one line per compartment (and axis).
function overTime({id, title, text, name, label, axes}) {
  const time = values('/signals/time'), found = array(`/signals/${name}`), error = array(`/signals/${name}_error`);
  if (!time || !found) return null;
  const count = time.length, parts = axes ? ['x', 'y', 'z'] : [''];
  const rows = compartments().flatMap((compartment, x) => time.flatMap((t, i) => parts.map((axis, a) => {
    const at = i * parts.length + a;
    return {name: compartment, time: t, axis, value: rowOf(found, x)[at], error: error ? rowOf(error, x)[at] : 0};
  })));
  const wanted = r => r.axis;
  return figure({
    id, half: true, title, text, from: ['/signals/time', `/signals/${name}`, ...(error ? [`/signals/${name}_error`] : [])], series: series(),
    controls: [...(axes ? [{key: 'axis', label: 'Axis', choices: ['mean', 'x', 'y', 'z']}] : []), {key: 'root', label: '1/√t axis', value: false}, {key: 'log', label: 'log scales', value: false}],
    draw: (width, {hidden, axis, root, log}) => {
      const colour = colours();
      const mean = list => list.reduce((sum, r) => sum + r.value, 0) / list.length;
      const chosen = axes && axis === 'mean'
        ? compartments().flatMap(c => time.map(t => { const list = rows.filter(r => r.name === c && r.time === t); return {name: c, time: t, value: mean(list), error: Math.hypot(...list.map(r => r.error)) / list.length}; }))
        : rows.filter(r => !axes || wanted(r) === axis);
      const shown = chosen.filter(r => !hidden.has(r.name)).map(r => ({...r, x: root ? 1 / Math.sqrt(r.time) : r.time})).filter(r => !log || (r.x > 0 && r.value > 0));
      return plot(width, {
        x: log ? logAxis(root ? '1 / √t (ms^-½)' : 'time t (ms)', shown.map(r => r.x)) : {label: root ? '1 / √t (ms^-½)' : 'time t (ms)', grid: true, zero: true, nice: true}, y: log ? logAxis(label, shown.map(r => r.value)) : {label, grid: true, nice: true},
        marks: [
          count > 1 ? Plot.line(shown, {x: 'x', y: 'value', z: 'name', stroke: r => colour[r.name]}) : null,
          Plot.ruleX(shown, {x: 'x', y1: r => (log ? Math.max(r.value - r.error, r.value * 0.05) : r.value - r.error), y2: r => r.value + r.error, stroke: r => colour[r.name], strokeWidth: 1.5}),
          Plot.dot(shown, {x: 'x', y: 'value', r: 3.5, fill: r => colour[r.name], ariaLabel: r => `${r.name} ${r.time} ${r.value}`, title: r => `${r.name}, t ${amount(r.time, 'ms')}\n${show(r.value, 4)} ± ${show(r.error, 2)}`, tip: true}),
        ],
      });
    },
  });
}

export function signalFigures() {
  const found = compartments().length ? shells() : null;
  if (!found || !found.rows.length) return [missing('Signals', 'No /signals: conceg simulate makes them (it needs /meshes), conceg import signal reads those of a scanner.', simulate)];
  const averaged = found.averaged ? 'Averaged over directions; bars are one standard error over walkers. A log scale leaves out what is not above 0.' : 'Each measurement as it is; the document has no averages over directions.';
  return [
    decay({id: 'decay', title: 'Signal against b', text: averaged, x: b => b, xLabel: 'b (ms/µm²)', y: 'log', found}),
    decay({id: 'root', title: 'Signal against 1/√b', text: 'Thin processes are a straight line through the origin here.', x: b => (b > 0 ? 1 / Math.sqrt(b) : NaN), xLabel: '1 / √b ((µm²/ms)^½)', y: 'linear', found}),
    directions(),
  ];
}

export function timeFigures() {
  const list = [
    overTime({id: 'diffusivity', title: 'Diffusivity over time', text: 'Mean squared displacement over 2t along an axis.', name: 'diffusivity', label: 'D(t) (µm²/ms)', axes: true}),
    overTime({id: 'msd', title: 'Mean squared displacement', text: 'In three dimensions.', name: 'msd', label: '⟨r²⟩ (µm²)', axes: false}),
    overTime({id: 'kurtosis', title: 'Kurtosis of displacements', text: 'Excess, 0 for a Gaussian.', name: 'kurtosis', label: 'K(t)', axes: true}),
  ].filter(Boolean);
  return list.length ? list : [missing('Diffusion over time', 'No /signals/time: conceg simulate stores displacements at times that it is given.', 'conceg simulate cube.cgx --times-ms 1,2,5,10,20,50 -o simulated.cgx')];
}
