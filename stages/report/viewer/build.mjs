// SPDX-License-Identifier: BSD-3-Clause
// Makes dist/viewer.html of src/, or that file in the folder named: one file, with the notices of what is in it. Same input, same bytes.
import {createHash} from 'node:crypto';
import {mkdirSync, readdirSync, readFileSync, writeFileSync} from 'node:fs';
import {dirname, join} from 'node:path';
import {fileURLToPath} from 'node:url';
import {build} from 'esbuild';

const here = dirname(fileURLToPath(import.meta.url)), out = process.argv[2] ?? join(here, 'dist');
const read = name => readFileSync(join(here, name), 'utf8');

const made = await build({
  entryPoints: [join(here, 'src/main.js')], absWorkingDir: here, bundle: true, minify: true, format: 'iife', target: 'es2022', charset: 'ascii', legalComments: 'none', write: false, metafile: true,
});
const style = await build({entryPoints: [join(here, 'src/style.css')], absWorkingDir: here, bundle: true, minify: true, charset: 'utf8', write: false});
const script = made.outputFiles[0].text.trim();
if (/<\/script|<!--/i.test(script)) throw new Error('the script would end its own element');

// Packages whose code is in the bundle, with their licences.
const packages = [...new Set(Object.entries(Object.values(made.metafile.outputs)[0].inputs).filter(([, part]) => part.bytesInOutput > 0).map(([path]) => path.match(/node_modules\/((?:@[^/]+\/)?[^/]+)/)?.[1]).filter(Boolean))].sort();
const about = packages.map(name => {
  const {version, license} = JSON.parse(read(`node_modules/${name}/package.json`));
  const file = readdirSync(join(here, 'node_modules', name)).find(f => /^licen[cs]e/i.test(f));
  if (!file) throw new Error(`${name}: no licence file`);
  return {name, version, license, text: read(`node_modules/${name}/${file}`).trim().replaceAll('\r\n', '\n')};
});
const notice = ['The viewer of conceg report (BSD-3-Clause), with code of', ...about.map(p => `  ${p.name} ${p.version} (${p.license})`), 'whose notices are in THIRD-PARTY.txt of stages/report/viewer/dist and below.', '', ...about.map(p => `${p.name}:\n${p.text}\n`)].join('\n').replaceAll('--', '- -');

const hash = createHash('sha256').update(script).digest('base64');
const page = read('src/page.html').replace('{{HASH}}', hash).replace('{{NOTICE}}', () => notice).replace('{{STYLE}}', () => style.outputFiles[0].text.trim()).replace('{{SCRIPT}}', () => script);
if (page.split('<!--CONCEG-DATA-->').length !== 2) throw new Error('expected one slot for the data');
mkdirSync(out, {recursive: true});
writeFileSync(join(out, 'viewer.html'), page);
writeFileSync(join(out, 'THIRD-PARTY.txt'), about.map(p => `${p.name} ${p.version} (${p.license})\n\n${p.text}\n`).join(`\n${'='.repeat(78)}\n\n`));
console.log(`viewer.html: ${page.length} bytes, ${about.length} packages`);
