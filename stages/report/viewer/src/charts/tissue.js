// SPDX-License-Identifier: BSD-3-Clause
// What the tissue is made of: cells, volume fractions, cable, bars.
import * as Plot from '@observablehq/plot';
import {classColour, spaceColours, stateColours, typeColour} from '../colours.js';
import {table} from '../data.js';
import {amount, show, words} from '../dom.js';
import {figure, missing, plot} from '../figure.js';

const analyse = 'conceg analyse cube.cgx -o analysed.cgx';

/** The value of a row of /statistics/summary, or null. */
export function summary(name) {
  return table('summary')?.records.find(r => r.name === name)?.value ?? null;
}

function fractions() {
  const ways = [['icvf_mesh', 'surfaces'], ['icvf_field', 'voxels'], ['icvf_points', 'random points']];
  const rows = ways.map(([name, label]) => ({name, label, value: summary(name), error: name === 'icvf_points' ? summary('icvf_points_standard_error') ?? 0 : 0})).filter(r => r.value !== null);
  if (!rows.length) return missing('Volume fraction', 'No /statistics/summary with icvf_mesh, icvf_field or icvf_points: conceg analyse measures them.', analyse);
  const most = Math.max(...rows.map(r => r.value + r.error)), least = Math.min(...rows.map(r => r.value - r.error));
  const room = Math.max(0.004, (most - least) * 0.6);
  return figure({
    id: 'fractions', half: true, title: `Intracellular volume fraction, ${rows.length === 3 ? 'three' : rows.length} ways`,
    text: `The volume of the surfaces by the divergence theorem, voxels of the skeletons’ field, and located points are independent measures of one thing. They lie ${show(most - least, 2)} apart; bars are one standard error.`,
    from: table('summary').where('name', 'value'),
    draw: width => plot(width, {
      height: 60 + 44 * rows.length, marginLeft: 110,
      x: {label: 'volume of cells / volume of the box', domain: [least - room, most + room], grid: true, ticks: Math.max(3, Math.floor(width / 130))}, y: {label: null, domain: rows.map(r => r.label)},
      marks: [
        Plot.ruleY(rows, {y: 'label', x1: r => r.value - r.error, x2: r => r.value + r.error, stroke: '#2f7fc1', strokeWidth: 3}),
        Plot.dot(rows, {y: 'label', x: 'value', r: 6, fill: '#2f7fc1', ariaLabel: r => `${r.name} ${r.value}`}),
        Plot.text(rows, {y: 'label', x: 'value', text: r => show(r.value, 4) + (r.error ? ` ± ${show(r.error, 1)}` : ''), dy: -14, fill: 'currentColor'}),
      ],
    }),
  });
}

function shares() {
  const rows = [['soma_fraction', 'soma'], ['neurite_fraction', 'neurite'], ['ecs_fraction', 'extracellular']].map(([name, part]) => ({name, part, value: summary(name)})).filter(r => r.value !== null);
  if (!rows.length) return null;
  return figure({
    id: 'shares', half: true, title: 'What fills the box', text: 'Shares of voxels: within a soma’s sphere, within a process, or in no cell.',
    from: table('summary').where('name', 'value'), series: rows.map(r => ({key: r.part, colour: spaceColours[r.part]})),
    draw: (width, {hidden}) => plot(width, {
      height: 130, marginLeft: 12, x: {label: 'share of the box', percent: true, domain: [0, 100]}, y: {axis: null},
      marks: [
        Plot.barX(rows.filter(r => !hidden.has(r.part)), Plot.stackX({x: 'value', fill: r => spaceColours[r.part], ariaLabel: r => `${r.part} ${r.value}`, title: r => `${r.part}: ${show(100 * r.value)} %`, tip: true, inset: 0.5})),
        Plot.text(rows.filter(r => !hidden.has(r.part) && r.value > 0.06), Plot.stackX({x: 'value', text: r => `${show(100 * r.value, 3)} %`, fill: r => (r.part === 'soma' ? '#fff' : '#10202e')})),
      ],
    }),
  });
}

function counts() {
  const t = table('type') ?? table('class');
  if (!t) return missing('Cells by type', 'No /statistics/type: conceg analyse counts them.', analyse);
  const key = t.name === 'type' ? 'type' : 'class';
  const measures = ['cells', 'volume', 'volume_fraction', 'surface', 'cable', 'cable_density', 'soma_volume', 'mean_radius'].filter(c => t.has(c));
  return figure({
    id: 'types', half: true, title: 'Cells by type', text: 'Counts, and what the cells of each type have together.', from: t.where(key, ...measures), table: [t, key === 'type' && table('class')],
    controls: [{key: 'measure', label: 'Show', choices: measures, names: Object.fromEntries(measures.map(m => [m, words(m)]))}],
    draw: (width, {measure}) => plot(width, {
      height: 60 + 34 * t.records.length, marginLeft: Math.min(150, width * 0.34), marginRight: 60,
      x: {label: [words(measure), amountUnit(t, measure)].filter(Boolean).join(' '), grid: true, nice: true}, y: {label: null, domain: t.records.map(r => r[key])},
      marks: [
        Plot.barX(t.records, {x: measure, y: key, fill: r => (key === 'type' ? typeColour(r.type) : classColour(r.class)), ariaLabel: r => `${r[key]} ${measure} ${r[measure]}`}),
        Plot.text(t.records, {x: measure, y: key, text: r => show(r[measure], 4), dx: 6, textAnchor: 'start'}), Plot.ruleX([0]),
      ],
    }),
  });
}
const amountUnit = (t, column) => { const text = amount('', t.unit(column)); return text ? `(${text.trim()})` : ''; };

function cable() {
  const t = table('neurite');
  if (!t || !t.records.length) return null;
  const kinds = [...new Set(t.records.map(r => r.neurite))];
  const colours = {'basal dendrite': '#1f6fb5', 'apical dendrite': '#6db6ec', axon: '#c9a21b', 'glial process': '#1e9c73', other: '#9aa3ad'};
  return figure({
    id: 'cable', half: true, title: 'Cable of processes', text: 'Length of all skeletons by class and kind.', from: t.where('class', 'neurite', 'cable'), table: t,
    series: kinds.map(k => ({key: k, colour: colours[k] ?? '#9aa3ad'})),
    draw: (width, {hidden}) => plot(width, {
      height: 60 + 34 * new Set(t.records.map(r => r.class)).size, marginLeft: 100, x: {label: 'cable (mm)', grid: true, transform: v => v / 1000}, y: {label: null},
      marks: [Plot.barX(t.records.filter(r => !hidden.has(r.neurite)), {x: 'cable', y: 'class', fill: r => colours[r.neurite] ?? '#9aa3ad', ariaLabel: r => `${r.class} ${r.neurite} ${r.cable} um`, title: r => `${r.class}, ${r.neurite}\n${amount(r.cable / 1000, 'mm')}, mean radius ${amount(r.mean_radius, 'um')}`, tip: true}), Plot.ruleX([0])],
    }),
  });
}

function bars() {
  const t = table('bars');
  if (!t || !t.records.length) return missing('Bars reached', 'No /statistics/bars: grow makes /bars, analyse counts them.', analyse);
  const states = ['done', 'handed', 'short', 'lost', 'waiting'];
  const rows = t.records.flatMap(r => states.map(state => ({type: r.type, state, count: r[state], share: r.bars ? r[state] / r.bars : 0})));
  const all = t.records.find(r => r.type === 'all') ?? t.records[0];
  return figure({
    id: 'bars', half: true, title: 'Bars reached', from: t.where('type', ...states), table: [t, table('comparison_bars')],
    text: `A bar is one branch path asked of a cell. ${show(all.done)} of ${show(all.bars)} are done as asked, ${show(all.short)} short, ${show(all.lost)} lost; ${amount(all.achieved / 1000, 'mm')} of ${amount(all.asked / 1000, 'mm')} grew.`,
    series: states.map(key => ({key, colour: stateColours[key]})),
    draw: (width, {hidden}) => plot(width, {
      height: 60 + 34 * t.records.length, marginLeft: Math.min(150, width * 0.34), x: {label: 'share of the bars asked', percent: true, domain: [0, 100]}, y: {label: null, domain: t.records.map(r => r.type)},
      marks: [Plot.barX(rows.filter(r => !hidden.has(r.state) && r.count), {x: 'share', y: 'type', fill: r => stateColours[r.state], ariaLabel: r => `${r.type} ${r.state} ${r.count}`, title: r => `${r.type}: ${r.count} ${r.state} (${show(100 * r.share, 3)} %)`, tip: true})],
    }),
  });
}

/** The section's figures. */
export const tissueFigures = () => [counts(), fractions(), shares(), cable(), bars()];
