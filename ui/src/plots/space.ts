// The track in space with the vehicle's attitude at the cursor, and the horizon as a pilot sees it.
import * as THREE from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { css, h } from "../dom";
import { t } from "../i18n";
import { colour } from "./colours";
import { Linked } from "./linked";

export interface Track3d {
  time: number[];
  east: (number | null)[];
  north: (number | null)[];
  up: (number | null)[];
  roll: (number | null)[];
  pitch: (number | null)[];
  heading: (number | null)[];
}

/** East, north, up to the axes of the scene: x east, y up, z south. */
const placed = (east: number, north: number, up: number) => new THREE.Vector3(east, up, -north);

export function nearest(times: number[], time: number): number {
  let low = 0,
    high = times.length - 1;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (times[middle]! < time) low = middle + 1;
    else high = middle;
  }
  return low;
}

/** An arrowhead with wings and a fin, nose along +x, y up, z right: what rolls and pitches is seen from any side. */
function vehicle(size: number): THREE.Group {
  const group = new THREE.Group();
  const solid = (vertices: number[], tint: string) => {
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute(
      "position",
      new THREE.Float32BufferAttribute(
        vertices.map((v) => v * size),
        3,
      ),
    );
    geometry.computeVertexNormals();
    group.add(
      new THREE.Mesh(geometry, new THREE.MeshLambertMaterial({ color: tint, side: THREE.DoubleSide, flatShading: true })),
    );
  };
  const accent = css("--warn"),
    body = css("--text");
  solid([1, 0, 0, -0.6, 0.05, 0.7, -0.35, 0.12, 0, 1, 0, 0, -0.35, 0.12, 0, -0.6, 0.05, -0.7], accent);
  solid([1, 0, 0, -0.35, -0.12, 0, -0.6, 0.05, 0.7, 1, 0, 0, -0.6, 0.05, -0.7, -0.35, -0.12, 0], body);
  solid([0.1, 0.08, 0, -0.6, 0.5, 0, -0.4, 0.08, 0], body);
  return group;
}

export class SpaceView {
  readonly element: HTMLElement;
  private readonly place = h("div", { class: "space-canvas" });
  private renderer: THREE.WebGLRenderer | null = null;
  private readonly scene = new THREE.Scene();
  private readonly camera = new THREE.PerspectiveCamera(40, 1, 0.1, 1e7);
  private controls: OrbitControls | null = null;
  private model: THREE.Group | null = null;
  private size = 1;
  private readonly render = Linked.perFrame(() => this.paint());

  constructor(
    private readonly track: Track3d,
    private readonly linked: Linked,
  ) {
    this.element = h(
      "figure",
      { class: "plot space" },
      h(
        "figcaption",
        null,
        h("span", { class: "plot-title" }, t("space.title")),
        h("span", { class: "plot-note" }, t("space.hint")),
      ),
      this.place,
    );
    try {
      this.renderer = new THREE.WebGLRenderer({ antialias: true, preserveDrawingBuffer: true });
    } catch {
      this.place.append(h("p", { class: "plot-note" }, t("space.none")));
      return;
    }
    this.place.append(this.renderer.domElement);
    this.renderer.domElement.setAttribute("aria-label", t("space.title"));
    this.renderer.domElement.setAttribute("role", "img");
    this.build();
    new ResizeObserver(() => this.resize()).observe(this.place);
    linked.onCursor(() => this.move());
  }

  redraw(): void {
    if (this.renderer) this.build();
  }

  private build(): void {
    this.scene.clear();
    this.scene.background = new THREE.Color(css("--surface"));
    const points: THREE.Vector3[] = [];
    this.track.time.forEach((_, i) => {
      const [e, n, u] = [this.track.east[i], this.track.north[i], this.track.up[i]];
      if (e !== null && n !== null && u !== null && e !== undefined && n !== undefined && u !== undefined)
        points.push(placed(e, n, u));
    });
    if (points.length < 2) return;
    const box = new THREE.Box3().setFromPoints(points);
    const centre = box.getCenter(new THREE.Vector3());
    this.size = Math.max(box.getSize(new THREE.Vector3()).length(), 1);
    const line = new THREE.Line(
      new THREE.BufferGeometry().setFromPoints(points),
      new THREE.LineBasicMaterial({ color: colour(t("track.solution"), 0) }),
    );
    const floor = box.min.y - 0.04 * this.size;
    const shadow = new THREE.Line(
      new THREE.BufferGeometry().setFromPoints(points.map((p) => new THREE.Vector3(p.x, floor, p.z))),
      new THREE.LineBasicMaterial({ color: css("--muted") }),
    );
    const grid = new THREE.GridHelper(this.size * 1.4, 14, css("--muted"), css("--grid"));
    grid.position.set(centre.x, floor, centre.z);
    this.model = vehicle(this.size / 28);
    this.scene.add(line, shadow, grid, this.model, new THREE.AmbientLight("#fff", 1.6));
    const sun = new THREE.DirectionalLight("#fff", 2);
    sun.position.set(1, 2, 1.5);
    this.scene.add(sun);
    if (!this.controls) {
      this.camera.position.set(centre.x - 0.55 * this.size, centre.y + 0.6 * this.size, centre.z + 0.85 * this.size);
      this.camera.near = this.size / 1000;
      this.camera.far = this.size * 20;
      this.controls = new OrbitControls(this.camera, this.renderer!.domElement);
      this.controls.target.copy(centre);
      this.controls.addEventListener("change", this.render);
      this.controls.update();
    }
    this.move();
    this.resize();
  }

  private move(): void {
    const { track, model } = this;
    if (!model || track.time.length === 0) return;
    const i = nearest(track.time, this.linked.cursor ?? track.time[0]!);
    model.position.copy(placed(track.east[i] ?? 0, track.north[i] ?? 0, track.up[i] ?? 0));
    const radians = (v: number | null | undefined) => ((v ?? 0) * Math.PI) / 180;
    // nose along +x is east: heading turns clockwise from north about the vertical, then pitch about the right wing, then roll
    const attitude = new THREE.Quaternion()
      .setFromAxisAngle(new THREE.Vector3(0, 1, 0), Math.PI / 2 - radians(track.heading[i]))
      .multiply(new THREE.Quaternion().setFromAxisAngle(new THREE.Vector3(0, 0, 1), radians(track.pitch[i])))
      .multiply(new THREE.Quaternion().setFromAxisAngle(new THREE.Vector3(1, 0, 0), radians(track.roll[i])));
    model.quaternion.copy(attitude);
    this.render();
  }

  private resize(): void {
    const width = this.place.clientWidth,
      height = this.place.clientHeight;
    if (!this.renderer || width === 0 || height === 0) return;
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.renderer.setSize(width, height);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.render();
  }

  private paint(): void {
    this.renderer?.render(this.scene, this.camera);
  }
}
