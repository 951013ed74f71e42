// One plot: axes and grid by uPlot, curves drawn here, since uPlot draws only curves whose x rises and a loop's does not.

const style = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

/** A number of a reading, to so many digits. */
function shortText(value, digits = 4) {
  if (!Number.isFinite(value)) return "–";
  if (value === 0) return "0";
  const size = Math.abs(value);
  return size >= 1e6 || size < 1e-3 ? value.toExponential(digits - 1).replace(/\.?0+e/, "e") : String(Number(value.toPrecision(digits)));
}

/** The smallest range of the finite numbers of several lists, a little wider. */
function rangeOf(lists) {
  let low = Infinity, high = -Infinity;
  for (const list of lists)
    for (const value of list) if (Number.isFinite(value)) { if (value < low) low = value; if (value > high) high = value; }
  if (!(low <= high)) return [-1, 1];
  const around = high > low ? 0.04 * (high - low) : Math.abs(high) * 0.1 || 1;
  return [low - around, high + around];
}

/** The data of an SVG path through the finite points of a curve, by functions to the places of x and y. */
function pathText({ x, y, mark }, toX, toY) {
  let path = "", pen = "M";
  for (let i = 0; i < x.length; i++) {
    if (!Number.isFinite(x[i] + y[i])) { pen = "M"; continue; }
    const px = toX(x[i]), py = toY(y[i]);
    if (mark === "point") path += `M${px - 1} ${py - 1}h2v2h-2z`;
    else if (mark === "bar") path += `M${px} ${toY(0)}V${py}`;
    else path += `${pen}${px} ${py}`;
    pen = "L";
  }
  return path;
}

const SMALL = { width: 240, height: 72 }; // of a small picture
/** A small picture of curves without axes, which all fill it together; the style sheet draws each by its class. */
function smallPicture(label, curves) {
  const make = (tag, attributes) => {
    const made = document.createElementNS("http://www.w3.org/2000/svg", tag);
    for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
    return made;
  };
  const [xLow, xHigh] = rangeOf(curves.map(({ x }) => x)), [yLow, yHigh] = rangeOf(curves.map(({ y }) => y)), short = (value) => Number(value.toFixed(1));
  const toX = (x) => short(((x - xLow) / (xHigh - xLow)) * SMALL.width), toY = (y) => short(((yHigh - y) / (yHigh - yLow)) * SMALL.height);
  const picture = make("svg", { viewBox: `0 0 ${SMALL.width} ${SMALL.height}`, preserveAspectRatio: "none", role: "img", "aria-label": label });
  for (const curve of curves) picture.append(make("path", { d: pathText(curve, toX, toY), class: curve.look, "vector-effect": "non-scaling-stroke" }));
  return picture;
}

const escaped = (text) => text.replace(/[&<>"]/g, (letter) => `&#${letter.charCodeAt(0)};`);

/**
 * A plot as SVG. `frame` is the rectangle of the curves in one of the width and height; `axes` are those of x and y, each its
 * range, the places of its lines with their texts, and its label; `colours` those of ink, grid and paper.
 */
function svgOf({ title, width, height, frame, axes, curves, colours }) {
  const [across, up] = axes, { left, top } = frame, right = left + frame.width, bottom = top + frame.height, short = (value) => Number(value.toFixed(2));
  const toX = (x) => short(left + ((x - across.min) / (across.max - across.min)) * frame.width);
  const toY = (y) => short(top + ((up.max - y) / (up.max - up.min)) * frame.height);
  const line = (x1, y1, x2, y2) => `<path d="M${x1} ${y1}L${x2} ${y2}" stroke="${colours.grid}"/>`;
  const text = (x, y, content, more = "") => `<text x="${x}" y="${y}" ${more}>${escaped(content)}</text>`;
  const drawn = curves.map((curve) => {
    const look = curve.mark === "point" ? `fill="${curve.colour}"` : `fill="none" stroke="${curve.colour}" stroke-width="${curve.mark !== "bar" ? 1.7 : curve.dash ? 2 : 5}"${curve.dash ? ' stroke-dasharray="6 4"' : ""}`;
    return `<path d="${pathText(curve, toX, toY)}" ${look}/>`;
  });
  const middle = top + frame.height / 2;
  return [
    `<svg xmlns="http://www.w3.org/2000/svg" width="${width}" height="${height}" viewBox="0 0 ${width} ${height}" font-family="system-ui, sans-serif" font-size="12" fill="${colours.ink}">`,
    `<title>${escaped(title)}</title>`, `<rect width="${width}" height="${height}" fill="${colours.paper}"/>`,
    ...across.splits.map(([at, name]) => line(toX(at), top, toX(at), bottom) + text(toX(at), bottom + 16, name, 'text-anchor="middle"')),
    ...up.splits.map(([at, name]) => line(left, toY(at), right, toY(at)) + text(left - 6, toY(at) + 4, name, 'text-anchor="end"')),
    text(left + frame.width / 2, bottom + 34, across.label, 'text-anchor="middle"'),
    text(12, middle, up.label, `text-anchor="middle" transform="rotate(-90 12 ${middle})"`),
    `<svg x="${left}" y="${top}" width="${frame.width}" height="${frame.height}" viewBox="${left} ${top} ${frame.width} ${frame.height}">`, ...drawn, "</svg>", "</svg>", "",
  ].join("\n");
}

class Plot {
  /** `onCursor(x, y)` is called as the pointer moves over the plot, with null as it leaves. */
  constructor(element, onCursor) {
    Object.assign(this, { element, onCursor });
    this.curves = [];
    this.labels = ["", ""];
    this.splits = [[], []]; // of each axis: the places of its lines with their texts
    this.make();
    new ResizeObserver(() => this.plot.setSize(this.size())).observe(element);
  }
  size() { return { width: Math.max(200, this.element.clientWidth), height: this.element.clientHeight }; }
  make() {
    this.plot?.destroy();
    const axis = (index) => ({
      stroke: () => style("--ink"), grid: { stroke: () => style("--grid"), width: 1 }, ticks: { stroke: () => style("--grid"), width: 1 },
      font: "12px system-ui", labelFont: "12px system-ui", label: () => this.labels[index], labelSize: 20, size: index ? 62 : 34,
      values: (_, places) => {
        const texts = places.map((value) => shortText(Math.abs(value) < 1e-12 * Math.abs(places.at(-1) - places[0]) ? 0 : value));
        this.splits[index] = places.map((value, i) => [value, texts[i]]);
        return texts;
      },
    });
    const scale = () => ({ time: false, auto: false, range: (_, low, high) => [low, high] });
    this.plot = new uPlot({
      ...this.size(), legend: { show: false }, padding: [8, 8, 0, 0],
      cursor: { drag: { x: false, y: false }, points: { show: false }, focus: { prox: -1 } },
      scales: { x: scale(), y: scale() }, axes: [axis(0), { ...axis(1), scale: "y" }], series: [{}, { scale: "y", points: { show: false } }],
      hooks: { draw: [(plot) => this.drawCurves(plot)], setCursor: [({ cursor, posToVal }) => (cursor.left >= 0 ? this.onCursor(posToVal(cursor.left, "x"), posToVal(cursor.top, "y")) : this.onCursor(null))] },
    }, [[0, 1], [null, null]], this.element);
  }
  /** `curves`: [{x, y, colour, dash, mark}] in the units of the axes. */
  show(labels, curves) {
    this.labels = labels;
    this.curves = curves;
    const plot = this.plot, [xLow, xHigh] = rangeOf(curves.map((curve) => curve.x)), [yLow, yHigh] = rangeOf(curves.map((curve) => curve.y));
    plot.batch(() => {
      plot.setScale("x", { min: xLow, max: xHigh });
      plot.setScale("y", { min: yLow, max: yHigh });
      plot.redraw(false, true);
    });
  }
  drawCurves(plot) {
    const { ctx, bbox } = plot, ratio = devicePixelRatio;
    ctx.save();
    ctx.beginPath();
    ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
    ctx.clip();
    const { x: across, y: up } = plot.scales;
    const toX = bbox.width / (across.max - across.min), toY = bbox.height / (up.max - up.min);
    for (const { x, y, colour, dash, mark } of this.curves) {
      ctx.beginPath();
      ctx.strokeStyle = ctx.fillStyle = style(colour);
      ctx.lineWidth = 1.7 * ratio;
      ctx.setLineDash(dash ? [6 * ratio, 4 * ratio] : []);
      let pen = false;
      for (let i = 0; i < x.length; i++) {
        const px = bbox.left + (x[i] - across.min) * toX, py = bbox.top + (up.max - y[i]) * toY;
        if (!Number.isFinite(px + py)) { pen = false; continue; }
        if (mark === "point") { ctx.rect(px - ratio, py - ratio, 2 * ratio, 2 * ratio); continue; }
        if (mark === "bar") { ctx.moveTo(px, bbox.top + up.max * toY); ctx.lineTo(px, py); continue; }
        if (pen) ctx.lineTo(px, py); else ctx.moveTo(px, py);
        pen = true;
      }
      if (mark === "bar") ctx.lineWidth = (dash ? 2 : 5) * ratio;
      if (mark === "point") ctx.fill(); else ctx.stroke();
    }
    ctx.restore();
  }
  svg(title) {
    const { bbox, width, height, scales } = this.plot, ratio = devicePixelRatio, frame = { left: bbox.left / ratio, top: bbox.top / ratio, width: bbox.width / ratio, height: bbox.height / ratio };
    const axes = [scales.x, scales.y].map(({ min, max }, i) => ({ min, max, splits: this.splits[i].filter(([at]) => at >= min && at <= max), label: this.labels[i] }));
    const colours = { ink: style("--ink"), grid: style("--grid"), paper: style("--paper") };
    return svgOf({ title, width, height, frame, axes, colours, curves: this.curves.map((curve) => ({ ...curve, colour: style(curve.colour) })) });
  }
  /** The picture as PNG on the colour of the page. */
  png() {
    const from = this.plot.ctx.canvas, to = document.createElement("canvas");
    to.width = from.width;
    to.height = from.height;
    const ctx = to.getContext("2d");
    ctx.fillStyle = style("--paper");
    ctx.fillRect(0, 0, to.width, to.height);
    ctx.drawImage(from, 0, 0);
    return new Promise((done) => to.toBlob(done, "image/png"));
  }
}
