// The course's views in JupyterLab: live while the notebook's kernel keeps them so, else a still that says it is one.
// A prebuilt extension as JupyterLab loads them (a module federation container), written by hand: it needs no build.
// Python's side is course_kit/views/live/shown.py (what stands under a cell) and tabs.py (what the kernel is told).
(() => {
  "use strict";
  const VIEW = "application/vnd.course-kit.view+json";
  const WIDGET = "application/vnd.jupyter.widget-view+json";
  const TARGET = "course_kit.views";
  const SPEAKS = 5000; // ms between two words of a tab that is looked at; the kernel takes it to sleep after 15 s
  const ENDED = ["restarting", "autorestarting", "terminating", "dead"];

  const AS_SAVED = "as it was when the notebook was saved. Run the cell again to have it live.";
  const WHY = {
    saved: `Frozen: ${AS_SAVED}`,
    untrusted: `Frozen: ${AS_SAVED} (The notebook has come from elsewhere, and is not trusted.)`,
    restarted: "Frozen: its kernel has ended or was restarted. Run the cell again to have it live.",
    waiting: "Frozen until the kernel answers: it is starting, or runs a cell.",
    ended: "Stopped: this is how it was last.",
    lost: "No connection to the kernel at the moment: this is how it was.",
  };

  let scope; // the modules that JupyterLab shares
  const shared = async name => {
    const versions = Object.values(scope[name]);
    return (await (versions.find(one => one.loaded) ?? versions[0]).get())();
  };

  // What one notebook's kernel keeps live, asked over a comm. It is told in turn whether anybody looks.
  class Tab {
    constructor(panel) {
      this.panel = panel;
      this.live = null; // ids of displays; null as long as the kernel has not answered
      this.isLost = false;
      this.why = "saved"; // of those that are not live
      this.known = new Set(); // ids that JupyterLab itself keeps up to date: displayed since the page was loaded
      this.renderers = new Set();
      const session = panel.sessionContext;
      session.kernelChanged.connect((_, change) => {
        if (change.oldValue) this.forget("restarted");
        this.ask();
      });
      session.statusChanged.connect((_, status) => {
        if (ENDED.includes(status)) this.forget("restarted");
        else if (status === "idle" && !this.comm) this.ask();
      });
      session.connectionStatusChanged.connect((_, status) => {
        this.isLost = status !== "connected";
        if (status === "connected") this.ask();
        this.tell();
      });
      session.iopubMessage.connect((_, message) => this.hear(message));
      this.speak = () => this.send({looks: this.looks()});
      this.timer = setInterval(() => this.looks() && this.speak(), SPEAKS);
      document.addEventListener("visibilitychange", this.speak);
      panel.disposed.connect(() => {
        clearInterval(this.timer);
        document.removeEventListener("visibilitychange", this.speak);
        this.comm?.close?.();
      });
      session.ready.then(() => this.ask());
    }
    looks() {
      return document.visibilityState === "visible" && this.panel.isVisible;
    }
    send(data) {
      if (this.comm && !this.comm.isDisposed && !this.isLost) this.comm.send(data);
    }
    ask() {
      const kernel = this.panel.sessionContext.session?.kernel;
      if (!kernel || ENDED.includes(kernel.status)) return;
      if (this.comm && !this.comm.isDisposed && this.of === kernel) return this.send({looks: this.looks(), asks: true});
      this.of = kernel;
      const comm = (this.comm = kernel.createComm(TARGET));
      comm.onMsg = message => {
        this.live = new Set([...message.content.data.live, ...(this.live ?? [])]);
        this.tell();
      };
      comm.onClose = () => { // a kernel without the course's views
        this.live ??= new Set();
        this.tell();
      };
      comm.open({looks: this.looks(), asks: true});
    }
    forget(why) {
      this.comm = null;
      this.live = new Set();
      this.why = why;
      this.tell();
    }
    hear(message) {
      const id = message.content?.transient?.display_id;
      if (!id) return;
      const state = message.content.metadata?.course_kit;
      if (message.header.msg_type === "display_data") this.known.add(id);
      const isNew = Boolean(state?.live) !== Boolean(this.live?.has(id));
      if (state?.live) (this.live ??= new Set()).add(id);
      else this.live?.delete(id);
      const isOurs = message.header.msg_type === "update_display_data" && !this.known.has(id);
      for (const one of this.renderers) {
        if (one.id === id && isOurs) one.follow(message.content);
        else if (one.id === id && isNew) one.refresh();
      }
    }
    state(id) {
      if (!id) return "saved";
      if (this.live?.has(id)) return this.isLost ? "lost" : "live";
      return this.live === null && this.panel.sessionContext.session?.kernel ? "waiting" : this.why;
    }
    tell() {
      for (const one of this.renderers) one.refresh();
    }
  }

  // A key that a control of a view uses is not JupyterLab's too, which would go to another cell, or change this one.
  const keepKeys = event => {
    const isCommand = event.ctrlKey || event.metaKey || event.altKey || (event.shiftKey && event.key === "Enter");
    const isControl = event.target.closest("button, input, select, textarea");
    if (isControl && !isCommand && !["Tab", "Escape"].includes(event.key)) event.stopPropagation();
  };

  const rendererClass = Panel =>
    class extends Panel {
      constructor(tab, options) {
        super();
        this.addClass("course-kit-view");
        this.node.style.overflow = "visible";
        this.tab = tab;
        this.options = options;
        tab.renderers.add(this);
        this.node.addEventListener("keydown", keepKeys);
      }
      dispose() {
        this.tab.renderers.delete(this);
        super.dispose();
      }
      async renderModel(model) {
        this.model = model;
        this.data = model.data;
        this.metadata = model.metadata ?? {};
        await this.refresh();
      }
      // An update that JupyterLab does not know to be one of this output, because the page was loaded since.
      follow(content) {
        this.data = content.data;
        this.metadata = content.metadata ?? {};
        this.refresh();
      }
      get id() {
        return this.metadata.course_kit?.id;
      }
      get state() {
        return this.metadata.course_kit?.live === false ? "ended" : this.tab.state(this.id);
      }
      get isLive() {
        return ["live", "lost"].includes(this.state);
      }
      async refresh() {
        if (!this.data || this.isDisposed) return;
        const widget = this.data[WIDGET]?.model_id;
        if (widget && this.isLive && this.model.trusted) {
          if (this.shows !== widget) await this.put(widget, {[WIDGET]: this.data[WIDGET]});
        } else {
          this.still = JSON.stringify(this.data);
          if (this.shows !== this.still) await this.put(this.still, this.stills());
        }
        const state = this.state; // the kernel may have said otherwise while that was put
        if (state === "saved" && !this.isOld) { // of one that a cell has just shown, the kernel's word comes after it
          this.isOld = true;
          setTimeout(() => this.refresh(), 300);
        } else this.note(this.isLive && widget && !this.model.trusted ? "untrusted" : state);
      }
      stills() {
        const {[VIEW]: _, [WIDGET]: __, ...rest} = this.data;
        return rest;
      }
      async put(what, data) {
        this.shows = what;
        const registry = this.tab.panel.content.rendermime;
        const kind = registry.preferredMimeType(data, this.model.trusted ? "any" : "ensure");
        if (!kind) return;
        const inner = registry.createRenderer(kind);
        await inner.renderModel(registry.createModel({data, metadata: this.metadata, trusted: this.model.trusted}));
        if (this.shows !== what) return inner.dispose(); // another came meanwhile
        this.inner?.dispose();
        this.inner = inner;
        this.insertWidget(0, inner);
      }
      // Say that it is frozen, why, and how to go on; a box of a node or process says it in its first line.
      note(state) {
        const text = WHY[state] ?? "";
        this.toggleClass("course-kit-frozen", Boolean(text) && !["lost", "ended"].includes(state));
        const head = this.node.querySelector(".course-kit-state");
        if (head) {
          if (text && !["waiting", "lost", "ended"].includes(state) && head.textContent.startsWith("▶")) {
            head.textContent = `■ ${head.textContent.slice(2).replace(/ running.*/, "")} ${
              state === "restarted" ? "ended with its kernel" : "is not running: this is saved output"}`;
            this.shows = null; // so that the true state is put again when it is live
          }
          return;
        }
        this.said ??= this.node.appendChild(Object.assign(document.createElement("div"), {className: "course-kit-note"}));
        this.said.setAttribute("role", "status");
        if (this.said.textContent !== text) this.said.textContent = text;
        this.said.hidden = !text;
        this.said.style.cssText =
          "font-size:var(--jp-ui-font-size1);color:var(--jp-ui-font-color1);padding:2px 8px;margin-top:4px;" +
          `border-left:3px solid var(--jp-${state === "ended" ? "border" : "warn"}-color1);` +
          "overflow-wrap:anywhere" + (text ? "" : ";display:none");
      }
    };

  // JupyterLab shows pictures without an alternative text. A picture's own is in its metadata, else it is its plain text.
  const describePictures = registry => {
    const plain = registry.getFactory("image/png");
    const createRenderer = options => {
      const renderer = plain.createRenderer(options);
      const renderModel = renderer.renderModel.bind(renderer);
      renderer.renderModel = async model => {
        await renderModel(model);
        const text = model.metadata[options.mimeType]?.alt ?? model.data["text/plain"];
        if (text) renderer.node.querySelector("img")?.setAttribute("alt", text);
      };
      return renderer;
    };
    registry.addFactory({...plain, createRenderer});
  };

  // JupyterLab writes the kernel's version of Python into a notebook that it opens. That is no change to be saved.
  const keepUnchanged = model => {
    model.metadataChanged.connect((_, change) => {
      if (change.key === "language_info" && !model.dirty) queueMicrotask(() => (model.dirty = false));
    });
  };

  const plugin = {
    id: "course-kit-views:plugin",
    autoStart: true,
    activate: async app => {
      const {Panel} = await shared("@lumino/widgets");
      const Renderer = rendererClass(Panel);
      app.docRegistry.addWidgetExtension("Notebook", {
        createNew: panel => {
          const tab = new Tab(panel);
          keepUnchanged(panel.context.model);
          describePictures(panel.content.rendermime);
          panel.content.rendermime.addFactory(
            {safe: true, mimeTypes: [VIEW], createRenderer: options => new Renderer(tab, options)},
            -20 // before any other kind that a view also has
          );
        },
      });
    },
  };

  (window._JUPYTERLAB ??= {})["course-kit-views"] = {
    init: modules => { scope = modules; },
    get: async () => () => ({__esModule: true, default: plugin}),
  };
})();
