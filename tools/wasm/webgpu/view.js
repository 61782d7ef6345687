// SPDX-License-Identifier: MIT
// From a camera and an instance, in doubles, to the floats that a GPU takes. metricView() is src/run/select/view.cpp again: the
// rounding of each number is derived in docs/reference/selection.md.

const GROWTH = 1 + 2 ** -20;
const [LEAST_NEAR, MOST_NEAR] = [2 ** -40, 2 ** 61];
const [LEAST_FACTOR, MOST_FACTOR] = [2 ** -126, 2 ** 126];
const SCALED_EXPONENT = 30;

const bits = new DataView(new ArrayBuffer(8));
/** The smallest float that is not below a value of at least 0. */
function floatAbove(value) {
  const nearest = Math.fround(value);
  if (!(nearest < value)) return nearest;
  bits.setFloat32(0, nearest);
  bits.setUint32(0, bits.getUint32(0) + 1);
  return bits.getFloat32(0);
}
/** The exponent e of frexp: value = m 2^e, m in [1/2, 1). Of normal numbers; those below are far below any length. */
function exponentOf(value) {
  bits.setFloat64(0, value);
  return ((bits.getUint32(0) >>> 20) & 0x7ff) - 1022;
}
const clampOrHigh = (value, low, high) => (value < high ? Math.max(value, low) : high);
const isLength = (value) => value > 0 && Number.isFinite(value);

function chooseUnit(largest, sigma) {
  if (!isLength(largest)) return 1;
  let exponent = SCALED_EXPONENT - exponentOf(largest);
  if (isLength(sigma)) exponent = Math.min(exponent, 100 - exponentOf(sigma));
  return 2 ** Math.min(Math.max(exponent, -1000), 1000);
}

/** Where the mesh's origin is, relative to `from`, in the order of operations of the runtime. */
function originOf({ transform: m }, { origin: o }, from) {
  return [0, 4, 8].map((k, i) => m[k] * o[0] + m[k + 1] * o[1] + m[k + 2] * o[2] + (m[k + 3] - from[i]));
}

/** Fifteen floats of MetricView: rows, scale, error_scale, near_distance. */
export function metricView(view, pixelError, instance, mesh, reach) {
  const out = new Float32Array(15);
  if (!(pixelError > 0)) {
    out.set([MOST_FACTOR, LEAST_NEAR], 13);
    return out;
  }
  const sigma = instance.scale;
  const pixels = view.isOrthographic ? view.heightPx / view.orthoHeight : view.heightPx / (2 * Math.tan(0.5 * view.fovyRadians));
  const pixelsPerError = pixels / pixelError;
  if (view.isOrthographic) {
    out.set([floatAbove(clampOrHigh(sigma * pixelsPerError * GROWTH, LEAST_FACTOR, MOST_FACTOR)), 1], 13);
    return out;
  }
  const translation = originOf(instance, mesh, view.eye);
  const [x, y, z] = translation;
  const unit = chooseUnit(Math.max(sigma * reach, Math.sqrt(x * x + y * y + z * z)), sigma);
  for (let i = 0; i < 3; ++i) {
    for (let k = 0; k < 3; ++k) out[4 * i + k] = instance.transform[4 * i + k] * unit;
    out[4 * i + 3] = translation[i] * unit;
  }
  out[12] = floatAbove(clampOrHigh(sigma * unit * GROWTH, 0, MOST_FACTOR));
  out[13] = floatAbove(clampOrHigh(sigma * pixelsPerError * unit * GROWTH, LEAST_FACTOR, MOST_FACTOR));
  out[14] = clampOrHigh(view.nearDistance * unit, LEAST_NEAR, MOST_NEAR);
  return out;
}

/** Twelve floats: rows from object units relative to the mesh's origin to the world relative to the eye. */
export function worldRows(eye, instance, mesh) {
  const moved = originOf(instance, mesh, eye);
  return Float32Array.from({ length: 12 }, (_, k) => (k % 4 === 3 ? moved[k >> 2] : instance.transform[k]));
}
/** Sixteen floats, columns: from object units to clip space. `viewProjection`: of the world, columns. */
export function clipMatrix(viewProjection, instance, mesh) {
  const origin = originOf(instance, mesh, [0, 0, 0]);
  const out = new Float32Array(16);
  for (let column = 0; column < 4; ++column) {
    const [x, y, z] = column === 3 ? origin : [0, 4, 8].map((k) => instance.transform[k + column]);
    for (let k = 0; k < 4; ++k) {
      out[4 * column + k] = viewProjection[k] * x + viewProjection[4 + k] * y + viewProjection[8 + k] * z + (column === 3 ? viewProjection[12 + k] : 0);
    }
  }
  return out;
}

/** Six planes, 24 numbers: four sides, each wider by `margin` of the view, and the plane through the eye. */
export function frustumOf(viewProjection, margin) {
  const side = 1 / (1 + margin);
  const row = (k, sign) => [0, 4, 8, 12].map((at) => viewProjection[at + 3] + sign * side * (k < 3 ? viewProjection[at + k] : 0));
  return [row(0, 1), row(0, -1), row(1, 1), row(1, -1), row(3, 0), [0, 0, 0, 0]].flat();
}
