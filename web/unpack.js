// Arrays as suite/show/replay/packed.py writes them: second differences, deflated, base64.

async function inflate(text) {
  const bytes = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Response(stream).arrayBuffer();
}

/** Rows of numbers: {rows, width, values: Float64Array}, row after row. */
export async function unpack({ shape, low, step, bits, data }) {
  const Levels = bits === 32 ? Uint32Array : Uint16Array;
  const raw = new Levels(await inflate(data));
  const width = shape.slice(1).reduce((a, b) => a * b, 1);
  const values = new Float64Array(raw.length);
  const level = new Levels(width);
  const slope = new Levels(width);
  for (let k = 0; k < raw.length; k++) {
    const i = k % width;
    slope[i] += raw[k]; // wraps around, as it was written
    level[i] += slope[i];
    values[k] = low + step * level[i];
  }
  return { rows: shape[0], width, values };
}

/** Index of the last of ascending `values` that is at or before `x`; 0 before the first. */
export function before(values, x) {
  let low = 0;
  let high = values.length - 1;
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (values[middle] <= x + 1e-9) low = middle;
    else high = middle - 1;
  }
  return low;
}

/** The row at fractional index `at`, linear between rows, the ends beyond them. */
export function rowAt({ rows, width, values }, at, first = 0, count = rows) {
  const inside = Math.min(Math.max(at, 0), count - 1);
  const k = first + Math.min(Math.floor(inside), Math.max(count - 2, 0));
  const share = inside + first - k;
  const row = new Array(width);
  for (let i = 0; i < width; i++) {
    const here = values[k * width + i];
    row[i] = share > 0 ? here + share * (values[(k + 1) * width + i] - here) : here;
  }
  return row;
}
