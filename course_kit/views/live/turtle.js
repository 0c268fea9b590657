// The browser's half of the turtle panel: it draws the field and passes on what is pressed and clicked.
// The kernel sends "field" (all there is), "turtles" (who is there, with which pens), "moves" (numbers only) and
// "said" (a line of text); what it does with "show", "key", "teleport", "spawn" and "call" is in turtle.py.

const SIZE = 500; // pixels of the field, both ways
const METER = 45; // pixels
const SHELL = 120; // pixels of a turtle's picture
const TURTLE = 60; // pixels of a turtle on the field
const ARROWS = { ArrowUp: "up", ArrowDown: "down", ArrowLeft: "left", ArrowRight: "right" };
const SIGNS = { up: "▲", left: "◀", down: "▼", right: "▶" };
const HEADINGS = "gtredcvbf";
const MODES = { nothing: "Nothing", teleport: "Teleport", spawn: "Spawn" };
const HOLD = 400; // milliseconds until a button that is held repeats
const REPEAT = 150; // milliseconds between its repeats
const TEXT = 100; // milliseconds between two looks of the numbers
const STILL = 1000; // milliseconds after which a turtle that does not move is told to screen readers

function element(kind, attributes = {}, ...children) {
  const made = document.createElement(kind);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  made.append(...children);
  return made;
}

/** Where the turtles are and what they have drawn, on a canvas. */
class Field {
  constructor(canvas) {
    this.screen = canvas.getContext("2d");
    this.scale = canvas.width / SIZE;
    this.trails = element("canvas", { width: SIZE, height: SIZE }).getContext("2d");
    this.trails.lineCap = "round";
    this.turtles = new Map(); // by number
    this.background = "rgb(69, 86, 255)";
    this.shells = null;
  }

  /** Take over who is there; a turtle that was there before goes on from where it was. */
  know(turtles) {
    const before = this.turtles;
    this.turtles = new Map(turtles.map((one) => [one.number, { ...before.get(one.number), ...one }]));
  }

  wipe() {
    this.trails.clearRect(0, 0, SIZE, SIZE);
  }

  /** No line leads to where the turtles come next: what was between is not known. */
  lift() {
    for (const turtle of this.turtles.values()) turtle.lifted = true;
  }

  move(number, x, y, theta) {
    const turtle = this.turtles.get(number);
    if (!turtle) return;
    if (turtle.down && !turtle.lifted && Number.isFinite(turtle.x + turtle.y + x + y)) {
      if (turtle.x !== x || turtle.y !== y) this.line(turtle, x, y);
    }
    Object.assign(turtle, { x, y, theta, lifted: false });
  }

  line(turtle, x, y) {
    const trails = this.trails;
    trails.strokeStyle = turtle.color;
    trails.lineWidth = turtle.width;
    trails.beginPath();
    trails.moveTo(...place(turtle.x, turtle.y));
    trails.lineTo(...place(x, y));
    trails.stroke();
  }

  draw() {
    const screen = this.screen;
    screen.setTransform(this.scale, 0, 0, this.scale, 0, 0);
    screen.fillStyle = this.background;
    screen.fillRect(0, 0, SIZE, SIZE);
    screen.drawImage(this.trails.canvas, 0, 0);
    if (!this.shells) return;
    const count = this.shells.width / SHELL;
    for (const { x, y, theta, shell } of this.turtles.values()) {
      if (!Number.isFinite(x + y + theta)) continue;
      screen.save();
      screen.translate(...place(x, y));
      screen.rotate(-theta);
      const from = (shell % count) * SHELL;
      screen.drawImage(this.shells, from, 0, SHELL, SHELL, -TURTLE / 2, -TURTLE / 2, TURTLE, TURTLE);
      screen.restore();
    }
  }
}

/** The pixels of a place in metres. */
function place(x, y) {
  return [x * METER + 0.5, SIZE - 0.5 - y * METER];
}

function picture(buffer) {
  return createImageBitmap(new Blob([buffer], { type: "image/png" }));
}

/** A button that acts when it is pressed, again and again while it is held, and by the keyboard. */
function holdable(button, act) {
  let timer = 0;
  const end = () => clearTimeout(timer);
  const repeat = () => {
    act();
    timer = setTimeout(repeat, REPEAT);
  };
  button.addEventListener("pointerdown", (event) => {
    if (event.button !== 0) return;
    button.focus(); // not every browser does so
    act();
    end();
    timer = setTimeout(repeat, HOLD);
  });
  for (const name of ["pointerup", "pointercancel", "pointerleave", "blur"]) button.addEventListener(name, end);
  button.addEventListener("contextmenu", (event) => event.preventDefault()); // of a finger that rests on it
  button.addEventListener("click", (event) => {
    if (event.detail === 0) act(); // by Enter or the space bar, or by a screen reader
  });
  return end;
}

function render({ model, el }) {
  const turtle = model.get("turtle");
  const identity = `course-kit-turtle-${Math.random().toString(36).slice(2)}`;
  const sharp = Math.min(2, Math.max(1, window.devicePixelRatio || 1));
  const canvas = element("canvas", { width: SIZE * sharp, height: SIZE * sharp, "aria-hidden": "true" });
  const board = element("div", {
    class: "course-kit-turtle-field",
    tabindex: 0,
    role: "application",
    "aria-label": `Field of the turtles. Arrow keys drive ${turtle}; g t r e d c v b turn it, f ends a turn.`,
    "aria-describedby": `${identity}-text`,
  });
  board.append(canvas);
  const text = element("div", { class: "course-kit-turtle-text", id: `${identity}-text` });
  const spoken = element("div", { class: "course-kit-turtle-spoken", role: "status" });
  const said = element("div", { class: "course-kit-turtle-said", role: "status" });
  const field = new Field(canvas);
  const say = (content) => model.send(content);

  // The controls.

  const pad = element("div", { class: "course-kit-turtle-pad", role: "group", "aria-label": `Drive ${turtle}` });
  const ends = Object.entries(SIGNS).map(([key, sign]) => {
    const button = element("button", { type: "button", title: key, "aria-label": key, class: key }, sign);
    pad.append(button);
    return holdable(button, () => say({ kind: "key", key }));
  });
  let mode = "nothing";
  const modes = element("div", { class: "course-kit-turtle-row", role: "group", "aria-label": "A click on the field" });
  modes.append(element("span", { "aria-hidden": "true" }, "Click:"));
  for (const [name, label] of Object.entries(MODES)) {
    const button = element("button", { type: "button", "aria-pressed": name === mode }, label);
    button.addEventListener("click", () => {
      mode = name;
      for (const one of modes.querySelectorAll("button")) one.setAttribute("aria-pressed", one === button);
      board.classList.toggle("course-kit-turtle-aims", mode !== "nothing");
    });
    modes.append(button);
  }
  const calls = element("div", { class: "course-kit-turtle-row", role: "group", "aria-label": "The whole field" });
  for (const name of ["Clear", "Reset"]) {
    const button = element("button", { type: "button" }, name);
    button.addEventListener("click", () => say({ kind: "call", service: name.toLowerCase() }));
    calls.append(button);
  }
  const controls = element("div", { class: "course-kit-turtle-controls" }, pad, modes, calls);
  const panel = element("div", { class: "course-kit-turtle", role: "group", "aria-label": "Turtle panel" });
  panel.append(board, controls, text, said, spoken);
  el.append(panel);

  board.addEventListener("click", (event) => {
    board.focus({ preventScroll: true });
    if (mode === "nothing") return;
    const box = canvas.getBoundingClientRect();
    const x = (((event.clientX - box.left) / box.width) * SIZE - 0.5) / METER;
    const y = (SIZE - 0.5 - ((event.clientY - box.top) / box.height) * SIZE) / METER;
    say({ kind: mode, x, y });
  });
  panel.addEventListener(
    "keydown",
    (event) => {
      if (event.ctrlKey || event.altKey || event.metaKey || event.shiftKey) return;
      const key = ARROWS[event.key] ?? (HEADINGS.includes(event.key) ? event.key : undefined);
      if (!key) return; // Tab, Escape and JupyterLab's shortcuts go on
      event.preventDefault(); // the page does not scroll
      event.stopPropagation(); // JupyterLab has commands of its own on these keys
      say({ kind: "key", key });
    },
    true,
  );

  // What is shown.

  let frame = 0;
  let written = 0;
  let moved = false;
  let speaking = 0;
  const places = () =>
    [...field.turtles.values()]
      .filter((one) => one.x !== undefined)
      .map((one) => `${one.name}  x ${number(one.x)} m, y ${number(one.y)} m, heading ${number(one.theta)} rad`);
  const number = (value) => value.toFixed(2).replace("-0.00", "0.00");
  const nobody = () => `No turtle: no node publishes ${model.get("topic")}. run(TurtleSim) starts one.`;
  const write = () => {
    text.textContent = places().join("\n") || nobody();
  };
  const draw = (now) => {
    frame = 0;
    field.draw();
    if (now - written < TEXT) return ask();
    written = now;
    write();
    if (!moved) return;
    moved = false;
    clearTimeout(speaking);
    speaking = setTimeout(() => {
      spoken.textContent = places().join("; ") || nobody();
    }, STILL);
  };
  const ask = () => {
    frame ||= requestAnimationFrame(draw);
  };

  // What comes.

  let count = -1; // of the last message
  let waits = false; // for the whole field
  const take = async (message, buffers) => {
    if (message.kind === "said") {
      said.textContent = message.text;
      return;
    }
    if (message.kind === "field") {
      const [trails, shells] = await Promise.all(buffers.map(picture));
      field.know(message.turtles);
      if (trails) {
        field.wipe();
        field.trails.drawImage(trails, 0, 0);
        waits = false;
      }
      if (shells) field.shells = shells;
      field.background = message.background;
      moved = true;
    } else {
      if (message.count !== count + 1) {
        field.lift();
        show();
      }
      if (message.kind === "turtles") {
        field.know(message.turtles);
        if (message.wiped) field.wipe();
        field.background = message.background;
      } else {
        const moves = new Float32Array(buffers[0].buffer.slice(buffers[0].byteOffset));
        for (let n = 0; n + 3 < moves.length; n += 4) field.move(...moves.subarray(n, n + 4));
      }
      moved = true;
    }
    count = message.count;
    ask();
  };
  const show = () => {
    if (!waits) say({ kind: "show" });
    waits = true;
  };
  let turn = Promise.resolve(); // one message after another, also while a picture is read
  const onMessage = (message, buffers) => {
    turn = turn.then(() => take(message, buffers)).catch((error) => console.error(error));
  };
  onMessage(model.get("first"), []);
  model.on("msg:custom", onMessage);
  show();

  return () => {
    model.off("msg:custom", onMessage);
    ends.forEach((end) => end());
    clearTimeout(speaking);
    cancelAnimationFrame(frame);
  };
}

export default { render };
