// SPDX-License-Identifier: BSD-3-Clause
// Integrity gates of conceg check, by group.
import {table} from './data.js';
import {amount, h} from './dom.js';
import {missing} from './figure.js';
import {tableWithTools} from './table.js';

export function gateCounts() {
  const t = table('gates');
  if (!t) return null;
  const count = verdict => t.records.filter(r => r.verdict === verdict).length;
  return {passed: count('passed'), failed: count('failed'), empty: count('void')};
}

export function gateView() {
  const t = table('gates'), counts = gateCounts();
  if (!t) return missing('Integrity', 'No /statistics/gates: conceg check looks whether the document can be believed and keeps its verdicts with -o.', 'conceg check cube.cgx -o checked.cgx');
  const groups = [...new Set(t.records.map(r => r.group))];
  const mark = {passed: '✓', failed: '✕', void: '–'};
  return h('div', {}, h('p', {}, `${counts.passed} passed, ${counts.failed} failed, ${counts.empty} void (nothing to look at).`),
    h('div', {class: 'gates'}, groups.map(group => h('section', {}, h('h3', {}, group), h('ul', {}, t.records.filter(r => r.group === group).map(r =>
      h('li', {class: `gate ${r.verdict}`, title: `${r.rule}\n${r.looked_at}`}, h('span', {class: 'mark', 'aria-label': r.verdict}, mark[r.verdict] ?? '?'), h('span', {}, r.gate),
        h('span', {class: 'value'}, r.verdict === 'void' ? '' : amount(r.value, r.value_unit, 3)))))))),
    h('details', {class: 'numbers'}, h('summary', {}, 'All that was looked at'), tableWithTools(t)));
}
