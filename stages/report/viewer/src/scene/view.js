// SPDX-License-Identifier: BSD-3-Clause
// The 3-D view: camera, what is drawn, picking. Knows nothing of the buttons around it.
import * as THREE from 'three';
import {OrbitControls} from 'three/examples/jsm/controls/OrbitControls.js';
import {balls, lines, sharedUniforms, surfaces, tubes} from './materials.js';
import {faces, segments, somata, vertexData} from './model.js';

const mostTubes = 500000; // more segments are drawn as lines

export class View {
  constructor(model, element) {
    this.model = model, this.element = element, this.parts = {}, this.dirty = true;
    this.renderer = new THREE.WebGLRenderer({antialias: true, preserveDrawingBuffer: true, alpha: true});
    this.renderer.setPixelRatio(Math.min(2, window.devicePixelRatio));
    this.renderer.outputColorSpace = THREE.LinearSRGBColorSpace;
    element.append(this.renderer.domElement);
    this.scene = new THREE.Scene();
    this.camera = new THREE.PerspectiveCamera(32, 1, 0.1, 1e6);
    this.camera.up.set(...model.pia);
    this.colours = new THREE.DataTexture(new Uint8Array(1024 * Math.max(1, Math.ceil(model.type.length / 1024)) * 4), 1024, Math.max(1, Math.ceil(model.type.length / 1024)));
    this.uniforms = sharedUniforms(model, this.colours);
    this.controls = new OrbitControls(this.camera, this.renderer.domElement);
    this.controls.enableDamping = true, this.controls.dampingFactor = 0.12;
    this.controls.addEventListener('change', () => this.draw());
    this.target = new THREE.WebGLRenderTarget(1, 1);
    if (model.hasBox) this.addBox();
    new ResizeObserver(() => this.resize()).observe(element);
    this.fit(false);
    this.resize();
  }

  addBox() {
    const size = this.model.hi.map((v, a) => v - this.model.lo[a]);
    this.box = new THREE.LineSegments(new THREE.EdgesGeometry(new THREE.BoxGeometry(...size)), new THREE.LineBasicMaterial({color: 0x8a94a0, transparent: true, opacity: 0.7}));
    this.scene.add(this.box);
  }

  /** Puts the camera so that the box, or all that is drawn, fills the view. */
  fit(whole) {
    const {model} = this;
    let radius = Math.hypot(...model.hi.map((v, a) => (v - model.lo[a]) / 2)), centre = new THREE.Vector3();
    if (whole && (model.position.length || model.somaPosition.length)) {
      const box = new THREE.Box3();
      for (const list of [model.position, model.somaPosition]) if (list.length) box.union(new THREE.Box3().setFromArray(list));
      const sphere = box.getBoundingSphere(new THREE.Sphere());
      radius = sphere.radius * 0.86, centre = sphere.center;
    }
    const distance = (whole ? 1.02 : 0.99) * radius / Math.sin(this.camera.fov * Math.PI / 360) / Math.min(1, this.camera.aspect || 1);
    const azimuth = 35 * Math.PI / 180, elevation = 20 * Math.PI / 180;
    this.camera.position.set(centre.x + distance * Math.cos(elevation) * Math.sin(azimuth), centre.y - distance * Math.cos(elevation) * Math.cos(azimuth), centre.z + distance * Math.sin(elevation));
    this.camera.near = distance / 500, this.camera.far = distance * 12;
    this.controls.target.copy(centre), this.controls.update();
    this.draw();
  }

  resize() {
    const width = this.element.clientWidth, height = this.element.clientHeight;
    if (!width || !height) return;
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height, this.camera.updateProjectionMatrix();
    this.draw();
  }

  /** What is drawn: {surface, folded}. Parts are made when first asked for. */
  show({surface, folded}) {
    const {model, uniforms} = this;
    const key = name => `${name}-${folded}`;
    const need = (name, make) => {
      if (!this.parts[key(name)]) this.scene.add(this.parts[key(name)] = make());
      return this.parts[key(name)];
    };
    const wanted = [];
    if (surface) {
      this.vertices ??= vertexData(model);
      wanted.push(need('surface', () => surfaces(model, this.vertices, faces(model, folded), uniforms)));
    } else {
      wanted.push(need('skeleton', () => {
        const parts = segments(model, folded);
        this.asLines = parts.cell.length > mostTubes;
        return this.asLines ? lines(parts, uniforms) : tubes(parts, uniforms);
      }));
      wanted.push(need('soma', () => balls(somata(model, folded), uniforms)));
    }
    for (const part of Object.values(this.parts)) part.visible = wanted.includes(part);
    uniforms.uBox.value = folded;
    this.draw();
  }

  /** colour(cell) -> [r, g, b] from 0 to 1, or null for a cell that is hidden. */
  colour(colour) {
    const data = this.colours.image.data;
    for (let i = 0; i < this.model.type.length; i++) {
      const c = colour(i);
      for (let k = 0; k < 3; k++) data[4 * i + k] = c ? Math.round(255 * c[k]) : 0;
      data[4 * i + 3] = c ? 255 : 0;
    }
    this.colours.needsUpdate = true;
    this.draw();
  }

  /** Cuts away what lies beyond `share` of the box along `axis` (-1 = no cut). */
  cut(axis, share, flipped) {
    if (axis < 0) this.uniforms.uPlane.value.set(0, 0, 0, 1);
    else {
      const normal = [0, 0, 0], at = this.model.lo[axis] + share * (this.model.hi[axis] - this.model.lo[axis]);
      normal[axis] = flipped ? -1 : 1;
      this.uniforms.uPlane.value.set(...normal, flipped ? -at : at);
    }
    this.draw();
  }

  /** Whether the camera looks from the lower side of an axis: then that side is cut away first. */
  facesLow(axis) {
    return this.camera.position.getComponent(axis) < this.controls.target.getComponent(axis);
  }

  highlight(cell) {
    this.uniforms.uPicked.value = cell ?? -1;
    this.draw();
  }

  /** The cell at a place of the element (pixels), or null. */
  cellAt(x, y) {
    const {renderer, camera, scene, uniforms} = this, ratio = renderer.getPixelRatio(), pixel = new Uint8Array(4);
    camera.setViewOffset(this.element.clientWidth * ratio, this.element.clientHeight * ratio, Math.floor(x * ratio), Math.floor(y * ratio), 1, 1);
    uniforms.uPick.value = true;
    if (this.box) this.box.visible = false;
    renderer.setRenderTarget(this.target), renderer.setClearColor(0, 0), renderer.clear(), renderer.render(scene, camera);
    renderer.readRenderTargetPixels(this.target, 0, 0, 1, 1, pixel);
    renderer.setRenderTarget(null), camera.clearViewOffset();
    uniforms.uPick.value = false;
    if (this.box) this.box.visible = true;
    const id = pixel[0] + 256 * pixel[1] + 65536 * pixel[2];
    return pixel[3] && id > 0 && id <= this.model.type.length ? id - 1 : null;
  }

  /** Draws once, at the next frame. */
  draw() {
    if (this.waiting) return;
    this.waiting = true;
    requestAnimationFrame(() => {
      this.waiting = false;
      this.controls.update();
      this.uniforms.uEye.value.copy(this.camera.position);
      this.renderer.render(this.scene, this.camera);
      this.onDraw?.();
    });
  }

  /** Directions of x, y, z on the screen, for the little axes. */
  axes() {
    return [0, 1, 2].map(a => {
      const v = new THREE.Vector3().setComponent(a, 1).applyQuaternion(this.camera.quaternion.clone().invert());
      return [v.x, -v.y];
    });
  }
}
