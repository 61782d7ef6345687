// SPDX-License-Identifier: MIT
import type { Box3, Camera, Material, Object3D, Object3DEventMap, WebGLRenderer } from 'three';
import type { Cut, Frustum, PromiseKind, View } from '../index.js';

/** A refusal with its place: a range of the file, 'head', 'page 3', 'image 0', 'camera', 'options' or 'worker'. */
export class LodeError extends Error {
  readonly place: string;
  readonly reason: string;
}

export interface LodeOptions {
  /** What a cut may be off on the screen; 1. May be set later: lode.pixelError. */
  pixelError?: number;
  /** Bytes of vertices and indices of resident pages; 256 MiB. The buffers may be larger, and the coarsest geometry is always kept. */
  poolBytes?: number;
  /** Widens the view volume by this share on each side, for turns faster than an answer; 0.1. */
  margin?: number;
  /** false: what is outside the view is drawn too, as shadows and mirrors may want. */
  isCulled?: boolean;
  /** What errors cover, of an asset that was built with it. */
  promise?: PromiseKind;
  /** Reads images of the type image/ktx2: three's KTX2Loader, after detectSupport(). */
  ktx2Loader?: { parse(buffer: ArrayBuffer, onLoad: (texture: any) => void, onError?: (error: any) => void): void };
  /** Of each request. */
  headers?: Record<string, string>;
  credentials?: RequestCredentials;
  /** Within which 64 KiB of a request have to come; 30,000. Infinity: no limit. */
  timeoutMs?: number;
  /** Where a bundler or an origin wants another worker than stream/worker.js of this package. */
  createWorker?: () => Worker;
  /** The compiled meshlode.wasm, where it does not lie beside index.js. */
  module?: WebAssembly.Module;
}

export interface LodeStatistics {
  /** Of the last selection, and of all pages so far, in the worker. */
  selectMs: number;
  unpackMs: number;
  /** Memory of the worker's module. */
  moduleBytes: number;
  bytesRead: number;
  fileBytes: number;
  requests: number;
  /** Of poolBytes. */
  poolUsed: number;
  /** Pages that the view wants and that are not there. */
  missing: number;
  /** Pages that could not be had, or are of no use without one that could not. */
  failed: number;
  /** Whether more is wanted than the pool holds. */
  isFull: boolean;
  isLoading: boolean;
  pages: number;
  residentPages: number;
  drawnClusters: number;
}

export interface LodeEventMap extends Object3DEventMap {
  /** What is drawn has changed: who draws on demand draws now. */
  change: {};
  progress: { loaded: number; total: number; missing: number; isFull: boolean; isComplete: boolean };
  statistics: { statistics: LodeStatistics };
  /** isFatal: nothing more is loaded. Without a listener it goes to the console. */
  error: { place: string; message: string; isFatal: boolean; page?: number; image?: number };
}

/** Its children are BatchedMesh; `userData.shown[batchId]` is {cluster, instance, isVisible}, for picking and for colours of clusters. */
export class Lode extends Object3D<LodeEventMap> {
  pixelError: number;
  /** Of all instances, in the space of this object. */
  readonly boundingBox: Box3;
  /** Of the asset: to be changed before they are first drawn. */
  readonly materials: Material[];
  /** What is drawn, and what it was chosen by; null before the first selection. */
  readonly drawn: (Cut & { view: View; frustum: Frustum | null; pixelError: number; resident: Uint32Array }) | null;
  readonly statistics: LodeStatistics | null;
  /** Whether the last camera is answered and nothing is being loaded. */
  readonly isSettled: boolean;
  /** To be called before each frame. */
  update(camera: Camera, renderer: WebGLRenderer): void;
  /** Asks again for pages that failed. */
  retry(): void;
  /** Ends the worker and frees what was given to the GPU. */
  dispose(): void;
}

/** Opens an asset: an address, or a Blob such as a dropped file. Rejects with a LodeError. */
export function loadLode(file: string | URL | Blob, options?: LodeOptions): Promise<Lode>;
