// SPDX-License-Identifier: BSD-3-Clause
// The page of `avianlidar view`: a scene in three dimensions, with three.js. Lengths are in metres, with x east, y
// north and z up from the middle of the scene. Texts of files become nodes of text, never markup.
"use strict";
(function () {
  const data = JSON.parse(document.getElementById("data").textContent);
  const find = (id) => document.getElementById(id);
  const say = (text) => { find("picked").textContent = text; find("picked").hidden = !text; };
  const MOVING_POINTS = 60000; // number of points that are drawn while the camera moves
  const REACH = 8; // distance in pixels at which a click still meets a point
  const BIRD_SIZE = 14; // length of a bird, pixels
  const types = { float32: Float32Array, uint32: Uint32Array, uint16: Uint16Array, uint8: Uint8Array };

  // Numbers of the page -------------------------------------------------------------------------------------------
  async function numbers(block) {
    const packed = Uint8Array.from(atob(block.values), (letter) => letter.charCodeAt(0));
    const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
    block.values = null;
    return new types[block.type](await new Response(stream).arrayBuffer());
  }
  const rgb = (text) => [1, 3, 5].map((at) => parseInt(text.substr(at, 2), 16));
  const figures = (value, count) => value.toLocaleString("en", { maximumSignificantDigits: count });

  // Stage ---------------------------------------------------------------------------------------------------------
  /// True if no graphics card draws. Smooth edges then cost four times as much.
  function drawsInSoftware() {
    const context = document.createElement("canvas").getContext("webgl");
    const info = context && context.getExtension("WEBGL_debug_renderer_info");
    return Boolean(info) && /swiftshader|llvmpipe|software/i.test(context.getParameter(info.UNMASKED_RENDERER_WEBGL));
  }
  let renderer;
  try {
    renderer = new THREE.WebGLRenderer({ antialias: !drawsInSoftware(), preserveDrawingBuffer: true });
  } catch (error) {
    say("This browser shows no 3D graphics: WebGL is switched off.");
    return;
  }
  renderer.setPixelRatio(Math.min(window.devicePixelRatio || 1, 2));
  document.body.insertBefore(renderer.domElement, document.body.firstChild);
  const stage = new THREE.Scene();
  stage.background = new THREE.Color(0xe4edf5);
  const camera = new THREE.PerspectiveCamera(40, 1, 1, 1e5);
  camera.up.set(0, 0, 1);
  const controls = new THREE.OrbitControls(camera, renderer.domElement);
  controls.maxPolarAngle = 0.495 * Math.PI;
  const centre = data.centre;
  const local = (place) => new THREE.Vector3(place[0] - centre[0], place[1] - centre[1], place[2] - centre[2]);
  const layers = {}; // groups of objects by name
  function layer(name, shown) {
    if (!layers[name]) {
      layers[name] = new THREE.Group();
      layers[name].visible = shown !== false;
      stage.add(layers[name]);
    }
    return layers[name];
  }

  // Drawing happens when something has changed. While the camera moves, clouds are drawn with fewer points.
  let asked = false, restful = 0;
  const clouds = [], movers = [];
  function draw() {
    if (!asked) {
      asked = true;
      requestAnimationFrame(() => { asked = false; render(); });
    }
  }
  function render() {
    movers.filter(({ of }) => !of.size).forEach(({ body }) => { // birds are as large as a letter from everywhere
      body.scale.setScalar(BIRD_SIZE * pixelAt(body.position));
    });
    renderer.render(stage, camera);
    placeNames();
    counted.frames += 1;
  }
  /// Length of a pixel at a place, m.
  function pixelAt(place) {
    return 2 * Math.tan(camera.fov * Math.PI / 360) * place.distanceTo(camera.position) / window.innerHeight;
  }
  const counted = { frames: 0 };
  function thin(moving) {
    const all = clouds.reduce((sum, cloud) => sum + (cloud.points.visible ? cloud.count : 0), 0);
    const share = moving && all > MOVING_POINTS ? MOVING_POINTS / all : 1;
    clouds.forEach((cloud) => cloud.points.geometry.setDrawRange(0, Math.ceil(share * cloud.count)));
  }
  controls.addEventListener("change", () => {
    thin(true);
    draw();
    clearTimeout(restful);
    restful = setTimeout(() => { thin(false); draw(); }, 250);
  });
  function resize() {
    renderer.setSize(window.innerWidth, window.innerHeight);
    camera.aspect = window.innerWidth / window.innerHeight;
    camera.updateProjectionMatrix();
    draw();
  }
  window.addEventListener("resize", resize);

  // Names in the picture ------------------------------------------------------------------------------------------
  const names = [];
  function addName(text, place, group) {
    const node = document.createElement("div");
    node.className = "name";
    node.textContent = text;
    find("names").appendChild(node);
    names.push({ node, place, group });
    return names[names.length - 1];
  }
  function placeNames() {
    const taken = [];
    names.forEach(({ node, place, group }) => {
      const at = place.clone().project(camera);
      const x = (at.x + 1) / 2 * window.innerWidth, y = (1 - at.y) / 2 * window.innerHeight;
      const width = 8 * node.textContent.length + 6;
      const hidden = at.z > 1 || Math.abs(at.x) > 1 || Math.abs(at.y) > 1 || !group.visible ||
        taken.some(([a, b, w]) => Math.abs(b - y) < 18 && x - width / 2 < a + w / 2 && a - w / 2 < x + width / 2);
      node.hidden = hidden;
      if (!hidden) {
        taken.push([x, y, width]);
        node.style.transform = `translate(${x.toFixed(0)}px, ${y.toFixed(0)}px) translate(-50%, -120%)`;
      }
    });
  }

  // Surfaces ------------------------------------------------------------------------------------------------------
  const LIGHT = new THREE.Vector3(-0.45, -0.6, 0.66).normalize();
  let surfaceObjects = null, surfaceMesh = null;
  async function addSurfaces(of) {
    const [points, cells, objects] = await Promise.all([of.points, of.cells, of.objects].map(numbers));
    const colours = of.colours.map(rgb), count = cells.length / 3;
    const places = new Float32Array(9 * count), shades = new Uint8Array(9 * count);
    for (let t = 0; t < count; ++t) {
      const [a, b, c] = [0, 1, 2].map((k) => 3 * cells[3 * t + k]);
      for (let k = 0; k < 3; ++k) {
        places[9 * t + k] = points[a + k];
        places[9 * t + 3 + k] = points[b + k];
        places[9 * t + 6 + k] = points[c + k];
      }
      const u = [0, 1, 2].map((k) => points[b + k] - points[a + k]);
      const v = [0, 1, 2].map((k) => points[c + k] - points[a + k]);
      const n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
      const length = Math.hypot(n[0], n[1], n[2]) || 1;
      const lit = (n[0] * LIGHT.x + n[1] * LIGHT.y + n[2] * LIGHT.z) / length;
      const shade = 0.62 + 0.38 * Math.max(0, n[2] < 0 && Math.abs(n[2]) > 0.9 * length ? -lit : lit) / LIGHT.z;
      for (let k = 0; k < 9; ++k) {
        shades[9 * t + k] = Math.min(255, shade * colours[objects[t]][k % 3]);
      }
    }
    surfaceObjects = objects;
    // Triangles come in the order of their layers. Lower layers yield, so that an apron hides the grass below.
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(places, 3));
    geometry.setAttribute("color", new THREE.BufferAttribute(shades, 3, true));
    const materials = [], highest = Math.max(...of.layers);
    for (let first = 0; first < count;) {
      const level = of.layers[objects[first]];
      let last = first;
      while (last < count && of.layers[objects[last]] === level) {
        ++last;
      }
      geometry.addGroup(3 * first, 3 * (last - first), materials.length);
      materials.push(new THREE.MeshBasicMaterial({ vertexColors: THREE.VertexColors, side: THREE.DoubleSide,
        polygonOffset: true, polygonOffsetFactor: 0.2 * (highest - level),
        polygonOffsetUnits: 8 * (highest - level + 1) }));
      first = last;
    }
    surfaceMesh = new THREE.Mesh(geometry, materials);
    layer("surfaces").add(surfaceMesh);
    const edges = await numbers(of.edges);
    const lines = new THREE.BufferGeometry();
    lines.setAttribute("position", new THREE.BufferAttribute(edges, 3));
    layer("edges").add(new THREE.LineSegments(lines, new THREE.LineBasicMaterial({ color: 0x333333 })));
  }

  // Echoes --------------------------------------------------------------------------------------------------------
  async function addEchoes(of) {
    const steps = await numbers(of.places), places = new Float32Array(steps.length);
    for (let i = 0; i < steps.length; ++i) {
      const k = i % 3;
      places[i] = of.low[k] + of.step[k] * steps[i] - centre[k];
    }
    const cloud = { of, count: of.count, places, colours: new Uint8Array(3 * of.count), lidar: of.lidar || data.lidar };
    cloud.energy = of.energy ? await numbers(of.energy.steps) : null;
    cloud.objects = of.objects ? await numbers(of.objects.of) : null;
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(places, 3));
    geometry.setAttribute("color", new THREE.BufferAttribute(cloud.colours, 3, true));
    cloud.points = new THREE.Points(geometry, new THREE.PointsMaterial({ size: 3, sizeAttenuation: false,
      vertexColors: THREE.VertexColors }));
    layer("echoes").add(cloud.points);
    clouds.push(cloud);
  }
  const hues = data.hues.map(rgb), shares = data.shades.map(rgb);
  function rangeOf(cloud, i) {
    const from = local(cloud.lidar);
    return Math.hypot(cloud.places[3 * i] - from.x, cloud.places[3 * i + 1] - from.y, cloud.places[3 * i + 2] - from.z);
  }
  function energyOf(cloud, i) {
    const { low, high } = cloud.of.energy;
    return low * Math.pow(high / low, cloud.energy[i] / 65535);
  }
  // What a cloud needs so that its echoes can be coloured in a way; other clouds are then hidden.
  const WAYS = { energy: (cloud) => cloud.energy, distance: (cloud) => cloud.lidar, class: (cloud) => cloud.objects };
  let colouring = "energy";
  function colourEchoes() {
    let farthest = 0;
    clouds.filter((cloud) => cloud.lidar).forEach((cloud) => {
      for (let i = 0; i < cloud.count; ++i) {
        farthest = Math.max(farthest, rangeOf(cloud, i));
      }
    });
    clouds.forEach((cloud) => {
      cloud.points.visible = WAYS[colouring] ? Boolean(WAYS[colouring](cloud)) : true;
      const ofObjects = cloud.of.objects ? cloud.of.objects.colours.map(rgb) : null;
      for (let i = 0; i < cloud.count; ++i) {
        let colour = [60, 60, 60];
        if (colouring === "energy" && cloud.energy) {
          const [low, high] = cloud.of.energy.scale, energy = energyOf(cloud, i);
          const share = high > 100 * low ? Math.log(energy / low) / Math.log(high / low) : (energy - low) / (high - low);
          colour = hues[Math.round(share * (hues.length - 1))];
        } else if (colouring === "distance" && cloud.lidar) {
          colour = shares[Math.round(255 * rangeOf(cloud, i) / farthest)];
        } else if (colouring === "class" && ofObjects) {
          colour = ofObjects[cloud.objects[i]];
        }
        cloud.colours.set(colour, 3 * i);
      }
      cloud.points.geometry.attributes.color.needsUpdate = true;
    });
    legendOfEchoes(farthest);
    draw();
  }

  // Legend --------------------------------------------------------------------------------------------------------
  function row(parent, colour, text) {
    const [line, box, words] = ["div", "i", "span"].map((kind) => document.createElement(kind));
    box.style.background = colour;
    words.textContent = text;
    line.append(box, words);
    parent.appendChild(line);
  }
  function heading(parent, text) {
    const line = document.createElement("b");
    line.textContent = text;
    parent.appendChild(line);
  }
  function scale(parent, title, colours, low, high) {
    heading(parent, title);
    const bar = document.createElement("canvas"), ends = document.createElement("div");
    bar.id = "bar";
    bar.width = colours.length;
    bar.height = 1;
    const pen = bar.getContext("2d");
    colours.forEach((colour, at) => { pen.fillStyle = colour; pen.fillRect(at, 0, 1, 1); });
    ends.style.justifyContent = "space-between";
    [low, high].forEach((text) => {
      const end = document.createElement("span");
      end.textContent = text;
      ends.appendChild(end);
    });
    parent.append(bar, ends);
  }
  function legendOfEchoes(farthest) {
    const legend = find("legend");
    legend.textContent = "";
    const withEnergy = clouds.find((cloud) => cloud.energy);
    if (colouring === "energy" && withEnergy) {
      const { scale: [low, high], ends } = withEnergy.of.energy;
      scale(legend, `energy of echoes${high > 100 * low ? " (logarithmic)" : ""}`, data.hues, ...ends);
    } else if (colouring === "distance" && farthest) {
      scale(legend, "distance (m)", data.shades, "0", figures(farthest, 3));
    } else if (colouring === "class") {
      const shown = new Map();
      clouds.filter((cloud) => cloud.objects).forEach(({ of, objects }) => new Set(objects).forEach((one) =>
        shown.set(of.objects.classes[one], of.objects.colours[one])));
      heading(legend, "class");
      [...shown].forEach(([word, colour]) => row(legend, colour, word));
    }
    if (data.sequence) {
      heading(legend, "species");
      Object.entries(data.sequence.species).forEach(([name, colour]) => row(legend, colour, name));
    }
    if (data.coverage && layers.coverage.visible) {
      scale(legend, "share of scans that detect the bird", data.shades, "0", "1");
    }
    legend.hidden = !legend.children.length;
  }

  // Lidar, its beams and rings of equal distance -------------------------------------------------------------------
  function addLidar(radius) {
    const group = layer("lidar"), at = local(data.lidar);
    const size = Math.max(2, radius / 150);
    const mark = new THREE.Mesh(new THREE.ConeBufferGeometry(size / 2, size, 4), new THREE.MeshBasicMaterial({
      color: 0xd7191c, depthTest: false }));
    mark.rotation.x = Math.PI / 2;
    mark.position.copy(at);
    mark.position.z += size / 2;
    mark.renderOrder = 9;
    group.add(mark);
    addName("lidar", mark.position.clone(), group);
    const rings = layer("range rings");
    const step = [50, 100, 200, 500, 1000, 2000, 5000].find((one) => radius < 4.5 * one) || 10000;
    for (let range = step; range < radius; range += step) {
      const corners = [];
      for (let k = 0; k <= 180; ++k) {
        const angle = k * Math.PI / 90;
        corners.push(new THREE.Vector3(at.x + range * Math.cos(angle), at.y + range * Math.sin(angle), at.z));
      }
      rings.add(new THREE.Line(new THREE.BufferGeometry().setFromPoints(corners), new THREE.LineBasicMaterial({
        color: 0x4a6a8a, transparent: true, opacity: 0.7 })));
      addName(range < 1000 ? `${range} m` : `${range / 1000} km`, new THREE.Vector3(at.x, at.y - range, at.z), rings);
    }
    const beams = layer("beams", false), ends = [];
    clouds.filter((cloud) => cloud.lidar).forEach((cloud) => {
      for (let i = 0; i < Math.min(cloud.count, data.beams); ++i) {
        ends.push(local(cloud.lidar), new THREE.Vector3().fromArray(cloud.places, 3 * i));
      }
    });
    if (ends.length) {
      beams.add(new THREE.LineSegments(new THREE.BufferGeometry().setFromPoints(ends), new THREE.LineBasicMaterial({
        color: 0xd7191c, transparent: true, opacity: 0.25 })));
    }
  }

  // Movers --------------------------------------------------------------------------------------------------------
  // A bird's path has rows of time, x, y, z and number of points. A box has rows of time, x, y, z and heading.
  let now = 0;
  function addMovers(sequence) {
    const shape = new THREE.ConeBufferGeometry(0.35, 1, 6);
    shape.rotateZ(-Math.PI / 2); // the tip points east
    sequence.birds.forEach((bird) => {
      const body = new THREE.Mesh(shape, new THREE.MeshBasicMaterial({ color: bird.colour }));
      const way = new THREE.BufferGeometry().setFromPoints(bird.path.map((one) => local(one.slice(1))));
      const trail = new THREE.Line(way, new THREE.LineBasicMaterial({ color: bird.colour, transparent: true,
        opacity: 0.45 }));
      layer("birds").add(body);
      layer("trails").add(trail);
      movers.push({ of: bird, body });
    });
    sequence.others.forEach((box) => {
      const body = new THREE.Mesh(new THREE.BoxBufferGeometry(...box.size), new THREE.MeshBasicMaterial({
        color: 0x4575b4, wireframe: true }));
      layer("boxes of vehicles").add(body);
      movers.push({ of: box, body });
    });
  }
  function moveTo(time) {
    now = time;
    movers.forEach(({ of, body }) => {
      const path = of.path, after = path.findIndex((one) => one[0] >= time);
      const gap = path.length > 1 ? 1.5 * (path[path.length - 1][0] - path[0][0]) / (path.length - 1) : 1e9;
      body.visible = after >= 0 ? path[after][0] - time <= gap : time - path[path.length - 1][0] <= 1e-3;
      if (after < 0) {
        return;
      }
      const two = path[after], one = path[Math.max(0, after - 1)];
      const share = two[0] > one[0] ? (time - one[0]) / (two[0] - one[0]) : 1;
      const from = local(one.slice(1)), to = local(two.slice(1));
      body.position.lerpVectors(from, to, share);
      body.rotation.z = of.size ? two[4] : Math.atan2(to.y - from.y, to.x - from.x);
    });
    draw();
  }

  // Coverage ------------------------------------------------------------------------------------------------------
  const slices = [];
  async function addCoverage(coverage) {
    for (const map of coverage.maps) {
      const values = await numbers(map.values), [rows, columns] = map.shape;
      const texels = new Uint8Array(4 * rows * columns);
      for (let i = 0; i < rows * columns; ++i) {
        texels.set(shares[values[i]], 4 * i);
        texels[4 * i + 3] = values[i] ? 190 : 0;
      }
      const picture = new THREE.DataTexture(texels, columns, rows, THREE.RGBAFormat);
      picture.flipY = true;
      picture.minFilter = picture.magFilter = THREE.NearestFilter;
      picture.needsUpdate = true;
      const size = [columns * map.step[0], rows * map.step[1]];
      const slice = new THREE.Mesh(new THREE.PlaneBufferGeometry(...size), new THREE.MeshBasicMaterial({ map: picture,
        transparent: true, side: THREE.DoubleSide, depthWrite: false }));
      slice.position.copy(local([map.west + size[0] / 2, map.north - size[1] / 2, map.height]));
      Object.assign(slice.userData, { map, values });
      layer("coverage", !clouds.length).add(slice);
      slices.push(slice);
    }
    showSlice(0);
  }
  function showSlice(number) {
    slices.forEach((slice, at) => { slice.visible = at === number; });
    draw();
  }

  function addTracks(tracks) {
    tracks.forEach((track) => layer("tracks").add(new THREE.Line(new THREE.BufferGeometry().setFromPoints(
      track.path.map((one) => local(one.slice(1)))), new THREE.LineBasicMaterial({ color: 0x6a3d9a }))));
  }

  // Picking and measuring -----------------------------------------------------------------------------------------
  let measured = null; // places of a measurement, or null while nothing is measured
  const marks = new THREE.Group();
  stage.add(marks);
  /// The nearest thing below a pixel: {place, text}, or null.
  function pick(x, y) {
    const width = window.innerWidth, height = window.innerHeight, place = new THREE.Vector3();
    const ray = new THREE.Raycaster();
    ray.setFromCamera(new THREE.Vector2(2 * x / width - 1, 1 - 2 * y / height), camera);
    let best = null;
    const offer = (point, text, bonus) => {
      const depth = point.distanceTo(camera.position) * (1 - bonus);
      best = !best || depth < best.depth ? { depth, place: point.clone(), text } : best;
    };
    movers.filter(({ body }) => body.visible && body.parent.visible).forEach(({ of, body }) => {
      const at = body.position.clone().project(camera);
      if (Math.hypot((at.x + 1) / 2 * width - x, (1 - at.y) / 2 * height - y) < REACH) {
        offer(body.position, () => `${of.name}, ${placeWords(body.position)}`, 0.05);
      }
    });
    const matrix = new THREE.Matrix4().multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse).elements;
    clouds.filter((cloud) => cloud.points.visible && layers.echoes.visible).forEach((cloud) => {
      const p = cloud.places;
      let near = -1, least = Infinity;
      for (let i = 0; i < cloud.count; ++i) {
        const [a, b, c] = [p[3 * i], p[3 * i + 1], p[3 * i + 2]];
        const w = matrix[3] * a + matrix[7] * b + matrix[11] * c + matrix[15];
        const dx = ((matrix[0] * a + matrix[4] * b + matrix[8] * c + matrix[12]) / w + 1) / 2 * width - x;
        const dy = (1 - (matrix[1] * a + matrix[5] * b + matrix[9] * c + matrix[13]) / w) / 2 * height - y;
        const away = dx * dx + dy * dy;
        if (w > 0 && away < REACH * REACH && away + 1e-3 * w < least) {
          least = away + 1e-3 * w;
          near = i;
        }
      }
      if (near >= 0) {
        offer(place.fromArray(p, 3 * near), () => echoWords(cloud, near), 0.02);
      }
    });
    if (layers.surfaces.visible) {
      const hit = ray.intersectObject(surfaceMesh)[0];
      if (hit) {
        const object = surfaceObjects[hit.faceIndex];
        offer(hit.point, () => `${data.surfaces.names[object]} (${data.surfaces.classes[object]}), ` +
          placeWords(hit.point), 0);
      }
    }
    const slice = slices.find((one) => one.visible && layers.coverage.visible);
    const hit = slice ? ray.intersectObject(slice)[0] : null;
    if (hit) {
      const { map, values } = slice.userData, [rows, columns] = map.shape;
      const column = Math.min(columns - 1, Math.floor(hit.uv.x * columns));
      const share = values[Math.min(rows - 1, Math.floor((1 - hit.uv.y) * rows)) * columns + column] / 255;
      offer(hit.point, () => `${figures(share, 2)} of the scans detect the bird, ${placeWords(hit.point)}`, 0);
    }
    return best;
  }
  function placeWords(point) {
    const at = [point.x + centre[0], point.y + centre[1], point.z + centre[2]].map((one) => one.toFixed(1));
    const from = data.lidar ? `, ${point.distanceTo(local(data.lidar)).toFixed(1)} m from the lidar` : "";
    return `at ${at[0]} m east, ${at[1]} m north, ${at[2]} m up${from}`;
  }
  function echoWords(cloud, i) {
    const words = [cloud.of.name];
    if (cloud.objects) {
      words.push(`echo of ${cloud.of.objects.names[cloud.objects[i]]}`);
    }
    if (cloud.lidar) {
      words.push(`range ${rangeOf(cloud, i).toFixed(1)} m`);
    }
    if (cloud.energy) {
      words.push(`energy ${figures(energyOf(cloud, i), 3)} ${cloud.of.energy.unit}`);
    }
    return words.join(", ");
  }
  function measure(found) {
    measured.push(found.place);
    if (measured.length > 2) {
      measured = [found.place];
    }
    marks.clear ? marks.clear() : marks.remove(...marks.children);
    marks.add(new THREE.Points(new THREE.BufferGeometry().setFromPoints(measured), new THREE.PointsMaterial({ size: 9,
      sizeAttenuation: false, color: 0x000000, depthTest: false })));
    if (measured.length < 2) {
      marks.children[0].renderOrder = 9; // after the surfaces
      say("Now click the other end.");
      return;
    }
    marks.add(new THREE.Line(new THREE.BufferGeometry().setFromPoints(measured), new THREE.LineBasicMaterial({
      color: 0x000000, depthTest: false })));
    marks.children.forEach((one) => { one.renderOrder = 9; });
    const [a, b] = measured;
    say(`distance ${a.distanceTo(b).toFixed(1)} m, level ${Math.hypot(b.x - a.x, b.y - a.y).toFixed(1)} m, up ` +
      `${(b.z - a.z).toFixed(1)} m`);
  }
  let pressed = null;
  renderer.domElement.addEventListener("pointerdown", (event) => { pressed = [event.clientX, event.clientY]; });
  renderer.domElement.addEventListener("pointerup", (event) => {
    if (!pressed || Math.hypot(event.clientX - pressed[0], event.clientY - pressed[1]) > 3) {
      return;
    }
    const found = pick(event.clientX, event.clientY);
    if (measured && found) {
      measure(found);
    } else {
      say(found ? found.text() : "");
    }
    draw();
  });

  // Controls ------------------------------------------------------------------------------------------------------
  function control(kind, words, settings, change) {
    const [label, input, text] = ["label", "input", "span"].map((kind) => document.createElement(kind));
    Object.assign(input, { type: kind }, settings);
    text.textContent = words;
    label.append(...(kind === "checkbox" ? [input, text] : [text, input]));
    input.addEventListener("input", () => change(input, text));
    find("controls").appendChild(label);
    return { input, text };
  }
  function button(words, click) {
    const one = document.createElement("button");
    one.textContent = words;
    one.addEventListener("click", () => click(one));
    find("controls").appendChild(one);
    return one;
  }
  function addLine(text) {
    const line = document.createElement("div");
    line.textContent = text;
    find("controls").appendChild(line);
  }
  function addControls() {
    if (data.surfaces.edges_left_out) {
      addLine(`${data.surfaces.edges_left_out.toLocaleString("en")} edges are not drawn`);
    }
    if (clouds.length) {
      const [shown, all] = clouds.reduce(([a, b], { of }) => [a + of.count, b + of.of], [0, 0]);
      addLine((shown < all ? `${shown.toLocaleString("en")} of ` : "") + `${all.toLocaleString("en")} echoes`);
      const label = document.createElement("label"), select = document.createElement("select");
      const ways = Object.keys(WAYS).filter((name) => clouds.some(WAYS[name]));
      ways.forEach((name) => select.add(new Option(name, name)));
      label.append("echoes by ", select);
      colouring = ways[0] || "";
      select.id = "colouring";
      select.addEventListener("change", () => { colouring = select.value; colourEchoes(); });
      find("controls").appendChild(label);
    }
    Object.keys(layers).filter((name) => layers[name].children.length).forEach((name) => {
      control("checkbox", ` ${name}`, { checked: layers[name].visible, id: `layer ${name}` }, (box) => {
        layers[name].visible = box.checked;
        colourEchoes();
      });
    });
    if (data.sequence) {
      const { from, to } = data.sequence;
      const slider = control("range", "", { id: "time", min: from, max: to, step: "any", value: from }, ({ value }) =>
        show(Number(value)));
      let playing = 0;
      const show = (time) => {
        slider.input.value = time;
        slider.text.textContent = `time ${time.toFixed(1)} s`;
        moveTo(time);
      };
      const play = button("play", (self) => {
        clearInterval(playing);
        playing = self.textContent === "play" ? setInterval(() => show(now + 0.1 > to ? from : now + 0.1), 100) : 0;
        self.textContent = playing ? "stop" : "play";
      });
      play.id = "play";
      show(from);
    }
    if (slices.length) {
      const heights = data.coverage.maps.map((map) => map.height);
      const slider = control("range", "", { id: "height", min: 0, max: heights.length - 1, step: 1, value: 0 },
        (input) => showHeight(Number(input.value)));
      const showHeight = (number) => {
        slider.text.textContent = `coverage at ${heights[number]} m above the origin`;
        showSlice(number);
      };
      showHeight(0);
    }
    button("measure", (self) => {
      measured = measured ? null : [];
      marks.remove(...marks.children);
      self.textContent = measured ? "stop measuring" : "measure";
      say(measured ? "Click two places." : "");
      draw();
    }).id = "measure";
    button("picture", () => {
      render();
      const link = document.createElement("a");
      link.href = renderer.domElement.toDataURL("image/png");
      link.download = `${data.title}.png`;
      link.click();
    }).id = "picture";
    button("from above", () => view(0.01)).id = "above";
    button("oblique", () => view(1.0)).id = "oblique";
  }

  // View ----------------------------------------------------------------------------------------------------------
  let reach = 1;
  /// Looks at the lidar, or at the middle of the scene, from the south. @param tilt angle from above, rad
  function view(tilt) {
    const target = data.lidar ? local(data.lidar) : new THREE.Vector3();
    const away = 1.15 * reach / Math.tan(camera.fov * Math.PI / 360);
    controls.target.copy(target);
    camera.near = Math.max(0.5, away / 500);
    camera.far = 60 * away;
    camera.updateProjectionMatrix();
    camera.position.set(target.x, target.y - away * Math.sin(tilt), target.z + away * Math.cos(tilt));
    controls.update();
    draw();
  }
  /// Radius around the lidar that holds most of what is shown, m.
  function radiusShown() {
    const from = data.lidar ? local(data.lidar) : new THREE.Vector3(), ranges = [];
    clouds.forEach((cloud) => {
      for (let i = 0; i < Math.min(cloud.count, 2000); ++i) {
        ranges.push(Math.hypot(cloud.places[3 * i] - from.x, cloud.places[3 * i + 1] - from.y));
      }
    });
    data.labels.forEach(({ at }) => ranges.push(local(at).distanceTo(from)));
    ranges.sort((a, b) => a - b);
    const half = Math.max(data.bounds[0][1] - data.bounds[0][0], data.bounds[1][1] - data.bounds[1][0]) / 2;
    return Math.max(1, Math.min(half, ranges.length ? ranges[Math.floor(0.8 * (ranges.length - 1))] : half));
  }
  async function begin() {
    document.querySelector("#panel h1").textContent = data.title;
    await addSurfaces(data.surfaces);
    for (const one of data.echoes) {
      await addEchoes(one);
    }
    reach = radiusShown();
    data.labels.forEach(({ text, at }) => addName(text, local(at), layer("names")));
    layer("names").add(new THREE.Group());
    if (data.lidar) {
      addLidar(2.5 * reach);
    }
    if (data.sequence) {
      addMovers(data.sequence);
    }
    if (data.coverage) {
      await addCoverage(data.coverage);
    }
    addTracks(data.tracks);
    addControls();
    colourEchoes();
    resize();
    view(1.0);
    say("");
    render();
    window.avianLidar = { counted, centre, camera, controls, pick, render, thin, ready: performance.now() };
  }
  begin().catch((error) => say(`The page cannot be shown: ${error.message}`));
})();
