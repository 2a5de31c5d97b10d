import { OrbitControls, THREE } from "nicegui-scene";

// The moving surface that strikewave.web.pages.case.elements_view writes: turned by the hand, at any instant, cut by a plane.
export default {
  template: `
    <div class="sw-body">
      <div class="sw-row">
        <label>field <select v-model.number="field" @change="paint">
          <option v-for="(one, place) in head.fields" :value="place">{{ one.name }} ({{ one.unit }})</option></select></label>
        <label>cut across <select v-model="across" @change="cut">
          <option value="">nothing</option><option>x</option><option>y</option><option>z</option></select></label>
        <label v-if="across">at <input type="range" min="0" max="1" step="0.005" v-model.number="depth" @input="cut"
          aria-label="place of the cut" /></label>
        <button type="button" @click="look">first view</button>
      </div>
      <div class="sw-view"><canvas tabindex="0" :aria-label="label" @keydown="turn"></canvas>
        <div class="sw-scale" v-if="head.fields.length"><span>{{ ends[1] }}</span><i :style="{ background: ramp }"></i>
          <span>{{ ends[0] }}</span></div></div>
      <div class="sw-row">
        <button type="button" @click="play">{{ timer ? "pause" : "play" }}</button>
        <input class="sw-grow" type="range" min="0" :max="head.time.length - 1" step="1" v-model.number="instant"
          @input="paint" aria-label="time" :aria-valuetext="when" /><span>{{ when }}</span>
      </div>
      <div class="sw-soft" role="status">{{ words }}</div>
    </div>`,
  props: { url: String, label: String },
  data() {
    return { head: { fields: [], time: [] }, field: 0, instant: 0, across: "", depth: 0.5, timer: 0, words: "" };
  },
  computed: {
    when() {
      return this.head.time.length ? `${this.head.time[this.instant]} ${this.head.time_unit}` : "";
    },
    ends() {
      const { low, high, unit } = this.head.fields[this.field];
      return [low, high].map((end) => `${Number(end.toPrecision(4))} ${unit}`);
    },
    ramp() {
      return `linear-gradient(to top, ${this.head.fields[this.field].colours.join(", ")})`;
    },
  },
  async mounted() {
    const canvas = this.$el.querySelector("canvas");
    try {
      this.renderer = new THREE.WebGLRenderer({ canvas, antialias: true, preserveDrawingBuffer: true });
    } catch {
      this.words = "this browser draws no WebGL: the run in motion below shows the same surface";
      return;
    }
    const answer = await fetch(this.url);
    if (!answer.ok) {
      this.words = "the field is no longer kept: run again";
      return;
    }
    this.read(await answer.arrayBuffer());
    this.build(canvas);
    await this.$nextTick(); // the slider reaches so far once it knows how many instants there are
    this.instant = this.fullest;
    this.paint();
    this.observer = new ResizeObserver(() => this.resize());
    this.observer.observe(canvas.parentElement);
    this.words = "drag to turn, wheel or two fingers to come nearer; arrow keys turn too";
  },
  beforeUnmount() {
    clearInterval(this.timer);
    this.observer?.disconnect();
    this.renderer?.dispose();
  },
  methods: {
    read(bytes) {
      const size = new DataView(bytes).getUint32(0, true);
      const head = JSON.parse(new TextDecoder().decode(new Uint8Array(bytes, 4, size)));
      let at = 4 + size;
      const take = (Kind, count) => {
        const values = new Kind(bytes, at, count);
        at += values.byteLength;
        return values;
      };
      this.faces = take(Uint32Array, 4 * head.faces);
      this.points = head.time.map(() => take(Float32Array, 3 * head.points));
      this.levels = head.fields.map(() => head.time.map(() => take(Uint8Array, head.faces)));
      this.shades = head.fields.map((field) => shadesOf(field.colours));
      this.head = head;
      const loads = this.levels[0].map((levels) => levels.reduce((sum, level) => sum + level, 0));
      this.fullest = loads.indexOf(Math.max(...loads));
    },
    build(canvas) {
      const corners = 4 * this.head.faces;
      const geometry = new THREE.BufferGeometry();
      geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(3 * corners), 3));
      geometry.setAttribute("color", new THREE.BufferAttribute(new Float32Array(3 * corners), 3));
      const triangles = new Uint32Array(6 * this.head.faces);
      for (let face = 0; face < this.head.faces; face++) {
        const first = 4 * face;
        triangles.set([first, first + 1, first + 2, first, first + 2, first + 3], 6 * face);
      }
      geometry.setIndex(new THREE.BufferAttribute(triangles, 1));
      const sides = new Uint32Array(8 * this.head.faces);
      for (let face = 0; face < this.head.faces; face++) {
        const first = 4 * face;
        sides.set([first, first + 1, first + 1, first + 2, first + 2, first + 3, first + 3, first], 8 * face);
      }
      const edges = new THREE.BufferGeometry();
      edges.setAttribute("position", geometry.attributes.position);
      edges.setIndex(new THREE.BufferAttribute(sides, 1));
      this.pencil = new THREE.LineBasicMaterial({ color: "#000000", transparent: true, opacity: 0.18 });
      this.plane = new THREE.Plane();
      this.material = new THREE.MeshBasicMaterial({ vertexColors: true, side: THREE.DoubleSide });
      this.material.polygonOffset = true; // lines lie before their faces
      this.material.polygonOffsetFactor = this.material.polygonOffsetUnits = 1;
      this.mesh = new THREE.Mesh(geometry, this.material);
      this.scene = new THREE.Scene();
      this.scene.background = new THREE.Color("#ffffff");
      this.scene.add(this.mesh, new THREE.LineSegments(edges, this.pencil));
      this.renderer.localClippingEnabled = true;
      this.camera = new THREE.PerspectiveCamera(30, 1, 0.1, 1e6);
      this.controls = new OrbitControls(this.camera, canvas);
      this.controls.addEventListener("change", () => this.draw());
      this.paint();
      this.look();
    },
    paint() {
      const { position, color } = this.mesh.geometry.attributes;
      const points = this.points[this.instant];
      const levels = this.levels[this.field][this.instant];
      const shades = this.shades[this.field];
      for (let corner = 0; corner < this.faces.length; corner++) {
        const point = 3 * this.faces[corner];
        const shade = 3 * levels[corner >> 2];
        for (let k = 0; k < 3; k++) {
          position.array[3 * corner + k] = points[point + k];
          color.array[3 * corner + k] = shades[shade + k];
        }
      }
      position.needsUpdate = color.needsUpdate = true;
      this.draw();
    },
    look() {
      const box = new THREE.Box3().setFromArray(this.points[0]);
      const middle = box.getCenter(new THREE.Vector3());
      const towards = new THREE.Vector3(...this.head.towards);
      const along = new THREE.Vector3(...this.head.axis);
      this.camera.up.copy(new THREE.Vector3().crossVectors(towards, along)).normalize();
      const side = towards.addScaledVector(this.camera.up, 0.45).addScaledVector(along, -0.25);
      this.wide = this.width();
      const far = (1.1 * box.getSize(new THREE.Vector3()).length()) / Math.tan((15 * Math.PI) / 180) / 2 / this.wide;
      this.camera.position.copy(middle).addScaledVector(side.normalize(), far);
      this.camera.near = far / 100;
      this.camera.far = 100 * far;
      this.controls.target.copy(middle);
      this.controls.update();
      this.resize();
    },
    width() {
      const place = this.$el.querySelector(".sw-view"); // how wide it is over its height, as far as that matters
      return Math.min(Math.max(place.clientWidth, 50) / place.clientHeight, 1.6);
    },
    cut() {
      const box = new THREE.Box3().setFromArray(this.points[0]);
      const normal = new THREE.Vector3(+(this.across === "x"), +(this.across === "y"), +(this.across === "z"));
      const [low, high] = [normal.dot(box.min), normal.dot(box.max)];
      this.plane.set(normal.negate(), low + this.depth * (high - low));
      for (const material of [this.material, this.pencil]) {
        material.clippingPlanes = this.across ? [this.plane] : [];
        material.needsUpdate = true;
      }
      this.draw();
    },
    turn(event) {
      const step = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key];
      if (!step || !this.controls) return;
      event.preventDefault();
      const arm = this.camera.position.clone().sub(this.controls.target);
      const right = new THREE.Vector3().crossVectors(this.camera.up, arm).normalize();
      arm.applyAxisAngle(this.camera.up, 0.1 * step[0]).applyAxisAngle(right, 0.1 * step[1]);
      this.camera.position.copy(this.controls.target).add(arm);
      this.controls.update();
      this.draw();
    },
    play() {
      if (this.timer) {
        clearInterval(this.timer);
        this.timer = 0;
        return;
      }
      this.timer = setInterval(() => {
        this.instant = (this.instant + 1) % this.head.time.length;
        this.paint();
      }, 120);
    },
    resize() {
      const place = this.$el.querySelector(".sw-view");
      const canvas = place.querySelector("canvas");
      const width = Math.max(place.clientWidth, 50);
      this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
      this.renderer.setSize(width, place.clientHeight, false);
      canvas.style.width = `${width}px`;
      this.camera.aspect = width / place.clientHeight;
      const arm = this.camera.position.clone().sub(this.controls.target);
      this.camera.position.copy(this.controls.target).addScaledVector(arm, this.wide / this.width());
      this.wide = this.width(); // what was seen is still seen where the screen becomes narrow
      this.camera.updateProjectionMatrix();
      this.draw();
    },
    draw() {
      this.renderer.render(this.scene, this.camera);
    },
  },
};

function shadesOf(colours) {
  const shades = new Float32Array(3 * 256);
  const ends = colours.map((colour) => new THREE.Color(colour));
  for (let level = 0; level < 256; level++) {
    const at = (level / 255) * (ends.length - 1);
    const below = Math.min(Math.floor(at), ends.length - 2);
    ends[below].clone().lerp(ends[below + 1], at - below).toArray(shades, 3 * level);
  }
  return shades;
}
