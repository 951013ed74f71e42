// Least squares by Levenberg and Marquardt, on the exact derivatives of the core.

const MAX_ITERATIONS = 60;
const MAX_TRIES = 12; // of a step, each with more damping
const SMALL_GAIN = 1e-10; // of the sum of squares, relative: the fit has converged
const MIN_INFLUENCE = 1e-6; // of a relative change of a number on the values, relative to them: a smaller one cannot be fitted
const MAX_LOG_STEP = 1.0; // of the logarithm of a number in one step

const MIN_TURN = 0.02; // of the range of the twist: a path that goes back by less is a single branch

/** True if a path turns back, beyond its noise. */
function turnsBack(path) {
  const [low, high] = [Math.min(...path), Math.max(...path)], least = MIN_TURN * (high - low);
  let top = path[0], bottom = path[0];
  let up = false, down = false;
  for (const value of path) {
    top = Math.max(top, value);
    bottom = Math.min(bottom, value);
    if (top - value > least) { down = true; bottom = value; }
    if (value - bottom > least) { up = true; top = value; }
  }
  return up && down;
}

/**
 * A measured torsion loop, as the package compares it: the gear has run the same path before, and the zeros of torque and twist are
 * unknown. A single branch does not determine them: there the gear begins unloaded at both zeros.
 * `zeros`: those of torque [N.m] and twist [rad].
 */
class LoopRecord {
  constructor(twist, torque, zeros = null) {
    const isLoop = turnsBack(twist);
    Object.assign(this, { twist, torque, isLoop, zeros: isLoop ? zeros ?? [0, 0.5 * (Math.min(...twist) + Math.max(...twist))] : [0, 0] });
  }
  path(twistZero) {
    const shifted = this.twist.map((value) => value - twistZero);
    return Float64Array.from(this.isLoop ? [0, ...shifted, ...shifted] : [0, ...shifted]);
  }
  /** Torque at each point, and its derivatives by numbers of the gear, by the zero of the torque and by that of the twist. */
  predicted(core, gear, places, [torqueZero, twistZero]) {
    const path = this.path(twistZero), first = path.length - this.twist.length, { values, slopes } = core.slopes("loop_slopes", gear, path, places, 1);
    const [byShift, ...byNumbers] = [slopes.at(-1), ...slopes.slice(0, -1)].map((row) => row.subarray(first));
    return { values: values.subarray(first).map((value) => value + torqueZero), slopes: [...byNumbers, byShift.map(() => 1), byShift.map((slope) => -slope)] };
  }
}

/** The numbers of a gear in these places, and the zeros of a record, that fit its torque best. */
function fittedLoop(core, gear, places, record) {
  const { length } = gear.numbers, zeros = record.isLoop ? [length, length + 1] : [];
  const compute = (numbers, free) => {
    const own = free.filter((place) => place < length), found = record.predicted(core, { ...gear, numbers: numbers.slice(0, length) }, own, numbers.slice(length));
    return { values: found.values, slopes: found.slopes.slice(0, free.length) };
  };
  const found = fitted(compute, [...gear.numbers, ...record.zeros], [...gear.fields, ZERO, ZERO], [...places, ...zeros], record.torque);
  return { ...found, zeros: found.numbers.slice(length), numbers: found.numbers.slice(0, length) };
}
const ZERO = { isZero: true }; // the field of the zero of a sensor, which a fit may move from 0

/**
 * The numbers of a set that fit measured values best. Numbers that may not be negative are fitted as logarithms, so that they keep
 * their sign; those that are zero stay.
 * @param compute (numbers, places) => {values, slopes}: the model, and its derivatives by the numbers in these places, one row each
 * @param fields the field of each number
 * `correlation` of the result: of each residual with the one before.
 */
function fitted(compute, numbers, fields, places, measured) {
  const wanted = places.filter((place) => numbers[place] !== 0 || fields[place].isZero), n = measured.length;
  if (wanted.every((place) => fields[place].isZero)) throw new Error("all numbers are zero, which the fit keeps: change one first");
  if (n < wanted.length) throw new Error(`${n} points do not determine ${wanted.length} numbers: measure more, or set numbers to zero`);
  const free = withInfluence(compute, numbers, fields, wanted, measured), inLogs = free.map((place) => (fields[place].min ?? -1) >= 0);
  const squares = (values) => values.reduce((sum, value, i) => sum + (value - measured[i]) ** 2, 0);
  const at = (trial) => {
    const { values, slopes } = compute(trial, free);
    return { numbers: trial, values, slopes, cost: squares(values) };
  };
  let now = at([...numbers]), damping = 1e-3, iterations = 0;
  for (; iterations < MAX_ITERATIONS; iterations++) {
    const columns = free.map((place, p) => Float64Array.from(now.slopes[p], (slope) => slope * (inLogs[p] ? now.numbers[place] : 1)));
    const matrix = columns.map((one) => columns.map((other) => { let sum = 0; for (let i = 0; i < n; i++) sum += one[i] * other[i]; return sum; }));
    const side = columns.map((one) => { let sum = 0; for (let i = 0; i < n; i++) sum += one[i] * (measured[i] - now.values[i]); return sum; });
    let better = null;
    for (let tries = 0; tries < MAX_TRIES && !better; tries++, damping *= better ? 0.2 : 4) {
      const step = solved(matrix.map((row, p) => row.map((value, q) => (p === q ? value * (1 + damping) + Number.MIN_VALUE : value))), side);
      const trial = [...now.numbers];
      free.forEach((place, p) => {
        const moved = inLogs[p] ? trial[place] * Math.exp(Math.max(-MAX_LOG_STEP, Math.min(MAX_LOG_STEP, step[p]))) : trial[place] + step[p];
        trial[place] = Math.min(fields[place].max ?? Infinity, Math.max(fields[place].min ?? -Infinity, moved));
      });
      if (!trial.every(Number.isFinite)) continue;
      try { const there = at(trial); if (there.cost < now.cost) better = there; } catch { /* numbers that contradict each other */ }
    }
    if (!better) break;
    const gain = (now.cost - better.cost) / now.cost;
    now = better;
    if (gain < SMALL_GAIN) break;
  }
  const left = measured.map((value, i) => value - now.values[i]);
  const correlation = left.reduce((sum, value, i) => sum + (i ? value * left[i - 1] : 0), 0) / now.cost;
  return { numbers: now.numbers, rms: Math.sqrt(now.cost / n), iterations, free, kept: wanted.length - free.length, correlation };
}

/** Those of the numbers in these places that the measured values determine at all. */
function withInfluence(compute, numbers, fields, places, measured) {
  const { slopes } = compute([...numbers], places), least = MIN_INFLUENCE * Math.hypot(...measured);
  return places.filter((place, p) => fields[place].isZero || Math.abs(numbers[place]) * Math.hypot(...slopes[p]) > least);
}

/** The solution of linear equations by elimination with row exchanges; 0 for an unknown that no equation determines. */
function solved(matrix, side) {
  const rows = matrix.map((row, i) => [...row, side[i]]), n = side.length;
  for (let i = 0; i < n; i++) {
    let most = i;
    for (let k = i + 1; k < n; k++) if (Math.abs(rows[k][i]) > Math.abs(rows[most][i])) most = k;
    [rows[i], rows[most]] = [rows[most], rows[i]];
    if (rows[i][i] === 0) continue;
    for (let k = i + 1; k < n; k++) {
      const factor = rows[k][i] / rows[i][i];
      for (let q = i; q <= n; q++) rows[k][q] -= factor * rows[i][q];
    }
  }
  const x = new Array(n).fill(0);
  for (let i = n - 1; i >= 0; i--) {
    let sum = rows[i][n];
    for (let q = i + 1; q < n; q++) sum -= rows[i][q] * x[q];
    x[i] = rows[i][i] === 0 ? 0 : sum / rows[i][i];
  }
  return x;
}
