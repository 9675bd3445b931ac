// SPDX-License-Identifier: BSD-3-Clause
// Shapes of cells: morphometry, comparison with what was drawn, with donors and with the paper.
import * as Plot from '@observablehq/plot';
import {classColour, typeColour as colourOfType} from '../colours.js';
import {facts, table} from '../data.js';
import {amount, show, unitText, words} from '../dom.js';
import {figure, missing, plot} from '../figure.js';

const degrees = 180 / Math.PI;
// Angles are shown in degrees, whatever they are stored in.
const shown = (value, unit) => (unit === 'rad' ? value * degrees : value);
const shownUnit = unit => (unit === 'rad' || unit === 'degree' ? '°' : unitText(unit));

function morphometry() {
  const t = table('morphometry');
  if (!t || !t.records.length) return missing('Morphometry', 'No /statistics/morphometry: conceg analyse measures it on a document with /skeleton.', 'conceg analyse grown.cgx -o analysed.cgx');
  const measures = [...new Set(t.records.map(r => r.measure))], classes = [...new Set(t.records.map(r => r.class))];
  return figure({
    id: 'morphometry', half: true, title: 'Branches by class', text: 'Mean and standard deviation over branches (over cells for branches per cell).', from: t.where('class', 'measure', 'mean', 'sd'), table: t,
    series: classes.map(key => ({key, colour: classColour(key)})),
    controls: [{key: 'measure', label: 'Measure', choices: measures, value: measures.includes('branch_length') ? 'branch_length' : measures[0], names: Object.fromEntries(measures.map(m => [m, words(m)]))}],
    draw: (width, {hidden, measure}) => {
      const rows = t.records.filter(r => r.measure === measure && !hidden.has(r.class) && r.count).map(r => ({...r, mean: shown(r.mean, r.unit), sd: shown(r.sd, r.unit), unit: r.unit}));
      return plot(width, {
        height: 70 + 40 * classes.length, marginLeft: 92, marginRight: 130, x: {label: `${words(measure)} ${shownUnit(rows[0]?.unit) ? `(${shownUnit(rows[0]?.unit)})` : ''}`, grid: true, zero: true, nice: true}, y: {label: null, domain: classes},
        marks: [
          Plot.ruleY(rows, {y: 'class', x1: r => Math.max(0, r.mean - r.sd), x2: r => r.mean + r.sd, stroke: r => classColour(r.class), strokeWidth: 3, strokeOpacity: 0.5}),
          Plot.dot(rows, {y: 'class', x: 'mean', r: 6, fill: r => classColour(r.class), ariaLabel: r => `${r.class} ${measure} ${r.mean}`}),
          Plot.text(rows, {y: 'class', x: r => r.mean + r.sd, text: r => `${show(r.mean, 3)} ± ${show(r.sd, 2)}  (n ${show(r.count)})`, dx: 10, textAnchor: 'start'}),
        ],
      });
    },
  });
}

const published = {order: ['order', 'order_sd'], branch_length: ['length_um', 'length_sd_um'], straightness: ['straightness', 'straightness_sd'], local_angle: ['angle_degree', 'angle_sd_degree']};
const sides = [
  {key: 'grown', label: 'grown here', colour: '#2f7fc1'}, {key: 'drawn', label: 'drawn for these cells', colour: '#6db6ec'}, {key: 'donors', label: 'donors (real cells)', colour: '#2a9d78'},
  {key: 'paper_real', label: 'paper, real cells', colour: '#8a8f98', dashed: true}, {key: 'paper_grown', label: 'paper, its ConCeG', colour: '#c98a2b', dashed: true},
];

// A row per type and side: mean, sd, count in degrees or the row's unit.
function comparisonRows(t, measure) {
  const rows = [];
  for (const r of t.records.filter(x => x.measure === measure)) {
    const name = r.part === 'axon' ? `${r.type}, axons` : r.type;
    for (const side of ['grown', 'drawn', 'donors'])
      if (r[`${side}_count`]) rows.push({name, side, mean: shown(r[`${side}_mean`], r.unit), sd: shown(r[`${side}_sd`], r.unit), count: r[`${side}_count`], unit: r.unit});
    const paper = r.part === 'axon' ? null : facts.paper.find(p => p.entry === r.entry), keys = published[measure];
    if (paper && keys)
      for (const side of ['real', 'grown']) rows.push({name, side: `paper_${side}`, mean: paper[side][keys[0]], sd: paper[side][keys[1]], count: paper[side].cells, unit: r.unit});
  }
  return rows;
}

function comparison() {
  const t = table('comparison');
  if (!t || !t.records.length) return missing('Against donors and the paper', 'No /statistics/comparison: it holds every type against the real cells it was grown from, and against the paper’s Table 1.', 'conceg analyse relaxed.cgx --compare=true -o compared.cgx');
  const measures = [...new Set(t.records.map(r => r.measure))];
  return figure({
    id: 'comparison', title: 'Against donors and the paper', from: t.where('type', 'measure', 'grown_mean', 'drawn_mean', 'donors_mean'), table: t, series: sides,
    text: 'Mean and standard deviation of the cells’ means. Drawn: the bars these very cells were asked for. The paper’s rows are its Table 1, printed values.',
    controls: [{key: 'measure', label: 'Measure', choices: measures, names: Object.fromEntries(measures.map(m => [m, words(m)]))}],
    draw: (width, {hidden, measure}) => {
      const rows = comparisonRows(t, measure).filter(r => !hidden.has(r.side)), unit = shownUnit(rows[0]?.unit);
      const side = Object.fromEntries(sides.map(s => [s.key, s]));
      const names = [...new Set(rows.map(r => r.name))], offset = r => (sides.findIndex(s => s.key === r.side) - 2) * 11;
      const marks = sides.flatMap(s => {
        const own = rows.filter(r => r.side === s.key), dy = offset({side: s.key});
        return [
          Plot.ruleY(own, {y: 'name', x1: r => r.mean - r.sd, x2: r => r.mean + r.sd, stroke: s.colour, strokeWidth: 2, strokeDasharray: s.dashed ? '3 2' : null, dy}),
          Plot.dot(own, {y: 'name', x: 'mean', r: 4.5, fill: s.dashed ? 'var(--paper)' : s.colour, stroke: s.colour, strokeWidth: 1.5, dy, ariaLabel: r => `${r.name} ${r.side} ${r.mean}`, title: r => `${r.name}, ${side[r.side].label}\n${amount(r.mean, unit)} ± ${show(r.sd, 3)}  (${r.count} cells)`, tip: true}),
        ];
      });
      return plot(width, {height: 70 + 72 * names.length, marginLeft: Math.min(150, width * 0.26), x: {label: `${words(measure)} ${unit ? `(${unit})` : ''}`, grid: true, nice: true}, y: {label: null, domain: names}, marks});
    },
  });
}

function effects() {
  const t = table('comparison');
  if (!t || !t.records.length) return null;
  const rows = t.records.map(r => ({name: `${r.type}${r.part === 'axon' ? ', axons' : ''}`, measure: words(r.measure), value: r.from_drawn_count ? r.from_drawn_in_sd : r.from_donors_in_sd, within: r.within, against: r.from_drawn_count ? 'drawn' : 'donors'}));
  const colours = {yes: '#2a9d78', unsure: '#e3b23c', no: '#d1495b', '-': '#9aa3ad'};
  return figure({
    id: 'effects', half: true, title: 'Size of the differences', text: 'In standard deviations of the entry’s donors. The tolerance for order and branch length is 0.2; straightness is judged by its difference.', from: t.where('from_drawn_in_sd', 'from_donors_in_sd', 'within'),
    series: Object.entries(colours).filter(([k]) => rows.some(r => r.within === k)).map(([key, colour]) => ({key, colour, label: {yes: 'within', no: 'outside', unsure: 'unsure', '-': 'no tolerance'}[key]})),
    draw: (width, {hidden}) => plot(width, {
      height: 70 + 22 * new Set(rows.map(r => r.measure)).size * 1.2 + 20, marginLeft: 100, x: {label: 'difference / sd of donors', grid: true, nice: true}, y: {label: null, domain: [...new Set(rows.map(r => r.measure))]},
      marks: [Plot.rectX([{}], {x1: -0.2, x2: 0.2, fill: '#2a9d78', fillOpacity: 0.12}), Plot.ruleX([0]),
        Plot.dot(rows.filter(r => !hidden.has(r.within)), {x: 'value', y: 'measure', r: 5, fill: r => colours[r.within] ?? '#9aa3ad', fillOpacity: 0.85, ariaLabel: r => `${r.name} ${r.measure} ${r.value}`, title: r => `${r.name}: ${r.measure}\n${show(r.value, 3)} sd from ${r.against} (${r.within})`, tip: true})],
    }),
  });
}

function scatter() {
  const t = table('cell');
  if (!t || !t.records.length) return null;
  const numbers = t.columns.filter(c => c.type !== 'text' && c.name !== 'id').map(c => c.name), types = [...new Set(t.records.map(r => r.type))];
  const pick = (wanted, i) => (numbers.includes(wanted) ? wanted : numbers[Math.min(i, numbers.length - 1)]);
  const names = Object.fromEntries(numbers.map(n => [n, words(n)]));
  return figure({
    id: 'cells', half: true, title: 'Cell by cell', text: `Each dot is a cell${t.rows > t.shown ? ` (the first ${show(t.shown)} of ${show(t.rows)})` : ''}.`, from: t.where(...numbers), table: t,
    series: types.map(key => ({key, colour: colourOfType(key)})),
    controls: [{key: 'x', label: 'x', choices: numbers, value: pick('cable', 0), names}, {key: 'y', label: 'y', choices: numbers, value: pick('volume', 1), names}],
    draw: (width, {hidden, x, y}) => plot(width, {
      x: {label: `${words(x)} (${unitText(t.unit(x)) || '1'})`, grid: true, nice: true, ticks: Math.floor(width / 90)}, y: {label: `${words(y)} (${unitText(t.unit(y)) || '1'})`, grid: true, nice: true, zero: true},
      marks: [Plot.dot(t.records.filter(r => !hidden.has(r.type)), {x, y, r: 5, fill: r => colourOfType(r.type), fillOpacity: 0.8, ariaLabel: r => `cell ${r.id} ${r[x]} ${r[y]}`, title: r => `cell ${r.id}, ${r.type}\n${words(x)} ${amount(r[x], t.unit(x))}\n${words(y)} ${amount(r[y], t.unit(y))}`, tip: true})],
    }),
  });
}

export const shapeFigures = () => [morphometry(), effects(), comparison(), scatter()];
