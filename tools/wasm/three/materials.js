// SPDX-License-Identifier: MIT
// Materials of three from those of the asset: glTF's metallic-roughness model, and KHR_materials_unlit and _emissive_strength.
import * as THREE from 'three';

const WRAP = { 33071: THREE.ClampToEdgeWrapping, 33648: THREE.MirroredRepeatWrapping, 10497: THREE.RepeatWrapping };
const FILTER = {
  9728: THREE.NearestFilter, 9984: THREE.NearestMipmapNearestFilter, 9986: THREE.NearestMipmapLinearFilter,
  9729: THREE.LinearFilter, 9985: THREE.LinearMipmapNearestFilter, 9987: THREE.LinearMipmapLinearFilter,
};

export class Materials {
  /** In the order of the asset. */
  list;
  #scene;
  #isKtx2;
  #used = new Set(); // indices into `list` of those that are drawn
  #of = new Map(); // material of `list` -> itself and its clones
  #users = new Map(); // glTF image -> functions that take its Texture
  #textures = [];

  constructor(records, scene, isKtx2) {
    this.#scene = scene ?? {};
    this.#isKtx2 = isKtx2;
    this.list = records.map((record) => this.#create(record));
  }
  /** glTF images that the materials use, each once. */
  get images() {
    return [...this.#users.keys()];
  }

  /** The material for a mesh with or without normals and colours. */
  variant(index, isFlat, hasColor) {
    const all = this.#of.get(this.list[index]);
    const isUsed = this.#used.has(index);
    const found = all.find((one) => isUsed && one.flatShading === isFlat && one.vertexColors === hasColor);
    if (found) return found;
    if (isUsed) all.push(this.list[index].clone());
    this.#used.add(index);
    return Object.assign(all.at(-1), { flatShading: isFlat, vertexColors: hasColor });
  }

  /** Sets an image in all materials that use it, by clones of the texture. */
  setImage(image, texture) {
    this.#textures.push(texture);
    for (const use of this.#users.get(image) ?? []) use(texture);
  }

  dispose() {
    for (const one of [...[...this.#of.values()].flat(), ...this.#textures]) one.dispose();
    for (const { image } of this.#textures) image?.close?.();
  }

  #create({ name, sourceIndex, alphaMode, alphaCutoff, doubleSided, baseColor }) {
    const json = this.#scene.materials?.[sourceIndex] ?? {};
    const pbr = json.pbrMetallicRoughness ?? {};
    const extensions = json.extensions ?? {};
    const isUnlit = extensions.KHR_materials_unlit !== undefined;
    const material = isUnlit ? new THREE.MeshBasicMaterial() : new THREE.MeshStandardMaterial();
    this.#of.set(material, [material]);
    material.name = name;
    material.color.setRGB(baseColor[0], baseColor[1], baseColor[2], THREE.LinearSRGBColorSpace);
    const isBlend = alphaMode === 2;
    Object.assign(material, { opacity: alphaMode === 0 ? 1 : baseColor[3], transparent: isBlend, depthWrite: !isBlend });
    if (alphaMode === 1) material.alphaTest = alphaCutoff;
    material.side = doubleSided ? THREE.DoubleSide : THREE.FrontSide;
    this.#show(material, pbr.baseColorTexture, ['map'], THREE.SRGBColorSpace);
    if (isUnlit) return material;
    const { metallicFactor: metalness = 1, roughnessFactor: roughness = 1 } = pbr;
    Object.assign(material, { metalness, roughness });
    if (this.#show(material, pbr.metallicRoughnessTexture, ['metalnessMap', 'roughnessMap'], '', { metalness, roughness })) {
      Object.assign(material, { metalness: 0, roughness: 1 }); // a metal would be black until its image is loaded
    }
    this.#show(material, json.normalTexture, ['normalMap']);
    // Without tangents three derives them with v downwards; its own loader flips the scale too.
    material.normalScale.set(1, -1).multiplyScalar(json.normalTexture?.scale ?? 1);
    this.#show(material, json.occlusionTexture, ['aoMap']);
    material.aoMapIntensity = json.occlusionTexture?.strength ?? 1;
    const emission = new THREE.Color().setRGB(...(json.emissiveFactor ?? [0, 0, 0]), THREE.LinearSRGBColorSpace);
    material.emissiveIntensity = extensions.KHR_materials_emissive_strength?.emissiveStrength ?? 1;
    if (!this.#show(material, json.emissiveTexture, ['emissiveMap'], THREE.SRGBColorSpace, { emissive: emission })) {
      material.emissive = emission;
    }
    return material;
  }

  /** Sets the texture in `slots`, and `factors`, once its image is loaded; false where there is no texture. */
  #show(material, use, slots, colorSpace = THREE.NoColorSpace, factors = {}) {
    const texture = this.#scene.textures?.[use?.index];
    const image = texture && this.#imageOf(texture);
    if (!(image >= 0)) return false;
    if (!this.#users.has(image)) this.#users.set(image, []);
    this.#users.get(image).push((source) => {
      const made = this.#createTexture(source, texture, use, colorSpace);
      for (const one of this.#of.get(material)) {
        for (const slot of slots) one[slot] = made;
        Object.assign(one, factors);
        one.needsUpdate = true;
      }
    });
    return true;
  }

  #imageOf({ source, extensions = {} }) {
    const ktx2 = this.#isKtx2 ? extensions.KHR_texture_basisu?.source : undefined;
    const other = extensions.EXT_texture_webp?.source ?? extensions.EXT_texture_avif?.source;
    return ktx2 ?? other ?? source ?? extensions.KHR_texture_basisu?.source;
  }
  #createTexture(source, texture, use, colorSpace) {
    const made = source.clone();
    this.#textures.push(made);
    const sampler = this.#scene.samplers?.[texture.sampler] ?? {};
    const transform = use.extensions?.KHR_texture_transform ?? {};
    const [wrapS, wrapT] = [sampler.wrapS, sampler.wrapT].map((wrap) => WRAP[wrap] ?? THREE.RepeatWrapping);
    const magFilter = FILTER[sampler.magFilter] ?? THREE.LinearFilter;
    const minFilter = FILTER[sampler.minFilter] ?? THREE.LinearMipmapLinearFilter;
    Object.assign(made, { colorSpace, flipY: false, wrapS, wrapT, magFilter, minFilter, rotation: transform.rotation ?? 0 });
    if (made.isCompressedTexture && made.mipmaps.length < 2) made.minFilter = THREE.LinearFilter; // a GPU makes no mip levels of these
    made.channel = Math.max(0, [0, 1, 2, 3].indexOf(transform.texCoord ?? use.texCoord));
    made.offset.fromArray(transform.offset ?? [0, 0]);
    made.repeat.fromArray(transform.scale ?? [1, 1]);
    made.needsUpdate = true;
    return made;
  }
}
