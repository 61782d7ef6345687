// SPDX-License-Identifier: GPL-3.0-or-later
// The page of the tests: a scene with one asset, driven from outside through window.test.
import * as THREE from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { loadLode } from 'meshlode/three';

const canvas = document.body.appendChild(document.createElement('canvas'));
const renderer = new THREE.WebGLRenderer({ canvas, antialias: false, preserveDrawingBuffer: true });
const scene = new THREE.Scene();
scene.background = new THREE.Color(0xff00ff);
scene.add(new THREE.HemisphereLight(0xffffff, 0x888888, 2));
const sun = new THREE.DirectionalLight(0xffffff, 2);
scene.add(sun);
let camera = new THREE.PerspectiveCamera(45, 1, 0.01, 1000);

// three makes a table for its own materials once, and keeps it.
const ball = new THREE.Mesh(new THREE.SphereGeometry(), new THREE.MeshStandardMaterial());
scene.add(ball);
renderer.render(scene, camera);
scene.remove(ball);
ball.geometry.dispose();
ball.material.dispose();
const before = { ...renderer.info.memory };

const covered = (bytes, ground) => {
  let text = '';
  for (let at = 0; at < bytes.length; at += 4) text += ground.every((value, k) => bytes[at + k] === value) ? '0' : '1';
  return text;
};

const test = {
  THREE, renderer, scene, lode: null, errors: [], events: [], frames: 0, isRunning: false,
  get camera() {
    return camera;
  },
  setSize(width, height) {
    renderer.setSize(width, height);
    camera.aspect = width / height;
    camera.updateProjectionMatrix();
  },
  /** What comes of an asset whose worker says that its scene is this one. */
  openScene(scene) {
    const material = { name: '', sourceIndex: 0, alphaMode: 0, alphaCutoff: 0.5, doubleSided: false, baseColor: [1, 1, 1, 1] };
    const data = { type: 'opened', meshes: [], materials: [material], instances: [], scene, slot: { vertices: 3, triangles: 1 }, pageCount: 0 };
    const createWorker = () => {
      const worker = { terminate() {}, postMessage: ({ type }) => type === 'open' && setTimeout(() => worker.onmessage({ data })) };
      return worker;
    };
    return loadLode('none', { createWorker }).then(() => 'ok', ({ place }) => place);
  },
  /** The same with a loader of KTX2 as three's is, which knows the sizes alone: three's own refuses the formats of the tests' model. */
  openKtx2(url) {
    const parse = (buffer, onLoad, onError) => {
      const bytes = new DataView(buffer);
      if (bytes.getUint32(0) !== 0xab4b5458) return onError(new Error('no KTX2'));
      const [width, height] = [bytes.getUint32(20, true), bytes.getUint32(24, true)];
      setTimeout(() => onLoad(new THREE.DataTexture(new Uint8Array(4 * width * height).fill(128), width, height)), 20);
    };
    return test.open(url, { ktx2Loader: { parse } });
  },
  /** Opens an asset; 'ok', or what was refused with its place. */
  async open(url, options) {
    test.errors = [];
    test.events = [];
    try {
      test.lode = await loadLode(url, options);
    } catch (error) {
      return { place: error.place, message: error.message };
    }
    test.lode.addEventListener('error', ({ place, message, isFatal }) => test.errors.push({ place, message, isFatal }));
    test.lode.addEventListener('progress', ({ target, ...event }) => test.events.push(event));
    scene.add(test.lode);
    return 'ok';
  },
  look(eye, target, fovy = 45, near = 0.001) {
    camera.position.set(...eye);
    camera.up.set(0, 1, 0);
    camera.fov = fovy;
    camera.near = near;
    camera.far = 1e6 * near;
    camera.updateProjectionMatrix();
    camera.lookAt(...target);
    sun.position.copy(camera.position);
    sun.target.position.set(...target);
    sun.target.updateMatrixWorld();
    test.target = target;
  },
  /** A view that frames the asset, from a direction. */
  frame(direction = [0.4, 0.3, 1], distance = 1.2) {
    const sphere = test.lode.boundingBox.getBoundingSphere(new THREE.Sphere());
    const away = new THREE.Vector3(...direction).normalize().multiplyScalar((distance * sphere.radius) / Math.sin(Math.PI / 8));
    test.look(sphere.center.clone().add(away).toArray(), sphere.center.toArray(), 45, 0.001 * sphere.radius);
  },
  /** Moves the asset and the camera alike. */
  move(matrix) {
    const group = new THREE.Group();
    group.applyMatrix4(matrix);
    group.add(camera);
    scene.add(group);
    test.lode.applyMatrix4(matrix);
    // The camera is scaled with its parent, which its near plane is not.
    camera.near *= matrix.getMaxScaleOnAxis();
    camera.far *= matrix.getMaxScaleOnAxis();
    camera.updateProjectionMatrix();
  },
  /** The view of the camera from its side, without perspective. */
  setOrthographic() {
    const sphere = test.lode.boundingBox.clone().applyMatrix4(test.lode.matrixWorld).getBoundingSphere(new THREE.Sphere());
    const { radius, center } = sphere;
    camera = new THREE.OrthographicCamera(-1.33 * radius, 1.33 * radius, radius, -radius, 0.1 * radius, 10 * radius);
    camera.position.copy(center).add(new THREE.Vector3(1, 1, 2).normalize().multiplyScalar(4 * radius));
    camera.lookAt(center);
  },
  draw() {
    test.lode?.update(camera, renderer);
    renderer.render(scene, camera);
    ++test.frames;
  },
  run() {
    test.isRunning = true;
    const next = () => {
      if (!test.isRunning) return;
      test.draw();
      requestAnimationFrame(next);
    };
    next();
  },
  /** Draws until the view is complete, or an error is fatal; false after so many seconds. */
  async settle(seconds = 60) {
    for (const end = performance.now() + 1000 * seconds; performance.now() < end; await new Promise((done) => setTimeout(done, 10))) {
      test.lode.update(camera, renderer);
      if (test.lode.isSettled || test.errors.some((error) => error.isFatal)) {
        test.draw();
        return true;
      }
    }
    return false;
  },
  pixels() {
    renderer.render(scene, camera);
    const gl = renderer.getContext();
    const bytes = new Uint8Array(4 * canvas.width * canvas.height);
    gl.readPixels(0, 0, canvas.width, canvas.height, gl.RGBA, gl.UNSIGNED_BYTE, bytes);
    return bytes;
  },
  /** Of the canvas: 1 where it is not the background. */
  coverage() {
    const { width, height } = canvas;
    const bytes = test.pixels();
    let text = '';
    for (let y = height - 1; y >= 0; --y) text += covered(bytes.subarray(4 * y * width, 4 * (y + 1) * width), [255, 0, 255]);
    return text;
  },
  /** The same of a picture whose corner is its background. */
  async coverageOf(url) {
    const image = await createImageBitmap(await (await fetch(url)).blob());
    const context = new OffscreenCanvas(image.width, image.height).getContext('2d');
    context.drawImage(image, 0, 0);
    const { data } = context.getImageData(0, 0, image.width, image.height);
    return covered(data, data.slice(0, 3));
  },
  /** Pixels of the asset's picture, and of three's own loader's of its source with the same camera: how many differ by how much. */
  async compareWithSource(url) {
    const ours = test.pixels();
    const { scene: source } = await new GLTFLoader().loadAsync(url);
    source.traverse((one) => (one.visible = !one.isLight)); // lights are not the asset's to bring
    scene.remove(test.lode);
    scene.add(source);
    const theirs = test.pixels();
    scene.remove(source);
    scene.add(test.lode);
    const steps = [2, 8, 24];
    const over = steps.map(() => 0);
    let squares = 0;
    for (let at = 0; at < ours.length; at += 4) {
      let most = 0;
      for (let k = 0; k < 3; ++k) {
        most = Math.max(most, Math.abs(ours[at + k] - theirs[at + k]));
        squares += (ours[at + k] - theirs[at + k]) ** 2;
      }
      steps.forEach((step, i) => (over[i] += most > step));
    }
    return { over: over.map((count) => (4 * count) / ours.length), psnr: 10 * Math.log10(255 ** 2 / (squares / (0.75 * ours.length))) };
  },
  /** What the renderer holds more than it did when no asset had been there. */
  leftovers() {
    renderer.render(scene, camera);
    const { geometries, textures } = renderer.info.memory;
    return { geometries: geometries - before.geometries, textures: textures - before.textures };
  },
};
window.test = test;
