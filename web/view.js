// One trial in its own scene: everything in it at an instant.

import * as THREE from "three";
import { backbone, nearest } from "./episode.js";
import { label, material, shapeGeometry, Trace, Tube } from "./bodies.js";
import { EXPECTED, GOAL, OBSTACLE, PATH, TRAIL } from "./look.js";
import { before } from "./unpack.js";

const PER_SECTION = 24;
const TRAIL_S = 8;
const GLOW_S = 1; // what touches glows so long, if it does not touch for longer

export class View {
  constructor(scenario, trial) {
    this.scenario = scenario;
    this.trial = trial;
    this.scene = new THREE.Scene();
    this.scene.background = new THREE.Color("#fbfaf7");
    this.scene.add(new THREE.HemisphereLight("#ffffff", "#b9b4a8", 2.1));
    const sun = new THREE.DirectionalLight("#ffffff", 1.6);
    sun.position.set(0.6, -0.9, 1.6);
    this.scene.add(sun, ...ground(scenario.arm));
    this.tube = new Tube(scenario.arm, PER_SECTION);
    this.scene.add(this.tube.group, goal(scenario));
    this.obstacles = scenario.shapes.map((shape, j) => this.addObstacle(shape, j));
    this.tipTrail = this.add(new Trace(TRAIL, { linewidth: 2.5 }));
    this.path = this.add(new Trace(PATH, { dashed: true, linewidth: 2.5 }));
  }

  add(trace) {
    this.scene.add(trace.line);
    return trace;
  }

  addObstacle(shape, j) {
    const body = new THREE.Mesh(shapeGeometry(shape), material(OBSTACLE));
    const name = label(String(j + 1), "#26211c");
    this.scene.add(body, name);
    const made = { body, name, trail: this.add(new Trace(OBSTACLE, { opacity: 0.7 })) };
    if (this.trial?.looks) {
      const look = new THREE.MeshBasicMaterial({ color: EXPECTED, wireframe: true, transparent: true, opacity: 0.55 });
      const coarse = shape.kind === "sphere" ? new THREE.IcosahedronGeometry(1, 2) : shapeGeometry(shape);
      made.ghost = new THREE.Mesh(coarse, look);
      made.ahead = this.add(new Trace(EXPECTED, { dashed: true }));
      this.scene.add(made.ghost);
    }
    return made;
  }

  /** Put everything where it is at `time`; returns what words can be made of. */
  show(time) {
    const { scenario, trial } = this;
    const frames = backbone(trial ? trial.state(time) : scenario.start, scenario.arm, PER_SECTION);
    this.tube.bend(frames);
    const centers = scenario.centers(time);
    this.obstacles.forEach((obstacle, j) => {
      obstacle.body.position.set(...centers[j]);
      obstacle.name.position.set(...centers[j]);
      obstacle.trail.through(scenario.trail(j, Math.max(time - TRAIL_S, scenario.trace.start), time));
    });
    const expected = this.showExpected(time);
    const near =
      scenario.allRound &&
      nearest(
        frames,
        scenario.arm,
        PER_SECTION,
        centers,
        scenario.shapes.map((s) => s.radius),
      );
    const [obstacle, section] = trial?.contact ?? [0, 0];
    const first = trial?.verdicts.swept.kind === "collision" ? trial.verdicts.swept.time : Infinity;
    const touched = time >= first - 1e-3 && (time < first + GLOW_S || (near && near.metres <= 0));
    this.tube.mark(touched ? section : 0);
    this.obstacles.forEach(({ body }, j) =>
      body.material.emissive.set(touched && j + 1 === obstacle ? "#8a0f00" : "#000000"),
    );
    if (trial) {
      this.tipTrail.through([...trial.tips.slice(0, before(trial.tipTimes, time) + 1), frames.at(-1).p]);
      const ahead = trial.looks?.path(time) ?? [];
      this.path.through(
        ahead.length && time < trial.end
          ? [frames.at(-1).p, ...ahead.map((state) => backbone(state, scenario.arm, 1).at(-1).p)]
          : [],
      );
    }
    return { near, expected, touched };
  }

  showExpected(time) {
    const { trial } = this;
    if (!trial?.looks) return null;
    const expected = trial.looks.expected(Math.min(time, trial.end));
    this.obstacles.forEach(({ ghost, ahead }, j) => {
      ghost.position.set(...expected.centers[j]);
      if (this.scenario.shapes[j].kind === "sphere") ghost.scale.setScalar(1.03 * Math.max(expected.radii[j], 1e-4)); // a hair outside, so that both are seen
      ahead.through(expected.ahead.map((centers) => centers[j]));
    });
    return expected;
  }
}

function ground({ length_m, radius_m, n_sections, section_length_m }) {
  const length = length_m ?? n_sections * section_length_m;
  const grid = new THREE.GridHelper(2 * length, 18, "#d9d4c7", "#ebe8df").rotateX(Math.PI / 2);
  Object.assign(grid.material, { transparent: true, opacity: 0.6 }); // an arm may hang below it
  const base = new THREE.Mesh(
    new THREE.CylinderGeometry(1.9 * radius_m, 2.2 * radius_m, 0.012, 40).rotateX(Math.PI / 2),
    material("#6d6a63"),
  );
  base.position.z = -0.006;
  return [grid, base];
}

function goal({ goal: point, tolerance }) {
  const ball = new THREE.Mesh(new THREE.SphereGeometry(tolerance, 20, 14), material("#f5c400"));
  const cage = new THREE.Mesh(
    new THREE.IcosahedronGeometry(tolerance * 1.3, 1),
    new THREE.MeshBasicMaterial({ color: GOAL, wireframe: true, transparent: true, opacity: 0.25 }),
  );
  const name = label("goal", GOAL);
  name.position.z = tolerance + 0.022;
  const group = new THREE.Group().add(ball, cage, name);
  group.position.set(...point);
  return group;
}
