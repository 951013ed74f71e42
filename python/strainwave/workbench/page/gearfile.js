// Gear files in the page: read by what the schema describes, and written. A number comes with its entry: source, relative spread of
// single gears and standard deviation, the last two null if the file has none.

const MAX_FILE = 1 << 21; // bytes of a gear file
const MAX_COVARIANCE = 200; // numbers
const ENTRY_KEYS = ["value", "unit", "source", "spread", "uncertainty"];
const ZERO_OF_CELSIUS = 273.15; // K
const TEXT_KEYS = ["name", "maker", "note"], OTHER_TABLES = ["gear", "ratings", "covariance", "validation"];

/** A text as one line of printable characters. */
const lineFrom = (text) => text.toWellFormed().replace(/[\p{C}\p{Z}]/gu, " ");
const isTable = (value) => typeof value === "object" && value !== null && !Array.isArray(value);
const isPositive = (value) => Number.isFinite(value) && value >= 0;
function failAt(where, what) { throw new Error(`${where}: ${what}`); }

// ---- Units -----------------------------------------------------------------------------------------------------------

/** Size of a unit in SI and its dimension, as "kg1 m2 s-2"; null if it is none. `symbols` are those of the schema. */
function measureOf(symbols, unit) {
  if (typeof unit !== "string") return null;
  const found = /^([^/()]+)(?:\/(?:\(([^/()]+)\)|([^/().]+)))?$/.exec(unit), powers = {};
  let size = 1;
  const times = (factors, sign) => factors.split(".").every((factor) => {
    const [, symbol, power = "1"] = /^([A-Za-z]+)(-?[1-9])?$/.exec(factor) ?? [];
    if (!symbol || !Object.hasOwn(symbols, symbol)) return sign > 0 && factor === "1";
    const [own, dimension] = symbols[symbol], exponent = sign * Number(power);
    size *= own ** exponent;
    for (const [base, each] of Object.entries(dimension)) powers[base] = (powers[base] ?? 0) + exponent * each;
    return true;
  });
  if (!found || !times(found[1], 1) || (found[2] ?? found[3] ? !times(found[2] ?? found[3], -1) : false)) return null;
  return { size, dimension: Object.keys(powers).filter((base) => powers[base]).sort().map((base) => base + powers[base]).join(" ") };
}
/** Factor from a unit to another one; an error if they measure different things. */
function factorBetween(symbols, unit, to) {
  if (unit === to) return 1;
  const from = measureOf(symbols, unit), target = measureOf(symbols, to);
  if (!from) throw new Error(`the unit ${unit} is not known to this page; write ${to}`);
  if (from.dimension !== target.dimension) throw new Error(`the unit ${unit} does not measure what ${to} does`);
  return from.size / target.size;
}

// ---- Reading ---------------------------------------------------------------------------------------------------------

/** The content of a gear file: texts, parts of a drive, their names, entries by path, ratings and covariance. */
function gearFromToml(schema, text) {
  const content = fromToml(text), { Gear, Drive } = schema.models, sources = {};
  if (content.datasheet) throw new Error("this is a data sheet: strainwave workbench makes its page");
  const ofGear = Gear.fields.filter((field) => field.kind === "part"), ofDrive = Drive.fields.filter((field) => field.name !== "gear");
  const names = [...TEXT_KEYS, ...OTHER_TABLES, ...[...ofGear, ...ofDrive].map((field) => field.name)];
  for (const key in content) if (!names.includes(key)) failAt(lineFrom(key), "no part of a gear file");
  for (const key of TEXT_KEYS) if (content[key] !== undefined && typeof content[key] !== "string") failAt(key, "a text expected");
  if (!content.name?.trim()) failAt("name", "missing");
  const loose = content.gear ?? {};
  if (!isTable(loose)) failAt("[gear]", "a table expected");
  for (const field of ofGear) if (field.name in loose) failAt(`[gear] ${field.name}`, "a table of its own");
  const members = { ...loose, ...Object.fromEntries(ofGear.filter(({ name }) => content[name] !== undefined).map(({ name }) => [name, content[name]])) };
  if (content.covariance !== undefined && !covarianceFrom(content.covariance)) failAt("[covariance]", "numbers, and a matrix with a row for each, expected");
  const drive = { gear: parametersOf(schema, "Gear", members, { path: "gear", header: "", sources, isLeftOut: content.gear === undefined }) };
  const parts = ofDrive.filter(({ name }) => content[name] !== undefined);
  for (const field of parts) drive[field.name] = partOf(schema, field, content[field.name], { path: field.name, header: field.name, sources });
  return { name: content.name, maker: content.maker ?? "", note: content.note ?? "", drive, parts: parts.map(({ name }) => name), sources,
    ratings: ratingsOf(schema, content.ratings ?? {}), covariance: content.covariance ?? null };
}

function partOf(schema, field, content, at) {
  const where = `[${at.header}]`;
  if (!isTable(content)) failAt(where, "a table expected");
  const { model, ...rest } = content, id = field.chosen ? field.options.find((each) => schema.models[each].name === model) : field.options[0];
  if (!id) failAt(`${where} model`, `one of ${field.options.map((each) => schema.models[each].name).join(", ")}`);
  return { ...(field.chosen ? { model } : {}), ...parametersOf(schema, id, field.chosen ? rest : content, at) };
}

/** Values of a model from its table; the entries of its numbers are added to `sources`. `isLeftOut`: its own numbers are not given. */
function parametersOf(schema, id, content, { path, header, sources, isLeftOut = false }) {
  const { fields } = schema.models[id], where = `[${header || "gear"}]`, values = {};
  for (const key in content) if (!fields.some((field) => field.name === key)) failAt(`${where} ${lineFrom(key)}`, `no parameter of ${id}`);
  for (const field of fields) {
    const given = content[field.name], place = `${path}.${field.name}`, inner = `${where} ${field.name}`, itsHeader = header ? `${header}.${field.name}` : field.name;
    if (given === undefined) {
      if (field.kind === "part" && !field.absent) failAt(`[${itsHeader}]`, "missing");
      if (field.kind !== "part" && !field.optional && !isLeftOut) failAt(inner, "missing");
    } else if (field.kind === "part") values[field.name] = partOf(schema, field, given, { path: place, header: itsHeader, sources });
    else if (field.kind === "choice") values[field.name] = given;
    else if (field.kind === "sequence") {
      const each = Array.isArray(given) ? given : isTable(given) && Array.isArray(given.value) ? given.value.map((value) => ({ ...given, value })) : failAt(inner, "a list expected");
      if (each.length > MAX_ELEMENTS) failAt(inner, `more than ${MAX_ELEMENTS} numbers`);
      values[field.name] = each.map((entry, i) => numberFrom(schema, field, entry, `${place}[${i}]`, inner, sources));
    } else values[field.name] = numberFrom(schema, field, given, place, inner, sources);
  }
  return values;
}

function numberFrom({ symbols }, { unit }, given, place, where, sources) {
  const { factor, source, spread, uncertainty, isCelsius } = entryFrom(symbols, given, unit, where);
  sources[place] = [source, spread, uncertainty === null ? null : uncertainty * factor];
  const value = isCelsius ? given.value + ZERO_OF_CELSIUS : factor === 1 ? given.value : given.value * factor;
  return Number.isFinite(value) ? value : failAt(where, "too large a number");
}
/** What an entry states beside its number; `unit` is the one wanted, empty for any. */
function entryFrom(symbols, given, unit, where) {
  if (!isTable(given)) failAt(where, 'a number is written as { value = …, unit = "…", source = "…" }');
  for (const key in given) if (!ENTRY_KEYS.includes(key)) failAt(where, `an entry has no ${lineFrom(key)}`);
  const { value, source, spread = null, uncertainty = null } = given, own = given.unit ?? (unit === "1" ? "1" : undefined);
  if (typeof value !== "number" || !Number.isFinite(value)) failAt(where, "value must be a number");
  if (typeof own !== "string") failAt(where, `unit missing${unit && `; write ${unit}`}`);
  if (typeof source !== "string" || !source.trim()) failAt(where, "source missing");
  for (const [name, number] of [["spread", spread], ["uncertainty", uncertainty]]) if (number !== null && !isPositive(number)) failAt(where, `${name} must be a number of at least 0`);
  const isCelsius = own === "degC" && unit === "K";
  let factor = 1;
  try { if (unit) factor = isCelsius ? 1 : factorBetween(symbols, own, unit); } catch (error) { failAt(where, error.message); }
  return { unit: own, factor, isCelsius, source: lineFrom(source), spread, uncertainty };
}
function ratingsOf({ symbols }, content) {
  if (!isTable(content)) failAt("[ratings]", "a table expected");
  return Object.fromEntries(Object.entries(content).map(([name, given]) => {
    const { unit, source, spread, uncertainty } = entryFrom(symbols, given, "", `[ratings] ${lineFrom(name)}`);
    return [name, [given.value, unit, source, spread, uncertainty]];
  }));
}

// ---- Origin ----------------------------------------------------------------------------------------------------------

/** Where the numbers of a gear come from, with nothing in it that cannot be written: of the page, of a file or of a link. */
function originFrom(schema, given) {
  const text = (value) => (typeof value === "string" ? lineFrom(value) : ""), measured = (value) => (isPositive(value) ? value : null);
  const entry = (value) => { const [source, spread, uncertainty] = Array.isArray(value) ? value : []; return [text(source).trim() || "not given", measured(spread), measured(uncertainty)]; };
  const table = (value) => Object.entries(isTable(value) ? value : {});
  const isRating = ([name, value]) => /^[\w-]+$/.test(name) && Array.isArray(value) && Number.isFinite(value[0]) && measureOf(schema.symbols, value[1]);
  const ratings = new Map(table(given.ratings).filter(isRating).map(([name, [value, unit, ...rest]]) => [name, [value, unit, ...entry(rest)]]));
  const rated = ratings.get("rated_torque"), isTorque = rated && measureOf(schema.symbols, rated[1]).dimension === measureOf(schema.symbols, "N.m").dimension;
  return {
    maker: text(given.maker), note: typeof given.note === "string" ? given.note.toWellFormed().replace(/[^\P{Cc}\n\t]/gu, " ") : "",
    drive: completed(schema, "Drive", given.drive), parts: schema.models.Drive.fields.map(({ name }) => name).filter((name) => name !== "gear" && given.parts?.includes?.(name)),
    sources: new Map(table(given.sources).map(([path, value]) => [path, entry(value)])), ratings, covariance: covarianceFrom(given.covariance),
    rated: isTorque ? rated[0] * factorBetween(schema.symbols, rated[1], "N.m") : null,
  };
}
/** A covariance of as many numbers as it has rows; null if it is none. */
function covarianceFrom(given) {
  const { numbers, matrix } = isTable(given) ? given : {};
  const isWhole = Array.isArray(numbers) && Array.isArray(matrix) && matrix.length === numbers.length && numbers.length <= MAX_COVARIANCE && numbers.every((path) => typeof path === "string" && /^[\w.[\]]+$/.test(path))
    && matrix.every((row) => Array.isArray(row) && row.length === numbers.length && row.every(Number.isFinite));
  return isWhole ? { numbers, matrix } : null;
}
/** An origin as data of a link. */
function portable({ sources, ratings, ...rest }) { return { ...rest, sources: Object.fromEntries(sources), ratings: Object.fromEntries(ratings) }; }

// ---- Writing ---------------------------------------------------------------------------------------------------------

/** A number as Python and TOML write it: a float has a point or an exponent. */
function floatText(value) {
  const text = String(value);
  return /[.e]/.test(text) ? text : `${text}.0`;
}
const numberText = (field, value) => (field.kind === "whole" ? String(value) : floatText(value));
const tomlText = (text) => JSON.stringify(text).replaceAll("\x7f", "\\u007f");
const listText = (texts) => `[${texts.join(", ")}]`;

/** A value in the text of TOML with its unit and entry. */
function inlineText(value, unit, [source, spread, uncertainty]) {
  const more = [["spread", spread], ["uncertainty", uncertainty]].filter(([, number]) => number !== null).map(([name, number]) => `, ${name} = ${floatText(number)}`);
  return `{ value = ${value}, unit = ${tomlText(unit)}, source = ${tomlText(source)}${more.join("")} }`;
}
function sequenceText(values, unit, entries) {
  if (!values.length) return "[]";
  if (entries.every((entry) => sameValues(entry, entries[0]))) return inlineText(listText(values.map(floatText)), unit, entries[0]);
  return `[\n${values.map((value, i) => `    ${inlineText(floatText(value), unit, entries[i])},\n`).join("")}]`;
}

/** The text of gear.toml. `parts` are those of the drive to write; `entryOf(keys)` the entry of the number at these keys. */
function gearToml(schema, { name, maker = "", note = "", ratings = new Map(), covariance = null }, drive, parts, entryOf) {
  const lines = Object.entries({ name, maker, note }).filter(([, text]) => text).map(([key, text]) => `${key} = ${tomlText(text)}`);
  const own = (id, values, keys) => schema.models[id].fields.filter((field) => field.kind !== "part").map((field) => {
    const value = values[field.name], place = [...keys, field.name];
    if (field.kind === "choice") return `${field.name} = ${tomlText(value)}`;
    if (field.kind === "sequence") return `${field.name} = ${sequenceText(value, field.unit, value.map((_, i) => entryOf([...place, i])))}`;
    return `${field.name} = ${inlineText(numberText(field, value), field.unit, entryOf(place))}`;
  });
  const table = (field, values, keys, header) => {
    const id = modelOf(schema, field, values);
    lines.push("", `[${header}]`, ...(field.chosen ? [`model = ${tomlText(values.model)}`] : []), ...own(id, values, keys));
    for (const inner of schema.models[id].fields) if (inner.kind === "part") table(inner, values[inner.name], [...keys, inner.name], `${header}.${inner.name}`);
  };
  for (const field of schema.models.Gear.fields) if (field.kind === "part") table(field, drive.gear[field.name], ["gear", field.name], field.name);
  lines.push("", "[gear]", ...own("Gear", drive.gear, ["gear"]));
  for (const field of schema.models.Drive.fields) if (parts.includes(field.name)) table(field, drive[field.name], [field.name], field.name);
  if (ratings.size) lines.push("", "[ratings]");
  for (const [rating, [value, unit, ...entry]] of ratings) lines.push(`${rating} = ${inlineText(floatText(value), unit, entry)}`);
  if (covariance) lines.push("", "[covariance]", `numbers = ${listText(covariance.numbers.map(tomlText))}`, `matrix = [\n${covariance.matrix.map((row) => `    ${listText(row.map(floatText))},\n`).join("")}]`);
  return `${lines.join("\n")}\n`;
}
