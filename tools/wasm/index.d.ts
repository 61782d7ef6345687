// SPDX-License-Identifier: MIT
// Units: mesh space is the source mesh's; errors are distances in it; decoded positions are relative to Mesh.origin.

export const NONE: number;
export const INFINITE_ERROR: number;
export const STUCK_REASONS: readonly string[];
export const PROMISES: readonly PromiseKind[];
export const CODECS: readonly string[];
export const GROUP_TERMINAL: number;
export const GROUP_STUCK: number;

/** What a cut may be asked to be true of: positions; texture coordinates too; shading normals too. */
export type PromiseKind = 'position' | 'texels' | 'appearance';

export type Status = 'usage' | 'io' | 'invalid' | 'out_of_memory' | 'unsupported' | 'too_small';

/** What the runtime refuses, with its place in the message. */
export class MeshlodeError extends Error {
  readonly status: Status;
}

type Triple = [number, number, number];

export interface Mesh {
  name: string;
  origin: Triple;
  gridStep: number;
  /** Relative to origin, units of the mesh. */
  boundsMin: Triple;
  boundsMax: Triple;
  diagonal: number;
  level0Deviation: number;
  /** 0 qem, 1 measured, 2 certified. */
  errorTier: number;
  /** 0 none, 1 stored, 2 flat. */
  normalMode: number;
  normalScale: number;
  uvSetCount: number;
  hasColor: boolean;
  /** Per stored set: a unit of its integers is 2 to this power. */
  uvLog2: number[];
  uvSetSource: number[];
  /** Of every triangle; NONE: decoding says which. */
  material: number;
  sphereLog2: number;
  levelCount: number;
  sourceTriangles: number;
  sourceVertices: number;
  firstGroup: number;
  groupCount: number;
  firstCluster: number;
  clusterCount: number;
}

export interface Material {
  name: string;
  sourceIndex: number;
  /** 0 opaque, 1 mask, 2 blend. */
  alphaMode: number;
  baseColor: [number, number, number, number];
  alphaCutoff: number;
  doubleSided: boolean;
  baseColorTexture: number;
  baseColorUvSet: number;
}

export interface Instance {
  name: string;
  /** Mesh space to world, row-major 3x4. */
  transform: Float64Array;
  scale: number;
  mesh: number;
  node: number;
  flags: number;
}

export interface Group {
  center: Triple;
  radius: number;
  /** INFINITE_ERROR: never passes. */
  error: number;
  quadricError: number;
  deviation: number;
  normalDeviation: number;
  uvDeviation: number;
  firstCluster: number;
  mesh: number;
  page: number;
  clusterCount: number;
  level: number;
  flags: number;
  /** Into STUCK_REASONS. */
  stuckReason: number;
}

export interface Cluster {
  center: Triple;
  radius: number;
  coneAxis: Triple;
  coneCutoff: number;
  /** NONE at level 0. */
  ownGroup: number;
  coarserGroup: number;
  vertexCount: number;
  triangleCount: number;
  level: number;
}

export interface Page {
  offset: number;
  storedBytes: number;
  bytes: number;
  /** Into CODECS. */
  codec: number;
  firstGroup: number;
  groupCount: number;
  firstCluster: number;
  clusterCount: number;
}

/** An image or buffer of the source, as it was. */
export interface AssetBlob {
  name: string;
  /** Such as "image/png". */
  mimeType: string;
  /** From the start of the file. */
  offset: number;
  bytes: number;
  /** 1 image, 2 buffer. */
  kind: number;
  /** In the glTF's images or buffers. */
  sourceIndex: number;
}

export interface View {
  /** World space; of a perspective view. */
  eye?: Triple;
  isOrthographic?: boolean;
  /** Full vertical angle. */
  fovyRadians?: number;
  orthoHeight?: number;
  nearDistance: number;
  heightPx: number;
  /** By which errors the cut is made; left out: `position`. */
  promise?: PromiseKind;
}

export interface DecodedFloats {
  vertexCount: number;
  triangleCount: number;
  positions: Float32Array;
  normals: Float32Array | null;
  uvs: Float32Array[];
  colors: Float32Array | null;
  triangles: Uint8Array;
  triangleMaterials: Uint32Array;
}

export interface DecodedIntegers {
  vertexCount: number;
  triangleCount: number;
  channelCount: number;
  values: Int32Array;
  triangles: Uint8Array;
  triangleMaterials: Uint32Array;
}

/** Instances and clusters of a cut, of equal length, ascending by instance and cluster. */
export interface Cut {
  instances: Uint32Array;
  clusters: Uint32Array;
}

/** Six planes a, b, c, d: a point is inside where a x + b y + c z + d >= 0 for each; one of zeros has everything inside. */
export type Frustum = ArrayLike<number>;

/** Chooses what to draw of what is resident, and says what to load. The asset closes it at its own end; a closed one throws. */
export interface Selector {
  /**
   * Page p is resident where bit p % 32 of word p / 32 is set. What is drawn covers each piece of each instance's surface once where
   * the pages of terminal groups are resident, as finely as resident pages allow.
   */
  select(view: View, pixelError: number, resident: Uint32Array, frustum?: Frustum | null): Cut;
  /** Of the last selection: pages that it lacks, by falling priority, each behind those that it is of no use without. */
  readonly requests: { pages: Uint32Array; priorities: Float32Array };
  /** Of the last selection, of each page: what is lost without it, in pixels; 0: nothing; INFINITE_ERROR: keep it always. */
  readonly pagePriorities: Float32Array;
  close(): void;
}

/** Tables are read when they are first wanted. */
export interface Asset {
  readonly meshes: Mesh[];
  readonly materials: Material[];
  readonly instances: Instance[];
  readonly groups: Group[];
  readonly clusters: Cluster[];
  readonly pages: Page[];
  readonly blobs: AssetBlob[];
  /** Text of the asset as JSON, which opening does not check: throws MeshlodeError `invalid` where it is none; `scene` too. */
  readonly meta: unknown;
  readonly scene: unknown;
  /**
   * `meshes` and `groups` have the errors of positions; these are as they are, with those of a promise. Errors: unsupported, where the
   * asset was not built with it.
   */
  tablesOf(promise: PromiseKind): { meshes: Mesh[]; groups: Group[] };
  /** Throws where the asset was not built with a promise. */
  checkPromise(promise: PromiseKind): void;
  selectUniform(mesh: number, maxError: number, promise?: PromiseKind): { clusters: Uint32Array; storedError: number };
  selectView(view: View, pixelError: number, frustum?: Frustum | null): Cut;
  /** The view volume: four sides and the plane through the eye; `aspect` is width over height. */
  makeFrustum(view: View, target: Triple, up: Triple, aspect: number): Float64Array;
  createSelector(): Selector;
  pageOf(cluster: number): number;
  /** NONE if there is no such cluster. */
  meshOf(cluster: number): number;
  /** The most vertices and triangles of any cluster. */
  largestCluster(): { vertices: number; triangles: number };
  pageDependencies(page: number): Uint32Array;
  streamingOrder(promise?: PromiseKind): Uint32Array;
  /**
   * Ranges to read before the first picture, ascending: the pages of terminal groups of meshes with an instance that is not singular.
   * Pages with at most `maxGap` bytes between them share a range, and neighbours always do.
   */
  firstRanges(maxGap?: number): { offset: number; bytes: number }[];
  /** Errors: invalid, where the page is broken; unsupported, where its codec is not none or strips. */
  loadPage(page: number): void;
  /** loadPage from bytes of the caller, those of the page's `offset` and `storedBytes`. Errors: also usage, for another number. */
  unpackPage(page: number, stored: Uint8Array): void;
  dropPage(page: number): void;
  /** A copy of a loaded page, decoded, for decode.wgsl; undefined where it is not loaded. */
  pageBytes(page: number): Uint8Array | undefined;
  /** Loads the cluster's page where it is not loaded; of a head it must be. */
  decodeFloats(cluster: number): DecodedFloats;
  decodeIntegers(cluster: number): DecodedIntegers;
  /** A copy; empty if there is no such blob, or of a head. */
  blobBytes(blob: number): Uint8Array;
  /** Throws where bytes of the caller are not the blob's. */
  checkBlob(blob: number, bytes: Uint8Array): void;
  /** The glTF image of a glTF texture, and the blob that is a glTF image; NONE where there is none. */
  imageOfTexture(texture: number): number;
  blobOfImage(image: number): number;
  close(): void;
}

export interface Runtime {
  readonly formatVersion: number;
  /** Of the module, which never shrinks. */
  readonly memoryBytes: number;
  open(bytes: Uint8Array): Asset;
  /** How many of a file's first bytes openHead needs. Not known: `bytes` of them are needed to say it. */
  headBytes(first: Uint8Array, fileBytes: number): { bytes: number; isKnown: boolean };
  /** Opens an asset by its head; pages and images are the caller's to read: unpackPage, checkBlob. */
  openHead(bytes: Uint8Array, fileBytes: number): Asset;
}

export function loadRuntime(source?: BufferSource | WebAssembly.Module): Promise<Runtime>;
