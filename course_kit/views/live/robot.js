// The browser's half of the robot view: it draws what the kernel sends, layer by layer, and passes on goals.
// The kernel sends "layers" (those that have changed) and "said" (a line of text); "show" asks it for all of them.

const FIELD = 560; // pixels of the picture's longer side, where there is room
const STEP = 0.1; // metres that an arrow key moves the cursor
const TURN = Math.PI / 12; // radians that it turns with the shift key
const DRAG = 8; // pixels: a goal that is dragged further has the direction of the drag
const STILL = 1000; // milliseconds after which a robot that does not move is told to screen readers
const MODES = { goal: "Goal", nothing: "Nothing" };
const ARROWS = { ArrowUp: [0, 1], ArrowDown: [0, -1], ArrowLeft: [-1, 0], ArrowRight: [1, 0] };

function element(kind, attributes = {}, ...children) {
  const made = document.createElement(kind);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  made.append(...children);
  return made;
}

function number(value) {
  return value.toFixed(2).replace("-0.00", "0.00");
}

function told([x, y, heading]) {
  return `x ${number(x)} m, y ${number(y)} m, heading ${number(heading)} rad`;
}

/** What there is, by layer, on a canvas. Places are in metres, y upwards. */
class Picture {
  constructor(canvas, look) {
    this.canvas = canvas;
    this.screen = canvas.getContext("2d");
    this.look = look;
    this.ground = { box: [-3, -3, 3, 3], walls: [], pillars: [] };
    this.robots = [];
    this.of = { hits: [], path: [], particles: [], trail: [], map: [] }; // by robot
    this.cursor = null; // a place that is chosen for a goal
  }

  /** Take over one layer. */
  async take(layer, data) {
    const numbers = data ? new Float32Array(data.buffer.slice(data.byteOffset, data.byteOffset + data.byteLength)) : [];
    if (layer.layer === "ground") this.ground = layer;
    else if (layer.layer === "robots") this.robots = layer.robots;
    else if (layer.layer === "map") {
      const image = data && (await createImageBitmap(new Blob([data], { type: "image/png" })));
      this.of.map[layer.robot] = layer.place && { ...layer, image };
    } else if (layer.layer === "trail") {
      const steps = (this.of.trail[layer.robot] ??= []);
      steps.length = 2 * layer.from;
      steps.push(...numbers);
    } else if (layer.layer in this.of) this.of[layer.layer][layer.robot] = numbers;
  }

  /** The kinds of things that are drawn, with their colours. */
  kinds() {
    const { look, of, robots } = this;
    const some = (layers) => robots.some((_, robot) => layers[robot]?.length > 0);
    return [
      ["robot", look.bodies[0], robots.length > 0],
      ["where it takes itself to be", look.estimate, robots.some((one) => one.estimate)],
      ["where it may be", look.particles, some(of.particles)],
      ["laser", look.hits, some(of.hits)],
      ["plan", look.path, some(of.path)],
      ["goal", look.goal, robots.some((one) => one.goal)],
    ].filter(([, , there]) => there);
  }

  /** Pixels of a metre. */
  fit(sharp) {
    const [x0, y0, x1, y1] = this.ground.box;
    const meter = (FIELD * sharp) / Math.max(x1 - x0, y1 - y0);
    const [width, height] = [Math.round((x1 - x0) * meter), Math.round((y1 - y0) * meter)];
    if (this.canvas.width !== width) this.canvas.width = width;
    if (this.canvas.height !== height) this.canvas.height = height;
    return meter;
  }

  draw(sharp) {
    const { screen, look, ground, of } = this;
    const meter = this.fit(sharp);
    this.thin = sharp / meter; // metres of a pixel of the page
    screen.setTransform(meter, 0, 0, -meter, -ground.box[0] * meter, ground.box[3] * meter);
    screen.fillStyle = ground.walls.length ? look.floor : look.outside;
    screen.fillRect(ground.box[0], ground.box[1], ground.box[2] - ground.box[0], ground.box[3] - ground.box[1]);
    screen.lineCap = screen.lineJoin = "round";
    this.robots.forEach((_, robot) => this.map(of.map[robot]));
    screen.fillStyle = look.wall;
    for (const [first, ...others] of ground.walls) {
      screen.beginPath();
      screen.moveTo(...first);
      others.forEach((corner) => screen.lineTo(...corner));
      screen.fill();
    }
    for (const [x, y, radius] of ground.pillars) this.disc(x, y, radius, look.wall);
    this.robots.forEach((one, robot) => {
      this.line(of.trail[robot], this.body(robot), 2, 0.5);
      this.arrows(of.particles[robot], look.particles);
      this.line(of.path[robot], look.path, 3);
      this.dots(of.hits[robot], look.hits);
      if (one.goal) this.goal(one.goal);
    });
    this.robots.forEach((one, robot) => {
      this.robot(one.place, this.body(robot));
      if (one.estimate) this.ring(one.estimate, look.estimate);
    });
    if (this.cursor) this.goal(this.cursor, [4 * this.thin, 4 * this.thin]);
  }

  body(robot) {
    return this.look.bodies[robot % this.look.bodies.length];
  }

  map(map) {
    if (!map?.image) return;
    const { screen } = this;
    const [x, y, heading] = map.place;
    screen.save();
    screen.translate(x, y);
    screen.rotate(heading);
    screen.imageSmoothingEnabled = false;
    screen.drawImage(map.image, 0, 0, map.image.width * map.resolution, map.image.height * map.resolution);
    screen.restore();
  }

  disc(x, y, radius, colour) {
    this.screen.fillStyle = colour;
    this.screen.beginPath();
    this.screen.arc(x, y, radius, 0, 2 * Math.PI);
    this.screen.fill();
  }

  dots(points, colour) {
    const { screen, thin } = this;
    screen.fillStyle = colour;
    const size = 2.5 * thin;
    for (let n = 0; n + 1 < (points?.length ?? 0); n += 2) {
      screen.fillRect(points[n] - size / 2, points[n + 1] - size / 2, size, size);
    }
  }

  line(points, colour, width, opacity = 1) {
    if (!(points?.length > 2)) return;
    const { screen, thin } = this;
    screen.globalAlpha = opacity;
    screen.strokeStyle = colour;
    screen.lineWidth = width * thin;
    screen.beginPath();
    for (let n = 0; n + 1 < points.length; n += 2) screen.lineTo(points[n], points[n + 1]);
    screen.stroke();
    screen.globalAlpha = 1;
  }

  arrows(places, colour) {
    const { screen, thin } = this;
    screen.strokeStyle = colour;
    screen.lineWidth = thin;
    screen.beginPath();
    for (let n = 0; n + 2 < (places?.length ?? 0); n += 3) {
      const [x, y, heading] = [places[n], places[n + 1], places[n + 2]];
      screen.moveTo(x, y);
      screen.lineTo(x + 0.12 * Math.cos(heading), y + 0.12 * Math.sin(heading));
    }
    screen.stroke();
  }

  /** A circle with a hand that shows where it looks. */
  ring([x, y, heading], colour) {
    const { screen, thin, look } = this;
    const radius = 1.3 * look.radius;
    screen.strokeStyle = colour;
    screen.lineWidth = 2 * thin;
    screen.beginPath();
    screen.arc(x, y, radius, 0, 2 * Math.PI);
    screen.moveTo(x + radius * Math.cos(heading), y + radius * Math.sin(heading));
    screen.lineTo(x + 1.7 * radius * Math.cos(heading), y + 1.7 * radius * Math.sin(heading));
    screen.stroke();
  }

  goal([x, y, heading], dashes = []) {
    const { screen, thin, look } = this;
    screen.strokeStyle = look.goal;
    screen.lineWidth = 2.5 * thin;
    screen.setLineDash(dashes);
    for (const radius of [look.radius, 0.45 * look.radius]) {
      screen.beginPath();
      screen.arc(x, y, radius, 0, 2 * Math.PI);
      screen.stroke();
    }
    screen.setLineDash([]);
    if (heading === undefined) return;
    screen.beginPath();
    screen.moveTo(x, y);
    screen.lineTo(x + 2.2 * look.radius * Math.cos(heading), y + 2.2 * look.radius * Math.sin(heading));
    screen.stroke();
  }

  robot([x, y, heading], colour) {
    const { screen, look } = this;
    const [wheel, apart] = look.wheels;
    screen.save();
    screen.translate(x, y);
    screen.rotate(heading);
    screen.fillStyle = "rgb(34, 36, 40)";
    for (const side of [-1, 1]) screen.fillRect(-wheel, (side * apart) / 2 - 0.012, 2 * wheel, 0.024);
    this.disc(0, 0, 0.86 * look.radius, colour);
    screen.fillStyle = "white";
    screen.beginPath();
    screen.moveTo(0.8 * look.radius, 0);
    screen.lineTo(0.05 * look.radius, 0.42 * look.radius);
    screen.lineTo(0.05 * look.radius, -0.42 * look.radius);
    screen.fill();
    screen.restore();
  }

  /** The place that is shown at a point of the page. */
  placeAt(event) {
    const [x0, y0, x1, y1] = this.ground.box;
    const box = this.canvas.getBoundingClientRect();
    const [right, down] = [(event.clientX - box.left) / box.width, (event.clientY - box.top) / box.height];
    return [x0 + right * (x1 - x0), y1 - down * (y1 - y0)];
  }
}

function render({ model, el }) {
  const identity = `course-kit-robot-${Math.random().toString(36).slice(2)}`;
  const sharp = Math.min(2, Math.max(1, window.devicePixelRatio || 1));
  const canvas = element("canvas", { "aria-hidden": "true" });
  const board = element("div", {
    class: "course-kit-robot-field",
    tabindex: 0,
    role: "application",
    "aria-label":
      "The robot from above. Arrow keys move a cursor, with the shift key left and right turn it, " +
      `Enter publishes it on ${model.get("goals")} as a goal, Escape puts it away.`,
    "aria-describedby": `${identity}-text`,
  });
  board.append(canvas);
  const legend = element("div", { class: "course-kit-robot-legend" });
  const text = element("div", { class: "course-kit-robot-text", id: `${identity}-text` });
  const spoken = element("div", { class: "course-kit-robot-spoken", role: "status" });
  const said = element("div", { class: "course-kit-robot-said", role: "status" });
  const picture = new Picture(canvas, model.get("look"));
  const send = (place) => {
    const [x, y, heading] = place;
    model.send({ kind: "goal", x, y, heading });
  };

  // What a click does.

  let mode = "goal";
  const modes = element("div", { class: "course-kit-robot-row", role: "group", "aria-label": "A click on the picture" });
  modes.append(element("span", { "aria-hidden": "true" }, "Click:"));
  for (const [name, label] of Object.entries(MODES)) {
    const button = element("button", { type: "button", "aria-pressed": name === mode }, label);
    button.addEventListener("click", () => {
      mode = name;
      for (const one of modes.querySelectorAll("button")) one.setAttribute("aria-pressed", one === button);
      board.classList.toggle("course-kit-robot-aims", mode === "goal");
    });
    modes.append(button);
  }
  board.classList.add("course-kit-robot-aims");
  const controls = element("div", { class: "course-kit-robot-row" }, modes, legend);
  const panel = element("div", { class: "course-kit-robot", role: "group", "aria-label": "Robot view" });
  panel.append(board, controls, text, said, spoken);
  el.append(panel);

  /** From the first robot to a place. */
  const direction = (x, y) => {
    const from = picture.robots[0]?.place;
    return from ? Math.atan2(y - from[1], x - from[0]) : 0;
  };
  let pressed = null; // where the pointer went down
  board.addEventListener("pointerdown", (event) => {
    board.focus({ preventScroll: true });
    if (event.button !== 0 || mode !== "goal") return;
    board.setPointerCapture(event.pointerId);
    const [x, y] = picture.placeAt(event);
    pressed = event;
    picture.cursor = [x, y, direction(x, y)];
    ask();
  });
  board.addEventListener("pointermove", (event) => {
    if (!pressed) return;
    const [right, down] = [event.clientX - pressed.clientX, event.clientY - pressed.clientY];
    const [x, y] = picture.cursor;
    picture.cursor = [x, y, Math.hypot(right, down) > DRAG ? Math.atan2(-down, right) : direction(x, y)];
    ask();
  });
  board.addEventListener("pointerup", () => {
    if (pressed) send(picture.cursor);
    pressed = picture.cursor = null;
    ask();
  });
  board.addEventListener("pointercancel", () => {
    pressed = picture.cursor = null;
    ask();
  });
  board.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    const arrow = ARROWS[event.key];
    const { cursor } = picture;
    if (!arrow && !(cursor && (event.key === "Enter" || event.key === "Escape"))) return;
    event.preventDefault(); // the page does not scroll
    event.stopPropagation(); // JupyterLab has commands of its own on these keys
    if (arrow) move(arrow, event.shiftKey);
    else {
      if (event.key === "Enter") send(cursor);
      picture.cursor = null;
    }
    ask();
  });
  const move = ([right, up], turns) => {
    const [x, y, heading] = picture.cursor ?? picture.robots[0]?.place ?? [0, 0, 0];
    if (!turns) picture.cursor = [x + STEP * right, y + STEP * up, heading];
    else picture.cursor = [x, y, Math.atan2(Math.sin(heading - TURN * right), Math.cos(heading - TURN * right))];
    say(() => `Cursor ${told(picture.cursor)}`, STILL / 4);
  };

  // What is shown.

  let frame = 0;
  let speaking = 0;
  const ask = () => {
    frame ||= requestAnimationFrame(() => {
      frame = 0;
      picture.draw(sharp);
    });
  };
  const say = (words, delay) => {
    clearTimeout(speaking);
    speaking = setTimeout(() => {
      spoken.textContent = words();
    }, delay);
  };
  const explain = () => {
    const kinds = picture.kinds();
    const names = kinds.map(([name]) => name).join();
    if (legend.dataset.names === names) return;
    legend.dataset.names = names;
    legend.replaceChildren(
      ...kinds.map(([name, colour]) => {
        const spot = element("span", { class: "course-kit-robot-spot", style: `background: ${colour}` });
        return element("span", {}, spot, name);
      }),
    );
  };

  // What comes.

  let count = -1; // of the last message
  const take = async (message, buffers) => {
    if (message.kind === "said") {
      said.textContent = message.text;
      return;
    }
    const all = message.layers.some((one) => one.layer === "ground");
    if (message.count !== count + 1 && !all) model.send({ kind: "show" });
    count = message.count;
    const data = [...buffers];
    for (const layer of message.layers) {
      const own = layer.has_data ? data.shift() : undefined;
      if (layer.layer === "text") text.textContent = layer.text;
      else await picture.take(layer, own);
      if (layer.layer === "robots" && !picture.cursor) {
        say(() => layer.robots.map((one) => `${one.name} ${told(one.place)}`).join("; ") || text.textContent, STILL);
      }
    }
    explain();
    ask();
  };
  let turn = Promise.resolve(); // one message after another, also while a picture is read
  const onMessage = (message, buffers) => {
    turn = turn.then(() => take(message, buffers)).catch((error) => console.error(error));
  };
  model.on("msg:custom", onMessage);
  model.send({ kind: "show" });

  return () => {
    model.off("msg:custom", onMessage);
    clearTimeout(speaking);
    cancelAnimationFrame(frame);
  };
}

export default { render };
