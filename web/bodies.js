// Things in the scene: a tube for the arm, obstacles of every shape, lines, labels.

import * as THREE from "three";
import { Line2 } from "three/addons/lines/Line2.js";
import { LineGeometry } from "three/addons/lines/LineGeometry.js";
import { LineMaterial } from "three/addons/lines/LineMaterial.js";
import { SECTIONS } from "./look.js";

const AROUND = 20;

/** The arm's body: rings about the backbone, coloured by section, with a round end. */
export class Tube {
  constructor(arm, perSection, { opacity = 1 } = {}) {
    this.rings = arm.n_sections * perSection + 1;
    this.radius = arm.radius_m;
    const geometry = new THREE.BufferGeometry();
    this.positions = new Float32Array(this.rings * AROUND * 3);
    this.normals = new Float32Array(this.rings * AROUND * 3);
    geometry.setAttribute("position", new THREE.BufferAttribute(this.positions, 3));
    geometry.setAttribute("normal", new THREE.BufferAttribute(this.normals, 3));
    geometry.setIndex(tubeIndex(this.rings));
    for (let i = 0; i < arm.n_sections; i++) geometry.addGroup(i * perSection * AROUND * 6, perSection * AROUND * 6, i);
    const materials = Array.from({ length: arm.n_sections }, (_, i) =>
      material(SECTIONS[i % SECTIONS.length], opacity),
    );
    this.body = new THREE.Mesh(geometry, materials);
    this.body.frustumCulled = false;
    this.end = new THREE.Mesh(new THREE.SphereGeometry(arm.radius_m, AROUND, 12), materials.at(-1));
    this.group = new THREE.Group().add(this.body, this.end);
  }

  bend(frames) {
    frames.forEach(({ p, x, y }, ring) => {
      for (let k = 0; k < AROUND; k++) {
        const angle = (2 * Math.PI * k) / AROUND;
        const [c, s] = [Math.cos(angle), Math.sin(angle)];
        for (let i = 0; i < 3; i++) {
          const normal = c * x[i] + s * y[i];
          const at = 3 * (ring * AROUND + k) + i;
          this.normals[at] = normal;
          this.positions[at] = p[i] + this.radius * normal;
        }
      }
    });
    for (const name of ["position", "normal"]) this.body.geometry.attributes[name].needsUpdate = true;
    this.end.position.set(...frames.at(-1).p);
  }

  /** Let one section, counted from 1, glow; none with 0. */
  mark(section) {
    this.body.material.forEach((each, i) => each.emissive.set(i + 1 === section ? "#b01800" : "#000000"));
  }
}

function tubeIndex(rings) {
  const index = [];
  for (let ring = 0; ring + 1 < rings; ring++)
    for (let k = 0; k < AROUND; k++) {
      const [a, b] = [ring * AROUND + k, ring * AROUND + ((k + 1) % AROUND)];
      index.push(a, b, a + AROUND, b, b + AROUND, a + AROUND);
    }
  return index;
}

export function material(color, opacity = 1) {
  return new THREE.MeshStandardMaterial({
    color,
    roughness: 0.62,
    opacity,
    transparent: opacity < 1,
    depthWrite: opacity === 1,
  });
}

/** An obstacle's geometry about its centre, turned as it always is. */
export function shapeGeometry(shape, radius = shape.radius) {
  const made = {
    sphere: () => new THREE.SphereGeometry(radius, 32, 20),
    box: () => new THREE.BoxGeometry(...(shape.size_m ?? [])),
    capsule: () => new THREE.CapsuleGeometry(shape.radius_m, shape.length_m, 10, 24).rotateX(Math.PI / 2), // along z
    cylinder: () => new THREE.CylinderGeometry(shape.radius_m, shape.radius_m, shape.length_m, 32).rotateX(Math.PI / 2),
    mesh: () => {
      const geometry = new THREE.BufferGeometry();
      geometry.setAttribute("position", new THREE.Float32BufferAttribute((shape.triangles ?? []).flat(), 3));
      geometry.computeVertexNormals();
      return geometry;
    },
  }[shape.kind]();
  if (shape.rotation) {
    const [a, b, c, d, e, f, g, i, j] = shape.rotation;
    made.applyMatrix4(new THREE.Matrix4().set(a, b, c, 0, d, e, f, 0, g, i, j, 0, 0, 0, 0, 1));
  }
  return made;
}

/** A polyline, some pixels wide, that is given anew points at every instant. */
export class Trace {
  constructor(color, { dashed = false, opacity = 1, linewidth = 2 } = {}) {
    const look = new LineMaterial({
      color,
      linewidth,
      dashed,
      dashSize: 0.008,
      gapSize: 0.006,
      transparent: opacity < 1,
      opacity,
    });
    this.line = new Line2(new LineGeometry(), look);
    this.line.frustumCulled = false;
  }

  through(points) {
    this.line.visible = points.length > 1;
    if (!this.line.visible) return;
    this.line.geometry.dispose();
    this.line.geometry = new LineGeometry().setPositions(points.flat());
    this.line.computeLineDistances();
  }
}

/** A number that always faces the viewer. */
export function label(text, color) {
  const canvas = Object.assign(document.createElement("canvas"), {
    width: 96 * Math.max(1, 0.45 * text.length),
    height: 96,
  });
  const pen = canvas.getContext("2d");
  pen.font = "600 58px system-ui, sans-serif";
  pen.textAlign = "center";
  pen.textBaseline = "middle";
  pen.lineWidth = 12;
  pen.strokeStyle = "rgba(255,255,255,0.95)";
  pen.strokeText(text, canvas.width / 2, 50);
  pen.fillStyle = color;
  pen.fillText(text, canvas.width / 2, 50);
  const map = new THREE.CanvasTexture(canvas);
  map.colorSpace = THREE.SRGBColorSpace;
  const sprite = new THREE.Sprite(
    new THREE.SpriteMaterial({ map, depthTest: false, transparent: true, sizeAttenuation: false }),
  );
  sprite.scale.set((0.036 * canvas.width) / 96, 0.036, 1);
  sprite.renderOrder = 5;
  return sprite;
}
