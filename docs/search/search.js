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
  ["install", "installation", "setup", "set up"],
  ["cite", "citation", "bibtex", "doi", "reference manager"],
  ["windows", "wsl"],
  ["conda", "conda forge", "mamba", "anaconda"],
  ["api", "public names", "python interface", "fortran interface", "c interface"],
  ["docker", "podman", "container"],
  ["fmu", "fmi", "functional mock up unit", "co simulation", "cosimulation", "modelica", "simulink"],
  ["coupling", "co simulation", "cosimulation", "hybrid simulation", "substructure"],
  ["time loop", "time step", "stepping", "step by step"],
  ["cluster", "slurm", "mpi", "hpc"],
  ["design", "optimise", "optimize", "optimisation", "optimization", "optimum"],
];
const STOPS = new Set(("a all an and are as at be between by can could do does each every find for from get give go going has have how i "
  + "if in into is it its me much many my need of on one or see show should some tell than that the their there this to use "
  + "want was we what when where which who why will with you your").split(" "));
// A section without the unit of a query answers it all the same.
const UNITS = new Set("kn knm n nm pa kpa mpa gpa mm cm m s kg t rad deg percent".split(" "));
// Pages for users before those that prove or that are for developers
const FOLDERS = { tutorials: 1.3, howto: 1.3, validation: 0.7, developer: 0.25 };
// Questions that the glossary answers first
const MEANING = /^\s*(what (is|are|does)|define|definition|meaning)\b/i;
// Points of a term beside another one in a passage, and of one that fills a cell of a table
const TOGETHER = 2, CELL = 4;
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
    // words of one group are one term
    const known = terms.find((term) => term.group === group);
    if (known) known.phrases.push(phrase);
    else terms.push({ group, phrases: [phrase], any: finder(group) });
  }
  for (const term of terms) term.own = finder(term.phrases);
  for (const word of rest.split(" ")) {
    if (word && !STOPS.has(word) && !/^\d+$/.test(word))
      terms.push({ own: finder([word]), any: finder([word]), isUnit: UNITS.has(word) });
  }
  return terms;
}

const count = (text, expression) => (text.match(expression) || []).length;

// Sections with their plain words; a passage is a paragraph or a row of a table, a list of its cells.
let prepared = null;
function prepare() {
  prepared = prepared || SECTIONS.map(([page, heading, address, text]) => ({
    page, heading, address, text,
    words: [plain(page), plain(heading), plain(text)],
    passages: text.split("\n").map((line) => line.split("\t").map((cell) => plain(cell).trim())),
  }));
  return prepared;
}

// The part of a text that an expression matches, by letters.
function share(text, expression) {
  const matched = (text.match(expression) || []).reduce((sum, match) => sum + match.length, 0);
  return matched / Math.max(text.trim().length, 1);
}

// The weight of the terms in a title or cell, and the part of its letters that they fill.
function match(text, terms) {
  let weight = 0, part = 0;
  for (const term of terms) {
    const own = share(text, term.own), other = own ? 0 : 0.6 * share(text, term.any);
    part += own + other;
    weight += term.weight * (own ? 1 : other ? 0.6 : 0);
  }
  return [weight, Math.min(1, part)];
}

function rank(terms, isMeaning) {
  const sections = prepare().map((section) => ({ ...section, score: 0, met: 0 }));
  const needed = terms.filter((term) => !term.isUnit).length || terms.length;
  for (const term of terms) {
    const hits = sections.map((section) => {
      const text = section.words.join(" ");
      const value = (expression) => 2 * Math.log1p(count(text, expression)) / (1 + text.length / 8000);
      return Math.max(value(term.own), 0.6 * value(term.any));
    });
    term.weight = Math.log1p(sections.length / (1 + hits.filter((hit) => hit > 0).length));
    hits.forEach((hit, i) => {
      sections[i].score += term.weight * hit;
      sections[i].met += hit > 0 && !(term.isUnit && needed < terms.length);
    });
  }
  // sections with all terms first; a section that misses one may still follow
  const found = sections.filter((section) => section.score > 0 && 2 * section.met >= needed);
  for (const section of found) {
    section.score += title(section.words[0], 3, terms) + title(section.words[1], 6, terms) + passage(section, terms);
    section.score *= (section.met / needed) ** 3 * (FOLDERS[section.address.split("/")[0]] || 1);
    if (isMeaning && section.address.startsWith("reference/glossary")) section.score *= 2;
  }
  return spread(found).slice(0, SHOWN);
}

// Sort by score; from the third section of a page on, a section counts half.
function spread(found) {
  const byScore = (one, other) => other.score - one.score;
  const shown = {};
  for (const section of found.sort(byScore)) {
    const page = section.address.split("#")[0];
    shown[page] = (shown[page] || 0) + 1;
    if (shown[page] > 2) section.score /= 2;
  }
  return found.sort(byScore);
}

// Points of a title; one that says little else gets twice as many.
function title(text, points, terms) {
  const [weight, part] = match(text, terms);
  return points * weight * Math.min(1, 0.5 + part);
}

// Points of the best passage: for terms that occur together, and for a cell that holds little else.
function passage(section, terms) {
  let most = 0;
  for (const cells of section.passages) {
    const line = cells.join(" ");
    const met = terms.filter((term) => line.search(term.any) >= 0);
    if (!met.length) continue;
    const weights = met.map((term) => term.weight);
    let points = TOGETHER * (weights.reduce((sum, weight) => sum + weight, 0) - Math.max(...weights));
    if (cells.length > 1) {
      points += CELL * Math.max(...cells.map((cell) => match(cell, met)).map(([weight, part]) => weight * part));
    }
    most = Math.max(most, points);
  }
  return most;
}

// Expressions for text as it is printed: anything but letters may separate the words of a phrase.
const printed = (terms) => new RegExp(terms.map((term) => term.any.source.replace(/ /g, "[^\\p{L}]+")).join("|"), "giu");

// The paragraph or row with most of the terms, its cells apart, around the densest matches.
function excerpt(text, expression) {
  // different terms first, then their number
  const found = (line) => {
    const matches = (line.match(expression) || []).map((match) => match.toLowerCase());
    return new Set(matches).size + 0.001 * Math.min(matches.length, 99);
  };
  const lines = text.split("\n");
  const best = lines.reduce((one, other) => (found(other) > found(one) ? other : one));
  const row = best.split("\t").filter(Boolean).join(" · ");
  const places = [...row.matchAll(expression)].map((match) => match.index);
  const near = (place) => places.filter((other) => other >= place && other < place + EXCERPT).length;
  const first = places.reduce((one, other) => (near(other) > near(one) ? other : one), places[0] || 0);
  let start = Math.max(0, first - EXCERPT / 4);
  if (start) start = row.indexOf(" ", start) + 1;
  const shown = row.slice(start, start + EXCERPT);
  const paragraph = document.createElement("p");
  paragraph.append(start ? "... " : "");
  let last = 0;
  for (const match of shown.matchAll(expression)) {
    const mark = document.createElement("mark");
    mark.textContent = match[0];
    paragraph.append(shown.slice(last, match.index), mark);
    last = match.index + match[0].length;
  }
  paragraph.append(shown.slice(last), start + EXCERPT < row.length ? " ..." : "");
  return paragraph;
}

function show(query) {
  const target = document.getElementById("search-results");
  const terms = termsOf(query);
  const found = terms.length ? rank(terms, MEANING.test(query)) : [];
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
