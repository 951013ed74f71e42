// The general drive in WebAssembly (src/workbench.cpp): numbers in, numbers out.

const LONG_STEP = 1.0; // rad: step times the fastest rate of the drive, beyond which a run means nothing
const INPUTS = 6; // of a drive at an instant: command, input of the load, temperature, each followed by its rate

class Core {
  static async of(bytes) {
    const module = await WebAssembly.compile(bytes), core = new Core();
    core.module = module;
    await core.begin();
    return core;
  }
  /** A fresh instance: after a trap, the memory of the old one means nothing. */
  async begin() {
    const imports = {};
    for (const { module, name } of WebAssembly.Module.imports(this.module)) (imports[module] ??= {})[name] = () => 0;
    this.exports = (await WebAssembly.instantiate(this.module, imports)).exports;
    this.exports._initialize();
    this.capacity = this.exports.capacity();
  }
  doubles(name, count) { return new Float64Array(this.exports.memory.buffer, this.exports[`${name}_at`](), count); }
  ints(name, count) { return new Int32Array(this.exports.memory.buffer, this.exports[`${name}_at`](), count); }
  problem() {
    const bytes = new Uint8Array(this.exports.memory.buffer, this.exports.problem_text());
    return new TextDecoder().decode(bytes.slice(0, Math.min(bytes.indexOf(0), 500)));
  }
  /** Writes a set of parameters, as `flattened` returns it, and returns its counts. */
  put({ laws, shape, numbers }) {
    const LARGEST = 4096;
    if (laws.length > LARGEST || shape.length > LARGEST || numbers.length > 16 * LARGEST) throw new Error("the set is too large");
    this.ints("laws", laws.length).set(laws);
    this.ints("shape", shape.length).set(shape);
    this.doubles("numbers", numbers.length).set(numbers);
    return [laws.length, shape.length, numbers.length];
  }
  /** Calls a verb; returns its code, 0 if done. */
  call(verb, ...counts) {
    const code = this.exports[verb](...counts);
    this.reason = code ? this.problem() : "";
    return code;
  }
  values(from, to) { return this.doubles("values", to).slice(from); }
  /** A verb over points: the rows of its values, each as long; an error if the set is refused. */
  over(verb, set, points, rows = 1, ...more) {
    const columns = typeof points[0] === "number" ? [points] : points, n = columns[0].length;
    if (n > this.capacity) throw new Error(`at most ${this.capacity} points`);
    const counts = this.put(set);
    columns.forEach((column, i) => this.doubles("points", (i + 1) * n).set(column, i * n));
    if (this.call(verb, ...counts, n, ...more) === 1) throw new Error(this.reason);
    return Array.from({ length: rows }, (_, i) => this.values(i * n, (i + 1) * n));
  }
  loop(gear, twist) { return this.over("loop", gear, twist)[0]; }
  twist(gear, torque) { return this.over("twist", gear, torque)[0]; }
  friction(gear, speed, angle, load, temperature) { return this.over("friction", gear, [speed, angle, load, temperature], 1, 0)[0]; }
  /** A verb and its derivatives by numbered parameters of the gear, a row each, then `more` rows of its own. */
  slopes(verb, gear, points, places, more = 0) {
    this.ints("parameters", places.length).set(places);
    const [values] = this.over(verb, gear, points, 1, places.length), n = values.length;
    if (this.reason) throw new Error(this.reason);
    return { values, slopes: Array.from({ length: places.length + more }, (_, p) => this.doubles("slopes", (p + 1) * n).slice(p * n)) };
  }
  noise(gear, angle) { return this.over("noise", gear, angle)[0]; }
  ratio(gear) { return this.over("ratio", gear, [0])[0][0]; }
  error(gear, angle) { return this.over("error", gear, angle, 2); }
  spring(gear, twist) { return this.over("spring", gear, twist, 2); }
  /** The fastest rate of a drive [rad/s], and first instant, period and delay of its controller [s]. */
  rates(drive, temperature) {
    if (this.call("rates", ...this.put(drive), temperature) === 1) throw new Error(this.reason);
    const [fastest, first, period, delay] = this.values(0, 4);
    return { fastest, first, period, delay };
  }
  /** A run from rest: rows of the recorded outputs. `instants` has one more element than `keep`, `inputs` 3 x 6 a step. */
  run(drive, instants, inputs, keep, recorded) {
    const steps = keep.length, samples = keep.reduce((sum, each) => sum + (each ? 1 : 0), 1);
    if (steps > this.capacity) throw new Error("too many steps");
    const counts = this.put(drive);
    this.doubles("instants", steps + 1).set(instants);
    this.doubles("inputs", inputs.length).set(inputs);
    new Uint8Array(this.exports.memory.buffer, this.exports.keep_at(), steps).set(keep);
    this.ints("recorded", recorded.length).set(recorded);
    const code = this.call("run", ...counts, steps, recorded.length, samples);
    if (code === 1) throw new Error(this.reason);
    return { code, reason: this.reason, rows: recorded.map((_, r) => this.values(r * samples, (r + 1) * samples)) };
  }
}
