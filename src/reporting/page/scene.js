// The page's behaviour: theme, key frame overlays, and the map in WebGL. No library; draws only when something changed.
"use strict";
(() => {
  const root = document.documentElement;
  let redraw = null;
  const themeButton = document.getElementById("theme");
  const setTheme = (theme) => {
    root.dataset.theme = theme;
    themeButton.textContent = theme === "dark" ? "Light" : "Dark";
    if (redraw) redraw();
  };
  setTheme(matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light");
  themeButton.addEventListener("click", () => setTheme(root.dataset.theme === "dark" ? "light" : "dark"));

  const views = document.querySelector(".views");
  for (const button of document.querySelectorAll("[data-overlay]")) {
    button.addEventListener("click", () => {
      views.classList.toggle("ior", button.dataset.overlay === "ior");
      for (const other of document.querySelectorAll("[data-overlay]")) {
        other.setAttribute("aria-pressed", String(other === button));
      }
    });
  }

  const canvas = document.getElementById("scene");
  if (!canvas) {
    root.dataset.scene = "none";
    return;
  }
  const about = JSON.parse(document.getElementById("scene-about").textContent);
  const encoded = atob(document.getElementById("scene-points").textContent);
  const points = new Uint8Array(encoded.length);
  for (let i = 0; i < encoded.length; ++i) points[i] = encoded.charCodeAt(i);
  const gl = canvas.getContext("webgl", {antialias: true, preserveDrawingBuffer: true});
  if (!gl) {
    document.getElementById("scene-hint").textContent = "This browser offers no WebGL, which the 3D view needs.";
    root.dataset.scene = "unavailable";
    return;
  }

  const kCommon = `
    uniform mat4 u_clip; uniform vec3 u_origin; uniform float u_cell;
  `;
  const kPointVertex = kCommon + `
    attribute vec3 a_position; attribute vec3 a_color; attribute float a_attention; attribute vec2 a_normal;
    attribute float a_size;
    uniform float u_pixels; uniform vec3 u_eye; uniform vec3 u_up; uniform vec2 u_heights; uniform int u_mode;
    varying vec3 v_color;
    vec3 viridis(float t) {  // polynomial fit
      return clamp(vec3(0.2777 + t * (0.1051 + t * (-0.3309 + t * (-4.6342 + t * (6.2283 + t * (4.7764 - t * 5.4355))))),
                        0.0054 + t * (1.4046 + t * (0.2148 + t * (-5.7991 + t * (14.1799 + t * (-13.7451 + t * 4.6459))))),
                        0.3341 + t * (1.3846 + t * (0.0951 + t * (-19.3324 + t * (56.6906 + t * (-65.3530 + t * 26.3124)))))),
                   0.0, 1.0);
    }
    void main() {
      vec3 position = u_origin + 0.5 * u_cell * a_position;
      gl_Position = u_clip * vec4(position, 1.0);
      gl_PointSize = clamp(1.35 * u_cell * exp2(a_size) * u_pixels / gl_Position.w, 1.5, 64.0);
      float light = 1.0;
      if (a_normal.x > -127.5) {
        vec2 o = a_normal / 127.0;
        vec3 n = vec3(o, 1.0 - abs(o.x) - abs(o.y));
        if (n.z < 0.0) n.xy = (1.0 - abs(n.yx)) * vec2(n.x < 0.0 ? -1.0 : 1.0, n.y < 0.0 ? -1.0 : 1.0);
        light = 0.45 + 0.55 * abs(dot(normalize(n), normalize(u_eye - position)));
      }
      float inhibited = a_attention >= 128.0 ? 1.0 : 0.0;
      float weight = (a_attention - 128.0 * inhibited) / 127.0;
      float grey = dot(a_color, vec3(0.3, 0.59, 0.11));
      if (u_mode == 0) v_color = a_color * (0.75 + 0.25 * light);
      else if (u_mode == 1) v_color = weight > 0.0 ? mix(vec3(0.75, 0.1, 0.05), vec3(1.0, 0.9, 0.3), weight) * light
                                                   : vec3(0.22 + 0.4 * grey) * light;
      else if (u_mode == 2) v_color = inhibited > 0.5 ? vec3(1.0) * (0.6 + 0.4 * light) : vec3(0.1 + 0.35 * grey) * light;
      else v_color = viridis(clamp((dot(position, u_up) - u_heights.x) / (u_heights.y - u_heights.x), 0.0, 1.0)) * light;
    }`;
  const kPointFragment = `
    precision mediump float; varying vec3 v_color;
    void main() { gl_FragColor = vec4(v_color, 1.0); }`;
  const kLineVertex = `uniform mat4 u_clip; attribute vec3 a_position;
    void main() { gl_Position = u_clip * vec4(a_position, 1.0); gl_PointSize = 7.0; }`;
  const kLineFragment = `precision mediump float; uniform vec3 u_color;
    void main() { gl_FragColor = vec4(u_color, 1.0); }`;

  const compile = (type, source) => {
    const shader = gl.createShader(type);
    gl.shaderSource(shader, source);
    gl.compileShader(shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
    return shader;
  };
  const program = (vertex, fragment) => {
    const result = gl.createProgram();
    gl.attachShader(result, compile(gl.VERTEX_SHADER, vertex));
    gl.attachShader(result, compile(gl.FRAGMENT_SHADER, fragment));
    gl.linkProgram(result);
    if (!gl.getProgramParameter(result, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(result));
    return result;
  };
  const bufferOf = (bytes) => {
    const buffer = gl.createBuffer();
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    gl.bufferData(gl.ARRAY_BUFFER, bytes, gl.STATIC_DRAW);
    return buffer;
  };
  const pointProgram = program(kPointVertex, kPointFragment), lineProgram = program(kLineVertex, kLineFragment);
  const pointBuffer = bufferOf(points);
  const pathBuffer = bufferOf(new Float32Array(about.path.flat()));
  const keyBuffer = bufferOf(new Float32Array(about.keyframes.flat()));
  const boxBuffer = bufferOf(new Float32Array(72));
  let boxShown = false;

  // Vectors and matrices, as many as are needed; matrices by columns.
  const add = (a, b, s = 1) => a.map((v, i) => v + s * b[i]);
  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
  const unit = (a) => a.map((v) => v / Math.hypot(...a));

  const up = about.up;
  const ahead0 = unit(add(about.ahead, up, -dot(about.ahead, up)));
  const right0 = cross(ahead0, up);
  const start = {target: about.target, distance: about.distance, yaw: 0.35, pitch: 0.45};
  let camera = {...start};
  let mode = 0, showPath = true;

  const forward = () => {
    const c = Math.cos(camera.pitch);
    const flat = add(ahead0.map((v) => v * Math.cos(camera.yaw)), right0, Math.sin(camera.yaw));
    return add(flat.map((v) => v * c), up, -Math.sin(camera.pitch));
  };
  const axes = () => {
    const z = forward(), x = unit(cross(z, up));
    return {x, y: cross(x, z), z, eye: add(camera.target, z, -camera.distance)};
  };
  // The shorter side of the picture sees 1 rad; the focal length is in halves of its height.
  const focalOf = (aspect) => Math.min(1, aspect) / Math.tan(0.5);
  const clipMatrix = ({x, y, z, eye}, aspect) => {
    const near = 0.01 * camera.distance, far = 20 * camera.distance + 4 * about.distance;
    const a = (far + near) / (far - near), b = -2 * far * near / (far - near);
    const focal = focalOf(aspect);
    const rows = [x.map((v) => v * focal / aspect), y.map((v) => v * focal), z.map((v) => v * a), z];
    const offsets = [-dot(rows[0], eye), -dot(rows[1], eye), b - a * dot(z, eye), -dot(z, eye)];
    const matrix = [];
    for (let column = 0; column < 3; ++column) for (const row of rows) matrix.push(row[column]);
    return new Float32Array([...matrix, ...offsets]);
  };

  const attribute = (name, size, type, normalized, offset) => {
    const place = gl.getAttribLocation(pointProgram, name);
    gl.enableVertexAttribArray(place);
    gl.vertexAttribPointer(place, size, type, normalized, 14, offset);
  };
  const drawLines = (buffer, clip, color, kind, count) => {
    if (count === 0) return;
    gl.useProgram(lineProgram);
    for (let i = 0; i < 8; ++i) gl.disableVertexAttribArray(i);
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    const place = gl.getAttribLocation(lineProgram, "a_position");
    gl.enableVertexAttribArray(place);
    gl.vertexAttribPointer(place, 3, gl.FLOAT, false, 0, 0);
    gl.uniformMatrix4fv(gl.getUniformLocation(lineProgram, "u_clip"), false, clip);
    gl.uniform3fv(gl.getUniformLocation(lineProgram, "u_color"), color);
    gl.drawArrays(kind, 0, count);
  };
  const draw = () => {
    const scale = Math.min(devicePixelRatio || 1, 2);
    const width = Math.round(canvas.clientWidth * scale), height = Math.round(canvas.clientHeight * scale);
    if (canvas.width !== width) canvas.width = width;
    if (canvas.height !== height) canvas.height = height;
    gl.viewport(0, 0, width, height);
    const back = getComputedStyle(canvas).backgroundColor.match(/\d+/g).map((v) => v / 255);
    gl.clearColor(back[0], back[1], back[2], 1);
    gl.enable(gl.DEPTH_TEST);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    const pose = axes(), clip = clipMatrix(pose, width / height);
    gl.useProgram(pointProgram);
    for (let i = 0; i < 8; ++i) gl.disableVertexAttribArray(i);
    gl.bindBuffer(gl.ARRAY_BUFFER, pointBuffer);
    attribute("a_position", 3, gl.UNSIGNED_SHORT, false, 0);
    attribute("a_color", 3, gl.UNSIGNED_BYTE, true, 6);
    attribute("a_attention", 1, gl.UNSIGNED_BYTE, false, 9);
    attribute("a_normal", 2, gl.BYTE, false, 10);
    attribute("a_size", 1, gl.UNSIGNED_BYTE, false, 12);
    const uniform = (name) => gl.getUniformLocation(pointProgram, name);
    gl.uniformMatrix4fv(uniform("u_clip"), false, clip);
    gl.uniform3fv(uniform("u_origin"), about.origin);
    gl.uniform1f(uniform("u_cell"), about.cell_m);
    gl.uniform1f(uniform("u_pixels"), 0.5 * height * focalOf(width / height));
    gl.uniform3fv(uniform("u_eye"), pose.eye);
    gl.uniform3fv(uniform("u_up"), up);
    gl.uniform2fv(uniform("u_heights"), about.heights);
    gl.uniform1i(uniform("u_mode"), mode);
    gl.drawArrays(gl.POINTS, 0, points.length / 14);
    if (showPath) {
      drawLines(pathBuffer, clip, [0.0, 0.55, 0.9], gl.LINE_STRIP, about.path.length);
      drawLines(keyBuffer, clip, [0.95, 0.55, 0.0], gl.POINTS, about.keyframes.length);
    }
    if (boxShown) drawLines(boxBuffer, clip, [1.0, 0.25, 0.5], gl.LINES, 24);
    root.dataset.scene = String(points.length / 14);
  };
  let pending = false;
  redraw = () => {
    if (pending) return;
    pending = true;
    requestAnimationFrame(() => {
      pending = false;
      draw();
    });
  };

  const orbit = (dx, dy) => {
    camera.yaw -= dx;
    camera.pitch = Math.max(-1.5, Math.min(1.5, camera.pitch + dy));
    redraw();
  };
  const pan = (dx, dy) => {  // by shares of the view's height
    const {x, y} = axes(), reach = 2 * camera.distance / focalOf(canvas.width / canvas.height);
    camera.target = add(add(camera.target, x, -dx * reach), y, dy * reach);
    redraw();
  };
  const zoom = (factor) => {
    camera.distance = Math.max(0.02 * start.distance, Math.min(10 * start.distance, camera.distance * factor));
    redraw();
  };

  const fingers = new Map();
  const spread = () => {
    const [a, b] = [...fingers.values()];
    return {x: (a.x + b.x) / 2, y: (a.y + b.y) / 2, size: Math.hypot(a.x - b.x, a.y - b.y)};
  };
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    fingers.set(event.pointerId, {x: event.clientX, y: event.clientY});
  });
  canvas.addEventListener("pointermove", (event) => {
    const last = fingers.get(event.pointerId);
    if (!last) return;
    const now = {x: event.clientX, y: event.clientY}, height = canvas.clientHeight;
    if (fingers.size === 2) {
      const before = spread();
      fingers.set(event.pointerId, now);
      const after = spread();
      pan((after.x - before.x) / height, (after.y - before.y) / height);
      if (after.size > 0) zoom(before.size / after.size);
      return;
    }
    fingers.set(event.pointerId, now);
    const dx = (now.x - last.x) / height, dy = (now.y - last.y) / height;
    if (event.shiftKey || event.buttons === 2 || event.buttons === 4) pan(dx, dy);
    else orbit(3 * dx, 3 * dy);
  });
  for (const name of ["pointerup", "pointercancel"]) {
    canvas.addEventListener(name, (event) => fingers.delete(event.pointerId));
  }
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  canvas.addEventListener("wheel", (event) => {
    event.preventDefault();
    zoom(Math.exp(Math.max(-1, Math.min(1, event.deltaY / 400))));
  }, {passive: false});

  const modeButtons = [...document.querySelectorAll("[data-mode]")];
  const legends = [...document.querySelectorAll("[data-legend]")];
  const setMode = (value) => {
    mode = value;
    modeButtons.forEach((button) => button.setAttribute("aria-pressed", String(Number(button.dataset.mode) === mode)));
    legends.forEach((legend) => legend.hidden = Number(legend.dataset.legend) !== mode);
    redraw();
  };
  modeButtons.forEach((button) => button.addEventListener("click", () => setMode(Number(button.dataset.mode))));
  const pathButton = document.getElementById("path");
  const togglePath = () => {
    showPath = !showPath;
    pathButton.setAttribute("aria-pressed", String(showPath));
    redraw();
  };
  pathButton.addEventListener("click", togglePath);
  const reset = () => {
    camera = {...start};
    redraw();
  };
  document.getElementById("reset").addEventListener("click", reset);
  const keys = {
    ArrowLeft: () => orbit(0.1, 0), ArrowRight: () => orbit(-0.1, 0),
    ArrowUp: () => orbit(0, 0.08), ArrowDown: () => orbit(0, -0.08),
    w: () => pan(0, 0.05), s: () => pan(0, -0.05), a: () => pan(0.05, 0), d: () => pan(-0.05, 0),
    "+": () => zoom(0.85), "=": () => zoom(0.85), "-": () => zoom(1 / 0.85), r: reset, p: togglePath,
    "1": () => setMode(0), "2": () => setMode(1), "3": () => setMode(2), "4": () => setMode(3),
  };
  canvas.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || !keys[event.key]) return;
    event.preventDefault();
    keys[event.key]();
  });

  const showBox = (box) => {
    const corner = (i) => [0, 1, 2].map((axis) => box[axis + 3 * (i >> axis & 1)]);
    const lines = [];
    for (let i = 0; i < 8; ++i) {
      for (let axis = 0; axis < 3; ++axis) {
        if (!(i >> axis & 1)) lines.push(...corner(i), ...corner(i | 1 << axis));
      }
    }
    gl.bindBuffer(gl.ARRAY_BUFFER, boxBuffer);
    gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(lines), gl.STATIC_DRAW);
    boxShown = true;
    camera.target = [0, 1, 2].map((axis) => (box[axis] + box[axis + 3]) / 2);
    const size = Math.hypot(box[3] - box[0], box[4] - box[1], box[5] - box[2]);
    camera.distance = Math.min(start.distance, Math.max(4 * size, 0.15 * start.distance));
    redraw();
  };
  const objectButtons = [...document.querySelectorAll("[data-box]")];
  objectButtons.forEach((button) => button.addEventListener("click", () => {
    objectButtons.forEach((other) => other.setAttribute("aria-pressed", String(other === button)));
    showBox(JSON.parse(button.dataset.box));
    canvas.scrollIntoView({block: "center"});
  }));
  new ResizeObserver(() => redraw()).observe(canvas);
  setMode(0);
  draw();
})();
