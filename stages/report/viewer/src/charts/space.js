// SPDX-License-Identifier: BSD-3-Clause
// How space is filled: scaling of pieces, spectra along processes, and the space between the cells.
import * as Plot from '@observablehq/plot';
import {classColour} from '../colours.js';
import {table} from '../data.js';
import {amount, h, show, words} from '../dom.js';
import {figure, logAxis, missing, plot} from '../figure.js';

const analyse = option => `conceg analyse cube.cgx --${option}=true -o analysed.cgx`;

function composition() {
  const t = table('composition'), fits = table('composition_fit');
  if (!t || !t.records.length) return missing('Composition scaling', 'No /statistics/composition: the volume of the largest piece of one cell in cubes of growing side, and its exponent d_f. It needs /volumes/label (mesh.volume_step_um 0.25 to 0.5).', analyse('composition'));
  const kinds = [{key: 'fragment', label: 'largest fragment', colour: '#2f7fc1'}, {key: 'cell', label: 'largest cell', colour: '#e07b39'}];
  const fitOf = range => fits?.records.find(r => r.range === range);
  const said = range => { const f = fitOf(range); return f ? `${show(f.fragment_exponent, 3)} ± ${show(f.fragment_error, 2)} (fragments), ${show(f.cell_exponent, 3)} ± ${show(f.cell_error, 2)} (cells)` : null; };
  const texts = [said('all') && `d over all lengths ${said('all')}`, said('beyond_somas') && `from ${amount(fitOf('beyond_somas').from, 'um')} on ${said('beyond_somas')}`].filter(Boolean);
  const lines = (kind, range) => {
    const f = fitOf(range);
    if (!f) return [];
    const rows = t.records.filter(r => r.side >= f.from * 0.999 && r.side <= f.to * 1.001 && r[`${kind}_volume`] > 0);
    const mean = g => rows.reduce((sum, r) => sum + g(r), 0) / rows.length;
    const slope = f[`${kind}_exponent`], at = mean(r => Math.log(r[`${kind}_volume`])) - slope * mean(r => Math.log(r.side));
    return rows.map(r => ({side: r.side, volume: Math.exp(at + slope * Math.log(r.side))}));
  };
  return figure({
    id: 'composition', half: true, title: 'Composition scaling', text: ['Mean volume of the largest piece of one cell in cubes of side L grows as L', h('sup', {}, 'd'), '. ', texts.join('; '), '.'],
    from: [...t.where('side', 'fragment_volume', 'cell_volume'), ...(fits ? fits.where('fragment_exponent', 'cell_exponent') : [])], table: [t, fits], series: kinds,
    controls: [{key: 'range', label: 'Line', choices: ['beyond_somas', 'all'].filter(fitOf), names: {all: 'all lengths', beyond_somas: 'beyond somas'}}].filter(c => c.choices.length),
    draw: (width, {hidden, range}) => plot(width, {
      x: logAxis('side of the cube, L (µm)', t.records.map(r => r.side)), y: logAxis('volume (µm³)', t.records.flatMap(r => kinds.map(k => r[`${k.key}_volume`]))),
      marks: kinds.filter(k => !hidden.has(k.key)).flatMap(k => [
        Plot.line(range ? lines(k.key, range) : [], {x: 'side', y: 'volume', stroke: k.colour, strokeDasharray: '5 4'}),
        Plot.dot(t.records.filter(r => r[`${k.key}_volume`] > 0), {x: 'side', y: `${k.key}_volume`, r: 4.5, fill: k.colour, ariaLabel: r => `${k.key} ${r.side} ${r[`${k.key}_volume`]}`, title: r => `${k.label}, L ${amount(r.side, 'um', 3)}\n${amount(r[`${k.key}_volume`], 'um^3')} ± sd ${show(r[`${k.key}_sd`], 3)}\nlocal slope ${show(r[`${k.key}_slope`], 3)}`, tip: true}),
      ]),
    }),
  });
}

function spectrum() {
  const t = table('spectrum'), fits = table('spectrum_fit');
  if (!t || !t.records.length) return missing('Power spectrum of the cross-section', 'No /statistics/spectrum: fluctuations of the cross-section along paths from soma to tip. A class needs paths of 110 µm.', analyse('spectrum'));
  const classes = [...new Set(t.records.map(r => r.class))];
  const texts = (fits?.records ?? []).map(f => `${f.class}: exponent ${show(f.exponent, 3)}, plateau ${amount(f.plateau, 'um', 3)}, ${show(f.paths)} paths of ${show(f.cells)} cells`);
  return figure({
    id: 'spectrum', half: true, title: 'Power spectrum of the cross-section', text: `With bands of 95 % over cells. Shaded: where plateau and exponent are taken. ${texts.join('; ')}.`,
    from: [...t.where('q', 'power', 'power_low', 'power_high'), ...(fits ? fits.where('exponent', 'plateau') : [])], table: [t, fits], series: classes.map(key => ({key, colour: classColour(key)})),
    controls: [{key: 'which', label: 'Taper', choices: ['power', 'raw'], names: {power: 'taken away', raw: 'kept'}}],
    draw: (width, {hidden, which}) => {
      const rows = t.records.filter(r => !hidden.has(r.class) && r[which] > 0);
      return plot(width, {
        x: logAxis('wave number q (rad/µm)', rows.map(r => r.q)), y: logAxis('power (µm)', rows.flatMap(r => [r[which], r[`${which}_high`]])),
        marks: [
          Plot.rectX([{}], {x1: 0.06, x2: 0.6, fill: 'currentColor', fillOpacity: 0.06}),
          Plot.areaY(rows.filter(r => r[`${which}_low`] > 0), {x: 'q', y1: `${which}_low`, y2: `${which}_high`, z: 'class', fill: r => classColour(r.class), fillOpacity: 0.16}),
          Plot.line(rows, {x: 'q', y: which, z: 'class', stroke: r => classColour(r.class), ariaLabel: r => `spectrum ${r.class}`}),
          Plot.tip(rows, Plot.pointer({x: 'q', y: which, title: r => `${r.class}\nq ${amount(r.q, 'rad/um', 3)}\npower ${amount(r[which], 'um', 3)} (${show(r[`${which}_low`], 3)} to ${show(r[`${which}_high`], 3)})`})),
        ],
      });
    },
  });
}

function pores() {
  const t = table('pore_space');
  if (!t || !t.records.length) return missing('Sizes of the extracellular space', 'No /statistics/pore_space: five definitions, which differ by factors. It needs /volumes/distance with voxels of at most a quarter of the median cleft.', analyse('pores'));
  const measures = [...new Set(t.records.map(r => r.measure))];
  const kinds = [{key: '3', label: 'in space', colour: '#2f7fc1'}, {key: '2', label: 'in plane sections', colour: '#e07b39'}];
  return figure({
    id: 'pores', half: true, title: 'Sizes of the extracellular space, five definitions', text: 'Dot: mean; line: median to 95 %. Radii and widths differ by definition: compare like with like, and sections with sections.', from: t.where('dimensions', 'measure', 'mean', 'median', 'p95'), table: t, series: kinds,
    draw: (width, {hidden}) => plot(width, {
      height: 70 + 46 * measures.length, marginLeft: 116, x: {label: 'size (µm)', grid: true, zero: true, nice: true}, y: {label: null, domain: measures.map(words)},
      marks: kinds.filter(k => !hidden.has(k.key)).flatMap((k, i) => {
        const rows = t.records.filter(r => String(r.dimensions) === k.key), dy = (k.key === '3' ? -1 : 1) * 8;
        return [
          Plot.ruleY(rows, {y: r => words(r.measure), x1: 'median', x2: 'p95', stroke: k.colour, strokeWidth: 2, dy}),
          Plot.dot(rows, {y: r => words(r.measure), x: 'mean', r: 5, fill: k.colour, dy, ariaLabel: r => `${r.measure} ${r.dimensions} ${r.mean}`, title: r => `${words(r.measure)}, ${k.label}\nmean ${amount(r.mean, 'um')} ± sd ${show(r.sd, 3)}\nmedian ${show(r.median, 3)}, 95 % ${show(r.p95, 3)}\n${show(r.count)} values`, tip: true}),
        ];
      }),
    }),
  });
}

function paths() {
  const t = table('paths');
  if (!t || !t.records.length) return missing('Straightness of paths between cells', 'No /statistics/paths: Euclidean distance over the shortest way through the extracellular space. It needs /volumes/distance.', analyse('paths'));
  const names = {fast_marching: 'fast marching', steps: 'steps on the grid'};
  return figure({
    id: 'paths', half: true, title: 'Straightness of paths between cells', text: `Distance over shortest path, ≤ 1, ${show(t.records[0].pairs)} pairs of places, ${show(t.records[0].without_path)} of them without a path. Steps on a grid give 0.92 in empty space: they say more of the grid than of the tissue.`, from: t.where('way', 'straightness', 'sd', 'median'), table: t,
    draw: width => plot(width, {
      height: 80 + 40 * t.records.length, marginLeft: 116, x: {label: 'distance / path', grid: true, domain: [Math.min(0.6, ...t.records.map(r => r.straightness - r.sd - 0.05)), 1]}, y: {label: null, domain: t.records.map(r => names[r.way] ?? r.way)},
      marks: [
        Plot.ruleY(t.records, {y: r => names[r.way] ?? r.way, x1: r => r.straightness - r.sd, x2: r => Math.min(1, r.straightness + r.sd), stroke: '#2a9d78', strokeWidth: 3, strokeOpacity: 0.5}),
        Plot.dot(t.records, {y: r => names[r.way] ?? r.way, x: 'straightness', r: 6, fill: '#2a9d78', ariaLabel: r => `${r.way} ${r.straightness}`}),
        Plot.text(t.records, {y: r => names[r.way] ?? r.way, x: 'straightness', text: r => `${show(r.straightness, 4)} ± ${show(r.sd, 2)}`, dy: -14}),
      ],
    }),
  });
}

function transport() {
  const t = table('transport');
  if (!t || !t.records.length) return missing('Transport tortuosity λ', 'No /statistics/transport: how much slower water diffuses between the cells than freely. It needs /volumes/distance with fine voxels.', analyse('transport'));
  const axes = ['x', 'y', 'z'].map((a, i) => ({key: a, label: `D* / D₀ along ${a}`, colour: ['#2f7fc1', '#e07b39', '#2a9d78'][i]}));
  const limit = t.records.find(r => r.voxel === 0) ?? t.records.at(-1);
  return figure({
    id: 'transport', half: true, title: 'Transport between the cells', text: `λ = √(D₀ / D*) = ${show(limit.lambda, 4)}${limit.voxel === 0 ? ', at voxels of size 0 by extrapolation' : ''}; extracellular share ${show(limit.ecs_fraction, 3)}.`, from: t.where('voxel', 'ratio_x', 'ratio_y', 'ratio_z', 'lambda'), table: t, series: axes,
    draw: (width, {hidden}) => plot(width, {
      x: {label: 'voxel (µm)', grid: true, zero: true, nice: true}, y: {label: 'D* / D₀', grid: true, nice: true, ticks: 6},
      marks: axes.filter(a => !hidden.has(a.key)).flatMap(a => [
        Plot.line(t.records, {x: 'voxel', y: `ratio_${a.key}`, stroke: a.colour, sort: 'voxel', strokeDasharray: '5 4'}),
        Plot.dot(t.records, {x: 'voxel', y: `ratio_${a.key}`, r: 5, fill: r => (r.voxel === 0 ? 'var(--paper)' : a.colour), stroke: a.colour, strokeWidth: 2, ariaLabel: r => `${a.key} ${r.voxel} ${r[`ratio_${a.key}`]}`, title: r => `${r.voxel === 0 ? 'extrapolated' : `voxel ${amount(r.voxel, 'um', 3)}`}\nD*/D₀ along ${a.key} ${show(r[`ratio_${a.key}`], 4)}\nλ ${show(r.lambda, 4)}`, tip: true}),
      ]),
    }),
  });
}

export const structureFigures = () => [composition(), spectrum()];
export const poreFigures = () => [pores(), paths(), transport()];
