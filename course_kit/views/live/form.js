// A form for an interface. What it says and what is wrong comes from Python (form.py), which reads each entry;
// here are the inputs, what is typed into them, and the buttons.
const make = (tag, properties = {}, ...children) => {
  const {attributes = {}, ...rest} = properties;
  const element = Object.assign(document.createElement(tag), rest);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  element.append(...children);
  return element;
};
const copied = value => JSON.parse(JSON.stringify(value));
const FEW = 14; // inputs that a nested message shows at once; more are folded
const AT_ONCE = 12; // elements of an array
const REST = 120; // ms after the last letter until what is typed is read

const inputs = (field, entry) => {
  if (field.kind === "message") return field.fields.reduce((sum, one) => sum + inputs(one, entry[one.name]), 0);
  if (field.kind === "array") return entry.reduce((sum, one) => sum + inputs(field.element, one), 1);
  return 1;
};

class Form {
  constructor(model, el) {
    this.model = model;
    this.by = Math.random().toString(36).slice(2); // this page's form: also in the ids of its inputs
    this.ended = []; // what is undone at the end
    this.places = new Map(); // by path: where the error of an input is said, and the input
    const {noun, name, type, root} = model.get("interface");
    this.noun = noun;
    this.root = root;
    this.entries = copied(model.get("entries").values);
    this.fields = make("div");
    this.build();
    this.elsewhere = make("p", {className: "ckf-error", attributes: {role: "alert"}}); // of inputs that are folded away
    this.line = make("p", {className: "ckf-line", attributes: {role: "status"}});
    this.answer = make("pre", {className: "ckf-answer", tabIndex: 0, attributes: {"aria-label": "Answer", role: "group"}});
    this.form = make("form", {
      className: "course-kit-form",
      noValidate: true,
      autocomplete: "off",
      attributes: {"aria-label": `Form of the ${noun} ${name}`},
      onsubmit: event => event.preventDefault(),
    }, make("p", {className: "ckf-title"}, `${noun} `, make("b", {}, name), ` ${type}`), this.fields,
    this.buttons(), this.elsewhere, this.line, this.answer, this.copies());
    el.append(this.form);
    const onKey = event => this.form.contains(event.target) && this.onKey(event);
    window.addEventListener("keydown", onKey, true);
    this.ended.push(() => window.removeEventListener("keydown", onKey, true));
    this.follow("entries", () => this.takeEntries());
    this.follow("problems", () => this.showProblems());
    this.follow("state", () => this.showState());
    this.showProblems();
    this.showState();
  }
  follow(trait, callback) {
    const event = `change:${trait}`;
    this.model.on(event, callback);
    this.ended.push(() => this.model.off(event, callback));
  }
  end() {
    clearTimeout(this.timer);
    for (const one of this.ended) one();
  }

  // What is typed goes to Python soon, and with a button at once.
  edited() {
    clearTimeout(this.timer);
    this.timer = setTimeout(() => this.say("read"), REST);
  }
  say(what) {
    clearTimeout(this.timer);
    if (["send", "start"].includes(what)) this.form.querySelector("[aria-invalid=true]")?.focus();
    this.model.send({do: what, by: this.by, entries: this.entries, rate: this.rate?.value ?? "1"});
  }
  takeEntries() {
    const {values, by, rate} = this.model.get("entries");
    if (by === this.by) return;
    this.entries = copied(values);
    if (this.rate) this.rate.value = rate;
    this.build();
    this.showProblems();
  }
  // Enter and Space are the form's; all other keys stay JupyterLab's, which looks at them before anything in the page.
  onKey(event) {
    const isPlain = !(event.ctrlKey || event.altKey || event.metaKey || event.shiftKey);
    this.form.toggleAttribute("data-lm-suppress-shortcuts", isPlain && ["Enter", " "].includes(event.key));
    if (isPlain && event.key === "Enter" && event.target.matches("input")) {
      event.preventDefault();
      this.say("send");
    }
  }

  build() {
    this.places.clear();
    const rows = this.root.fields.map(one => this.part(one, one.name, one.name, this.entries[one.name],
      value => { this.entries[one.name] = value; }));
    this.fields.replaceChildren(...(rows.length ? rows : [make("p", {}, "It has no fields.")]));
  }
  part(field, label, path, entry, set) {
    if (field.kind === "message") return this.group(field, label, path, entry);
    if (field.kind === "array") return this.array(field, label, path, entry);
    return this.input(field, label, path, entry, set);
  }
  group(field, label, path, entry) {
    const fill = () => field.fields.map(one => this.part(one, one.name, `${path}.${one.name}`, entry[one.name],
      value => { entry[one.name] = value; }));
    return this.folded(label, field.type, inputs(field, entry) <= FEW, fill);
  }
  // Inputs are made when their group is opened for the first time: a matrix has many.
  folded(label, type, open, fill) {
    const body = make("div", {className: "ckf-body"});
    let isFilled = false;
    const group = make("details", {
      ontoggle: () => {
        if (!group.open || isFilled) return;
        isFilled = true;
        body.append(...fill());
        this.showProblems();
      },
    }, this.summary(label, type), body);
    if (open) {
      isFilled = true;
      body.append(...fill());
      group.open = true;
    }
    return group;
  }
  summary(label, type) {
    return make("summary", {}, label, " ", make("span", {className: "ckf-type"}, type));
  }
  array(field, label, path, entry) {
    const body = make("div");
    const canChange = field.least !== field.most;
    const error = this.error(path);
    const add = make("button", {type: "button", onclick: () => {
      entry.push(copied(field.element.default));
      fill();
      this.edited();
      body.lastElementChild.querySelector("input, summary")?.focus();
    }}, "Add to ", make("span", {}, path));
    const fill = () => {
      for (const known of [...this.places.keys()]) if (known.startsWith(`${path}[`)) this.places.delete(known);
      body.replaceChildren(...entry.map((one, index) => {
        const part = this.part(field.element, `[${index}]`, `${path}[${index}]`, one, value => { entry[index] = value; });
        if (!canChange) return part;
        const remove = make("button", {
          type: "button",
          title: `Remove ${path}[${index}]`,
          attributes: {"aria-label": `Remove ${path}[${index}]`},
          onclick: () => {
            entry.splice(index, 1);
            fill();
            this.edited();
            (body.children[Math.min(index, entry.length - 1)]?.querySelector("input, summary") ?? add).focus();
          },
        }, "✕");
        return make("div", {className: "ckf-element"}, part, remove);
      }));
      add.disabled = entry.length >= field.most;
    };
    this.places.set(path, {error});
    const isOpen = entry.length <= AT_ONCE;
    return this.folded(label, field.type, isOpen, () => {
      fill();
      return canChange ? [body, add, error] : [body, error];
    });
  }
  error(path) {
    return make("p", {className: "ckf-error", id: `ckf-${this.by}-${path}-error`, attributes: {role: "alert"}});
  }
  input(field, label, path, entry, set) {
    const id = `ckf-${this.by}-${path}`;
    const error = this.error(path);
    const isSwitch = field.kind === "boolean";
    const input = make("input", {
      id,
      type: isSwitch ? "checkbox" : "text",
      spellcheck: false,
      attributes: {"aria-describedby": error.id, autocapitalize: "off"},
      oninput: () => { set(isSwitch ? input.checked : input.value); this.edited(); },
    });
    if (isSwitch) input.checked = entry;
    else input.value = entry;
    const hint = field.kind === "time" ? field.type.endsWith("/Time") ? "seconds, or now" : "seconds" : field.type;
    const row = make("div", {className: "ckf-row"},
      make("label", {htmlFor: id}, label, " ", make("span", {className: "ckf-type"}, hint)), input);
    if (field.choices.length) row.append(this.constants(field, path, input));
    row.append(error);
    this.places.set(path, {error, input});
    return row;
  }

  // A name of a constant is typed in, or chosen here.
  constants(field, path, input) {
    const choice = make("select", {
      attributes: {"aria-label": `Constants for ${path}`},
      onchange: () => {
        input.value = choice.value;
        choice.selectedIndex = 0;
        input.dispatchEvent(new Event("input"));
        input.focus();
      },
    }, make("option", {}, "constants …"), ...field.choices.map(value => make("option", {value}, value)));
    return choice;
  }

  buttons() {
    const row = make("div", {className: "ckf-buttons"});
    const button = (text, onclick) => {
      const one = make("button", {type: "button", onclick}, text);
      row.append(one);
      return one;
    };
    if (this.noun === "topic") {
      this.send = button("Publish once", () => this.say("send"));
      const error = this.error("rate");
      this.rate = make("input", {id: `ckf-${this.by}-rate`, value: this.model.get("entries").rate, size: 5,
        attributes: {"aria-describedby": error.id, "aria-label": "Rate in Hz"}, oninput: () => this.edited()});
      this.start = button("Start at", () => this.say("start"));
      row.append(make("span", {className: "ckf-rate"}, this.start, this.rate, "Hz"));
      this.stop = button("Stop", () => this.say("stop"));
      row.append(error);
      this.ofRate = {error, input: this.rate};
    } else {
      this.send = button(this.noun === "service" ? "Call" : "Send goal", () => this.say("send"));
      if (this.noun === "action") this.cancel = button("Cancel goal", () => this.say("cancel"));
    }
    return row;
  }
  copies() {
    const text = {};
    const part = (trait, title) => {
      text[trait] = make("pre", {tabIndex: 0, attributes: {role: "group", "aria-label": title}});
      const show = () => { text[trait].textContent = this.model.get(trait); };
      this.follow(trait, show);
      show();
      const copy = make("button", {type: "button", onclick: async () => {
        await navigator.clipboard.writeText(text[trait].textContent);
        copy.textContent = "Copied";
        setTimeout(() => { copy.textContent = "Copy"; }, 1500);
      }, attributes: {"aria-label": `Copy ${title}`}}, "Copy");
      return [make("p", {className: "ckf-copy"}, title, " ", copy), text[trait]];
    };
    return make("details", {className: "ckf-copies"},
      make("summary", {}, "The same as a command and in Python"),
      ...part("command", "In a terminal"), ...part("program", "In Python"));
  }

  showProblems() {
    const problems = this.model.get("problems");
    for (const [path, {error, input}] of [...this.places, ...(this.ofRate ? [["rate", this.ofRate]] : [])]) {
      const said = problems[path] ?? "";
      if (error.textContent !== said) error.textContent = said;
      input?.setAttribute("aria-invalid", String(Boolean(said)));
    }
    const elsewhere = Object.keys(problems).filter(path => !this.places.has(path) && path !== "rate");
    this.elsewhere.textContent = elsewhere.map(path => problems[path]).join(" ");
    for (const path of Object.keys(problems)) {
      for (let group = this.places.get(path)?.input?.closest("details"); group; group = group.parentElement.closest("details"))
        group.open = true;
    }
  }
  showState() {
    const {line, answer, is_busy: isBusy, is_problem: isProblem} = this.model.get("state");
    if (this.line.textContent !== line) this.line.textContent = line;
    this.line.classList.toggle("ckf-problem", isProblem);
    if (this.answer.textContent !== answer) this.answer.textContent = answer;
    this.answer.hidden = !answer;
    if (this.noun === "topic") this.stop.disabled = !isBusy;
    else this.send.disabled = isBusy;
    if (this.cancel) this.cancel.disabled = !isBusy;
  }
}

export default {
  render({model, el}) {
    const form = new Form(model, el);
    return () => form.end();
  },
};
