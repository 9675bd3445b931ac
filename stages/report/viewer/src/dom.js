// SPDX-License-Identifier: BSD-3-Clause
// Elements, numbers and units as text. All text goes in as text nodes, never as HTML.

/** An element: h('p', {class: 'note', onclick: f}, 'text', child). Children that are null or false are left out. */
export function h(tag, attributes = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (value === null || value === undefined || value === false) continue;
    if (name.startsWith('on')) element.addEventListener(name.slice(2), value);
    else if (name === 'style') for (const [key, v] of Object.entries(value)) element.style.setProperty(key, v);
    else element.setAttribute(name, value === true ? '' : value);
  }
  element.append(...children.flat(Infinity).filter(child => child !== null && child !== undefined && child !== false));
  return element;
}

const raised = {'-': '⁻', 0: '⁰', 1: '¹', 2: '²', 3: '³', 4: '⁴', 5: '⁵', 6: '⁶', 7: '⁷', 8: '⁸', 9: '⁹'};

/** 'ms/um^2' -> 'ms/µm²'; '1' and '' -> ''. */
export function unitText(unit) {
  if (!unit || unit === '1') return '';
  return unit.replace(/\^(-?\d+)/g, (_, digits) => [...digits].map(d => raised[d]).join('')).replace(/\bum/g, 'µm').replace(/\*/g, ' ');
}

/** 'radius' and 'um' -> 'radius (µm)'. */
export const labelled = (name, unit) => (unitText(unit) ? `${name} (${unitText(unit)})` : name);

/** A number with `digits` significant digits; '–' for none; text as it is. */
export function show(value, digits = 4) {
  if (value === null || value === undefined || (typeof value === 'number' && !Number.isFinite(value))) return '–';
  if (typeof value !== 'number') return String(value);
  if (Number.isInteger(value) && Math.abs(value) < 1e15) return grouped(String(value));
  const size = Math.abs(value);
  if (size !== 0 && (size < 1e-3 || size >= 1e7)) return value.toExponential(digits - 1).replace(/\.?0+e/, 'e').replace('e+', 'e').replace('-', '−').replace('e-', 'e−');
  const decimals = Math.max(0, digits - 1 - Math.floor(Math.log10(size || 1)));
  return grouped(String(Number(value.toFixed(Math.min(decimals, 12)))));
}

// 12345.6 -> 12 345.6 with thin spaces, from five digits on; a minus sign that looks like one.
function grouped(text) {
  const [whole, part] = text.replace('-', '−').split('.');
  const digits = whole.replace('−', '');
  const body = digits.length > 4 ? digits.replace(/\B(?=(\d{3})+$)/g, '\u2009') : digits;
  return (whole.startsWith('−') ? '−' : '') + body + (part ? `.${part}` : '');
}

/** value and unit as text. */
export const amount = (value, unit, digits) => [show(value, digits), unitText(unit)].filter(Boolean).join('\u202f');

/** 'branch_length' -> 'branch length'. */
export const words = name => String(name).replace(/_/g, ' ');

/** Offers text as a file of the page's own making. */
export function offer(name, type, text) {
  const url = URL.createObjectURL(new Blob([text], {type}));
  h('a', {href: url, download: name}).click();
  setTimeout(() => URL.revokeObjectURL(url), 10000);
}

/** A button that copies what `text()` gives and says so. */
export function copyButton(text, label = 'Copy') {
  const button = h('button', {type: 'button', class: 'small'}, label);
  button.addEventListener('click', async () => {
    try {
      await navigator.clipboard.writeText(text());
      button.textContent = 'Copied';
    } catch {
      const area = h('textarea', {class: 'offscreen'});
      area.value = text();
      document.body.append(area), area.select();
      button.textContent = document.execCommand('copy') ? 'Copied' : 'Select and copy by hand';
      area.remove();
    }
    setTimeout(() => { button.textContent = label; }, 1500);
  });
  return button;
}
