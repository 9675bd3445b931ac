// SPDX-License-Identifier: BSD-3-Clause
// How to make the document again: the recipe it carries, and the commands of its stages.
import {values} from './data.js';
import {facts} from './data.js';
import {copyButton, h, offer} from './dom.js';
import {missing} from './figure.js';
import {sortable} from './table.js';

const sources = ['place', 'characterise', 'import'];
const quoted = text => (/^[\w./=,:+-]+$/.test(text) ? text : `'${text.replaceAll("'", "'\\''")}'`);

/** The stages that were run, as rows of /provenance. */
export function runs() {
  const stage = values('/provenance/stage') ?? [];
  const at = (name, i) => values(`/provenance/${name}`)?.[i] ?? '';
  return stage.map((word, i) => ({stage: word, implementation: at('implementation', i), version: at('implementation_version', i), library: at('library_version', i), seed: at('seed', i), parameters: String(at('parameters', i)), input: at('input', i)}));
}

// "name: value" lines of a run's parameters as [name, value].
const parameters = text => text.split('\n').map(line => line.match(/^([\w.]+): ?(.*)$/)).filter(Boolean).map(m => [m[1], m[2]]);

/** Commands that make the document again from recipe.yaml; `null` when nothing is known of its making. */
export function commands() {
  const list = runs();
  if (!list.length) return null;
  const last = list.length - 1;
  const options = r => parameters(r.parameters).filter(([name]) => name !== 'impl').map(([name, value]) => ` --set ${quoted(`${r.stage}.${name}=${value}`)}`).join('');
  // A stage that ran twice had other parameters each time, which the recipe cannot hold both.
  const twice = r => list.filter(x => x.stage === r.stage).length > 1;
  const lines = list.map((r, i) => {
    const head = i === 0 ? (r.stage === 'place' ? 'conceg place -p recipe.yaml' : `conceg ${r.stage} FILES...`) : `conceg ${r.stage}`;
    return head + (i > 0 && twice(r) ? options(r) : '') + (i > 0 && !sources.includes(list[0].stage) ? '' : '');
  });
  const note = list[0].stage === 'place' ? '' : `# ${list[0].stage} read files that are not in the document: name them.\n`;
  return `${note}set -o pipefail\n${lines.join(' |\n  ')} > again.cgx${last >= 0 ? '\nconceg diff again.cgx ORIGINAL.cgx --exact' : ''}\n`;
}

function code(title, text, file) {
  return h('div', {class: 'code'}, h('div', {class: 'codehead'}, h('h3', {}, title), h('span', {class: 'grow'}), copyButton(() => text),
    file && h('button', {type: 'button', class: 'small', onclick: () => offer(file, 'text/plain', text)}, `Save ${file}`)), h('pre', {tabindex: '0'}, h('code', {}, text)));
}

export function provenanceView() {
  const list = runs(), shell = commands();
  const column = (name, type = 'text') => ({name, type, unit: ''});
  const tableOf = {columns: [column('stage'), column('implementation'), column('version'), column('library'), column('seed', 'u64'), column('parameters'), column('input')], records: list};
  return h('div', {},
    shell ? code('Commands', shell, 'again.sh') : missing('Commands', 'No /provenance: the document does not say which stages made it.'),
    facts.recipe ? code('Recipe', facts.recipe, 'recipe.yaml') : missing('Recipe', 'No /recipe: the document was not made from a recipe.'),
    list.length ? h('details', {class: 'numbers'}, h('summary', {}, `${list.length} runs, with parameters and the digest of what they read`), sortable(tableOf)) : null);
}
