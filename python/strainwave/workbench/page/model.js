// Parameters of a drive as nested objects, in the form of a gear file: taken apart for the core, and written as Python.
// `schema` is what strainwave/workbench/schema.py makes of the models; no model or parameter is named here.

const MAX_FRAGMENT = 60000; // characters of a permalink
const MAX_INFLATED = 1 << 20; // bytes of its content
const MAX_ELEMENTS = 1000; // of a sequence

/** The model of a part's value. */
function modelOf(schema, field, value) {
  return field.options.find((id) => !field.chosen || schema.models[id].name === value.model);
}

/** Parameters of a model, checked and completed with the defaults of those that are absent. Nothing else is taken over. */
function completed(schema, id, given) {
  if (typeof given !== "object" || given === null || Array.isArray(given)) throw new Error(`${id}: parameters expected`);
  const values = {};
  for (const field of schema.models[id].fields) {
    const has = Object.hasOwn(given, field.name);
    const value = has ? given[field.name] : Object.hasOwn(values, field.follows ?? "") ? values[field.follows] : field.default;
    values[field.name] = checked(schema, id, field, value);
  }
  return values;
}

function checked(schema, id, field, value) {
  const where = `${id}.${field.name}`;
  if (field.kind === "part") {
    const chosen = modelOf(schema, field, value ?? {});
    if (!chosen) throw new Error(`${where}: no such law`);
    const inner = completed(schema, chosen, value);
    return field.chosen ? { model: schema.models[chosen].name, ...inner } : inner;
  }
  if (field.kind === "choice") {
    if (!field.options.includes(value)) throw new Error(`${where}: one of ${field.options.join(", ")}`);
    return value;
  }
  if (field.kind === "sequence") {
    if (!Array.isArray(value) || value.length > MAX_ELEMENTS) throw new Error(`${where}: a list of numbers expected`);
    return value.map((each, i) => number(`${where}[${i}]`, field, each));
  }
  return number(where, field, value);
}

function number(where, field, value) {
  if (typeof value !== "number" || !Number.isFinite(value)) throw new Error(`${where}: a finite number expected`);
  const problem = problemOf(field, value);
  if (problem) throw new Error(`${where} ${problem}`);
  return value;
}

/** Why a number does not fit its field; empty if it does. */
function problemOf(field, value) {
  if (!Number.isFinite(value)) return "must be a number";
  const low = field.min ?? -Infinity, high = field.max ?? Infinity;
  if (value < low || (field.open && value === low)) return `must be ${field.open ? "above" : "at least"} ${low}`;
  if (value > high) return `must be at most ${high}`;
  if ((field.kind === "whole" || field.kind === "count") && !Number.isInteger(value)) return "must be a whole number";
  return "";
}

const COMMANDED = { V: "voltage", A: "current", "N.m": "torque", "rad/s2": "acceleration" }; // by a controller, by its unit
/** The fields of a controller in the unit of its motor. They are described in that of `limit`, which is a voltage or a current. */
function fieldsWithMotor(fields, unit) {
  const own = fields.find(({ name }) => name === "limit")?.unit, written = unit === "rad/s2" ? "rad.s-2" : unit;
  if (!["V", "A"].includes(own) || own === unit) return fields;
  const docOf = (doc) => doc.replace(new RegExp(COMMANDED[own], "i"), (word) => (word[0] < "a" ? COMMANDED[unit][0].toUpperCase() + COMMANDED[unit].slice(1) : COMMANDED[unit]));
  return fields.map((field) => ({ ...field, unit: field.unit.replace(new RegExp(`\\b${own}\\b`), written), doc: field.unit.includes(own) ? docOf(field.doc) : field.doc }));
}

/** The laws, whole numbers and numbers of a model, in the order of the compiled core, with path and field of each number. */
function flattened(schema, id, values) {
  const parts = { laws: [], shape: [], numbers: [], paths: [], fields: [] };
  flatten(schema, id, values, "", parts);
  return parts;
}

function flatten(schema, id, values, before, parts) {
  for (const field of schema.models[id].fields) {
    const value = values[field.name], path = before + field.name;
    if (field.kind === "part") {
      const chosen = modelOf(schema, field, value);
      if (field.chosen) parts.laws.push(field.options.indexOf(chosen));
      flatten(schema, chosen, value, `${path}.`, parts);
    } else if (field.kind === "choice") parts.shape.push(field.options.indexOf(value));
    else if (field.kind === "whole") parts.shape.push(value);
    else if (field.kind === "sequence") {
      parts.shape.push(value.length);
      value.forEach((each, i) => addNumber(parts, each, `${path}[${i}]`, field));
    } else addNumber(parts, value, path, field);
  }
}
function addNumber(parts, value, path, field) {
  parts.numbers.push(value);
  parts.paths.push(path);
  parts.fields.push(field);
}

/** The keys of a path such as hysteresis.stiffness[0]. */
const keysOf = (path) => path.replaceAll("]", "").split(/[.[]/).map((key) => (/^\d+$/.test(key) ? Number(key) : key));

/** A copy of nested values with one of them changed. */
function replaced(values, path, value) {
  const [head, ...rest] = path;
  const copy = Array.isArray(values) ? [...values] : { ...values };
  copy[head] = rest.length ? replaced(values[head], rest, value) : value;
  return copy;
}
const valueAt = (values, path) => path.reduce((inner, key) => inner?.[key], values);

function sameValues(one, other) {
  return JSON.stringify(one) === JSON.stringify(other);
}

// ---- Python --------------------------------------------------------------------------------------------------------

/** A model as a Python expression; parts and numbers that have their default are left out. `texts` replace members. */
function pythonOf(schema, id, values, indent = "", texts = {}) {
  const deeper = `${indent}    `, lines = [];
  for (const field of schema.models[id].fields) {
    const value = values[field.name], otherwise = field.follows ? values[field.follows] : field.default;
    if (!field.required && sameValues(value, otherwise)) continue;
    if (texts[field.name]) lines.push(`${field.name}=${texts[field.name]}`);
    else if (field.kind === "part") lines.push(`${field.name}=${pythonOf(schema, modelOf(schema, field, value), value, deeper)}`);
    else if (field.kind === "choice") lines.push(`${field.name}=${JSON.stringify(value)}`);
    else if (field.kind === "sequence") lines.push(`${field.name}=[${value.map(floatText).join(", ")}]`);
    else lines.push(`${field.name}=${numberText(field, value)}`);
  }
  const short = `sw.${id}(${lines.join(", ")})`;
  return short.length + indent.length <= 88 && !short.includes("\n") ? short : `sw.${id}(\n${lines.map((line) => `${deeper}${line},\n`).join("")}${indent})`;
}

// ---- Permalink -------------------------------------------------------------------------------------------------------

async function through(bytes, stream, limit) {
  const reader = new Blob([bytes]).stream().pipeThrough(stream).getReader(), chunks = [];
  for (let size = 0; ; ) {
    const { done, value } = await reader.read();
    if (done) break;
    size += value.length;
    if (size > limit) { await reader.cancel(); throw new Error("the link contains too much"); }
    chunks.push(value);
  }
  return new Uint8Array(await new Blob(chunks).arrayBuffer());
}
const toBase64 = (bytes) => btoa(Array.from(bytes, (byte) => String.fromCharCode(byte)).join(""));
const fromBase64 = (text) => Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));

/** Any data as the fragment of a link: JSON, deflated, base64url; null if that is longer than a link may be. */
async function toFragment(data) {
  const plain = new TextEncoder().encode(JSON.stringify(data));
  if (plain.length > MAX_INFLATED) return null;
  const text = toBase64(await through(plain, new CompressionStream("deflate-raw"), 2 * MAX_INFLATED)).replaceAll("+", "-").replaceAll("/", "_").replaceAll("=", "");
  return text.length > MAX_FRAGMENT ? null : text;
}
async function fromFragment(text) {
  if (text.length > MAX_FRAGMENT || !/^[\w-]*$/.test(text)) throw new Error("the link is too long or not whole");
  const bytes = fromBase64(text.replaceAll("-", "+").replaceAll("_", "/"));
  return JSON.parse(new TextDecoder().decode(await through(bytes, new DecompressionStream("deflate-raw"), MAX_INFLATED)));
}
