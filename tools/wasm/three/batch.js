// SPDX-License-Identifier: MIT
// A BatchedMesh as a pool: a slot of equal size per resident cluster, an instance of three per drawn cluster. Only documented
// functions of three are used. Slots and instances are reused and never deleted, because three sorts its free lists at each deletion.
import * as THREE from 'three';

const FIRST_SLOTS = 1; // most materials of a scene of many have few clusters; growth by half copies each byte three times at most
const MOST_SLOTS = 32768; // three passes all geometries of a batch as arguments of one call; engines take about 100,000
const grown = (count) => Math.ceil(count * 1.5);

export class Batch {
  object;
  #uvNames;
  #slot;
  #slots = 0; // in use or free
  #slotCapacity = FIRST_SLOTS;
  #free = [];
  #shown = []; // per instance of three: its slot, cluster and instance of the asset, whether it is visible
  #used = 0;

  /** `uvSets`: TEXCOORD_n of each stored set; `slot`: the most vertices and triangles of a cluster. */
  constructor(material, uvSets, slot, isMirrored) {
    this.#slot = { vertices: slot.vertices, indices: 3 * slot.triangles };
    this.#uvNames = uvSets.map((set) => (set === 0 ? 'uv' : `uv${set}`));
    const { vertices, indices } = this.#slot;
    this.object = new THREE.BatchedMesh(FIRST_SLOTS, FIRST_SLOTS * vertices, FIRST_SLOTS * indices, material);
    const [{ name, transparent: sortObjects }, userData] = [material, { shown: this.#shown }];
    Object.assign(this.object, { name, userData, sortObjects, frustumCulled: false, perObjectFrustumCulled: false }); // the worker culls
    // three flips the winding by the determinant of an object, not of an instance: mirrored instances are mirrored twice.
    if (isMirrored) this.object.scale.set(-1, 1, 1);
  }

  /** Copies the triangles of a cluster into a slot, and returns it. */
  put({ positions, normals, uvs, colors }, triangles) {
    const geometry = new THREE.BufferGeometry();
    const set = (name, array, size) => geometry.setAttribute(name, new THREE.BufferAttribute(array, size));
    set('position', positions, 3);
    if (normals) set('normal', normals, 3);
    uvs.forEach((array, k) => set(this.#uvNames[k], array, 2));
    if (colors) set('color', colors, 4);
    geometry.setIndex(new THREE.BufferAttribute(triangles, 1));
    const free = this.#free.pop();
    if (free !== undefined) {
      this.object.setGeometryAt(free, geometry);
      return free;
    }
    const { vertices, indices } = this.#slot;
    if (this.#slots === this.#slotCapacity) {
      this.#slotCapacity = Math.min(grown(this.#slotCapacity), MOST_SLOTS);
      this.object.setGeometrySize(this.#slotCapacity * vertices, this.#slotCapacity * indices);
    }
    ++this.#slots;
    return this.object.addGeometry(geometry, vertices, indices);
  }
  drop(slot) {
    this.#free.push(slot);
  }
  get isFull() {
    return this.#slots === MOST_SLOTS && this.#free.length === 0;
  }
  get isEmpty() {
    return this.#slots === this.#free.length;
  }

  /** show() is called between begin() and end() for each cluster that is drawn. */
  begin() {
    this.#used = 0;
  }
  show(slot, cluster, instance, matrix) {
    const id = this.#used++;
    let shown = this.#shown[id];
    if (!shown) {
      if (id === this.object.maxInstanceCount) this.object.setInstanceCount(grown(id));
      this.object.addInstance(slot);
      shown = this.#shown[id] = { slot, instance: -1, isVisible: true };
    }
    // Earlier versions of three update the draw list only when a visibility changes.
    if (shown.slot !== slot) this.object.setGeometryIdAt(id, slot).setVisibleAt(id, false);
    if (shown.instance !== instance) this.object.setMatrixAt(id, matrix);
    this.object.setVisibleAt(id, true);
    Object.assign(shown, { slot, cluster, instance, isVisible: true });
  }
  end() {
    for (let id = this.#used; id < this.#shown.length && this.#shown[id].isVisible; ++id) {
      this.object.setVisibleAt(id, false);
      this.#shown[id].isVisible = false;
    }
  }
  dispose() {
    this.object.removeFromParent();
    this.object.dispose();
  }
}
