// SPDX-License-Identifier: BSD-3-Clause
// Shaders: one look for tubes, lines, spheres and surfaces; colours per cell from a texture; box and plane cut in the shader.
import * as THREE from 'three';

const common = /* glsl */ `
  uniform sampler2D uColours; uniform float uPicked; uniform bool uPick;
  out vec3 vAt; out vec3 vNormal; flat out vec4 vColour;
  bool place(vec3 at, vec3 normal, float cell) {
    ivec2 texel = ivec2(int(cell) % 1024, int(cell) / 1024);
    vec4 colour = texelFetch(uColours, texel, 0);
    vAt = at; vNormal = normal; vColour = colour;
    if (uPick) { float id = cell + 1.0; vColour = vec4(mod(id, 256.0), mod(floor(id / 256.0), 256.0), floor(id / 65536.0), 255.0) / 255.0; }
    else if (uPicked >= 0.0 && abs(uPicked - cell) > 0.5) vColour.rgb = mix(vColour.rgb, vec3(dot(vColour.rgb, vec3(0.3, 0.6, 0.1))), 0.85) * 0.75 + 0.12;
    gl_Position = projectionMatrix * viewMatrix * vec4(at, 1.0);
    if (colour.a < 0.5) gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
    return true;
  }`;

const fragment = /* glsl */ `
  precision highp float;
  uniform vec3 uLo, uHi; uniform bool uBox, uPick, uFlat; uniform vec4 uPlane; uniform vec3 uEye;
  in vec3 vAt; in vec3 vNormal; flat in vec4 vColour;
  out vec4 outColour;
  void main() {
    if (uBox && (any(lessThan(vAt, uLo)) || any(greaterThan(vAt, uHi)))) discard;
    if (dot(vAt, uPlane.xyz) > uPlane.w) discard;
    if (uPick) { outColour = vColour; return; }
    if (uFlat) { outColour = vec4(vColour.rgb, 1.0); return; }
    // Seen from within: the cut through a cell, drawn flat as if it were filled.
    if (!gl_FrontFacing) { outColour = vec4(mix(vColour.rgb, vec3(1.0), 0.28), 1.0); return; }
    vec3 n = normalize(vNormal), view = normalize(uEye - vAt);
    float facing = max(0.0, dot(n, view));
    float key = max(0.0, dot(n, normalize(view + vec3(0.45, -0.35, 0.8))));
    float sky = 0.5 + 0.5 * n.z;
    vec3 colour = vColour.rgb * (0.34 + 0.26 * sky + 0.52 * key) + 0.10 * pow(key, 24.0);
    outColour = vec4(colour * (0.55 + 0.45 * smoothstep(0.0, 0.45, facing)), 1.0);
  }`;

const tube = /* glsl */ `
  in vec4 a, b; in vec3 ta, tb; in float cell;
  void main() {
    vec3 along = normalize(b.xyz - a.xyz + vec3(1e-9));
    vec3 side = abs(along.z) < 0.9 ? normalize(cross(along, vec3(0, 0, 1))) : normalize(cross(along, vec3(1, 0, 0)));
    vec3 t = position.z < 0.5 ? ta : tb;
    vec3 u = normalize(side - t * dot(side, t)), v = cross(t, u);
    vec3 out_ = position.x * u + position.y * v;
    vec4 end = position.z < 0.5 ? a : b;
    place(end.xyz + end.w * out_, out_, cell);
  }`;

const ball = /* glsl */ `
  in vec4 sphere; in float cell;
  void main() { place(sphere.xyz + sphere.w * position, position, cell); }`;

const line = /* glsl */ `
  in float cell;
  void main() { place(position, vec3(0, 0, 1), cell); }`;

const surface = /* glsl */ `
  uniform vec3 uMeshLo, uShift; uniform float uMeshStep; in float cell;
  void main() { place(uMeshLo + uMeshStep * position + uShift, normal, cell); }`;

/** Uniforms that all materials share. */
export function sharedUniforms(model, colours) {
  return {
    uColours: {value: colours}, uPicked: {value: -1}, uPick: {value: false}, uBox: {value: false}, uEye: {value: new THREE.Vector3()},
    uLo: {value: new THREE.Vector3(...model.lo)}, uHi: {value: new THREE.Vector3(...model.hi)}, uPlane: {value: new THREE.Vector4(0, 0, 0, 1)},
  };
}

function material(vertex, uniforms, own = {}) {
  return new THREE.ShaderMaterial({
    glslVersion: THREE.GLSL3, side: THREE.DoubleSide, vertexShader: common + vertex, fragmentShader: fragment,
    uniforms: {...uniforms, uFlat: {value: false}, ...own},
  });
}

const unitTube = sides => {
  const position = [], index = [];
  for (let z = 0; z < 2; z++) for (let k = 0; k < sides; k++) position.push(Math.cos(2 * Math.PI * k / sides), Math.sin(2 * Math.PI * k / sides), z);
  for (let k = 0; k < sides; k++) { const n = (k + 1) % sides; index.push(k, n, sides + n, k, sides + n, sides + k); }
  return {position, index};
};

function instanced(base, attributes) {
  const geometry = new THREE.InstancedBufferGeometry();
  geometry.setAttribute('position', new THREE.Float32BufferAttribute(base.position, 3));
  geometry.setIndex(base.index);
  for (const [name, list, size] of attributes) geometry.setAttribute(name, new THREE.InstancedBufferAttribute(Float32Array.from(list), size));
  geometry.instanceCount = attributes[0][1].length / attributes[0][2];
  return geometry;
}

const unculled = object => Object.assign(object, {frustumCulled: false});

export function tubes(parts, uniforms) {
  const sides = parts.cell.length > 150000 ? 5 : 8;
  return unculled(new THREE.Mesh(instanced(unitTube(sides), [['a', parts.a, 4], ['b', parts.b, 4], ['ta', parts.ta, 3], ['tb', parts.tb, 3], ['cell', parts.cell, 1]]), material(tube, uniforms)));
}

export function lines(parts, uniforms) {
  const count = parts.cell.length, position = new Float32Array(6 * count), cell = new Float32Array(2 * count);
  for (let i = 0; i < count; i++) {
    for (let k = 0; k < 3; k++) position[6 * i + k] = parts.a[4 * i + k], position[6 * i + 3 + k] = parts.b[4 * i + k];
    cell[2 * i] = cell[2 * i + 1] = parts.cell[i];
  }
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute('position', new THREE.BufferAttribute(position, 3)), geometry.setAttribute('cell', new THREE.BufferAttribute(cell, 1));
  return unculled(new THREE.LineSegments(geometry, material(line, uniforms, {uFlat: {value: true}})));
}

export function balls(parts, uniforms) {
  const base = new THREE.SphereGeometry(1, 32, 20);
  return unculled(new THREE.Mesh(instanced({position: base.attributes.position.array, index: [...base.index.array]}, [['sphere', parts.sphere, 4], ['cell', parts.cell, 1]]), material(ball, uniforms)));
}

export function surfaces(model, data, groups, uniforms) {
  const group = new THREE.Group();
  const position = new THREE.BufferAttribute(model.meshPosition, 3), normal = new THREE.BufferAttribute(data.normal, 3, true), cell = new THREE.BufferAttribute(data.cell, 1);
  for (const part of groups) {
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute('position', position), geometry.setAttribute('normal', normal), geometry.setAttribute('cell', cell);
    geometry.setIndex(new THREE.BufferAttribute(Uint32Array.from(part.index), 1));
    group.add(unculled(new THREE.Mesh(geometry, material(surface, uniforms, {uMeshLo: {value: new THREE.Vector3(...model.meshLo)}, uMeshStep: {value: model.meshStep}, uShift: {value: new THREE.Vector3(...part.shift)}}))));
  }
  return group;
}
