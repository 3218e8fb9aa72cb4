// Constant-curvature kinematics, as scenarios/kernels/kinematics.py has them: frames along the backbone.

const MIN_BEND = 1e-6;

/** Frames {p, d, e, z} at `perSection` equal steps along each section, the base first; d, e, z are unit vectors. */
export function backbone(state, { n_sections, section_length_m }, perSection) {
  let p = [0, 0, 0];
  let x = [1, 0, 0];
  let y = [0, 1, 0];
  let z = [0, 0, 1];
  const frames = [{ p, x, y, z }];
  for (let i = 0; i < n_sections; i++) {
    const [u, v] = [state[2 * i], state[2 * i + 1]];
    const bend = Math.max(Math.hypot(u, v), MIN_BEND);
    const [c, s] = Math.hypot(u, v) < MIN_BEND ? [1, 0] : [u / bend, v / bend];
    const d = combine(c, x, s, y);
    const e = combine(-s, x, c, y);
    const radius = section_length_m / bend;
    const base = { p, z };
    for (let k = 1; k <= perSection; k++) {
      const [sin, cos] = [Math.sin((bend * k) / perSection), Math.cos((bend * k) / perSection)];
      p = add(base.p, combine(radius * (1 - cos), d, radius * sin, base.z));
      z = combine(sin, d, cos, base.z);
      const turned = combine(cos, d, -sin, base.z);
      x = combine(c, turned, -s, e); // the bend carries no twist
      y = combine(s, turned, c, e);
      frames.push({ p, x, y, z });
    }
  }
  return frames;
}

export function tip(state, arm) {
  return backbone(state, arm, 1).at(-1).p;
}

function combine(a, v, b, w) {
  return [a * v[0] + b * w[0], a * v[1] + b * w[1], a * v[2] + b * w[2]];
}

function add(v, w) {
  return [v[0] + w[0], v[1] + w[1], v[2] + w[2]];
}
