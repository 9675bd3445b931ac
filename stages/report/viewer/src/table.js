// SPDX-License-Identifier: BSD-3-Clause
// Any table of the document: sortable, with units, and as a CSV file.
import {h, labelled, offer, show, unitText, words} from './dom.js';

const most = 500; // rows drawn at once

const isText = column => column.type === 'text';

function csvField(value) {
  const text = value === null || value === undefined ? '' : String(value);
  return /[",\n\r]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
}

/** RFC 4180, all digits. */
export function csv(table) {
  const head = table.columns.map(c => csvField(labelled(c.name, c.unit)));
  const rows = table.records.map(r => table.columns.map(c => csvField(r[c.name])));
  return [head, ...rows].map(row => row.join(',')).join('\r\n') + '\r\n';
}

function compare(a, b, text) {
  const none = v => v === null || v === undefined;
  if (none(a) || none(b)) return none(a) - none(b);
  return text ? String(a).localeCompare(String(b), 'en', {numeric: true}) : a - b;
}

function cell(column, value) {
  if (isText(column)) return h('td', {}, /(^|_)unit$/.test(column.name) ? unitText(value) || '–' : value ?? '–');
  return h('td', {class: 'number', title: value === null ? null : String(value)}, show(value, 5));
}

/** A sortable <table> of {columns, records}. */
export function sortable(table) {
  // Names first, then numbers, each in the document's order.
  const columns = [...table.columns.filter(isText), ...table.columns.filter(c => !isText(c))];
  let by = null, falling = false, all = false;
  const body = h('tbody'), more = h('p', {class: 'note'});
  const heads = columns.map(column => {
    const button = h('button', {type: 'button', class: 'sort'}, words(column.name), unitText(column.unit) && h('span', {class: 'unit'}, unitText(column.unit)));
    button.addEventListener('click', () => {
      falling = by === column ? !falling : false;
      by = column;
      fill();
    });
    return h('th', {scope: 'col', class: isText(column) ? null : 'number'}, button);
  });
  function fill() {
    const rows = [...table.records];
    if (by) rows.sort((a, b) => (falling ? -1 : 1) * compare(a[by.name], b[by.name], isText(by)));
    body.replaceChildren(...rows.slice(0, all ? rows.length : most).map(r => h('tr', {}, columns.map(c => cell(c, r[c.name])))));
    heads.forEach((head, i) => head.setAttribute('aria-sort', columns[i] !== by ? 'none' : falling ? 'descending' : 'ascending'));
    more.replaceChildren();
    if (!all && rows.length > most)
      more.append(`The first ${most} of ${show(rows.length)} rows. `, h('button', {type: 'button', class: 'small', onclick: () => { all = true; fill(); }}, 'Show all'));
  }
  fill();
  return h('div', {class: 'table'}, h('div', {class: 'scroll', tabindex: '0'}, h('table', {}, h('thead', {}, h('tr', {}, heads)), body)), more);
}

/** What a table does not show, in words; null when it shows all. */
export function leftOut(table) {
  const lines = [];
  if (table.rows > table.shown) lines.push(`The page holds the first ${show(table.shown)} of ${show(table.rows)} rows; conceg report --rows ${table.rows} keeps all.`);
  for (const line of table.left_out ?? []) lines.push(`Left out: ${line}.`);
  return lines.length ? h('p', {class: 'note'}, lines.join(' ')) : null;
}

/** Names of the tables that stand on the page. */
export const shown = new Set();

/** The table with its path and a button for a CSV file. */
export function tableWithTools(table) {
  shown.add(table.name);
  return h('div', {}, leftOut(table), table.records.length ? sortable(table) : h('p', {class: 'note'}, 'The table has no rows.'),
    h('p', {class: 'tools'}, h('code', {}, table.path), h('button', {type: 'button', class: 'small', onclick: () => offer(`${table.name.replaceAll('/', '-') || 'table'}.csv`, 'text/csv', csv(table))}, 'Save CSV')));
}
