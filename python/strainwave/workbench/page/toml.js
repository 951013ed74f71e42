// TOML 1.0 without dates: tables, keys and values of gear files. What else a text contains is refused with its line.

const MAX_DEPTH = 20; // of tables, lists and keys in one another
const ESCAPES = { b: "\b", t: "\t", n: "\n", f: "\f", r: "\r", '"': '"', "\\": "\\" };

/** The content of a TOML text, tables as objects without prototype. */
function fromToml(text) {
  return new TomlReader(text.replace(/^\uFEFF/, "").replaceAll("\r\n", "\n")).document();
}

class TomlReader {
  constructor(text) {
    Object.assign(this, { text, at: 0, opened: new Set(), whole: new Set() }); // tables with a header; tables and lists in brackets
  }
  fail(what) { throw new Error(`line ${this.text.slice(0, this.at).split("\n").length}: ${what}`); }
  /** The match of a sticky pattern here, which is then behind; null if there is none. */
  take(pattern) {
    pattern.lastIndex = this.at;
    const found = pattern.exec(this.text);
    if (found) this.at = pattern.lastIndex;
    return found;
  }
  next(character) { return this.text.startsWith(character, this.at) && Boolean((this.at += character.length)); }
  need(character) { if (!this.next(character)) this.fail(`${character} expected`); }
  blanks() { this.take(/[ \t]*/y); }
  /** Blanks, ends of lines and comments. */
  gap() { this.take(/(?:[ \t\n]|#[^\n]*)*/y); }
  endOfLine() { if (!this.take(/[ \t]*(?:#[^\n]*)?(?:\n|$)/y)) this.fail("end of line expected"); }

  document() {
    const root = Object.create(null);
    let table = root;
    for (this.gap(); this.at < this.text.length; this.gap()) {
      if (this.next("[[")) table = this.listed(root, this.keys("]]"));
      else if (this.next("[")) table = this.headed(root, this.keys("]"));
      else this.pair(table);
      this.endOfLine();
    }
    return root;
  }
  /** The keys of a header or pair, up to its end. */
  keys(end) {
    const keys = [];
    do {
      this.blanks();
      keys.push(this.take(/[\w-]+/y)?.[0] ?? this.quoted() ?? this.fail("a key expected"));
      this.blanks();
      if (keys.length > MAX_DEPTH) this.fail("too deep");
    } while (this.next("."));
    this.need(end);
    return keys;
  }
  /** The table at these keys, made where it is missing; in a list of tables its last one. */
  inner(table, keys) {
    for (const key of keys) {
      const value = (table[key] ??= Object.create(null));
      table = Array.isArray(value) ? value.at(-1) : value;
      if (typeof table !== "object" || this.whole.has(value)) this.fail(`${key} is no table that goes on`);
    }
    return table;
  }
  headed(root, keys) {
    const table = this.inner(root, keys.slice(0, -1)), key = keys.at(-1), own = (table[key] ??= Object.create(null));
    if (this.opened.has(own) || this.whole.has(own) || typeof own !== "object" || Array.isArray(own)) this.fail(`[${keys.join(".")}] comes twice`);
    this.opened.add(own);
    return own;
  }
  listed(root, keys) {
    const parent = this.inner(root, keys.slice(0, -1)), list = (parent[keys.at(-1)] ??= []);
    if (!Array.isArray(list) || this.whole.has(list)) this.fail(`${keys.join(".")} is no list of tables`);
    list.push(Object.create(null));
    return list.at(-1);
  }
  pair(table, depth = 0) {
    const keys = this.keys("="), inner = this.inner(table, keys.slice(0, -1)), key = keys.at(-1);
    if (key in inner) this.fail(`${key} comes twice`);
    if (inner !== table && this.opened.has(inner)) this.fail(`${keys[0]} has a header`);
    inner[key] = this.value(depth);
  }
  value(depth) {
    if (depth > MAX_DEPTH) this.fail("too deep");
    this.blanks();
    const text = this.quoted();
    if (text !== undefined) return text;
    if (this.next("[")) return this.list(depth);
    if (this.next("{")) return this.braced(depth);
    const word = this.take(/[^\s,\]}#]+/y)?.[0] ?? this.fail("a value expected");
    if (word === "true" || word === "false") return word === "true";
    if (!/^[+-]?(?:0|[1-9](?:_?\d)*)(?:\.\d(?:_?\d)*)?(?:[eE][+-]?\d(?:_?\d)*)?$/.test(word)) this.fail(`${word.slice(0, 40)} is neither text nor number`);
    return Number(word.replaceAll("_", ""));
  }
  list(depth) {
    const values = [];
    this.whole.add(values);
    for (this.gap(); !this.next("]"); this.gap()) {
      values.push(this.value(depth + 1));
      this.gap();
      if (!this.next(",")) { this.need("]"); break; }
    }
    return values;
  }
  braced(depth) {
    const table = Object.create(null);
    this.blanks();
    if (!this.next("}")) {
      do this.pair(table, depth + 1); while ((this.blanks(), this.next(",")));
      this.need("}");
    }
    this.whole.add(table);
    return table;
  }
  /** A text in quotes; undefined if none begins here. */
  quoted() {
    const long = this.take(/"""\n?((?:[^"\\]|\\[^]|"(?!""))*"{0,2})"""/y);
    if (long) return this.unescaped(long[1]);
    const literal = this.take(/'''\n?((?:[^']|'(?!''))*'{0,2})'''/y) ?? this.take(/'([^'\n]*)'/y);
    if (literal) return literal[1];
    const short = this.take(/"((?:[^"\\\n]|\\[^\n])*)"/y);
    if (short) return this.unescaped(short[1]);
    return /["']/.test(this.text[this.at] ?? "") ? this.fail("a text without end") : undefined;
  }
  unescaped(text) {
    return text.replace(/\\(u[\da-fA-F]{4}|U[\da-fA-F]{8}|[ \t]*\n[ \t\n]*|[^])/g, (whole, code) => {
      if (code.includes("\n")) return "";
      if (code.length === 1) return ESCAPES[code] ?? this.fail(`${whole} is no escape`);
      const point = parseInt(code.slice(1), 16);
      return point > 0x10ffff || (point >= 0xd800 && point < 0xe000) ? this.fail(`${whole} is no character`) : String.fromCodePoint(point);
    });
  }
}
