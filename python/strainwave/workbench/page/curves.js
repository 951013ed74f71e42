// Curves of a gear or drive, in SI: what the plots show. `sets` has the parameters taken apart, of the gear and of the drive.

const PER_STRETCH = 160; // points of a loop between two reversals
const FRICTION_POINTS = 401;
const TURN_POINTS = 1024; // of one input turn; orders up to 100 are clear of its Nyquist order
const HIGHEST_ORDER = 24;
const RUN_SAMPLES = 600;
const ROOM_TEMPERATURE = 293.15; // K

// Turning points of the histories, as shares of the travel. The last two stretches are the loop that numbers are read from.
const HISTORIES = {
  "closed loop": [1, -1, 1],
  "one side": [1, 0, 1],
  "shrinking loops": [1, -1, 0.75, -0.75, 0.5, -0.5, 0.25, -0.25],
  "first loading": [1],
};

/** Evenly spaced numbers from one to the other, both included. */
const between = (from, to, n) => Float64Array.from({ length: n }, (_, i) => from + ((to - from) * i) / (n - 1));

const PLACES = ["input", "mesh", "output", "sum at the input"]; // of friction

/** The parameters of a drive taken apart: of its gear, of the whole, and of the gear with the friction of another part at the input. */
function setsOf(schema, drive) {
  const ofGear = (changes) => flattened(schema, "Gear", { ...drive.gear, ...changes });
  return { gear: ofGear({}), drive: flattened(schema, "Drive", drive), sensors: drive.sensors, gearWithInputFriction: (part) => ofGear({ friction_input: drive.gear[part] }) };
}

/** Twist [rad] and torque [N.m] along the chosen travel, and the first point of the last two stretches. */
function loopOf(core, sets, travel) {
  const turns = HISTORIES[travel.history];
  const twists = travel.by === "torque" ? core.twist(sets.gear, turns.map((share) => share * travel.torque)) : turns.map((share) => share * travel.twist);
  if (!twists.every(Number.isFinite)) throw new Error("no twist gives this torque: choose a smaller travel");
  const twist = [0];
  twists.forEach((end, i) => twist.push(...between(i ? twists[i - 1] : 0, end, PER_STRETCH + 1).subarray(1)));
  const path = Float64Array.from(twist);
  return { twist: path, torque: core.loop(sets.gear, path), last: Math.max(0, (turns.length - 2) * PER_STRETCH) };
}

/** Where a stretch of points crosses a level of y, by interpolation; NaN where it does not. */
function crossing(x, y, from, to, level) {
  for (let i = from + 1; i <= to; i++)
    if ((y[i - 1] - level) * (y[i] - level) <= 0 && y[i] !== y[i - 1]) return x[i - 1] + ((level - y[i - 1]) / (y[i] - y[i - 1])) * (x[i] - x[i - 1]);
  return NaN;
}

/** Width [rad] at the middle torque, mean stiffness [N.m/rad] and loss [J] of the last two stretches of a loop. */
function numbersOfLoop({ twist, torque, last }) {
  const n = twist.length - 1, turn = last + PER_STRETCH;
  let low = Infinity, high = -Infinity, work = 0;
  for (let i = last; i <= n; i++) { low = Math.min(low, torque[i]); high = Math.max(high, torque[i]); }
  for (let i = last + 1; i <= n; i++) work += 0.5 * (torque[i] + torque[i - 1]) * (twist[i] - twist[i - 1]);
  const middle = 0.5 * (low + high);
  const width = turn < n ? Math.abs(crossing(twist, torque, last, turn, middle) - crossing(twist, torque, turn, n, middle)) : NaN;
  return { width, stiffness: Math.abs((torque[n] - torque[turn < n ? turn : 0]) / (twist[n] - twist[turn < n ? turn : 0])), loss: turn < n ? Math.abs(work) : NaN };
}

/** Slope [N.m/rad] over torque [N.m] along the last stretches of a loop; a gap at the reversal. */
function slopesOfLoop({ twist, torque, last }) {
  const x = [], y = [];
  for (let i = last + 1; i < twist.length; i++) {
    if (i - last === PER_STRETCH + 1) { x.push(NaN); y.push(NaN); }
    x.push(0.5 * (torque[i] + torque[i - 1]));
    y.push((torque[i] - torque[i - 1]) / (twist[i] - twist[i - 1]));
  }
  return { x, y };
}

/** The part whose friction a place has; none for the sum. */
const frictionPart = (place) => ({ input: "friction_input", mesh: "friction_mesh", output: "friction_output" })[place];
/** Turns of the input for one of the shaft of a place: mesh and output turn with the output. */
const turnsAt = (core, sets, place) => (place === "mesh" || place === "output" ? Math.abs(core.ratio(sets.gear)) : 1);

/** Steady friction [N.m] of a part over speeds [rad/s] and angles [rad] of its own shaft, under a load [N.m] there. */
function frictionOf(core, sets, part, speeds, angles, load, temperature) {
  const filled = (value) => new Float64Array(speeds.length).fill(value);
  return core.friction(sets.gearWithInputFriction(part), speeds, angles, filled(load), filled(temperature));
}
/** Steady friction [N.m] at the place of a view, over speeds [rad/s] and angles [rad] of its shaft. The load is that of the input. */
function frictionAt(core, sets, speeds, angles, { place, load, temperature }) {
  const part = frictionPart(place), ratio = core.ratio(sets.gear), referred = (values) => Float64Array.from(values, (value) => value / ratio);
  if (part) return frictionOf(core, sets, part, speeds, angles, load * turnsAt(core, sets, place), temperature);
  const [input, mesh, output] = [frictionOf(core, sets, "friction_input", speeds, angles, load, temperature),
    ...["friction_mesh", "friction_output"].map((each) => frictionOf(core, sets, each, referred(speeds), referred(angles), load * ratio, temperature))];
  return input.map((torque, i) => torque + (mesh[i] + output[i]) / ratio);
}
/** Steady friction [N.m] over speed [rad/s]; a gap at rest, where a set-valued law jumps. */
function frictionOverSpeed(core, sets, view) {
  const half = (FRICTION_POINTS - 1) / 2, speed = new Float64Array(FRICTION_POINTS), maxSpeed = view.maxSpeed / turnsAt(core, sets, view.place);
  for (let i = 1; i <= half; i++) { // denser near rest, where friction varies most
    const at = maxSpeed * (i / half) ** 2;
    speed[half + i] = at;
    speed[half - i] = -at;
  }
  const torque = frictionAt(core, sets, speed, new Float64Array(FRICTION_POINTS).fill(view.angle), view);
  torque[half] = NaN;
  return { x: speed, y: torque };
}
/** Steady friction [N.m] over one turn [rad] of the shaft of its place, at the speed of a view. */
function frictionOverAngle(core, sets, view) {
  const angle = between(0, 2 * Math.PI, FRICTION_POINTS), speed = view.speed / turnsAt(core, sets, view.place);
  return { x: angle, y: frictionAt(core, sets, new Float64Array(FRICTION_POINTS).fill(speed), angle, view) };
}
/** Steady friction [N.m] at speed and angle of a view. */
const frictionAtSpeed = (core, sets, view) => frictionAt(core, sets, [view.speed / turnsAt(core, sets, view.place)], [view.angle], view)[0];

/** Kinematic error [rad] over one turn of the input [rad], at rest without load: `y` is the sum of the repeating and random part. */
function errorOverTurn(core, sets) {
  const angle = between(0, 2 * Math.PI, TURN_POINTS + 1), [repeating] = core.error(sets.gear, angle), random = core.noise(sets.gear, angle);
  return { x: angle, y: repeating.map((value, i) => value + random[i]), repeating, random };
}
/** Root mean square of the noise of a sensor, in the unit of what it measures. */
const noiseOf = ({ model, law, amplitude }) => Math.hypot(model === "noisy" ? amplitude : 0, law ? noiseOf(law) : 0);
/** That of the kinematic error [rad] as the sensors of both angles measure it. */
function sensorNoise(core, sets) {
  return Math.hypot(noiseOf(sets.sensors.output_angle), noiseOf(sets.sensors.input_angle) / core.ratio(sets.gear));
}
const COSINES = Float64Array.from({ length: TURN_POINTS }, (_, i) => Math.cos((2 * Math.PI * i) / TURN_POINTS));

/** Amplitude [rad] of each order of one turn, from 1 on. */
function ordersOf({ y }) {
  const orders = [], amplitudes = [];
  for (let order = 1; order <= HIGHEST_ORDER; order++) {
    let cosine = 0, sine = 0;
    for (let i = 0; i < TURN_POINTS; i++) {
      cosine += y[i] * COSINES[(order * i) % TURN_POINTS];
      sine += y[i] * COSINES[(order * i + 0.75 * TURN_POINTS) % TURN_POINTS];
    }
    orders.push(order);
    amplitudes.push((2 / TURN_POINTS) * Math.hypot(cosine, sine));
  }
  return { x: orders, y: amplitudes };
}

/** Time, command and a recorded output of the whole drive from rest. */
function runOf(core, sets, view, output) {
  const { fastest, first, period, delay } = core.rates(sets.drive, ROOM_TEMPERATURE);
  const step = Math.min(view.duration / RUN_SAMPLES, (0.5 * LONG_STEP) / fastest);
  const steps = Math.ceil(view.duration / step - 1e-9);
  const acting = period ? Math.floor(2 * (view.duration / period)) : 0;
  if (!(steps + acting < core.capacity)) throw new Error(`this takes ${steps + acting} steps, more than ${core.capacity}: choose a shorter duration`);
  const every = Math.ceil(steps / RUN_SAMPLES), times = new Map([[0, true]]);
  for (let i = 1; i <= steps; i++) times.set(Math.min(i * step, view.duration), i % every === 0 || i === steps);
  if (period)
    for (let k = 0; k * period < view.duration; k++)
      for (const at of [first + k * period, first + (k - 1) * period + delay])
        if (at > 1e-9 * period && at < view.duration && !times.has(at)) times.set(at, false);
  const instants = Float64Array.from([...times.keys()].sort((a, b) => a - b).filter((at, i, all) => !i || at - all[i - 1] > 1e-12 || times.get(at)));
  const keep = Uint8Array.from(instants.subarray(1), (at) => Number(times.get(at)));
  const inputs = new Float64Array(3 * INPUTS * keep.length);
  for (let i = 0; i < keep.length; i++)
    for (let part = 0; part < 3; part++) {
      const at = instants[i] + 0.5 * part * (instants[i + 1] - instants[i]);
      inputs.set([...commandAt(view, at), view.load, 0, ROOM_TEMPERATURE, 0], (3 * i + part) * INPUTS);
    }
  const { rows, code, reason } = core.run(sets.drive, instants, inputs, keep, [0, output]);
  const time = [0, ...instants.subarray(1).filter((_, i) => keep[i])];
  return { time, command: rows[0], output: rows[1], reason: code ? reason : "" };
}
/** Command and its rate at a time. */
function commandAt({ command, amplitude, frequency }, time) {
  if (command === "step") return [amplitude, 0];
  const phase = 2 * Math.PI * frequency * time;
  return [amplitude * Math.sin(phase), amplitude * 2 * Math.PI * frequency * Math.cos(phase)];
}

/** Root mean square of the finite differences, and how many there are. */
function rmsOf(one, other) {
  let sum = 0, count = 0;
  for (let i = 0; i < one.length; i++) if (Number.isFinite(one[i] - other[i])) { sum += (one[i] - other[i]) ** 2; count++; }
  return { rms: Math.sqrt(sum / count), count };
}
/** The separator of columns of a line: semicolon, else tab, else blanks, else comma. Only there is a comma no decimal sign. */
function separatorOf(line) {
  if (line.includes(";")) return ";";
  if (line.includes("\t")) return "\t";
  return /\s/.test(line) ? /\s*,\s+|\s+,\s*|\s+/ : ",";
}
/** Two columns of numbers from a text, and how many lines were skipped because they are no two numbers. */
function twoColumns(text, most) {
  const x = [], y = [];
  let skipped = 0;
  for (const line of text.split(/\r?\n/).map((each) => each.trim()).filter(Boolean)) {
    const separator = separatorOf(line), words = line.split(separator).map((word) => word.trim());
    const [one, other] = words.slice(0, 2).map((word) => (word === "" ? NaN : Number(separator === "," ? word : word.replace(",", "."))));
    if (!Number.isFinite(one) || !Number.isFinite(other)) { skipped++; continue; }
    x.push(one);
    y.push(other);
    if (x.length > most) throw new Error(`more than ${most} points`);
  }
  if (x.length < 2) throw new Error("no two columns of numbers found");
  return { x: Float64Array.from(x), y: Float64Array.from(y), skipped };
}
