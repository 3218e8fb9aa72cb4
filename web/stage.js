// One canvas, one camera: a viewport per trial, all seen from the same side.

import * as THREE from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";

export class Stage {
  /** `sphere` holds what is to be seen; `toward` is the side from which it is best seen. */
  constructor(views, sphere, toward) {
    this.views = views;
    this.renderer = new THREE.WebGLRenderer({ antialias: true, preserveDrawingBuffer: true });
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
    this.renderer.setScissorTest(true);
    this.canvas = this.renderer.domElement;
    this.canvas.setAttribute("aria-label", "3D view; drag to turn, scroll to come nearer");
    this.camera = new THREE.PerspectiveCamera(30, 1, 0.01, 50);
    this.camera.up.set(0, 0, 1);
    this.sphere = sphere;
    const azimuth = Math.atan2(toward[1], toward[0]) - 0.6;
    this.home = [Math.cos(azimuth), Math.sin(azimuth), 0.38];
    this.controls = new OrbitControls(this.camera, this.canvas);
    this.controls.addEventListener("change", () => this.render());
    this.turned = false;
    this.controls.addEventListener("start", () => (this.turned = true));
  }

  /** Put viewports over the given boxes, in CSS pixels from the canvas's upper left corner. */
  lay(width, height, boxes) {
    this.renderer.setSize(width, height);
    this.height = height;
    this.boxes = boxes;
    if (!this.turned) this.goHome();
    this.render();
  }

  goHome() {
    const { width, height } = this.boxes[0];
    const { center, radius } = this.sphere;
    const half = Math.tan((this.camera.fov * Math.PI) / 360) * Math.min(1, width / height);
    const far = (0.97 * radius) / Math.sin(Math.atan(half));
    const norm = Math.hypot(...this.home);
    this.controls.target.set(...center);
    this.camera.position.set(...center.map((c, i) => c + (far * this.home[i]) / norm));
    this.turned = false;
    this.controls.update();
    this.render();
  }

  render() {
    if (!this.boxes) return;
    this.views.forEach((view, k) => {
      const { left, top, width, height } = this.boxes[k];
      if (width < 1 || height < 1) return;
      const bottom = this.height - top - height;
      this.renderer.setViewport(left, bottom, width, height);
      this.renderer.setScissor(left, bottom, width, height);
      this.camera.aspect = width / height;
      this.camera.updateProjectionMatrix();
      this.renderer.render(view.scene, this.camera);
    });
  }
}
