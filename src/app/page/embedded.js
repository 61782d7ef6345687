// SPDX-License-Identifier: MIT
// The page of info --html: the viewer of docs/examples/viewer with an asset that the page holds itself. All its pages are there at
// once, so it also cuts by one error everywhere; nothing is asked of a network.
import { NONE, loadRuntime } from 'meshlode';
import { countTriangles, restrictCut } from './dag.js';
import { Address } from './address.js';
import { boundsOf } from './orbit.js';
import { Viewer, byId, count, number, say, short } from './viewer.js';
import { MeshView } from './mesh_view.js';

const FIRST_FRAME_TRIANGLES = 100000;
const MOST_TRIANGLES = 1500000;
const ERROR_STEPS = 400;
const COARSEST_STEP = 60; // of the slider of pixels

function decodeBase64(text, into, at) {
  const bytes = atob(text);
  for (let i = 0; i < bytes.length; ++i) into[at + i] = bytes.charCodeAt(i);
}

class EmbeddedViewer extends Viewer {
  constructor(facts, asset, address) {
    super(facts, asset, address);
    this.mesh = -1; // the whole scene
    try {
      this.view = new MeshView(byId('mesh-view'), asset, {
        onSelect: (cluster) => this.select(cluster),
        onMove: () => this.cameraMoved(),
        onResize: () => this.cameraMoved(),
      });
    } catch (error) {
      byId('mesh-view').hidden = true;
      byId('mesh-keys').textContent = `No 3D: ${error.message}.`;
      document.querySelector('input[value=camera]').disabled = true;
      document.querySelector('input[value=uniform]').checked = true;
      byId('png').disabled = true;
    }
  }

  connect(prefersDark) {
    super.connect(prefersDark);
    this.on(byId('error'), 'input', () => this.recut());
    this.on(byId('error'), 'input', () => this.address.set({ error: byId('error').value }));
    for (const radio of document.querySelectorAll('input[name=cut]')) {
      this.on(radio, 'change', () => {
        this.showSlider();
        this.recut();
        this.address.set({ cut: this.isCameraCut() ? null : 'uniform' });
      });
    }
  }
  restore() {
    if (this.address.text('cut') === 'uniform') document.querySelector('input[value=uniform]').checked = true;
    const step = this.address.integer('error', 0, ERROR_STEPS);
    if (step !== null) byId('error').value = String(step);
    this.showSlider();
    super.restore();
  }

  showSlider() {
    byId('error-label').hidden = this.isCameraCut();
    byId('pixels-label').hidden = !this.isCameraCut();
  }

  // ------------------------------------------------------------------------------------------------------------- cuts

  /** Which transforms the shown meshes have: [{mesh, transform, instance}]; a mesh that is nowhere is shown as it is. */
  shown() {
    const of = (instance, i) => ({ mesh: instance.mesh, transform: instance.transform, instance: i });
    const all = this.asset.instances.map(of).filter(({ instance }) => (this.asset.instances[instance].flags & 2) === 0);
    if (this.mesh < 0) return all;
    const one = all.find(({ mesh }) => mesh === this.mesh);
    return [one ?? { mesh: this.mesh, transform: null, instance: NONE }];
  }

  isCameraCut() {
    return document.querySelector('input[name=cut]:checked').value === 'camera';
  }

  showMesh(mesh) {
    this.mesh = mesh;
    byId('mesh').value = String(mesh);
    this.showGraph(mesh < 0 ? this.shown()[0]?.mesh ?? 0 : mesh);
    this.view?.frame(boundsOf(this.asset, this.shown()));
    byId('error').value = String(this.firstStep());
    if (this.view) byId('pixels').value = String(this.firstPixels());
    this.showSlider();
    this.recut();
  }

  /** Of the uniform cut: step 0 is no error, then from 10^-6 to 1 of each mesh's diagonal. */
  relativeError(step) {
    return step === 0 ? 0 : 10 ** ((6 * step) / ERROR_STEPS - 6);
  }

  uniformCut(step) {
    const cuts = new Map();
    return this.shown().map((shown) => {
      if (!cuts.has(shown.mesh)) {
        const error = this.relativeError(step) * this.asset.meshes[shown.mesh].diagonal;
        const { clusters, storedError } = this.asset.selectUniform(shown.mesh, error);
        cuts.set(shown.mesh, { clusters: restrictCut(this.asset, this.made, this.present, clusters), storedError });
      }
      return { ...shown, ...cuts.get(shown.mesh) };
    });
  }

  cameraCut(pixels) {
    const { instances, clusters } = this.asset.selectView(this.view.view(), pixels);
    const byInstance = new Map();
    instances.forEach((instance, i) => {
      if (!byInstance.has(instance)) byInstance.set(instance, []);
      byInstance.get(instance).push(clusters[i]);
    });
    return this.shown().map((shown) => ({
      ...shown,
      storedError: null,
      clusters: restrictCut(this.asset, this.made, this.present, byInstance.get(shown.instance) ?? []),
    }));
  }

  triangles(cut) {
    return cut.reduce((sum, part) => sum + countTriangles(this.asset, part.clusters), 0);
  }

  /** The finest step within the triangles of a first frame. */
  firstStep(most = FIRST_FRAME_TRIANGLES) {
    let low = -1;
    let high = ERROR_STEPS;
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (this.triangles(this.uniformCut(middle)) <= most) high = middle;
      else low = middle;
    }
    return high;
  }

  /** From one pixel on, the smallest step within the triangles of a first frame. */
  firstPixels() {
    for (let step = 0; step < COARSEST_STEP; ++step) {
      if (this.triangles(this.cameraCut(2 ** (step / 10))) <= FIRST_FRAME_TRIANGLES) return step;
    }
    return COARSEST_STEP;
  }

  recut() {
    const step = Number(byId('error').value);
    say('error', step === 0 ? 'finest' : `${short(this.relativeError(step))} of the diagonal`);
    this.sayPixels();
    const isCamera = this.isCameraCut() && this.view !== null;
    let cut = isCamera ? this.cameraCut(this.pixelError) : this.uniformCut(step);
    let note = '';
    if (this.triangles(cut) > MOST_TRIANGLES) {
      note = ` Shown coarser: ${number(this.triangles(cut))} triangles are more than this page draws.`;
      cut = this.uniformCut(this.firstStep(MOST_TRIANGLES));
    }
    this.graph.inCut = new Set(cut.flatMap((part) => Array.from(part.clusters)));
    this.graph.draw();
    const items = cut.flatMap(({ mesh, transform, clusters }) =>
      Array.from(clusters, (cluster) => ({ cluster, transform, origin: this.asset.meshes[mesh].origin })),
    );
    this.view?.setCut(items);
    const worst = cut.reduce((most, part) => Math.max(most, part.storedError ?? 0), 0);
    const error = isCamera ? '' : `, stored error ${short(worst)}`;
    byId('cut-text').textContent =
      `${count(items.length, 'cluster')}, ${count(this.triangles(cut), 'triangle')}${error}.${note}`;
  }

  cameraMoved() {
    clearTimeout(this.timer);
    this.timer = setTimeout(() => {
      if (this.isCameraCut()) this.recut();
      if (this.view.hasMoved) this.keepCamera();
    }, 60);
  }
}

async function main() {
  const facts = JSON.parse(byId('facts').textContent);
  const module = byId('runtime').textContent;
  const code = new Uint8Array((module.length / 4) * 3 - (module.endsWith('==') ? 2 : module.endsWith('=') ? 1 : 0));
  decodeBase64(module, code, 0);
  const runtime = await loadRuntime(code);
  const file = new Uint8Array(facts.embedded_file_bytes);
  for (const piece of document.querySelectorAll('script.piece')) {
    decodeBase64(piece.textContent, file, Number(piece.dataset.at));
    piece.remove();
  }
  // What this page cannot do: it holds no images, and streams nothing.
  for (const streamed of document.querySelectorAll('[data-only=streamed]')) streamed.remove();
  byId('measure').value = 'cluster';
  const viewer = new EmbeddedViewer(facts, runtime.open(file), new Address());
  viewer.start();
  viewer.view?.drawNow();
  window.meshlodeViewer = viewer; // for a console, and for tests
  // When it is on the screen: a task after the frame that it is drawn in.
  requestAnimationFrame(() =>
    setTimeout(() => {
      document.documentElement.dataset.firstFrameMs = String(Math.round(performance.now()));
    }),
  );
}

main().catch((error) => {
  byId('summary').textContent = `This page cannot show its asset: ${error.message}`;
  document.documentElement.dataset.failed = 'yes';
  throw error;
});
