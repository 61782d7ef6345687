// SPDX-License-Identifier: MIT
import type { Box3, Camera, Material, Object3D, Object3DEventMap, WebGLRenderer } from 'three';
import type { Cut, Frustum, View } from '../index.js';
import type { StreamOptions, StreamStatistics } from '../stream/source.js';

export { LodeError } from '../stream/source.js';

export interface LodeOptions extends StreamOptions {
  /** Bytes of vertices and indices of resident pages; 256 MiB. The buffers may be larger, and the coarsest geometry is always kept. */
  poolBytes?: number;
  /** Reads images of the type image/ktx2: three's KTX2Loader, after detectSupport(). */
  ktx2Loader?: { parse(buffer: ArrayBuffer, onLoad: (texture: any) => void, onError?: (error: any) => void): void };
}

export interface LodeStatistics extends StreamStatistics {
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
