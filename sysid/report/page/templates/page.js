"use strict";
(() => {
  const data = JSON.parse(document.getElementById("data").textContent);
  const LOOKS = data.looks;
  const LEVELS = ["#440154", "#3b528b", "#21918c", "#35a35b", "#8fb52c", "#b8860b", "#7a4a1e", "#000000"];
  const SYMBOLS = ["circle", "square", "diamond", "triangle-up", "x", "star", "cross", "triangle-down"];
  /* No bar of buttons: it hides legends, and some of its buttons would leave the page. */
  const CONFIG = { displayModeBar: false, responsive: true };
  const PHONE = window.matchMedia("(max-width: 44rem)").matches;
  const byId = (id) => document.getElementById(id);
  const drawn = new Set();

  /* Plotly reads some HTML in names: what comes from files must not become any. */
  const plainly = (text) => {
    const short = text.length > 60 ? "…" + text.slice(-59) : text; /* told apart at their ends */
    return short.replace(/&/g, "&amp;").replace(/</g, "&lt;").replace(/>/g, "&gt;");
  };
  const style = (k) => LOOKS.models[k];
  const bytesOf = (text) => {
    const letters = atob(text);
    const bytes = new Uint8Array(letters.length);
    for (let k = 0; k < letters.length; k += 1) bytes[k] = letters.charCodeAt(k);
    return bytes;
  };
  const unpack = (packed) => {
    if (!packed) return null;
    const [middle, step, text] = packed;
    const bytes = bytesOf(text);
    const view = new DataView(bytes.buffer);
    return Array.from({ length: bytes.length / 2 }, (_, k) => middle + step * view.getInt16(2 * k, true));
  };
  const closed = (values, loop) => (values && loop ? [...values, values[0]] : values);

  const layout = (x, y, more = {}) => ({
    margin: { l: 62, r: 12, t: 8, b: 46 }, font: { size: 12, color: "#1b1f24" }, hovermode: "closest",
    xaxis: { title: { text: x, standoff: 8 }, zeroline: true, zerolinecolor: "#aab", gridcolor: "#e6e9ed", automargin: true },
    yaxis: { title: { text: y, standoff: 8 }, zeroline: true, zerolinecolor: "#aab", gridcolor: "#e6e9ed", automargin: true },
    legend: { orientation: "h", x: 0, y: 1.02, yanchor: "bottom", font: { size: 11 } }, showlegend: true,
    dragmode: PHONE ? false : "zoom", /* a finger scrolls the page */
    paper_bgcolor: "#fff", plot_bgcolor: "#fff", ...more,
  });
  const draw = (id, traces, shape) => {
    const place = byId(id);
    if (!place) return;
    if (!window.Plotly) {
      sketch(place, traces, shape);
      return;
    }
    const sketched = place.querySelector("svg.sketch");
    if (sketched) sketched.remove();
    (sketched ? Plotly.newPlot : Plotly.react)(place, traces, shape, CONFIG);
    drawn.add(place);
  };
  /* The parser knows the name of SVG, which looks like an address; the page is to hold none. */
  const SVG = new DOMParser().parseFromString("<svg></svg>", "text/html").body.firstChild.namespaceURI;
  /* Curves as plain lines, for who chooses a test before the library is there. */
  const DASHES = { dash: "8 5", dot: "2 4", dashdot: "8 4 2 4", longdash: "14 6", longdashdot: "14 5 2 5" };
  const svg = (tag, facts, text = "") => {
    const element = document.createElementNS(SVG, tag);
    for (const [name, value] of Object.entries(facts)) element.setAttribute(name, String(value));
    element.textContent = text;
    return element;
  };
  const sketch = (place, traces, shape) => {
    const ends = (values) => values.reduce(([a, b], z) => [Math.min(a, z), Math.max(b, z)], [0, 0]);
    const [left, right, top, bottom] = [62, 396, 8 + 17 * traces.length, 274];
    const [x0, x1] = ends(traces.flatMap((z) => z.x));
    const [y0, y1] = ends(traces.flatMap((z) => z.y));
    const across = (x) => left + ((x - x0) / (x1 - x0 || 1)) * (right - left);
    const up = (y) => bottom - ((y - y0) / (y1 - y0 || 1)) * (bottom - top);
    const whole = svg("svg", { class: "sketch", viewBox: "0 0 420 320", "font-size": 12, fill: "#1b1f24" });
    const words = (x, y, text, more = {}) => whole.append(svg("text", { x, y, ...more }, text));
    whole.append(svg("path", { d: `M${across(0)} ${top}V${bottom}M${left} ${up(0)}H${right}`, stroke: "#aab", fill: "none" }));
    for (const x of new Set([x0, 0, x1])) words(across(x), bottom + 16, Number(x.toPrecision(3)), { "text-anchor": "middle" });
    for (const y of new Set([y0, 0, y1])) words(left - 6, up(y) + 4, Number(y.toPrecision(3)), { "text-anchor": "end" });
    words((left + right) / 2, bottom + 36, shape.xaxis.title.text, { "text-anchor": "middle" });
    words(0, 0, shape.yaxis.title.text, { "text-anchor": "middle", transform: `translate(13 ${(top + bottom) / 2}) rotate(-90)` });
    traces.forEach((one, k) => {
      const look = { stroke: one.line.color, "stroke-width": one.line.width || 2, "stroke-dasharray": DASHES[one.line.dash] || "none", fill: "none" };
      whole.append(svg("polyline", { points: one.x.map((x, n) => `${across(x).toFixed(1)},${up(one.y[n]).toFixed(1)}`).join(" "), ...look }));
      whole.append(svg("path", { d: `M${left} ${10 + 17 * k}h28`, ...look }));
      words(left + 34, 14 + 17 * k, one.name);
    });
    place.replaceChildren(whole);
  };
  const line = (x, y, name, look) => ({
    x, y, name: plainly(name), mode: "lines", type: "scatter", line: look,
    hovertemplate: "%{x:.4g}, %{y:.4g}<extra>%{fullData.name}</extra>",
  });

  /* A reversal on the frame of a figure would be cut in half. */
  const reach = (x) => {
    const [low, high] = x.reduce(([a, b], z) => [Math.min(a, z), Math.max(b, z)], [0, 0]);
    const margin = 0.05 * (high - low || 1);
    return [low - margin, high + margin];
  };
  const loops = (test) => {
    const loop = test.over === "phase";
    const force = closed(unpack(test.f), loop);
    const models = test.m.map((z) => closed(unpack(z), loop));
    const against = (x) => [
      line(x, force, data.measured, LOOKS.measured),
      ...models.flatMap((m, k) => (m ? [line(x, m, data.models[k], style(k))] : [])),
    ];
    for (const [place, values] of [["velocity", test.v], ["displacement", test.x]]) {
      const x = closed(unpack(values), loop);
      const shape = layout(data.along[place], "force / N");
      shape.xaxis.range = reach(x);
      draw(`detail-${place}`, against(x), shape);
    }
  };
  const residual = (test) => {
    const loop = test.over === "phase";
    const force = unpack(test.f);
    const along = loop ? force.map((_, k) => (360 * k) / force.length) : unpack(test.along);
    const traces = test.m.flatMap((packed, k) => {
      const m = unpack(packed);
      return m ? [line(along, m.map((z, n) => force[n] - z), data.models[k], style(k))] : [];
    });
    const shape = layout(loop ? "phase of the displacement / °" : "time / s", "measured − simulated / N");
    if (loop) Object.assign(shape.xaxis, { range: [0, 360], dtick: 90 });
    draw("detail-residual", traces, shape);
  };

  const cells = Array.from(document.querySelectorAll("#matrix button.cell"));
  let shown = null;
  const show = (place) => {
    shown = place;
    const test = data.tests[place];
    for (const cell of cells) cell.setAttribute("aria-pressed", String(Number(cell.dataset.test) === place));
    byId("detail-title").textContent = test.id;
    byId("detail-words").textContent = data.labels[place];
    const body = byId("detail-facts").tBodies[0];
    body.replaceChildren(...test.facts.map(([name, value]) => {
      const row = document.createElement("tr");
      const head = document.createElement("th");
      head.scope = "row";
      head.textContent = name;
      const cell = document.createElement("td");
      cell.textContent = value;
      row.append(head, cell);
      return row;
    }));
    const known = Boolean(test.f);
    byId("detail-facts").hidden = !known;
    for (const id of ["detail-velocity", "detail-displacement", "detail-residual"]) byId(id).hidden = !known;
    curves();
  };

  const curves = () => {
    if (shown === null || !data.tests[shown].f) return;
    loops(data.tests[shown]);
    residual(data.tests[shown]);
  };

  const neighbour = (cell, key) => {
    const place = cells.indexOf(cell);
    if (key === "ArrowRight") return cells[place + 1];
    if (key === "ArrowLeft") return cells[place - 1];
    const column = cell.closest("td").cellIndex;
    let row = cell.closest("tr");
    while ((row = key === "ArrowDown" ? row.nextElementSibling : row.previousElementSibling)) {
      const found = row.cells[column]?.querySelector("button.cell");
      if (found) return found;
    }
    return undefined;
  };
  const listen = () => {
    for (const cell of cells) {
      cell.addEventListener("click", () => {
        show(Number(cell.dataset.test));
        byId("detail").scrollIntoView({ block: "nearest" });
      });
      cell.addEventListener("keydown", (event) => {
        if (!event.key.startsWith("Arrow")) return;
        const next = neighbour(cell, event.key);
        if (!next) return;
        event.preventDefault();
        next.focus();
      });
    }
    for (const radio of document.querySelectorAll("input[name=model]")) {
      radio.addEventListener("change", () => recolour(Number(radio.value)));
    }
    window.addEventListener("beforeprint", () => {
      for (const hidden of document.querySelectorAll("details")) hidden.open = true;
      for (const place of drawn) {
        if (place.hidden) continue;
        const [width, height] = place.closest(".triple") ? [222, 220]
          : place.closest(".pair") ? [335, 260] : [660, place.classList.contains("tall") ? 400 : 260];
        Plotly.relayout(place, { autosize: false, width, height });
      }
    });
    window.addEventListener("afterprint", () => {
      for (const place of drawn) {
        Plotly.relayout(place, { autosize: true, width: null, height: null });
      }
    });
  };
  const recolour = (model) => {
    const bands = byId("matrix").dataset.bands.split(" ").map(Number);
    for (const cell of cells) {
      const error = parseFloat(cell.dataset.errors.split(" ")[model]);
      if (!cell.dataset.errors) continue;
      const known = Number.isFinite(error);
      const band = known ? bands.filter((limit) => error >= limit).length : "x";
      cell.className = cell.className.replace(/\be[0-9x]\b/, `e${band}`);
      cell.querySelector(".error").textContent = known ? written(100 * error) : "–";
    }
  };
  /* Two significant digits without an exponent, as everywhere on the page. */
  const written = (value) => {
    if (value === 0) return "0";
    const digits = value >= 99.5 ? 3 : 2;
    const size = Math.floor(Math.log10(Number(value.toPrecision(digits))));
    return value.toFixed(Math.min(20, Math.max(0, digits - 1 - size)));
  };

  const damper = () => {
    const look = (k) => ({ color: LEVELS[k % 8], symbol: SYMBOLS[k % 8], size: 8 });
    const minus = (values) => values.map((z) => (z === null ? null : -z));
    const traces = data.damper.flatMap((level, k) => {
      const name = level.current === "unknown" ? "current unknown" : `${level.current} A`;
      const one = { legendgroup: String(k), name: plainly(name), type: "scatter", x: level.velocity };
      const told = { hovertemplate: "%{x:.3g} m/s, %{y:.4g} N<extra>%{fullData.name}</extra>" };
      const thin = { mode: "lines", showlegend: false, line: { color: LEVELS[k % 8], width: 1 } };
      return [
        { ...one, ...told, y: level.compression, mode: "markers", marker: look(k) },
        { ...one, ...told, y: minus(level.rebound), mode: "markers", marker: look(k), showlegend: false },
        { ...one, ...told, ...thin, y: level.model_compression },
        { ...one, ...told, ...thin, y: minus(level.model_rebound) },
      ];
    });
    if (data.limits.length) {
      const ends = (z) => [z.low, z.high].filter((end) => end !== null);
      traces.push({
        type: "scatter", mode: "lines+markers", name: "limits of the drawing", connectgaps: false,
        x: data.limits.flatMap((z) => [...ends(z).map(() => z.velocity), null]),
        y: data.limits.flatMap((z) => [...ends(z), null]),
        text: data.limits.flatMap((z) => [...ends(z).map(() => z.current), ""]),
        line: { color: "#444c56", width: 1.2 }, marker: { symbol: "line-ew-open", size: 16, color: "#444c56", line: { width: 2 } },
        hovertemplate: "%{x:.3g} m/s, %{text}: %{y:.4g} N<extra>limit</extra>",
      });
    }
    const shape = layout("peak velocity / (m/s)", "peak force / N");
    shape.xaxis.rangemode = "tozero";
    shape.annotations = [["compression", 0.98], ["rebound", 0.02]].map(([text, y]) => ({
      text, x: 0.01, y, xref: "paper", yref: "paper", xanchor: "left", showarrow: false, font: { color: "#5a6370" },
    }));
    draw("damper", traces, shape);
  };
  const parity = () => {
    const traces = data.parity.map((left, k) => ({
      type: "bar", orientation: "h", name: plainly(left.model),
      y: left.shares.map(([kind, meaning]) => `${kind}: ${meaning}`), x: left.shares.map((z) => 100 * z[2]),
      marker: { color: style(k).color, pattern: { shape: ["/", "", "x", ".", "\\", "|", "-"][data.parity.length > 1 ? k % 7 : 1] } },
      hovertemplate: "%{x:.3g} %<extra>%{fullData.name}</extra>",
    }));
    const shape = layout("share of the energy that is left / %", "", { barmode: "group" });
    shape.yaxis.autorange = "reversed";
    shape.yaxis.title.text = "";
    shape.xaxis.range = [0, 100];
    if (PHONE) {
      for (const trace of traces) trace.y = trace.y.map((z) => z.slice(0, 2));
    }
    draw("parity", traces, shape);
  };
  const screen = () => {
    const kinds = { asserted: ["asserted", "#0072b2", "diamond"], above: ["above its threshold", "#009e73", "circle"], below: ["below its threshold", "#8d99a6", "circle-open"], unjudged: ["not held against chance", "#8d99a6", "circle-open"] };
    const traces = Object.entries(kinds).map(([verdict, [name, color, symbol]]) => {
      const rows = data.screen.filter((z) => z.verdict === verdict);
      return { type: "scatter", mode: "markers", name, x: rows.map((z) => z.score), y: rows.map((z) => z.id), marker: { color, symbol, size: 11 }, hovertemplate: "score %{x:.3g}<extra>%{y}</extra>" };
    });
    const judged = data.screen.filter((z) => z.threshold !== null);
    traces.push({ type: "scatter", mode: "markers", name: "threshold", x: judged.map((z) => z.threshold), y: judged.map((z) => z.id), marker: { color: "#d55e00", symbol: "line-ns-open", size: 13, line: { width: 2 } }, hovertemplate: "threshold %{x:.3g}<extra>%{y}</extra>" });
    const shape = layout(judged.length ? "score (χ²), logarithmic" : "score, logarithmic", "");
    Object.assign(shape.xaxis, { type: "log", dtick: "D2" });
    shape.yaxis.title.text = "";
    Object.assign(shape.yaxis, { categoryorder: "array", categoryarray: data.screen.map((z) => z.id).reverse() });
    draw("screen-chart", traces.filter((z) => z.x.length), shape);
  };

  const library = async () => {
    const packed = new Response(bytesOf(byId("plotly").textContent)).body;
    const stream = packed.pipeThrough(new DecompressionStream("gzip"));
    const element = document.createElement("script");
    element.textContent = await new Response(stream).text();
    await turn();
    document.head.append(element);
  };
  /* The browser shows what there is and hears clicks, before work goes on. */
  const turn = () => new Promise((go) => { setTimeout(go, 0); });
  const painted = () => new Promise((go) => { requestAnimationFrame(() => setTimeout(go, 0)); setTimeout(go, 500); });
  const start = async () => {
    listen();
    if (data.worst !== null) show(data.worst);
    document.documentElement.dataset.loops = String(Math.round(performance.now()));
    await painted();
    document.documentElement.dataset.first = String(Math.round(performance.now()));
    await library();
    const figures = [curves, data.damper.length && damper, data.parity.length && parity, data.screen.length && screen];
    for (const figure of figures.filter(Boolean)) {
      await turn();
      figure();
    }
    document.documentElement.dataset.ready = String(Math.round(performance.now()));
  };
  start().catch((fault) => {
    for (const place of document.querySelectorAll(".plot")) {
      if (place.querySelector("svg.drawn, svg.sketch") || drawn.has(place)) continue;
      place.classList.add("failed");
      place.textContent = "This browser cannot draw the figures (it is older than 2023, or scripts are restricted); all numbers stand in the tables.";
    }
    console.error(fault);
  });
})();
