// SPDX-License-Identifier: GPL-3.0-or-later
// The viewer's picture at one pixel beside that of the source by three's own GLTFLoader: the same camera, light and renderer.
import { writeFileSync } from 'node:fs';
import { join } from 'node:path';

/** In the page: draws both, and returns how they differ and three pictures as data URLs. */
const COMPARE = async (address) => {
  const { GLTFLoader } = await import('three/addons/loaders/GLTFLoader.js');
  const { view } = globalThis.meshlodeViewer;
  const { renderer, scene, camera, lode } = view;
  const gl = renderer.getContext();
  const [width, height] = [gl.drawingBufferWidth, gl.drawingBufferHeight];
  const draw = () => {
    renderer.render(scene, camera);
    const bytes = new Uint8Array(4 * width * height);
    gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, bytes);
    return { bytes, triangles: renderer.info.render.triangles, url: renderer.domElement.toDataURL() };
  };
  const count = () => {
    renderer.info.reset();
    return draw();
  };
  view.drawNow();
  const ours = count();
  const { scene: source } = await new GLTFLoader().loadAsync(address);
  source.traverse((one) => (one.visible = !one.isLight)); // lights are not the asset's to bring
  scene.remove(lode);
  scene.add(source);
  const theirs = count();
  scene.remove(source);
  scene.add(lode);
  const steps = [2, 8, 24, 64];
  const over = steps.map(() => 0);
  const shown = new ImageData(width, height);
  let [squares, covered] = [0, 0];
  const ground = ours.bytes.slice(0, 3);
  for (let at = 0; at < ours.bytes.length; at += 4) {
    let most = 0;
    let isGround = true;
    for (let k = 0; k < 3; ++k) {
      const off = Math.abs(ours.bytes[at + k] - theirs.bytes[at + k]);
      most = Math.max(most, off);
      squares += off * off;
      isGround &&= ours.bytes[at + k] === ground[k] && theirs.bytes[at + k] === ground[k];
    }
    covered += !isGround;
    steps.forEach((step, i) => (over[i] += most > step));
    const row = height - 1 - Math.floor(at / 4 / width);
    shown.data.set([most * 4, most * 4, most * 4, 255], 4 * (row * width + ((at / 4) % width)));
  }
  const canvas = document.createElement('canvas');
  Object.assign(canvas, { width, height });
  canvas.getContext('2d').putImageData(shown, 0, 0);
  return { over: over.map((pixels) => pixels / covered), psnr: 10 * Math.log10(255 ** 2 / (squares / (3 * width * height))), triangles:
    [ours.triangles, theirs.triangles], size: [width, height], urls: [ours.url, theirs.url, canvas.toDataURL()] };
};

/** Expects no more than a person would see: of the pixels that either covers 1% may be off by more than a tenth of the scale. */
export async function comparePictures({ tab, name, address, screenshots, expect }) {
  await tab.until('meshlodeViewer.view.lode?.isSettled', 40);
  const { over, psnr, triangles, size, urls } = await tab.value(`(${COMPARE})('${address}')`);
  ['ours', 'three', 'difference'].forEach((what, i) => {
    writeFileSync(join(screenshots, `example-${name}-beside-${what}.png`), Buffer.from(urls[i].split(',')[1], 'base64'));
  });
  expect(over[2] <= 0.01 && triangles[0] > 0 && triangles[1] > triangles[0], `${name}, ${size.join(' x ')} beside three's own loader: of covered pixels ${
    over.map((share) => `${(100 * share).toFixed(2)}%`).join(', ')} are off by more than 2, 8, 24, 64 of 255, ${psnr.toFixed(1)} dB, ${triangles.join(' and ')} triangles`);
  await tab.close();
}
