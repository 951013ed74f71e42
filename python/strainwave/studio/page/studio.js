// Pages of the studio beside those of the workbench: forms of the verbs of the command, files, jobs and their reports.

const RECONNECT = 1000; // ms between two attempts
const ENDED = { done: "done", contradicted: "a check failed", asked: "a question is open", refused: "refused", failed: "failed", cancelled: "cancelled", interrupted: "interrupted: the server ended" };
const SHEETS = { Gear: "gear", Drive: "motor, controller, load and a run" }; // of the workbench itself
const FIRST = ["constant", "joint"]; // options that many recordings need
const CHOICES = { side: ["", "input", "output"] };
const label = (name) => name.replaceAll("_", " ");
const shortNumber = (value) => shortText(value, 3);

class Studio {
  constructor(workbench, { pages, sets }) {
    Object.assign(this, { workbench, pages, sets, files: [], opened: [], jobs: new Map(), waiting: [], sheets: {} });
    this.forms = Object.fromEntries(Object.values(pages).flat().map((form) => [form.verb, form]));
    this.buildNavigation();
    for (const [page, forms] of Object.entries(pages)) this.sheets[page] = page === "Faults" ? new FaultSheet(this, page, forms) : new Sheet(this, page, forms);
    document.querySelector("main").after(...Object.values(this.sheets).map(({ element }) => element));
    this.show("Gear");
    this.connect();
  }
  // ---- Pages ---------------------------------------------------------------------------------------------------------
  buildNavigation() {
    this.tabs = [...Object.keys(SHEETS), ...Object.keys(this.pages)].map((page) => {
      const made = element("button", { type: "button" }, page);
      made.onclick = () => this.show(page);
      return made;
    });
    this.connection = element("span", { className: "connection", role: "status" }, "connecting");
    const send = element("button", { type: "button", title: "The other pages can then choose it as their gear" }, "Use this gear in the other pages");
    send.onclick = () => this.saveGear();
    document.querySelector("header [aria-label=Export]").append(send);
    document.querySelector("header").before(element("nav", { "aria-label": "Pages" }, ...this.tabs, this.connection));
    document.body.ondragover = (event) => event.preventDefault();
    document.body.ondrop = (event) => { if (!event.defaultPrevented) { event.preventDefault(); this.upload(event.dataTransfer.files); } };
  }
  show(page) {
    this.say("");
    document.body.dataset.page = page;
    for (const tab of this.tabs) tab.setAttribute("aria-current", tab.textContent === page ? "page" : "false");
    for (const [name, sheet] of Object.entries(this.sheets)) sheet.element.hidden = name !== page;
    document.querySelector("main").hidden = document.querySelector("header").hidden = !(page in SHEETS);
    if (page === "Drive") this.workbench.form.open.add("drive");
    if (page in SHEETS) this.workbench.showAll();
    else this.sheets[page].shown();
    this.workbench.toTop();
  }
  say(text, bad = false) { this.workbench.say(text, bad); }
  // ---- The server ----------------------------------------------------------------------------------------------------
  connect() {
    this.socket = new WebSocket(new URL("live", location.href.replace(/^http/, "ws").replace(/#.*/, "")));
    this.socket.onopen = () => { this.connected(true); for (const message of this.waiting.splice(0)) this.ask(message); };
    this.socket.onclose = () => { this.connected(false); setTimeout(() => this.connect(), RECONNECT); };
    this.socket.onmessage = ({ data }) => this.take(JSON.parse(data));
  }
  connected(is) {
    this.connection.textContent = is ? "" : "The server does not answer. The page keeps what you entered and connects again when strainwave studio runs.";
    this.connection.classList.toggle("bad", !is);
  }
  /** Asks the server. While it is away a run is refused, and of all else the newest is kept. */
  ask(message) {
    if (this.socket.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify(message));
    else if (message.do === "start") this.take({ problem: "The server does not answer: start strainwave studio again, then run." });
    else this.waiting = [...this.waiting.filter((each) => each.do !== message.do || message.do === "cancel"), message];
  }
  take(message) {
    if (message.files) { this.files = message.files; this.opened = message.opened; for (const sheet of Object.values(this.sheets)) sheet.filesChanged(); }
    if (message.jobs) this.jobs = new Map(message.jobs.map((job) => [job.id, job]));
    if (message.job) this.jobs.set(message.job.id, message.job);
    if (message.jobs || message.job) for (const sheet of Object.values(this.sheets)) sheet.jobsChanged(message.job);
    if (message.started) document.getElementById(message.started)?.scrollIntoView({ block: "nearest" });
    if (message.read) this.sheets.Identify.showReadings(message.read);
    if (message.gear) this.openGear(message.gear);
    if (message.spectrum) this.sheets.Faults.showSpectrum(message.spectrum);
    if (message.problem) for (const sheet of Object.values(this.sheets)) sheet.problem(message.problem, message.of);
  }
  openGear(start) {
    const { workbench } = this, { travel } = workbench.view;
    workbench.start = start;
    const origin = workbench.origin(start.name, start);
    workbench.change({ name: start.name, drive: origin.drive, view: { ...workbench.view, travel: { ...travel, ...start.travel } }, origin }, true);
    this.show("Gear");
  }
  async upload(files) {
    for (const file of files) {
      this.say(`${file.name} is sent`);
      try {
        const answer = await fetch(`files/${encodeURIComponent(file.name)}`, { method: "PUT", body: file });
        const told = answer.headers.get("content-type").includes("json") ? await answer.json() : { problem: await answer.text() };
        this.say(told.problem ?? `${told.name} is in the studio`, Boolean(told.problem));
        if (told.name) for (const sheet of Object.values(this.sheets)) sheet.fileCame(told.name);
        if (told.problem) for (const sheet of Object.values(this.sheets)) sheet.problem(told.problem);
      } catch { this.connected(false); this.say(`${file.name} was not sent: the server does not answer`, true); }
    }
  }
  async saveGear() {
    const name = `${(this.workbench.state.name || "gear").replace(/[^\p{L}\p{N}]+/gu, "-").replace(/^-+|-+$/g, "") || "gear"}.toml`;
    await this.upload([new File([this.workbench.toml()], name)]);
    for (const sheet of Object.values(this.sheets)) if (!sheet.element.hidden) sheet.build();
  }
}

/** One page: its files, the form of a verb, and the jobs of its verbs. */
class Sheet {
  constructor(studio, page, forms) {
    Object.assign(this, { studio, page, forms, values: {} });
    this.element = element("section", { className: "sheet", hidden: true, role: "main", "aria-label": page });
    this.verb = element("select", { "aria-label": "what to do" }, ...forms.map(({ verb, summary }) => element("option", { value: verb }, `${verb}: ${summary}`)));
    this.verb.onchange = () => this.build();
    this.filesBox = element("div", { className: "files" });
    this.formBox = element("form", { className: "verb" });
    this.readBox = element("div", { className: "readings" });
    this.message = element("p", { className: "problem", role: "alert" });
    this.jobsBox = element("div", { className: "jobs" });
    this.formBox.onsubmit = (event) => { event.preventDefault(); this.start(); };
    this.element.append(...this.content());
    this.build();
  }
  content() {
    this.shownBox = element("div", { className: "shown" }, this.readBox, this.jobsBox);
    return [element("div", { className: "ask" }, element("h1", {}, this.page), this.verb, this.filesBox, this.formBox, this.message), this.shownBox];
  }
  get form() { return this.studio.forms[this.verb.value]; }
  get takesFiles() { return this.form.fields.some(({ kind }) => kind === "files" || kind === "file"); }
  shown() { this.build(); }
  problem(text, of) {
    if (of === "read" && this.page === "Identify") this.readBox.replaceChildren(element("p", { className: "problem" }, text));
    else if (of !== "read" && !this.element.hidden) this.message.textContent = text;
  }
  // ---- The form ------------------------------------------------------------------------------------------------------
  build() {
    const { fields } = this.form, inFront = ({ required, name }) => required || FIRST.includes(name);
    const first = fields.filter((field) => inFront(field) && field.kind !== "files"), rest = fields.filter((field) => !inFront(field) && !this.isInTable(field.name));
    const begin = element("button", { className: "begin" }, `Run ${this.verb.value}`);
    this.formBox.replaceChildren(...first.map((field) => this.row(field)),
      element("details", { open: this.hasOptions ?? !this.takesFiles }, element("summary", {}, "Options"), ...rest.map((field) => this.row(field))), begin);
    this.formBox.querySelector("details").ontoggle = ({ target }) => { this.hasOptions = target.open; };
    this.filesChanged();
    this.jobsChanged();
    if (this.focused) document.getElementById(this.focused)?.focus();
    this.focused = null;
  }
  isInTable(name) { return this.page === "Identify" && this.takesFiles && ["column", "unit", "side"].includes(name); }
  row(field) {
    const id = `${this.page}-${field.name}`, value = this.values[field.name];
    const put = (given) => { if (given === "" || given === false || given?.length === 0) delete this.values[field.name]; else this.values[field.name] = given; this.changed(field.name); };
    let input;
    if (field.kind === "flag") input = element("input", { type: "checkbox", id, checked: value === true, onchange: () => put(input.checked) });
    else if (field.kind === "set") input = this.setMenu(id, value, put);
    else if (field.kind === "file" || field.kind === "files") {
      const files = element("select", { id, multiple: field.several, size: field.several ? 3 : 1 }, ...(field.several ? [] : [element("option", { value: "" }, "none")]), ...this.studio.files.map((name) => element("option", { value: name, selected: [value].flat().includes(name) }, name)));
      files.onchange = () => put(field.several ? [...files.selectedOptions].map((option) => option.value) : files.value);
      input = files;
    } else if (CHOICES[field.name]) { input = select(CHOICES[field.name], value ?? "", { id }); input.onchange = () => put(input.value); }
    else if (field.several) {
      input = element("textarea", { id, rows: 1 + [value ?? []].flat().length, value: [value ?? []].flat().join("\n"), placeholder: "one a line" });
      input.onchange = () => put(input.value.split("\n").map((line) => line.trim()).filter(Boolean));
    } else {
      input = element("input", { id, value: value ?? "", placeholder: field.default, autocomplete: "off", spellcheck: false });
      if (field.kind !== "text") input.inputMode = "decimal";
      input.onchange = () => put(field.kind === "text" ? input.value.trim() : input.value.trim().replace(",", "."));
    }
    input.setAttribute("aria-describedby", `${id}-help`);
    return element("div", { className: "field" }, element("label", { htmlFor: id }, label(field.name)), input, element("small", { id: `${id}-help` }, field.help));
  }
  setMenu(id, value, put) {
    const gears = this.studio.files.filter((name) => name.endsWith(".toml") || this.verb.value === "compare");
    const list = element("datalist", { id: `${id}-sets` }, ...[...gears, ...this.studio.sets].map((name) => element("option", { value: name })));
    const input = element("input", { id, value: value ?? "", placeholder: "a set by name, or a file", autocomplete: "off", spellcheck: false, onchange: () => put(input.value.trim()) });
    input.setAttribute("list", list.id);
    return element("span", {}, input, list);
  }
  changed() { this.message.textContent = ""; }
  get filled() {
    const names = new Set(this.form.fields.map(({ name }) => name));
    return Object.fromEntries(Object.entries(this.values).filter(([name]) => names.has(name)));
  }
  start() {
    this.message.textContent = "";
    this.studio.ask({ do: "start", name: this.verb.value, values: this.filled });
  }
  // ---- Files ---------------------------------------------------------------------------------------------------------
  filesChanged() {
    for (const { kind, name } of this.form.fields) if (kind === "files" && this.values[name]) this.values[name] = this.values[name].filter((each) => this.studio.files.includes(each));
    if (!this.takesFiles) { this.filesBox.replaceChildren(); this.readBox.replaceChildren(); return; }
    const chosen = new Set(this.values.paths ?? []);
    const rows = this.studio.files.filter((name) => !name.endsWith(".toml")).map((name) => {
      const box = element("input", { type: "checkbox", id: `${this.page}-file-${name}`, checked: chosen.has(name), onchange: () => this.choose(name, box.checked) });
      return element("label", {}, box, ` ${name}`, this.studio.opened.includes(name) ? element("small", {}, " opened") : this.remover(name));
    });
    const more = element("input", { type: "file", multiple: true, onchange: () => this.studio.upload(more.files), "aria-label": "add files" });
    const focus = document.activeElement?.id;
    this.filesBox.replaceChildren(element("h2", {}, "Recordings"), ...rows, element("p", { className: "hint" }, "Drop files on this page, or choose them: ", more));
    if (focus) document.getElementById(focus)?.focus();
  }
  remover(name) {
    const made = element("button", { type: "button", className: "small", title: `remove ${name} from the studio`, "aria-label": `remove ${name} from the studio` }, "×");
    made.onclick = (event) => { event.preventDefault(); fetch(`files/${encodeURIComponent(name)}`, { method: "DELETE" }).catch(() => this.studio.connected(false)); };
    return made;
  }
  fileCame(name) {
    if (this.element.hidden || !this.takesFiles || name.endsWith(".toml")) return;
    if (!this.studio.files.includes(name)) this.studio.files.push(name);
    this.choose(name, true);
  }
  choose(name, is) {
    const chosen = new Set(this.values.paths ?? []);
    if (is) chosen.add(name); else chosen.delete(name);
    this.values.paths = [...chosen];
    this.filesChanged();
    this.askReadings();
  }
  // ---- How files are read --------------------------------------------------------------------------------------------
  askReadings() {
    if (this.page !== "Identify") return;
    if (!this.values.paths?.length) { this.readBox.replaceChildren(); return; }
    this.readBox.replaceChildren(element("p", { className: "hint" }, "reading"));
    this.studio.ask({ do: "read", values: this.filled });
  }
  showReadings(readings) { this.readBox.replaceChildren(...readings.map((reading) => this.reading(reading))); }
  reading({ name, kind, side, joint, rows, columns, why, remarks, question, problem }) {
    const box = element("article", { className: "reading" }, element("h3", {}, name));
    if (problem) { box.append(element("p", { className: "problem" }, problem)); return box; }
    if (kind) box.append(element("p", {}, [kind, side && `at the ${side}`, joint && `joint ${joint}`, `${rows} rows`].filter(Boolean).join(", ")));
    if (question) box.append(this.question(question, () => this.askReadings()));
    if (kind) box.append(this.sideMenu(side));
    const head = element("thead", {}, element("tr", {}, ...["column", "is", "unit", "from … to"].map((text) => element("th", { scope: "col" }, text))));
    const [used, others] = [true, false].map((is) => columns.filter(({ channel }) => Boolean(channel) === is).map((column) => this.column(column)));
    const tableOf = (rows) => element("div", { className: "wide" }, element("table", {}, head.cloneNode(true), element("tbody", {}, ...rows)));
    if (used.length) box.append(tableOf(used));
    if (others.length) box.append(element("details", { open: !used.length && !question }, element("summary", {}, `${others.length} columns that are not used`), tableOf(others)));
    if (why?.length || remarks?.length) box.append(element("details", {}, element("summary", {}, "Why, and remarks"), element("ul", {}, ...[...(why ?? []), ...(remarks ?? [])].map((line) => element("li", {}, line)))));
    return box;
  }
  sideMenu(side) {
    const menu = element("select", {}, ...["", "input", "output"].map((each) => element("option", { value: each, selected: each === (this.values.side ?? "") }, each || `as read${side ? `: ${side}` : ""}`)));
    menu.onchange = () => { if (menu.value) this.values.side = menu.value; else delete this.values.side; this.askReadings(); };
    return element("label", { className: "side" }, "side of the numbers ", menu);
  }
  column({ column, channel, unit, assumed, low, high, si }) {
    const menu = element("select", { "aria-label": `what ${column} is` }, element("option", { value: "" }, "not used"), ...CHANNELS.map((each) => element("option", { value: each, selected: each === channel }, label(each))));
    menu.onchange = () => {
      const given = this.values.column ?? [];
      const before = given.find((each) => each.startsWith("unused="))?.slice("unused=".length).split(",") ?? [];
      const unused = [...before.filter((each) => each !== column), ...(menu.value ? [] : [column])];
      const others = given.filter((each) => !each.startsWith("unused=") && !each.endsWith(`=${column}`) && !each.startsWith(`${menu.value}=`));
      this.values.column = [...others, ...(menu.value ? [`${menu.value}=${column}`] : []), ...(unused.length ? [`unused=${unused.join(",")}`] : [])];
      this.askReadings();
    };
    const input = element("input", { value: unit ?? "", "aria-label": `unit of ${column}`, spellcheck: false, disabled: !channel });
    input.onchange = () => {
      const others = (this.values.unit ?? []).filter((each) => !each.startsWith(`${channel}=`));
      this.values.unit = input.value.trim() ? [...others, `${channel}=${input.value.trim()}`] : others;
      this.askReadings();
    };
    const range = low === undefined ? "" : `${shortNumber(low)} … ${shortNumber(high)} ${si}`;
    return element("tr", {}, element("th", { scope: "row" }, column), element("td", {}, menu), element("td", {}, input, assumed ? element("small", {}, " assumed") : ""), element("td", {}, range));
  }
  question({ text, answers }, answered) {
    const ways = answers.map((answer) => {
      const made = element("button", { type: "button" }, `${answer.label}${answer.gives ? `: ${answer.gives}` : ""}`);
      const numbers = Object.entries(answer.numbers).map(([key, meaning]) => [key, element("input", { placeholder: meaning, "aria-label": meaning, inputMode: "decimal" })]);
      made.onclick = () => { this.focused = `${this.page}-${this.form.fields.find(({ required, kind }) => required && kind !== "files")?.name}`; if (this.answer(answer, Object.fromEntries(numbers.map(([key, input]) => [key, input.value.trim()])))) answered(); };
      return element("li", {}, made, ...numbers.map(([, input]) => input));
    });
    return element("div", { className: "question", role: "group", "aria-label": "question" }, element("p", {}, text), element("ol", {}, ...ways));
  }
  /** Puts an answer into the form; false if one of its numbers is missing. */
  answer({ options, numbers, files }, given) {
    const names = new Set(this.form.fields.map(({ name }) => name));
    for (const [name, word] of options) {
      const key = word.split("=")[0];
      const value = numbers[key] ? word.replace("NUMBER", given[key]) : word;
      if (numbers[key] && !given[key]) { this.message.textContent = `give the number: ${numbers[key]}`; return false; }
      if (!names.has(name)) continue;
      const field = this.form.fields.find((each) => each.name === name);
      this.values[name] = field.several ? [...(this.values[name] ?? []).filter((each) => !each.startsWith(`${key}=`)), value] : value;
    }
    for (const path of files) { const name = path.split(/[\\/]/).at(-1); if (this.studio.files.includes(name)) this.values.paths = [...new Set([...this.values.paths, name])]; }
    this.build();
    return true;
  }
  // ---- Jobs ----------------------------------------------------------------------------------------------------------
  jobsChanged(changed) {
    const verbs = new Set(this.forms.map(({ verb }) => verb)), jobs = [...this.studio.jobs.values()].filter(({ verb }) => verbs.has(verb)).reverse();
    if (changed && !verbs.has(changed.verb)) return;
    const shown = changed && document.getElementById(changed.id);
    if (shown) { shown.replaceWith(this.job(changed, changed === jobs[0])); return; } // others keep their reports as they are
    this.jobsBox.replaceChildren(...(jobs.length ? [element("h2", {}, "Runs")] : []), ...jobs.map((job, place) => this.job(job, place === 0)));
  }
  job(job, isNewest) {
    const { id, verb, state, stage, share, lines, files, seconds, question } = job, runs = state === "running" || state === "waiting";
    const head = element("div", { className: "bar" }, element("h3", {}, id), element("span", { className: state === "done" ? "" : "quiet" }, runs ? state : `${ENDED[state] ?? state}${seconds ? `, ${shortText(seconds, 2)} s` : ""}`));
    const box = element("article", { className: `job ${state}`, id }, head);
    if (runs) {
      const cancel = element("button", { type: "button", onclick: () => this.studio.ask({ do: "cancel", name: id }) }, "Cancel");
      const bar = element("progress", { "aria-label": "progress" });
      if (typeof share === "number") bar.value = share;
      head.append(cancel);
      box.append(bar, element("span", {}, ` ${stage ?? ""}, ${Math.round(Date.now() / 1000 - job.begun)} s`));
      return box;
    }
    const again = element("button", { type: "button", title: "Put what this run was asked into the form" }, "Take into the form");
    again.onclick = () => { this.values = structuredClone(job.values); this.verb.value = verb; this.hasOptions = true; this.build(); this.askReadings(); this.element.scrollIntoView(); };
    head.append(again);
    if (question) box.append(isNewest ? this.question(question, () => this.start()) : element("p", {}, question.text));
    if (lines.length) box.append(element("pre", { tabIndex: 0, "aria-label": "output" }, lines.join("\n")));
    const link = (name) => element("a", { href: `results/${id}/${name.split("/").map(encodeURIComponent).join("/")}`, target: "_blank", rel: "noopener" }, name);
    if (files.length) box.append(element("p", { className: "links" }, ...files.filter((name) => !name.includes("/") && name !== "workbench.html").flatMap((name) => [link(name), " "])));
    if (files.includes("gear.toml")) {
      const open = element("button", { type: "button" }, "Open gear.toml in the pages Gear and Drive");
      open.onclick = () => this.studio.ask({ do: "gear", values: { name: `${id}/gear.toml` } });
      box.append(open);
    }
    if (files.includes("report.html")) {
      const report = element("details", { open: isNewest }, element("summary", {}, "Report"));
      const frame = element("iframe", { title: `report of ${id}`, loading: "lazy" });
      const load = () => { if (report.open && !frame.src) frame.src = `results/${id}/report.html`; };
      report.ontoggle = load;
      report.append(frame);
      load();
      box.append(report);
    }
    return box;
  }
}

/** The page of faults: a misalignment under the hand, and the orders of the current that it makes. */
class FaultSheet extends Sheet {
  content() {
    this.live = { drive: "robot-joint", combine: "single", moved: { housing_eccentricity: 2e-5, housing_tilt_x: 0, generator_eccentricity: 0, generator_tilt_x: 0 }, record: { speed: 30, load_torque: 0, duration: 2, rate: 500, noise: 0.02 } };
    const slider = (group, name, text, low, high, scale, unit) => {
      const output = element("output", {});
      const input = element("input", { type: "range", min: low, max: high, step: (high - low) / 200, value: this.live[group][name] / scale, "aria-label": text });
      input.oninput = () => { this.live[group][name] = input.value * scale; output.textContent = `${shortNumber(Number(input.value))} ${unit}`; this.askSpectrum(); };
      output.textContent = `${shortNumber(Number(input.value))} ${unit}`;
      return element("label", { className: "slider" }, element("span", {}, text), input, output);
    };
    const drive = this.setMenu("fault-drive", this.live.drive, (name) => { this.live.drive = name; this.askSpectrum(); });
    const combine = select(["single", "mean", "max"], this.live.combine, { "aria-label": "how the lobes share" });
    combine.onchange = () => { this.live.combine = combine.value; this.askSpectrum(); };
    this.canvas = element("div", { className: "canvas", role: "img" });
    this.reading = element("p", { className: "numbers", role: "status" });
    const live = element("article", { className: "plot live" }, element("h2", {}, "Misalignment and the orders of the current"),
      element("div", { className: "sliders" }, element("label", { className: "slider" }, element("span", {}, "drive"), drive), element("label", { className: "slider" }, element("span", {}, "lobes share"), combine),
        slider("moved", "housing_eccentricity", "eccentricity of the shaft", 0, 200, 1e-6, "µm"), slider("moved", "housing_tilt_x", "tilt of the shaft", -1, 1, 1e-3, "mrad"),
        slider("moved", "generator_eccentricity", "eccentricity of the generator", 0, 200, 1e-6, "µm"), slider("moved", "generator_tilt_x", "tilt of the generator", -1, 1, 1e-3, "mrad"),
        slider("record", "speed", "speed of the input", 5, 155, 1, "rad/s"), slider("record", "duration", "length of the record", 1, 21, 1, "s"),
        slider("record", "load_torque", "load torque", 0, 100, 1, "N·m"), slider("record", "noise", "noise of the current", 0, 0.2, 1, "A")),
      this.canvas, this.reading);
    const content = super.content();
    this.shownBox.prepend(live);
    return content;
  }
  shown() {
    super.shown();
    this.plot ??= new Plot(this.canvas, () => {});
    if (!this.found) this.askSpectrum();
  }
  askSpectrum() {
    this.reading.textContent = "computing";
    this.canvas.classList.add("old");
    this.studio.ask({ do: "spectrum", values: this.live });
  }
  showSpectrum({ orders, healthy, misaligned, limit, assumed }) {
    this.found = true;
    this.canvas.classList.remove("old");
    const wide = [0.5, ...orders, orders.at(-1) + 0.5];
    this.plot.show(["order, periods a turn of the input", "current [A]"], [
      { x: [...orders.map((order) => order + 0.12), NaN], y: [...healthy, 0], colour: "--other", dash: true, mark: "bar" },
      { x: [...orders, NaN], y: [...misaligned, 0], colour: "--one", mark: "bar" },
      { x: wide, y: [limit[0], ...limit, limit.at(-1)], colour: "--data", dash: true },
    ]);
    const shown = orders.filter((_, i) => Math.abs(misaligned[i] - healthy[i]) > limit[i]);
    this.reading.textContent = `${shown.length ? `${shown.length > 1 ? "Orders" : "Order"} ${shown.join(", ")} ${shown.length > 1 ? "change" : "changes"}` : "No order changes"} by more than the limit, the smallest line that such a record shows (grey). Blue: misaligned, orange: without misalignment.${assumed ? " The drive has no dimensions of the wave generator: they are assumed." : ""}`;
    this.canvas.setAttribute("aria-label", this.reading.textContent);
  }
  problem(text, of) { if (of === "spectrum") { this.reading.textContent = text; this.plot.show(["order", "current [A]"], []); } else super.problem(text, of); }
}

const about = dataIn("studio"), CHANNELS = about.channels;
window.workbench.then((workbench) => { window.studio = new Studio(workbench, about); });
