// SPDX-License-Identifier: MIT
// What meshlode/three and meshlode/webgpu share: the worker that streams, its options and what it reports.
import type { PromiseKind } from '../index.js';

/** A refusal with its place: a range of the file, 'head', 'page 3', 'image 0', 'camera', 'scene', 'options', 'shader', 'device' or 'worker'. */
export class LodeError extends Error {
  readonly place: string;
  readonly reason: string;
}

export interface StreamOptions {
  /** What a cut may be off, pixels of the target; 1. May be set later: lode.pixelError. */
  pixelError?: number;
  /** Widens the view by this share on each side, for turns faster than an answer; 0.1. */
  margin?: number;
  /** false: what is outside the view is drawn too, as shadows and mirrors may want. */
  isCulled?: boolean;
  /** What errors cover, of an asset that was built with it. */
  promise?: PromiseKind;
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

/** Of the worker's last answer. */
export interface StreamStatistics {
  /** Of the last selection, and of all pages so far. */
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
}
