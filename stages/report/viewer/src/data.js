// SPDX-License-Identifier: BSD-3-Clause
// What the page holds: facts as JSON, bulk as base64 blocks of little-endian numbers.

export const facts = JSON.parse(document.getElementById('facts').textContent);

const byName = new Map(facts.tables.map(table => [table.name, table]));

/** The table /statistics/<name> as {name, path, rows, shown, columns, records, unit(column), has(column)}, or null. */
export function table(name) {
  const found = byName.get(name);
  if (!found) return null;
  if (!found.records) {
    const column = new Map(found.columns.map(c => [c.name, c]));
    found.records = Array.from({length: found.shown}, (_, i) =>
      Object.fromEntries(found.columns.map(c => [c.name, i < c.values.length ? c.values[i] : null])));
    found.unit = c => column.get(c)?.unit ?? '';
    found.has = (...names) => names.every(n => column.has(n));
    found.where = (...names) => names.map(n => `${found.path}/${n}`);
  }
  return found;
}

/** The tables that stand, in the document's order. */
export const tables = () => facts.tables.map(t => table(t.name));

/** The array at a path as {shape, unit, values}, or null when it is not there or too large for the page. */
export function array(path) {
  const found = facts.arrays[path];
  return found && found.values ? found : null;
}
export const values = path => array(path)?.values ?? null;
export const scalar = path => array(path)?.values[0] ?? null;

/** Row `row` of a matrix. */
export function rowOf(matrix, row) {
  const width = matrix.values.length / matrix.shape[0];
  return matrix.values.slice(row * width, (row + 1) * width);
}

/** True when the document has an array at or below this group. */
export const hasGroup = group => facts.contents.some(c => c.path === group || c.path.startsWith(`${group}/`));

/** Block `id` as a typed array. */
export function block(id, Type) {
  const text = document.getElementById(id)?.textContent ?? '';
  const bytes = Uint8Array.fromBase64 ? Uint8Array.fromBase64(text) : slowBytes(text);
  return new Type(bytes.buffer, 0, bytes.byteLength / Type.BYTES_PER_ELEMENT);
}

function slowBytes(text) {
  const raw = atob(text);
  const bytes = new Uint8Array(raw.length);
  for (let i = 0; i < raw.length; i++) bytes[i] = raw.charCodeAt(i);
  return bytes;
}
