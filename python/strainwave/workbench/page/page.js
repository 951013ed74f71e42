// The page: state, history, plots and exports.

const MAX_UNDO = 200;
const SLOW_RUN = 14; // ms: a run that takes longer waits until the hand rests
const REST = 120; // ms
const MAX_MEASURED = 16000; // points: a loop goes through them twice, within the capacity of the core
const MAX_LINKED = 3000; // points of all plots in a link
const LINKED_DIGITS = 7; // of a measured number in a link
const TRAVEL_SHARE = 0.3; // of the rated torque: travel of the loop of a gear from a file
const MAX_CORRELATION = 0.5; // of each residual with the one before: beyond it, a fit is doubted
const EFFECT = 1.1; // factor of a number whose effect is shown
const MAX_BLOCK = 12; // ms: effects of many numbers are computed in pieces as long
const MIN_EFFECT = 5e-5; // relative change: a smaller one is not shown
const MAX_STRONGEST = 4; // numbers below a plot
const DRIVE_PARTS = { motor: "motor", control: "controller", load: "load" }; // of a drive, by name
const SIGNS = { "N.m": "N·m", "mN.m": "mN·m", "kgf.m": "kgf·m", "kgf.cm": "kgf·cm" };

const by = (id) => document.getElementById(id);
const dataIn = (id) => JSON.parse(by(id).textContent);

const VIEW = {
  units: { angle: "arcmin", speed: "rpm", torque: "N.m" },
  travel: { by: "torque", torque: 10, twist: 1e-3, history: "closed loop" },
  friction: { place: "input", maxSpeed: 210, speed: 52.4, angle: 0, load: 0, temperature: ROOM_TEMPERATURE },
  run: { command: "step", amplitude: 0.1, frequency: 2, duration: 0.5, load: 0, shown: "output angle" },
  effect: "loop width",
};

const EFFECTS = ["loop width", "mean stiffness", "friction at speed", "kinematic error"];
const SLOTS = ["loop", ...PLACES.map((place) => `friction of ${place}`)]; // of measured data
const POSITIVE = ["duration", "frequency", "maxSpeed", "temperature"]; // numbers of a view

/** A view from a link: finite numbers, and texts that their menus have; the rest is as in VIEW. */
function viewFrom(schema, given, like = VIEW) {
  const texts = { by: ["torque", "twist"], history: Object.keys(HISTORIES), place: PLACES, command: ["step", "sine"], shown: Object.keys(OUTPUTS), effect: EFFECTS };
  if (like === VIEW.units) for (const of in like) texts[of] = Object.keys(schema.units[of]);
  const allowed = (key, value) => (typeof value === "number" ? Number.isFinite(value) && (value > 0 || !POSITIVE.includes(key)) : texts[key].includes(value));
  return Object.fromEntries(Object.entries(like).map(([key, value]) => {
    const other = given && Object.hasOwn(given, key) ? given[key] : undefined;
    if (typeof value === "object") return [key, viewFrom(schema, other, value)];
    return [key, typeof other === typeof value && allowed(key, other) ? other : value];
  }));
}

/** Measured points by plot as a link contains them; null if there are too many. */
function linkedPoints(measured) {
  const rounded = (values) => Array.from(values, (value) => Number(value.toPrecision(LINKED_DIGITS)));
  const count = Object.values(measured).reduce((sum, { x }) => sum + x.length, 0);
  return count > MAX_LINKED ? null : Object.fromEntries(Object.entries(measured).map(([slot, { x, y }]) => [slot, [rounded(x), rounded(y)]]));
}
const zerosFrom = (given) => (Array.isArray(given) && given.length === 2 && given.every(Number.isFinite) ? given : null);
/** Measured points by plot from a link: columns of finite numbers, as long, of plots that take them. */
function pointsFrom(given) {
  const isColumn = (values) => Array.isArray(values) && values.length > 1 && values.length <= MAX_LINKED && values.every(Number.isFinite);
  return Object.fromEntries(SLOTS.flatMap((slot) => {
    const [x, y] = given && Object.hasOwn(given, slot) && Array.isArray(given[slot]) ? given[slot] : [];
    return isColumn(x) && isColumn(y) && x.length === y.length ? [[slot, { x: Float64Array.from(x), y: Float64Array.from(y) }]] : [];
  }));
}

/** Places of the numbers of these parts in a set, but for whole ones. */
const placesOf = (set, parts) => set.paths.flatMap((path, i) => (parts.includes(path.split(".")[0]) && ["number", "sequence"].includes(set.fields[i].kind) ? [i] : []));

/** True if the browser itself undoes in an element: a field of another page, or one whose text the page does not have yet. */
const isTyped = (field) => Boolean(field?.matches("input:not([type=range]), textarea") && (!field.closest("#form, #plots, #name") || field.value !== field.defaultValue));
/** A name of one line, of whole characters. */
const nameFrom = (text) => lineFrom(text.slice(0, 80));
/** A relative change in percent, as "+3.3 %". */
const changeText = (change) => `${change > 0 ? "+" : "−"}${shortText(Math.abs(100 * change), 2)}\u00a0%`;

/** Python that computes the friction over the speed of the input at the place of a view. */
function frictionPython({ place, load, temperature }) {
  const of = (part, by) => `gear.${part}.steady(speed${by && " / ratio"}, load=${floatText(load)}${by && " * ratio"}, temperature=${floatText(temperature)})`;
  const part = frictionPart(place);
  if (place === "input") return [`friction = ${of(part, "")}  # N.m`];
  if (part) return ["ratio = abs(gear.kinematics.ratio)", `friction = ${of(part, "ratio")}  # N.m, over speed / ratio`];
  return ["ratio = gear.kinematics.ratio", `friction = ${of("friction_input", "")}`, ...["friction_mesh", "friction_output"].map((each) => `friction += ${of(each, "ratio")} / ratio  # N.m`)];
}

class Workbench {
  constructor(core, schema, catalogue, start) {
    Object.assign(this, { core, schema, catalogue, start, past: [], future: [], measured: {}, other: null, });
    const origin = this.origin(start.name, start);
    this.state = { name: start.name, drive: origin.drive, view: viewFrom(schema, { travel: start.travel }), origin, zeros: null };
    this.saved = this.state;
  }
  // ---- State ---------------------------------------------------------------------------------------------------------
  get view() { return this.state.view; }
  /** Where the numbers of a state come from: of a gear that the page contains, else nothing. It goes with the state through Undo. */
  origin(key, gear) { return gear ? { key, ...originFrom(this.schema, gear) } : { key, drive: null, sources: new Map(), ratings: new Map(), parts: [], rated: null }; }
  /** That of a link: the key of a gear of the page, or what the link contains of a gear from a file. */
  originOfLink(key) {
    if (isTable(key)) return this.origin(null, key);
    if (key === this.start.name) return this.origin(key, this.start);
    return this.origin(key, typeof key === "string" && Object.hasOwn(this.catalogue, key) ? this.catalogue[key] : null);
  }
  /** Source, spread and standard deviation of the number at these keys. A sequence keeps them as a whole. */
  entryOf(keys) {
    const { drive, origin } = this.state, whole = keys.filter((key) => typeof key === "string"), name = whole.join(".");
    if (!origin.drive || !sameValues(valueAt(drive, whole), valueAt(origin.drive, whole))) return ["set in the workbench", null, null];
    const path = keys.length > whole.length ? `${name}[${keys.at(-1)}]` : name;
    return origin.sources.get(path) ?? [keys[0] === "gear" || origin.parts.includes(keys[0]) ? "not given" : "assumed by the workbench", null, null];
  }
  /** The covariance of the numbers that are as they were, among the parts of a file; null if there is none. */
  covarianceOf(parts) {
    const { numbers, matrix } = this.state.origin.covariance ?? { numbers: [] }, { sources } = this.state.origin;
    const kept = numbers.flatMap((path, i) => { const keys = keysOf(path); return ["gear", ...parts].includes(keys[0]) && sources.has(path) && this.entryOf(keys) === sources.get(path) ? [i] : []; });
    return kept.length ? { numbers: kept.map((i) => numbers[i]), matrix: kept.map((i) => kept.map((k) => matrix[i][k])) } : null;
  }
  /** The parts of the drive as the page assumes them. */
  assumedParts() {
    const { drive, origin } = this.state;
    return Object.keys(DRIVE_PARTS).filter((part) => origin.drive && !origin.parts.includes(part) && sameValues(drive[part], origin.drive[part])).map((part) => DRIVE_PARTS[part]);
  }
  /** The other parts of which a number is assumed. */
  partsWithAssumed() {
    const whole = this.assumedParts();
    return Object.keys(DRIVE_PARTS).filter((part) => !whole.includes(DRIVE_PARTS[part]) && this.assumes(part)).map((part) => `the ${DRIVE_PARTS[part]}`);
  }
  change(state, done, rebuild = false) {
    this.state = state;
    if (done) {
      if (!sameValues(this.saved, state)) { this.past.push(this.saved); if (this.past.length > MAX_UNDO) this.past.shift(); this.future = []; }
      this.saved = state;
    }
    if (rebuild) { this.form.build(); this.buildControls(); }
    this.draw();
  }
  setDrive(path, value, done, rebuild) { this.change({ ...this.state, drive: replaced(this.state.drive, path, value) }, done, rebuild); }
  setView(path, value, rebuild) { this.change({ ...this.state, view: replaced(this.view, path, value) }, true, rebuild); }
  travelBack(from, to) {
    if (!from.length) return;
    to.push(this.saved);
    this.state = this.saved = from.pop();
    this.showAll();
  }
  /** Shows the top of the page and of the form, for a gear that was opened. */
  toTop() { by("form").scrollTop = 0; scrollTo(0, 0); }
  showAll() {
    by("name").value = by("name").defaultValue = this.state.name;
    this.form.build();
    this.buildControls();
    this.draw();
  }
  // ---- Units ---------------------------------------------------------------------------------------------------------
  /** Factor to SI and text of the user's unit of a quantity. */
  unit(of) {
    const name = this.view.units[of];
    return { factor: this.schema.units[of][name] ?? 1, text: SIGNS[name] ?? name };
  }
  unitOf(unit) {
    const { angle, speed, torque } = { angle: this.unit("angle"), speed: this.unit("speed"), torque: this.unit("torque") };
    if (unit === "rad") return angle;
    if (unit === "rad/s") return speed;
    if (unit === "N.m") return torque;
    if (unit === "N.m/rad") return { factor: torque.factor / angle.factor, text: `${torque.text}/${angle.text}` };
    return { factor: 1, text: unit === "1" || !unit ? "" : unit.replaceAll(".", "·").replace(/([a-zA-Z)])(-?)(\d)/g, (_, letter, minus, power) => letter + (minus && "⁻") + "⁰¹²³⁴⁵⁶⁷⁸⁹"[power]) };
  }
  say(text, bad = false) { by("status").textContent = text; by("status").classList.toggle("bad", bad); }
  // ---- Drawing -------------------------------------------------------------------------------------------------------
  draw() {
    by("undo").disabled = !this.past.length;
    by("redo").disabled = !this.future.length;
    by("swap").disabled = by("forget").disabled = !this.other;
    if (this.waiting) return;
    this.waiting = true;
    requestAnimationFrame(() => { this.waiting = false; this.drawNow(); });
  }
  drawNow() {
    const begin = performance.now();
    this.sets = setsOf(this.schema, this.state.drive);
    this.otherSets = this.other && setsOf(this.schema, this.other.drive);
    let problem = "";
    for (const card of this.cards) if (!card.slow) problem ||= this.drawCard(card);
    if (problem || this.problem) this.say(problem, Boolean(problem));
    this.problem = problem;
    const run = this.cards.find((card) => card.slow);
    clearTimeout(this.later);
    if ((this.runTime ?? 0) < SLOW_RUN && !problem) this.drawRun(run);
    else this.later = setTimeout(() => this.drawRun(run), REST);
    this.frame = performance.now() - begin;
    clearTimeout(this.rested);
    this.rested = setTimeout(() => { this.form.refreshAll(); this.showEffects(); this.remember(); }, REST);
  }
  drawRun(card) {
    const begin = performance.now();
    this.drawCard(card);
    this.runTime = performance.now() - begin;
  }
  /** Draws a plot; returns why it cannot be drawn. */
  drawCard(card) {
    try {
      const pieces = [card.of(this.sets, "one")];
      if (this.otherSets) { try { pieces.push(card.of(this.otherSets, "other")); } catch { /* the kept gear does not reach this */ } }
      card.pieces = pieces;
      const measured = card.takes && this.measured[card.slot()];
      const curves = pieces.flatMap(({ curves }) => curves).reverse();
      if (measured) curves.unshift(this.scaled(this.behindZeros(card, measured), card.axes(), { colour: "--data", mark: "point" }));
      card.plot.show(card.axes().map(({ label }) => label), curves);
      const read = pieces.map(({ numbers }, i) => element("span", { className: i ? "other" : "" }, i ? `${this.other.name}: ` : "", ...numbers.flatMap(([label, text], k) => [`${k ? ", " : ""}${label} `, element("b", {}, text)])));
      if (measured) read.push(element("span", { className: "measured" }, "measured: ", element("b", {}, card.residual(measured)), " "), ...(card.fits().length ? [this.button("Fit", () => this.fit(card))] : []));
      card.numbers.replaceChildren(...read);
      card.element.querySelector(".canvas").setAttribute("aria-label", `${card.title}: ${card.numbers.textContent}`);
      return "";
    } catch (error) {
      if (error instanceof WebAssembly.RuntimeError) this.core.begin();
      card.numbers.replaceChildren(element("span", { className: "problem" }, error.message));
      card.plot.show(card.axes().map(({ label }) => label), []);
      return error.message;
    }
  }
  /** The measured points of a plot from the zeros that a fit found. */
  behindZeros(card, { x, y }) {
    const [torqueZero, twistZero] = (card.key === "loop" && this.state.zeros) || [0, 0];
    return { x: x.map((value) => value - twistZero), y: y.map((value) => value - torqueZero) };
  }
  scaled(curve, axes, more) {
    const scale = (list, { factor }) => Float64Array.from(list, (value) => value / factor);
    return { x: scale(curve.x, axes[0]), y: scale(curve.y, axes[1]), ...more };
  }
  // ---- The plots -----------------------------------------------------------------------------------------------------
  makeCards() {
    const shared = { loop: sharedByPlots((sets) => loopOf(this.core, sets, this.view.travel)), error: sharedByPlots((sets) => errorOverTurn(this.core, sets)) };
    return CARDS.map((kind) => new kind(this, shared));
  }
  /** True if a number of a part of the gear or drive is assumed. */
  assumes(...keys) { return [...this.form.rows.values()].some(({ path }) => keys.every((key, i) => path[i] === key) && this.entryOf(path)[0].startsWith("assumed")); }
  buildCards() {
    this.cards = this.makeCards();
    by("plots").replaceChildren(...this.cards.map((card) => {
      const canvas = element("div", { className: "canvas", role: "img" });
      card.at = element("small", { className: "at" });
      card.numbers = element("p", { className: "numbers" });
      card.strongest = element("p", { className: "strongest" });
      card.bar = element("div", { className: "controls" });
      const save = [this.button("CSV", () => this.saveCsv(card)), this.button("PNG", async () => this.download(`${card.key}.png`, await card.plot.png())), this.button("SVG", () => this.download(`${card.key}.svg`, card.plot.svg(card.title)))];
      if (card.takes) save.unshift(this.button("Data…", () => this.askMeasured(card)));
      card.element = element("article", { className: "plot", id: card.key }, element("div", { className: "bar" }, element("h2", {}, card.title), element("div", { className: "controls" }, ...save)), card.bar, canvas, card.numbers, card.strongest);
      canvas.append(card.at);
      if (card.takes) {
        card.element.ondragover = (event) => { event.preventDefault(); card.element.classList.add("over"); };
        card.element.ondragleave = () => card.element.classList.remove("over");
        card.element.ondrop = async (event) => {
          card.element.classList.remove("over");
          const [file] = event.dataTransfer.files;
          if (!file || file.name.endsWith(".toml")) return; // the page opens it
          event.preventDefault();
          event.stopPropagation();
          this.takeMeasured(card, await file.slice(0, 1 << 23).text());
        };
      }
      return card.element;
    }));
    for (const card of this.cards)
      card.plot = new Plot(card.element.querySelector(".canvas"), (x, y) => { card.at.textContent = x === null ? "" : card.textAt(x, y); });
    this.buildControls();
  }
  buildControls() {
    for (const card of this.cards) card.bar.replaceChildren(...(card.controls?.() ?? []));
    by("units").replaceChildren(...Object.entries(this.schema.units).map(([of, names]) => {
      const menu = select(Object.keys(names), this.view.units[of], { "aria-label": `unit of ${of}` });
      menu.onchange = () => { this.setView(["units", of], menu.value, true); this.buildControls(); };
      return menu;
    }));
    by("effect").value = this.view.effect;
  }
  button(text, act) { const made = element("button", { type: "button" }, text); made.onclick = act; return made; }
  choice(path, options, label) {
    const menu = select(options, valueAt(this.view, path), { "aria-label": label });
    menu.onchange = () => { this.setView(path, menu.value); this.buildControls(); };
    return menu;
  }
  numberControls(group, rows) {
    return rows.map(([name, label, unit]) => {
      const { factor, text } = this.unitOf(unit);
      const shown = String(Number((this.view[group][name] / factor).toPrecision(6))), input = element("input", { inputMode: "decimal", defaultValue: shown, value: shown });
      input.onchange = () => {
        const value = numberOf(input.value, factor, this.schema.symbols, unit);
        const wrong = !Number.isFinite(value) ? "is no number" : POSITIVE.includes(name) && value <= 0 ? "must be above 0" : "";
        if (wrong) this.say(`${label}: ${input.value} ${wrong}`, true);
        else { input.defaultValue = input.value; this.setView([group, name], value); }
      };
      return element("label", {}, `${label} `, input, ` ${text}`);
    });
  }
  travelControls() {
    const wanted = this.view.travel.by === "torque" ? ["torque", "±", "N.m"] : ["twist", "±", "rad"];
    const made = [this.choice(["travel", "history"], Object.keys(HISTORIES), "history of the twist"), this.choice(["travel", "by"], ["torque", "twist"], "travel given by"), ...this.numberControls("travel", [wanted])];
    const { rated } = this.state.origin;
    if (this.view.travel.by === "torque") made.push(rated ? `= ${shortText((100 * this.view.travel.torque) / rated, 3)} % of rated torque` : "rated torque not given");
    return made;
  }
  /** Unit of the command: that of the controller, of the law that a sampled one contains, or of the motor in open loop. */
  commandUnit() {
    const { control, motor } = this.state.drive, models = Object.values(this.schema.models);
    const of = ({ model }) => models.find(({ name, command }) => command && name === model)?.command;
    return of(control.law?.model ? control.law : control) ?? of(motor);
  }
  runControls() {
    const { command, amplitude } = this.view.run, unit = this.commandUnit(), { factor } = this.unitOf(unit);
    return [this.choice(["run", "command"], ["step", "sine"], "command"), ...this.numberControls("run", [["amplitude", "amplitude", unit]]), ...(factor === 1 ? [] : [`= ${shortText(amplitude)} ${unit}`]), ...this.numberControls("run", [...(command === "sine" ? [["frequency", "frequency [Hz]", ""]] : []), ["duration", "duration [s]", ""]]),
      this.choice(["run", "shown"], Object.keys(OUTPUTS), "output shown")];
  }
  // ---- Effects -------------------------------------------------------------------------------------------------------
  get measures() {
    return {
      "loop width": (sets) => numbersOfLoop(loopOf(this.core, sets, this.view.travel)).width,
      "mean stiffness": (sets) => numbersOfLoop(loopOf(this.core, sets, this.view.travel)).stiffness,
      "friction at speed": (sets) => frictionAtSpeed(this.core, sets, this.view.friction),
      "kinematic error": (sets) => { const { y } = errorOverTurn(this.core, sets); return Math.max(...y) - Math.min(...y); },
    };
  }
  /** Beside each number of the gear: the change of the chosen measure if it grows by 10 %. */
  async showEffects() {
    const changes = await this.effects();
    if (!changes) return;
    for (const row of this.form.rows.values()) {
      const change = changes.get(row.path.join("."))?.[this.view.effect], shown = Math.abs(change) > MIN_EFFECT;
      row.effect.textContent = shown ? changeText(change) : "";
      row.effect.classList.toggle("strong", shown && Math.abs(change) > 0.02);
    }
    for (const card of this.cards) if (card.measure) this.showStrongest(card, changes);
  }
  /** Relative change of every measure if a number of the gear grows by 10 %, by the path of its row; null if the gear changes meanwhile. */
  async effects() {
    const { sets } = this, { drive } = this.state, { gear } = sets, measures = Object.entries(this.measures);
    const valueOf = (measure, sets) => { try { return measure(sets); } catch { return NaN; } }; // the plot says why
    const now = measures.map(([, measure]) => valueOf(measure, sets)), changes = new Map();
    let begin = performance.now();
    for (let i = 0; i < gear.paths.length; i++) {
      if (gear.numbers[i] === 0 || gear.fields[i].kind === "count") continue;
      const keys = ["gear", ...keysOf(gear.paths[i])], changed = setsOf(this.schema, replaced(drive, keys, gear.numbers[i] * EFFECT));
      changes.set(keys.join("."), Object.fromEntries(measures.map(([name, measure], k) => [name, now[k] === 0 ? NaN : valueOf(measure, changed) / now[k] - 1])));
      if (performance.now() - begin < MAX_BLOCK) continue;
      await new Promise((done) => setTimeout(done)); // the hand may move again
      if (this.sets !== sets) return null;
      begin = performance.now();
    }
    return changes;
  }
  /** Below a plot: the numbers that change its reading most. */
  showStrongest(card, changes) {
    const strong = [...changes].map(([key, of]) => ({ row: this.form.rows.get(key), change: of[card.measure] })).filter(({ row, change }) => row && Math.abs(change) > MIN_EFFECT)
      .sort((one, other) => Math.abs(other.change) - Math.abs(one.change)).slice(0, MAX_STRONGEST);
    const named = (words, group) => (group.length ? [words, ...group.flatMap(({ row, change }, i) => [i ? ", " : "", this.button(row.label, () => this.goTo(row, card.measure)), ` (${changeText(change)})`])] : []);
    const grows = named(" grows with ", strong.filter(({ change }) => change > 0)), falls = named(`${grows.length ? ";" : ""} falls with `, strong.filter(({ change }) => change < 0));
    card.strongest.replaceChildren(...(strong.length ? [card.measure, ...grows, ...falls, ", for 10 % more of each"] : []));
  }
  /** Shows the row of a number, and the effects on a measure. */
  goTo(row, measure) {
    this.setView(["effect"], measure);
    by("effect").value = measure;
    row.made.closest("details:not(.help)")?.setAttribute("open", "");
    row.input.focus({ preventScroll: true });
    const form = by("form"), box = form.getBoundingClientRect(), middle = 0.5 * (Math.max(box.top, 0) + Math.min(box.bottom, innerHeight));
    form.scrollTop += row.input.getBoundingClientRect().top - middle; // the plots stay where they are
    row.made.scrollIntoView({ block: "nearest" }); // on a narrow screen, where the page scrolls, and at the end of the form
  }
  /** In the help of a number: the curve that it changes most, now and with twice as much, or half where that is too much. */
  explain(row) {
    const { path, field, label, picture } = row, now = valueAt(this.state.drive, path);
    if (picture.contains(document.activeElement)) return;
    const equation = this.button("equation and validity", () => { const help = row.made.closest("fieldset").querySelector("details.help"); if (help) { help.open = true; help.scrollIntoView({ block: "nearest" }); } });
    picture.replaceChildren(equation);
    if (field.kind === "whole" || field.kind === "count" || !now) return;
    const [amount, found] = [["twice", 2], ["half", 0.5]].map(([word, factor]) => [word, this.changedCurve(path, factor * now)]).find(([, each]) => each) ?? [];
    if (!found) return;
    const { title, curves } = found, isSame = sameValues([...curves[0].y], [...curves[1].y]), words = `${title}: ${isSame ? `the same with ${amount} as much` : `solid now, dashed with ${amount} as much`}`;
    picture.prepend(smallPicture(`${label}. ${words}`, curves), element("div", {}, words));
  }
  /** The curve that changes most if the number at these keys becomes another, before and after; null if none can be drawn. */
  changedCurve(path, value) {
    const before = setsOf(this.schema, this.state.drive), after = setsOf(this.schema, replaced(this.state.drive, path, value));
    const drawn = this.curvesOf(path).flatMap(([title, of]) => {
      try {
        const curves = [{ ...of(before), look: "now" }, { ...of(after), look: "more" }], { rms } = rmsOf(curves[0].y, curves[1].y);
        return [{ title, curves, change: rms / rmsOf(curves[0].y, new Float64Array(curves[0].y.length)).rms || 0 }];
      } catch { return []; } // not allowed, or beyond what a law can do
    });
    return drawn.sort((one, other) => other.change - one.change)[0] ?? null;
  }
  /** The curves that show a number of the gear or drive, by their titles. */
  curvesOf([root, part]) {
    const { core, view } = this, place = PLACES.find((each) => frictionPart(each) === part), ofLoop = (sets) => loopOf(core, sets, view.travel);
    if (place) return [["friction over speed", (sets) => frictionOverSpeed(core, sets, { ...view.friction, place })], ["friction over a turn", (sets) => frictionOverAngle(core, sets, { ...view.friction, place })]];
    if (root === "gear" && part.startsWith("kinematic_")) return [["kinematic error over a turn", (sets) => errorOverTurn(core, sets)]];
    if (part === "stiffness" || part === "hysteresis") return [["torque over twist", (sets) => { const { twist, torque } = ofLoop(sets); return { x: twist, y: torque }; }]];
    return [[`${view.run.shown} over time`, (sets) => { const { time, output } = runOf(core, sets, view.run, OUTPUTS[view.run.shown][0]); return { x: time, y: output }; }]];
  }
  // ---- Measured data -------------------------------------------------------------------------------------------------
  askMeasured(card) {
    const [across, up] = card.axes();
    this.ask(`Measured data: ${across.label}, ${up.label}, a line each`, "", (text) => this.takeMeasured(card, text), "Two columns, separated by semicolon, tab, blanks or comma. Empty removes them. A file can be dropped on the plot.");
  }
  takeMeasured(card, text) {
    try {
      if (text.trim() === "") delete this.measured[card.slot()];
      else {
        const [across, up] = card.axes(), { x, y, skipped } = twoColumns(text, MAX_MEASURED);
        this.say(`${x.length} points read${skipped ? `, ${skipped} ${skipped > 1 ? "rows" : "row"} skipped` : ""}`);
        this.measured[card.slot()] = { x: x.map((value) => value * across.factor), y: y.map((value) => value * up.factor) };
      }
      if (card.key === "loop") this.change({ ...this.state, zeros: null, view: this.measuredView(null) }, true);
      this.buildControls();
      this.draw();
    } catch (error) { this.say(`measured data: ${error.message}`, true); }
  }
  /** The view with the travel of the measured loop, from its zeros; as it is without such a loop. */
  measuredView(zeros) {
    const { loop } = this.measured, [, twistZero] = zeros ?? [0, 0];
    const wanted = loop && { by: "twist", twist: Math.max(...loop.x.map((value) => Math.abs(value - twistZero))) };
    return { ...this.view, travel: { ...this.view.travel, ...wanted } };
  }
  /** Fits the numbers of the parts that a plot shows to its measured data. */
  fit(card) {
    const measured = this.measured[card.slot()], begin = performance.now();
    try {
      const { numbers, places, pathOf, ...found } = card.key === "loop" ? this.fitLoop(measured) : this.fitFriction(measured, card.fits()[0]);
      let { drive } = this.state;
      for (const place of places) drive = replaced(drive, ["gear", ...keysOf(pathOf(place))], numbers[place]);
      const view = found.zeros && this.view.travel.by === "twist" ? this.measuredView(found.zeros) : this.view;
      this.change({ ...this.state, drive, view, zeros: found.zeros ?? this.state.zeros }, true, true);
      const count = found.free.filter((place) => places.includes(place)).length, kept = found.kept ? `; ${found.kept} without influence stay` : "";
      const doubt = found.correlation > MAX_CORRELATION ? "the residuals follow one another: another law, or another start, fits better" : "strainwave identify gives their standard deviations";
      this.say(`${count} numbers fitted in ${found.iterations} iterations and ${Math.round(performance.now() - begin)} ms${kept}; ${doubt}`);
    } catch (error) { this.say(`the fit failed: ${error.message}`, true); }
  }
  fitLoop({ x, y }) {
    const { gear } = this.sets, places = placesOf(gear, ["stiffness", "hysteresis"]), record = new LoopRecord(x, y, this.state.zeros);
    const found = fittedLoop(this.core, gear, places, record);
    return { ...found, zeros: record.isLoop ? found.zeros : null, places, pathOf: (place) => gear.paths[place] };
  }
  fitFriction({ x, y }, part) {
    const gear = this.sets.gearWithInputFriction(part), places = placesOf(gear, ["friction_input"]), { place, angle, load, temperature } = this.view.friction;
    const points = [x, ...[angle, load * turnsAt(this.core, this.sets, place), temperature].map((value) => new Float64Array(x.length).fill(value))];
    const found = fitted((numbers, free) => this.core.slopes("friction", { ...gear, numbers }, points, free), gear.numbers, gear.fields, places, y);
    return { ...found, places, pathOf: (each) => gear.paths[each].replace("friction_input", part) };
  }
  // ---- Texts and files -----------------------------------------------------------------------------------------------
  /** Shows the gear of a file; parts of the drive that it lacks stay those shown. */
  async openFile(file) {
    try {
      if (file.size > MAX_FILE) throw new Error("larger than a gear file");
      this.openToml(await file.text());
      const kept = this.assumedParts();
      this.say(`${file.name} read${kept.length ? `; ${listed(kept)} as before, because the file has none` : ""}`);
    } catch (error) { this.say(`${file.name} cannot be read as a gear file: ${error.message}`, true); }
  }
  openToml(text) {
    const { name, drive: parts, ...given } = gearFromToml(this.schema, text), drive = { ...this.state.drive, ...parts };
    const origin = this.origin(null, { ...given, drive }), { rated } = origin, { travel } = this.view;
    const wanted = rated ? { by: "torque", torque: TRAVEL_SHARE * rated } : { by: "twist", twist: VIEW.travel.twist };
    this.change({ ...this.state, name: nameFrom(name), drive: origin.drive, view: { ...this.view, travel: { ...travel, ...wanted } }, origin }, true);
    this.showAll();
    this.toTop();
  }
  ask(title, content, use, hint = "") {
    by("text-title").textContent = title;
    Object.assign(by("text-content"), { value: content, placeholder: hint, readOnly: !use });
    by("text-use").hidden = !use;
    by("text-use").onclick = () => { by("text").close(); use(by("text-content").value); };
    by("text").showModal();
  }
  download(name, content) {
    const link = element("a", { href: URL.createObjectURL(content instanceof Blob ? content : new Blob([content], { type: "text/plain" })), download: name });
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 1000);
  }
  saveCsv(card) {
    const [across, up] = card.axes(), lines = [`curve,${across.label},${up.label}`];
    card.pieces.forEach(({ curves }, i) => curves.forEach(({ x, y }) => x.forEach((value, k) => { if (Number.isFinite(value + y[k])) lines.push(`${i ? "kept" : "now"},${value},${y[k]}`); })));
    this.download(`${card.key}.csv`, `${lines.join("\n")}\n`);
  }
  toml() {
    const { name, drive, origin } = this.state;
    const parts = Object.keys(drive).filter((part) => part !== "gear" && (origin.parts.includes(part) || !origin.drive || !sameValues(drive[part], origin.drive[part])));
    const { maker, note, ratings } = origin, head = { name: name.trim() || "gear", maker, note, ratings, covariance: this.covarianceOf(parts) };
    return gearToml(this.schema, head, drive, parts, (keys) => this.entryOf(keys));
  }
  python() {
    const { travel, friction, run } = this.view, { drive } = this.state;
    const turns = HISTORIES[travel.history].map((share) => share * travel[travel.by]);
    return [
      "import numpy as np", "import strainwave as sw", "", `gear = ${pythonOf(this.schema, "Gear", drive.gear)}`, "",
      travel.by === "torque" ? `turns = gear.twist(np.array([${turns.map(floatText).join(", ")}]))  # rad, where the path turns round` : `turns = np.array([${turns.map(floatText).join(", ")}])  # rad, where the path turns round`,
      "ends = np.concatenate([[0.0], turns])",
      `twist = np.concatenate([[0.0], *(np.linspace(a, b, ${PER_STRETCH + 1})[1:] for a, b in zip(ends, ends[1:]))])`,
      "torque = gear.trace(twist)  # N.m", "",
      `speed = np.linspace(${floatText(friction.maxSpeed / 200)}, ${floatText(friction.maxSpeed)}, 200)  # rad/s`,
      ...frictionPython(friction),
      `angle = np.linspace(0.0, 2.0 * np.pi, ${TURN_POINTS + 1})`, "error = gear.kinematic_error.error(angle) + gear.kinematic_noise.error(angle)  # rad", "",
      `drive = ${pythonOf(this.schema, "Drive", drive, "", { gear: "gear" })}`,
      `command = sw.scenario.${run.command === "sine" ? "sine" : "step"}(amplitude=${floatText(run.amplitude)}, ${run.command === "sine" ? `frequency=${floatText(run.frequency)}, ` : ""}duration=${floatText(run.duration)})`,
      `run = sw.simulate(drive, command${run.load ? `, load_torque=${floatText(run.load)}` : ""})`, `run[${JSON.stringify(run.shown.replaceAll(" ", "_"))}]`, "",
    ].join("\n");
  }
  /** The fragment of a link to what is shown, and what it leaves out because that is too long for a link. */
  async linked() {
    const { name, drive, view, origin, zeros } = this.state, left = [];
    let data = { name, drive, view, zeros, origin: origin.key }, fragment = await toFragment(data);
    const more = { "the sources of the opened file": origin.drive && origin.key === null && { origin: portable(origin) }, "the measured data": Object.keys(this.measured).length && { measured: linkedPoints(this.measured) } };
    for (const [what, added] of Object.entries(more)) {
      if (!added) continue;
      const longer = added.measured === null ? null : await toFragment({ ...data, ...added });
      if (longer === null) left.push(what);
      else { fragment = longer; data = { ...data, ...added }; }
    }
    return { fragment, left };
  }
  async remember() {
    const { state } = this, { fragment, left } = await this.linked();
    if (state === this.state) history.replaceState(null, "", `#${(this.fragment = fragment)}`);
    return left;
  }
  async open(fragment) {
    const given = await fromFragment(fragment);
    this.measured = pointsFrom(given.measured);
    this.change({ name: nameFrom(String(given.name ?? "")), drive: completed(this.schema, "Drive", given.drive), view: viewFrom(this.schema, given.view), zeros: zerosFrom(given.zeros), origin: this.originOfLink(given.origin) }, true);
    this.showAll();
    this.toTop();
  }
  // ---- Begin ---------------------------------------------------------------------------------------------------------
  begin() {
    this.say("");
    this.form = new Form(by("fields"), this.schema, (unit) => this.unitOf(unit), () => this.state.drive, (...change) => this.setDrive(...change), (path) => this.entryOf(path), (row) => this.explain(row));
    by("effect").replaceChildren(...EFFECTS.map((name) => element("option", { value: name }, name)));
    this.buildCards();
    by("effect").onchange = () => this.setView(["effect"], by("effect").value);
    by("name").onchange = () => {
      by("name").defaultValue = by("name").value;
      this.change({ ...this.state, name: nameFrom(by("name").value) }, true);
    };
    by("catalogue").append(...Object.keys(this.catalogue).map((name) => element("option", { value: name }, name)));
    by("catalogue").onchange = () => {
      const key = by("catalogue").value, chosen = this.catalogue[key];
      by("catalogue").value = "";
      if (!chosen) return;
      const origin = this.origin(key, chosen);
      this.change({ ...this.state, name: chosen.name, drive: origin.drive, view: { ...this.view, travel: { ...this.view.travel, ...chosen.travel } }, origin }, true);
      this.showAll();
      this.toTop();
    };
    by("open").onclick = () => by("file").click();
    by("file").onchange = () => { const [file] = by("file").files; by("file").value = ""; if (file) this.openFile(file); };
    addEventListener("dragover", (event) => event.preventDefault());
    addEventListener("drop", (event) => { // unless a page around this one took it
      const [file] = event.dataTransfer.files;
      if (file && !event.defaultPrevented) this.openFile(file);
      event.preventDefault();
    });
    by("undo").onclick = () => this.travelBack(this.past, this.future);
    by("redo").onclick = () => this.travelBack(this.future, this.past);
    by("keep").onclick = () => { const { name, drive, origin } = this.state; this.other = { name: name || "kept", drive, origin }; this.draw(); };
    by("forget").onclick = () => { this.other = null; this.draw(); };
    by("swap").onclick = () => { const { name, drive, origin } = this.state, { other } = this; this.other = { name: name || "kept", drive, origin }; this.change({ ...this.state, ...other }, true); this.showAll(); };
    by("link").onclick = async () => {
      const left = await this.remember(), without = left.length ? `, without ${listed(left)}: too long for a link` : "";
      try { await navigator.clipboard.writeText(location.href); this.say(`link copied${without}`); } catch { this.ask(`Link${without}`, location.href); }
    };
    by("toml").onclick = () => this.download("gear.toml", this.toml());
    by("python").onclick = () => this.ask("Python that computes these curves", this.python());
    by("text-close").onclick = () => by("text").close();
    by("text-copy").onclick = () => { by("text-content").select(); navigator.clipboard?.writeText(by("text-content").value).catch(() => {}); };
    addEventListener("keydown", (event) => {
      const key = event.key.toLowerCase();
      if (!(event.ctrlKey || event.metaKey) || (key !== "z" && key !== "y") || isTyped(document.activeElement)) return;
      event.preventDefault();
      (event.shiftKey || key === "y" ? by("redo") : by("undo")).click();
    });
    addEventListener("hashchange", () => { const fragment = location.hash.slice(1); if (fragment && fragment !== this.fragment) this.openOrSay(fragment); });
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.draw());
    this.showAll();
  }
  openOrSay(fragment) { return this.open(fragment).catch((error) => this.say(`the link cannot be read: ${error.message}`, true)); }
}

async function start() {
  const core = await Core.of(await through(fromBase64(dataIn("wasm")), new DecompressionStream("gzip"), 1 << 24));
  const workbench = new Workbench(core, dataIn("schema"), dataIn("gears"), dataIn("gear")), fragment = location.hash.slice(1);
  workbench.begin();
  if (fragment) await workbench.openOrSay(fragment);
  return workbench;
}
if (typeof document !== "undefined")
  window.workbench = start().catch((error) => { by("status").textContent = `the workbench did not start: ${error.message}`; throw error; });
