// Numbers and units as the page shows them, and elements.

// About four digits; a number far from one has a power of ten.
export function short(value, digits = 4) {
  if (value === null || !Number.isFinite(value)) return "–";
  if (value === 0) return "0";
  const size = Math.abs(value);
  if (size >= 1e6 || size < 1e-4) {
    const [mantissa, power] = value.toExponential(digits - 1).split("e");
    return `${Number(mantissa)}e${Number(power)}`;
  }
  return String(Number(value.toPrecision(digits)));
}

// Units of forces and stresses on the page: factor and name.
const SCALED = { N: [1e3, "kN"], "N m": [1e3, "kN m"], "N/m": [1e3, "kN/m"],
  "N s/m": [1e3, "kN s/m"], "N m2": [1e3, "kN m²"], Pa: [1e6, "MPa"] };
const UNIT = { "1": "", "-": "", "m/s2": "m/s²", "1/s2": "1/s²", "rad/s2": "rad/s²", m2: "m²",
  "kg/m3": "kg/m³", "m3/s2": "m³/s²" };

export const unit = (text) => SCALED[text]?.[1] ?? UNIT[text] ?? text;

const factor = (text) => SCALED[text]?.[0] ?? 1;
// powers of ten leave a last digit that is no digit of the number
const clean = (x, by) => (by === 1 ? x : Number(x.toPrecision(15)));

// A value in SI units in the unit of the page, and back.
export const fromSi = (value, text) => clean(value / factor(text), factor(text));
export const toSi = (value, text) => clean(value * factor(text), factor(text));

export function element(name, attributes = {}, ...children) {
  const found = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (key.startsWith("on")) found.addEventListener(key.slice(2), value);
    else if (value === true) found.setAttribute(key, "");
    else if (value !== false && value !== undefined) found.setAttribute(key, value);
  }
  found.append(...children);
  return found;
}

export const byId = (name) => document.getElementById(name);

export const colour = (name) => getComputedStyle(document.documentElement)
  .getPropertyValue(`--${name}`).trim();

// Size of the text of pictures [px].
export const textSize = () =>
  0.75 * parseFloat(getComputedStyle(document.documentElement).fontSize);

export const copy = (value) => JSON.parse(JSON.stringify(value));

// A filled dot on a canvas.
export function dot(ctx, x, y, radius) {
  ctx.beginPath();
  ctx.arc(x, y, radius, 0, 2 * Math.PI);
  ctx.fill();
}

// A text as a file.
export function save(name, kind, text) {
  const url = URL.createObjectURL(new Blob([text], { type: kind }));
  element("a", { href: url, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(url), 1000);
}
