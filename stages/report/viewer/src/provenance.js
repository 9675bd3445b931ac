// SPDX-License-Identifier: BSD-3-Clause
// How to make the document again: the recipe it carries, and the commands of its stages.
import {facts, values} from './data.js';
import {copyButton, h, offer} from './dom.js';
import {missing} from './figure.js';
import {sortable} from './table.js';

const quoted = text => (/^[\w./=,:+-]+$/.test(text) ? text : `'${text.replaceAll("'", "'\\''")}'`);

/** The stages that were run, as rows of /provenance. */
export function runs() {
  const stage = values('/provenance/stage') ?? [];
  const at = (name, i) => values(`/provenance/${name}`)?.[i] ?? '';
  return stage.map((word, i) => ({stage: word, implementation: at('implementation', i), version: at('implementation_version', i), library: at('library_version', i), seed: at('seed', i), parameters: String(at('parameters', i)), input: at('input', i)}));
}

// A run's parameters, "{a: 1, b: \"x\"}" in YAML, as name -> value.
const settings = text => new Map([...text.matchAll(/(\w+): ("(?:[^"\\]|\\.)*"|[^,}]*)/g)].map(m => [m[1], m[2]]));

/** Commands that make the document again from recipe.yaml; `null` when nothing is known of its making. */
export function commands() {
  const list = runs();
  if (!list.length) return null;
  // A stage that ran twice had other parameters each time, of which the recipe holds the last; a run may have had its own seed.
  const varied = r => {
    const runsOf = list.filter(x => x.stage === r.stage).map(x => settings(x.parameters));
    return [...settings(r.parameters)].filter(([name, value]) => runsOf.some(other => other.get(name) !== value));
  };
  const options = r => varied(r).map(([name, value]) => ` --set ${quoted(`${r.stage}.${name}=${value}`)}`).join('') + (String(r.seed) !== String(list[0].seed) ? ` --seed ${r.seed}` : '');
  const head = (r, i) => (i > 0 ? `conceg ${r.stage}` : r.stage === 'place' ? 'conceg place -p recipe.yaml' : `conceg ${r.stage} FILES...`);
  // A sink passes the document on only with -o.
  const passed = r => (['export', 'render', 'report'].includes(r.stage) ? ' -o -' : '');
  const lines = [];
  let pipe = [], from = '';
  const flush = file => {
    if (pipe.length) lines.push(`${pipe.join(' |\n  ')} > ${file}`);
    pipe = [], from = ` ${file}`;
  };
  list.forEach((r, i) => {
    const last = i === list.length - 1, own = i > 0 ? options(r) : '';
    // conceg check prints its verdicts where others put the document.
    if (r.stage === 'check') {
      if (pipe.length) flush(`before-${i}.cgx`);
      const file = last ? 'again.cgx' : `after-${i}.cgx`;
      lines.push(`conceg check${from}${own} -q -o ${file} > /dev/null`);
      from = ` ${file}`;
    } else {
      pipe.push(head(r, i) + (pipe.length || i === 0 ? '' : from) + own + passed(r));
      if (last) flush('again.cgx');
    }
  });
  const note = list[0].stage === 'place' ? '' : `# ${list[0].stage} read files that are not in the document: name them.\n`;
  return `#!/bin/bash\n${note}set -o pipefail\n${lines.join('\n')}\nconceg diff again.cgx ORIGINAL.cgx   # ORIGINAL.cgx: the document of this page\n`;
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
