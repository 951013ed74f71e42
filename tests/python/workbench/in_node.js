// Runs scripts of the page in node: node in_node.js SCRIPTS PAGE < cases.json. A case is a task with its data; results go out as
// JSON, numbers as the bytes of doubles.
"use strict";
const { readFileSync } = require("node:fs");
const { gunzipSync } = require("node:zlib");
const { runInThisContext } = require("node:vm");

const [scripts, page] = process.argv.slice(2);
runInThisContext(`${["model", "toml", "gearfile", "core", "curves", "fit", "plots", "form", "cards", "page"].map((name) => readFileSync(`${scripts}/${name}.js`, "utf8")).join("\n")}\nglobalThis.Core = Core;`);
const bytesOf = (numbers) => Buffer.from(Float64Array.from(numbers).buffer).toString("base64");

const TASKS = {
  /** Laws, whole numbers, numbers and paths of drives, and texts of their gears. */
  flatten: ({ schema, drives }) => drives.map((given) => {
    const drive = completed(schema, "Drive", given), parts = flattened(schema, "Drive", drive);
    return { ...parts, fields: undefined, numbers: bytesOf(parts.numbers), values: drive, python: pythonOf(schema, "Drive", drive), toml: gearToml(schema, { name: "made" }, drive, ["motor", "control", "load", "sensors", "thermal", "meter"], () => ["a test", null, null]) };
  }),
  refuse: ({ schema, given }) => given.map((each) => { try { completed(schema, "Drive", each); return ""; } catch (error) { return error.message; } }),
  link: async ({ data, texts }) => [await fromFragment(await toFragment(data)), ...(await Promise.all(texts.map((text) => fromFragment(text).catch((error) => String(error.message)))))],
  /** Views of links, and Python with each. */
  views: ({ schema, drive, given }) => given.map((each) => {
    const view = viewFrom(schema, each);
    return [view, Workbench.prototype.python.call({ schema, view, state: { drive: completed(schema, "Drive", drive) } })];
  }),
  /** What the page reads of the texts of gear files: name, drive on a default one, entries, ratings and covariance; or why not. */
  read: ({ schema, texts }) => texts.map((text) => {
    try {
      const { name, drive, ...given } = gearFromToml(schema, text), origin = originFrom(schema, { ...given, drive });
      return { name, drive: origin.drive, ...portable(origin) };
    } catch (error) { return error.message; }
  }),
  origin: ({ schema, given }) => given.map((each) => { try { return portable(originFrom(schema, each)); } catch (error) { return error.message; } }),
  toml: ({ texts }) => texts.map((text) => { try { return [fromToml(text)]; } catch (error) { return error.message; } }),
  /** gear.toml of drives that follow on a gear of the page. */
  export: ({ schema, start, catalogue, key, drives }) => drives.map((given) => {
    const workbench = Object.assign(Object.create(Workbench.prototype), { schema, start, catalogue });
    workbench.state = { name: "made", drive: completed(schema, "Drive", given), origin: workbench.originOfLink(key) };
    return workbench.toml();
  }),
  /** Why a fit of measured values is refused, without a core. */
  refuse_fit: ({ numbers, measured }) => { try { fitted(() => null, numbers, numbers.map(() => ({})), numbers.map((_, i) => i), measured); } catch (error) { return error.message; } },
  states: ({ entries }) => entries.map(([source, deviation]) => stateOf(source, deviation)),
  units: ({ schema, controllers, unit }) => controllers.map((name) => fieldsWithMotor(schema.models[name].fields, unit).map((field) => [field.name, field.unit, field.doc])),
  svg: ({ plot }) => svgOf(plot),
  points: ({ given }) => given.map((each) => Object.entries(pointsFrom(each)).map(([slot, { x, y }]) => [slot, [...x], [...y]])),
  /** The fragment of points, as many as given, and what a link leaves out. */
  linked: async ({ counts }) => Promise.all(counts.map((count) => {
    const x = Float64Array.from({ length: count }, (_, i) => Math.sin(1e4 * i)), y = x.map((value) => Math.tan(5e4 * value)), workbench = Object.create(Workbench.prototype);
    return Object.assign(workbench, { measured: { loop: { x, y } }, state: { name: "", drive: {}, view: {}, origin: { key: null, drive: null } } }).linked();
  })),
  columns: ({ texts }) => texts.map((text) => { try { const { x, y, skipped } = twoColumns(text, 5); return [[...x], [...y], skipped]; } catch (error) { return error.message; } }),
  /** Loop, friction, error, spring and a run of each drive; null if a verb does not end with finite numbers. */
  compute: async ({ schema, drives, twist, speed, angle, load, temperature, instants, inputs, recorded }, core) => drives.map((given) => {
    const sets = setsOf(schema, completed(schema, "Drive", given));
    const verbs = {
      loop: () => core.over("loop", sets.gear, twist),
      friction: () => core.over("friction", sets.gear, [speed, angle, load, temperature], 1, 0),
      error: () => core.over("error", sets.gear, angle, 2),
      noise: () => [core.noise(sets.gear, angle)],
      ratio: () => [[core.ratio(sets.gear)]],
      spring: () => core.over("spring", sets.gear, twist, 2),
      run: () => { const { code, rows } = core.run(sets.drive, instants, inputs, new Uint8Array(instants.length - 1).fill(1), recorded); return code ? null : rows; },
    };
    return Object.fromEntries(Object.entries(verbs).map(([name, verb]) => { const rows = verb(); return [name, rows && rows.map(bytesOf)]; }));
  }),
  /** Numbers and RMS of fits of a loop, from each start. */
  fit: ({ schema, drives, x, y, parts }, core) => drives.map((given) => {
    const { gear } = setsOf(schema, completed(schema, "Drive", given));
    const places = gear.paths.flatMap((path, i) => (parts.includes(path.split(".")[0]) ? [i] : []));
    const begin = performance.now(), found = fittedLoop(core, gear, places, new LoopRecord(Float64Array.from(x), Float64Array.from(y)));
    return { zeros: found.zeros, rms: found.rms, correlation: found.correlation, kept: found.kept, iterations: found.iterations, numbers: places.map((place) => found.numbers[place]), seconds: 1e-3 * (performance.now() - begin) };
  }),
  /** Friction of a drive over speeds of the input or of the place, at each place. */
  places: ({ schema, drive, speed, angle, view }, core) => {
    const sets = setsOf(schema, completed(schema, "Drive", drive));
    return PLACES.map((place) => {
      const turns = turnsAt(core, sets, place);
      return [...frictionAt(core, sets, speed.map((each) => each / turns), angle.map((each) => each / turns), { ...view, place })];
    });
  },
  /** Codes of verbs with spoilt sets and points; any trap ends this process. */
  spoil: async ({ schema, drives, spoilt }, core) => {
    const codes = { number: [], points: [], law: [], shape: [], counts: [] };
    const call = (set, points) => {
      const counts = core.put(set), n = points.length;
      core.doubles("points", 4 * n).set([...points, ...points, ...points, ...points.map(() => ROOM_TEMPERATURE)]);
      return ["loop", "twist", "error", "noise", "ratio", "spring"].map((verb) => core.call(verb, ...counts, n)).concat(core.call("friction", ...counts, n, 0));
    };
    const points = [0, 1e-4, -1e-4], keep = [1, 1, 1], instants = [0, 1e-4, 2e-4, 3e-4];
    const inputs = [].concat(...Array.from({ length: 9 }, () => [0.1, 0, 0, 0, ROOM_TEMPERATURE, 0]));
    for (const given of drives) {
      const { gear, drive } = setsOf(schema, completed(schema, "Drive", given));
      for (const value of spoilt) {
        for (const set of [gear, drive])
          for (let i = 0; i < set.numbers.length; i++) {
            const numbers = set.numbers.with?.(i, value) ?? Object.assign([...set.numbers], { [i]: value });
            if (set === gear) codes.number.push([value, ...call({ ...set, numbers }, points)]);
            else {
              core.call("rates", ...core.put({ ...set, numbers }), ROOM_TEMPERATURE);
              try { core.run({ ...set, numbers }, instants, inputs, keep, [3]); } catch (error) { if (error instanceof WebAssembly.RuntimeError) throw error; }
            }
          }
        codes.points.push([value, ...call(gear, [0, value, 0])]);
      }
      for (const wrong of [-1, 99, 2147483647, -2147483648]) {
        for (let i = 0; i < gear.laws.length; i++) codes.law.push(...call({ ...gear, laws: Object.assign([...gear.laws], { [i]: wrong }) }, points));
        for (let i = 0; i < gear.shape.length; i++) if (wrong !== 99) codes.shape.push(...call({ ...gear, shape: Object.assign([...gear.shape], { [i]: wrong }) }, points));
      }
      const [l, s, c] = core.put(gear);
      for (const [dl, ds, dc] of [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1], [-l, -s, -c], [1e6, 0, 0], [0, 1e6, 0], [0, 0, 1e9]])
        codes.counts.push(core.call("loop", l + dl, s + ds, c + dc, 3));
      for (const n of [0, -1, core.capacity + 1, 2147483647]) codes.counts.push(core.call("loop", l, s, c, n));
    }
    return codes;
  },
};

(async () => {
  const { task, ...data } = JSON.parse(readFileSync(0, "utf8"), (_, value) => (value === "NaN" ? NaN : value === "Infinity" ? Infinity : value));
  const packed = page && /id="wasm">"([^"]*)"/.exec(readFileSync(page, "utf8"))[1];
  const core = packed && (await Core.of(gunzipSync(Buffer.from(packed, "base64"))));
  process.stdout.write(JSON.stringify(await TASKS[task](data, core)));
})();
