// SPDX-License-Identifier: BSD-3-Clause
// The page: head, contents, sections.
import {fitFigures} from './charts/fit.js';
import {explorer} from './charts/generic.js';
import {shapeFigures} from './charts/shape.js';
import {protocolText, signalFigures, timeFigures} from './charts/signals.js';
import {poreFigures, structureFigures} from './charts/space.js';
import {structureTables} from './charts/structure.js';
import {timeTables} from './charts/time.js';
import {summary, tissueFigures} from './charts/tissue.js';
import {facts, hasGroup, scalar, table, tables, values} from './data.js';
import {amount, h, show, unitText} from './dom.js';
import {figures, missing, redrawAll} from './figure.js';
import {gateCounts, gateView} from './gates.js';
import {provenanceView, runs} from './provenance.js';
import {scenePanel} from './scene/panel.js';
import {shown, sortable, tableWithTools} from './table.js';

// Cards in two columns; one that would stand alone in its row takes both.
function grid(list) {
  const cards = list.filter(Boolean);
  let left = null;
  for (const card of cards) {
    const half = card.classList.contains('half') || !card.matches('figure');
    if (half) left = left ? null : card;
    else if (left) left.classList.add('alone'), left = null;
  }
  left?.classList.add('alone');
  return h('div', {class: 'grid'}, cards);
}

// Tables that no section has shown are drawn generically, so that none is left out.
const structured = /^structure/, timed = /^(diffusivity|lambda)/;
const others = group => tables().filter(t => !shown.has(t.name) && group.test(t.name)).map(t => t.name);

function tiles() {
  const side = values('/domain@lo') && values('/domain@hi').map((v, a) => v - values('/domain@lo')[a]);
  const gates = gateCounts(), fraction = summary('icvf_mesh') ?? summary('icvf_field') ?? scalar('/meshes@icvf'), fits = table('sandi');
  const list = [
    [facts.scene.cells ? show(facts.scene.cells) : null, 'cells'],
    [side && `${side.map(v => show(v, 4)).join(' × ')} µm`, values('/domain@periodic')?.every(Boolean) ? 'periodic box' : 'box'],
    [fraction !== null && show(fraction, 3), 'intracellular volume fraction'],
    [summary('cable') !== null && amount(summary('cable') / 1000, 'mm', 3), 'of processes'],
    [facts.scene.faces ? show(facts.scene.faces) : null, 'triangles'],
    [scalar('/meshes@crossings') !== null && show(scalar('/meshes@crossings')), 'crossings of surfaces'],
    [summary('bars') && `${show(summary('bars_done'))} / ${show(summary('bars'))}`, 'bars done'],
    [scalar('/walkers@leaks') !== null && show(scalar('/walkers@leaks')), 'leaks of walkers'],
    [fits && fits.records.length ? show(fits.records.length) : null, 'SANDI fits'],
    [gates && `${gates.passed} / ${gates.passed + gates.failed}`, 'integrity gates passed'],
  ];
  return h('div', {class: 'tiles'}, list.filter(([value]) => value).map(([value, label]) => h('div', {class: `tile${value.length > 12 ? ' wide' : ''}`}, h('b', {}, value), h('span', {}, label))));
}

const makers = [['/domain', 'conceg place or import'], ['/cells', 'conceg place or import'], ['/bars', 'conceg place'], ['/skeleton', 'conceg grow'], ['/meshes', 'conceg mesh'], ['/volumes', 'conceg mesh --volume-step-um 0.25'],
  ['/walkers', 'conceg simulate'], ['/signals', 'conceg simulate, or conceg import signal'], ['/statistics', 'conceg analyse, fit and check'], ['/dictionary', 'conceg characterise'], ['/provenance', 'each stage'], ['/recipe', 'conceg place']];

function contents() {
  const unit = c => unitText(c.unit);
  const list = {columns: [{name: 'path', type: 'text', unit: ''}, {name: 'type', type: 'text', unit: ''}, {name: 'shape', type: 'text', unit: ''}, {name: 'unit', type: 'text', unit: ''}],
    records: facts.contents.map(c => ({path: c.path, type: c.type, shape: c.shape.length ? c.shape.join(' × ') : 'scalar', unit: unit(c)}))};
  return h('div', {}, h('ul', {class: 'groups'}, makers.map(([group, maker]) => h('li', {class: hasGroup(group) || group === '/domain' && values('/domain@lo') ? 'there' : 'absent'}, h('code', {}, group),
    hasGroup(group) || group === '/domain' && values('/domain@lo') ? null : h('span', {}, ` not there: ${maker} makes it`)))),
    h('details', {class: 'numbers'}, h('summary', {}, `All ${show(facts.contents.length + facts.contents_left_out)} arrays`), facts.contents_left_out ? h('p', {class: 'note'}, `${show(facts.contents_left_out)} of them are not listed.`) : null, sortable(list)));
}

function groundTruth(truth) {
  const t = table('summary');
  return [truth && h('div', {class: 'frame'}, h('h3', {}, truth.title), h('p', {}, truth.text), tableWithTools(truth.table)),
    t && h('div', {class: 'frame'}, h('h3', {}, 'Summary of the tissue'), tableWithTools(t))];
}

function moreTables() {
  const rest = tables().filter(t => !shown.has(t.name));
  return rest.length ? grid(rest.map(t => explorer(t, true))) : h('p', {class: 'lead'}, 'Every table of /statistics stands in a section above.');
}

// [id, title, lead, content]: content is made when the page is.
function sections() {
  const fit = fitFigures();
  return [
    ['tissue', 'The tissue', null, () => scenePanel()],
    ['composition-of-tissue', 'Composition', 'What is in the box, and how much of it.', () => grid(tissueFigures())],
    ['shape', 'Shapes of cells', null, () => grid(shapeFigures())],
    ['structure', 'Structure', null, () => grid([...structureFigures(), ...structureTables(others(structured))])],
    ['space', 'Space between cells', null, () => grid(poreFigures())],
    ['signals', 'Diffusion MRI signal', protocolText() || null, () => grid(signalFigures())],
    ['time', 'Diffusion over time', null, () => grid([...timeFigures(), ...timeTables(others(timed))])],
    ['sandi', 'SANDI and the ground truth', null, () => grid([...fit.figures, ...groundTruth(fit.truth)])],
    ['integrity', 'Integrity', null, () => gateView()],
    ['tables', 'More tables', null, moreTables],
    ['contents', 'What the document holds', null, contents],
    ['provenance', 'Make it again', 'The document carries its recipe. Save both files into one folder; the same version of ConCeG gives the same bytes.', provenanceView],
  ];
}

function title() {
  const line = facts.recipe.match(/^title: *(.+)$/m);
  return line ? line[1].replace(/^(['"])(.*)\1$/, '$2') : 'ConCeG report';
}

// What made the tissue, in one sentence.
function origin() {
  const first = runs()[0];
  if (!first) return `A document of ConCeG ${facts.version}.`;
  if (first.stage === 'import') return `Tissue or signals of another program, read by ConCeG ${first.library}.`;
  if (first.stage === 'characterise') return `A dictionary of real cells, made by ConCeG ${first.library}.`;
  return `A piece of synthetic grey matter, made by ConCeG ${first.library} with seed ${first.seed}.`;
}

function themeButton() {
  const root = document.documentElement, names = {auto: 'Theme: auto', light: 'Theme: light', dark: 'Theme: dark'}, order = ['auto', 'light', 'dark'];
  let now = 'auto';
  const button = h('button', {type: 'button', class: 'small'}, names.auto);
  button.addEventListener('click', () => {
    now = order[(order.indexOf(now) + 1) % 3];
    if (now === 'auto') delete root.dataset.theme;
    else root.dataset.theme = now;
    button.textContent = names[now];
    redrawAll();
  });
  return button;
}

function page() {
  document.title = title();
  const list = sections();
  const links = list.map(([id, name]) => h('a', {href: `#${id}`}, name));
  const main = h('main', {}, h('header', {class: 'head'}, h('h1', {}, title()),
    h('p', {class: 'lead'}, origin() + ' Every chart names the array it shows; nothing on this page is loaded from anywhere.'), tiles()));
  for (const [id, name, lead, content] of list) {
    const section = h('section', {id, class: 'part'}, h('h2', {}, h('a', {href: `#${id}`, class: 'anchor'}, name)), lead && h('p', {class: 'lead'}, lead));
    try {
      section.append(content());
    } catch (error) {
      figures.failed++;
      console.error(`section ${id}:`, error);
      section.append(missing('This section could not be drawn', String(error.message)));
    }
    main.append(section);
  }
  document.body.append(h('div', {class: 'page'}, h('nav', {class: 'toc', 'aria-label': 'contents'}, h('div', {class: 'brand'}, 'ConCeG', h('span', {}, 'report')), h('div', {class: 'links'}, links), themeButton()), main));
  spy(links);
}

// The entry of what is read is marked.
function spy(links) {
  const seen = new IntersectionObserver(entries => entries.forEach(entry => {
    if (entry.isIntersecting) links.forEach(link => link.classList.toggle('now', link.getAttribute('href') === `#${entry.target.id}`));
  }), {rootMargin: '-10% 0px -75% 0px'});
  document.querySelectorAll('section.part').forEach(section => seen.observe(section));
}

page();
matchMedia('(prefers-color-scheme: dark)').addEventListener('change', redrawAll);
// A printed page shows what is folded.
addEventListener('beforeprint', () => document.querySelectorAll('details').forEach(d => { d.dataset.was = d.open; d.open = d.querySelectorAll('tr').length < 60; }));
addEventListener('afterprint', () => document.querySelectorAll('details').forEach(d => { d.open = d.dataset.was === 'true'; }));
requestAnimationFrame(() => requestAnimationFrame(() => {
  document.documentElement.dataset.figures = figures.drawn, document.documentElement.dataset.failed = figures.failed;
  // The section that the address names, now that it is there.
  if (location.hash) document.getElementById(location.hash.slice(1))?.scrollIntoView({behavior: 'instant'});
}));
