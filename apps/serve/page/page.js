// The page as a view of the newest event of each kind. Nothing here decides anything: fields that an
// older or newer daemon does not send are absent, and shown as such.
"use strict";

const state = {points: []}; // the newest event by kind; points: the answers of the last minutes
const points_max = 300;
const alive_ms = 7000; // without an event: the server is gone
const at = id => document.getElementById(id);
const is_number = value => typeof value === "number" && Number.isFinite(value);
const fixed = (value, digits, unit = "") => is_number(value) ? value.toFixed(digits) + unit : "–";
const percent = value => is_number(value) ? (100 * value).toFixed(0) + " %" : "–";
const mib = bytes => fixed(bytes / 1048576, 0, " MiB");

function text(element, value) {
  if (element.textContent !== value)
    element.textContent = value;
}

// An element with a class and children, which are elements or text.
function make(name, style, ...children) {
  const element = document.createElement(name);
  if (style)
    element.className = style;
  element.append(...children);
  return element;
}

// --- colours of experiences, in the order in which they were first seen

const inks = new Map();
function ink(experience) {
  if (!inks.has(experience))
    inks.set(experience, inks.size < 8 ? `ink${inks.size}` : "ink");
  return inks.get(experience);
}

// --- the parts of the page

function show_headline() {
  const {headline, status} = state;
  if (!headline)
    return;
  at("headline").className = `headline ${headline.tone}`;
  text(at("sentence"), headline.text);
  const silent = headline.tone === "bad" && (state.pulse?.status_age_s ?? 0) > 3;
  const name = headline.name ?? (!status ? "WAITING" : silent ? "SILENT" : status.state.replace("_", " "));
  text(at("state"), name);
  if (at("announced").dataset.state !== name) { // a screen reader hears changes, not each number
    at("announced").dataset.state = name;
    text(at("announced"), `${name}. ${headline.text}`);
  }
  document.title = `${name.toLowerCase()}${status?.experience ? ": " + status.experience : ""} – vdna`;
  text(at("host"), status?.host ?? "");
}

function show_live() {
  const {picture, pulse} = state;
  if (picture) {
    const image = at("live");
    if (picture.problem) {
      image.hidden = true;
      text(at("no-live"), "This picture cannot be shown");
    } else if (image.dataset.loading !== "yes") { // a slow link gets fewer, not older ones
      image.dataset.loading = "yes";
      image.src = `picture?${picture.utime}`;
    }
  }
  if (pulse)
    text(at("live-facts"), pulse.camera_age_s === null ? "No camera heard"
      : `${fixed(pulse.camera_hz, 1)} frames per second, newest ${fixed(pulse.camera_age_s, 1)} s ago`);
}

function position_of(answer) {
  if (!answer.position)
    return is_number(answer.place) ? `, place ${answer.place}` : "";
  const digits = answer.position_frame === "wgs84" ? 6 : 1;
  return `, at ${answer.position.slice(0, 2).map(value => value.toFixed(digits)).join(" ")}` +
    (digits === 6 ? "" : ` m in ${answer.position_frame}`);
}

// The matched frame of the map, if the server has the map; the newest one once the last has come.
function show_match_picture(answer) {
  const image = at("match"), url = answer?.experience ? `map/${answer.experience}/${answer.frame}.jpg` : "";
  if (!state.map?.shown || !url) {
    image.hidden = true;
    text(at("no-match"), state.map && !state.map.shown ? "To see it, start vdna serve with --map DIR" : "No match yet");
  } else if (image.dataset.url !== url && image.dataset.loading !== "yes") {
    image.dataset.loading = "yes";
    image.src = image.dataset.url = url;
  }
}

function show_match() {
  const answer = state.localisation;
  show_match_picture(answer);
  text(at("match-facts"), !answer ? "No answer yet"
    : answer.experience === null ? `${answer.validity.toLowerCase().replace("_", " ")}` +
      (answer.reason ? `: ${answer.reason}` : "")
    : `${answer.experience}, frame ${answer.frame}${position_of(answer)}; confidence ` +
      fixed(answer.confidence, 2) + (answer.basis === "PARKED" ? "; parked" : answer.moving ? "" : "; standing"));
}

function bar(share, low, high) {
  const fill = make("i"), track = make("div", "bar", fill);
  fill.style.width = `${100 * Math.min(1, Math.max(0, share))}%`;
  if (is_number(low) && is_number(high)) {
    const whisker = make("b");
    whisker.style.left = `${100 * low}%`;
    whisker.style.width = `${100 * (high - low)}%`;
    track.append(whisker);
  }
  return track;
}

// A button that sends a command; `pressed` is the state of what it switches.
function command_button(label, does, command, pressed) {
  const button = make("button", "", label);
  button.title = does;
  button.disabled = !token;
  button.dataset.key = command;
  if (pressed !== undefined)
    button.setAttribute("aria-pressed", `${pressed}`);
  button.onclick = () => send(command);
  return button;
}

function candidate_buttons(name, {pinned, excluded = []}) {
  const is_pinned = pinned === name, is_excluded = excluded.includes(name);
  const pin = command_button("pin", is_pinned ? `Unpin ${name}` : `Localise in ${name}, whatever the ranking says`,
                             is_pinned ? "pin" : `pin ${name}`, is_pinned);
  const exclude = command_button("exclude", is_excluded ? `Include ${name} again` : `Never choose ${name}`,
                                 `${is_excluded ? "include" : "exclude"} ${name}`, is_excluded);
  pin.dataset.key = `pin ${name}`;
  exclude.dataset.key = `exclude ${name}`;
  return make("td", "actions", pin, exclude);
}

function candidate(entry, farthest, chosen, status) {
  const name = make("th", "", make("span", "swatch"), entry.experience);
  name.scope = "row";
  const distance = make("td", "", (entry.bound ? "≥ " : "") + fixed(entry.distance_bins, 2) + (entry.tied ? " tied" : ""),
                        bar(entry.distance_bins / farthest));
  const {predicted_recall: recall, predicted_low: low, predicted_high: high} = entry;
  const interval = is_number(low) && is_number(high) ? ` (${fixed(100 * low, 0)}–${fixed(100 * high, 0)})` : "";
  const recalled = make("td", "", percent(recall) + interval);
  if (is_number(recall))
    recalled.append(bar(recall, low, high));
  const row = make("tr", ink(entry.experience), name, distance, recalled,
                   candidate_buttons(entry.experience, status ?? {}));
  if (status?.pinned === entry.experience)
    name.append(" pinned");
  if (status?.excluded?.includes(entry.experience))
    name.append(" excluded");
  if (entry.experience === chosen) {
    row.setAttribute("aria-current", "true");
    name.append(" ✓");
  }
  return row;
}

let shown_ranking = "";
const rules = {emd: "distance", transfer: "predicted recall", relative: "predicted recall"};
function show_ranking() {
  const {ranking, status} = state;
  const entries = ranking?.ranking ?? [];
  const {experience, state: is, pinned, excluded, shadow} = status ?? {};
  const showing = JSON.stringify([ranking, experience, is, pinned, excluded, shadow]);
  if (showing === shown_ranking) // a button that is being pressed stays
    return;
  shown_ranking = showing;
  const focused = document.activeElement?.dataset?.key;
  const farthest = Math.max(...entries.map(entry => entry.distance_bins), 1e-9);
  at("ranking").replaceChildren(
    ...entries.map(entry => candidate(entry, farthest, status?.experience || entries[0].experience, status)));
  [...at("ranking").querySelectorAll("button")].find(button => button.dataset.key === focused)?.focus();
  if (!ranking)
    return text(at("margin"), "No ranking heard yet; the daemon sends one after each warmup.");
  const notes = [`Margin ${fixed(ranking.margin_bins, 2)} bins, after ${ranking.window_frames} frames`,
                 `by ${rules[ranking.ranked_by ?? "emd"] ?? ranking.ranked_by}`];
  if (ranking.previous)
    notes.push(`in place of ${ranking.previous}`);
  const predicted = entries.some(entry => is_number(entry.predicted_recall));
  at("candidates").classList.toggle("unpredicted", !predicted);
  text(at("margin"), notes.join(", ") + "; shorter is more alike." +
    (predicted ? "" : ` Recall is not predicted${ranking.no_prediction ? ": " + ranking.no_prediction : ""}.`) +
    (status?.state === "WARMUP" ? " From the last warmup." : "") +
    (shadow ? " In shadow: recommended only, the choice stays." : ""));
}

// A frame of the map, with its picture if the server has it.
function example(experience, frame) {
  if (!is_number(frame) || frame < 0)
    return make("span", "", "–");
  const shown = make("span", "", String(frame));
  if (state.map?.shown) {
    const image = make("img");
    image.alt = "";
    image.hidden = true;
    image.addEventListener("load", () => image.hidden = false);
    image.src = `map/${experience}/${frame}.jpg`;
    shown.append(image);
  }
  return shown;
}

function reason_row(reason, margin, largest, [first, second]) {
  const name = make("th", "", `${reason.tap} ${reason.neuron}`);
  name.scope = "row";
  const share = margin === 0 ? fixed(reason.bins, 3, " bins") : fixed(100 * reason.bins / margin, 1, " %");
  const bins = [reason.live_bin, reason.winner_bin, reason.runner_up_bin].map(bin => fixed(bin, 0)).join(", ");
  return make("tr", reason.bins < 0 ? "against" : "", name,
              make("td", "", share, bar(Math.abs(reason.bins) / largest)), make("td", "", bins),
              make("td", "", example(first, reason.winner_most), ", ", example(first, reason.winner_least)),
              make("td", "", example(second, reason.runner_up_most), ", ", example(second, reason.runner_up_least)));
}

// As the sentence of `vdna explain`.
function why_of(names, margin, reasons, neurons) {
  if (margin === 0)
    return `${names[0]} is as near as ${names[1]}.`;
  const share = reasons.reduce((sum, reason) => sum + reason.bins, 0) / margin;
  return `${names[0]} is ${fixed(Math.abs(margin), 2)} bins ${margin > 0 ? "nearer" : "farther"} than ${names[1]}: ` +
    `${reasons.length} of ${neurons} neurons make ${percent(share)} of it.`;
}

function show_why() {
  const {reasons = [], ranking: entries = [], margin_bins: margin, neurons} = state.ranking ?? {};
  const names = entries.map(entry => entry.experience);
  const largest = Math.max(...reasons.map(reason => Math.abs(reason.bins)), 1e-9);
  at("reasons").replaceChildren(...reasons.map(reason => reason_row(reason, margin, largest, names)));
  text(at("why"), !state.ranking ? "No ranking heard yet."
    : reasons.length === 0 ? "The ranking names no neurons." : why_of(names, margin, reasons, neurons));
}

// --- the strip: x is seconds since its left end

const svg = (name, attributes) => {
  const element = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes))
    element.setAttribute(key, value);
  return element;
};

// A line through the points that have a value, broken where there is none.
function line(points, value, most) {
  let path = "", open = false;
  for (const point of points) {
    const y = value(point);
    if (is_number(y))
      path += `${open ? "L" : "M"}${point.x.toFixed(1)} ${(0.96 - 0.92 * y / most).toFixed(3)}`;
    open = is_number(y);
  }
  return svg("path", {d: path});
}

// A rectangle for each stretch of time with one choice and certainty.
function bands(points) {
  const found = [];
  for (const {x, experience, validity} of points) {
    const style = ink(experience) + (validity === "VALID" ? "" : " weak"), last = found.at(-1);
    if (last?.style === style && x - last.end < 2.5)
      last.end = x;
    else
      found.push({style, begin: Math.max(0, x - 1), end: x});
  }
  return found.map(({style, begin, end}) =>
    svg("rect", {x: begin, width: end - begin, height: 1, class: style}));
}

const spans_s = [60, 120, points_max]; // the shortest that holds all points is shown
function show_strip() {
  if (state.points.length === 0)
    return;
  const newest = state.points.at(-1).utime, age_s = point => (newest - point.utime) / 1e6;
  const span = spans_s.find(seconds => age_s(state.points[0]) <= seconds) ?? points_max;
  const points = state.points.map(point => ({...point, x: span - age_s(point)})).filter(({x}) => x >= 0);
  const chosen = points.filter(point => point.experience);
  const farthest = Math.max(1, ...chosen.map(point => point.frame));
  const draw_lane = (name, ...marks) => {
    at(name).setAttribute("viewBox", `0 0 ${span} 1`);
    at(name).replaceChildren(...marks);
  };
  draw_lane("lane-choice", ...bands(chosen));
  draw_lane("lane-confidence", line(points, point => point.confidence, 1));
  draw_lane("lane-frame", line(points, point => point.frame, farthest));
  text(at("route-range"), `frame 0 to ${farthest}`);
  text(at("span"), `${span / 60} min ago`);

  const names = [...new Set(chosen.map(point => point.experience))];
  at("legend").replaceChildren(...names.map(
    name => make("span", ink(name), make("i", "swatch"), name)), names.length ? "" : "\u00a0");
  const last = chosen.at(-1);
  at("strip").setAttribute("aria-label", !last ? "No answers yet"
    : `Chosen: ${names.join(", ")}. Newest: ${last.experience}, frame ${last.frame}, confidence ` +
      fixed(last.confidence, 2));
}

// --- the daemon's health

function problems_of({status, problems, pulse, picture, headline}) {
  const found = [];
  const add = (sentence, style = "") => sentence && found.push(make("li", style, sentence));
  if (pulse?.camera_age_s === null || pulse?.camera_age_s > 3)
    add(pulse.camera_age_s === null ? "No camera heard on its channel."
      : `No camera frame for ${fixed(pulse.camera_age_s, 0)} s.`, "bad");
  add(status?.reason, headline?.tone === "bad" ? "bad" : "");
  for (const problem of problems ?? [])
    add(problem);
  add(picture?.problem && `The page cannot show a picture: ${picture.problem}`);
  add(pulse?.left_out && `A message was left out: ${pulse.left_out}`);
  if (pulse?.camera_oversized > 0)
    add(`Pictures too large for this page: ${pulse.camera_oversized}`);
  return found.length ? found : [make("li", "none", "None known.")];
}

function show_health() {
  const {status, pulse} = state;
  at("problems").replaceChildren(...problems_of(state));
  if (!status)
    return;
  const known = value => value === undefined || value === "" ? "–" : `${value}`;
  const facts = {
    "Camera": `${fixed(pulse?.camera_hz, 1)} frames/s`,
    "Frames used": `${known(status.processed)} of ${known(status.received)}`,
    "Memory": `${mib(status.resident_bytes)}, most ${mib(status.resident_bytes_max)}`,
    "Map": `${known(status.experiences)} experiences, ${known(status.map_hash?.slice(0, 8))}`,
    "Network": known(status.backbone),
    "Daemon": known(status.version),
    "Viewers": known(pulse?.viewers),
  };
  at("facts").replaceChildren(...Object.entries(facts).flatMap(
    ([name, value]) => [make("dt", "", name), make("dd", "", value)]));
  const stages = Object.entries(status).filter(([, value]) => is_number(value?.p99_us));
  at("stages").replaceChildren(...stages.map(([name, time]) => {
    const head = make("th", "", name);
    head.scope = "row";
    return make("tr", "", head, ...[time.newest_us, time.p50_us, time.p99_us, time.max_us].map(
      value => make("td", "", fixed(value / 1000, 1))));
  }));
}

function show_raw() {
  const {status, ranking, localisation} = state;
  if (at("raw").open)
    text(at("fields"), JSON.stringify({status, localisation, ranking}, null, 2));
}

// --- commands: only with the token that was printed, which the address carries behind its #

if (location.hash.length > 1) {
  sessionStorage.setItem("token", location.hash.slice(1));
  history.replaceState(null, "", location.pathname);
}
const token = sessionStorage.getItem("token");

async function send(name) {
  text(at("sent"), `${name} …`);
  const failed = () => ({ok: false, text: () => "the server is gone"});
  const answer = await fetch("command", {method: "POST", body: name, headers: {"X-Vdna-Token": token}})
    .catch(failed);
  text(at("sent"), answer.ok ? `${name} sent` : `${name}: ${(await answer.text()).trim()}`);
}

// Those for one experience are beside it.
function show_commands() {
  const {shadow} = state.status ?? {};
  const button = at("commands").querySelector("[aria-pressed]");
  if (button)
    button.setAttribute("aria-pressed", `${shadow === true}`);
  if (at("commands").childElementCount > 0)
    return;
  for (const {name, does, argument} of state.commands ?? [])
    if (argument === "none")
      at("commands").append(command_button(name, does, name));
    else if (argument === "on or off") {
      const toggle = command_button(name, does, name, shadow === true);
      toggle.onclick = () => send(`${name} ${toggle.ariaPressed === "true" ? "off" : "on"}`);
      at("commands").append(toggle);
    }
  if (!token)
    text(at("sent"), "To use it, open the address that vdna serve printed, token included.");
}

// What the daemon made of the newest command, whoever sent it.
function show_result() {
  const {command, accepted, text: sentence} = state.result ?? {};
  if (token && command)
    text(at("sent"), `${command}${accepted ? "" : " refused"}: ${sentence}`);
}

// --- events in, one drawing for all that came since the last one

const parts = [[show_headline, "headline", "status", "pulse"], [show_live, "picture", "pulse"],
               [show_match, "localisation", "map"], [show_ranking, "ranking", "status"],
               [show_why, "ranking", "map"], [show_strip, "point"],
               [show_health, "status", "problems", "pulse", "picture"], [show_commands, "commands", "status"],
               [show_result, "result"],
               [show_raw, "status", "localisation", "ranking"]];
const fresh = new Set(); // kinds of events since the last drawing
let heard_ms = 0, source = null;

function draw() {
  for (const [show, ...kinds] of parts)
    if (kinds.some(kind => fresh.has(kind)))
      show();
  fresh.clear();
}

function take(kind, data) {
  heard_ms = performance.now();
  text(at("link"), "live");
  at("link").classList.add("up");
  take_as(kind, data);
}

function take_as(kind, data) {
  if (kind === "point")
    state.points = [...state.points.slice(1 - points_max), data];
  else
    state[kind] = data;
  if (fresh.size === 0)
    requestAnimationFrame(draw);
  fresh.add(kind);
}

function connect() {
  source?.close();
  source = new EventSource("events");
  source.addEventListener("open", () => state.points = []); // the server sends all it has
  for (const kind of ["result", "commands", "headline", "localisation", "map", "picture", "point", "problems", "pulse", "ranking",
                      "status"])
    source.addEventListener(kind, event => take(kind, JSON.parse(event.data)));
}

// The browser itself reconnects after a broken stream, but not after a refusal or a silent link.
setInterval(() => {
  const is_gone = source.readyState !== EventSource.OPEN || performance.now() - heard_ms > alive_ms;
  if (!is_gone)
    return;
  text(at("link"), "reconnecting …");
  at("link").classList.remove("up");
  take_as("headline", {tone: "bad", name: "GONE", text: "vdna serve does not answer: below is what it said last."});
  if (source.readyState !== EventSource.CONNECTING)
    connect();
}, 2000);

at("live").addEventListener("load", () => { at("live").hidden = false; at("live").dataset.loading = ""; });
at("live").addEventListener("error", () => { at("live").hidden = true; at("live").dataset.loading = ""; });
at("match").addEventListener("load", () => { at("match").hidden = false; at("match").dataset.loading = ""; show_match(); });
at("match").addEventListener("error", () => {
  at("match").hidden = true;
  at("match").dataset.loading = "";
  text(at("no-match"), "No thumbnail of this frame");
});
at("raw").addEventListener("toggle", show_raw);
connect();
