// Least squares by Levenberg and Marquardt, on the exact derivatives of the core.

const MAX_ITERATIONS = 60;
const MAX_TRIES = 12; // of a step, each with more damping
const SMALL_GAIN = 1e-10; // of the sum of squares, relative: the fit has converged
const MAX_LOG_STEP = 1.0; // of the logarithm of a number in one step

/**
 * The numbers of a set that fit measured values best. Numbers that may not be negative are fitted as logarithms, so that they keep
 * their sign; those that are zero stay.
 * @param compute (numbers, places) => {values, slopes}: the model, and its derivatives by the numbers in these places, one row each
 * @param fields the field of each number
 */
function fitted(compute, numbers, fields, places, measured) {
  const free = places.filter((place) => numbers[place] !== 0), inLogs = free.map((place) => (fields[place].min ?? -1) >= 0), n = measured.length;
  if (!free.length) throw new Error("all numbers are zero, which the fit keeps: change one first");
  if (n < free.length) throw new Error(`${n} points do not determine ${free.length} numbers: measure more, or set numbers to zero`);
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
  return { numbers: now.numbers, rms: Math.sqrt(now.cost / n), iterations, free: free.length };
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
