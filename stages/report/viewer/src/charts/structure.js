// SPDX-License-Identifier: BSD-3-Clause
// Tables structure*: grown cells against real ones that were held back, by trait; with what two halves of the real ones differ by.
import * as Plot from '@observablehq/plot';
import {seriesColour} from '../colours.js';
import {table} from '../data.js';
import {labelled, show, words} from '../dom.js';
import {figure, plot} from '../figure.js';
import {explorer} from './generic.js';

// -1 stands for a value that is not known.
const known = value => value !== null && value >= 0;
const verdictColours = ['#2a9d78', '#d1495b', '#e3b23c', '#8a8f98', '#2f7fc1', '#a56cc1'];

function judgements(t) {
  const statistics = [...new Set(t.records.map(r => r.statistic))], entries = [...new Set(t.records.map(r => r.entry))], verdicts = [...new Set(t.records.map(r => r.verdict))];
  const colour = r => verdictColours[verdicts.indexOf(r.verdict) % verdictColours.length];
  return figure({
    id: 'structure-judged', title: 'Grown against real cells, by trait', text: 'Dot: the statistic with its interval; hollow mark: what two halves of the real cells differ by, tick: the floor of that noise.', from: t.where('trait', 'statistic', 'value', 'low', 'high', 'halves', 'floor', 'verdict'), table: t,
    series: verdicts.map((key, i) => ({key, colour: verdictColours[i % verdictColours.length]})),
    controls: [{key: 'statistic', label: 'Statistic', choices: statistics, names: Object.fromEntries(statistics.map(s => [s, words(s)]))}, {key: 'entry', label: 'Entry', choices: entries}],
    draw: (width, {hidden, statistic, entry}) => {
      const rows = t.records.filter(r => r.statistic === statistic && r.entry === entry && !hidden.has(r.verdict)).map(r => ({...r, name: `${words(r.trait)}, ${r.level}`}));
      return plot(width, {
        height: 70 + 34 * new Set(rows.map(r => r.name)).size, marginLeft: Math.min(220, width * 0.34), x: {label: words(statistic), grid: true, nice: true}, y: {label: null, domain: [...new Set(rows.map(r => r.name))]},
        marks: [
          Plot.ruleY(rows, {y: 'name', x1: 'low', x2: 'high', stroke: colour, strokeWidth: 3, strokeOpacity: 0.5}),
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
    controls: [{key: 'trait', label: 'Trait', choices: traits, names: Object.fromEntries(traits.map(x => [x, words(x)]))}],
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

const charts = {
  structure: t => (t.has('trait', 'statistic', 'value', 'low', 'high', 'halves', 'floor', 'verdict', 'entry', 'level') ? judgements(t) : null),
  structure_quantile: t => (t.has('entry', 'trait', 'level', 'share', 'grown', 'real') ? quantiles(t) : null),
};

/** A figure for each of the tables structure*: its own where the columns are known, else the generic one. */
export const structureTables = names => names.map(name => { const t = table(name); return (t.records.length && charts[name]?.(t)) || explorer(t, true); });
