// SPDX-License-Identifier: BSD-3-Clause
// Colours of classes (those of conceg render) and of series; they stay apart without the red-green channel.
import {values} from './data.js';

export const classShades = {
  pyramidal: ['#1f6fb5', '#6db6ec', '#123f7a', '#9fd0f5'],
  interneuron: ['#d1401f', '#f59a3e', '#9c1f2e', '#ffc07a'],
  astrocyte: ['#1e9c73', '#67c9a2', '#0e6b4e', '#a5dfc6'],
  microglia: ['#8b5bb5', '#b995d8', '#5e3487', '#d7c0ea'],
  axon: ['#c9a21b', '#e6cb5e', '#8f7110', '#f2e09c'],
  other: ['#7f8790', '#abb2ba', '#555c64', '#cbd0d6'],
};
export const series = ['#2f7fc1', '#e07b39', '#2a9d78', '#a56cc1', '#c9a21b', '#d1495b', '#6c7a89', '#4bb3c3', '#8c6d31', '#b23a8a', '#3b5b92', '#7d9b3a'];

export const classColour = name => (classShades[name] ?? classShades.other)[0];
export const seriesColour = i => series[i % series.length];

/** A colour for each type: successive shades of its class. */
export function typeColours() {
  const used = {};
  return (values('/types/class') ?? []).map(name => {
    const shades = classShades[name] ?? classShades.other;
    used[name] = (used[name] ?? -1) + 1;
    return shades[used[name] % shades.length];
  });
}

/** By type's name. */
export function typeColour(name) {
  const i = (values('/types/name') ?? []).indexOf(name);
  return i < 0 ? seriesColour(6) : typeColours()[i];
}

/** '#rrggbb' -> [r, g, b] from 0 to 1. */
export const rgb = hex => [1, 3, 5].map(i => parseInt(hex.slice(i, i + 2), 16) / 255);

export const stateColours = {done: '#2a9d78', handed: '#7fc8a9', short: '#e3b23c', lost: '#d1495b', waiting: '#9aa3ad'};
export const spaceColours = {soma: '#1f6fb5', neurite: '#6db6ec', extracellular: '#b9c2cb'};
