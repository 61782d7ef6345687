// SPDX-License-Identifier: MIT
// GPUDevice and others: of TypeScript's DOM library; before they were in it, of @webgpu/types.
import type { Cut, View } from '../index.js';
import type { StreamOptions, StreamStatistics } from '../stream/source.js';

export { LodeError } from '../stream/source.js';

export interface LodeFault {
  place: string;
  message: string;
  /** Nothing more is loaded. */
  isFatal: boolean;
  page?: number;
}

export interface LodeOptions extends StreamOptions {
  /** Of the colour target. */
  format: GPUTextureFormat;
  /** Of the depth target; depth24plus. */
  depthFormat?: GPUTextureFormat;
  /** less; greater where depths are reversed. */
  depthCompare?: GPUCompareFunction;
  sampleCount?: number;
  /** WGSL with `fn shade(s: Surface, base: vec4f) -> vec4f`; Surface is in draw.wgsl. Left out: a light from the eye. */
  shade?: string;
  /** Of bind groups 1 and up, which `shade` reads. The caller sets them before draw(). */
  bindGroupLayouts?: GPUBindGroupLayout[];
  /** Bytes of decoded pages on the GPU; 64 MiB, and at most three quarters of what the device binds. The coarsest pages are always kept. */
  poolBytes?: number;
  /** Of faults after opening; left out, they go to the console. */
  onError?: (fault: LodeFault) => void;
  /** Pages have come: draw now, if you draw on demand. */
  onChange?: () => void;
}

export type Statistics = StreamStatistics;

export interface Frame {
  /** Of the camera, in the asset's world; heightPx of the target. An orthographic view has an eye too: the surface is relative to it. */
  view: View & { eye: [number, number, number] };
  /** World to clip space, 16 numbers, columns; depths as the pipeline's depthCompare takes them. Doubles keep far places exact. */
  viewProjection: ArrayLike<number>;
}

export class Lode {
  pixelError: number;
  readonly statistics: Statistics | null;
  /** Whether the last view is answered, nothing is being loaded and all that came is selected from. */
  readonly isSettled: boolean;
  /** Pages that the last select() chose from: page p is bit p % 32 of word p / 32. */
  readonly resident: Uint32Array;
  /** Encodes the selection of a frame. Submit it before the next frame's select(). Throws a LodeError where the view has no eye. */
  select(encoder: GPUCommandEncoder, frame: Frame): void;
  /** Encodes one indirect draw of what the frame selected. Sets the pipeline and bind group 0. */
  draw(pass: GPURenderPassEncoder | GPURenderBundleEncoder): void;
  /** What the last submitted selection chose. Waits for the GPU: for tests and tools. */
  readDrawn(): Promise<Cut>;
  /** Requests failed pages again. */
  retry(): void;
  /** Ends the worker and frees GPU memory. */
  dispose(): void;
}

/** A device whose buffers may be as large as the adapter allows. Null where there is no WebGPU: draw with meshlode/three there. */
export function requestDevice(options?: GPURequestAdapterOptions): Promise<GPUDevice | null>;
/** Opens an asset: an address, or a Blob such as a dropped file. Rejects with a LodeError. */
export function openLode(device: GPUDevice | null, file: string | URL | Blob, options: LodeOptions): Promise<Lode>;
