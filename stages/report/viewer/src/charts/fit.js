// SPDX-License-Identifier: BSD-3-Clause
// SANDI: fits beside the signal, and what they find beside what the geometry has.
import * as Plot from '@observablehq/plot';
import {seriesColour} from '../colours.js';
import {table} from '../data.js';
import {amount, labelled, show, words} from '../dom.js';
import {figure, logAxis, missing, plot} from '../figure.js';

// "intra, gpd sphere, D free", and what else tells one fit from another.
function namesOf(fits) {
  const short = r => `${r.signal}, ${r.kernel} sphere, D ${/neurite_diffusivity/.test(r.fitted) ? 'free' : 'held'}`;
  const long = r => `${short(r)}, ${r.model}, ${r.extracellular}`;
  const unique = (name, r) => fits.filter(x => name(x) === name(r)).length === 1;
  return fits.map((r, i) => (unique(short, r) ? short(r) : unique(long, r) ? long(r) : `${long(r)} (${i})`));
}

function curves(fits, shells, names) {
  const rows = shells.records.map(r => ({...r, name: names[r.fit], of: fits.records[r.fit]?.signal})).filter(r => r.name !== undefined);
  const signals = [...new Set(rows.map(r => r.of))];
  return figure({
    id: 'sandi-curves', half: true, title: 'Fits to the signal', text: 'Dots: signal with standard error; lines: fits.', from: shells.where('b', 'signal', 'error', 'fitted'), table: shells,
    series: names.map((key, i) => ({key, colour: seriesColour(i)})), controls: [{key: 'of', label: 'Signal', choices: signals}, {key: 'x', label: 'x', choices: ['b', 'root'], names: {b: 'b', root: '1/√b'}}, {key: 'log', label: 'log scale', value: true}],
    draw: (width, {hidden, of, x, log}) => {
      const at = r => (x === 'b' ? r.b : r.b > 0 ? 1 / Math.sqrt(r.b) : NaN);
      const own = rows.filter(r => r.of === of).map(r => ({...r, x: at(r)})).filter(r => Number.isFinite(r.x) && (!log || (r.signal > 0 && r.fitted > 0)));
      const first = own.filter(r => r.fit === own[0]?.fit), drawn = own.filter(r => !hidden.has(r.name));
      return plot(width, {
        x: {label: x === 'b' ? 'b (ms/µm²)' : '1 / √b ((µm²/ms)^½)', grid: true, zero: true}, y: log ? logAxis('signal / signal at b = 0', own.flatMap(r => [r.signal, r.fitted])) : {label: 'signal / signal at b = 0', grid: true, zero: true},
        marks: [
          Plot.line(drawn, {x: 'x', y: 'fitted', z: 'name', sort: 'x', stroke: r => seriesColour(r.fit), ariaLabel: r => r.name}),
          Plot.ruleX(first, {x: 'x', y1: r => (log ? Math.max(r.signal - r.error, r.signal * 0.05) : r.signal - r.error), y2: r => r.signal + r.error, stroke: 'currentColor'}),
          Plot.dot(first, {x: 'x', y: 'signal', r: 3.5, fill: 'currentColor', ariaLabel: r => `${of} ${r.b} ${r.signal}`, title: r => `b ${amount(r.b, 'ms/um^2')}\nsignal ${show(r.signal, 4)} ± ${show(r.error, 2)}`, tip: true}),
        ],
      });
    },
  });
}

function residuals(shells, names) {
  const rows = shells.records.map(r => ({...r, name: names[r.fit]})).filter(r => r.name !== undefined);
  return figure({
    id: 'sandi-residuals', half: true, title: 'Residuals', text: 'Signal less fit.', from: shells.where('b', 'residual'), series: names.map((key, i) => ({key, colour: seriesColour(i)})),
    draw: (width, {hidden}) => plot(width, {
      x: {label: 'b (ms/µm²)', grid: true, zero: true}, y: {label: 'signal − fit', grid: true, nice: true},
      marks: [Plot.ruleY([0]), Plot.line(rows.filter(r => !hidden.has(r.name)), {x: 'b', y: 'residual', z: 'name', stroke: r => seriesColour(r.fit)}), Plot.dot(rows.filter(r => !hidden.has(r.name)), {x: 'b', y: 'residual', r: 3, fill: r => seriesColour(r.fit), ariaLabel: r => `${r.name} ${r.b} ${r.residual}`, title: r => `${r.name}\nb ${amount(r.b, 'ms/um^2')}\nresidual ${show(r.residual, 3)}`, tip: true})],
    }),
  });
}

const quantities = ['f_neurite', 'f_soma', 'f_extracellular', 'radius', 'neurite_diffusivity', 'soma_diffusivity', 'extra_diffusivity'];
const quantityNames = {f_neurite: 'share of neurites', f_soma: 'share of somas', f_extracellular: 'share of the extracellular space', radius: 'soma radius', soma_radius: 'soma radius'};

function parameters(fits, names) {
  const choices = fits.columns.map(c => c.name).filter(c => fits.has(`${c}_error`));
  const ordered = [...quantities.filter(q => choices.includes(q)), ...choices.filter(c => !quantities.includes(c))];
  const truths = r => [[r[`${r.quantity}_truth`], 'the geometry', '#2a9d78']];
  return figure({
    id: 'sandi-truth', title: 'Fits beside the ground truth of the geometry', text: 'Dots: fits with one standard error. Green lines: what the geometry has (shares of the cells’ volume for reduced fits, of the box for full ones; radii: mean, and as long pulses weight them).',
    from: fits.where(...ordered), table: [fits, table('sandi_covariance')], controls: [{key: 'quantity', label: 'Quantity', choices: ordered, names: Object.fromEntries(ordered.map(q => [q, quantityNames[q] ?? words(q)]))}],
    draw: (width, {quantity}) => {
      const rows = fits.records.map((r, i) => ({name: names[i], value: r[quantity], error: r[`${quantity}_error`], quantity, colour: seriesColour(i), bound: String(r.at_bound ?? '').split(' ').includes(quantity),
        truths: /radius/.test(quantity) ? [[r.radius_truth, 'mean'], [r.radius_truth_effective, 'effective']] : truths({...r, quantity})})).filter(r => r.value !== null);
      const marks = rows.flatMap(r => r.truths.filter(t => Number.isFinite(t[0])).map(t => ({name: r.name, value: t[0], label: t[1]})));
      return plot(width, {
        height: 70 + 40 * rows.length, marginLeft: Math.min(250, width * 0.38), x: {label: labelled(quantityNames[quantity] ?? words(quantity), fits.unit(quantity)), grid: true, nice: true, ticks: Math.floor(width / 100)}, y: {label: null, domain: rows.map(r => r.name)},
        marks: [
          Plot.tickX(marks, {y: 'name', x: 'value', stroke: '#2a9d78', strokeWidth: 3, ariaLabel: r => `truth ${r.name} ${r.value}`, title: r => `geometry (${r.label}): ${show(r.value, 4)}`, tip: true}),
          Plot.ruleY(rows, {y: 'name', x1: r => r.value - r.error, x2: r => r.value + r.error, stroke: 'colour', strokeWidth: 3, strokeOpacity: 0.5}),
          Plot.dot(rows, {y: 'name', x: 'value', r: 6, fill: 'colour', ariaLabel: r => `${r.name} ${quantity} ${r.value}`, title: r => `${r.name}\n${show(r.value, 4)} ± ${show(r.error, 2)}${r.bound ? '\nat a bound' : ''}`, tip: true}),
        ], color: {type: 'identity'},
      });
    },
  });
}

function truth() {
  const t = table('sandi_truth');
  if (!t || !t.records.length) return null;
  return {table: t, title: 'Ground truth', text: 'What the surfaces enclose: shares of the box, and radii of somas (of the SWC spheres, and of spheres with the somas’ mesh volume).'};
}

/** Figures, and the table of the truth as {table, title, text}. */
export function fitFigures() {
  const fits = table('sandi'), shells = table('sandi_shell');
  if (!fits || !fits.records.length) return {figures: [missing('SANDI', 'No /statistics/sandi: conceg fit fits it to /signals and holds it against the geometry.', 'conceg simulate cube.cgx | conceg fit -o fitted.cgx')], truth: truth()};
  const names = namesOf(fits.records);
  return {figures: [parameters(fits, names), ...(shells ? [curves(fits, shells, names), residuals(shells, names)] : [])], truth: truth()};
}
