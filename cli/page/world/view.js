// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
// The 3-D view of a world: its edges and surfaces, the route, and at every pose of a robot what its
// rig sees and what each source of error takes away. Lengths in the data are millimetres.
import { coloursOf, layersOf } from "./layers.js";
import { Flight } from "./flight.js";

/* global THREE */
const data = JSON.parse(document.getElementById("data").textContent);
const stage = document.getElementById("stage");
const dark = window.matchMedia("(prefers-color-scheme: dark)").matches;

function say(text) {
  const trouble = document.getElementById("trouble");
  trouble.textContent = text;
  trouble.hidden = false;
}

/** Coordinates in millimetres, three a point, as metres. */
function metres(numbers) {
  return Float32Array.from(numbers, (x) => x / 1000);
}

function lines(numbers, colour, opacity = 1) {
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.BufferAttribute(metres(numbers), 3));
  const material = new THREE.LineBasicMaterial({ color: colour, transparent: opacity < 1, opacity });
  return new THREE.LineSegments(geometry, material);
}

/**
 * Edges as thin rods, since lines of WebGL are one pixel wide. With an eye, the rods are as wide in
 * its image wherever they are.
 */
function rods(numbers, colour, radius, eye) {
  const count = numbers.length / 6;
  const mesh = new THREE.InstancedMesh(
    new THREE.BoxBufferGeometry(1, 1, 1), new THREE.MeshBasicMaterial({ color: colour }), Math.max(1, count));
  mesh.count = count;
  mesh.frustumCulled = false;
  const at = metres(numbers);
  const a = new THREE.Vector3(), b = new THREE.Vector3(), along = new THREE.Vector3();
  const x = new THREE.Vector3(1, 0, 0), turn = new THREE.Quaternion(), place = new THREE.Matrix4();
  for (let i = 0; i < count; ++i) {
    a.fromArray(at, 6 * i);
    b.fromArray(at, 6 * i + 3);
    along.subVectors(b, a);
    const length = along.length();
    turn.setFromUnitVectors(x, along.normalize());
    const middle = a.add(b).multiplyScalar(0.5);
    const wide = eye ? 0.0035 * middle.distanceTo(eye) : radius;
    place.compose(middle, turn, new THREE.Vector3(length, wide, wide));
    mesh.setMatrixAt(i, place);
  }
  return mesh;
}

function surfaces(numbers) {
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.BufferAttribute(metres(numbers), 3));
  geometry.computeVertexNormals();
  const material = new THREE.MeshLambertMaterial({
    color: dark ? 0x3a444f : 0xe4e9ee, side: THREE.DoubleSide, polygonOffset: true,
    polygonOffsetFactor: 1, polygonOffsetUnits: 1 });
  return new THREE.Mesh(geometry, material);
}

/** The robot: a disc on the floor with its heading, and its camera. */
function robot() {
  const group = new THREE.Group();
  const paint = new THREE.MeshBasicMaterial({ color: 0xd55e00 });
  const body = new THREE.Mesh(new THREE.CylinderBufferGeometry(0.15, 0.15, 0.05, 24), paint);
  body.rotation.x = Math.PI / 2;
  const cone = new THREE.Mesh(new THREE.ConeBufferGeometry(0.09, 0.3, 16), paint);
  cone.rotation.z = -Math.PI / 2;
  cone.position.x = 0.3;
  group.add(body, cone);
  return group;
}

function start() {
  const renderer = new THREE.WebGLRenderer({ antialias: true, preserveDrawingBuffer: true });
  renderer.setClearColor(dark ? 0x14181d : 0xffffff);
  stage.appendChild(renderer.domElement);
  const scene = new THREE.Scene();
  scene.add(new THREE.HemisphereLight(0xffffff, dark ? 0x667788 : 0x99a4b0, 0.85));
  const light = new THREE.DirectionalLight(0xffffff, 0.15);
  light.position.set(1, 2, 3);
  scene.add(light);

  const colours = coloursOf(dark);
  const walls = surfaces(data.surfaces), ceilings = surfaces(data.ceilings);
  const edges = lines(data.edges, colours.edges), edgesAbove = lines(data.edges_above, colours.edges);
  const route = rods(data.route, colours.route, 0.03);
  scene.add(walls, ceilings, edges, edgesAbove, route);
  const marker = robot();
  scene.add(marker);

  const flight = new Flight(stage, data, () => draw());
  const layers = layersOf(document.getElementById("legend"), data, colours, () => show());
  const pose = document.getElementById("pose"), where = document.getElementById("where");
  let shown = [];

  function show() {
    const view = data.views[Number(pose.value)];
    for (const object of shown) {
      scene.remove(object);
      object.geometry.dispose();
    }
    shown = [];
    walls.visible = layers.on("surfaces");
    edges.visible = layers.on("edges");
    route.visible = layers.on("route");
    marker.visible = view !== undefined && !flight.isEye;
    // From above one looks through the ceiling.
    ceilings.visible = layers.on("surfaces") && !flight.isAbove;
    edgesAbove.visible = layers.on("edges") && !flight.isAbove;
    if (view) {
      const [x, y, heading] = view.pose;
      marker.position.set(x, y, 0.03);
      marker.rotation.z = heading;
      where.textContent = `${x.toFixed(2)}, ${y.toFixed(2)} m, ${(heading * 180 / Math.PI).toFixed(0)}°`;
      const eye = flight.isEye ? new THREE.Vector3(x, y, data.camera.height_m) : null;
      for (const [name, numbers] of Object.entries(view.edges)) {
        if (!layers.on(name) || numbers.length === 0) continue;
        const drawn = rods(numbers, layers.colour(name), 0.022, eye);
        scene.add(drawn);
        shown.push(drawn);
      }
      layers.count(view);
      if (flight.isEye) flight.eye(view.pose, data.camera);
    }
    draw();
  }

  function draw() {
    renderer.render(scene, flight.camera);
  }

  function resize() {
    const { clientWidth: width, clientHeight: height } = stage;
    renderer.setPixelRatio(window.devicePixelRatio);
    renderer.setSize(width, height);
    flight.resize(width, height);
    draw();
  }

  pose.max = Math.max(0, data.views.length - 1);
  pose.value = Math.floor(data.views.length / 3);
  document.getElementById("place").hidden = data.views.length === 0;
  pose.addEventListener("input", show);
  document.getElementById("eye").addEventListener("click", () => {
    const view = data.views[Number(pose.value)];
    flight.eye(view.pose, data.camera);
    show();
  });
  document.getElementById("above").addEventListener("click", () => {
    flight.above();
    show();
  });
  flight.onLeave = show;
  window.addEventListener("resize", resize);
  resize();
  flight.above();
  // A link may name the pose, and whether one looks with the robot's eyes: #pose=12&eye
  const wanted = new URLSearchParams(window.location.hash.slice(1));
  if (wanted.has("pose")) pose.value = wanted.get("pose");
  if (wanted.has("eye") && data.views.length > 0) flight.eye(data.views[Number(pose.value)].pose, data.camera);
  show();
}

document.getElementById("name").textContent = data.name;
document.title = `${data.name} – Vernier world`;
document.getElementById("about").textContent = data.about;
try {
  start();
} catch (error) {
  say(`The view in space needs WebGL, which this browser does not give: ${error.message}`);
}
