// The bar under a cell that takes long. It stands between the cell's input and its outputs and is none of them, so
// nothing of it is saved. A prebuilt extension as JupyterLab loads them, written by hand: it needs no build.
// Python's side is course_kit/views/live/progress_bar.py, which opens a comm for a bar and closes it at its end.
(() => {
  "use strict";
  const TARGET = "course_kit.progress";
  const OVER = ["idle", "restarting", "autorestarting", "terminating", "dead"]; // no cell runs in such a kernel
  const STYLE = `
    .course-kit-progress {margin: 4px 8px 4px min(calc(var(--jp-cell-prompt-width) + 16px), 20%);
      color: var(--jp-ui-font-color1); font-family: var(--jp-ui-font-family); font-size: var(--jp-ui-font-size1);
      overflow-wrap: anywhere}
    .course-kit-progress > div {height: 6px; margin-bottom: 2px; border-radius: 3px; overflow: hidden;
      background: var(--jp-layout-color2)}
    .course-kit-progress > div > div {height: 100%; background: var(--jp-brand-color1); transition: width 0.5s linear}
    .course-kit-progress:not([aria-valuenow]) > div > div {width: 25%;
      animation: course-kit-progress 1.6s ease-in-out infinite alternate}
    @keyframes course-kit-progress {from {margin-left: 0} to {margin-left: 75%}}
    @media (prefers-reduced-motion: reduce) {
      .course-kit-progress > div > div {animation: none !important; transition: none}
    }`;

  const panels = new Set();

  // One bar, in each view of the notebook whose kernel works.
  class Bar {
    constructor(kernel, {cell}) {
      const views = [...panels].filter(panel => panel.sessionContext.session?.kernel?.id === kernel.id);
      const cells = views.flatMap(panel => panel.content.widgets.filter(one => one.model.id === cell));
      this.nodes = cells.map(one => {
        const node = document.createElement("div");
        node.className = "course-kit-progress";
        node.setAttribute("role", "progressbar");
        node.innerHTML = "<div><div></div></div><span></span>";
        one.node.insertBefore(node, one.node.querySelector(":scope > .jp-Cell-outputWrapper"));
        return node;
      });
    }
    show({what, text, fraction}) {
      for (const node of this.nodes) {
        node.setAttribute("aria-label", what);
        node.setAttribute("aria-valuetext", text);
        if (fraction === null) node.removeAttribute("aria-valuenow");
        else node.setAttribute("aria-valuenow", Math.round(100 * fraction));
        node.firstChild.firstChild.style.width = fraction === null ? "" : `${100 * fraction}%`;
        node.querySelector("span").textContent = text;
      }
    }
    remove() {
      for (const node of this.nodes) node.remove();
    }
  }

  const listen = kernel => {
    let bar = null;
    const remove = () => {
      bar?.remove();
      bar = null;
    };
    kernel?.registerCommTarget(TARGET, (comm, message) => {
      remove();
      bar = new Bar(kernel, message.content.data);
      bar.show(message.content.data);
      comm.onMsg = ({content}) => bar?.show(content.data);
      comm.onClose = remove;
    });
    kernel?.statusChanged.connect((_, status) => OVER.includes(status) && remove());
  };

  const plugin = {
    id: "course-kit-progress:plugin",
    autoStart: true,
    activate: app => {
      document.head.append(Object.assign(document.createElement("style"), {textContent: STYLE}));
      app.docRegistry.addWidgetExtension("Notebook", {
        createNew: panel => {
          panels.add(panel);
          panel.disposed.connect(() => panels.delete(panel));
          panel.sessionContext.kernelChanged.connect((_, change) => listen(change.newValue));
          listen(panel.sessionContext.session?.kernel);
        },
      });
    },
  };

  (window._JUPYTERLAB ??= {})["course-kit-progress"] = {
    init: () => {},
    get: async () => () => ({__esModule: true, default: plugin}),
  };
})();
