// The plots of the page, each with its axes, curves and readings. A reading is a label with its text.

const DEGREES = { text: "°", factor: Math.PI / 180 };
const OUTPUTS = { "output angle": [3, "angle"], twist: [5, "angle"], "transmission error": [7, "angle"], torque: [8, "torque"], "input speed": [2, "speed"], "output speed": [4, "speed"] };
const SHOWN_COMMANDS = { "output angle": "rad", "output speed": "rad/s" }; // units of commands that are drawn with an output

/** A function of the sets of a drive whose result several plots of one frame share. */
function sharedByPlots(of) {
  const known = new WeakMap();
  return (sets) => {
    if (!known.has(sets)) known.set(sets, of(sets));
    return known.get(sets);
  };
}
const listed = (names) => [names.slice(0, -1).join(", "), names.at(-1)].filter(Boolean).join(" and ");
/** Which parts are assumed, and which have assumed numbers; empty if none. */
const assumedText = (whole, inPart) => [whole.length && `${listed(whole)} ${whole.length > 1 ? "are" : "is"} assumed`, inPart.length && `some numbers of ${listed(inPart)} are assumed`].filter(Boolean).join("; ");
const extentOf = (values) => Math.max(...values) - Math.min(...values);

/** A plot of the page. `shared` has the loop and the error that several plots draw. A plot that `takes` measured data names their slot. */
class Card {
  constructor(page, shared) { Object.assign(this, { page, shared }); }
  get core() { return this.page.core; }
  get view() { return this.page.view; }
  unit(of) { return this.page.unit(of); }
  get perAngle() { return this.page.unitOf("N.m/rad"); }
  axis(label, { text, factor }) { return { label: `${label} [${text}]`, factor }; }
  /** What stands beside the pointer at a place of the plot, in the units of the axes. */
  textAt(x, y) { return `${shortText(x)}, ${shortText(y)}`; }
  text(value, { text, factor }) { return `${shortText(value / factor)} ${text}`; }
  /** A curve in the units of the axes, of this gear or of the one that was kept. */
  curve(points, which, more = {}) {
    const look = { colour: which === "one" ? "--one" : "--other", dash: which !== "one" };
    return this.page.scaled(points, this.axes(), { ...look, ...more });
  }
  /** A second curve, grey and dashed. */
  besides(points) { return this.page.scaled(points, this.axes(), { colour: "--data", dash: true }); }
}

class LoopCard extends Card {
  key = "loop";
  title = "Torque over twist";
  measure = "loop width";
  takes = true;
  slot() { return "loop"; }
  fits() { return ["stiffness", "hysteresis"]; }
  axes() { return [this.axis("twist", this.unit("angle")), this.axis("torque", this.unit("torque"))]; }
  controls() { return this.page.travelControls(); }
  of(sets, which) {
    const loop = this.shared.loop(sets), { width, stiffness, loss } = numbersOfLoop(loop);
    const numbers = [["loop width", this.text(width, this.unit("angle"))], ["mean stiffness", this.text(stiffness, this.perAngle)], ["loss a cycle", `${shortText(loss)} J`]];
    if (which === "one" && this.page.assumes("gear", "hysteresis")) numbers.push(["from assumed numbers", ""]);
    return { curves: [this.curve({ x: loop.twist, y: loop.torque }, which)], numbers };
  }
  residual({ x, y }) {
    const { state: { zeros }, sets } = this.page, record = new LoopRecord(x, y, zeros ?? [0, 0]);
    const { rms, count } = rmsOf(record.predicted(this.core, sets.gear, [], record.zeros).values, y), text = `RMS residual ${this.text(rms, this.unit("torque"))} of ${count} points`;
    return zeros && record.isLoop ? `${text}; its zeros: torque ${this.text(zeros[0], this.unit("torque"))}, twist ${this.text(zeros[1], this.unit("angle"))}` : text;
  }
}

class StiffnessCard extends Card {
  key = "stiffness";
  title = "Stiffness over torque";
  measure = "mean stiffness";
  axes() { return [this.axis("torque", this.unit("torque")), this.axis("stiffness", this.perAngle)]; }
  of(sets, which) {
    const slopes = slopesOfLoop(this.shared.loop(sets)), finite = slopes.y.filter(Number.isFinite);
    return { curves: [this.curve(slopes, which)], numbers: [["of spring and hysteresis together: from", this.text(Math.min(...finite), this.perAngle)], ["to", this.text(Math.max(...finite), this.perAngle)]] };
  }
}

class RunCard extends Card {
  key = "run";
  title = "Response of the whole drive";
  slow = true;
  get output() { return OUTPUTS[this.view.run.shown]; }
  axes() { return [{ label: "time [s]", factor: 1 }, this.axis(this.view.run.shown, this.unit(this.output[1]))]; }
  controls() { return this.page.runControls(); }
  /** A value in the unit of the user, and in SI if that is another one. */
  both(value) {
    const [, quantity] = this.output, unit = this.unit(quantity), [si] = Object.keys(this.page.schema.units[quantity]);
    return `${this.text(value, unit)}${unit.factor === 1 ? "" : ` = ${shortText(value)} ${si.replace(".", "·")}`}`;
  }
  of(sets, which) {
    const run = runOf(this.core, sets, this.view.run, this.output[0]), assumed = assumedText(this.page.assumedParts(), this.page.partsWithAssumed()), curves = [this.curve({ x: run.time, y: run.output }, which)];
    const numbers = [["at the end", this.both(run.output.at(-1))], ["largest", this.both(Math.max(...run.output.map(Math.abs)))]];
    if (which === "one" && SHOWN_COMMANDS[this.view.run.shown] === this.page.commandUnit()) {
      curves.push(this.besides({ x: run.time, y: run.command }));
      numbers.push(["grey dashes:", "command"]);
    }
    if (run.reason) numbers.push(["stopped:", run.reason]);
    if (which === "one" && assumed) numbers.push([assumed, ""]);
    return { curves, numbers };
  }
}

/** Friction at a place of the view, over the motion of its own shaft. */
class FrictionCard extends Card {
  key = "friction";
  title = "Friction over speed";
  measure = "friction at speed";
  takes = true;
  slot() { return `friction of ${this.view.friction.place}`; }
  fits() { return [frictionPart(this.view.friction.place)].filter(Boolean); }
  get shaft() { return ["mesh", "output"].includes(this.view.friction.place) ? "output" : "input"; }
  get torqueAxis() { return this.axis(frictionPart(this.view.friction.place) ? `friction of the ${this.view.friction.place}` : "friction, sum at the input", this.unit("torque")); }
  axes() { return [this.axis(`${this.shaft} speed`, this.unit("speed")), this.torqueAxis]; }
  controls() {
    const numbers = [["maxSpeed", "input up to", "rad/s"], ["load", "input load", "N.m"], ["temperature", "temperature [K]", ""]];
    return [this.page.choice(["friction", "place"], PLACES, "place of the friction"), ...this.page.numberControls("friction", numbers)];
  }
  of(sets, which) {
    const torque = this.text(frictionAtSpeed(this.core, sets, this.view.friction), this.unit("torque"));
    return { curves: [this.curve(frictionOverSpeed(this.core, sets, this.view.friction), which)], numbers: [[`at ${this.text(this.view.friction.speed, this.unit("speed"))} of the input`, torque]] };
  }
  residual({ x, y }) {
    const angles = new Float64Array(x.length).fill(this.view.friction.angle), { rms, count } = rmsOf(frictionAt(this.core, this.page.sets, x, angles, this.view.friction), y);
    return `RMS residual ${this.text(rms, this.unit("torque"))} of ${count} points`;
  }
}

class FrictionOverTurnCard extends FrictionCard {
  key = "angle";
  title = "Friction over a turn";
  measure = null;
  takes = false;
  axes() { return [this.axis(`${this.shaft} angle`, DEGREES), this.torqueAxis]; }
  controls() { return this.page.numberControls("friction", [["speed", "input at", "rad/s"]]); }
  of(sets, which) {
    const points = frictionOverAngle(this.core, sets, this.view.friction);
    return { curves: [this.curve(points, which)], numbers: [["peak to peak", this.text(extentOf(points.y), this.unit("torque"))]] };
  }
}

class ErrorCard extends Card {
  key = "error";
  title = "Kinematic error";
  measure = "kinematic error";
  axes() { return [this.axis("input angle", DEGREES), this.axis("error at the output", this.unit("angle"))]; }
  of(sets, which) {
    const error = this.shared.error(sets), angle = (value) => this.text(value, this.unit("angle")), noise = sensorNoise(this.core, sets);
    const curves = [this.curve(error, which)], numbers = [["peak to peak", angle(extentOf(error.y))]];
    if (error.random.some(Boolean)) {
      numbers.push(["random part, RMS of this turn", angle(rmsOf(error.random, error.random.map(() => 0)).rms)]);
      if (which === "one") {
        curves.push(this.besides({ x: error.x, y: error.repeating }));
        numbers.push(["grey dashes:", "without it"]);
      }
    }
    if (noise) numbers.push(["noise of the angle sensors, RMS", angle(noise)]);
    return { curves, numbers };
  }
}

class OrdersCard extends Card {
  key = "orders";
  title = "Orders of the error";
  /** The amplitude of the order next to the pointer. */
  textAt(x) {
    const { x: orders, y } = ordersOf(this.shared.error(this.page.sets)), place = Math.min(Math.max(Math.round(x), 1), orders.length) - 1;
    return `order ${orders[place]}: ${this.text(y[place], this.unit("angle"))}`;
  }
  axes() { return [{ label: "periods a turn of the input", factor: 1 }, this.axis("amplitude", this.unit("angle"))]; }
  of(sets, which) {
    const { x, y } = ordersOf(this.shared.error(sets)), largest = Math.max(...y);
    const numbers = [["largest", largest > 0 ? `${this.text(largest, this.unit("angle"))} of order ${x[y.indexOf(largest)]}` : "none"]];
    return { curves: [this.curve({ x: [...x, NaN], y: [...y, 0] }, which, { mark: "bar" })], numbers };
  }
}

const CARDS = [LoopCard, StiffnessCard, RunCard, FrictionCard, FrictionOverTurnCard, ErrorCard, OrdersCard];
