// The form of all parameters, family by family, made from the schema.

const FINE = 1.01, COARSE = 1.1; // factors of the arrow keys, without and with Shift
const DIGITS = 7, MAX_SHOWN = 11; // of a number in its field, which is that wide
const MAX_MARK = 30; // characters of the source beside a number
const OCTAVES = 2; // of a slider, to either side
const words = (name) => name.replaceAll("_", " ");

/** The number of a field in SI: in the unit shown, whose factor is given, or in one that is written behind it; NaN if there is none. */
function numberOf(text, factor, symbols, unit) {
  const [, digits = "", written = ""] = /^\s*([^\sa-zA-Z°]+(?:[eE][+-]?\d+)?)\s*(.*?)\s*$/.exec(text) ?? [];
  const number = digits ? Number(digits.replace(",", ".")) : NaN;
  try { return number * (written ? factorBetween(symbols, written.replaceAll("·", ".").replace("°", "deg"), unit || "1") : factor); } catch { return NaN; }
}

function element(tag, properties = {}, ...children) {
  const made = document.createElement(tag);
  for (const [key, value] of Object.entries(properties)) {
    if (key in made) made[key] = value;
    else made.setAttribute(key, value);
  }
  made.append(...children);
  return made;
}
const select = (options, value, properties = {}) => {
  const made = element("select", properties, ...options.map((each) => element("option", { value: each }, words(each))));
  made.value = value;
  return made;
};

class Form {
  /** `get()` returns the drive; `set(path, value, done)` changes it, `done` if the change is complete; `entryOf(path)` the entry of a number; `explain(row)` draws its picture. */
  constructor(root, schema, unitOf, get, set, entryOf, explain) {
    Object.assign(this, { root, schema, unitOf, get, set, entryOf, explain, rows: new Map(), open: new Set(), used: new Set() });
  }
  /** Anew: a law, a length or a unit is another. */
  build() {
    const focus = document.activeElement?.id, drive = this.get(), { models } = this.schema;
    this.rows.clear();
    const gear = models.Gear.fields, loose = gear.filter((field) => field.kind !== "part");
    const parts = gear.filter((field) => field.kind === "part"), idle = (field) => !this.used.has(field.name);
    for (const field of parts) if (!sameValues(drive.gear[field.name], field.default)) this.used.add(field.name); // and stays in its place
    const shown = (field) => this.part(field, drive.gear[field.name], ["gear", field.name]);
    const own = element("fieldset", {}, element("legend", {}, "gear"), ...loose.flatMap((field) => this.member(field, drive.gear[field.name], ["gear", field.name])));
    const rest = models.Drive.fields.filter((field) => field.name !== "gear").map((field) => this.part(field, drive[field.name], [field.name]));
    this.root.replaceChildren(
      ...parts.filter((field) => !idle(field)).map(shown), own,
      this.folded("default", "Parts of the gear that are as by default", parts.filter(idle).map(shown)),
      this.folded("drive", "Drive: motor, control, load, sensors", rest),
    );
    if (focus) document.getElementById(focus)?.focus();
  }
  folded(key, title, content) {
    const made = element("details", { open: this.open.has(key) }, element("summary", {}, title), ...content);
    made.addEventListener("toggle", () => (made.open ? this.open.add(key) : this.open.delete(key)));
    return made;
  }
  part(field, value, path) {
    const id = modelOf(this.schema, field, value), model = this.schema.models[id], key = path.join(".");
    const made = element("fieldset", {}, element("legend", {}, words(field.name)));
    if (field.chosen && field.options.length > 1) {
      const menu = select(field.options.map((each) => this.schema.models[each].name), model.name, { id: `law-${key}`, "aria-label": `law of ${words(field.name)}` });
      menu.onchange = () => {
        const chosen = field.options.find((each) => this.schema.models[each].name === menu.value);
        this.set(path, { model: menu.value, ...completed(this.schema, chosen, shared(this.schema, chosen, value)) }, true, true);
      };
      made.append(element("div", { className: "law" }, menu));
    }
    const { motor } = this.get(), motorModel = modelOf(this.schema, this.schema.models.Drive.fields.find(({ name }) => name === "motor"), motor);
    const fields = id.startsWith("control.") ? fieldsWithMotor(model.fields, this.schema.models[motorModel].command) : model.fields;
    const help = element("details", { className: "help" }, element("summary", {}, model.doc || field.doc),
      element("div", { innerHTML: model.help ?? "" }), element("p", {}, `Source: ${model.source}`), element("p", {}, "Python: ", element("code", {}, `sw.${id}`)));
    made.append(help);
    made.append(...fields.flatMap((inner) => (inner.kind === "part" ? [this.part(inner, value[inner.name], [...path, inner.name])]
      : this.member(inner, value[inner.name], [...path, inner.name], fields, value))));
    return made;
  }
  /** Rows of a parameter. Sequences of a model that are as long, as orders and amplitudes, grow and shrink together. */
  member(field, value, path, fields = [], values = {}) {
    const key = path.join(".");
    if (field.kind === "choice") {
      const menu = select(field.options, value, { id: `field-${key}` });
      menu.onchange = () => this.set(path, menu.value, true);
      return [element("div", { className: "row wide" }, element("label", { htmlFor: menu.id }, words(field.name)), menu, element("div", { className: "doc" }, field.doc))];
    }
    if (field.kind !== "sequence") return [this.row(field, path, words(field.name))];
    const resized = (by) => {
      const alike = fields.filter((each) => each.kind === "sequence" && values[each.name].length === value.length);
      const changed = alike.map((each) => [each.name, by < 0 ? values[each.name].slice(0, by) : [...values[each.name], values[each.name].at(-1) ?? zeroScale(each)]]);
      this.set(path.slice(0, -1), { ...values, ...Object.fromEntries(changed) }, true, true);
    };
    const count = element("div", { className: "bar" }, element("small", {}, `${words(field.name)}: ${field.doc}`),
      element("span", {}, this.button(`one more element of ${words(field.name)}`, "+", () => resized(1)),
        this.button(`one element of ${words(field.name)} less`, "−", () => resized(-1))));
    return [count, ...value.map((_, i) => this.row(field, [...path, i], `${words(field.name)} ${i + 1}`))];
  }
  button(label, text, act) {
    const made = element("button", { type: "button", className: "small", title: label, "aria-label": label }, text);
    made.onclick = act;
    return made;
  }
  row(field, path, label) {
    const isPhase = field.unit === "rad" && field.name.endsWith("phase"); // of a wave, which no plot shows as an angle
    const key = path.join("."), { factor, text } = isPhase ? { factor: Math.PI / 180, text: "°" } : this.unitOf(field.unit);
    const input = element("input", { id: `field-${key}`, inputMode: "decimal", autocomplete: "off", spellcheck: false, "aria-describedby": `doc-${key}` });
    const slider = element("input", { type: "range", min: -100, max: 100, value: 0, step: 1, tabIndex: -1, "aria-label": `change ${label}` });
    const effect = element("span", { className: "effect" });
    const doc = element("div", { className: "doc", id: `doc-${key}` }, this.limits(field, text, factor));
    const mark = element("small", { className: "mark" }), source = element("div", { className: "doc" }), picture = element("div", { className: "doc picture" });
    const made = element("div", { className: "row" }, element("label", { htmlFor: input.id }, label, " ", element("small", {}, text), " ", mark), input, slider, effect, doc, source, picture);
    const row = { label: `${words(String(path.at(typeof path.at(-1) === "number" ? -3 : -2)))} ${label}`, field, path, input, slider, effect, factor, mark, source, picture, made };
    made.addEventListener("focusin", () => this.explain(row));
    const put = (value, done) => {
      const wrong = problemOf(field, value);
      input.classList.toggle("wrong", Boolean(wrong));
      input.setCustomValidity(wrong);
      doc.textContent = wrong ? `${label} ${wrong}` : this.limits(field, text, factor);
      if (!wrong) this.set(path, value, done);
      return !wrong;
    };
    input.onchange = () => { if (put(numberOf(input.value, factor, this.schema.symbols, field.unit), true)) this.refresh(row); };
    input.onkeydown = (event) => {
      if (event.key !== "ArrowUp" && event.key !== "ArrowDown") return;
      event.preventDefault();
      const by = event.shiftKey ? COARSE : FINE, now = valueAt(this.get(), path), up = event.key === "ArrowUp";
      const next = field.kind === "number" || field.kind === "sequence" ? (up ? now * by : now / by) : now + (up ? 1 : -1);
      if (put(next, true)) this.refresh(row);
    };
    let base = null;
    const begin = () => { base ??= valueAt(this.get(), path); };
    slider.onpointerdown = slider.onkeydown = begin;
    slider.oninput = () => {
      begin();
      const share = slider.value / 100, whole = field.kind === "whole" || field.kind === "count";
      const next = base === 0 ? share * zeroScale(field) : base * 2 ** (OCTAVES * share);
      const value = Math.min(field.max ?? Infinity, Math.max(field.min ?? -Infinity, whole ? Math.round(next) : next));
      if (problemOf(field, value)) return;
      this.set(path, value, false);
      this.showValue(row);
    };
    slider.onchange = () => { base = null; slider.value = 0; this.set(path, valueAt(this.get(), path), true); };
    this.rows.set(key, row);
    this.refresh(row);
    return made;
  }
  limits(field, unit, factor) {
    const end = (value, none) => (value === undefined ? none : shortText(value / factor));
    const low = field.open || field.min === undefined ? "(" : "[", high = field.max === undefined ? ")" : "]";
    return `${field.doc}${unit ? ` [${unit}]` : ""}, in ${low}${end(field.min, "−∞")}, ${end(field.max, "∞")}${high}`;
  }
  shown({ path, factor, field }) {
    const value = valueAt(this.get(), path) / factor, text = String(Number(value.toPrecision(DIGITS)));
    if (field.kind === "whole" || field.kind === "count") return String(value);
    return text.length > MAX_SHOWN ? value.toExponential(DIGITS - 1).replace(/\.?0+e/, "e") : text;
  }
  /** The text of a number, which is that of its field until someone types. */
  showValue(row) { row.input.value = row.input.defaultValue = this.shown(row); }
  refresh(row) {
    this.showValue(row);
    row.input.classList.remove("wrong");
    row.input.setCustomValidity("");
    this.showSource(row);
  }
  showSource({ path, mark, source, made, factor }) {
    const [text, spread, sigma] = this.entryOf(path), deviation = sigma !== null && shortText(sigma / factor, 2);
    mark.textContent = stateOf(text, deviation);
    const more = [spread !== null && `single gears scatter by ± ${shortText(100 * spread, 2)} %`, deviation && `standard deviation ${deviation}`].filter(Boolean);
    made.title = source.textContent = [`Source: ${text}`, ...more].join("; ");
  }
  refreshAll() {
    for (const row of this.rows.values()) {
      if (row.input === document.activeElement) this.showSource(row); else this.refresh(row);
      if (row.made.contains(document.activeElement)) this.explain(row);
    }
  }
}

/** The state of a number by its source; of one that was published or measured apart, the first words of the source. */
function stateOf(source, deviation) {
  if (source.startsWith("identified in combination")) return "in combination";
  if (source.startsWith("identified")) return deviation ? `identified ± ${deviation}` : "identified";
  if (/^(fitted|not determined)/.test(source)) return "not determined";
  if (source.startsWith("assumed")) return "assumed";
  if (source === "not given") return "by default";
  const [first] = source.split(/[,;:]/);
  return first.length > MAX_MARK ? `${first.slice(0, MAX_MARK - 1)}…` : first;
}

/** Scale of a slider whose number is zero: the default of its field, else an angle of a turn, else one. */
const zeroScale = (field) => (typeof field.default === "number" && field.default) || (field.unit === "rad" ? Math.PI : 1);

/** The values that a law has in common with another: the same law within it or around it, else numbers of the same names. */
function shared(schema, id, values) {
  const { name, fields } = schema.models[id], within = Object.values(values).find((value) => value?.model === name);
  if (within) return within;
  const kept = {}, sequences = fields.filter((field) => field.kind === "sequence"), together = sequences.every((field) => Object.hasOwn(values, field.name));
  for (const field of fields) {
    const value = field.kind === "part" ? values : values[field.name];
    if (value === undefined || (field.kind === "sequence" && !together)) continue;
    try { kept[field.name] = checked(schema, id, field, value); } catch { /* the default, then */ }
  }
  return kept;
}
