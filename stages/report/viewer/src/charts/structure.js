// SPDX-License-Identifier: BSD-3-Clause
// Tables structure*: grown cells against real ones that were held back, by trait; with what two halves of the real ones differ by.
import * as Plot from '@observablehq/plot';
import {seriesColour} from '../colours.js';
import {table} from '../data.js';
import {amount, labelled, show, words} from '../dom.js';
import {figure, plot} from '../figure.js';
import {explorer} from './generic.js';

// -1 stands for a value that is not known.
const known = value => value !== null && value >= 0;
const verdictColours = {within: '#2a9d78', yes: '#2a9d78', outside: '#d1495b', no: '#d1495b', unsure: '#e3b23c', '-': '#8a8f98'};
const verdictColour = verdict => verdictColours[verdict] ?? '#2f7fc1';

// What the axis spans: the values with some room; an interval that is far wider (few cells) leaves the chart.
function domainOf(rows) {
  const values = rows.flatMap(r => [r.value, ...[r.floor, r.halves].filter(known)]), low = Math.min(0, ...values), high = Math.max(0, ...values), room = Math.max(high - low, 0.2);
  return [Math.max(low - room, Math.min(low, ...rows.map(r => r.low))), Math.min(high + room, Math.max(high, ...rows.map(r => r.high)))];
}

function judgements(t) {
  const statistics = [...new Set(t.records.map(r => r.statistic))], entries = [...new Set(t.records.map(r => r.entry))], verdicts = [...new Set(t.records.map(r => r.verdict))];
  const colour = r => verdictColour(r.verdict);
  return figure({
    id: 'structure-judged', title: 'Grown against real cells, by trait', text: 'Dot: the statistic with its interval; hollow mark: what two halves of the real cells differ by, tick: the floor of that noise. A line that leaves the chart is an interval far wider than the differences: too few cells.', from: t.where('trait', 'statistic', 'value', 'low', 'high', 'halves', 'floor', 'verdict'), table: t,
    series: verdicts.map(key => ({key, colour: verdictColour(key), label: key === '-' ? 'not judged' : key})),
    controls: [{key: 'statistic', label: 'Statistic', choices: statistics, names: Object.fromEntries(statistics.map(s => [s, words(s)]))}, {key: 'entry', label: 'Entry', choices: entries}],
    draw: (width, {hidden, statistic, entry}) => {
      const rows = t.records.filter(r => r.statistic === statistic && r.entry === entry && !hidden.has(r.verdict)).map(r => ({...r, name: `${words(r.trait)}, ${r.level}`}));
      return plot(width, {
        height: 70 + 34 * new Set(rows.map(r => r.name)).size, marginLeft: Math.min(220, width * 0.34), x: {label: words(statistic), grid: true, ...(rows.length ? {domain: domainOf(rows)} : {})}, y: {label: null, domain: [...new Set(rows.map(r => r.name))]},
        marks: [
          Plot.ruleX([0], {strokeOpacity: 0.3}), Plot.ruleY(rows, {y: 'name', x1: 'low', x2: 'high', stroke: colour, strokeWidth: 3, strokeOpacity: 0.5, clip: true}),
          Plot.tickX(rows.filter(r => known(r.floor)), {y: 'name', x: 'floor', stroke: 'currentColor', strokeDasharray: '3 2', title: r => `noise floor ${show(r.floor, 3)}`, tip: true}),
          Plot.dot(rows.filter(r => known(r.halves)), {y: 'name', x: 'halves', r: 5, stroke: 'currentColor', strokeOpacity: 0.6}),
          Plot.dot(rows, {y: 'name', x: 'value', r: 5.5, fill: colour, ariaLabel: r => `${r.entry} ${r.trait} ${r.level} ${r.value}`, title: r => `${r.entry}: ${r.name}\n${words(statistic)} ${show(r.value, 3)} (${show(r.low, 3)} to ${show(r.high, 3)})\n${r.verdict}; ${show(r.grown)} grown, ${show(r.donors)} donors`, tip: true}),
        ],
      });
    },
  });
}

function quantiles(t) {
  const traits = [...new Set(t.records.map(r => `${r.trait}, ${r.level}`))], entries = [...new Set(t.records.map(r => r.entry))];
  return figure({
    id: 'structure-quantiles', half: true, title: 'Quantile against quantile', text: 'On the line both distributions are the same.', from: t.where('grown', 'real', 'share'), table: t, series: entries.map((key, i) => ({key, colour: seriesColour(i)})),
    controls: [{key: 'trait', label: 'Trait', choices: traits, value: traits.find(x => x.endsWith('branch')) ?? traits[0], names: Object.fromEntries(traits.map(x => [x, words(x)]))}],
    draw: (width, {hidden, trait}) => {
      const rows = t.records.filter(r => `${r.trait}, ${r.level}` === trait && !hidden.has(r.entry)), all = rows.flatMap(r => [r.grown, r.real]), ends = [Math.min(...all), Math.max(...all)];
      return plot(width, {
        x: {label: labelled('real', rows[0]?.unit), grid: true, nice: true}, y: {label: labelled('grown', rows[0]?.unit), grid: true, nice: true},
        marks: [Plot.line(ends.map(v => [v, v]), {stroke: 'currentColor', strokeOpacity: 0.5, strokeDasharray: '4 4'}),
          Plot.line(rows, {x: 'real', y: 'grown', z: 'entry', stroke: r => seriesColour(entries.indexOf(r.entry)), strokeOpacity: 0.4}),
          Plot.dot(rows, {x: 'real', y: 'grown', r: 3, fill: r => seriesColour(entries.indexOf(r.entry)), ariaLabel: r => `${r.entry} ${r.share} ${r.real} ${r.grown}`, title: r => `${r.entry}, ${show(100 * r.share)} %\nreal ${show(r.real, 4)}, grown ${show(r.grown, 4)}`, tip: true})],
      });
    },
  });
}

const sides = [
  {key: 'grown', label: 'grown here', colour: '#2f7fc1'}, {key: 'real', label: 'real cells held back', colour: '#2a9d78'},
  {key: 'paper_grown', label: 'paper, its ConCeG', colour: '#c98a2b', dashed: true}, {key: 'paper_real', label: 'paper, real cells', colour: '#8a8f98', dashed: true},
];

// The paper's Table 1 with ours beside it: a row per entry, a mark per side.
function means(t) {
  const traits = [...new Set(t.records.map(r => `${r.trait}, ${r.level}`))], there = sides.filter(s => t.has(`${s.key}_mean`, `${s.key}_sd`));
  return figure({
    id: 'structure-means', title: 'Means by entry, as in the paper’s Table 1', text: 'Mean and standard deviation over cells, or over branches. The paper’s rows are its printed values.', from: t.where('entry', 'trait', 'grown_mean', 'real_mean', 'paper_grown_mean', 'paper_real_mean'), table: t, series: there,
    controls: [{key: 'trait', label: 'Trait', choices: traits, names: Object.fromEntries(traits.map(x => [x, words(x)]))}],
    draw: (width, {hidden, trait}) => {
      const own = t.records.filter(r => `${r.trait}, ${r.level}` === trait), scale = own[0]?.unit === 'rad' ? 180 / Math.PI : 1, unit = scale === 1 ? own[0]?.unit : '°';
      const marks = there.filter(s => !hidden.has(s.key)).flatMap(s => {
        const dy = (sides.indexOf(s) - 1.5) * 9;
        const rows = own.filter(r => r[`${s.key}_sd`] >= 0 && known(r[`${s.key}_mean`]) && (r[`${s.key}_count`] ?? 1) > 0).map(r => ({entry: r.entry, mean: scale * r[`${s.key}_mean`], sd: scale * r[`${s.key}_sd`], count: r[`${s.key}_count`]}));
        return [
          Plot.ruleY(rows, {y: 'entry', x1: r => r.mean - r.sd, x2: r => r.mean + r.sd, stroke: s.colour, strokeWidth: 2, strokeDasharray: s.dashed ? '3 2' : null, dy}),
          Plot.dot(rows, {y: 'entry', x: 'mean', r: 4.5, fill: s.dashed ? 'var(--paper)' : s.colour, stroke: s.colour, strokeWidth: 1.5, dy, ariaLabel: r => `${r.entry} ${s.key} ${r.mean}`, title: r => `${r.entry}, ${s.label}\n${amount(r.mean, unit)} ± ${show(r.sd, 3)}${r.count ? `  (n ${show(r.count)})` : ''}`, tip: true}),
        ];
      });
      return plot(width, {height: 70 + 48 * new Set(own.map(r => r.entry)).size, marginLeft: Math.min(170, width * 0.28), x: {label: labelled(words(trait), unit), grid: true, nice: true}, y: {label: null, domain: [...new Set(own.map(r => r.entry))]}, marks});
    },
  });
}

const charts = {
  structure_means: t => (t.has('entry', 'trait', 'level', 'unit', 'grown_mean', 'grown_sd') ? means(t) : null),
  structure: t => (t.has('trait', 'statistic', 'value', 'low', 'high', 'halves', 'floor', 'verdict', 'entry', 'level') ? judgements(t) : null),
  structure_quantile: t => (t.has('entry', 'trait', 'level', 'share', 'grown', 'real') ? quantiles(t) : null),
};

/** A figure for each of the tables structure*: its own where the columns are known, else the generic one. */
export const structureTables = names => names.map(name => { const t = table(name); return (t.records.length && charts[name]?.(t)) || explorer(t, true); });
