// SPDX-License-Identifier: MIT
// A Lode of meshlode/three on a canvas: an orbit camera, light from all around, and other materials where the viewer shows
// something else than the asset's own. Draws when something has changed.
import * as THREE from 'three';
import { RoomEnvironment } from 'three/addons/environments/RoomEnvironment.js';
import { FIELD_OF_VIEW, Orbit } from './orbit.js';

/** Three keeps the ranges that a batch draws until a visibility changes, and those of edges are others than those of triangles. */
function renewRanges(batch) {
  if (batch.userData.shown.length === 0) return;
  const isVisible = batch.getVisibleAt(0);
  batch.setVisibleAt(0, !isVisible).setVisibleAt(0, isVisible);
}

function useAlphaAlone(shader) {
  shader.fragmentShader = shader.fragmentShader.replace('#include <map_fragment>', 'diffuseColor.a *= texture2D(map, vMapUv).a;');
}

export class LodeStage {
  hasMoved = false;
  isOver = false;
  lode = null;
  #mode = 'textured';
  #isWire = false;
  #colours = null; // 4 bytes a cluster
  #ground = new THREE.Color();
  #own = new WeakMap(); // batch -> the asset's material
  #other = new Map(); // materials of this class
  #request = 0;

  /** onDraw() comes after each picture, onMove() after each move of the camera. Throws where there is no WebGL2. */
  constructor(canvas, { onSelect, onMove, onDraw }) {
    this.canvas = canvas;
    this.onDraw = onDraw;
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: true });
    this.renderer.toneMapping = THREE.NeutralToneMapping; // keeps base colours as they are
    this.scene = new THREE.Scene();
    this.camera = new THREE.PerspectiveCamera(THREE.MathUtils.radToDeg(FIELD_OF_VIEW));
    const generator = new THREE.PMREMGenerator(this.renderer);
    const room = new RoomEnvironment();
    this.light = generator.fromScene(room, 0.04);
    this.scene.environment = this.light.texture;
    room.dispose();
    generator.dispose();
    this.orbit = new Orbit(canvas, {
      onMove: () => {
        this.hasMoved = true;
        this.draw();
        onMove();
      },
      onClick: (x, y) => {
        const cluster = this.#pick(x, y);
        if (cluster !== undefined) onSelect(cluster);
      },
    });
    this.observer = new ResizeObserver(() => this.draw());
    this.observer.observe(canvas);
  }

  /** Shows an opened Lode in place of another. */
  setLode(lode) {
    this.lode?.dispose();
    this.lode = lode;
    this.scene.add(lode);
    lode.addEventListener('change', () => {
      this.#dress();
      this.draw();
    });
    this.draw();
  }
  frame(box) {
    this.orbit.frame(box);
    this.draw();
  }

  // ---------------------------------------------------------------------------------------------------------- colours

  set theme(theme) {
    this.#ground.setRGB(...theme.canvas.map((value) => value / 255), THREE.SRGBColorSpace);
    this.scene.background = this.#ground;
    this.mark = theme.mark;
    this.edge = theme.isDark ? 0xe0e0e0 : 0x1a1a1a;
  }
  setMode(measure, isWire) {
    this.#mode = measure;
    this.scene.environmentIntensity = measure === 'textured' ? 1 : 0.6; // colours that stand for something stay below white
    this.#isWire = isWire;
  }
  setColours(bytes) {
    this.#colours = bytes;
    this.#dress();
    this.draw();
  }

  /** Each batch gets the material of the mode, and each cluster that is drawn its colour. */
  #dress() {
    const colour = new THREE.Color();
    for (const batch of this.lode?.children ?? []) {
      if (!this.#own.has(batch)) this.#own.set(batch, batch.material);
      const own = this.#own.get(batch);
      batch.material = this.#materialFor(own, this.#mode);
      if (!this.#colours) continue;
      batch.userData.shown.forEach(({ cluster, isVisible }, id) => {
        if (!isVisible) return;
        const isSelected = this.#colours[4 * cluster + 3] < 128;
        const bytes = isSelected ? this.mark : this.#colours.subarray(4 * cluster, 4 * cluster + 3);
        if (!isSelected && (this.#mode === 'textured' || this.#mode === 'normals')) colour.set(0xffffff);
        else colour.setRGB(bytes[0] / 255, bytes[1] / 255, bytes[2] / 255, THREE.SRGBColorSpace);
        batch.setColorAt(id, colour);
      });
    }
  }
  #materialFor(own, mode) {
    if (mode === 'textured') return own;
    const { side, flatShading, alphaTest, map } = own;
    const isColour = mode !== 'normals' && mode !== 'edges';
    const isCut = isColour && alphaTest > 0 && map !== null; // leaves have the shapes that their texture cuts out
    const key = [isColour ? 'colours' : mode, side, flatShading, isCut && `${alphaTest} ${map.uuid}`].join(' ');
    if (!this.#other.has(key)) {
      const made = mode === 'normals' ? new THREE.MeshNormalMaterial({ side, flatShading })
        : mode === 'edges' ? new THREE.MeshBasicMaterial({ side, wireframe: true })
          : new THREE.MeshStandardMaterial({ side, flatShading, roughness: 1, metalness: 0 });
      made.toneMapped = false;
      if (isCut) Object.assign(made, { alphaTest, map, onBeforeCompile: useAlphaAlone });
      this.#other.set(key, made);
    }
    return this.#other.get(key);
  }

  // --------------------------------------------------------------------------------------------------------- pictures

  draw() {
    if (this.#request === 0 && !this.isOver) this.#request = requestAnimationFrame(() => this.drawNow());
  }

  drawNow() {
    cancelAnimationFrame(this.#request);
    this.#request = 0;
    if (!this.lode || !this.orbit.center) return;
    const { canvas, renderer, camera, orbit, scene } = this;
    const [width, height, ratio] = [Math.max(1, canvas.clientWidth), Math.max(1, canvas.clientHeight), devicePixelRatio || 1];
    const size = renderer.getSize(new THREE.Vector2());
    if (size.x !== width || size.y !== height || renderer.getPixelRatio() !== ratio) {
      renderer.setPixelRatio(ratio);
      renderer.setSize(width, height, false);
    }
    const center = new THREE.Vector3(...orbit.center);
    camera.position.fromArray(orbit.eye()).add(center);
    Object.assign(camera, { aspect: width / height, near: orbit.near(), far: orbit.far() });
    camera.updateProjectionMatrix();
    camera.lookAt(center.add(new THREE.Vector3(...orbit.target)));
    this.lode.update(camera, renderer);
    renderer.info.autoReset = false;
    renderer.info.reset();
    renderer.render(scene, camera);
    this.triangles = renderer.info.render.triangles;
    this.calls = renderer.info.render.calls;
    if (this.#isWire) this.#drawEdges();
    this.edges = renderer.info.render.lines;
    this.onDraw();
  }

  /** Over the picture, at its depths. */
  #drawEdges() {
    const { renderer, scene, camera, lode } = this;
    const before = lode.children.map((batch) => batch.material);
    for (const batch of lode.children) {
      renewRanges(batch);
      batch.material = this.#materialFor(this.#own.get(batch) ?? batch.material, 'edges'); // its own until #dress()
      batch.material.color.set(this.edge);
    }
    // A step nearer than the triangles that they are of, until the next picture: lines have no polygon offset.
    camera.projectionMatrix.elements[14] *= 1.0005;
    scene.background = null;
    renderer.autoClear = false;
    renderer.render(scene, camera);
    renderer.autoClear = true;
    scene.background = this.#ground;
    lode.children.forEach((batch, i) => {
      batch.material = before[i];
      renewRanges(batch);
    });
  }

  toPng(done) {
    this.drawNow();
    this.canvas.toBlob(done);
  }

  /** The cluster at a place of the canvas, CSS pixels. */
  #pick(x, y) {
    if (!this.lode) return undefined;
    const at = new THREE.Vector2((2 * x) / this.canvas.clientWidth - 1, 1 - (2 * y) / this.canvas.clientHeight);
    const ray = new THREE.Raycaster();
    ray.setFromCamera(at, this.camera);
    const hit = ray.intersectObject(this.lode)[0];
    return hit && hit.object.userData.shown[hit.batchId]?.cluster;
  }

  end() {
    this.isOver = true;
    cancelAnimationFrame(this.#request);
    this.observer.disconnect();
    this.lode?.dispose();
    for (const material of this.#other.values()) material.dispose();
    this.light.dispose();
    this.renderer.dispose();
    this.renderer.forceContextLoss();
    this.canvas.replaceWith(this.canvas.cloneNode()); // with its listeners
  }
}
