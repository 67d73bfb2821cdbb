/** Units of the file as people write them. */

const WORDS = { um: "µm", urad: "µrad", deg: "°", degC: "°C", 1: "" };

/** @param {string} unit as an attribute has it: "um", "mm s-1" */
export function unitText(unit) {
  if (unit in WORDS) return WORDS[unit];
  return String(unit ?? "")
    .replace(/\bum\b/g, "µm")
    .replace(/\burad\b/g, "µrad")
    .replace(/(\S+) (\S+)-1$/, "$1/$2")
    .replace(/\^2/g, "²");
}

/** "contour error (µm)", without brackets where there is no unit. */
export function withUnit(name, unit) {
  const text = unitText(unit);
  return text ? `${name} (${text})` : name;
}

/** "contour_error" as words. */
export const words = (name) => name.replaceAll("_", " ");
