// Plugin of Open MCT 4: telemetry, equipment, versions and decisions of reident, from the API of
// reident-web. README.md says how to serve the two as one origin.
//
//   import reident from "./openmct-reident.js";
//   openmct.install(reident({ url: "/reident" }));
//
// Objects, by the key of their identifier; parts are encoded, since Open MCT takes / and % apart:
//   root~SPACECRAFT~telemetry~PARAMETER      plots and tables, with limits
//   root~SPACECRAFT~EQUIPMENT                its versions
//   root~SPACECRAFT~EQUIPMENT~error          the champion's error, on telemetry that it was not fitted to
//   root~SPACECRAFT~EQUIPMENT~decisions      what was decided, where telemetry was then

const namespace = "reident";
const silentMs = 5000;  // heartbeats come each second
const slowMs = 10_000;  // between two looks for what no event tells
const sharedMs = 1000;  // that an answer for all parameters serves
const usualBins = 500;

const encoded = (part) => encodeURIComponent(part).replace(/~/g, "%7E").replace(/%/g, "$");
const decoded = (part) => decodeURIComponent(part.replace(/\$/g, "%"));
const keyOf = (...parts) => ["root", ...parts.map(encoded)].join("~");
const identifierOf = (...parts) => ({ namespace, key: keyOf(...parts) });
const partsOf = (identifier) => identifier.key.split("~").slice(1).map(decoded);
const isoOf = (ms) => new Date(ms).toISOString();
/** Milliseconds of a text of UTC, which has nanoseconds. */
const msOf = (text) => Date.parse(text.replace(/(\.\d{3})\d*Z$/, "$1Z"));

const time = { key: "utc", name: "Time", source: "utc", format: "utc", hints: { domain: 1 } };
const rangeOf = (unit) => ({ key: "value", name: "Value", unit, format: "float", hints: { range: 1 } });
const texts = [["kind", "Decision"], ["version", "Version"], ["actor", "By"], ["reason", "Reason"], ["decided", "Decided at"]]
  .map(([key, name]) => ({ key, name, format: "string" }));

class Api {
  constructor(url) {
    this.url = url;
    this.listeners = new Set();
    this.source = null;
    this.heard = 0;  // when the last heartbeat came [ms]
    this.known = null;  // the answer of series()
  }

  async ask(view, parameters, signal) {
    const query = new URLSearchParams(Object.entries(parameters).filter(([, value]) => value !== undefined));
    const answer = await fetch(`${this.url}/api/v1/${view}?${query}`, { signal });
    const body = await answer.json();
    if (!answer.ok) throw new Error(body.error?.message ?? answer.statusText);
    return body;
  }

  /** What telemetry there is. Who asks within a moment shares an answer: a folder asks for each of its parameters. */
  series() {
    const forget = () => setTimeout(() => { this.known = null; }, sharedMs);
    this.known ??= this.ask("series", {}).finally(forget);
    return this.known;
  }

  /** The newest sample of a parameter, with its unit and limits. */
  async last(spacecraft, parameter, signal) {
    const { series } = await this.series();
    const known = series.find((one) => one.spacecraft === spacecraft && one.parameter === parameter && one.origin === "real");
    return this.ask("telemetry", { spacecraft, parameter, begin: known?.last, bins: 1 }, signal);
  }

  /** Calls `listener(event, data)` for each change until the function that it returns is called. */
  listen(listener) {
    this.listeners.add(listener);
    if (!this.source) {
      this.source = new EventSource(`${this.url}/api/v1/stream`);
      for (const event of ["service", "registry"])
        this.source.addEventListener(event, ({ data }) => {
          const news = JSON.parse(data);
          if (event === "service") this.heard = Date.now() - 1000 * news.age_s;
          for (const one of this.listeners) one(event, news);
        });
    }
    return () => {
      this.listeners.delete(listener);
      if (this.listeners.size > 0) return;
      this.source.close();
      this.source = null;
    };
  }
}

/** Extremes at the times at which they were, ascending. */
function pointsOf(answer) {
  const begin = msOf(answer.range.begin), points = [];
  const push = (seconds, value) => {
    const utc = begin + 1000 * seconds;
    if (value !== null && !(points.length > 0 && utc <= points[points.length - 1].utc)) points.push({ utc, value });
  };
  answer.least.forEach((least, i) => {
    const ends = [[answer.least_s[i], least], [answer.greatest_s[i], answer.greatest[i]]].sort((a, b) => a[0] - b[0]);
    for (const [seconds, value] of ends) push(seconds, value);
  });
  return points;
}

/** What each kind of telemetry object answers for a range of milliseconds. */
class Telemetry {
  constructor(api) {
    this.api = api;
  }

  async parameter([spacecraft, , parameter], { begin, end, bins, signal }) {
    return pointsOf(await this.api.ask("telemetry", { spacecraft, parameter, begin, end, bins }, signal));
  }

  async newest([spacecraft, , parameter], signal) {
    return pointsOf(await this.api.last(spacecraft, parameter, signal));
  }

  async error([spacecraft, equipment], { begin, end, bins, signal }) {
    const timeline = await this.api.ask("timeline", { spacecraft, equipment, begin, end, bins }, signal);
    const origin = msOf(timeline.range.begin);
    return timeline.records.flatMap((record) => record.to_s.map((to, i) => ({ utc: origin + 1000 * to, value: record.error_percent[i] })))
      .filter((point) => point.value !== null).sort((a, b) => a.utc - b.utc);
  }

  async decisions([spacecraft, equipment], { begin, end, signal }) {
    const { decisions } = await this.api.ask("equipment", { spacecraft, equipment, versions: 1 }, signal);
    return decisions.map(({ telemetry, time: decided, kind, version, actor, reason }) => ({ utc: msOf(telemetry), kind, version, actor, reason, decided }))
      .filter(({ utc }) => (begin === undefined || utc >= Date.parse(begin)) && utc < Date.parse(end)).sort((a, b) => a.utc - b.utc);
  }

  kindOf(domainObject) {
    return { "reident.parameter": "parameter", "reident.error": "error", "reident.decisions": "decisions" }[domainObject.type];
  }

  async request(domainObject, { start, end, strategy, size, signal }) {
    const kind = this.kindOf(domainObject), parts = partsOf(domainObject.identifier);
    if (strategy === "latest" && kind === "parameter") return this.newest(parts, signal);
    // Two points a bin. An end that is a moment ago has what came until now.
    const bins = Math.min(4000, Math.max(1, Math.ceil((size ?? 2 * usualBins) / 2)));
    const points = await this[kind](parts, { begin: isoOf(start), end: isoOf(Math.max(end, start + 1)), bins, signal });
    return strategy === "latest" ? points.slice(-1) : points;
  }

  /** Gives what is new with each change, until the function that it returns is called. */
  subscribe(domainObject, callback, isBatch) {
    const kind = this.kindOf(domainObject), parts = partsOf(domainObject.identifier);
    const placeOf = (point) => point.decided ?? point.utc;  // of two decisions at one time of telemetry
    let newest = null, since = null, last = null, asked = 0, asking = false, again = false;
    // What is decided now may stand where telemetry was long ago.
    const begins = { parameter: () => isoOf(last), error: () => isoOf(since) };
    const look = async () => {
      if (asking) again = true;
      if (asking || newest === null || (kind === "parameter" && last !== null && newest <= last)) return;
      asking = true;
      since ??= newest;
      asked = Date.now();
      try {
        const points = kind === "parameter" && last === null ? await this.newest(parts)
          : await this[kind](parts, { begin: begins[kind]?.(), end: isoOf(newest + 1), bins: usualBins });
        const fresh = points.filter((point) => last === null || placeOf(point) > last);
        const isHistory = last === null && kind !== "parameter";  // which a request has given
        last = [...points.map(placeOf), last ?? (kind === "decisions" ? "" : 0)].reduce((a, b) => (a > b ? a : b));
        if (!isHistory && isBatch && fresh.length > 0) callback(fresh);
        if (!isHistory && !isBatch) fresh.forEach((point) => callback(point));
      } catch {
        // The next change asks again.
      }
      asking = false;
      if (again) setTimeout(look);
      again = false;
    };
    return this.api.listen((event, data) => {
      if (event === "service") newest = data.newest_telemetry === null ? null : msOf(data.newest_telemetry);
      const isOfIt = event === "service" ? kind === "parameter" || Date.now() - asked > slowMs
        : kind !== "parameter" && data.spacecraft === parts[0] && data.equipment === parts[1];
      if (isOfIt) look();
    });
  }
}

function objectsOf(api) {
  const folder = (identifier, name, location) => ({ identifier, name, location, type: "folder" });
  const telemetry = (type, identifier, name, values, location) => ({ identifier, name, type, location, telemetry: { values: [time, ...values] } });
  const place = (...parts) => `${namespace}:${keyOf(...parts)}`;
  return {
    async get(identifier) {
      const [spacecraft, second, third] = partsOf(identifier);
      if (spacecraft === undefined) return folder(identifier, "reident", "ROOT");
      if (second === undefined) return folder(identifier, spacecraft, place());
      if (second === "telemetry" && third === undefined) return folder(identifier, "telemetry", place(spacecraft));
      if (second === "telemetry") {
        const { unit } = await api.last(spacecraft, third).catch(() => ({ unit: "" }));
        return telemetry("reident.parameter", identifier, third, [rangeOf(unit)], place(spacecraft, second));
      }
      if (third === "error") return telemetry("reident.error", identifier, `${second}: error of the champion`, [rangeOf("%")], place(spacecraft, second));
      if (third === "decisions") return telemetry("reident.decisions", identifier, `${second}: decisions`, texts, place(spacecraft, second));
      return { identifier, name: second, type: "reident.equipment", location: place(spacecraft) };
    },
  };
}

function compositionOf(api) {
  return {
    appliesTo: ({ identifier, type }) => identifier.namespace === namespace && (type === "folder" || type === "reident.equipment"),
    async load({ identifier }) {
      const [spacecraft, second] = partsOf(identifier);
      if (second === "telemetry") {
        const { series } = await api.series();
        return series.filter((one) => one.spacecraft === spacecraft && one.origin === "real").map((one) => identifierOf(spacecraft, second, one.parameter));
      }
      if (second !== undefined) {
        const { outputs, parameters } = await api.ask("equipment", { spacecraft, equipment: second });
        return [identifierOf(spacecraft, second, "error"), identifierOf(spacecraft, second, "decisions"),
                ...[...outputs.map(({ name }) => name), ...parameters].map((name) => identifierOf(spacecraft, "telemetry", name))];
      }
      const [{ series }, { equipment }] = await Promise.all([api.series(), api.ask("overview", {})]);
      if (spacecraft === undefined) return [...new Set([...series, ...equipment].map((one) => one.spacecraft))].sort().map((name) => identifierOf(name));
      return [...equipment.filter((one) => one.spacecraft === spacecraft && one.attempts > 0).map((one) => identifierOf(spacecraft, one.equipment)),
              identifierOf(spacecraft, "telemetry")];
    },
  };
}

/** The versions of an equipment as a table, kept current. */
function versionsView(api) {
  return {
    key: "reident.versions",
    name: "Versions",
    cssClass: "icon-tabular",
    canView: ({ type }) => type === "reident.equipment",
    view({ identifier }) {
      const [spacecraft, equipment] = partsOf(identifier);
      let stop = () => {};
      return {
        show(element) {
          const draw = async () => {
            const { versions, line } = await api.ask("equipment", { spacecraft, equipment });
            const table = document.createElement("table");
            table.className = "c-table__body";
            const row = (cell, words) => {
              const tr = table.insertRow();
              for (const word of words) tr.append(Object.assign(document.createElement(cell), { textContent: word ?? "–", align: "left" }));
              return tr;
            };
            row("th", ["version", "status", "error %", "fit %", "order", "window ends (UTC)"]);
            for (const one of [...versions].reverse()) {
              const tr = row("td", [one.version, one.version === line.champion ? "champion" : one.status, one.error_percent?.toPrecision(3),
                                    one.fit_percent?.toPrecision(3), one.order, one.window.end.slice(0, 19)]);
              tr.dataset.version = one.version;
            }
            element.replaceChildren(table);
          };
          const tell = (error) => { element.textContent = String(error.message ?? error); };
          draw().catch(tell);
          stop = api.listen((event, data) => {
            if (event === "registry" && data.spacecraft === spacecraft && data.equipment === equipment) draw().catch(tell);
          });
        },
        destroy: () => stop(),
      };
    },
    priority: () => 100,
  };
}

/** `url`: where reident-web is, on the origin of Open MCT. */
export default function reident({ url = "" } = {}) {
  return function install(openmct) {
    const api = new Api(url);
    const telemetry = new Telemetry(api);
    const isParameter = ({ type }) => type === "reident.parameter";
    const has = (domainObject) => telemetry.kindOf(domainObject) !== undefined;
    for (const [type, name, cssClass] of [["equipment", "Equipment", "icon-object"], ["parameter", "Parameter", "icon-telemetry"],
                                          ["error", "Error of the champion", "icon-telemetry"], ["decisions", "Decisions", "icon-tabular"]])
      openmct.types.addType(`reident.${type}`, { name: `${name} (reident)`, description: name, creatable: false, cssClass });
    openmct.objects.addRoot(identifierOf());
    openmct.objects.addProvider(namespace, objectsOf(api));
    openmct.composition.addProvider(compositionOf(api));
    openmct.objectViews.addProvider(versionsView(api));
    const limitsOf = ({ identifier }) => api.last(partsOf(identifier)[0], partsOf(identifier)[2]);
    openmct.telemetry.addProvider({
      supportsRequest: has,
      request: (domainObject, options) => telemetry.request(domainObject, options),
      supportsSubscribe: has,
      supportsBatching: has,
      subscribe: (domainObject, callback, options) => telemetry.subscribe(domainObject, callback, options?.strategy === "batch"),
      supportsLimits: isParameter,
      getLimitEvaluator(domainObject) {
        let limits = null;
        limitsOf(domainObject).then((answer) => { limits = answer; }, () => {});
        return {
          evaluate({ value }) {
            const low = limits?.low_limit ?? -Infinity, high = limits?.high_limit ?? Infinity;
            if (value < low) return { cssClass: "is-limit--lwr is-limit--red", low: -Infinity, high: low, name: "below its limit" };
            if (value > high) return { cssClass: "is-limit--upr is-limit--red", low: high, high: Infinity, name: "above its limit" };
            return undefined;
          },
        };
      },
      getLimits: (domainObject) => ({
        async limits() {
          const { low_limit: low, high_limit: high } = await limitsOf(domainObject);
          const side = (value) => (value === null ? undefined : { color: "red", value });
          return { CRITICAL: { low: side(low), high: side(high) } };
        },
      }),
      supportsStaleness: isParameter,
      isStale: async () => ({ isStale: Date.now() - api.heard > silentMs, timestamp: api.heard }),
      subscribeToStaleness(domainObject, callback) {
        let known;
        const look = () => {
          const isStale = Date.now() - api.heard > silentMs;
          if (isStale !== known) callback({ isStale, timestamp: api.heard });
          known = isStale;
        };
        const stop = api.listen(look);
        const timer = setInterval(look, 1000);
        return () => {
          clearInterval(timer);
          stop();
        };
      },
    });
  };
}
