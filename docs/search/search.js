// Ranks the sections of all pages (sections.js) for the words of the address and shows excerpts.
"use strict";

// Words that engineers use for the same thing. A query with one of them finds the others too.
const EQUIVALENTS = [
  ["idr", "interstorey drift", "interstory drift", "storey drift", "story drift", "drift ratio"],
  ["pfa", "peak floor acceleration", "floor acceleration"],
  ["pga", "peak ground acceleration", "peak acceleration"],
  ["sa", "spectral acceleration", "pseudo acceleration"],
  ["ida", "incremental dynamic analysis"],
  ["fragility", "probability of exceedance", "vulnerability"],
  ["tendon", "cable", "strand", "prestress", "prestressing", "post tension", "pt bar"],
  ["uplift", "lift off", "gap opening"],
  ["restitution", "coefficient of restitution", "impact rule"],
  ["overturn", "topple", "tip over"],
  ["checks", "limits", "acceptance criteria", "utilisation", "utilization", "demand capacity ratio", "dcr"],
  ["pushover", "static curve", "capacity curve", "capacity spectrum", "backbone", "nonlinear static"],
  ["toe", "contact length", "edge pressure", "neutral axis", "compression zone", "crushing"],
  ["ufp", "u shaped flexural plate", "steel damper"],
  ["storey", "story"],
  ["storeys", "stories", "floors"],
  ["self centring", "self centering", "recentre", "recenter"],
  ["ground motion", "accelerogram", "record", "earthquake"],
  ["lose", "lost", "loss"],
  ["compare", "comparison", "beside"],
  ["slide", "sliding", "slip", "friction"],
  ["unit", "units", "cm s2", "m s2"],
  ["export", "csv", "excel", "spreadsheet"],
  ["time history", "response history", "nltha"],
  ["animation", "film", "animate", "moving picture"],
  ["opensees", "openseespy"],
  ["fmu", "fmi", "functional mock up unit", "co simulation", "cosimulation", "modelica", "simulink"],
  ["coupling", "co simulation", "cosimulation", "hybrid simulation", "substructure"],
  ["time loop", "time step", "stepping", "step by step"],
  ["cluster", "slurm", "mpi", "hpc"],
];
const STOPS = new Set(("a all an and are as at be between by can do does each every for from get give has have how i "
  + "if in is it its me much many my of on one or see show should some than that the their there this to use "
  + "want was we what when where which who why will with you your").split(" "));
// Pages for users before those for developers
const FOLDERS = { tutorials: 1.3, howto: 1.3, developer: 0.5 };
const SHOWN = 30;
const EXCERPT = 240;

const plain = (text) => text.normalize("NFKD").toLowerCase().replace(/[^\p{L}\p{N}]+/gu, " ");

// A pattern for a word or phrase in plain text; longer words match their endings too.
const pattern = (phrase) => phrase.split(" ").map((word) => {
  const stem = word.length > 4 ? word.replace(/(ies|ing|ed|es|s|y|e)$/, "") : word;
  return stem.length > 3 ? stem + "\\p{L}*" : stem + "s?";
}).join(" ");

const finder = (phrases) =>
  new RegExp("(?<![\\p{L}\\p{N}])(?:" + phrases.map(pattern).join("|") + ")(?![\\p{L}\\p{N}])", "gu");

// The terms of a query: each is the word itself and its equivalents.
function termsOf(query) {
  let rest = ` ${plain(query).trim()} `;
  const terms = [];
  const phrases = EQUIVALENTS.flatMap((group) => group.map((phrase) => [phrase, group]));
  phrases.sort((one, other) => other[0].length - one[0].length);
  for (const [phrase, group] of phrases) {
    const found = rest.match(finder([phrase]));
    if (!found) continue;
    rest = rest.replace(finder([phrase]), " ");
    const others = group.filter((other) => other !== phrase);
    terms.push({ own: finder([phrase]), any: finder([phrase, ...others]) });
  }
  for (const word of rest.split(" ")) {
    if (word && !STOPS.has(word) && !/^\d+$/.test(word))
      terms.push({ own: finder([word]), any: finder([word]) });
  }
  return terms;
}

const count = (text, expression) => (text.match(expression) || []).length;

function rank(terms) {
  const sections = SECTIONS.map(([page, heading, address, text]) => ({
    page, heading, address, text,
    words: [plain(page), plain(heading), plain(text)],
    score: 0, met: 0,
  }));
  for (const term of terms) {
    const hits = sections.map((section) => {
      const [page, heading, text] = section.words;
      const value = (expression) => (count(page, expression) ? 3 : 0) + (count(heading, expression) ? 6 : 0)
        + 2 * Math.log1p(count(text, expression)) / (1 + text.length / 8000);
      return Math.max(value(term.own), 0.6 * value(term.any));
    });
    const weight = Math.log1p(sections.length / (1 + hits.filter((hit) => hit > 0).length));
    hits.forEach((hit, i) => {
      sections[i].score += weight * hit;
      sections[i].met += hit > 0;
    });
  }
  // sections with all terms first; a section that misses one may still follow
  const found = sections.filter((section) => section.met > 0 && 2 * section.met >= terms.length);
  for (const section of found) {
    section.score *= (section.met / terms.length) ** 3 * (FOLDERS[section.address.split("/")[0]] || 1);
  }
  return found.sort((one, other) => other.score - one.score).slice(0, SHOWN);
}

// Expressions for text as it is printed: anything but letters may separate the words of a phrase.
const printed = (terms) => new RegExp(terms.map((term) => term.any.source.replace(/ /g, "[^\\p{L}]+")).join("|"), "giu");

function excerpt(text, expression) {
  const places = [...text.matchAll(expression)].map((match) => match.index);
  let first = 0, most = 0;
  for (const place of places) {
    const near = places.filter((other) => other >= place && other < place + EXCERPT).length;
    if (near > most) [first, most] = [place, near];
  }
  let start = Math.max(0, first - EXCERPT / 4);
  if (start) start = text.indexOf(" ", start) + 1;
  const shown = text.slice(start, start + EXCERPT);
  const line = document.createElement("p");
  line.append(start ? "... " : "");
  let last = 0;
  for (const match of shown.matchAll(expression)) {
    const mark = document.createElement("mark");
    mark.textContent = match[0];
    line.append(shown.slice(last, match.index), mark);
    last = match.index + match[0].length;
  }
  line.append(shown.slice(last), start + EXCERPT < text.length ? " ..." : "");
  return line;
}

function show(query) {
  const target = document.getElementById("search-results");
  const terms = termsOf(query);
  const found = terms.length ? rank(terms) : [];
  const summary = document.createElement("p");
  summary.className = "search-summary";
  summary.textContent = found.length ? `Best ${found.length} sections for "${query}":`
    : query ? `Nothing found for "${query}". Try one word of it, or the glossary.` : "Type the words to find.";
  const list = document.createElement("ul");
  list.className = "search";
  const expression = terms.length ? printed(terms) : null;
  for (const section of found) {
    const item = document.createElement("li");
    const link = document.createElement("a");
    link.href = section.address;
    link.textContent = section.heading === section.page ? section.page : `${section.page}: ${section.heading}`;
    item.append(link, excerpt(section.text, expression));
    list.append(item);
  }
  target.replaceChildren(summary, list);
}

const query = new URLSearchParams(window.location.search).get("q") || "";
for (const field of document.querySelectorAll("input[name=q]")) field.value = query;
show(query);
